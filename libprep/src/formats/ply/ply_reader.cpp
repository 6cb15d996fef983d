#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/parallel.h"
#include "formats/face_colors.h"
#include "formats/loose_points.h"
#include "formats/picture_search.h"
#include "formats/ply/ply.h"
#include "formats/ply/ply_colors.h"
#include "formats/ply/ply_header.h"
#include "formats/ply/ply_records.h"
#include "formats/ply/ply_values.h"
#include "formats/ply/ply_vertices.h"
#include "prep/mesh.h"
#include "text/line_ends.h"
#include "text/name_list.h"

namespace prep {
namespace {

using namespace detail;

class PlyParser {
  public:
    // `by_line`: text with a line for each element is read so (PlyValues::expect_lines).
    PlyParser(std::span<const std::byte> bytes, const std::string& name, PlyHeader header,
              PictureSearch* pictures, int threads, bool by_line)
        : by_line_(by_line),
          name_(name),
          pictures_(pictures),
          threads_(threads),
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
        if (by_line_) values_.expect_lines(elements);
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
    bool has_passed_over_values() const { return values_.long_lines() > 0; }

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

    void leave(const PlyElement& element, const PlyProperty& property) {
        if (element.count > 0) not_taken_.add(element.name + " " + property.name);
    }

    Result<void> skip(const PlyElement& element) {
        for (const PlyProperty& p : element.properties) leave(element, p);
        if (element.properties.empty()) return {};
        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (const PlyProperty& p : element.properties)
                if (!values_.skip(p)) return cut_short(element, i);
            values_.end_element();
        }
        return {};
    }

    Result<void> vertices(const PlyElement& element) {
        if (have_vertices_) return fail("a second element \"vertex\"");
        have_vertices_ = true;
        if (!vertices_.choose(element)) return fail("vertices without x, y and z");
        for (std::size_t p = 0; p < element.properties.size(); ++p)
            if (!vertices_.takes(p)) leave(element, element.properties[p]);
        const std::uint64_t read = vertices_.read(element, header_.encoding, threads_, values_);
        if (read < element.count) return cut_short(element, read);
        return {};
    }

    bool vertices_have_colors() const {
        return std::any_of(header_.elements.begin(), header_.elements.end(),
                           [](const PlyElement& element) {
                               return element.name == "vertex" && PlyColors(element).any();
                           });
    }

    static bool lists_corners(const PlyProperty& p) {
        return p.list && (p.name == "vertex_indices" || p.name == "vertex_index");
    }

    Result<void> faces(const PlyElement& element, Mesh& mesh) {
        std::vector<double> texcoords;
        if (std::count_if(element.properties.begin(), element.properties.end(), lists_corners) > 1)
            return fail("faces with two lists of corners, vertex_index and vertex_indices");
        // One colour has room: of files with both that of the vertices, which is finer.
        const PlyColors colors = vertices_have_colors() ? PlyColors() : PlyColors(element);
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            const PlyProperty& p = element.properties[i];
            if (!lists_corners(p) && !lists_uvs(p) && !names_texture(p) && !colors.channel(i))
                leave(element, p);
        }
        // Strips before them are white.
        if (colors.any()) face_colors_.resize(mesh.face_count(), glm::vec4(1.0f));
        // Strips before them have the first picture.
        if (!header_.textures.empty()) mesh.face_materials.resize(mesh.face_count(), 0);
        if (face_records(element, colors, mesh)) return {};
        for (std::uint64_t f = 0; f < element.count; ++f) {
            const std::size_t first = mesh.corner_vertices.size();
            bool have_corners = false;
            double texture = 0;
            texcoords.clear();
            PlyColors::Row color{};
            for (std::size_t i = 0; i < element.properties.size(); ++i) {
                const PlyProperty& p = element.properties[i];
                if (const std::optional<int> channel = colors.channel(i)) {
                    if (!values_.next(p.type, color[*channel])) return cut_short(element, f);
                    continue;
                }
                const bool corners = lists_corners(p);
                const bool coordinates = lists_uvs(p);
                if (names_texture(p)) {
                    if (!values_.next(p.type, texture)) return cut_short(element, f);
                    continue;
                }
                if (!corners && !coordinates) {
                    if (!values_.skip(p)) return cut_short(element, f);
                    continue;
                }
                std::uint64_t length = 0;
                if (!values_.list_length(p, length)) return cut_short(element, f);
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
            if (colors.any()) face_colors_.resize(mesh.face_count(), colors.linear(color));
            if (header_.textures.empty()) continue;
            mesh.face_materials.resize(mesh.face_count(), material_of(texture));
        }
        return {};
    }

    // Faces of a binary file that all have as many corners as the first, all at once. False, and
    // nothing is taken, where that is not so, or where an index is none: value by value, faces()
    // says which.
    bool face_records(const PlyElement& element, const PlyColors& colors, Mesh& mesh) {
        const auto records = PlyRecords::of(element, header_.encoding, values_.rest());
        if (!records) return false;
        std::optional<std::size_t> corners, uvs, texture;
        std::vector<std::pair<std::size_t, int>> channels;  // property and place in the row
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const PlyProperty& property = element.properties[p];
            if (const std::optional<int> channel = colors.channel(p))
                channels.push_back({p, *channel});
            std::optional<std::size_t>* const found = lists_corners(property)   ? &corners
                                                      : lists_uvs(property)     ? &uvs
                                                      : names_texture(property) ? &texture
                                                                                : nullptr;
            if (!found) continue;
            if (*found) return false;
            *found = p;
        }
        if (!corners || !is_integer(element.properties[*corners].type)) return false;
        const std::size_t n = records->length(*corners);
        const std::size_t first = mesh.corner_vertices.size(), first_face = mesh.face_count();
        if (n < 3 || element.count > (no_index - 1 - first) / n) return false;
        if (uvs && records->length(*uvs) != 2 * n) return false;
        mesh.corner_vertices.resize(first + n * element.count);
        mesh.face_offsets.resize(first_face + element.count + 1);
        const std::size_t first_uv = corner_uvs_.size();
        if (uvs) {
            corner_uv_indices_.resize(first, no_index);
            corner_uv_indices_.resize(mesh.corner_vertices.size());
            corner_uvs_.resize(first_uv + n * element.count);
        }
        if (!header_.textures.empty()) mesh.face_materials.resize(first_face + element.count, 0);
        if (colors.any()) face_colors_.resize(first_face + element.count);
        std::atomic<bool> good = true;
        constexpr std::size_t block = 4096;
        parallel_blocks(element.count, block, threads_, [&](std::size_t begin, std::size_t end) {
            if (!good || !records->alike(begin, end)) {
                good = false;
                return;
            }
            const std::size_t count = end - begin;
            std::vector<std::int64_t> vertices(count);
            for (std::size_t k = 0; k < n; ++k) {
                records->read(*corners, k, begin, end, vertices.data());
                std::uint32_t* to = mesh.corner_vertices.data() + first + n * begin + k;
                std::int64_t outside = 0;
                for (std::size_t i = 0; i < count; ++i, to += n) {
                    outside |= vertices[i] | (std::int64_t(no_index) - 1 - vertices[i]);
                    *to = std::uint32_t(vertices[i]);
                }
                if (outside < 0) good = false;
            }
            for (std::size_t f = begin; f < end; ++f)
                mesh.face_offsets[first_face + f + 1] = std::uint32_t(first + n * (f + 1));
            std::vector<PlyColors::Row> rows(channels.empty() ? 0 : count);
            std::vector<double> values(uvs || texture || !rows.empty() ? count : 0);
            for (const auto& [property, place] : channels) {
                records->read(property, 0, begin, end, values.data());
                for (std::size_t i = 0; i < count; ++i) rows[i][place] = values[i];
            }
            for (std::size_t i = 0; i < rows.size(); ++i)
                face_colors_[first_face + begin + i] = colors.linear(rows[i]);
            for (std::size_t k = 0; uvs && k < 2 * n; ++k) {
                records->read(*uvs, k, begin, end, values.data());
                for (std::size_t i = 0; i < count; ++i) {
                    const std::size_t corner = n * (begin + i) + k / 2;
                    glm::vec2& uv = corner_uvs_[first_uv + corner];
                    k % 2 == 0 ? uv.x = float(values[i]) : uv.y = float(1.0 - values[i]);
                    corner_uv_indices_[first + corner] = std::uint32_t(first_uv + corner);
                }
            }
            if (!texture) return;
            records->read(*texture, 0, begin, end, values.data());
            for (std::size_t i = 0; i < count; ++i)
                mesh.face_materials[first_face + begin + i] = material_of(values[i]);
        });
        if (good) {
            values_.skip(records->size());
            return true;
        }
        mesh.corner_vertices.resize(first);
        mesh.face_offsets.resize(first_face + 1);
        if (uvs) {
            corner_uv_indices_.resize(std::min(corner_uv_indices_.size(), first));
            corner_uvs_.resize(first_uv);
        }
        if (!header_.textures.empty()) mesh.face_materials.resize(first_face);
        if (colors.any()) face_colors_.resize(first_face);
        return false;
    }

    // Below 0, as MeshLab writes "none", the one behind the pictures'; of what the file has no
    // picture for, the next.
    std::uint32_t material_of(double texture) const {
        const std::size_t count = header_.textures.size();
        if (texture < 0) return std::uint32_t(count);
        return std::uint32_t(texture < double(count) ? std::size_t(texture) : count + 1);
    }

    static bool lists_uvs(const PlyProperty& p) { return p.list && p.name == "texcoord"; }

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
        if (pictures_) pictures_->tell(scene_);
        without_picture(mesh);
    }

    void without_picture(Mesh& mesh) {
        const auto none = std::uint32_t(scene_.materials.size());
        std::size_t unknown = 0;
        bool any = false;
        for (std::uint32_t& material : mesh.face_materials) {
            if (material < none) continue;
            any = true;
            unknown += material > none;
            material = none;
        }
        if (!any) return;
        Material& plain = scene_.materials.emplace_back();
        plain.name = "no picture";
        plain.diffuse = glm::vec4(1.0f);
        plain.specular = usual_specular(plain.shininess);
        if (unknown > 0)
            scene_.warnings.push_back(name_ + ": " + std::to_string(unknown) +
                                      (unknown == 1 ? " face has" : " faces have") +
                                      " a texnumber that the file has no picture for: none");
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
        faces_without_uvs_ += !texcoords.empty() && texcoords.size() != 2 * corners;
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
        for (const PlyProperty& p : element.properties)
            if (!lists_corners(p)) leave(element, p);
        for (std::uint64_t i = 0; i < element.count; ++i, values_.end_element())
            for (const PlyProperty& p : element.properties) {
                if (!lists_corners(p)) {
                    if (!values_.skip(p)) return cut_short(element, i);
                    continue;
                }
                std::uint64_t length = 0;
                if (!values_.list_length(p, length)) return cut_short(element, i);
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
        for (const PlyProperty& p : element.properties)
            if (p.list || (p.name != "vertex1" && p.name != "vertex2")) leave(element, p);
        for (std::uint64_t i = 0; i < element.count; ++i) {
            double ends[2] = {-1, -1};
            for (const PlyProperty& p : element.properties) {
                const int end = p.name == "vertex1" ? 0 : p.name == "vertex2" ? 1 : -1;
                if (p.list || end < 0) {
                    if (!values_.skip(p)) return cut_short(element, i);
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

    // The first index that is not below `count`.
    std::optional<std::uint32_t> first_beyond(std::span<const std::uint32_t> indices,
                                              std::size_t count) const {
        std::atomic<bool> within = true;
        constexpr std::size_t block = 1 << 16;
        parallel_blocks(indices.size(), block, threads_, [&](std::size_t begin, std::size_t end) {
            std::uint32_t largest = 0;
            for (std::size_t i = begin; i < end; ++i) largest = std::max(largest, indices[i]);
            if (largest >= count) within = false;
        });
        if (within) return std::nullopt;
        return *std::find_if(indices.begin(), indices.end(),
                             [&](std::uint32_t v) { return v >= count; });
    }

    // Where corners have none of their own.
    void take_uvs_of_vertices(const Mesh& mesh) {
        if (std::find(corner_uv_indices_.begin(), corner_uv_indices_.end(), no_index) ==
            corner_uv_indices_.end()) {
            scene_.remarks.push_back(name_ + ": UVs of vertices were left out: faces have theirs");
            return;
        }
        const std::size_t own = corner_uvs_.size();
        corner_uvs_.insert(corner_uvs_.end(), vertices_.uvs.begin(), vertices_.uvs.end());
        for (std::size_t c = 0; c < mesh.corner_count(); ++c)
            if (corner_uv_indices_[c] == no_index)
                corner_uv_indices_[c] = std::uint32_t(own + mesh.corner_vertices[c]);
        scene_.warnings.push_back(name_ +
                                  ": UVs of vertices were taken where faces have none alone");
    }

    Result<Scene> finish(Mesh& mesh) {
        const std::size_t count = vertices_.size();
        for (const auto* list : {&mesh.corner_vertices, &mesh.line_vertices})
            if (const auto v = first_beyond(*list, count))
                return fail("vertex index " + std::to_string(*v) +
                                " is out of range: the file has " + std::to_string(count),
                            ErrorCode::invalid);
        vertices_.move_positions(mesh);
        const auto by_vertex = [&](auto& layer, auto& values) {
            layer.values = std::move(values);
            layer.indices = mesh.corner_vertices;
        };
        const bool faces = mesh.corner_count() > 0;
        if (vertices_.has_normals && faces) by_vertex(mesh.normals, vertices_.normals);
        if (vertices_.has_tangents && faces) by_vertex(mesh.tangents, vertices_.tangents);
        if (!corner_uvs_.empty()) {
            corner_uv_indices_.resize(mesh.corner_count(), no_index);
            if (vertices_.has_uvs) take_uvs_of_vertices(mesh);
            mesh.uvs.push_back({std::move(corner_uvs_), std::move(corner_uv_indices_)});
        } else if (vertices_.has_uvs && faces) {
            by_vertex(mesh.uvs.emplace_back(), vertices_.uvs);
        }
        materials(mesh);
        if (vertices_.has_colors && (!faces || !mesh.line_vertices.empty()))
            mesh.vertex_colors = vertices_.colors;
        if (vertices_.has_colors && faces) by_vertex(mesh.colors.emplace_back(), vertices_.colors);
        if (!face_colors_.empty()) set_face_colors(mesh, std::move(face_colors_));
        if (!faces && mesh.line_vertices.empty()) {
            mesh.points.resize(count);
            for (std::uint32_t v = 0; v < count; ++v) mesh.points[v] = v;
        }
        if (!faces && (vertices_.has_normals || vertices_.has_uvs) && count > 0)
            scene_.warnings.push_back(
                name_ + values_of_points_left_out(vertices_.has_normals, vertices_.has_uvs));
        if (const std::uint64_t lines = values_.long_lines(); lines > 0)
            scene_.warnings.push_back(
                name_ + ": " + std::to_string(lines) + (lines == 1 ? " line has" : " lines have") +
                " more values than the header names: what is beyond was left out");
        if (!not_taken_.empty())
            scene_.warnings.push_back(name_ +
                                      ": properties that were not taken: " + not_taken_.text());
        if (faces_without_uvs_ > 0)
            scene_.warnings.push_back(name_ + ": " + std::to_string(faces_without_uvs_) +
                                      (faces_without_uvs_ == 1 ? " face has" : " faces have") +
                                      " a texcoord list of another length than two a corner: left "
                                      "out");
        if (const std::size_t more = values_.left_over(); more > 0)
            scene_.warnings.push_back(name_ + ": " + std::to_string(more) +
                                      (more == 1 ? " byte" : " bytes") +
                                      " after the last element were left out");
        if (short_faces_)
            scene_.warnings.push_back(name_ + ": " + std::to_string(short_faces_) +
                                      " faces with fewer than three corners were dropped");
        instance_unused_meshes(scene_);
        return std::move(scene_);
    }

    bool by_line_;
    const std::string& name_;
    PictureSearch* pictures_;
    int threads_;
    PlyHeader header_;
    PlyValues values_;
    Scene scene_;
    bool have_vertices_ = false;
    PlyVertices vertices_;
    std::vector<glm::vec2> corner_uvs_;
    std::vector<std::uint32_t> corner_uv_indices_;
    std::vector<glm::vec4> face_colors_;  // empty, or of all faces up to the last with colours
    std::uint64_t short_faces_ = 0, faces_without_uvs_ = 0;
    NameList not_taken_;  // "element property"
};

}  // namespace

Result<Scene> parse_ply(std::span<const std::byte> bytes, const std::string& name) {
    return parse_ply(bytes, name, nullptr, 0);
}

Result<Scene> parse_ply(std::span<const std::byte> bytes, const std::string& name,
                        detail::PictureSearch* pictures, int threads) {
    // The header alone decides; what is binary behind it keeps its bytes.
    const std::string_view text =
        without_byte_order_mark({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    bytes = std::as_bytes(std::span(text));
    const std::string_view last = "\rend_header\r";
    if (const std::size_t end = text.find(last);
        end != std::string_view::npos &&
        ends_lines_with_cr(text.substr(0, end + last.size() - 1)) &&
        !text.substr(end + last.size()).starts_with('\n')) {
        const std::size_t head = end + last.size();
        const bool ascii = text.substr(0, head).find("format ascii") != std::string_view::npos;
        std::string mended = with_line_feeds(text.substr(0, ascii ? text.size() : head));
        if (!ascii) mended += text.substr(head);
        return parse_ply(std::as_bytes(std::span(mended)), name, pictures, threads);
    }
    auto header = read_ply_header(bytes, name);
    if (!header) return std::move(header).error();
    PlyParser by_line(bytes, name, *header, pictures, threads, true);
    Result<Scene> scene = by_line.run();
    if (scene || !by_line.has_passed_over_values()) return scene;
    // Of several elements on a line and one on several lines there can be as many lines as
    // elements.
    Result<Scene> by_value =
        PlyParser(bytes, name, *std::move(header), pictures, threads, false).run();
    return by_value ? std::move(by_value) : std::move(scene);
}

}  // namespace prep
