#include "formats/gltf/nodes/build_nodes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "formats/gltf/nodes/sheared_matrix.h"
#include "model/trs.h"
#include "text/utf8.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

class NodeBuilder {
  public:
    NodeBuilder(const PreparedScene& prepared, const WrittenParts& written, Json& document,
                GltfBuffer& buffer, std::vector<std::string>& notes)
        : prepared_(prepared),
          scene_(prepared.scene),
          written_(written),
          document_(document),
          buffer_(buffer),
          notes_(notes) {}

    void run() {
        for (const Animation& animation : scene_.animations)
            for (const AnimationChannel& channel : animation.channels)
                if (channel.path != AnimationPath::weights) animated_.insert(channel.node);
        nodes();
        animations();
        note(lost_channels_, "animation channel", "animation channels",
             "without keys or a node to move left out");
        note(lost_skins_, "skin", "skins",
             "without joints, or of a mesh without weights, left out");
    }

  private:
    void note(std::uint64_t count, const char* one, const char* many, const char* rest) {
        if (count > 0)
            notes_.push_back(std::to_string(count) + ' ' + (count == 1 ? one : many) + ' ' + rest);
    }

    static void numbers(const Trs& t, Json& out) {
        if (t.translation != glm::dvec3(0.0)) out["translation"] = array3(t.translation);
        if (t.rotation != glm::dquat(1, 0, 0, 0))
            out["rotation"] = {t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w};
        if (t.scale != glm::dvec3(1.0)) out["scale"] = array3(t.scale);
    }

    // As numbers that move, where the node has them so or moves; else its matrix.
    static void transform(const Node& node, bool moves, Json& out) {
        if (node.transform == glm::dmat4(1.0) && !moves) return;
        if (node.trs) return numbers(*node.trs, out);
        if (moves || largest(node.transform) > largest_matrix)
            return numbers(trs_of(node.transform), out);
        Json matrix = Json::array();
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r) matrix.push_back(node.transform[c][r]);
        out["matrix"] = std::move(matrix);
    }

    // The format's validator compares matrices with what they are made of by roundings of floats,
    // whatever their size.
    static constexpr double largest_matrix = 100;
    static double largest(const glm::dmat4& matrix) {
        double most = 0;
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) most = std::max(most, std::abs(matrix[c][r]));
        return most;
    }
    // Shear cannot move: what moves is taken for its nearest numbers.
    bool needs_two(Index n) const {
        const Node& node = scene_.nodes[n];
        return !node.trs && !animated_.contains(n) && !is_scaled_rotation(node.transform);
    }

    void nodes() {
        const std::size_t count = scene_.nodes.size();
        mesh_nodes_.assign(count, no_index);
        Json roots = Json::array();
        std::vector<Json> children(count, Json::array());
        std::vector<Json> more;      // behind the scene's own
        std::map<Index, Trs> turns;  // what is left to nodes within one of those
        for (Index n = 0; n < count; ++n) {
            const Node& node = scene_.nodes[n];
            Json& siblings = node.parent == no_index ? roots : children[node.parent];
            if (!needs_two(n)) {
                siblings.push_back(n);
                continue;
            }
            const auto [outer, inner] = as_two_nodes(node.transform);
            siblings.push_back(count + more.size());
            Json around{{"children", {n}}};
            numbers(outer, around);
            more.push_back(std::move(around));
            turns.emplace(n, inner);
        }
        for (Index n = 0; n < count; ++n) {
            const Node& node = scene_.nodes[n];
            const bool moves = animated_.contains(n);
            Json out = Json::object();
            if (!node.name.empty()) out["name"] = as_utf8(node.name);
            if (const auto turn = turns.find(n); turn != turns.end())
                numbers(turn->second, out);
            else
                transform(node, moves, out);
            if (node.camera != no_index) out["camera"] = node.camera;
            if (node.light != no_index && written_.lights[node.light] != no_index)
                out["extensions"]["KHR_lights_punctual"]["light"] = written_.lights[node.light];
            if (node.mesh != no_index && written_.meshes[node.mesh] != no_index) {
                const Index mesh = written_.meshes[node.mesh];
                const glm::dvec3 origin = prepared_.meshes[node.mesh].origin;
                const Index skin = skin_of(node, origin);
                if (skin != no_index) {  // whose joints place the mesh, wherever the node is
                    out["mesh"] = mesh;
                    out["skin"] = skin;
                    mesh_nodes_[n] = n;
                } else if (origin == glm::dvec3(0.0)) {
                    out["mesh"] = mesh;
                    mesh_nodes_[n] = n;
                } else if (node.transform == glm::dmat4(1.0) && children[n].empty() && !moves) {
                    // Doubles in JSON keep what float positions could not.
                    out["translation"] = array3(origin);
                    out["mesh"] = mesh;
                    mesh_nodes_[n] = n;
                } else {
                    mesh_nodes_[n] = Index(count + more.size());
                    children[n].push_back(count + more.size());
                    more.push_back(Json{{"translation", array3(origin)}, {"mesh", mesh}});
                }
            }
            if (!children[n].empty()) out["children"] = children[n];
            buffer_.push("nodes", std::move(out));
        }
        for (Json& node : more) buffer_.push("nodes", std::move(node));
        document_["scene"] = 0;
        Json out_scene = Json::object();
        if (!roots.empty()) out_scene["nodes"] = std::move(roots);
        if (!scene_.name.empty()) out_scene["name"] = as_utf8(scene_.name);
        buffer_.push("scenes", std::move(out_scene));
    }

    // A skin for each origin that the meshes of a skin have: positions are relative to it.
    Index skin_of(const Node& node, const glm::dvec3& origin) {
        if (node.skin >= scene_.skins.size()) return no_index;
        const auto key = std::tuple(node.skin, origin.x, origin.y, origin.z);
        const auto known = skins_.find(key);
        if (known != skins_.end()) return known->second;
        const Skin& skin = scene_.skins[node.skin];
        Index made = no_index;
        const bool joints =
            !skin.joints.empty() && std::all_of(skin.joints.begin(), skin.joints.end(),
                                                [&](Index j) { return j < scene_.nodes.size(); });
        if (!joints || scene_.meshes[node.mesh].skin_influences.empty()) {
            ++lost_skins_;
        } else {
            Json out;
            if (!skin.name.empty()) out["name"] = as_utf8(skin.name);
            out["joints"] = skin.joints;
            std::vector<glm::mat4> matrices;
            for (std::size_t j = 0; j < skin.joints.size(); ++j) {
                glm::dmat4 m(j < skin.inverse_bind.size() ? skin.inverse_bind[j] : glm::mat4(1.0f));
                m[3] = m * glm::dvec4(origin, 1);
                matrices.emplace_back(m);
                // The last row of a matrix that places points; products leave it off by roundings.
                for (int c = 0; c < 4; ++c) matrices.back()[c][3] = c == 3 ? 1.0f : 0.0f;
            }
            const std::size_t view = buffer_.add_view(std::as_bytes(std::span(matrices)), 0);
            out["inverseBindMatrices"] = buffer_.push("accessors", Json{{"bufferView", view},
                                                                        {"componentType", 5126},
                                                                        {"count", matrices.size()},
                                                                        {"type", "MAT4"}});
            made = Index(buffer_.push("skins", std::move(out)));
        }
        skins_.emplace(key, made);
        return made;
    }

    // Samplers share what they have in common, as the scene's do.
    std::size_t floats(const std::shared_ptr<const std::vector<float>>& values, int width,
                       bool bounds) {
        const auto known = accessors_.find({values.get(), width});
        if (known != accessors_.end()) return known->second;
        static const char* const types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
        const std::size_t view = buffer_.add_view(std::as_bytes(std::span(*values)), 0);
        Json out{{"bufferView", view},
                 {"componentType", 5126},
                 {"count", values->size() / std::size_t(width)},
                 {"type", types[width]}};
        if (bounds) {
            const auto [low, high] = std::minmax_element(values->begin(), values->end());
            out["min"] = Json::array({*low});
            out["max"] = Json::array({*high});
        }
        const std::size_t accessor = buffer_.push("accessors", std::move(out));
        accessors_.emplace(std::pair(values.get(), width), accessor);
        return accessor;
    }

    void animations() {
        for (const Animation& animation : scene_.animations) {
            Json channels = Json::array(), samplers = Json::array();
            for (const AnimationChannel& channel : animation.channels) {
                const char* path = channel.path == AnimationPath::translation ? "translation"
                                   : channel.path == AnimationPath::rotation  ? "rotation"
                                   : channel.path == AnimationPath::scale     ? "scale"
                                   : channel.path == AnimationPath::weights   ? "weights"
                                                                              : nullptr;
                const bool there = path && channel.sampler < animation.samplers.size() &&
                                   channel.node < scene_.nodes.size();
                const AnimationSampler* sampler =
                    there ? &animation.samplers[channel.sampler] : nullptr;
                const Index node = !there ? no_index
                                   : channel.path == AnimationPath::weights
                                       ? mesh_nodes_[channel.node]
                                       : channel.node;
                if (node == no_index || !sampler->times || !sampler->values ||
                    sampler->times->empty() || sampler->values->empty()) {
                    ++lost_channels_;
                    continue;
                }
                const int width = channel.path == AnimationPath::weights    ? 1
                                  : channel.path == AnimationPath::rotation ? 4
                                                                            : 3;
                Json out{{"input", floats(sampler->times, 1, true)},
                         {"output", floats(sampler->values, width, false)}};
                if (sampler->interpolation != Interpolation::linear)
                    out["interpolation"] =
                        sampler->interpolation == Interpolation::step ? "STEP" : "CUBICSPLINE";
                channels.push_back(Json{{"sampler", samplers.size()},
                                        {"target", {{"node", node}, {"path", path}}}});
                samplers.push_back(std::move(out));
            }
            if (channels.empty()) continue;
            Json out;
            if (!animation.name.empty()) out["name"] = as_utf8(animation.name);
            out["channels"] = std::move(channels);
            out["samplers"] = std::move(samplers);
            buffer_.push("animations", std::move(out));
        }
    }

    const PreparedScene& prepared_;
    const Scene& scene_;
    const WrittenParts& written_;
    Json& document_;
    GltfBuffer& buffer_;
    std::vector<std::string>& notes_;
    std::set<Index> animated_;
    std::vector<Index> mesh_nodes_;  // by node: what has its mesh, which weights are told to
    std::map<std::tuple<Index, double, double, double>, Index> skins_;
    std::map<std::pair<const std::vector<float>*, int>, std::size_t> accessors_;
    std::uint64_t lost_channels_ = 0, lost_skins_ = 0;
};

}  // namespace

void build_nodes(const PreparedScene& prepared, const WrittenParts& written, Json& document,
                 GltfBuffer& buffer, std::vector<std::string>& notes) {
    NodeBuilder(prepared, written, document, buffer, notes).run();
}

}  // namespace prep::detail
