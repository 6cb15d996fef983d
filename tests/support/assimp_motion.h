// What Assimp says of a file in motion, sampled here: keys by lerp and slerp, nodes multiplied,
// bones and morph targets applied as Assimp documents them. Nothing of libprep is used.
#pragma once

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/ext/quaternion_double.hpp>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "gltf_motion.h"

namespace test {

class AssimpMotion {
  public:
    explicit AssimpMotion(const std::filesystem::path& path) {
        importer_.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
        scene_ = importer_.ReadFile(path.string(), aiProcess_ValidateDataStructure);
        if (!scene_) throw std::runtime_error(importer_.GetErrorString());
        float centimetres = 100;
        if (scene_->mMetaData) scene_->mMetaData->Get("UnitScaleFactor", centimetres);
        metres_ = double(centimetres) / 100;
    }

    const aiScene& scene() const { return *scene_; }
    double metres() const { return metres_; }
    double ticks(int animation) const {
        const double t = scene_->mAnimations[animation]->mTicksPerSecond;
        return t > 0 ? t : 25;
    }
    double duration(int animation) const {
        return scene_->mAnimations[animation]->mDuration / ticks(animation);
    }

    // Vertices of faces, of every node with a mesh. animation −1: at rest.
    std::vector<MovedVertex> vertices(int animation, double seconds) const {
        Pose pose;
        if (animation >= 0)
            sample(*scene_->mAnimations[animation], seconds * ticks(animation), pose);
        place(*scene_->mRootNode, scaled(metres_), pose);
        std::vector<MovedVertex> out;
        collect(*scene_->mRootNode, pose, out);
        return out;
    }

  private:
    struct Pose {
        std::map<std::string, glm::dmat4> moved;  // by name
        std::map<std::string, std::map<unsigned, double>> weights;
        std::map<const aiNode*, glm::dmat4> world;
        std::map<std::string, glm::dmat4> by_name;
    };

    static glm::dmat4 scaled(double s) {
        glm::dmat4 m(1.0);
        for (int c = 0; c < 3; ++c) m[c] *= s;
        return m;
    }
    static glm::dmat4 matrix(const aiMatrix4x4& m) {
        return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2,
                m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
    }

    template <class Key, class Value>
    static Value key_at(const Key* keys, unsigned count, double t, const Value& otherwise,
                        Value (*value)(const Key&), Value (*mix)(Value, Value, double)) {
        if (count == 0) return otherwise;
        if (t <= keys[0].mTime) return value(keys[0]);
        for (unsigned k = 1; k < count; ++k)
            if (t < keys[k].mTime)
                return mix(value(keys[k - 1]), value(keys[k]),
                           (t - keys[k - 1].mTime) / (keys[k].mTime - keys[k - 1].mTime));
        return value(keys[count - 1]);
    }
    static glm::dvec3 vector_of(const aiVectorKey& k) {
        return {k.mValue.x, k.mValue.y, k.mValue.z};
    }
    static glm::dquat quaternion_of(const aiQuatKey& k) {
        return glm::normalize(glm::dquat(k.mValue.w, k.mValue.x, k.mValue.y, k.mValue.z));
    }
    static glm::dvec3 lerp(glm::dvec3 a, glm::dvec3 b, double t) { return a + (b - a) * t; }
    static glm::dquat slerp(glm::dquat a, glm::dquat b, double t) {
        if (glm::dot(a, b) < 0) b = -b;
        const double angle = std::acos(std::min(1.0, glm::dot(a, b)));
        if (std::sin(angle) < 1e-9) return a;
        return (a * std::sin((1 - t) * angle) + b * std::sin(t * angle)) / std::sin(angle);
    }

    static void sample(const aiAnimation& animation, double t, Pose& pose) {
        for (unsigned c = 0; c < animation.mNumChannels; ++c) {
            const aiNodeAnim& in = *animation.mChannels[c];
            const glm::dvec3 translation = key_at<aiVectorKey, glm::dvec3>(
                in.mPositionKeys, in.mNumPositionKeys, t, glm::dvec3(0.0), vector_of, lerp);
            const glm::dquat rotation =
                key_at<aiQuatKey, glm::dquat>(in.mRotationKeys, in.mNumRotationKeys, t,
                                              glm::dquat(1, 0, 0, 0), quaternion_of, slerp);
            const glm::dvec3 scale = key_at<aiVectorKey, glm::dvec3>(
                in.mScalingKeys, in.mNumScalingKeys, t, glm::dvec3(1.0), vector_of, lerp);
            glm::dmat4 m = glm::mat4_cast(rotation);
            for (int k = 0; k < 3; ++k) m[k] *= scale[k];
            m[3] = glm::dvec4(translation, 1);
            pose.moved[in.mNodeName.C_Str()] = m;
        }
        for (unsigned c = 0; c < animation.mNumMorphMeshChannels; ++c) {
            const aiMeshMorphAnim& in = *animation.mMorphMeshChannels[c];
            std::map<unsigned, std::vector<std::pair<double, double>>> curves;
            for (unsigned k = 0; k < in.mNumKeys; ++k)
                for (unsigned v = 0; v < in.mKeys[k].mNumValuesAndWeights; ++v)
                    curves[in.mKeys[k].mValues[v]].push_back(
                        {in.mKeys[k].mTime, in.mKeys[k].mWeights[v]});
            std::string name = in.mName.C_Str();
            name = name.substr(0, name.find('*'));
            for (const auto& [target, keys] : curves) {
                double weight = keys.front().second;
                for (std::size_t k = 0; k < keys.size(); ++k) {
                    if (t < keys[k].first) {
                        if (k > 0)
                            weight = keys[k - 1].second + (keys[k].second - keys[k - 1].second) *
                                                              (t - keys[k - 1].first) /
                                                              (keys[k].first - keys[k - 1].first);
                        break;
                    }
                    weight = keys[k].second;
                }
                pose.weights[name][target] = weight;
            }
        }
    }

    // Assimp 5.2.5 gives a node with FBX's pre-rotation alone a channel that has it already, beside
    // the nodes that have it: the channel then stands for all of them.
    static bool chained(const aiNode& node) {
        return std::string(node.mName.C_Str()).find("_$AssimpFbx$_") != std::string::npos;
    }
    static const aiNode& end_of_chain(const aiNode& node) {
        const aiNode* last = &node;
        while (chained(*last) && last->mNumChildren == 1) last = last->mChildren[0];
        return *last;
    }

    static void place(const aiNode& node, const glm::dmat4& parent, Pose& pose) {
        const auto moved = pose.moved.find(node.mName.C_Str());
        glm::dmat4 local = moved == pose.moved.end() ? matrix(node.mTransformation) : moved->second;
        if (chained(node) && pose.moved.contains(end_of_chain(node).mName.C_Str()))
            local = glm::dmat4(1.0);
        const glm::dmat4 world = parent * local;
        pose.world[&node] = world;
        pose.by_name.emplace(node.mName.C_Str(), world);
        for (unsigned c = 0; c < node.mNumChildren; ++c) place(*node.mChildren[c], world, pose);
    }

    void collect(const aiNode& node, const Pose& pose, std::vector<MovedVertex>& out) const {
        for (unsigned m = 0; m < node.mNumMeshes; ++m) {
            const aiMesh& mesh = *scene_->mMeshes[node.mMeshes[m]];
            std::vector<bool> used(mesh.mNumVertices, false);
            for (unsigned f = 0; f < mesh.mNumFaces; ++f)
                if (mesh.mFaces[f].mNumIndices >= 3)
                    for (unsigned k = 0; k < mesh.mFaces[f].mNumIndices; ++k)
                        used[mesh.mFaces[f].mIndices[k]] = true;
            std::vector<glm::dmat4> skin(mesh.mNumVertices, glm::dmat4(0.0));
            std::vector<double> sums(mesh.mNumVertices, 0.0);
            for (unsigned b = 0; b < mesh.mNumBones; ++b) {
                const aiBone& bone = *mesh.mBones[b];
                const glm::dmat4 to =
                    pose.by_name.at(bone.mName.C_Str()) * matrix(bone.mOffsetMatrix);
                for (unsigned w = 0; w < bone.mNumWeights; ++w) {
                    skin[bone.mWeights[w].mVertexId] += double(bone.mWeights[w].mWeight) * to;
                    sums[bone.mWeights[w].mVertexId] += double(bone.mWeights[w].mWeight);
                }
            }
            const auto weights = pose.weights.find(node.mName.C_Str());
            for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
                if (!used[v]) continue;
                const aiVector3D& in = mesh.mVertices[v];
                MovedVertex moved;
                moved.base = {in.x, in.y, in.z};
                glm::dvec3 p(in.x, in.y, in.z);
                for (unsigned t = 0; t < mesh.mNumAnimMeshes; ++t) {
                    const aiAnimMesh& target = *mesh.mAnimMeshes[t];
                    double weight = target.mWeight == 1 ? 0 : double(target.mWeight);
                    if (weights != pose.weights.end() && weights->second.contains(t))
                        weight = weights->second.at(t);
                    const aiVector3D& end = target.mVertices[v];
                    p += weight * (glm::dvec3(end.x, end.y, end.z) - glm::dvec3(in.x, in.y, in.z));
                }
                const glm::dmat4 to = sums[v] > 0 ? skin[v] / sums[v] : pose.world.at(&node);
                moved.world = glm::dvec3(to * glm::dvec4(p, 1));
                out.push_back(moved);
            }
        }
        for (unsigned c = 0; c < node.mNumChildren; ++c) collect(*node.mChildren[c], pose, out);
    }

    Assimp::Importer importer_;
    const aiScene* scene_ = nullptr;
    double metres_ = 1;
};

// The largest distance between vertices of one base over all times, each with the one that it
// agrees with best, in both directions; relative to the size at the first time.
inline double largest_difference(const std::vector<std::vector<MovedVertex>>& written,
                                 const std::vector<std::vector<MovedVertex>>& expected) {
    using Base = std::array<float, 3>;
    std::map<Base, std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> groups;
    const auto plain = [](Base b) {
        for (float& x : b) x += 0.0f;  // −0 is 0
        return b;
    };
    for (std::size_t i = 0; i < written[0].size(); ++i)
        groups[plain(written[0][i].base)].first.push_back(i);
    glm::dvec3 low(1e300), high(-1e300);
    for (std::size_t i = 0; i < expected[0].size(); ++i) {
        groups[plain(expected[0][i].base)].second.push_back(i);
        low = glm::min(low, expected[0][i].world);
        high = glm::max(high, expected[0][i].world);
    }
    const double size = glm::length(high - low);
    double worst = 0;
    const auto distance = [&](std::size_t w, std::size_t e) {
        double far = 0;
        for (std::size_t t = 0; t < written.size(); ++t)
            far = std::max(far, glm::length(written[t][w].world - expected[t][e].world));
        return far;
    };
    for (const auto& [base, group] : groups) {
        for (const std::size_t w : group.first) {
            double best = 1e300;
            for (const std::size_t e : group.second) best = std::min(best, distance(w, e));
            worst = std::max(worst, best);
        }
        for (const std::size_t e : group.second) {
            double best = 1e300;
            for (const std::size_t w : group.first) best = std::min(best, distance(w, e));
            worst = std::max(worst, best);
        }
    }
    return worst / size;
}

}  // namespace test
