#include <algorithm>
#include <cmath>
#include <exception>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <set>

#include "base/file_bytes.h"
#include "formats/gltf/document.h"
#include "formats/gltf/extensions.h"
#include "formats/gltf/materials/material_reader.h"
#include "formats/gltf/meshes.h"
#include "formats/gltf/structure.h"
#include "text/name_list.h"

namespace prep {
namespace {

using namespace detail;
using Index = std::uint32_t;

constexpr double widest_yfov = 3.1;  // at π a picture would have no edge

class SceneReader {
  public:
    SceneReader(std::shared_ptr<GltfDocument> document, const GltfOptions& options)
        : d_(*document),
          document_(document),
          allowed_(options.allowed_extensions),
          threads_(options.threads),
          decoded_bytes_left_(decoded_limit(d_.input_bytes)) {}

    Result<Scene> run() {
        scene_.warnings = d_.warnings;
        if (auto done = extensions(); !done) return std::move(done).error();
        for (const char* key :
             {"accessors", "bufferViews", "meshes", "nodes", "scenes", "materials", "textures",
              "images", "samplers", "cameras", "skins", "animations"})
            if (auto list = top_array(d_, key); !list) return list.error();
        if (auto done = check_structure(d_); !done) return std::move(done).error();
        if (auto done = read_gltf_materials(d_, scene_); !done) return std::move(done).error();
        if (auto done = read_gltf_meshes(*document_, scene_, joints_, threads_); !done)
            return std::move(done).error();
        if (auto done = cameras(); !done) return std::move(done).error();
        if (auto done = lights(); !done) return std::move(done).error();
        if (auto done = nodes(); !done) return std::move(done).error();
        if (auto done = skins(); !done) return std::move(done).error();
        if (auto done = animations(); !done) return std::move(done).error();
        if (auto done = active_scene(); !done) return std::move(done).error();
        scene_.name = d_.name;
        document_->nodes = scene_.nodes;
        scene_.retained_file = document_;
        scene_.source_bytes = d_.input_bytes;
        return std::move(scene_);
    }

  private:
    std::size_t size_of(const char* key) const {
        return d_.json.contains(key) ? d_.json[key].size() : 0;
    }

    Result<void> extensions() {
        const auto it = d_.json.find("extensionsRequired");
        if (it == d_.json.end()) return {};
        if (!it->is_array()) return d_.bad("/extensionsRequired", "expected an array");
        for (std::size_t i = 0; i < it->size(); ++i) {
            const std::string pointer = "/extensionsRequired/" + std::to_string(i);
            if (!(*it)[i].is_string()) return d_.bad(pointer, "expected a string");
            const std::string name = (*it)[i].get<std::string>();
            auto said = required_extension(name, allowed_);
            if (!said) return d_.bad(pointer, said.error().text, said.error().code);
            if (!said->empty()) scene_.warnings.push_back(d_.place(pointer) + ": " + *said);
        }
        return {};
    }

    // A number member; `otherwise` where it is absent.
    Result<double> number(const Json& object, const char* key, const std::string& pointer,
                          std::optional<double> otherwise) const {
        const auto it = object.find(key);
        if (it == object.end()) {
            if (otherwise) return *otherwise;
            return d_.bad(pointer + "/" + key, "the member is missing");
        }
        if (!it->is_number()) return d_.bad(pointer + "/" + key, "expected a number");
        return it->get<double>();
    }

    Result<void> cameras() {
        const Json* list = *top_array(d_, "cameras");
        for (std::size_t c = 0; c < list->size(); ++c) {
            const Json& in = (*list)[c];
            const std::string pointer = "/cameras/" + std::to_string(c);
            Camera out;
            out.name = name_of(in);
            const auto type = in.find("type");
            if (type == in.end() || !type->is_string())
                return d_.bad(pointer + "/type", "expected a string");
            const std::string kind = type->get<std::string>();
            if (kind != "perspective" && kind != "orthographic")
                return d_.bad(pointer + "/type", "expected perspective or orthographic");
            const auto lens = in.find(kind);
            if (lens == in.end() || !lens->is_object())
                return d_.bad(pointer + "/" + kind, "expected an object");
            const std::string place = pointer + "/" + kind;
            out.perspective = kind == "perspective";
            const auto take = [&](const char* key, std::optional<double> otherwise, double& to,
                                  double low) -> Result<void> {
                const auto value = number(*lens, key, place, otherwise);
                if (!value) return value.error();
                if (lens->contains(key) && !(*value >= low && std::isfinite(*value)))
                    return d_.bad(place + "/" + key, "out of range");
                to = *value;
                return {};
            };
            if (out.perspective) {
                if (auto r = take("yfov", {}, out.yfov, 1e-9); !r) return r;
                if (auto r = take("aspectRatio", 0.0, out.aspect, 1e-9); !r) return r;
                if (auto r = take("znear", {}, out.znear, 1e-30); !r) return r;
                if (auto r = take("zfar", 0.0, out.zfar, 1e-30); !r) return r;
                if (out.yfov > widest_yfov) {
                    scene_.warnings.push_back(d_.place(place) +
                                              "/yfov: π or more: drawn with a little less");
                    out.yfov = widest_yfov;
                }
                if (lens->contains("zfar") && out.zfar <= out.znear)
                    return d_.bad(place + "/zfar", "must be greater than znear");
            } else {
                if (auto r = take("xmag", {}, out.xmag, -1e300); !r) return r;
                if (auto r = take("ymag", {}, out.ymag, -1e300); !r) return r;
                if (auto r = take("znear", {}, out.znear, 0); !r) return r;
                if (auto r = take("zfar", {}, out.zfar, 0); !r) return r;
                if (out.xmag == 0) return d_.bad(place + "/xmag", "must not be zero");
                if (out.ymag == 0) return d_.bad(place + "/ymag", "must not be zero");
                if (out.zfar <= out.znear)
                    return d_.bad(place + "/zfar", "must be greater than znear");
            }
            scene_.cameras.push_back(out);
        }
        return {};
    }

    Result<void> lights() {
        if (!d_.json.contains("extensions") || !d_.json["extensions"].is_object()) return {};
        const Json& extensions = d_.json["extensions"];
        if (!extensions.contains("KHR_lights_punctual")) return {};
        const Json& extension = extensions["KHR_lights_punctual"];
        const std::string base = "/extensions/KHR_lights_punctual/lights";
        if (!extension.is_object() || !extension.contains("lights") ||
            !extension["lights"].is_array())
            return d_.bad(base, "expected an array");
        for (std::size_t l = 0; l < extension["lights"].size(); ++l) {
            const Json& in = extension["lights"][l];
            const std::string pointer = base + "/" + std::to_string(l);
            if (!in.is_object()) return d_.bad(pointer, "expected an object");
            Light out;
            out.name = name_of(in);
            const std::string type =
                in.contains("type") && in["type"].is_string() ? in["type"].get<std::string>() : "";
            if (type == "directional")
                out.kind = LightKind::directional;
            else if (type == "point")
                out.kind = LightKind::point;
            else if (type == "spot")
                out.kind = LightKind::spot;
            else
                return d_.bad(pointer + "/type", "expected directional, point or spot");
            double rgb[3] = {1, 1, 1};
            if (auto r = read_numbers(d_, in, "color", pointer, rgb); !r) return r;
            out.color = glm::vec3(glm::dvec3(rgb[0], rgb[1], rgb[2]));
            const auto intensity = number(in, "intensity", pointer, 1.0);
            const auto range = number(in, "range", pointer, 0.0);
            if (!intensity) return intensity.error();
            if (!range) return range.error();
            out.intensity = float(*intensity);
            out.range = float(*range);
            if (in.contains("spot") && in["spot"].is_object()) {
                const auto inner = number(in["spot"], "innerConeAngle", pointer + "/spot", 0.0);
                const auto outer =
                    number(in["spot"], "outerConeAngle", pointer + "/spot", double(out.outer_cone));
                if (!inner) return inner.error();
                if (!outer) return outer.error();
                out.inner_cone = float(*inner);
                out.outer_cone = float(*outer);
            }
            scene_.lights.push_back(out);
        }
        return {};
    }

    Result<void> node_transform(const Json& in, const std::string& pointer, Node& out) const {
        double m[16], t[3] = {0, 0, 0}, r[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
        if (in.contains("matrix")) {
            for (const char* key : {"translation", "rotation", "scale"})
                if (in.contains(key))
                    return d_.bad(pointer + "/matrix",
                                  std::string("the node has a matrix and a ") + key +
                                      ": which of them holds cannot be known; remove one");
            if (auto done = read_numbers(d_, in, "matrix", pointer, m); !done) return done;
            for (int c = 0; c < 4; ++c)
                for (int k = 0; k < 4; ++k) out.transform[c][k] = m[4 * c + k];
            return {};
        }
        if (auto done = read_numbers(d_, in, "translation", pointer, t); !done) return done;
        if (auto done = read_numbers(d_, in, "rotation", pointer, r); !done) return done;
        if (auto done = read_numbers(d_, in, "scale", pointer, s); !done) return done;
        glm::dquat q(r[3], r[0], r[1], r[2]);
        const double length = glm::length(q);
        if (length > 0 && std::isfinite(length)) q = q / length;
        out.trs = Trs{{t[0], t[1], t[2]}, q, {s[0], s[1], s[2]}};
        out.transform = out.trs->matrix();
        return {};
    }

    Result<void> nodes() {
        const Json* list = *top_array(d_, "nodes");
        scene_.nodes.resize(list->size());
        NameList instanced;
        for (std::size_t n = 0; n < list->size(); ++n) {
            const Json& in = (*list)[n];
            const std::string pointer = "/nodes/" + std::to_string(n);
            Node& out = scene_.nodes[n];
            out.name = name_of(in);
            if (auto done = node_transform(in, pointer, out); !done) return done;
            const auto take = [&](const char* key, std::size_t size, Index& to) -> Result<void> {
                const auto value = index_member(d_, in, key, pointer, size);
                if (!value) return value.error();
                to = *value;
                return {};
            };
            if (auto done = take("mesh", scene_.meshes.size(), out.mesh); !done) return done;
            if (auto done = take("camera", scene_.cameras.size(), out.camera); !done) return done;
            if (auto done = take("skin", size_of("skins"), out.skin); !done) return done;
            if (const Json* punctual = extension_of(in, "KHR_lights_punctual")) {
                const auto light =
                    index_member(d_, *punctual, "light",
                                 pointer + "/extensions/KHR_lights_punctual", scene_.lights.size());
                if (!light) return light.error();
                out.light = *light;
            }
            if (out.mesh != no_index && in.contains("extensions") && in["extensions"].is_object() &&
                in["extensions"].contains("EXT_mesh_gpu_instancing"))
                instanced.add(std::to_string(n));
            const auto children = in.find("children");
            if (children == in.end()) continue;
            if (!children->is_array()) return d_.bad(pointer + "/children", "expected an array");
            for (std::size_t c = 0; c < children->size(); ++c) {
                const std::string place = pointer + "/children/" + std::to_string(c);
                const auto index = index_value(d_, (*children)[c], place, list->size());
                if (!index) return index.error();
                Node& child = scene_.nodes[*index];
                if (child.parent != no_index)
                    return d_.bad(place,
                                  "the node has another parent: " + std::to_string(child.parent));
                child.parent = Index(n);
            }
        }
        if (!instanced.empty())
            scene_.warnings.push_back(d_.place("/nodes") +
                                      ": the instances of EXT_mesh_gpu_instancing are kept in glTF "
                                      "files; drawn, measured and written to other formats, the "
                                      "mesh stands once (nodes " +
                                      instanced.text() + ")");
        return check_cycles();
    }

    // With one parent each, a node that cannot reach a root is on a cycle or below one.
    Result<void> check_cycles() const {
        std::vector<std::uint8_t> good(scene_.nodes.size(), 0);
        for (Index n = 0; n < scene_.nodes.size(); ++n) {
            Index k = n;
            std::size_t steps = 0;
            while (k != no_index && !good[k] && steps <= scene_.nodes.size()) {
                k = scene_.nodes[k].parent;
                ++steps;
            }
            if (steps > scene_.nodes.size())
                return d_.bad("/nodes/" + std::to_string(n), "the node is its own ancestor");
            for (k = n; k != no_index && !good[k]; k = scene_.nodes[k].parent) good[k] = 1;
        }
        return {};
    }

    Result<void> skins() {
        const Json* list = *top_array(d_, "skins");
        for (std::size_t s = 0; s < list->size(); ++s) {
            const Json& in = (*list)[s];
            const std::string pointer = "/skins/" + std::to_string(s);
            Skin out;
            out.name = name_of(in);
            const auto joints = in.find("joints");
            if (joints == in.end() || !joints->is_array() || joints->empty())
                return d_.bad(pointer + "/joints", "expected a list with at least one node");
            for (std::size_t j = 0; j < joints->size(); ++j) {
                const auto node =
                    index_value(d_, (*joints)[j], pointer + "/joints/" + std::to_string(j),
                                scene_.nodes.size());
                if (!node) return node.error();
                out.joints.push_back(*node);
            }
            const auto accessor =
                index_member(d_, in, "inverseBindMatrices", pointer, size_of("accessors"));
            if (!accessor) return accessor.error();
            if (auto r = index_member(d_, in, "skeleton", pointer, scene_.nodes.size()); !r)
                return r.error();
            out.inverse_bind.assign(out.joints.size(), glm::mat4(1.0f));
            if (*accessor != no_index) {
                const Json& matrices = d_.json["accessors"][*accessor];
                if (matrices.contains("sparse")) {  // each skin decodes it whole
                    const std::uint64_t bytes = 64 * matrices["count"].get<std::uint64_t>();
                    if (bytes > decoded_bytes_left_)
                        return d_.bad(pointer + "/inverseBindMatrices",
                                      "skins share a sparse accessor so often that it would fill " +
                                          std::to_string(decoded_limit(d_.input_bytes) >> 20) +
                                          " MiB",
                                      ErrorCode::limit);
                    decoded_bytes_left_ -= bytes;
                }
                const auto raw = d_.raw_accessor(*accessor);
                if (!raw) return raw.error();
                if (raw->width != 16 || raw->component_type != 5126 ||
                    raw->count < out.joints.size())
                    return d_.bad(pointer + "/inverseBindMatrices",
                                  "expected a float MAT4 for each of " +
                                      std::to_string(out.joints.size()) + " joints");
                RawAccessor of_joints = *raw;  // many skins may share the matrices
                of_joints.count = out.joints.size();
                of_joints.bytes = raw->bytes.part(0, of_joints.count * raw->element_size());
                const std::vector<float> floats = to_floats(of_joints);
                for (std::size_t j = 0; j < out.joints.size(); ++j)
                    for (int k = 0; k < 16; ++k)
                        out.inverse_bind[j][k / 4][k % 4] = floats[16 * j + std::size_t(k)];
            }
            scene_.skins.push_back(std::move(out));
        }
        return check_joints();
    }

    // The joints that a mesh uses, against those that its nodes' skins have.
    Result<void> check_joints() const {
        const Json* list = *top_array(d_, "nodes");
        for (std::size_t n = 0; n < list->size(); ++n) {
            const Index mesh = scene_.nodes[n].mesh, skin = scene_.nodes[n].skin;
            if (mesh == no_index || skin == no_index) continue;
            for (const GltfJoints& used : joints_[mesh])
                if (used.largest >= scene_.skins[skin].joints.size())
                    return d_.bad(used.pointer,
                                  "joint " + std::to_string(used.largest) + " is used, but skin " +
                                      std::to_string(skin) + " of node " + std::to_string(n) +
                                      " has " + std::to_string(scene_.skins[skin].joints.size()));
        }
        return {};
    }

    // Animations are carried, not played: data that cannot be read are left out here, and are an
    // error only to who writes them back.
    Result<void> animations() {
        const Json* list = *top_array(d_, "animations");
        for (std::size_t a = 0; a < list->size(); ++a) {
            const Json& in = (*list)[a];
            const std::string pointer = "/animations/" + std::to_string(a);
            scene_.animations.push_back({name_of(in), {}, {}});
            for (const char* key : {"samplers", "channels"}) {
                if (!in.contains(key) || !in[key].is_array() || in[key].empty())
                    return d_.bad(pointer + "/" + key, "expected a list with at least one entry");
                for (std::size_t i = 0; i < in[key].size(); ++i) {
                    const std::string place = pointer + "/" + key + "/" + std::to_string(i);
                    if (!in[key][i].is_object()) return d_.bad(place, "expected an object");
                    auto done = key[0] == 's' ? animation_sampler(in[key][i], place)
                                              : animation_channel(in, in[key][i], place);
                    if (!done) return done;
                }
            }
        }
        return {};
    }

    Result<void> animation_sampler(const Json& sampler, const std::string& pointer) {
        for (const char* key : {"input", "output"}) {
            const auto accessor = index_member(d_, sampler, key, pointer, size_of("accessors"));
            if (!accessor) return accessor.error();
            if (*accessor == no_index) return d_.bad(pointer + "/" + key, "the member is missing");
        }
        const Json& input = d_.json["accessors"][sampler["input"].get<std::size_t>()];
        if (input["type"] != "SCALAR" || input["componentType"] != 5126)
            return d_.bad(pointer + "/input", "the key times must be float scalars");
        const std::string name =
            sampler.contains("interpolation") && sampler["interpolation"].is_string()
                ? sampler["interpolation"].get<std::string>()
                : std::string();
        scene_.animations.back().samplers.push_back({name == "STEP" ? Interpolation::step
                                                     : name == "CUBICSPLINE"
                                                         ? Interpolation::cubic_spline
                                                         : Interpolation::linear,
                                                     key_values(sampler["input"].get<Index>()),
                                                     key_values(sampler["output"].get<Index>())});
        return {};
    }

    // Each accessor is decoded once, however many samplers share it; but accessors share bytes.
    std::shared_ptr<const std::vector<float>> key_values(Index accessor) {
        const auto [it, added] = key_values_.emplace(accessor, nullptr);
        if (!added) return it->second;
        const Json& in = d_.json["accessors"][accessor];
        const std::uint64_t bytes = in["count"].get<std::uint64_t>() * sizeof(float) *
                                    std::uint64_t(components_of(in["type"].get<std::string>()));
        if (bytes > decoded_bytes_left_) return nullptr;
        decoded_bytes_left_ -= bytes;
        if (const auto raw = d_.raw_accessor(accessor))
            it->second = std::make_shared<const std::vector<float>>(to_floats(*raw));
        return it->second;
    }

    Result<void> animation_channel(const Json& animation, const Json& channel,
                                   const std::string& pointer) {
        const Json& samplers = animation["samplers"];
        const auto sampler = index_member(d_, channel, "sampler", pointer, samplers.size());
        if (!sampler) return sampler.error();
        if (*sampler == no_index) return d_.bad(pointer + "/sampler", "the member is missing");
        const auto target = channel.find("target");
        if (target == channel.end() || !target->is_object())
            return d_.bad(pointer + "/target", "expected an object");
        const auto node =
            index_member(d_, *target, "node", pointer + "/target", scene_.nodes.size());
        if (!node) return node.error();
        const auto path = target->find("path");
        if (path == target->end() || !path->is_string())
            return d_.bad(pointer + "/target/path", "expected a string");
        const std::string name = path->get<std::string>();
        const char* type = name == "translation" || name == "scale" ? "VEC3"
                           : name == "rotation"                     ? "VEC4"
                           : name == "weights"                      ? "SCALAR"
                                                                    : nullptr;
        const std::size_t output = samplers[*sampler]["output"].get<std::size_t>();
        if (type && d_.json["accessors"][output]["type"] != type)
            return d_.bad(pointer + "/sampler", "a " + name + " needs values of type " + type +
                                                    ", accessor " + std::to_string(output) +
                                                    " has " +
                                                    d_.json["accessors"][output]["type"].dump());
        scene_.animations.back().channels.push_back({*sampler, *node,
                                                     name == "translation"
                                                         ? AnimationPath::translation
                                                     : name == "rotation" ? AnimationPath::rotation
                                                     : name == "scale"    ? AnimationPath::scale
                                                     : name == "weights"  ? AnimationPath::weights
                                                                          : AnimationPath::other});
        return {};
    }

    // Nodes outside the active scene keep their place in the list, but nothing of theirs is drawn.
    Result<void> active_scene() {
        const Json* list = *top_array(d_, "scenes");
        const auto chosen = index_member(d_, d_.json, "scene", "", list->size());
        if (!chosen) return chosen.error();
        for (std::size_t s = 0; s < list->size(); ++s)
            if (auto done = scene_nodes((*list)[s], "/scenes/" + std::to_string(s)); !done)
                return done;
        constexpr std::uint8_t unknown = 0, hidden = 1, shown = 2;
        // Without any scene, all nodes are.
        std::vector<std::uint8_t> state(scene_.nodes.size(), list->empty() ? shown : unknown);
        if (!list->empty()) {
            const Json& scene = (*list)[*chosen == no_index ? 0 : *chosen];
            if (scene.contains("nodes"))
                for (const Json& n : scene["nodes"]) state[n.get<std::size_t>()] = shown;
        }
        std::vector<Index> path;  // each node is walked over once, however deep the tree
        for (Index n = 0; n < scene_.nodes.size(); ++n) {
            Index k = n;
            for (; k != no_index && state[k] == unknown; k = scene_.nodes[k].parent)
                path.push_back(k);
            for (const Index p : path) state[p] = k == no_index ? hidden : state[k];
            path.clear();
        }
        for (Index n = 0; n < scene_.nodes.size(); ++n) {
            Node& node = scene_.nodes[n];
            if (state[n] != shown) node.mesh = node.light = node.camera = no_index;
            if (node.camera != no_index && scene_.active_camera == no_index)
                scene_.active_camera = n;
        }
        return {};
    }

    Result<void> scene_nodes(const Json& scene, const std::string& pointer) const {
        const auto nodes = scene.find("nodes");
        if (nodes == scene.end()) return {};
        if (!nodes->is_array()) return d_.bad(pointer + "/nodes", "expected an array");
        for (std::size_t i = 0; i < nodes->size(); ++i) {
            const std::string place = pointer + "/nodes/" + std::to_string(i);
            const auto node = index_value(d_, (*nodes)[i], place, scene_.nodes.size());
            if (!node) return node.error();
            if (scene_.nodes[*node].parent != no_index)
                return d_.bad(place, "the node is not a root");
        }
        return {};
    }

    const GltfDocument& d_;
    std::shared_ptr<GltfDocument> document_;
    Scene scene_;
    std::vector<std::vector<GltfJoints>> joints_;                            // per mesh
    std::map<Index, std::shared_ptr<const std::vector<float>>> key_values_;  // by accessor
    const std::vector<std::string>& allowed_;
    int threads_;
    std::uint64_t decoded_bytes_left_;
};

Result<Scene> parse(const SharedBytes& bytes, const GltfOptions& options) {
    try {
        auto opened = detail::open_gltf(bytes, options);
        if (!opened) return std::move(opened).error();
        return SceneReader(std::make_shared<GltfDocument>(*std::move(opened)), options).run();
    } catch (const detail::Json::exception& e) {
        // Types are checked where they are read; this is the net below that.
        return Error{ErrorCode::invalid, std::string("unexpected JSON: ") + e.what(), options.name};
    }
}

}  // namespace

Result<Scene> parse_gltf(std::span<const std::byte> bytes, const GltfOptions& options) {
    return parse(std::vector<std::byte>(bytes.begin(), bytes.end()), options);
}

Result<Scene> load_gltf(const std::filesystem::path& path, const LoadOptions& load) {
    auto bytes = detail::read_file_bytes(path, load.threads);
    if (!bytes) return std::move(bytes).error();
    GltfOptions options;
    options.allowed_extensions = load.allowed_extensions;
    options.name = path.filename().string();
    // Empty would say that the document did not come from a file.
    options.directory = path.has_parent_path() ? path.parent_path() : ".";
    options.texture_directories = load.texture_directories;
    options.threads = load.threads;
    auto scene = parse(SharedBytes::of(*std::move(bytes)), options);
    if (!scene) return scene;
    scene->source = path;
    scene->libraries = detail::files_of_buffers(*gltf_document(*scene));
    return scene;
}

}  // namespace prep
