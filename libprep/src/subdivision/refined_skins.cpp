#include "subdivision/refined_skins.h"

#include <algorithm>

#include "base/parallel.h"

namespace prep::detail {
namespace {

std::vector<SparseValue> cage_weights(const Mesh& mesh) {
    std::vector<SparseValue> weights(mesh.vertex_count());
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
        auto& terms = weights[v].terms;
        const std::uint32_t file = mesh.file_vertex(v);
        for (const SkinInfluences& set : mesh.skin_influences)
            for (int k = 0; file < set.weights.size() && k < 4; ++k)
                if (const float weight = set.weights[file][k]; weight != 0)
                    terms.emplace_back(set.joints[file][k], weight);
        std::sort(terms.begin(), terms.end(), [](auto& a, auto& b) { return a.first < b.first; });
        std::size_t kept = 0;
        for (std::size_t k = 0; k < terms.size(); ++k) {
            if (kept > 0 && terms[kept - 1].first == terms[k].first)
                terms[kept - 1].second += terms[k].second;
            else
                terms[kept++] = terms[k];
        }
        terms.resize(kept);
    }
    return weights;
}

// The vertices whose values a node and what is below it read.
void collect_controls(const ChannelSurface& surface, std::uint32_t level, std::uint32_t face,
                      std::vector<std::uint32_t>& controls) {
    const PatchTree& tree = surface.tree;
    const PatchNode node = tree.nodes[level][face];
    const RefinedLevel& at = surface.cage.levels[level];
    const std::uint32_t corners = surface.cage.corners_per_face;
    const std::uint32_t begin = at.first_corner(face, corners);
    const std::uint32_t size =
        at.face_offsets.empty() ? corners : at.face_offsets[face + 1] - begin;
    for (std::uint32_t c = 0; c < size; ++c)
        controls.push_back(at.first_vertex + at.corner_vertices[begin + c]);
    if (node.kind == PatchNode::split)
        for (std::uint32_t c = 0; c < 4; ++c)
            collect_controls(surface, level + 1, at.first_child[face] + c, controls);
    if (node.kind == PatchNode::regular)
        tree.for_regular_controls(node.index, [&](std::uint32_t v) { controls.push_back(v); });
    if (node.kind == PatchNode::crease)
        for (const std::uint32_t v : tree.crease_patches[node.index].patch.controls)
            controls.push_back(v);
    if (node.kind != PatchNode::ring) return;
    const Ring& ring = tree.rings[tree.sectors[node.index].ring];
    const auto first = tree.ring_points.begin() + ring.first_point;
    controls.insert(controls.end(), first, first + ring.shape.point_count());
}

// One root's joints, and its controls' weights as rows over them.
struct LocalWeights {
    std::vector<std::uint32_t> controls, joints, slots;
    std::vector<double> rows;

    void gather(const ChannelSurface& surface, const std::vector<SparseValue>& weights,
                const PatchRoot& root) {
        slots.resize(weights.size());
        controls.clear();
        joints.clear();
        collect_controls(surface, root.level, root.face, controls);
        // Level 0 of an n-gon reads the cage itself.
        const RefinedLevel& base = surface.cage.levels[0];
        for (std::uint32_t c = base.face_offsets[root.cage_face];
             c < base.face_offsets[root.cage_face + 1]; ++c)
            controls.push_back(base.corner_vertices[c]);
        std::sort(controls.begin(), controls.end());
        controls.erase(std::unique(controls.begin(), controls.end()), controls.end());
        for (const std::uint32_t v : controls)
            for (const auto& [joint, weight] : weights[v].terms) joints.push_back(joint);
        std::sort(joints.begin(), joints.end());
        joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
        rows.assign(controls.size() * joints.size(), 0.0);
        for (std::uint32_t s = 0; s < controls.size(); ++s) {
            slots[controls[s]] = s;
            for (const auto& [joint, weight] : weights[controls[s]].terms) {
                const auto at =
                    std::lower_bound(joints.begin(), joints.end(), joint) - joints.begin();
                rows[s * joints.size() + std::size_t(at)] = weight;
            }
        }
    }
};

}  // namespace

float keep_largest(std::vector<std::pair<double, std::uint32_t>>& influences, double sum,
                   std::size_t most, std::vector<SkinInfluences>& sets, std::size_t vertex) {
    std::stable_sort(influences.begin(), influences.end(), [](const auto& a, const auto& b) {
        return std::abs(a.first) > std::abs(b.first);
    });
    if (influences.size() > most) influences.resize(most);
    double kept = 0;
    for (const auto& [weight, joint] : influences) kept += weight;
    const double scale = kept != 0 ? sum / kept : 1;
    for (std::size_t d = 0; d < influences.size(); ++d) {
        SkinInfluences& set = sets[d / 4];
        set.joints[vertex][int(d % 4)] = std::uint16_t(influences[d].second);
        set.weights[vertex][int(d % 4)] = float(influences[d].first * scale);
    }
    const double share = sum != 0 ? (sum - kept) / sum : 0;
    return share > 1e-9 ? float(share) : 0;  // not what rounding makes of it
}

RefinedSkins refined_skins(const UniformRefinement& refinement, const ChannelSurface& surface,
                           const GridNumbering& numbering) {
    const Mesh& mesh = refinement.mesh;
    const SubdivideOptions& options = refinement.options;
    RefinedSkins out;
    const std::size_t most = options.max_influences > 0 ? std::size_t(options.max_influences)
                                                        : 4 * mesh.skin_influences.size();
    out.sets.resize((most + 3) / 4);
    for (SkinInfluences& set : out.sets) {
        set.joints.assign(numbering.count(), glm::vec<4, std::uint16_t>(0));
        set.weights.assign(numbering.count(), glm::vec4(0.0F));
    }
    const std::vector<SparseValue> weights = surface.cage.refine(cage_weights(mesh));
    const GridTables tables(options.level, surface.tree.sharpnesses, refinement.triangles());
    // Few blocks: what one works in is as long as the list of all vertices.
    const std::size_t grain = std::max<std::size_t>(32, (refinement.roots.size() + 63) / 64);
    std::vector<float> dropped((refinement.roots.size() + grain - 1) / grain, 0.0F);
    parallel_blocks(
        refinement.roots.size(), grain, options.threads, [&](std::size_t begin, std::size_t end) {
            LocalWeights local;
            UniformRefinement::Scratch scratch;
            std::vector<std::pair<double, std::uint32_t>> order;
            for (std::size_t k = begin; k < end; ++k) {
                const std::uint32_t index = refinement.roots[k];
                const PatchRoot& root = surface.tree.roots[index];
                local.gather(surface, weights, root);
                const std::size_t width = local.joints.size();
                if (width == 0) continue;
                const SurfacePieces pieces{
                    &surface.cage,
                    &surface.tree,
                    {local.rows.data(), std::uint32_t(width), local.slots.data()},
                    nullptr};
                PatchEvaluator evaluator(pieces, options.simd);
                refinement.evaluate(root, index, numbering, pieces, evaluator, tables, false,
                                    scratch);
                for (std::size_t p = 0; p < scratch.ids.size(); ++p) {
                    if (!scratch.own[p]) continue;
                    order.clear();
                    double sum = 0;
                    for (std::size_t d = 0; d < width; ++d) {
                        const double weight = scratch.value[p * width + d];
                        sum += weight;
                        if (std::abs(weight) > 1e-12) order.emplace_back(weight, local.joints[d]);
                    }
                    const float lost = keep_largest(order, sum, most, out.sets, scratch.ids[p]);
                    dropped[begin / grain] = std::max(dropped[begin / grain], lost);
                }
            }
        });
    for (const float share : dropped) out.largest_dropped = std::max(out.largest_dropped, share);
    return out;
}

}  // namespace prep::detail
