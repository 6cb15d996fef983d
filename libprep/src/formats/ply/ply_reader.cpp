#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/srgb.h"
#include "formats/picture_search.h"
#include "formats/ply/ply.h"
#include "formats/ply/ply_header.h"
#include "prep/mesh.h"
#include "text/line_ends.h"
#include "text/name_list.h"
#include "text/scan.h"

namespace prep {
namespace {

using namespace detail;

// Values one after the other, from text or from bytes of either order.
class Values {
  public:
    Values(std::span<const std::byte> bytes, PlyEncoding encoding, std::size_t at)
        : bytes_(bytes), encoding_(encoding), at_(at) {}

    bool next(PlyType type, double& value) {
        return encoding_ == PlyEncoding::ascii ? next_text(value) : next_binary(type, value);
    }
    // Where the last value stood: ":line" in text, ", byte N" behind it in binary files.
    std::string place() const {
        if (encoding_ != PlyEncoding::ascii) return ", byte " + std::to_string(at_);
        const auto* data = reinterpret_cast<const char*>(bytes_.data());
        return ":" + std::to_string(1 + std::count(data, data + at_, '\n'));
    }
    std::size_t left() const { return bytes_.size() - at_; }
    bool skip(std::size_t bytes) {
        if (bytes > left()) return false;
        at_ += bytes;
        return true;
    }

    // Text with a line for each element, as the format has it: what a line holds beyond the
    // properties that the header names is passed over. Files with several elements on a line are
    // read value by value.
    void expect_lines(double elements) {
        if (encoding_ != PlyEncoding::ascii) return;
        const char* data = reinterpret_cast<const char*>(bytes_.data());
        double lines = 0;
        for (std::size_t at = at_; at < bytes_.size() && lines <= elements;) {
            const void* const end = std::memchr(data + at, '\n', bytes_.size() - at);
            const std::size_t next =
                end ? std::size_t(static_cast<const char*>(end) - data) + 1 : bytes_.size();
            lines += std::any_of(data + at, data + next, [](char c) { return !is_space(c); });
            at = next;
        }
        by_line_ = lines == elements;
    }
    void end_element() {
        if (!by_line_) return;
        const char* data = reinterpret_cast<const char*>(bytes_.data());
        bool more = false;
        for (; at_ < bytes_.size() && data[at_] != '\n'; ++at_) more |= !is_space(data[at_]);
        long_lines_ += more;
    }
    std::uint64_t long_lines() const { return long_lines_; }

  private:
    static bool is_space(char c) { return is_blank(c) || c == '\n'; }

    bool next_text(double& value) {
        const char* data = reinterpret_cast<const char*>(bytes_.data());
        while (at_ < bytes_.size() && is_space(data[at_])) ++at_;
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && !is_space(data[at_])) ++at_;
        return LineScanner(data + begin, data + at_).number(value);
    }

    bool next_binary(PlyType type, double& value) {
        const std::size_t size = size_of(type);
        if (size > left()) return false;
        std::array<std::byte, 8> raw{};
        std::memcpy(raw.data(), bytes_.data() + at_, size);
        at_ += size;
        if (encoding_ == PlyEncoding::big) std::reverse(raw.begin(), raw.begin() + long(size));
        switch (type) {
            case PlyType::i8:
                value = as<std::int8_t>(raw);
                break;
            case PlyType::u8:
                value = as<std::uint8_t>(raw);
                break;
            case PlyType::i16:
                value = as<std::int16_t>(raw);
                break;
            case PlyType::u16:
                value = as<std::uint16_t>(raw);
                break;
            case PlyType::i32:
                value = as<std::int32_t>(raw);
                break;
            case PlyType::u32:
                value = as<std::uint32_t>(raw);
                break;
            case PlyType::f32:
                value = double(as<float>(raw));
                break;
            case PlyType::f64:
                value = as<double>(raw);
                break;
        }
        return true;
    }

    template <class T>
    static T as(const std::array<std::byte, 8>& raw) {
        T value;
        std::memcpy(&value, raw.data(), sizeof value);
        return value;
    }

    std::span<const std::byte> bytes_;
    PlyEncoding encoding_;
    std::size_t at_;
    bool by_line_ = false;
    std::uint64_t long_lines_ = 0;
};

enum Slot { px, py, pz, nx, ny, nz, red, green, blue, alpha, tu, tv, tx, ty, tz, tw, slot_count };

std::optional<Slot> slot_of(const std::string& name) {
    static const std::pair<const char*, Slot> names[] = {{"x", px},
                                                         {"y", py},
                                                         {"z", pz},
                                                         {"nx", nx},
                                                         {"ny", ny},
                                                         {"nz", nz},
                                                         {"red", red},
                                                         {"green", green},
                                                         {"blue", blue},
                                                         {"alpha", alpha},
                                                         {"r", red},
                                                         {"g", green},
                                                         {"b", blue},
                                                         {"a", alpha},
                                                         {"diffuse_red", red},
                                                         {"diffuse_green", green},
                                                         {"diffuse_blue", blue},
                                                         {"s", tu},
                                                         {"t", tv},
                                                         {"u", tu},
                                                         {"v", tv},
                                                         {"texture_u", tu},
                                                         {"texture_v", tv},
                                                         {"tx", tx},
                                                         {"ty", ty},
                                                         {"tz", tz},
                                                         {"tw", tw}};
    for (const auto& [text, slot] : names)
        if (name == text) return slot;
    return std::nullopt;
}

double largest_of(PlyType type) {
    switch (type) {
        case PlyType::i8:
            return 127;
        case PlyType::u8:
            return 255;
        case PlyType::i16:
            return 32767;
        case PlyType::u16:
            return 65535;
        case PlyType::i32:
            return 2147483647.0;
        case PlyType::u32:
            return 4294967295.0;
        default:
            return 1;
    }
}

float linear(double x, PlyType type) {
    if (type == PlyType::f32 || type == PlyType::f64) return float(x);
    return float(srgb_to_linear(std::clamp(x / largest_of(type), 0.0, 1.0)));
}

class PlyParser {
  public:
    PlyParser(std::span<const std::byte> bytes, const std::string& name, PlyHeader header,
              PictureSearch* pictures)
        : name_(name),
          pictures_(pictures),
          header_(std::move(header)),
          values_(bytes, header_.encoding, header_.size) {}

    Result<Scene> run() {
        scene_.name = name_;
        scene_.meshes.emplace_back();
        Mesh& mesh = scene_.meshes.back();
        mesh.name = std::filesystem::path(name_).stem().string();
        double elements = 0;
        for (const PlyElement& element : header_.elements)
            if (!element.properties.empty()) elements += double(element.count);
        values_.expect_lines(elements);
        for (const PlyElement& element : header_.elements) {
            if (auto done = check_room(element); !done) return std::move(done).error();
            Result<void> done = element.name == "vertex"      ? vertices(element)
                                : element.name == "face"      ? faces(element, mesh)
                                : element.name == "tristrips" ? strips(element, mesh)
                                : element.name == "edge"      ? edges(element, mesh)
                                                              : skip(element);
            if (!done) return std::move(done).error();
        }
        return finish(mesh);
    }

  private:
    Error fail(const std::string& what, ErrorCode code = ErrorCode::syntax) const {
        return {code, what, name_ + values_.place()};
    }
    Error cut_short(const PlyElement& element, std::uint64_t done) const {
        return fail("the file ends or is malformed in " + element.name + " " +
                    std::to_string(done) + " of " + std::to_string(element.count));
    }

    // The announced count against what the file has room for, before anything is reserved.
    Result<void> check_room(const PlyElement& element) const {
        std::size_t least = 0;
        for (const PlyProperty& p : element.properties)
            least += header_.encoding == PlyEncoding::ascii ? 2
                     : p.list                               ? size_of(p.count_type)
                                                            : size_of(p.type);
        // A last value in text needs no separator after it.
        const std::size_t room = values_.left() + (header_.encoding == PlyEncoding::ascii ? 1 : 0);
        if (least > 0 && element.count > room / least)
            return fail("the header announces " + std::to_string(element.count) + " of " +
                        element.name + ", but there is room for " + std::to_string(room / least));
        if (element.count >= no_index)
            return fail("more than 2^32 - 2 of " + element.name, ErrorCode::limit);
        return {};
    }

    // One list's length, checked against the bytes that are left.
    bool list_length(const PlyProperty& p, std::uint64_t& length) {
        double value;
        if (!values_.next(p.count_type, value) || !(value >= 0) || value != std::floor(value))
            return false;
        const std::size_t each = header_.encoding == PlyEncoding::ascii ? 2 : size_of(p.type);
        if (value > double((values_.left() + 1) / each)) return false;
        length = std::uint64_t(value);
        return true;
    }

    bool skip_property(const PlyProperty& p) {
        double value;
        if (!p.list) return values_.next(p.type, value);
        std::uint64_t length = 0;
        if (!list_length(p, length)) return false;
        if (header_.encoding != PlyEncoding::ascii) return values_.skip(length * size_of(p.type));
        for (std::uint64_t k = 0; k < length; ++k)
            if (!values_.next(p.type, value)) return false;
        return true;
    }

    void leave(const PlyElement& element, const PlyProperty& property) {
        if (element.count > 0) not_taken_.add(element.name + " " + property.name);
    }

    Result<void> skip(const PlyElement& element) {
        for (const PlyProperty& p : element.properties) leave(element, p);
        if (element.properties.empty()) return {};
        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (const PlyProperty& p : element.properties)
                if (!skip_property(p)) return cut_short(element, i);
            values_.end_element();
        }
        return {};
    }

    Result<void> vertices(const PlyElement& element) {
        std::vector<std::optional<Slot>> slots;
        std::array<bool, slot_count> has{};
        for (const PlyProperty& p : element.properties) {
            slots.push_back(p.list ? std::nullopt : slot_of(p.name));
            if (slots.back()) {
                has[*slots.back()] = true;
                types_[*slots.back()] = p.type;
            }
        }
        if (!has[px] || !has[py] || !has[pz]) return fail("vertices without x, y and z");
        if (have_vertices_) return fail("a second element \"vertex\"");
        have_vertices_ = true;
        has_normals_ = has[nx] && has[ny] && has[nz];
        has_colors_ = has[red] && has[green] && has[blue];
        has_uvs_ = has[tu] && has[tv];
        has_tangents_ = has_normals_ && has[tx] && has[ty] && has[tz] && has[tw];
        for (std::size_t p = 0; p < slots.size(); ++p) {
            const auto slot = slots[p];
            const bool taken = slot && (*slot <= pz || (*slot <= nz && has_normals_) ||
                                        (*slot >= red && *slot <= alpha && has_colors_) ||
                                        (*slot >= tu && *slot <= tv && has_uvs_) ||
                                        (*slot >= tx && has_tangents_));
            if (!taken) leave(element, element.properties[p]);
        }
        positions_.reserve(element.count);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            std::array<double, slot_count> v{};
            if (!has[alpha]) v[alpha] = 1;
            for (std::size_t p = 0; p < slots.size(); ++p) {
                if (!slots[p]) {
                    if (!skip_property(element.properties[p])) return cut_short(element, i);
                } else if (!values_.next(element.properties[p].type, v[*slots[p]])) {
                    return cut_short(element, i);
                }
            }
            values_.end_element();
            positions_.push_back({v[px], v[py], v[pz]});
            if (has_normals_) normals_.push_back({float(v[nx]), float(v[ny]), float(v[nz])});
            if (has_uvs_) uvs_.push_back({float(v[tu]), float(1.0 - v[tv])});
            if (has_tangents_)
                tangents_.push_back({float(v[tx]), float(v[ty]), float(v[tz]), float(v[tw])});
            if (has_colors_) {
                const double a = has[alpha] ? v[alpha] / largest_of(types_[alpha]) : 1;
                colors_.push_back({linear(v[red], types_[red]), linear(v[green], types_[green]),
                                   linear(v[blue], types_[blue]), float(a)});
            }
        }
        return {};
    }

    static bool lists_corners(const PlyProperty& p) {
        return p.list && (p.name == "vertex_indices" || p.name == "vertex_index");
    }

    Result<void> faces(const PlyElement& element, Mesh& mesh) {
        std::vector<double> texcoords;
        for (const PlyProperty& p : element.properties)
            if (!lists_corners(p) && !(p.list && p.name == "texcoord") && !names_texture(p))
                leave(element, p);
        for (std::uint64_t f = 0; f < element.count; ++f) {
            const std::size_t first = mesh.corner_vertices.size();
            bool have_corners = false;
            double texture = 0;
            texcoords.clear();
            for (const PlyProperty& p : element.properties) {
                const bool corners = lists_corners(p);
                const bool coordinates = p.list && p.name == "texcoord";
                if (names_texture(p)) {
                    if (!values_.next(p.type, texture)) return cut_short(element, f);
                    continue;
                }
                if (!corners && !coordinates) {
                    if (!skip_property(p)) return cut_short(element, f);
                    continue;
                }
                std::uint64_t length = 0;
                if (!list_length(p, length)) return cut_short(element, f);
                for (std::uint64_t k = 0; k < length; ++k) {
                    double value;
                    if (!values_.next(p.type, value)) return cut_short(element, f);
                    if (coordinates) {
                        texcoords.push_back(value);
                    } else if (auto done = add_corner(value, mesh); !done) {
                        return done;
                    }
                }
                have_corners |= corners;
            }
            if (!have_corners) return fail("faces without a list of vertex_indices");
            values_.end_element();
            close_face(first, texcoords, mesh);
            if (header_.textures.empty()) continue;
            // Outside of the list, and below 0 for "none": the first, as other readers have it.
            const bool known = texture >= 0 && texture < double(header_.textures.size());
            mesh.face_materials.resize(mesh.face_count(), known ? std::uint32_t(texture) : 0);
        }
        return {};
    }

    bool names_texture(const PlyProperty& p) const {
        return !header_.textures.empty() && !p.list && p.name == "texnumber";
    }

    // Of files with UVs: without any, a picture has no place.
    void materials(Mesh& mesh) {
        if (header_.textures.empty() || mesh.face_count() == 0) return;
        mesh.face_materials.resize(mesh.face_count(), 0);  // of strips
        if (mesh.uvs.empty()) {
            mesh.face_materials.clear();
            scene_.warnings.push_back(name_ + ": a TextureFile without UVs was not taken");
            return;
        }
        for (const std::string& texture : header_.textures) {
            ImageRef image;
            image.name = texture;
            if (pictures_) image.path = pictures_->find(texture);
            Texture sampler;
            sampler.image = std::uint32_t(scene_.images.size());
            Material material;
            material.name = std::filesystem::path(texture).stem().string();
            material.diffuse = glm::vec4(1.0f);
            material.specular = usual_specular(material.shininess);
            material.diffuse_map.texture = std::uint32_t(scene_.textures.size());
            scene_.images.push_back(std::move(image));
            scene_.textures.push_back(sampler);
            scene_.materials.push_back(std::move(material));
        }
        if (pictures_)
            for (std::string& warning : pictures_->warnings())
                scene_.warnings.push_back(std::move(warning));
    }

    Result<void> add_corner(double value, Mesh& mesh) {
        if (!(value >= 0 && value < double(no_index)) || value != std::floor(value))
            return fail("a vertex index that is none", ErrorCode::invalid);
        if (mesh.corner_vertices.size() + 1 >= no_index)
            return fail("more than 2^32 - 2 corners", ErrorCode::limit);
        mesh.corner_vertices.push_back(std::uint32_t(value));
        return {};
    }

    void close_face(std::size_t first, const std::vector<double>& texcoords, Mesh& mesh) {
        const std::size_t corners = mesh.corner_vertices.size() - first;
        if (corners < 3) {
            ++short_faces_;
            mesh.corner_vertices.resize(first);
            return;
        }
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        if (texcoords.size() == 2 * corners) {
            corner_uv_indices_.resize(first, no_index);
            for (std::size_t k = 0; k < corners; ++k) {
                corner_uv_indices_.push_back(std::uint32_t(corner_uvs_.size()));
                corner_uvs_.push_back({float(texcoords[2 * k]), float(1.0 - texcoords[2 * k + 1])});
            }
        }
    }

    // Strips in one list; a negative index begins a new one.
    Result<void> strips(const PlyElement& element, Mesh& mesh) {
        if (element.properties.empty()) return {};
        for (std::uint64_t i = 0; i < element.count; ++i, values_.end_element())
            for (const PlyProperty& p : element.properties) {
                if (!lists_corners(p)) {
                    if (!skip_property(p)) return cut_short(element, i);
                    continue;
                }
                std::uint64_t length = 0;
                if (!list_length(p, length)) return cut_short(element, i);
                std::array<double, 2> last{};
                std::uint64_t run = 0;
                for (std::uint64_t k = 0; k < length; ++k) {
                    double value;
                    if (!values_.next(p.type, value)) return cut_short(element, i);
                    if (value < 0) {
                        run = 0;
                        continue;
                    }
                    if (run >= 2) {
                        const bool odd = run % 2 == 1;
                        for (const double v :
                             {odd ? last[1] : last[0], odd ? last[0] : last[1], value})
                            if (auto done = add_corner(v, mesh); !done) return done;
                        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
                    }
                    last = {last[1], value};
                    ++run;
                }
            }
        return {};
    }

    Result<void> edges(const PlyElement& element, Mesh& mesh) {
        for (std::uint64_t i = 0; i < element.count; ++i) {
            double ends[2] = {-1, -1};
            for (const PlyProperty& p : element.properties) {
                const int end = p.name == "vertex1" ? 0 : p.name == "vertex2" ? 1 : -1;
                if (p.list || end < 0) {
                    if (!skip_property(p)) return cut_short(element, i);
                } else if (!values_.next(p.type, ends[end])) {
                    return cut_short(element, i);
                }
            }
            values_.end_element();
            for (const double v : ends)
                if (!(v >= 0 && v < double(no_index)))
                    return fail("an edge without two vertex indices", ErrorCode::invalid);
            mesh.line_vertices.push_back(std::uint32_t(ends[0]));
            mesh.line_vertices.push_back(std::uint32_t(ends[1]));
            mesh.line_offsets.push_back(std::uint32_t(mesh.line_vertices.size()));
        }
        return {};
    }

    Result<Scene> finish(Mesh& mesh) {
        const std::size_t count = positions_.size();
        for (const auto* list : {&mesh.corner_vertices, &mesh.line_vertices})
            for (const std::uint32_t v : *list)
                if (v >= count)
                    return fail("vertex index " + std::to_string(v) +
                                    " is out of range: the file has " + std::to_string(count),
                                ErrorCode::invalid);
        set_positions(mesh, positions_);
        const auto by_vertex = [&](auto& layer, auto& values) {
            layer.values = std::move(values);
            layer.indices = mesh.corner_vertices;
        };
        const bool faces = mesh.corner_count() > 0;
        if (has_normals_ && faces) by_vertex(mesh.normals, normals_);
        if (has_tangents_ && faces) by_vertex(mesh.tangents, tangents_);
        if (!corner_uvs_.empty()) {
            corner_uv_indices_.resize(mesh.corner_count(), no_index);
            mesh.uvs.push_back({std::move(corner_uvs_), std::move(corner_uv_indices_)});
        } else if (has_uvs_ && faces) {
            by_vertex(mesh.uvs.emplace_back(), uvs_);
        }
        materials(mesh);
        if (has_colors_ && faces) by_vertex(mesh.colors.emplace_back(), colors_);
        if (has_colors_ && !faces) mesh.vertex_colors = std::move(colors_);
        if (!faces && mesh.line_vertices.empty()) {
            mesh.points.resize(count);
            for (std::uint32_t v = 0; v < count; ++v) mesh.points[v] = v;
        }
        if (!faces && (has_normals_ || has_uvs_) && count > 0)
            scene_.warnings.push_back(name_ + ": " +
                                      (has_normals_ && has_uvs_ ? "normals and UVs"
                                       : has_normals_           ? "normals"
                                                                : "UVs") +
                                      " of points were not taken: only faces have them here");
        if (const std::uint64_t lines = values_.long_lines(); lines > 0)
            scene_.warnings.push_back(
                name_ + ": " + std::to_string(lines) + (lines == 1 ? " line has" : " lines have") +
                " more values than the header names: what is beyond was left out");
        if (!not_taken_.empty())
            scene_.warnings.push_back(name_ +
                                      ": properties that were not taken: " + not_taken_.text());
        if (short_faces_)
            scene_.warnings.push_back(name_ + ": " + std::to_string(short_faces_) +
                                      " faces with fewer than three corners were dropped");
        instance_unused_meshes(scene_);
        return std::move(scene_);
    }

    const std::string& name_;
    PictureSearch* pictures_;
    PlyHeader header_;
    Values values_;
    Scene scene_;
    std::vector<glm::dvec3> positions_;
    std::vector<glm::vec3> normals_;
    std::vector<glm::vec2> uvs_, corner_uvs_;
    std::vector<glm::vec4> colors_, tangents_;
    std::vector<std::uint32_t> corner_uv_indices_;
    std::array<PlyType, slot_count> types_{};
    bool have_vertices_ = false, has_normals_ = false, has_colors_ = false, has_uvs_ = false,
         has_tangents_ = false;
    std::uint64_t short_faces_ = 0;
    NameList not_taken_;  // "element property"
};

}  // namespace

Result<Scene> parse_ply(std::span<const std::byte> bytes, const std::string& name) {
    return parse_ply(bytes, name, nullptr);
}

Result<Scene> parse_ply(std::span<const std::byte> bytes, const std::string& name,
                        detail::PictureSearch* pictures) {
    // The header alone decides; what is binary behind it keeps its bytes.
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string_view last = "\rend_header\r";
    if (const std::size_t end = text.find(last);
        end != std::string_view::npos &&
        ends_lines_with_cr(text.substr(0, end + last.size() - 1)) &&
        !text.substr(end + last.size()).starts_with('\n')) {
        const std::size_t head = end + last.size();
        const bool ascii = text.substr(0, head).find("format ascii") != std::string_view::npos;
        std::string mended = with_line_feeds(text.substr(0, ascii ? text.size() : head));
        if (!ascii) mended += text.substr(head);
        return parse_ply(std::as_bytes(std::span(mended)), name, pictures);
    }
    auto header = read_ply_header(bytes, name);
    if (!header) return std::move(header).error();
    return PlyParser(bytes, name, *std::move(header), pictures).run();
}

}  // namespace prep
