#include "tessellation/height_functions.h"

#include <array>
#include <vector>

#include "tessellation/domain.h"

namespace prep {
namespace detail {
namespace {

class MapHeights final : public HeightFunction {
  public:
    explicit MapHeights(HeightMap map) : map_(std::move(map)) {}
    Sample at(const glm::dvec2& uv) const override {
        const HeightSample sample = map_.at(uv);
        return {sample.value, sample.gradient};
    }
    double deviation(const std::array<glm::dvec2, 3>& uv, const std::array<double, 3>& values,
                     double enough) const override {
        // Large triangles over a rough map are halved in any case: their bound need not be tight.
        constexpr std::uint32_t effort = 1u << 12;
        return map_.deviation(uv, values, enough, effort).upper;
    }

  private:
    HeightMap map_;
};

class Charts {
  public:
    explicit Charts(const CornerLayer<glm::vec2>& layer) : layer_(layer) {}
    // Of a fan; nothing where a corner has no UV.
    void add(const std::vector<std::uint32_t>& corners) {
        glm::dvec2 mean(0.0);
        for (const std::uint32_t c : corners) {
            if (layer_.indices[c] == no_index) return;
            mean += at(c);
        }
        mean /= double(corners.size());
        for (std::size_t k = 0; k < corners.size(); ++k)
            triangles_.push_back({at(corners[k]), at(corners[(k + 1) % corners.size()]), mean});
    }
    const std::vector<std::array<glm::dvec2, 3>>& triangles() const { return triangles_; }

  private:
    glm::dvec2 at(std::uint32_t c) const { return glm::dvec2(layer_.values[layer_.indices[c]]); }
    const CornerLayer<glm::vec2>& layer_;
    std::vector<std::array<glm::dvec2, 3>> triangles_;
};

}  // namespace

std::shared_ptr<const HeightFunction> height_function(const HeightMap& map, const Mesh* charts,
                                                      std::size_t uv_set, std::uint32_t material,
                                                      int threads) {
    if (!charts || uv_set >= charts->uvs.size() || charts->uvs[uv_set].empty())
        return std::make_shared<MapHeights>(map);
    const Domain domain = make_domain(*charts, {}, true, threads);
    Charts covered(charts->uvs[uv_set]);
    std::vector<std::uint32_t> corners;
    for (std::uint32_t fan = 0; fan < domain.fans(); ++fan) {
        const std::uint32_t face = domain.roots[domain.fan_roots[fan]].face;
        if (material != no_index &&
            (charts->face_materials.empty() || charts->face_materials[face] != material))
            continue;
        corners.clear();
        for_fan_corners(domain, fan, [&](std::uint32_t c) { corners.push_back(c); });
        covered.add(corners);
        // A face that was cut is one fan on limit surfaces.
        const std::uint32_t first = charts->face_offsets[face],
                            last = charts->face_offsets[face + 1];
        if (corners.size() == last - first) continue;
        corners.clear();
        for (std::uint32_t c = first; c < last; ++c) corners.push_back(c);
        covered.add(corners);
    }
    return std::make_shared<MapHeights>(map.confined(covered.triangles()));
}

}  // namespace detail

Result<std::shared_ptr<const HeightFunction>> height_function(const Image& image,
                                                              const HeightMapOptions& options,
                                                              const Mesh* charts,
                                                              std::size_t uv_set) {
    HeightMapOptions as_read = options;
    as_read.band_limited = false;
    const Result<detail::HeightMap> map = detail::HeightMap::make(image, as_read);
    if (!map) return map.error();
    return detail::height_function(*map, charts, uv_set, no_index, options.threads);
}

}  // namespace prep
