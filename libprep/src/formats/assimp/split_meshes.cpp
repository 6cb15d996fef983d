#include "formats/assimp/split_meshes.h"

#include <assimp/scene.h>

#include <algorithm>
#include <bit>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "formats/assimp/import.h"

namespace prep::detail {
namespace {

using MeshNumbers = std::vector<unsigned>;

// The arrays of all parts, one after the other; null where no part has it. `list`: what a part has,
// `otherwise`: what stands for it where it has none and is nothing but 0 where that is null, too.
template <class T, class List, class Otherwise>
T* joined(const std::vector<const aiMesh*>& parts, unsigned count, List list, Otherwise otherwise) {
    if (std::none_of(parts.begin(), parts.end(), [&](const aiMesh* m) { return list(*m); }))
        return nullptr;
    T* const out = new T[count];
    T* to = out;
    for (const aiMesh* part : parts) {
        const T* from = list(*part);
        if (!from) from = otherwise(*part);
        to = from ? std::copy_n(from, part->mNumVertices, to)
                  : std::fill_n(to, part->mNumVertices, T());
    }
    return out;
}
template <class T, class List>
T* joined(const std::vector<const aiMesh*>& parts, unsigned count, List list) {
    return joined<T>(parts, count, list, [](const aiMesh&) -> const T* { return nullptr; });
}

void join_faces(const std::vector<const aiMesh*>& parts, aiMesh& out) {
    for (const aiMesh* part : parts) out.mNumFaces += part->mNumFaces;
    out.mFaces = new aiFace[out.mNumFaces];
    aiFace* face = out.mFaces;
    unsigned first = 0;
    for (const aiMesh* part : parts) {
        for (unsigned f = 0; f < part->mNumFaces; ++f, ++face) {
            *face = part->mFaces[f];
            for (unsigned k = 0; k < face->mNumIndices; ++k) face->mIndices[k] += first;
        }
        first += part->mNumVertices;
    }
}

// A bone of several parts is one where it is bound alike.
void join_bones(const std::vector<const aiMesh*>& parts, aiMesh& out) {
    using Key = std::pair<std::string, std::string>;  // its name, and the bytes of the matrix
    std::map<Key, std::size_t> known;
    std::vector<std::unique_ptr<aiBone>> bones;
    std::vector<std::vector<aiVertexWeight>> weights;
    unsigned first = 0;
    for (const aiMesh* part : parts) {
        for (unsigned b = 0; b < part->mNumBones; ++b) {
            const aiBone& from = *part->mBones[b];
            Key key{std::string(from.mName.data, from.mName.length),
                    std::string(reinterpret_cast<const char*>(&from.mOffsetMatrix),
                                sizeof from.mOffsetMatrix)};
            const auto [at, fresh] = known.emplace(std::move(key), bones.size());
            if (fresh) {
                bones.push_back(std::make_unique<aiBone>());
                bones.back()->mName = from.mName;
                bones.back()->mOffsetMatrix = from.mOffsetMatrix;
                weights.emplace_back();
            }
            for (unsigned w = 0; w < from.mNumWeights; ++w) {
                // One of a vertex that is not there must not become another part's.
                if (from.mWeights[w].mVertexId >= part->mNumVertices) continue;
                weights[at->second].emplace_back(first + from.mWeights[w].mVertexId,
                                                 from.mWeights[w].mWeight);
            }
        }
        first += part->mNumVertices;
    }
    if (bones.empty()) return;
    out.mNumBones = unsigned(bones.size());
    out.mBones = new aiBone*[bones.size()]();
    for (std::size_t b = 0; b < bones.size(); ++b) {
        bones[b]->mNumWeights = unsigned(weights[b].size());
        bones[b]->mWeights = new aiVertexWeight[weights[b].size()];
        std::copy(weights[b].begin(), weights[b].end(), bones[b]->mWeights);
        out.mBones[b] = bones[b].release();
    }
}

// A target leads to positions, not by differences: what a part's has not stays where it is.
void join_targets(const std::vector<const aiMesh*>& parts, aiMesh& out) {
    out.mNumAnimMeshes = parts[0]->mNumAnimMeshes;
    if (out.mNumAnimMeshes == 0) return;
    out.mAnimMeshes = new aiAnimMesh*[out.mNumAnimMeshes]();
    for (unsigned t = 0; t < out.mNumAnimMeshes; ++t) {
        aiAnimMesh& target = *(out.mAnimMeshes[t] = new aiAnimMesh());
        target.mName = parts[0]->mAnimMeshes[t]->mName;
        target.mWeight = parts[0]->mAnimMeshes[t]->mWeight;
        target.mNumVertices = out.mNumVertices;
        const auto vectors = [&](aiVector3D* aiAnimMesh::*list, aiVector3D* aiMesh::*otherwise) {
            return joined<aiVector3D>(
                parts, out.mNumVertices, [&](const aiMesh& m) { return m.mAnimMeshes[t]->*list; },
                [&](const aiMesh& m) { return m.*otherwise; });
        };
        target.mVertices = vectors(&aiAnimMesh::mVertices, &aiMesh::mVertices);
        target.mNormals = vectors(&aiAnimMesh::mNormals, &aiMesh::mNormals);
        target.mTangents = vectors(&aiAnimMesh::mTangents, &aiMesh::mTangents);
        target.mBitangents = vectors(&aiAnimMesh::mBitangents, &aiMesh::mBitangents);
        for (unsigned s = 0; s < AI_MAX_NUMBER_OF_TEXTURECOORDS; ++s)
            target.mTextureCoords[s] = joined<aiVector3D>(
                parts, out.mNumVertices,
                [&](const aiMesh& m) { return m.mAnimMeshes[t]->mTextureCoords[s]; },
                [&](const aiMesh& m) { return m.mTextureCoords[s]; });
        for (unsigned s = 0; s < AI_MAX_NUMBER_OF_COLOR_SETS; ++s)
            target.mColors[s] = joined<aiColor4D>(
                parts, out.mNumVertices,
                [&](const aiMesh& m) { return m.mAnimMeshes[t]->mColors[s]; },
                [&](const aiMesh& m) { return m.mColors[s]; });
    }
}

std::unique_ptr<aiMesh> joined_mesh(const std::vector<const aiMesh*>& parts) {
    auto out = std::make_unique<aiMesh>();
    out->mName = parts[0]->mName;
    out->mMaterialIndex = parts[0]->mMaterialIndex;
    out->mMethod = parts[0]->mMethod;
    for (const aiMesh* part : parts) {
        out->mNumVertices += part->mNumVertices;
        out->mPrimitiveTypes |= part->mPrimitiveTypes;
        for (unsigned s = 0; s < AI_MAX_NUMBER_OF_TEXTURECOORDS; ++s) {
            out->mNumUVComponents[s] =
                std::max(out->mNumUVComponents[s], part->mNumUVComponents[s]);
            if (part->HasTextureCoordsName(s) && !out->HasTextureCoordsName(s))
                out->SetTextureCoordsName(s, *part->mTextureCoordsNames[s]);
        }
    }
    const auto vectors = [&](aiVector3D* aiMesh::*list) {
        return joined<aiVector3D>(parts, out->mNumVertices,
                                  [&](const aiMesh& m) { return m.*list; });
    };
    out->mVertices = vectors(&aiMesh::mVertices);
    out->mNormals = vectors(&aiMesh::mNormals);
    out->mTangents = vectors(&aiMesh::mTangents);
    out->mBitangents = vectors(&aiMesh::mBitangents);
    for (unsigned s = 0; s < AI_MAX_NUMBER_OF_TEXTURECOORDS; ++s)
        out->mTextureCoords[s] = joined<aiVector3D>(
            parts, out->mNumVertices, [&](const aiMesh& m) { return m.mTextureCoords[s]; });
    for (unsigned s = 0; s < AI_MAX_NUMBER_OF_COLOR_SETS; ++s)
        out->mColors[s] = joined<aiColor4D>(parts, out->mNumVertices,
                                            [&](const aiMesh& m) { return m.mColors[s]; });
    join_faces(parts, *out);
    join_bones(parts, *out);
    join_targets(parts, *out);
    return out;
}

template <class T, std::size_t n>
unsigned bits_of(T* const (&sets)[n]) {
    unsigned bits = 0;
    for (std::size_t s = 0; s < n; ++s) bits |= unsigned(sets[s] != nullptr) << s;
    return bits;
}

bool is_bare(const aiNode& node) {
    return node.mNumMeshes == 1 && node.mNumChildren == 0 && node.mTransformation.IsIdentity();
}

// Readers that give the parts of a mesh no name, and a node one mesh alone.
bool splits_unnamed_meshes(const aiScene& scene) {
    return is_by(scene, "AC3D Importer") || is_by(scene, "ASE Importer") ||
           is_by(scene, "LightWave/Modo Object Importer");
}

// Children of the root that are the parts of one mesh.
struct Run {
    unsigned begin = 0, end = 0;
    std::unique_ptr<unsigned[]> meshes;
};

// Those of one name, in a row.
std::vector<Run> runs_of_parts(const aiScene& scene) {
    const aiNode& root = *scene.mRootNode;
    const auto name = [&](unsigned child) -> const aiString* {
        const aiNode& node = *root.mChildren[child];
        return is_bare(node) && node.mMeshes[0] < scene.mNumMeshes
                   ? &scene.mMeshes[node.mMeshes[0]]->mName
                   : nullptr;
    };
    std::vector<Run> runs;
    for (unsigned begin = 0, end = 0; begin < root.mNumChildren; begin = end) {
        const aiString* const first = name(begin);
        for (end = begin + 1; first && end < root.mNumChildren; ++end)
            if (const aiString* const next = name(end); !next || !(*next == *first)) break;
        if (end - begin < 2) continue;
        Run run{begin, end, std::make_unique<unsigned[]>(end - begin)};
        for (unsigned c = begin; c < end; ++c)
            run.meshes[c - begin] = root.mChildren[c]->mMeshes[0];
        runs.push_back(std::move(run));
    }
    return runs;
}

// Files of 3DS without a hierarchy: each part has a node of its own below the root.
void gather_parts(aiScene& scene) {
    std::vector<Run> runs = runs_of_parts(scene);
    // From here on nothing throws.
    aiNode& root = *scene.mRootNode;
    for (Run& run : runs) {
        aiNode& node = *root.mChildren[run.begin];
        delete[] std::exchange(node.mMeshes, run.meshes.release());
        node.mNumMeshes = run.end - run.begin;
        for (unsigned c = run.begin + 1; c < run.end; ++c)
            delete std::exchange(root.mChildren[c], nullptr);
    }
    root.mNumChildren = unsigned(std::remove(root.mChildren, root.mChildren + root.mNumChildren,
                                             static_cast<aiNode*>(nullptr)) -
                                 root.mChildren);
}

// Of where its vertices are.
std::uint64_t hash_of_points(const aiMesh& mesh) {
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a, by words
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
        for (unsigned k = 0; k < 3; ++k)
            hash = (hash ^ std::bit_cast<std::uint32_t>(mesh.mVertices[v][k])) * 0x100000001b3;
    return hash;
}

class Joiner {
  public:
    Joiner(aiScene& scene, bool unnamed_too)
        : scene_(scene), unnamed_too_(unnamed_too), hashes_(scene.mNumMeshes) {}

    MeshParts run() {
        Nodes nodes;
        std::vector<aiNode*> open{scene_.mRootNode};
        while (!open.empty()) {
            aiNode* const node = open.back();
            open.pop_back();
            if (!node) continue;
            open.insert(open.end(), node->mChildren, node->mChildren + node->mNumChildren);
            if (node->mNumMeshes > 0) nodes.emplace_back(node, groups(*node));
        }
        if (!any_) return {};
        leave_shared_parts(nodes);
        // By their numbers, so that the order of meshes is that of their first parts.
        std::map<MeshNumbers, unsigned> places;
        std::vector<bool> used(scene_.mNumMeshes, false);
        for (const auto& [node, of_node] : nodes)
            for (const MeshNumbers& group : of_node) {
                places.emplace(group, 0);
                for (const unsigned m : group) used[m] = true;
            }
        for (unsigned m = 0; m < scene_.mNumMeshes; ++m)
            if (!used[m]) places.emplace(MeshNumbers{m}, 0);
        rebuild(places);
        for (auto& [node, of_node] : nodes) {
            node->mNumMeshes = unsigned(of_node.size());
            for (std::size_t g = 0; g < of_node.size(); ++g)
                node->mMeshes[g] = places.at(of_node[g]);
        }
        return std::move(parts_);
    }

  private:
    using Nodes = std::vector<std::pair<aiNode*, std::vector<MeshNumbers>>>;

    // Each part is in one group, whichever nodes have it: else a large one would be copied for each
    // of the small ones beside it.
    void leave_shared_parts(Nodes& nodes) const {
        std::vector<const MeshNumbers*> group_of(scene_.mNumMeshes, nullptr);
        std::vector<bool> shared(scene_.mNumMeshes, false);
        for (const auto& [node, groups] : nodes)
            for (const MeshNumbers& group : groups)
                for (const unsigned m : group) {
                    if (group_of[m] && *group_of[m] != group) shared[m] = true;
                    group_of[m] = &group;
                }
        for (auto& [node, groups] : nodes) {
            std::vector<MeshNumbers> kept;
            for (MeshNumbers& group : groups)
                if (std::none_of(group.begin(), group.end(), [&](unsigned m) { return shared[m]; }))
                    kept.push_back(std::move(group));
                else
                    for (const unsigned m : group) kept.push_back({m});
            groups = std::move(kept);
        }
    }

    // Of one name.
    bool are_one(unsigned a, unsigned b) const {
        const aiMesh &first = *scene_.mMeshes[a], &second = *scene_.mMeshes[b];
        if (first.mName.length == 0 && !unnamed_too_) return false;
        if (first.mNumAnimMeshes != second.mNumAnimMeshes) return false;
        for (const aiMesh* mesh : {&first, &second})
            for (unsigned t = 0; t < mesh->mNumAnimMeshes; ++t)
                if (mesh->mAnimMeshes[t]->mNumVertices != mesh->mNumVertices) return false;
        return true;
    }

    // Not those of a part that is there; then they are there, too.
    bool are_other_points(std::set<std::uint64_t>& known, unsigned first, unsigned next) {
        if (known.empty()) known.insert(points_of(first));
        return known.insert(points_of(next)).second;
    }
    std::uint64_t points_of(unsigned mesh) {
        std::optional<std::uint64_t>& hash = hashes_[mesh];
        if (!hash) hash = hash_of_points(*scene_.mMeshes[mesh]);
        return *hash;
    }

    // What the node has, in the order in which it names the first of each.
    std::vector<MeshNumbers> groups(const aiNode& node) {
        std::vector<MeshNumbers> out;
        struct Open {
            std::size_t group;
            std::uint64_t vertices;
            std::set<std::uint64_t> points;  // of its parts
        };
        std::map<std::string, Open> by_name;
        std::set<unsigned> seen;
        for (unsigned i = 0; i < node.mNumMeshes; ++i) {
            const unsigned m = node.mMeshes[i];
            if (m >= scene_.mNumMeshes) continue;
            const aiMesh& mesh = *scene_.mMeshes[m];
            const auto [at, fresh] =
                by_name.emplace(std::string(mesh.mName.data, mesh.mName.length), Open{});
            Open& open = at->second;
            if (seen.insert(m).second && !fresh && are_one(out[open.group][0], m) &&
                open.vertices + mesh.mNumVertices <= AI_MAX_VERTICES &&
                are_other_points(open.points, out[open.group][0], m)) {
                out[open.group].push_back(m);
                open.vertices += mesh.mNumVertices;
                any_ = true;
                continue;
            }
            open = {out.size(), mesh.mNumVertices, {}};
            out.push_back({m});
        }
        return out;
    }

    std::unique_ptr<aiMesh> join(const MeshNumbers& group, std::vector<MeshPart>& parts) const {
        std::vector<const aiMesh*> from;
        unsigned first = 0;
        for (const unsigned m : group) {
            const aiMesh& mesh = *scene_.mMeshes[m];
            from.push_back(&mesh);
            parts.push_back({first, mesh.mMaterialIndex, mesh.mNormals != nullptr,
                             mesh.mTangents && mesh.mBitangents, bits_of(mesh.mTextureCoords),
                             bits_of(mesh.mColors)});
            first += mesh.mNumVertices;
        }
        return joined_mesh(from);
    }

    // The scene's list of meshes, as `places` has them; their new numbers go there.
    void rebuild(std::map<MeshNumbers, unsigned>& places) {
        std::vector<std::unique_ptr<aiMesh>> made;
        for (auto& [group, place] : places) {
            place = unsigned(made.size());
            std::vector<MeshPart>& parts = parts_.emplace_back();
            made.push_back(group.size() > 1 ? join(group, parts) : nullptr);
        }
        auto list = std::make_unique<aiMesh*[]>(made.size());
        // From here on nothing throws.
        for (const auto& [group, place] : places)
            list[place] = group.size() > 1 ? made[place].release()
                                           : std::exchange(scene_.mMeshes[group[0]], nullptr);
        for (unsigned m = 0; m < scene_.mNumMeshes; ++m) delete scene_.mMeshes[m];
        delete[] std::exchange(scene_.mMeshes, list.release());
        scene_.mNumMeshes = unsigned(made.size());
    }

    aiScene& scene_;
    const bool unnamed_too_;
    std::vector<std::optional<std::uint64_t>> hashes_;  // by mesh
    bool any_ = false;                                  // group of several
    MeshParts parts_;
};

}  // namespace

MeshParts join_split_meshes(aiScene& scene) {
    if (scene.mRootNode && is_by(scene, "Discreet 3DS Importer")) gather_parts(scene);
    return Joiner(scene, splits_unnamed_meshes(scene)).run();
}

}  // namespace prep::detail
