// PLY, STL and OFF out.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "prep/io.h"
#include "srgb.h"
#include "writers.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

template <class Number>
void append_number(std::string& out, Number value) {
    char digits[40];
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
    out.append(digits, end);
}

template <class T>
void append_raw(std::string& out, T value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// Everything in one list, in world space, as formats without a scene graph need it.
struct Flat {
    std::vector<glm::dvec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec4> tangents, colors;
    std::vector<glm::vec2> uvs;
    std::vector<Index> face_offsets{0}, corner_vertices;  // polygons, by split vertex
    std::vector<Index> triangles, lines;
    bool moved = false;  // positions are not plain floats
    bool has_normals = false, has_tangents = false, has_uvs = false, has_colors = false;
};

void note_once(std::vector<std::string>& notes, const std::string& text) {
    if (std::find(notes.begin(), notes.end(), text) == notes.end()) notes.push_back(text);
}

void append_mesh(const PreparedScene& prepared, Index mesh_index, const glm::dmat4& world,
                 Flat& flat) {
    const VertexMesh& mesh = prepared.meshes[mesh_index];
    const Mesh& source = prepared.scene.meshes[mesh_index];
    const Index base = Index(flat.positions.size());
    const glm::dmat3 linear(world);
    const bool moved = world != glm::dmat4(1.0) || mesh.origin != glm::dvec3(0.0);
    const double sign = glm::determinant(linear) < 0 ? -1 : 1;
    const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                              glm::cross(linear[0], linear[1]));
    const auto unit = [](const glm::dvec3& v) {
        const double length = glm::length(v);
        return length > 0 ? v / length : v;
    };
    flat.moved |= moved;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const glm::dvec3 p(mesh.positions[v]);
        // Adding an origin of zero would turn −0 into 0.
        flat.positions.push_back(moved ? glm::dvec3(world * glm::dvec4(p + mesh.origin, 1.0)) : p);
        const auto at = [&](const auto& list, const auto& otherwise) {
            return v < list.size() ? list[v] : otherwise;
        };
        const glm::vec3 n = at(mesh.normals, glm::vec3(0, 0, 1));
        const glm::vec4 t = at(mesh.tangents, glm::vec4(1, 0, 0, 1));
        flat.normals.push_back(moved ? glm::vec3(unit(cofactor * glm::dvec3(n) * sign)) : n);
        flat.tangents.push_back(
            moved ? glm::vec4(glm::vec3(unit(linear * glm::dvec3(glm::vec3(t)))), t.w * float(sign))
                  : t);
        flat.uvs.push_back(mesh.uvs.empty() ? glm::vec2(0.0f) : at(mesh.uvs[0], glm::vec2(0.0f)));
        flat.colors.push_back(mesh.colors.empty() ? glm::vec4(1.0f)
                                                  : at(mesh.colors[0], glm::vec4(1.0f)));
    }
    flat.has_normals |= !mesh.normals.empty();
    flat.has_tangents |= !mesh.tangents.empty();
    flat.has_uvs |= !mesh.uvs.empty();
    flat.has_colors |= !mesh.colors.empty();
    const Index corner_base = Index(flat.corner_vertices.size());
    for (const Index v : mesh.corner_vertices) flat.corner_vertices.push_back(base + v);
    for (std::size_t f = 1; f < source.face_offsets.size(); ++f)
        flat.face_offsets.push_back(corner_base + source.face_offsets[f]);
    for (const Index v : mesh.indices) flat.triangles.push_back(base + v);
    for (const Index v : mesh.lines) flat.lines.push_back(base + v);
}

Flat flatten(const PreparedScene& prepared, const char* format, std::vector<std::string>& notes) {
    Flat flat;
    const std::vector<glm::dmat4> world = world_transforms(prepared.scene);
    std::size_t instances = 0;
    for (std::size_t n = 0; n < prepared.scene.nodes.size(); ++n) {
        const Index m = prepared.scene.nodes[n].mesh;
        if (m == no_index) continue;
        ++instances;
        append_mesh(prepared, m, world[n], flat);
        if (prepared.meshes[m].uvs.size() > 1)
            note_once(notes, fmt::format("{} holds one UV set: the others are left out", format));
    }
    if (instances > 1)
        note_once(notes, fmt::format("{} holds one mesh: {} were joined", format, instances));
    if (!prepared.scene.materials.empty())
        note_once(notes, fmt::format("{} holds no materials: left out", format));
    return flat;
}

unsigned char encoded(float linear) {
    const double x = std::clamp(double(linear), 0.0, 1.0);
    return static_cast<unsigned char>(std::lround(linear_to_srgb(x) * 255));
}

Result<void> check_count(std::size_t count, const std::filesystem::path& path) {
    if (count >= no_index)
        return Error{ErrorCode::limit, "more than 2^32 - 2 corners in one file", path.string()};
    return {};
}

// One value of a vertex or face, in text or bytes.
class PlyOut {
  public:
    PlyOut(std::string& out, bool ascii) : out_(out), ascii_(ascii) {}
    template <class T>
    void put(T value) {
        if (!ascii_) return append_raw(out_, value);
        if (!first_) out_ += ' ';
        first_ = false;
        if constexpr (sizeof(T) == 1)
            append_number(out_, int(value));
        else
            append_number(out_, value);
    }
    void end() {
        if (ascii_) out_ += '\n';
        first_ = true;
    }

  private:
    std::string& out_;
    bool ascii_, first_ = true;
};

glm::dvec3 facet_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    if (!(largest > 0) || !std::isfinite(largest)) return glm::dvec3(0.0);
    const glm::dvec3 scaled = n / largest;
    return scaled / glm::length(scaled);
}

WriteResult finish(const std::filesystem::path& path, const std::string& out,
                   std::vector<std::string> notes) {
    if (auto done = write_file(path, std::as_bytes(std::span(out))); !done)
        return std::move(done).error();
    return notes;
}

}  // namespace

WriteResult write_ply(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions& options) {
    std::vector<std::string> notes;
    const Flat flat = flatten(prepared, "PLY", notes);
    if (auto done = check_count(flat.corner_vertices.size(), path); !done)
        return std::move(done).error();
    if (flat.positions.size() > 0x7fffffff)
        return Error{ErrorCode::limit, "PLY's vertex indices end at 2^31 - 1", path.string()};
    const char* coordinate = flat.moved ? "double" : "float";
    std::string out =
        fmt::format("ply\nformat {} 1.0\ncomment meshprep\nelement vertex {}\n",
                    options.ascii ? "ascii" : "binary_little_endian", flat.positions.size());
    for (const char* axis : {"x", "y", "z"})
        out += fmt::format("property {} {}\n", coordinate, axis);
    const auto floats = [&](bool present, std::initializer_list<const char*> names) {
        if (present)
            for (const char* name : names) out += fmt::format("property float {}\n", name);
    };
    floats(flat.has_normals, {"nx", "ny", "nz"});
    floats(flat.has_tangents, {"tx", "ty", "tz", "tw"});
    // 1 − t as a float loses bits that a reader needs to come back to t.
    const bool uv_doubles = std::any_of(flat.uvs.begin(), flat.uvs.end(), [](const glm::vec2& uv) {
        return float(1.0 - double(float(1.0 - double(uv.y)))) != uv.y;
    });
    if (flat.has_uvs)
        for (const char* name : {"s", "t"})
            out += fmt::format("property {} {}\n", uv_doubles ? "double" : "float", name);
    if (flat.has_colors)
        for (const char* name : {"red", "green", "blue", "alpha"})
            out += fmt::format("property uchar {}\n", name);
    const std::size_t faces = flat.face_offsets.size() - 1;
    // Most readers expect a byte for the length of a face; larger polygons need more.
    Index largest = 0;
    for (std::size_t f = 0; f < faces; ++f)
        largest = std::max(largest, flat.face_offsets[f + 1] - flat.face_offsets[f]);
    const bool byte_lengths = largest <= 255;
    if (faces > 0)
        out += fmt::format("element face {}\nproperty list {} int vertex_indices\n", faces,
                           byte_lengths ? "uchar" : "uint");
    if (!flat.lines.empty())
        out += fmt::format("element edge {}\nproperty int vertex1\nproperty int vertex2\n",
                           flat.lines.size() / 2);
    out += "end_header\n";
    PlyOut to(out, options.ascii);
    for (std::size_t v = 0; v < flat.positions.size(); ++v) {
        for (int k = 0; k < 3; ++k) {
            if (flat.moved)
                to.put(flat.positions[v][k]);
            else
                to.put(float(flat.positions[v][k]));
        }
        for (int k = 0; flat.has_normals && k < 3; ++k) to.put(flat.normals[v][k]);
        for (int k = 0; flat.has_tangents && k < 4; ++k) to.put(flat.tangents[v][k]);
        if (flat.has_uvs) {
            const glm::dvec2 uv(flat.uvs[v].x, 1.0 - double(flat.uvs[v].y));
            for (int k = 0; k < 2; ++k) {
                if (uv_doubles)
                    to.put(uv[k]);
                else
                    to.put(float(uv[k]));
            }
        }
        if (flat.has_colors) {
            for (int k = 0; k < 3; ++k) to.put(encoded(flat.colors[v][k]));
            const float alpha = std::clamp(flat.colors[v].a, 0.0f, 1.0f);
            to.put(static_cast<unsigned char>(std::lround(double(alpha) * 255)));
        }
        to.end();
    }
    for (std::size_t f = 0; f < faces; ++f) {
        const Index length = flat.face_offsets[f + 1] - flat.face_offsets[f];
        if (byte_lengths)
            to.put(static_cast<unsigned char>(length));
        else
            to.put(length);
        for (Index c = flat.face_offsets[f]; c < flat.face_offsets[f + 1]; ++c)
            to.put(std::int32_t(flat.corner_vertices[c]));
        to.end();
    }
    for (std::size_t i = 0; i < flat.lines.size(); i += 2) {
        to.put(std::int32_t(flat.lines[i]));
        to.put(std::int32_t(flat.lines[i + 1]));
        to.end();
    }
    return finish(path, out, std::move(notes));
}

WriteResult write_stl(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions& options) {
    std::vector<std::string> notes;
    const Flat flat = flatten(prepared, "STL", notes);
    if (flat.has_uvs) note_once(notes, "STL holds no UVs: left out");
    if (flat.has_colors) note_once(notes, "STL holds no colours: left out");
    if (flat.moved) note_once(notes, "STL holds floats: coordinates were rounded to them");
    if (flat.has_normals) note_once(notes, "STL holds facet normals only: vertex normals left out");
    if (!flat.lines.empty()) note_once(notes, "STL holds no lines: left out");
    const std::size_t facets = flat.triangles.size() / 3;
    if (auto done = check_count(facets, path); !done) return std::move(done).error();
    std::string out;
    if (options.ascii) {
        out = "solid meshprep\n";
    } else {
        out.assign(80, ' ');
        std::memcpy(out.data(), "meshprep", 8);
        append_raw(out, std::uint32_t(facets));
        out.reserve(84 + facets * 50);
    }
    for (std::size_t t = 0; t < facets; ++t) {
        const glm::dvec3 p[3] = {flat.positions[flat.triangles[3 * t]],
                                 flat.positions[flat.triangles[3 * t + 1]],
                                 flat.positions[flat.triangles[3 * t + 2]]};
        const glm::vec3 n(facet_normal(p[0], p[1], p[2]));
        const auto numbers = [&](const glm::vec3& v) {
            for (int k = 0; k < 3; ++k) {
                if (options.ascii)
                    out += ' ', append_number(out, v[k]);
                else
                    append_raw(out, v[k]);
            }
        };
        if (options.ascii) out += "facet normal";
        numbers(n);
        if (options.ascii) out += "\nouter loop\n";
        for (const glm::dvec3& corner : p) {
            if (options.ascii) out += "vertex";
            numbers(glm::vec3(corner));
            if (options.ascii) out += '\n';
        }
        if (options.ascii)
            out += "endloop\nendfacet\n";
        else
            append_raw(out, std::uint16_t(0));
    }
    if (options.ascii) out += "endsolid meshprep\n";
    return finish(path, out, std::move(notes));
}

WriteResult write_off(const PreparedScene& prepared, const std::filesystem::path& path,
                      const SaveOptions&) {
    std::vector<std::string> notes;
    const Flat flat = flatten(prepared, "OFF", notes);
    if (flat.has_tangents) note_once(notes, "OFF holds no tangents: left out");
    const std::size_t faces = flat.face_offsets.size() - 1;
    std::string out = fmt::format("{}{}{}OFF\n{} {} 0\n", flat.has_uvs ? "ST" : "",
                                  flat.has_colors ? "C" : "", flat.has_normals ? "N" : "",
                                  flat.positions.size(), faces + flat.lines.size() / 2);
    for (std::size_t v = 0; v < flat.positions.size(); ++v) {
        for (int k = 0; k < 3; ++k) {
            if (k) out += ' ';
            if (flat.moved)
                append_number(out, flat.positions[v][k]);
            else
                append_number(out, float(flat.positions[v][k]));
        }
        for (int k = 0; flat.has_normals && k < 3; ++k)
            out += ' ', append_number(out, flat.normals[v][k]);
        for (int k = 0; flat.has_colors && k < 4; ++k) {
            out += ' ';
            const std::size_t begin = out.size();
            append_number(out, flat.colors[v][k]);
            // Integers would mean 0 … 255.
            if (out.find_first_of(".en", begin) == std::string::npos) out += ".0";
        }
        if (flat.has_uvs) {
            out += ' ';
            append_number(out, flat.uvs[v].x);
            out += ' ';
            append_number(out, 1.0 - double(flat.uvs[v].y));
        }
        out += '\n';
    }
    for (std::size_t f = 0; f < faces; ++f) {
        append_number(out, flat.face_offsets[f + 1] - flat.face_offsets[f]);
        for (Index c = flat.face_offsets[f]; c < flat.face_offsets[f + 1]; ++c)
            out += ' ', append_number(out, flat.corner_vertices[c]);
        out += '\n';
    }
    for (std::size_t i = 0; i < flat.lines.size(); i += 2)
        out += fmt::format("2 {} {}\n", flat.lines[i], flat.lines[i + 1]);
    return finish(path, out, std::move(notes));
}

}  // namespace prep::detail
