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

// The vertices whose values a node and what is below it read; of rings, the rings.
void collect_controls(const ChannelSurface& surface, std::uint32_t level, std::uint32_t face,
                      std::vector<std::uint32_t>& controls, std::vector<std::uint32_t>& rings) {
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
            collect_controls(surface, level + 1, at.first_child[face] + c, controls, rings);
    if (node.kind == PatchNode::regular)
        tree.for_regular_controls(node.index, [&](std::uint32_t v) { controls.push_back(v); });
    if (node.kind == PatchNode::crease)
        for (const std::uint32_t v : tree.crease_patches[node.index].patch.controls)
            controls.push_back(v);
    if (node.kind == PatchNode::ring) rings.push_back(tree.sectors[node.index].ring);
}

// The first ring of many sectors below a node, or no_index.
std::uint32_t large_ring(const ChannelSurface& surface, std::uint32_t level, std::uint32_t face) {
    const PatchTree& tree = surface.tree;
    const PatchNode node = tree.nodes[level][face];
    if (node.kind == PatchNode::ring) {
        const std::uint32_t ring = tree.sectors[node.index].ring;
        return tree.rings[ring].shape.sectors >= many_sectors ? ring : no_index;
    }
    std::uint32_t first = no_index;
    if (node.kind == PatchNode::split)
        for (std::uint32_t c = 0; c < 4; ++c)
            first = std::min(first, large_ring(surface, level + 1,
                                               surface.cage.levels[level].first_child[face] + c));
    return first;
}

void sort_out(std::vector<std::uint32_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

// The joints of some roots, and their controls' weights as rows over them.
struct LocalWeights {
    std::vector<std::uint32_t> controls, rings, joints, slots;
    std::vector<double> rows;

    void gather(const ChannelSurface& surface, const std::vector<SparseValue>& weights,
                std::span<const std::uint32_t> roots) {
        slots.resize(weights.size());
        controls.clear();
        rings.clear();
        joints.clear();
        const RefinedLevel& base = surface.cage.levels[0];
        const PatchTree& tree = surface.tree;
        for (const std::uint32_t index : roots) {
            const PatchRoot& root = tree.roots[index];
            collect_controls(surface, root.level, root.face, controls, rings);
            // Level 0 of an n-gon reads the cage itself.
            const std::uint32_t first = base.face_offsets[root.cage_face];
            controls.push_back(base.corner_vertices[first + root.corner]);
        }
        sort_out(rings);
        for (const std::uint32_t ring : rings) {
            const auto first =
                tree.ring_points.begin() + std::ptrdiff_t(tree.rings[ring].first_point);
            controls.insert(controls.end(), first, first + tree.rings[ring].shape.point_count());
        }
        sort_out(controls);
        for (const std::uint32_t v : controls)
            for (const auto& [joint, weight] : weights[v].terms) joints.push_back(joint);
        sort_out(joints);
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

RootGroups::RootGroups(const ChannelSurface& surface, const std::vector<std::uint32_t>& kept) {
    const std::vector<Ring>& rings = surface.tree.rings;
    const bool any_large = std::any_of(rings.begin(), rings.end(), [](const Ring& ring) {
        return ring.shape.sectors >= many_sectors;
    });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> large;  // ring, root
    std::vector<std::uint32_t> alone;
    for (const std::uint32_t root : kept) {
        const PatchRoot& at = surface.tree.roots[root];
        const std::uint32_t ring = any_large ? large_ring(surface, at.level, at.face) : no_index;
        if (ring != no_index)
            large.emplace_back(ring, root);
        else
            alone.push_back(root);
    }
    std::sort(large.begin(), large.end());
    std::vector<std::span<const std::pair<std::uint32_t, std::uint32_t>>> groups;
    for (std::size_t k = 0, first = 0; k < large.size(); ++k)
        if (k + 1 == large.size() || large[k + 1].first != large[k].first) {
            groups.push_back(std::span(large).subspan(first, k + 1 - first));
            first = k + 1;
        }
    std::stable_sort(groups.begin(), groups.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    roots.reserve(kept.size());
    for (const auto& group : groups) {
        for (const auto& [ring, root] : group) roots.push_back(root);
        offsets.push_back(std::uint32_t(roots.size()));
    }
    for (const std::uint32_t root : alone) {
        roots.push_back(root);
        offsets.push_back(std::uint32_t(roots.size()));
    }
    // Few blocks: what one works in is as long as the list of all vertices.
    const std::size_t most = std::max<std::size_t>(32, (roots.size() + 63) / 64);
    for (std::uint32_t group = 1; group < count(); ++group)
        if (offsets[group + 1] - offsets[blocks.back()] > most) blocks.push_back(group);
    if (count() > 0) blocks.push_back(std::uint32_t(count()));
}

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
    const RootGroups groups(surface, refinement.roots);
    struct Told {
        float dropped = 0;
        std::uint64_t gathered = 0;
    };
    std::vector<Told> told(groups.blocks.size() - 1);
    parallel_blocks(told.size(), 1, options.threads, [&](std::size_t block, std::size_t) {
        LocalWeights local;
        UniformRefinement::Scratch scratch;
        std::vector<std::pair<double, std::uint32_t>> order;
        for (std::size_t k = groups.blocks[block]; k < groups.blocks[block + 1]; ++k) {
            local.gather(surface, weights, groups[k]);
            told[block].gathered += local.controls.size();
            const std::size_t width = local.joints.size();
            if (width == 0) continue;
            const SurfacePieces pieces{
                &surface.cage,
                &surface.tree,
                {local.rows.data(), std::uint32_t(width), local.slots.data()},
                nullptr};
            PatchEvaluator evaluator(pieces, options.simd);
            for (const std::uint32_t index : groups[k]) {
                refinement.evaluate(surface.tree.roots[index], index, numbering, pieces, evaluator,
                                    tables, false, scratch);
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
                    told[block].dropped = std::max(told[block].dropped, lost);
                }
            }
            told[block].gathered += evaluator.gathered_ring_points();
        }
    });
    for (const auto& [dropped, gathered] : told) {
        out.largest_dropped = std::max(out.largest_dropped, dropped);
        out.gathered += gathered;
    }
    return out;
}

}  // namespace prep::detail
