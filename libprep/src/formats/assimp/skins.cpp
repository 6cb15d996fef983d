// Bones into skins: a list of joints with their inverse bind matrices for each mesh, and each
// vertex' influences in sets of four, the strongest first, their sum 1.
#include <algorithm>
#include <cmath>
#include <set>

#include "formats/assimp/import.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Sixteen sets; beyond them the weakest are left out. No exporter has more than 32.
constexpr std::size_t most_influences = 64;
constexpr std::size_t most_joints = 65535;  // joints are 16-bit in glTF

struct Influence {
    Index joint;
    double weight;
};

class SkinImport {
  public:
    explicit SkinImport(AssimpImport& import) : import_(import), scene_(import.scene) {}

    void run() {
        for (unsigned m = 0; m < import_.from.mNumMeshes; ++m)
            if (import_.from.mMeshes[m]->mNumBones > 0) mesh(m);
        import_.warn(lost_bones_, "bone", "bones", "without a node of that name: left out");
        import_.warn(beyond_, "bone", "bones",
                     "beyond the " + std::to_string(most_joints) +
                         " that a skin can number left out with their weights");
        import_.warn(bad_weights_, "weight", "weights",
                     "of bones negative, not finite or of a vertex that is not there: left out");
        import_.warn(
            too_many_, "influence", "influences",
            "beyond the " + std::to_string(most_influences) + " strongest of a vertex left out");
        import_.warn(loose_, "vertex", "vertices",
                     "of skinned meshes without a weight: they follow the node of the mesh");
        import_.warn(shared_names_.size(), "bone", "bones",
                     "whose name several nodes have: the first of them is taken");
    }

  private:
    std::vector<std::vector<Influence>> influences(const aiMesh& in, Skin& skin) {
        std::vector<std::vector<Influence>> of_vertices(in.mNumVertices);
        for (unsigned b = 0; b < in.mNumBones; ++b) {
            if (skin.joints.size() >= most_joints) {
                beyond_ += in.mNumBones - b;
                break;
            }
            const aiBone& bone = *in.mBones[b];
            const AssimpNodes::Target* target = import_.nodes.find(bone.mName);
            if (!target) {
                ++lost_bones_;
                continue;  // its vertices are loose
            }
            if (import_.nodes.repeated_names.contains(text(bone.mName)))
                shared_names_.insert(text(bone.mName));
            const Index joint =
                joint_of(skin, target->frame, glm::mat4(matrix(bone.mOffsetMatrix)));
            for (unsigned w = 0; w < bone.mNumWeights; ++w) {
                const aiVertexWeight& weight = bone.mWeights[w];
                if (weight.mVertexId >= in.mNumVertices || !std::isfinite(weight.mWeight) ||
                    weight.mWeight < 0)
                    ++bad_weights_;
                else if (weight.mWeight > 0)
                    add(of_vertices[weight.mVertexId], joint, weight.mWeight);
            }
        }
        return of_vertices;
    }

    // A node is a joint once. Where it is bound in two ways, the second gets a node that stands
    // still in it.
    Index joint_of(Skin& skin, Index node, const glm::mat4& inverse_bind) {
        const auto found = std::find(skin.joints.begin(), skin.joints.end(), node);
        if (found != skin.joints.end()) {
            const Index joint = Index(found - skin.joints.begin());
            if (skin.inverse_bind[joint] == inverse_bind) return joint;
            Node below;
            below.name = scene_.nodes[node].name;
            below.parent = node;
            node = Index(scene_.nodes.size());
            scene_.nodes.push_back(std::move(below));
        }
        skin.joints.push_back(node);
        skin.inverse_bind.push_back(inverse_bind);
        return Index(skin.joints.size() - 1);
    }

    static void add(std::vector<Influence>& list, Index joint, double weight) {
        for (Influence& there : list)
            if (there.joint == joint) {
                there.weight += weight;
                return;
            }
        list.push_back({joint, weight});
    }

    void mesh(Index m) {
        const aiMesh& in = *import_.from.mMeshes[m];
        Mesh& mesh = scene_.meshes[m];
        Skin skin;
        skin.name = mesh.name;
        std::vector<std::vector<Influence>> of_vertices = influences(in, skin);
        if (skin.joints.empty()) return;

        std::size_t most = 1;
        std::uint64_t loose = 0;
        for (std::vector<Influence>& list : of_vertices) {
            std::stable_sort(list.begin(), list.end(), [](const Influence& a, const Influence& b) {
                return a.weight > b.weight;
            });
            if (list.size() > most_influences) {
                too_many_ += list.size() - most_influences;
                list.resize(most_influences);
            }
            most = std::max(most, list.size());
            loose += list.empty();
        }
        loose_ += loose;
        const Index own = Index(skin.joints.size());  // the mesh's own node, where needed
        const std::size_t sets = (most + 3) / 4;
        mesh.skin_influences.assign(sets, {});
        for (SkinInfluences& set : mesh.skin_influences) {
            set.joints.assign(in.mNumVertices, glm::vec<4, std::uint16_t>(0));
            set.weights.assign(in.mNumVertices, glm::vec4(0.0f));
        }
        for (unsigned v = 0; v < in.mNumVertices; ++v) {
            std::vector<Influence>& list = of_vertices[v];
            if (list.empty()) list.push_back({own, 1});
            double sum = 0;
            for (const Influence& i : list) sum += i.weight;
            for (std::size_t k = 0; k < list.size(); ++k) {
                SkinInfluences& set = mesh.skin_influences[k / 4];
                set.joints[v][int(k % 4)] = std::uint16_t(list[k].joint);
                set.weights[v][int(k % 4)] = float(list[k].weight / sum);
            }
        }
        attach(m, std::move(skin), loose > 0);
    }

    // To every node that has the mesh. Vertices that no bone moves have the node for a joint.
    void attach(Index m, Skin skin, bool own_node) {
        const std::size_t nodes = scene_.nodes.size();
        Index shared = no_index;
        for (Index n = 0; n < nodes; ++n) {
            if (scene_.nodes[n].mesh != m) continue;
            if (own_node) {
                Skin of_node = skin;
                own_joint(of_node, n);
                scene_.nodes[n].skin = push(std::move(of_node));
            } else {
                if (shared == no_index) shared = push(skin);
                scene_.nodes[n].skin = shared;
            }
        }
    }

    // Always a new joint, whose number the vertices have already.
    void own_joint(Skin& skin, Index node) {
        const std::size_t before = skin.joints.size();
        if (joint_of(skin, node, glm::mat4(1.0f)) < before) {
            Node below;
            below.name = scene_.nodes[node].name;
            below.parent = node;
            skin.joints.push_back(Index(scene_.nodes.size()));
            skin.inverse_bind.push_back(glm::mat4(1.0f));
            scene_.nodes.push_back(std::move(below));
        }
    }

    // Meshes of several materials come in parts with the same bones.
    Index push(Skin skin) {
        for (Index s = 0; s < scene_.skins.size(); ++s)
            if (scene_.skins[s].joints == skin.joints &&
                scene_.skins[s].inverse_bind == skin.inverse_bind)
                return s;
        scene_.skins.push_back(std::move(skin));
        return Index(scene_.skins.size() - 1);
    }

    AssimpImport& import_;
    Scene& scene_;
    std::uint64_t lost_bones_ = 0, beyond_ = 0, bad_weights_ = 0, too_many_ = 0, loose_ = 0;
    std::set<std::string> shared_names_;
};

}  // namespace

void import_skins(AssimpImport& import) {
    SkinImport(import).run();
}

}  // namespace prep::detail
