// PLY, STL and OFF out.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <type_traits>

#include "base/atomic_files.h"
#include "base/srgb.h"
#include "formats/writers.h"
#include "model/origin.h"
#include "text/blocks.h"
#include "text/lower_case.h"
#include "text/note_once.h"
#include "text/numbers.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Bytes as they are in memory (little-endian machines).
template <class T>
char* write_raw(char* to, T value) {
    std::memcpy(to, &value, sizeof value);
    return to + sizeof value;
}

// Everything in one list, in world space, as formats without a scene graph need it. The lists are
// the mesh's own where there is one mesh and nothing moves it, or `own`.
struct Flat {
    std::span<const glm::vec3> floats;    // positions when nothing is moved
    std::span<const glm::dvec3> doubles;  // positions otherwise
    std::span<const glm::vec3> normals;   // this and the next: empty or one per vertex
    std::span<const glm::vec4> tangents, colors;
    std::span<const glm::vec2> uvs;
    std::span<const Index> face_offsets, corner_vertices;  // polygons, by split vertex
    std::span<const Index> triangles, lines;
    std::size_t points = 0;
    bool far = false;  // of text: floats are written with all the digits of a double

    struct Own {
        std::vector<glm::vec3> floats, normals;
        std::vector<glm::dvec3> doubles;
        std::vector<glm::vec4> tangents, colors;
        std::vector<glm::vec2> uvs;
        std::vector<Index> face_offsets{0}, corner_vertices, triangles, lines;
    } own;

    bool moved() const { return !doubles.empty(); }
    std::size_t vertices() const { return moved() ? doubles.size() : floats.size(); }
    std::size_t faces() const { return face_offsets.empty() ? 0 : face_offsets.size() - 1; }
    glm::dvec3 position(std::size_t v) const {
        return moved() ? doubles[v] : glm::dvec3(floats[v]);
    }
};

struct Instance {
    const VertexMesh* mesh;
    const Mesh* source;
    glm::dmat4 world;
    bool moved() const { return world != glm::dmat4(1.0) || mesh->origin != glm::dvec3(0.0); }
};

// Formats that hold one set get the first that the mesh has.
const std::vector<glm::vec2>& first_uvs(const VertexMesh& mesh) {
    static const std::vector<glm::vec2> none;
    const auto set = std::find_if(mesh.uvs.begin(), mesh.uvs.end(),
                                  [](const auto& uvs) { return !uvs.empty(); });
    return set == mesh.uvs.end() ? none : *set;
}

template <class List, class T>
void append_or_fill(List& to, bool wanted, const std::vector<T>& from, std::size_t count,
                    const T& otherwise) {
    if (!wanted) return;
    if (from.empty())
        to.insert(to.end(), count, otherwise);
    else
        to.insert(to.end(), from.begin(), from.end());
}

void append_instance(const Instance& instance, bool moved, bool normals, bool tangents, bool uvs,
                     bool colors, Flat::Own& to) {
    const VertexMesh& mesh = *instance.mesh;
    const Index base = Index(moved ? to.doubles.size() : to.floats.size());
    const glm::dmat3 linear(instance.world);
    const float sign = mirrors(linear) ? -1 : 1;
    const glm::dmat3 normals_to_world = normal_matrix(linear);
    // Where a flat transform leaves no direction, that of before, as in OBJ.
    const auto unit = [](const glm::dvec3& v, const glm::vec3& before) {
        const double length = glm::length(v);
        return length > 0 ? glm::vec3(v / length) : before;
    };
    if (!moved) to.floats.insert(to.floats.end(), mesh.positions.begin(), mesh.positions.end());
    const std::size_t first_normal = to.normals.size(), first_tangent = to.tangents.size();
    append_or_fill(to.normals, normals, mesh.normals, mesh.vertex_count(), glm::vec3(0, 0, 1));
    append_or_fill(to.tangents, tangents, mesh.tangents, mesh.vertex_count(),
                   glm::vec4(1, 0, 0, 1));
    if (moved) {
        for (const glm::vec3& p : mesh.positions)
            to.doubles.push_back(
                glm::dvec3(instance.world * glm::dvec4(glm::dvec3(p) + mesh.origin, 1.0)));
    }
    if (instance.moved() && linear != glm::dmat3(1.0)) {
        for (std::size_t v = first_normal; v < to.normals.size(); ++v)
            to.normals[v] = unit(normals_to_world * glm::dvec3(to.normals[v]), to.normals[v]);
        for (std::size_t v = first_tangent; v < to.tangents.size(); ++v) {
            glm::vec4& t = to.tangents[v];
            const glm::vec3 before(t);
            t = glm::vec4(unit(linear * glm::dvec3(before), before), t.w * sign);
        }
    }
    append_or_fill(to.uvs, uvs, first_uvs(mesh), mesh.vertex_count(), glm::vec2(0.0f));
    append_or_fill(to.colors, colors,
                   mesh.colors.empty() ? std::vector<glm::vec4>() : mesh.colors[0],
                   mesh.vertex_count(), glm::vec4(1.0f));
    const Index corner_base = Index(to.corner_vertices.size());
    const std::size_t first_triangle = to.triangles.size();
    for (const Index v : mesh.corner_vertices) to.corner_vertices.push_back(base + v);
    for (std::size_t f = 1; f < instance.source->face_offsets.size(); ++f)
        to.face_offsets.push_back(corner_base + instance.source->face_offsets[f]);
    for (const Index v : mesh.indices) to.triangles.push_back(base + v);
    if (sign < 0) {  // a mirror turns the winding: the front stays the front
        for (std::size_t f = 1; f < instance.source->face_offsets.size(); ++f)
            std::reverse(
                to.corner_vertices.begin() + corner_base + instance.source->face_offsets[f - 1] + 1,
                to.corner_vertices.begin() + corner_base + instance.source->face_offsets[f]);
        for (std::size_t t = first_triangle; t + 2 < to.triangles.size(); t += 3)
            std::swap(to.triangles[t + 1], to.triangles[t + 2]);
    }
    for (const Index v : mesh.lines) to.lines.push_back(base + v);
}

// Vertices of the source that are not in the split mesh, whatever its order.
std::size_t unused_vertices(const VertexMesh& mesh, const Mesh& source) {
    std::vector<bool> used(source.vertex_count(), false);
    for (const Index v : mesh.source_vertices)
        if (v < used.size()) used[v] = true;
    return std::size_t(std::count(used.begin(), used.end(), false));
}

// Errors: limit (instances and all, more than indices of 32 bits tell apart).
Result<void> flatten(const PreparedScene& prepared, const char* format, bool text,
                     const std::filesystem::path& path, std::vector<std::string>& notes,
                     Flat& flat) {
    const std::vector<glm::dmat4> world = world_transforms(prepared.scene);
    std::vector<Instance> instances;
    bool moved = false, normals = false, tangents = false, uvs = false, colors = false;
    std::set<Index> seen;
    std::size_t unused = 0, color_sets = 0;
    std::uint64_t vertices = 0, corners = 0;
    for (std::size_t n = 0; n < prepared.scene.nodes.size(); ++n) {
        const Index m = prepared.scene.nodes[n].mesh;
        if (m == no_index) continue;
        const VertexMesh& mesh = prepared.meshes[m];
        instances.push_back({&mesh, &prepared.scene.meshes[m], world[n]});
        moved |= instances.back().moved();
        normals |= !mesh.normals.empty();
        tangents |= !mesh.tangents.empty();
        uvs |= !first_uvs(mesh).empty();
        colors |= !mesh.colors.empty();
        flat.points += mesh.points.size();
        vertices += mesh.vertex_count();
        corners += std::max(mesh.corner_vertices.size(), mesh.indices.size());
        if (seen.insert(m).second) unused += unused_vertices(mesh, prepared.scene.meshes[m]);
        if (std::count_if(mesh.uvs.begin(), mesh.uvs.end(),
                          [](const auto& set) { return !set.empty(); }) > 1)
            note_once(notes, fmt::format("{} holds one UV set: the others are left out", format));
        color_sets = std::max<std::size_t>(
            color_sets, std::size_t(std::count_if(mesh.colors.begin(), mesh.colors.end(),
                                                  [](const auto& set) { return !set.empty(); })));
    }
    if (text) {
        PositionBounds bounds;
        for (const Instance& instance : instances)
            for (const glm::vec3& p : instance.mesh->positions)
                bounds.add(glm::dvec3(instance.world *
                                      glm::dvec4(glm::dvec3(p) + instance.mesh->origin, 1.0)));
        flat.far = bounds.may_be_far();
        moved |= flat.far;
    }
    if (vertices >= no_index || corners >= no_index)
        return Error{ErrorCode::limit, "more than 2^32 - 2 vertices or corners in one file",
                     path.string()};
    if (instances.size() > 1)
        note_once(notes,
                  fmt::format("{} holds one mesh: {} were joined", format, instances.size()));
    if (!prepared.scene.materials.empty())
        note_once(notes, fmt::format("{} holds no materials: left out", format));
    if (color_sets > 1 && std::string_view(format) != "STL")  // which holds none
        note_once(notes,
                  fmt::format("{} holds one set of colours: the others are left out", format));
    note_groups(prepared, format, notes);
    if (unused > 0)
        notes.push_back(fmt::format("{} that no face, line or point uses left out",
                                    unused == 1 ? "1 vertex" : fmt::format("{} vertices", unused)));
    if (instances.size() == 1 && !moved) {
        const VertexMesh& mesh = *instances[0].mesh;
        flat.floats = mesh.positions;
        flat.normals = mesh.normals;
        flat.tangents = mesh.tangents;
        flat.uvs = first_uvs(mesh);
        if (colors) flat.colors = mesh.colors[0];
        flat.face_offsets = instances[0].source->face_offsets;
        flat.corner_vertices = mesh.corner_vertices;
        flat.triangles = mesh.indices;
        flat.lines = mesh.lines;
        return {};
    }
    Flat::Own& own = flat.own;
    for (const Instance& instance : instances)
        append_instance(instance, moved, normals, tangents, uvs, colors, own);
    flat.floats = own.floats;
    flat.doubles = own.doubles;
    flat.normals = own.normals;
    flat.tangents = own.tangents;
    flat.colors = own.colors;
    flat.uvs = own.uvs;
    flat.face_offsets = own.face_offsets;
    flat.corner_vertices = own.corner_vertices;
    flat.triangles = own.triangles;
    flat.lines = own.lines;
    return {};
}

// 0 to 1; 0 for what is no number.
double clamped(float x) {
    return x > 0 ? std::min(double(x), 1.0) : 0.0;
}

unsigned char encoded(float linear) {
    return static_cast<unsigned char>(std::lround(linear_to_srgb(clamped(linear)) * 255));
}

unsigned char encoded_alpha(float alpha) {
    return static_cast<unsigned char>(std::lround(clamped(alpha) * 255));
}

// What bytes are read as.
bool are_bytes(const glm::vec4& color) {
    static const std::array<float, 256> linear = [] {
        std::array<float, 256> values;
        for (std::size_t k = 0; k < values.size(); ++k)
            values[k] = float(srgb_to_linear(double(k) / 255));
        return values;
    }();
    return float(encoded_alpha(color.a) / 255.0) == color.a &&
           std::binary_search(linear.begin(), linear.end(), color.r) &&
           std::binary_search(linear.begin(), linear.end(), color.g) &&
           std::binary_search(linear.begin(), linear.end(), color.b);
}

void note_changed_colors(const Flat& flat, std::vector<std::string>& notes) {
    bool clamped = false, rounded = false;
    for (const glm::vec4& c : flat.colors) {
        if (clamped && rounded) break;
        if (c != glm::clamp(c, glm::vec4(0.0f), glm::vec4(1.0f)))
            clamped = true;
        else
            rounded = rounded || !are_bytes(c);
    }
    if (clamped) note_once(notes, "vertex colours outside 0 … 1 were clamped");
    if (rounded) note_once(notes, "PLY's colours are bytes here: they were rounded to them");
}

// A vertex that nothing else uses is a point in a file without faces and segments only.
void note_points(const Flat& flat, const char* format, std::vector<std::string>& notes) {
    if (flat.points > 0 && (flat.faces() > 0 || !flat.lines.empty()))
        note_once(notes, fmt::format("{} has no points beside faces or lines: {} written as "
                                     "vertices that nothing uses",
                                     format, flat.points));
}

// One value of a vertex or face after the other, in text or bytes.
class PlyOut {
  public:
    PlyOut(char* to, bool ascii) : to_(to), ascii_(ascii) {}
    template <class T>
    void put(T value) {
        if (!ascii_) {
            to_ = write_raw(to_, value);
            return;
        }
        if (!first_) *to_++ = ' ';
        first_ = false;
        if constexpr (std::is_same_v<T, float>)
            to_ = write_float(to_, value);
        else if constexpr (std::is_same_v<T, double>)
            to_ = write_double(to_, value);
        else
            to_ = write_integer(to_, std::uint64_t(value));
    }
    char* end() {
        if (ascii_) *to_++ = '\n';
        return to_;
    }

  private:
    char* to_;
    bool ascii_, first_ = true;
};

glm::dvec3 facet_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    if (!(largest > 0) || !std::isfinite(largest)) return glm::dvec3(0.0);
    const glm::dvec3 scaled = n / largest;
    return scaled / glm::length(scaled) + 0.0;  // no negative zeros: their sign is chance
}

// A face's length and its indices, of up to 10 digits, and what stands between them.
auto room_of_faces(const Flat& flat) {
    return [&flat](std::size_t begin, std::size_t end) {
        return std::size_t(12) *
               (flat.face_offsets[end] - flat.face_offsets[begin] + (end - begin));
    };
}

WriteResult finish(FileSetRules rules, const std::filesystem::path& path, TextBlocks& out,
                   std::vector<std::string> notes) {
    FileSet files(std::move(rules));
    if (auto done = files.add(path, out.parts()); !done) return std::move(done).error();
    if (auto done = files.commit(); !done) return std::move(done).error();
    return notes;
}

}  // namespace

WriteResult write_ply(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions& options) {
    std::vector<std::string> notes;
    Flat flat;
    if (auto done = flatten(prepared, "PLY", options.ascii, path, notes, flat); !done)
        return std::move(done).error();
    note_points(flat, "PLY", notes);
    note_changed_colors(flat, notes);
    if (flat.vertices() > 0x7fffffff)
        return Error{ErrorCode::limit, "PLY's vertex indices end at 2^31 - 1", path.string()};
    TextBlocks out(options.threads);
    std::string& header = out.text();
    header = fmt::format("ply\nformat {} 1.0\ncomment meshprep\nelement vertex {}\n",
                         options.ascii ? "ascii" : "binary_little_endian", flat.vertices());
    for (const char* axis : {"x", "y", "z"})
        header += fmt::format("property {} {}\n", flat.moved() ? "double" : "float", axis);
    const auto floats = [&](bool present, std::initializer_list<const char*> names) {
        if (present)
            for (const char* name : names) header += fmt::format("property float {}\n", name);
    };
    floats(!flat.normals.empty(), {"nx", "ny", "nz"});
    floats(!flat.tangents.empty(), {"tx", "ty", "tz", "tw"});
    // 1 − t as a float loses bits that a reader needs to come back to t.
    const bool uv_doubles = std::any_of(flat.uvs.begin(), flat.uvs.end(), [](const glm::vec2& uv) {
        return float(1.0 - double(float(1.0 - double(uv.y)))) != uv.y;
    });
    if (!flat.uvs.empty())
        for (const char* name : {"s", "t"})
            header += fmt::format("property {} {}\n", uv_doubles ? "double" : "float", name);
    if (!flat.colors.empty())
        for (const char* name : {"red", "green", "blue", "alpha"})
            header += fmt::format("property uchar {}\n", name);
    // Most readers expect a byte for the length of a face; larger polygons need more.
    Index largest = 0;
    for (std::size_t f = 0; f < flat.faces(); ++f)
        largest = std::max(largest, flat.face_offsets[f + 1] - flat.face_offsets[f]);
    const bool byte_lengths = largest <= 255;
    if (flat.faces() > 0)
        header += fmt::format("element face {}\nproperty list {} int vertex_indices\n",
                              flat.faces(), byte_lengths ? "uchar" : "uint");
    if (!flat.lines.empty())
        header += fmt::format("element edge {}\nproperty int vertex1\nproperty int vertex2\n",
                              flat.lines.size() / 2);
    header += "end_header\n";
    const std::size_t longest = options.ascii ? 17 * max_number_text : 17 * sizeof(double);
    out.short_lines(flat.vertices(), longest, [&](char* at, std::size_t v) {
        PlyOut to(at, options.ascii);
        for (int k = 0; k < 3; ++k) {
            if (flat.moved())
                to.put(flat.doubles[v][k]);
            else
                to.put(flat.floats[v][k]);
        }
        for (int k = 0; !flat.normals.empty() && k < 3; ++k) to.put(flat.normals[v][k]);
        for (int k = 0; !flat.tangents.empty() && k < 4; ++k) to.put(flat.tangents[v][k]);
        if (!flat.uvs.empty()) {
            const glm::dvec2 uv(flat.uvs[v].x, 1.0 - double(flat.uvs[v].y));
            for (int k = 0; k < 2; ++k) {
                if (uv_doubles)
                    to.put(uv[k]);
                else
                    to.put(float(uv[k]));
            }
        }
        if (!flat.colors.empty()) {
            for (int k = 0; k < 3; ++k) to.put(encoded(flat.colors[v][k]));
            to.put(encoded_alpha(flat.colors[v].a));
        }
        return to.end();
    });
    out.lines(flat.faces(), room_of_faces(flat), [&](char* at, std::size_t f) {
        PlyOut to(at, options.ascii);
        const Index length = flat.face_offsets[f + 1] - flat.face_offsets[f];
        if (byte_lengths)
            to.put(static_cast<unsigned char>(length));
        else
            to.put(length);
        for (Index c = flat.face_offsets[f]; c < flat.face_offsets[f + 1]; ++c)
            to.put(std::int32_t(flat.corner_vertices[c]));
        return to.end();
    });
    out.short_lines(flat.lines.size() / 2, 24, [&](char* at, std::size_t i) {
        PlyOut to(at, options.ascii);
        to.put(std::int32_t(flat.lines[2 * i]));
        to.put(std::int32_t(flat.lines[2 * i + 1]));
        return to.end();
    });
    return finish(rules_for(prepared, path, options), path, out, std::move(notes));
}

namespace {

// The mesh's, where it is the only one and text that readers find the end of.
std::string solid_name(const Scene& scene) {
    const std::string name = scene.meshes.size() == 1 ? scene.meshes[0].name : "";
    const bool one_line = std::none_of(name.begin(), name.end(),
                                       [](char c) { return static_cast<unsigned char>(c) < ' '; });
    const bool good = !name.empty() && name.front() != ' ' && name.back() != ' ' && one_line &&
                      lower_case(name).find("facet") == std::string::npos;
    return good ? name : "meshprep";
}

}  // namespace

WriteResult write_stl(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions& options) {
    std::vector<std::string> notes;
    Flat flat;
    if (auto done = flatten(prepared, "STL", options.ascii, path, notes, flat); !done)
        return std::move(done).error();
    if (!flat.uvs.empty()) note_once(notes, "STL holds no UVs: left out");
    if (!flat.colors.empty()) note_once(notes, "STL holds no colours: left out");
    if (flat.triangles.empty() && (!flat.lines.empty() || flat.points > 0))
        return Error{ErrorCode::unsupported,
                     "STL holds triangles alone, and there are only lines or points: write .ply, "
                     ".obj, .glb or .gltf",
                     path.string()};
    const auto is_rounded = [&](std::uint32_t v) {
        return glm::dvec3(glm::vec3(flat.position(v))) != flat.position(v);
    };
    if (flat.moved() && std::any_of(flat.triangles.begin(), flat.triangles.end(), is_rounded))
        note_once(notes, "STL holds floats: coordinates were rounded to them");
    if (!flat.normals.empty())
        note_once(notes, "STL holds facet normals only: vertex normals left out");
    if (!flat.tangents.empty()) note_once(notes, "STL holds no tangents: left out");
    if (!flat.lines.empty()) note_once(notes, "STL holds no lines: left out");
    if (flat.points > 0)
        note_once(notes, fmt::format("STL holds no points: {} left out", flat.points));
    const std::size_t facets = flat.triangles.size() / 3;
    TextBlocks out(options.threads);
    const std::string name = solid_name(prepared.scene);
    if (options.ascii) {
        out.text() = "solid " + name + '\n';
    } else {
        out.text().assign(84, ' ');
        std::memcpy(out.text().data(), "meshprep", 8);
        write_raw(out.text().data() + 80, std::uint32_t(facets));
    }
    const std::size_t longest = options.ascii ? 12 * max_number_text + 120 : 50;
    out.short_lines(facets, longest, [&](char* to, std::size_t t) {
        const glm::dvec3 p[3] = {flat.position(flat.triangles[3 * t]),
                                 flat.position(flat.triangles[3 * t + 1]),
                                 flat.position(flat.triangles[3 * t + 2])};
        const auto word = [&](const char* text) {
            while (options.ascii && *text) *to++ = *text++;
        };
        const auto numbers = [&](const glm::vec3& v, bool far) {
            for (int k = 0; k < 3; ++k) {
                word(" ");
                to = !options.ascii ? write_raw(to, v[k])
                     : far          ? write_double(to, double(v[k]))
                                    : write_float(to, v[k]);
            }
        };
        word("facet normal");
        numbers(glm::vec3(facet_normal(p[0], p[1], p[2])), false);
        word("\nouter loop\n");
        for (const glm::dvec3& corner : p) {
            word("vertex");
            numbers(glm::vec3(corner), flat.far);
            word("\n");
        }
        word("endloop\nendfacet\n");
        return options.ascii ? to : write_raw(to, std::uint16_t(0));
    });
    if (options.ascii) out.text() = "endsolid " + name + '\n';
    return finish(rules_for(prepared, path, options), path, out, std::move(notes));
}

WriteResult write_off(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions& options) {
    std::vector<std::string> notes;
    Flat flat;
    if (auto done = flatten(prepared, "OFF", true, path, notes, flat); !done)
        return std::move(done).error();
    note_points(flat, "OFF", notes);
    if (!flat.tangents.empty()) note_once(notes, "OFF holds no tangents: left out");
    TextBlocks out(options.threads);
    out.text() = fmt::format("{}{}{}OFF\n{} {} 0\n", flat.uvs.empty() ? "" : "ST",
                             flat.colors.empty() ? "" : "C", flat.normals.empty() ? "" : "N",
                             flat.vertices(), flat.faces() + flat.lines.size() / 2);
    out.short_lines(flat.vertices(), 13 * max_number_text, [&](char* to, std::size_t v) {
        for (int k = 0; k < 3; ++k) {
            if (k) *to++ = ' ';
            to = flat.moved() ? write_double(to, flat.doubles[v][k])
                              : write_float(to, flat.floats[v][k]);
        }
        for (int k = 0; !flat.normals.empty() && k < 3; ++k) {
            *to++ = ' ';
            to = write_float(to, flat.normals[v][k]);
        }
        for (int k = 0; !flat.colors.empty() && k < 4; ++k) {
            *to++ = ' ';
            char* const begin = to;
            to = write_float(to, flat.colors[v][k]);
            // Integers would mean 0 … 255.
            if (std::none_of(begin, to, [](char c) { return c == '.' || c == 'e' || c == 'n'; })) {
                *to++ = '.';
                *to++ = '0';
            }
        }
        if (!flat.uvs.empty()) {
            *to++ = ' ';
            to = write_float(to, flat.uvs[v].x);
            *to++ = ' ';
            to = write_flipped(to, flat.uvs[v].y);
        }
        *to++ = '\n';
        return to;
    });
    out.lines(flat.faces(), room_of_faces(flat), [&](char* to, std::size_t f) {
        to = write_integer(to, flat.face_offsets[f + 1] - flat.face_offsets[f]);
        for (Index c = flat.face_offsets[f]; c < flat.face_offsets[f + 1]; ++c) {
            *to++ = ' ';
            to = write_integer(to, flat.corner_vertices[c]);
        }
        *to++ = '\n';
        return to;
    });
    for (std::size_t i = 0; i < flat.lines.size(); i += 2)
        out.text() += fmt::format("2 {} {}\n", flat.lines[i], flat.lines[i + 1]);
    return finish(rules_for(prepared, path, options), path, out, std::move(notes));
}

}  // namespace prep::detail
