#include "tessellation/root_heights.h"

#include <algorithm>

#include "base/finite.h"

namespace prep::detail {

Result<RootHeights> RootHeights::make(const Mesh& mesh, const Domain& domain,
                                      const BaseSurface& base, const TessellateOptions& options) {
    RootHeights heights;
    heights.domain_ = &domain;
    if (options.displacements.empty()) return heights;
    heights.displacements_ = options.displacements;
    const std::string name = mesh.name.empty() ? "" : "mesh '" + mesh.name + "', ";
    heights.which_.assign(domain.roots.size(), no_index);
    heights.corners_.resize(domain.roots.size());
    const auto choice = [&](std::uint32_t face) -> std::uint32_t {
        const auto& table = options.material_displacements;
        if (table.empty()) return 0;
        const std::uint32_t m = mesh.face_materials.empty() ? no_index : mesh.face_materials[face];
        return m < table.size() ? table[m] : no_index;
    };
    for (std::uint32_t fan = 0; fan < domain.fans(); ++fan) {
        const std::uint32_t face = domain.roots[domain.fan_roots[fan]].face;
        const std::uint32_t k = choice(face);
        if (k == no_index) continue;
        const Displacement& displacement = options.displacements[k];
        const std::uint32_t first = domain.fan_roots[fan], last = domain.fan_roots[fan + 1];
        if (displacement.height || displacement.noise || displacement.vector)
            for (std::uint32_t r = first; r < last; ++r) heights.which_[r] = k;
        if (!displacement.height && !displacement.vector) continue;
        const std::size_t set = displacement.uv_set;
        const auto place = [&] { return name + "face " + std::to_string(face); };
        if (set >= mesh.uvs.size() || mesh.uvs[set].empty())
            return Error{ErrorCode::invalid,
                         "its displacement reads UV set " + std::to_string(set) +
                             ", which the mesh does not have: unwrap it, or name another set",
                         place()};
        const CornerLayer<glm::vec2>& layer = mesh.uvs[set];
        const auto at = [&](std::uint32_t c) { return glm::dvec2(layer.values[layer.indices[c]]); };
        glm::dvec2 sum(0.0);
        bool covered = true;
        for_fan_corners(domain, fan, [&](std::uint32_t c) {
            covered = covered && layer.indices[c] != no_index && is_finite(at(c));
            if (covered) sum += at(c);
        });
        if (!covered)
            return Error{ErrorCode::invalid,
                         "a corner has no UV of set " + std::to_string(set) +
                             " that is a number, but its displacement reads it",
                         place()};
        const glm::dvec2 centre = sum / double(last - first);
        for (std::uint32_t r = first; r < last; ++r)
            heights.corners_[r] = {at(domain.roots[r].corners[0]), at(domain.roots[r].corners[1]),
                                   centre};
        if (!displacement.vector || !displacement.tangent_space || heights.frames_.contains(set))
            continue;
        auto frames = TangentFrames::make(mesh, domain, base, set, options.threads);
        if (!frames) return std::move(frames).error();
        heights.frames_.emplace(set, *std::move(frames));
    }
    return heights;
}

RootHeights RootHeights::noise_alone() const {
    RootHeights alone;
    alone.domain_ = domain_;
    alone.which_ = which_;
    alone.corners_ = corners_;
    for (const Displacement& of : displacements_) {
        Displacement noise;
        noise.noise = of.noise;
        alone.own_.push_back(std::move(noise));
    }
    alone.displacements_ = alone.own_;
    return alone;
}

bool RootHeights::has_noise_over_maps() const {
    return std::any_of(displacements_.begin(), displacements_.end(),
                       [](const Displacement& of) { return of.noise && of.height && !of.vector; });
}

glm::dvec2 RootHeights::uv(const RootPoint& at) const {
    const std::array<glm::dvec2, 3>& c = corners_[at.root];
    return at.weights.x * c[0] + at.weights.y * c[1] + at.weights.z * c[2];
}

std::array<glm::dvec2, 2> RootHeights::uv_steps(std::uint32_t root) const {
    const std::array<glm::dvec2, 3>& c = corners_[root];
    return {c[1] - c[0], c[2] - c[0]};
}

double RootHeights::raw(const RootPoint& at) const {
    const Displacement* displacement = of(at.root);
    return displacement && displacement->height ? displacement->height->value(uv(at)) : 0;
}

double RootHeights::height(const RootPoint& at, double raw, const glm::dvec3& position) const {
    const Displacement* displacement = of(at.root);
    if (!displacement) return 0;
    const double of_map =
        displacement->height ? displacement->scale * (raw - displacement->midlevel) : 0;
    return displacement->noise ? of_map + displacement->noise->at(position).value : of_map;
}

glm::dvec3 RootHeights::map_vector(const RootPoint& at) const {
    const Displacement* displacement = of(at.root);
    return displacement && displacement->vector ? displacement->vector->at(uv(at)).value
                                                : glm::dvec3(0.0);
}

glm::dvec3 RootHeights::vector(const RootPoint& at, const glm::dvec3& direction) const {
    const TangentFrames* frames = this->frames(at.root);
    const glm::dvec3 of_map = map_vector(at);
    return frames ? frame(*frames, at, direction).axes * of_map : of_map;
}

glm::dvec3 RootHeights::vector_step(const BaseFrame& base, const RootPoint& at, std::size_t axis,
                                    const VectorFunction::Sample& sample) const {
    const glm::dvec2 by = uv_steps(at.root)[axis];
    const glm::dvec3 of_map = by.x * sample.du + by.y * sample.dv;
    const TangentFrames* frames = this->frames(at.root);
    if (!frames) return of_map;
    const TangentFrame here = frame(*frames, at, base.point.direction);
    return here.axes * of_map +
           frames->step(domain_->roots[at.root], here, axis, base.direction_steps[axis]) *
               sample.value;
}

}  // namespace prep::detail
