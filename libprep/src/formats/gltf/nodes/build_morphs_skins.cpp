#include "formats/gltf/nodes/build_morphs_skins.h"

#include <algorithm>
#include <cmath>

#include "model/vertex_deltas.h"
#include "text/utf8.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// The file's own vertex of each of the primitive's, whose targets and influences it has.
std::vector<Index> file_vertices(const PrimitiveVertices& v, bool of_corners) {
    const VertexMesh& mesh = v.prepared.meshes[v.mesh];
    const Mesh& faces = v.prepared.scene.meshes[v.mesh];
    std::vector<Index> out(v.count);
    for (std::size_t i = 0; i < v.count; ++i) {
        const Index vertex = v.at(i), corner = mesh.source_corners[vertex];
        out[i] = of_corners && corner != no_index ? faces.corner_file_vertex(corner)
                                                  : faces.file_vertex(mesh.source_vertices[vertex]);
    }
    return out;
}

std::vector<glm::vec3> deltas_at(const std::vector<VertexDeltas>& runs,
                                 const std::vector<Index>& vertices) {
    std::vector<glm::vec3> out(vertices.size(), glm::vec3(0.0f));
    for (std::size_t i = 0; i < vertices.size(); ++i)
        if (const glm::vec3* d = delta_of(runs, vertices[i]); d && finite(*d)) out[i] = *d;
    return out;
}

std::size_t add_deltas(const std::vector<glm::vec3>& deltas, Json& document, GltfBuffer& buffer) {
    std::vector<Index> moved;
    for (Index i = 0; i < deltas.size(); ++i)
        if (deltas[i] != glm::vec3(0.0f)) moved.push_back(i);
    const bool narrow = deltas.size() <= 65536;
    std::size_t accessor = 0;
    if (moved.size() * (narrow ? 14 : 16) < deltas.size() * 12) {
        Json out{{"componentType", 5126}, {"count", deltas.size()}, {"type", "VEC3"}};
        if (!moved.empty()) {
            std::vector<glm::vec3> values;
            for (const Index i : moved) values.push_back(deltas[i]);
            std::vector<std::uint16_t> small(moved.begin(), moved.end());
            const std::size_t indices = buffer.add_view(
                narrow ? std::as_bytes(std::span(small)) : std::as_bytes(std::span(moved)), 0);
            const std::size_t view = buffer.add_view(std::as_bytes(std::span(values)), 0);
            out["sparse"] = {
                {"count", moved.size()},
                {"indices", {{"bufferView", indices}, {"componentType", narrow ? 5123 : 5125}}},
                {"values", {{"bufferView", view}}}};
        }
        accessor = buffer.push("accessors", std::move(out));
    } else {
        accessor = buffer.add_floats(&deltas[0].x, deltas.size(), 3);
    }
    glm::vec3 low = deltas[0], high = deltas[0];
    for (const glm::vec3& d : deltas) {
        low = glm::min(low, d);
        high = glm::max(high, d);
    }
    document["accessors"][accessor]["min"] = array3(low);
    document["accessors"][accessor]["max"] = array3(high);
    return accessor;
}

std::vector<glm::vec3> finite_at(const PrimitiveVertices& v, const std::vector<glm::vec3>& values) {
    std::vector<glm::vec3> out(v.count);
    for (std::size_t i = 0; i < v.count; ++i)
        out[i] = finite(values[v.at(i)]) ? values[v.at(i)] : glm::vec3(0.0f);
    return out;
}

}  // namespace

void add_influences(const PrimitiveVertices& v, GltfBuffer& buffer, Json& attributes) {
    const Mesh& mesh = v.prepared.scene.meshes[v.mesh];
    const std::size_t sets = mesh.skin_influences.size();
    if (sets == 0 || v.count == 0) return;
    const std::vector<Index> vertices = file_vertices(v, false);
    std::vector<std::vector<glm::vec<4, std::uint16_t>>> joints(sets);
    std::vector<std::vector<glm::vec4>> weights(sets);
    for (std::size_t s = 0; s < sets; ++s) {
        joints[s].assign(v.count, glm::vec<4, std::uint16_t>(0));
        weights[s].assign(v.count, glm::vec4(0.0f));
    }
    Index most = 0;
    for (std::size_t i = 0; i < v.count; ++i) {
        double sum = 0;
        const auto each = [&](const auto& body) {
            for (std::size_t s = 0; s < sets; ++s) {
                const SkinInfluences& set = mesh.skin_influences[s];
                if (vertices[i] >= set.joints.size() || vertices[i] >= set.weights.size()) continue;
                for (int k = 0; k < 4; ++k) {
                    const float w = set.weights[vertices[i]][k];
                    if (w > 0 && std::isfinite(w)) body(s, k, set.joints[vertices[i]][k], w);
                }
            }
        };
        each([&](std::size_t, int, Index, float w) { sum += double(w); });
        each([&](std::size_t s, int k, Index joint, float w) {
            joints[s][i][k] = std::uint16_t(joint);
            weights[s][i][k] = float(double(w) / sum);
            most = std::max(most, joint);
        });
        if (!(sum > 0)) weights[0][i][0] = 1;
    }
    for (std::size_t s = 0; s < sets; ++s) {
        const std::string number = std::to_string(s);
        Json accessor{
            {"componentType", most < 256 ? 5121 : 5123}, {"count", v.count}, {"type", "VEC4"}};
        if (most < 256) {
            std::vector<std::uint8_t> small;
            for (const auto& four : joints[s])
                for (int k = 0; k < 4; ++k) small.push_back(std::uint8_t(four[k]));
            accessor["bufferView"] =
                buffer.add_view(std::as_bytes(std::span(small)), GltfBuffer::array_buffer);
        } else {
            accessor["bufferView"] =
                buffer.add_view(std::as_bytes(std::span(joints[s])), GltfBuffer::array_buffer);
        }
        attributes["JOINTS_" + number] = buffer.push("accessors", std::move(accessor));
        attributes["WEIGHTS_" + number] = buffer.add_floats(&weights[s][0].x, v.count, 4);
    }
}

void add_targets(const PrimitiveVertices& v, const Json& attributes, Json& document,
                 GltfBuffer& buffer, Json& primitive) {
    const Mesh& mesh = v.prepared.scene.meshes[v.mesh];
    if (mesh.morph_targets.empty() || v.count == 0) return;
    const std::vector<Index> of_vertices = file_vertices(v, false);
    const std::vector<Index> of_corners = file_vertices(v, true);
    const bool made = v.mesh < v.prepared.morphs.size() &&
                      v.prepared.morphs[v.mesh].size() == mesh.morph_targets.size();
    Json targets = Json::array();  // put in last: a new member moves the others
    for (std::size_t t = 0; t < mesh.morph_targets.size(); ++t) {
        const MorphTarget& target = mesh.morph_targets[t];
        const MorphDeltas none;
        const MorphDeltas& own = made ? v.prepared.morphs[v.mesh][t] : none;
        Json out;
        out["POSITION"] = add_deltas(deltas_at(target.positions, of_vertices), document, buffer);
        const auto add = [&](const char* name, const std::vector<glm::vec3>& computed,
                             const std::vector<VertexDeltas>& of_file) {
            if (!attributes.contains(name)) return;
            if (!computed.empty())
                out[name] = add_deltas(finite_at(v, computed), document, buffer);
            else if (!of_file.empty())
                out[name] = add_deltas(deltas_at(of_file, of_corners), document, buffer);
        };
        add("NORMAL", own.normals, target.normals);
        add("TANGENT", own.tangents, target.tangents);
        targets.push_back(std::move(out));
    }
    // All targets of a primitive have the same attributes in the readers that people use.
    for (const char* name : {"NORMAL", "TANGENT"}) {
        bool any = false;
        for (const Json& target : targets) any |= target.contains(name);
        if (!any) continue;
        std::size_t zeros = 0;
        bool there = false;
        for (Json& target : targets) {
            if (target.contains(name)) continue;
            if (!there)
                zeros =
                    add_deltas(std::vector<glm::vec3>(v.count, glm::vec3(0.0f)), document, buffer);
            there = true;
            target[name] = zeros;
        }
    }
    primitive["targets"] = std::move(targets);
}

void add_target_members(const Mesh& mesh, Json& out) {
    if (mesh.morph_targets.empty()) return;
    bool named = false;
    Json weights = Json::array(), names = Json::array();
    for (const MorphTarget& target : mesh.morph_targets) {
        weights.push_back(target.weight);
        names.push_back(as_utf8(target.name));
        named |= !target.name.empty();
    }
    out["weights"] = std::move(weights);
    if (named) out["extras"]["targetNames"] = std::move(names);
}

}  // namespace prep::detail
