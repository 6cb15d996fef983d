#include "gltf_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/quaternion_double.hpp>
#include <glm/gtc/quaternion.hpp>
#include <stdexcept>

namespace test {
namespace {

using Json = GltfFile::Json;
constexpr std::size_t none = std::size_t(-1);

const Json& list(const Json& json, const char* name) {
    static const Json empty = Json::array();
    return json.contains(name) ? json[name] : empty;
}

// LINEAR of the specification: rotations by spherical interpolation over the shorter arc.
std::vector<double> sample(const GltfValues& times, const GltfValues& values, double t,
                           bool rotation) {
    const std::size_t keys = times.values.size();
    const std::size_t width = values.values.size() / keys;
    const auto key = [&](std::size_t k) {
        return std::vector<double>(values.values.begin() + std::ptrdiff_t(k * width),
                                   values.values.begin() + std::ptrdiff_t((k + 1) * width));
    };
    if (t <= times.values.front()) return key(0);
    if (t >= times.values.back()) return key(keys - 1);
    std::size_t k = 0;
    while (times.values[k + 1] <= t) ++k;
    const double s = (t - times.values[k]) / (times.values[k + 1] - times.values[k]);
    std::vector<double> a = key(k), b = key(k + 1);
    if (!rotation) {
        for (std::size_t i = 0; i < width; ++i) a[i] += (b[i] - a[i]) * s;
        return a;
    }
    double dot = 0;
    for (std::size_t i = 0; i < 4; ++i) dot += a[i] * b[i];
    const double sign = dot < 0 ? -1 : 1;
    const double angle = std::acos(std::min(1.0, std::abs(dot)));
    double p = 1 - s, q = s;
    if (std::sin(angle) > 1e-9) {
        p = std::sin(angle * (1 - s)) / std::sin(angle);
        q = std::sin(angle * s) / std::sin(angle);
    }
    for (std::size_t i = 0; i < 4; ++i) a[i] = p * a[i] + q * sign * b[i];
    return a;
}

glm::dmat4 matrix_of(const std::vector<double>& m) {
    glm::dmat4 out(1.0);
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) out[c][r] = m[std::size_t(4 * c + r)];
    return out;
}

}  // namespace

GltfMotion::GltfMotion(const GltfFile& file) : file_(file) {
    for (std::size_t a = 0; a < list(file.json, "accessors").size(); ++a)
        accessors_.push_back(file.accessor(a));
    const Json& nodes = list(file.json, "nodes");
    parents_.assign(nodes.size(), none);
    for (std::size_t n = 0; n < nodes.size(); ++n)
        for (const Json& child : list(nodes[n], "children")) {
            if (parents_.at(child) != none) throw std::runtime_error("two parents");
            parents_.at(child) = n;
        }
}

double GltfMotion::duration(int animation) const {
    double end = 0;
    for (const Json& sampler : file_.json.at("animations").at(std::size_t(animation))["samplers"])
        end = std::max(end, accessors_.at(sampler["input"]).values.back());
    return end;
}

GltfMotion::Pose GltfMotion::pose(int animation, double seconds) const {
    const Json& nodes = list(file_.json, "nodes");
    struct Local {
        std::vector<double> t{0, 0, 0}, r{0, 0, 0, 1}, s{1, 1, 1}, m;
    };
    std::vector<Local> local(nodes.size());
    Pose out;
    out.weights.resize(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const Json& node = nodes[n];
        if (node.contains("translation"))
            local[n].t = node["translation"].get<std::vector<double>>();
        if (node.contains("rotation")) local[n].r = node["rotation"].get<std::vector<double>>();
        if (node.contains("scale")) local[n].s = node["scale"].get<std::vector<double>>();
        if (node.contains("matrix")) local[n].m = node["matrix"].get<std::vector<double>>();
        if (node.contains("mesh")) {
            const Json& mesh = file_.json["meshes"].at(node["mesh"].get<std::size_t>());
            if (mesh.contains("weights"))
                out.weights[n] = mesh["weights"].get<std::vector<double>>();
            if (node.contains("weights"))
                out.weights[n] = node["weights"].get<std::vector<double>>();
        }
    }
    if (animation >= 0) {
        const Json& in = file_.json.at("animations").at(std::size_t(animation));
        for (const Json& channel : in["channels"]) {
            const Json& sampler = in["samplers"].at(channel["sampler"].get<std::size_t>());
            if (sampler.value("interpolation", "LINEAR") != "LINEAR")
                throw std::runtime_error("not linear");
            const std::string path = channel["target"]["path"];
            const std::size_t n = channel["target"]["node"];
            if (path != "weights" && !local.at(n).m.empty())
                throw std::runtime_error("an animated node with a matrix");
            const std::vector<double> value =
                sample(accessors_.at(sampler["input"]), accessors_.at(sampler["output"]), seconds,
                       path == "rotation");
            (path == "translation" ? local[n].t
             : path == "rotation"  ? local[n].r
             : path == "scale"     ? local[n].s
                                   : out.weights.at(n)) = value;
        }
    }
    std::vector<glm::dmat4> own(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (!local[n].m.empty()) {
            own[n] = matrix_of(local[n].m);
            continue;
        }
        const Local& l = local[n];
        own[n] = glm::mat4_cast(glm::normalize(glm::dquat(l.r[3], l.r[0], l.r[1], l.r[2])));
        for (int c = 0; c < 3; ++c) own[n][c] *= l.s[std::size_t(c)];
        own[n][3] = glm::dvec4(l.t[0], l.t[1], l.t[2], 1);
    }
    out.world.resize(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        glm::dmat4 m = own[n];
        for (std::size_t p = parents_[n]; p != none; p = parents_[p]) m = own[p] * m;
        out.world[n] = m;
    }
    return out;
}

std::vector<glm::dmat4> GltfMotion::world(int animation, double seconds) const {
    return pose(animation, seconds).world;
}

std::vector<MovedVertex> GltfMotion::vertices(int animation, double seconds) const {
    const Pose at = pose(animation, seconds);
    const Json& nodes = list(file_.json, "nodes");
    std::vector<MovedVertex> out;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (!nodes[n].contains("mesh")) continue;
        const Json& mesh = file_.json["meshes"].at(nodes[n]["mesh"].get<std::size_t>());
        std::vector<glm::dmat4> joints;
        if (nodes[n].contains("skin")) {
            const Json& skin = file_.json["skins"].at(nodes[n]["skin"].get<std::size_t>());
            const GltfValues& bind = accessors_.at(skin["inverseBindMatrices"]);
            for (std::size_t j = 0; j < skin["joints"].size(); ++j)
                joints.push_back(at.world.at(skin["joints"][j].get<std::size_t>()) *
                                 matrix_of(bind.at(j)));
        }
        for (const Json& primitive : mesh["primitives"]) {
            const Json& attributes = primitive["attributes"];
            const GltfValues& positions = accessors_.at(attributes["POSITION"]);
            for (std::size_t v = 0; v < positions.count(); ++v) {
                const auto three = [&](const GltfValues& values) {
                    return glm::dvec3(values.values[3 * v], values.values[3 * v + 1],
                                      values.values[3 * v + 2]);
                };
                glm::dvec3 p = three(positions);
                MovedVertex moved;
                for (int k = 0; k < 3; ++k) moved.base[std::size_t(k)] = float(p[k]);
                const Json& targets = list(primitive, "targets");
                for (std::size_t t = 0; t < targets.size(); ++t)
                    if (t < at.weights[n].size() && targets[t].contains("POSITION"))
                        p += at.weights[n][t] * three(accessors_.at(targets[t]["POSITION"]));
                glm::dmat4 m = at.world[n];
                if (!joints.empty()) {
                    m = glm::dmat4(0.0);
                    for (std::size_t s = 0; attributes.contains("JOINTS_" + std::to_string(s));
                         ++s) {
                        const GltfValues& j =
                            accessors_.at(attributes["JOINTS_" + std::to_string(s)]);
                        const GltfValues& w =
                            accessors_.at(attributes["WEIGHTS_" + std::to_string(s)]);
                        for (std::size_t k = 4 * v; k < 4 * v + 4; ++k)
                            if (w.values[k] != 0)
                                m += w.values[k] * joints.at(std::size_t(j.values[k]));
                    }
                }
                moved.world = glm::dvec3(m * glm::dvec4(p, 1));
                out.push_back(moved);
            }
        }
    }
    return out;
}

}  // namespace test
