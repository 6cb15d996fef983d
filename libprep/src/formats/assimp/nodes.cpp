// The node hierarchy, with FBX's pivots multiplied into the node that they belong to.
#include <cmath>
#include <string_view>

#include "base/finite.h"
#include "formats/assimp/import.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Deeper than any real file; a longer chain is a broken or hostile one.
constexpr int max_depth = 2000;

// How Assimp names the nodes that it makes of FBX's pivots and offsets: name, tag, what it is.
constexpr std::string_view pivot_tag = "_$AssimpFbx$_";

std::string_view name_of(const aiNode& node) {
    return {node.mName.data, node.mName.length};
}
std::string_view pivot_of(const aiNode& node) {
    const std::size_t at = name_of(node).rfind(pivot_tag);
    return at == std::string_view::npos ? std::string_view()
                                        : name_of(node).substr(at + pivot_tag.size());
}
std::string name_without_tag(const aiNode& node) {
    return std::string(name_of(node).substr(0, name_of(node).rfind(pivot_tag)));
}

bool is_identity(const glm::dmat4& m) {
    double worst = 0;
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) worst = std::max(worst, std::abs(m[c][r] - (c == r ? 1 : 0)));
    return worst < 1e-5;  // products of floats with their inverses
}

class NodeImport {
  public:
    explicit NodeImport(AssimpImport& import) : scene_(import.scene), nodes_(import.nodes) {}

    bool add(const aiNode& in, Index parent, int depth) {
        if (depth > max_depth) return false;
        std::vector<const aiNode*> chain;
        const aiNode* last = &in;
        while (!pivot_of(*last).empty() && last->mNumMeshes == 0 && last->mNumChildren == 1 &&
               ++depth <= max_depth) {
            chain.push_back(last);
            last = last->mChildren[0];
        }
        if (depth > max_depth) return false;
        if (chain.empty()) return add_plain(in, parent, depth);
        return add_resolved(chain, *last, parent, depth);
    }

  private:
    Index push(std::string name, Index parent, const glm::dmat4& transform) {
        Node node;
        node.name = std::move(name);
        node.parent = parent;
        node.transform = transform;
        scene_.nodes.push_back(std::move(node));
        return Index(scene_.nodes.size() - 1);
    }

    AssimpNodes::Target& remember(const aiNode& in, Index animated, Index frame) {
        const auto [at, fresh] = nodes_.by_name.try_emplace(text(in.mName));
        if (fresh) {
            at->second.animated = animated;
            at->second.frame = frame;
        } else {
            nodes_.repeated_names.insert(text(in.mName));
        }
        return at->second;
    }

    std::vector<Index> attach_meshes(const aiNode& in, Index self) {
        std::vector<Index> holders;
        if (in.mNumMeshes == 1 && in.mMeshes[0] < scene_.meshes.size()) {
            scene_.nodes[self].mesh = in.mMeshes[0];
            holders.push_back(self);
        }
        if (in.mNumMeshes > 1)
            for (unsigned m = 0; m < in.mNumMeshes; ++m) {
                if (in.mMeshes[m] >= scene_.meshes.size()) continue;
                Node child;
                child.name = scene_.meshes[in.mMeshes[m]].name;
                child.parent = self;
                child.mesh = in.mMeshes[m];
                holders.push_back(Index(scene_.nodes.size()));
                scene_.nodes.push_back(std::move(child));
            }
        return holders;
    }

    bool add_plain(const aiNode& in, Index parent, int depth) {
        const bool tagged = !pivot_of(in).empty();
        const Index self = push(tagged ? name_without_tag(in) : text(in.mName), parent,
                                matrix(in.mTransformation));
        AssimpNodes::Target& target = remember(in, self, self);
        std::vector<Index> holders = attach_meshes(in, self);
        if (target.animated == self) target.mesh_nodes = std::move(holders);
        return add_children(in, self, depth);
    }

    bool add_children(const aiNode& in, Index self, int depth) {
        for (unsigned c = 0; c < in.mNumChildren; ++c)
            if (!add(*in.mChildren[c], self, depth + 1)) return false;
        return true;
    }

    // The chain is translation · … · scale · … (what animations move) and then the geometric
    // transform, which belongs to the meshes alone: nodes that undo it stand above the children.
    bool add_resolved(const std::vector<const aiNode*>& chain, const aiNode& last, Index parent,
                      int depth) {
        glm::dmat4 product(1.0), geometric(1.0);
        std::vector<PivotFactor> factors;
        for (const aiNode* part : chain) {
            const glm::dmat4 m = matrix(part->mTransformation);
            if (pivot_of(*part).starts_with("Geometric")) {
                geometric = geometric * m;
            } else {
                product = product * m;
                factors.push_back({part, m});
            }
        }
        const bool apart = !is_identity(geometric);
        const glm::dmat4 own = matrix(last.mTransformation);
        if (!apart) {
            product = product * own;
            factors.push_back({&last, own});
        }
        const std::string name = pivot_of(last).empty() ? text(last.mName) : name_without_tag(last);
        const Index self = push(name, parent, product);
        const Index frame = apart ? push(name + " geometry", self, geometric * own) : self;
        for (const aiNode* part : chain) remember(*part, self, self);
        AssimpNodes::Target& target = remember(last, self, frame);
        std::vector<Index> holders = attach_meshes(last, frame);
        if (target.animated == self) target.mesh_nodes = std::move(holders);
        nodes_.factors.emplace(self, std::move(factors));
        if (!apart) return add_children(last, self, depth);
        for (unsigned c = 0; c < last.mNumChildren; ++c) {
            const aiNode* below = last.mChildren[c];
            glm::dmat4 undone = geometric * own;
            bool undoes = false;
            while (pivot_of(*below).starts_with("Geometric") && below->mNumMeshes == 0 &&
                   ++depth <= max_depth) {
                undone = undone * matrix(below->mTransformation);
                undoes = true;
                if (below->mNumChildren != 1) break;
                if (!pivot_of(*below->mChildren[0]).starts_with("Geometric")) break;
                below = below->mChildren[0];
            }
            if (depth > max_depth) return false;
            if (!undoes) {
                if (!add(*below, frame, depth + 1)) return false;
                continue;
            }
            const Index under = is_identity(undone) ? self : push(name + " children", self, undone);
            if (!add_children(*below, under, depth + 1)) return false;
        }
        return true;
    }

    Scene& scene_;
    AssimpNodes& nodes_;
};

}  // namespace

bool is_pivot(const aiString& name) {
    return std::string_view(name.data, name.length).find(pivot_tag) != std::string_view::npos;
}

Result<void> import_nodes(AssimpImport& import) {
    NodeImport nodes(import);
    if (import.from.mRootNode && !nodes.add(*import.from.mRootNode, no_index, 0))
        return Error{
            ErrorCode::limit,
            "the scene graph is nested more than " + std::to_string(max_depth) + " nodes deep",
            import.path.string()};
    for (const Node& node : import.scene.nodes)
        for (int c = 0; c < 4; ++c)
            if (!is_finite(node.transform[c]))
                return Error{ErrorCode::invalid,
                             "the transform of node '" + node.name + "' is not finite",
                             import.path.string()};
    return {};
}

}  // namespace prep::detail
