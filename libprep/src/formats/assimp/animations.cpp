// Animations: the channels of nodes and of morph targets' weights.
#include <algorithm>
#include <cmath>
#include <set>

#include "formats/assimp/import.h"
#include "formats/assimp/key_tracks.h"
#include "formats/assimp/pivot_motion.h"
#include "model/trs.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// What Assimp's own viewer takes where a file says nothing.
constexpr double usual_ticks_per_second = 25;
// A transform that is off its translation, rotation and scale by more than float products are.
constexpr double least_shear = 1e-4;

class AnimationImport {
  public:
    explicit AnimationImport(AssimpImport& import)
        : import_(import), scene_(import.scene), nodes_(import.nodes) {}

    void run() {
        for (unsigned a = 0; a < import_.from.mNumAnimations; ++a)
            animation(*import_.from.mAnimations[a]);
        warn();
    }

  private:
    void animation(const aiAnimation& in) {
        out_ = Animation{};
        out_.name = text(in.mName);
        times_.clear();
        taken_.clear();
        ticks_ = in.mTicksPerSecond > 0 && std::isfinite(in.mTicksPerSecond)
                     ? in.mTicksPerSecond
                     : usual_ticks_per_second;
        std::map<Index, std::vector<const aiNodeAnim*>> of_pivots;
        for (unsigned c = 0; c < in.mNumChannels; ++c) {
            const aiNodeAnim& channel = *in.mChannels[c];
            const AssimpNodes::Target* target = nodes_.find(channel.mNodeName);
            other_ends_ += repeats(channel.mPreState) + repeats(channel.mPostState);
            if (!target) {
                ++lost_channels_;
                continue;
            }
            if (nodes_.repeated_names.contains(text(channel.mNodeName)))
                shared_names_.insert(text(channel.mNodeName));
            const auto factors = nodes_.factors.find(target->animated);
            // A channel of the node itself stands for its pivots as well: Assimp makes such where
            // there is a pre-rotation alone.
            if (factors != nodes_.factors.end() && is_pivot(channel.mNodeName))
                of_pivots[target->animated].push_back(&channel);
            else
                whole_node(channel, target->animated);
        }
        for (const auto& [node, channels] : of_pivots) pivots(node, channels);
        for (unsigned c = 0; c < in.mNumMorphMeshChannels; ++c) morph(*in.mMorphMeshChannels[c]);
        swapped_meshes_ += in.mNumMeshChannels;
        if (!out_.channels.empty())
            scene_.animations.push_back(std::move(out_));
        else
            ++empty_;
    }

    static bool repeats(aiAnimBehaviour behaviour) {
        return behaviour == aiAnimBehaviour_LINEAR || behaviour == aiAnimBehaviour_REPEAT;
    }

    void whole_node(const aiNodeAnim& in, Index node) {
        TrsTracks tracks;
        tracks.translation = vector_track(in.mPositionKeys, in.mNumPositionKeys, ticks_, counts_);
        tracks.rotation = rotation_track(in.mRotationKeys, in.mNumRotationKeys, ticks_, counts_);
        tracks.scale = vector_track(in.mScalingKeys, in.mNumScalingKeys, ticks_, counts_);
        emit(node, std::move(tracks));
    }

    void pivots(Index node, const std::vector<const aiNodeAnim*>& channels) {
        std::vector<MovingFactor> factors;
        for (const PivotFactor& factor : nodes_.factors.at(node)) {
            MovingFactor& out = factors.emplace_back();
            out.rest = without_roundings(trs_of(factor.transform));
            for (const aiNodeAnim* in : channels) {
                if (in->mNodeName != factor.node->mName) continue;
                out.translation =
                    vector_track(in->mPositionKeys, in->mNumPositionKeys, ticks_, counts_);
                out.rotation =
                    rotation_track(in->mRotationKeys, in->mNumRotationKeys, ticks_, counts_);
                out.scale = vector_track(in->mScalingKeys, in->mNumScalingKeys, ticks_, counts_);
                // Assimp puts one key that changes nothing where the factor does not move.
                keep_moving(out);
            }
        }
        auto tracks = product_tracks(factors, counts_);
        if (!tracks) {
            ++sheared_pivots_;
            return;
        }
        emit(node, *std::move(tracks));
    }

    static void keep_moving(MovingFactor& factor) {
        factor.rest = Trs{};
        if (factor.translation.values.size() == 1) {
            factor.rest.translation = factor.translation.values[0];
            factor.translation = {};
        }
        if (factor.rotation.values.size() == 1) {
            factor.rest.rotation = factor.rotation.values[0];
            factor.rotation = {};
        }
        if (factor.scale.values.size() == 1) {
            factor.rest.scale = factor.scale.values[0];
            factor.scale = {};
        }
    }

    void emit(Index node, TrsTracks tracks) {
        Node& moved = scene_.nodes[node];
        if (!moved.trs) {
            moved.trs = trs_of(moved.transform);
            sheared_ += shear_of(moved.transform, *moved.trs) > least_shear;
            moved.transform = moved.trs->matrix();
        }
        start_at_zero(tracks.translation, counts_);
        start_at_zero(tracks.rotation, counts_);
        start_at_zero(tracks.scale, counts_);
        const auto vectors = [](const glm::dvec3& v, std::vector<float>& to) {
            for (int k = 0; k < 3; ++k) to.push_back(float(v[k]));
        };
        push(node, AnimationPath::translation, tracks.translation, vectors);
        push(node, AnimationPath::rotation, tracks.rotation,
             [](const glm::dquat& q, std::vector<float>& to) {
                 for (const double x : {q.x, q.y, q.z, q.w}) to.push_back(float(x));
             });
        push(node, AnimationPath::scale, tracks.scale, vectors);
    }

    template <class T, class Append>
    void push(Index node, AnimationPath path, const KeyTrack<T>& track, const Append& append) {
        if (track.empty()) return;
        if (!taken_.insert({node, path}).second) {
            ++second_channels_;
            return;
        }
        FloatTimes times = float_times(track.times, counts_);
        auto values = std::make_shared<std::vector<float>>();
        for (const std::size_t key : times.keys) append(track.values[key], *values);
        auto& shared = times_[times.times];
        if (!shared) shared = std::make_shared<const std::vector<float>>(times.times);
        AnimationChannel channel;
        channel.sampler = Index(out_.samplers.size());
        channel.node = node;
        channel.path = path;
        out_.samplers.push_back({Interpolation::linear, shared, std::move(values)});
        out_.channels.push_back(channel);
    }

    // Assimp names the node, for FBX with the number of the geometry behind a star, or the mesh.
    std::vector<Index> morphed_nodes(const aiString& name) const {
        std::vector<Index> found;
        const auto take = [&](Index n) {
            const Index mesh = scene_.nodes[n].mesh;
            if (mesh != no_index && !scene_.meshes[mesh].morph_targets.empty()) found.push_back(n);
        };
        std::string known = text(name);
        auto target = nodes_.by_name.find(known);
        if (target == nodes_.by_name.end()) {
            known = known.substr(0, known.rfind('*'));
            target = nodes_.by_name.find(known);
        }
        if (target != nodes_.by_name.end())
            for (const Index n : target->second.mesh_nodes) take(n);
        if (found.empty())
            for (Index n = 0; n < scene_.nodes.size(); ++n)
                if (scene_.nodes[n].mesh != no_index &&
                    scene_.meshes[scene_.nodes[n].mesh].name == text(name))
                    take(n);
        return found;
    }

    void morph(const aiMeshMorphAnim& in) {
        const std::vector<Index> nodes = morphed_nodes(in.mName);
        if (nodes.empty()) ++lost_channels_;
        for (const Index node : nodes) {
            const std::vector<MorphTarget>& targets =
                scene_.meshes[scene_.nodes[node].mesh].morph_targets;
            // A key tells the weights of some targets: each has keys of its own.
            std::vector<NumberTrack> tracks(targets.size());
            for (unsigned k = 0; k < in.mNumKeys; ++k) {
                const aiMeshMorphKey& key = in.mKeys[k];
                const double time = key.mTime / ticks_;
                for (unsigned v = 0; v < key.mNumValuesAndWeights; ++v) {
                    if (key.mValues[v] >= targets.size()) {
                        ++lost_weights_;
                    } else if (!std::isfinite(float(time)) ||
                               !std::isfinite(float(key.mWeights[v]))) {
                        ++counts_.not_finite;
                    } else {
                        tracks[key.mValues[v]].times.push_back(time);
                        tracks[key.mValues[v]].values.push_back(key.mWeights[v]);
                    }
                }
            }
            std::vector<double> times;
            for (NumberTrack& track : tracks) {
                clean(track, counts_);
                start_at_zero(track, counts_);
                times.insert(times.end(), track.times.begin(), track.times.end());
            }
            std::sort(times.begin(), times.end());
            times.erase(std::unique(times.begin(), times.end()), times.end());
            KeyTrack<std::size_t> keys;
            keys.times = std::move(times);
            for (std::size_t k = 0; k < keys.times.size(); ++k) keys.values.push_back(k);
            push(node, AnimationPath::weights, keys, [&](std::size_t k, std::vector<float>& to) {
                for (std::size_t t = 0; t < tracks.size(); ++t)
                    to.push_back(tracks[t].empty() ? targets[t].weight
                                                   : float(at(tracks[t], keys.times[k])));
            });
        }
    }

    void warn() {
        import_.warn(lost_channels_, "animation channel", "animation channels",
                     "of nodes or meshes that are not there: left out");
        import_.warn(lost_weights_, "weight", "weights",
                     "in animations of morph targets that are not there: left out");
        import_.warn(second_channels_, "animation channel", "animation channels",
                     "of nodes that the same animation moves already: left out");
        import_.warn(sheared_pivots_, "node", "nodes",
                     "whose animated pivots make no translation, rotation and scale: not animated");
        import_.warn(swapped_meshes_, "animation channel", "animation channels",
                     "that swap whole meshes, which glTF has not: left out");
        import_.warn(empty_, "animation", "animations", "without anything to move: left out");
        import_.warn(sheared_, "animated node", "animated nodes",
                     "with shear at rest, which animated nodes have not: the nearest without it");
        import_.warn(shared_names_.size(), "animated name", "animated names",
                     "that several nodes have: the first of them moves");
        import_.warn(other_ends_, "animation channel", "animation channels",
                     "going on before the first or after the last key: they stand still there");
        import_.warn(counts_.not_finite, "key", "keys",
                     "not finite, or rotations of no length: left out");
        import_.warn(counts_.unsorted, "key", "keys", "not in the order of their times: sorted");
        import_.warn(counts_.repeated, "key", "keys",
                     "at the time of others, or too close to them for floats: left out");
        import_.warn(counts_.negative, "key", "keys", "before the animation's start: cut there");
        import_.warn(counts_.added, "key", "keys",
                     "added so that what turns about a pivot keeps its distance between keys");
    }

    AssimpImport& import_;
    Scene& scene_;
    const AssimpNodes& nodes_;
    Animation out_;
    double ticks_ = usual_ticks_per_second;
    std::map<std::vector<float>, std::shared_ptr<const std::vector<float>>> times_;
    std::set<std::pair<Index, AnimationPath>> taken_;
    KeyCounts counts_;
    std::uint64_t lost_channels_ = 0, lost_weights_ = 0, second_channels_ = 0, sheared_pivots_ = 0,
                  swapped_meshes_ = 0, empty_ = 0, sheared_ = 0, other_ends_ = 0;
    std::set<std::string> shared_names_;
};

}  // namespace

void import_animations(AssimpImport& import) {
    AnimationImport(import).run();
}

}  // namespace prep::detail
