#include "formats/gltf/build.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "base/finite.h"
#include "formats/gltf/materials/material_writer.h"
#include "formats/gltf/nodes/build_morphs_skins.h"
#include "formats/gltf/nodes/build_nodes.h"
#include "formats/gltf/nodes/far_plane.h"
#include "formats/gltf/references.h"
#include "text/note_once.h"
#include "text/utf8.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

class Builder {
  public:
    Builder(const PreparedScene& prepared, Json& document, GltfBuffer& buffer,
            std::vector<std::string>& notes)
        : prepared_(prepared),
          scene_(prepared.scene),
          document_(document),
          buffer_(buffer),
          notes_(notes) {}

    void run() {
        materials_.choose_variants();
        meshes();
        materials_.write();
        lights();
        cameras();
        build_nodes(prepared_, {mesh_index_, light_index_}, document_, buffer_, notes_);
        materials_.note_unread();
        for (const auto& [count, what] :
             {std::pair(dropped_[2], "triangle"), std::pair(dropped_[1], "line segment"),
              std::pair(dropped_[0], "point")})
            if (count > 0) notes_.push_back(non_finite_note(count, what));
        for (const std::string& name : extensions_) document_["extensionsUsed"].push_back(name);
    }

  private:
    void meshes() {
        mesh_index_.assign(scene_.meshes.size(), no_index);
        for (Index m = 0; m < scene_.meshes.size(); ++m) {
            Json primitives = Json::array();
            const VertexMesh& mesh = prepared_.meshes[m];
            all_finite_ = all_finite(floats_of(mesh.positions));
            mended_uvs_.clear();
            // Sets are numbered without gaps: zeros before one that is there.
            for (const auto& uvs : mesh.uvs)
                mended_uvs_.push_back(uvs.empty()     ? std::vector<glm::vec2>(mesh.vertex_count())
                                      : are_good(uvs) ? std::vector<glm::vec2>()
                                                      : mended(uvs));
            mended_colors_.clear();
            for (const auto& colors : mesh.colors)
                mended_colors_.push_back(are_good(colors) ? std::vector<glm::vec4>()
                                                          : mended(colors));
            for (const VertexMesh::Range& range : mesh.ranges) {
                const std::span<const Index> whole(
                    mesh.indices.data() + 3 * std::size_t(range.first_triangle),
                    3 * std::size_t(range.triangle_count));
                add_finite_primitive(m, whole, 3, 4, range.material, primitives);
            }
            add_finite_primitive(m, mesh.lines, 2, 1, no_index, primitives);
            add_finite_primitive(m, mesh.points, 1, 0, no_index, primitives);
            if (primitives.empty()) {
                note_once(notes_,
                          "mesh '" + scene_.meshes[m].name + "' has nothing to draw: left out");
                continue;
            }
            Json out{{"primitives", std::move(primitives)}};
            if (!scene_.meshes[m].name.empty()) out["name"] = as_utf8(scene_.meshes[m].name);
            add_target_members(scene_.meshes[m], out);
            mesh_index_[m] = Index(buffer_.push("meshes", std::move(out)));
        }
    }

    // Without those of `group` vertices each of which one is not finite.
    void add_finite_primitive(Index m, std::span<const Index> indices, std::size_t group, int mode,
                              Index material, Json& primitives) {
        if (all_finite_) {
            add_primitive(m, indices, mode, material, primitives);
            return;
        }
        const VertexMesh& mesh = prepared_.meshes[m];
        std::vector<Index> kept;
        kept.reserve(indices.size());
        for (std::size_t i = 0; i < indices.size(); i += group) {
            const std::span<const Index> one = indices.subspan(i, group);
            if (std::all_of(one.begin(), one.end(),
                            [&](Index v) { return is_finite(mesh.positions[v]); }))
                kept.insert(kept.end(), one.begin(), one.end());
            else
                ++dropped_[group - 1];
        }
        add_primitive(m, kept, mode, material, primitives);
    }

    void add_primitive(Index m, std::span<const Index> indices, int mode, Index material,
                       Json& primitives) {
        if (indices.empty()) return;
        const VertexMesh& mesh = prepared_.meshes[m];
        // The vertices that this primitive uses, in their order. Where it uses all, the mesh's own
        // lists are what is written.
        std::vector<Index> used, local;
        const bool all = all_finite_ && mesh.ranges.size() == 1 && mesh.lines.empty() &&
                         mesh.points.empty() && indices.size() == mesh.indices.size();
        if (!all) {
            local.assign(indices.begin(), indices.end());
            used = number_anew(local);
            indices = local;
        }
        const std::size_t count = all ? mesh.vertex_count() : used.size();
        const auto add = [&](const auto& values, int width, bool lent = true) {
            using T = std::decay_t<decltype(values[0])>;
            if (all && lent) return buffer_.lend_floats(&values[0].x, count, width);
            if (all) return buffer_.add_floats(&values[0].x, count, width);
            std::vector<T> gathered(count);
            for (std::size_t i = 0; i < count; ++i) gathered[i] = values[used[i]];
            return buffer_.add_floats(&gathered[0].x, count, width);
        };
        Json attributes;
        const std::size_t position = add(mesh.positions, 3);
        set_bounds(mesh, used, all, position);
        attributes["POSITION"] = position;
        const bool faces = mode == 4;
        if (faces && !mesh.normals.empty()) attributes["NORMAL"] = add(mesh.normals, 3);
        if (faces && !mesh.tangents.empty() && !mesh.normals.empty())
            attributes["TANGENT"] = add(mesh.tangents, 4);
        const auto add_mended = [&](const auto& values, const auto& mended, int width) {
            return mended.empty() ? add(values, width) : add(mended, width, false);
        };
        if (faces)
            for (std::size_t s = 0; s < mesh.uvs.size(); ++s)
                attributes["TEXCOORD_" + std::to_string(s)] =
                    add_mended(mesh.uvs[s], mended_uvs_[s], 2);
        for (std::size_t s = 0; s < mesh.colors.size(); ++s)
            attributes["COLOR_" + std::to_string(s)] =
                add_mended(mesh.colors[s], mended_colors_[s], 4);
        const PrimitiveVertices vertices{prepared_, m, all ? std::span<const Index>() : used,
                                         count};
        add_influences(vertices, buffer_, attributes);
        Json primitive{{"attributes", std::move(attributes)}};
        add_targets(vertices, primitive["attributes"], document_, buffer_, primitive);
        primitive["indices"] =
            buffer_.add_indices(indices, count, indices.data() == mesh.indices.data());
        if (material < scene_.materials.size())
            primitive["material"] = materials_.variant_for(mesh, material);
        if (mode != 4) primitive["mode"] = mode;
        primitives.push_back(std::move(primitive));
    }

    void set_bounds(const VertexMesh& mesh, const std::vector<Index>& used, bool all,
                    std::size_t accessor) {
        const std::size_t count = all ? mesh.vertex_count() : used.size();
        glm::vec3 low = mesh.positions[all ? 0 : used[0]], high = low;
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec3& p = mesh.positions[all ? i : used[i]];
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        document_["accessors"][accessor]["min"] = array3(low);
        document_["accessors"][accessor]["max"] = array3(high);
    }

    static bool are_good(const std::vector<glm::vec2>& uvs) {
        return std::all_of(uvs.begin(), uvs.end(),
                           [](const glm::vec2& uv) { return is_finite(uv); });
    }
    static bool are_good(const std::vector<glm::vec4>& colors) {
        return std::all_of(colors.begin(), colors.end(), [](const glm::vec4& c) {
            return c.r >= 0 && c.r <= 1 && c.g >= 0 && c.g <= 1 && c.b >= 0 && c.b <= 1 &&
                   c.a >= 0 && c.a <= 1;
        });
    }

    std::vector<glm::vec2> mended(const std::vector<glm::vec2>& uvs) {
        std::vector<glm::vec2> out = uvs;
        for (glm::vec2& uv : out)
            if (!is_finite(uv)) {
                uv = glm::vec2(0.0f);
                note_once(notes_, "UVs that are not finite were written as 0");
            }
        return out;
    }

    std::vector<glm::vec4> mended(const std::vector<glm::vec4>& colors) {
        std::vector<glm::vec4> out = colors;
        for (glm::vec4& c : out)
            for (int k = 0; k < 4; ++k)
                if (!(c[k] >= 0 && c[k] <= 1)) {
                    c[k] = c[k] > 1 ? 1.0f : 0.0f;
                    note_once(notes_, "vertex colours outside 0 … 1 were clamped");
                }
        return out;
    }

    void lights() {
        light_index_.assign(scene_.lights.size(), no_index);
        Json list = Json::array();
        std::uint64_t ambient = 0;
        for (Index l = 0; l < scene_.lights.size(); ++l) {
            const Light& light = scene_.lights[l];
            if (light.kind == LightKind::ambient) {
                ++ambient;
                continue;
            }
            // Colours end at 1, intensities nowhere.
            const float brightest = std::max({light.color.r, light.color.g, light.color.b, 1.0f});
            Json out{{"type", light.kind == LightKind::directional ? "directional"
                              : light.kind == LightKind::point     ? "point"
                                                                   : "spot"},
                     {"color", array3(glm::clamp(light.color / brightest, 0.0f, 1.0f))},
                     {"intensity", std::max(light.intensity, 0.0f) * brightest}};
            if (!light.name.empty()) out["name"] = as_utf8(light.name);
            if (light.range > 0 && light.kind != LightKind::directional) out["range"] = light.range;
            // The nearest float to a quarter turn, the widest there is, lies above it.
            const float widest = std::nextafter(float(std::numbers::pi / 2), 0.0f);
            if (light.kind == LightKind::spot)
                out["spot"] = {{"innerConeAngle", light.inner_cone},
                               {"outerConeAngle", std::min(light.outer_cone, widest)}};
            light_index_[l] = Index(list.size());
            list.push_back(std::move(out));
        }
        if (ambient > 0)
            notes_.push_back(std::to_string(ambient) +
                             (ambient == 1 ? " ambient light" : " ambient lights") +
                             " left out: glTF has none");
        if (list.empty()) return;
        extensions_.insert("KHR_lights_punctual");
        document_["extensions"]["KHR_lights_punctual"]["lights"] = std::move(list);
    }

    void cameras() {
        const FarPlanes far_planes(prepared_);
        for (std::size_t c = 0; c < scene_.cameras.size(); ++c) {
            const Camera& camera = scene_.cameras[c];
            Json out;
            if (!camera.name.empty()) out["name"] = as_utf8(camera.name);
            out["type"] = camera.perspective ? "perspective" : "orthographic";
            Json& lens = out[camera.perspective ? "perspective" : "orthographic"];
            if (camera.perspective) {
                lens["yfov"] = camera.yfov;
                if (camera.aspect > 0) lens["aspectRatio"] = camera.aspect;
                lens["znear"] = camera.znear;
                if (camera.zfar > camera.znear) lens["zfar"] = camera.zfar;
            } else {
                // glTF has no camera without a width: a square picture's.
                lens["xmag"] = camera.xmag != 0 ? camera.xmag : camera.ymag;
                lens["ymag"] = camera.ymag;
                lens["znear"] = camera.znear;
                lens["zfar"] = far_planes.of(c);
            }
            buffer_.push("cameras", std::move(out));
        }
    }

    const PreparedScene& prepared_;
    const Scene& scene_;
    Json& document_;
    GltfBuffer& buffer_;
    std::vector<std::string>& notes_;
    std::array<std::uint64_t, 3> dropped_{};  // points, line segments, triangles
    bool all_finite_ = false;                 // the positions of the mesh at hand
    // Of the mesh at hand, in place of those that files must not hold; empty: there are none.
    std::vector<std::vector<glm::vec2>> mended_uvs_;
    std::vector<std::vector<glm::vec4>> mended_colors_;
    std::vector<Index> mesh_index_, light_index_;
    std::set<std::string> extensions_;
    MaterialWriter materials_{prepared_, buffer_, notes_, extensions_};
};

}  // namespace

void build_gltf(const PreparedScene& prepared, Json& document, GltfBuffer& buffer,
                std::vector<std::string>& notes) {
    Builder(prepared, document, buffer, notes).run();
}

}  // namespace prep::detail
