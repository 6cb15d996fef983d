#include "tessellation/height_functions.h"

#include <array>
#include <vector>

#include "displacement/noise_field.h"
#include "tessellation/domain.h"

namespace prep {
namespace detail {
namespace {

// Large triangles over a rough map are halved in any case: their bound need not be tight.
constexpr std::uint32_t effort = 1u << 12;

class MapHeights final : public HeightFunction {
  public:
    explicit MapHeights(HeightMap map) : map_(std::move(map)) {}
    Sample at(const glm::dvec2& uv) const override {
        const HeightSample sample = map_.at(uv);
        return {sample.value, sample.gradient};
    }
    double value(const glm::dvec2& uv) const override { return map_.value(uv); }
    double deviation(const std::array<glm::dvec2, 3>& uv, const std::array<double, 3>& values,
                     double enough) const override {
        return map_.deviation(uv, values, enough, effort).upper;
    }

  private:
    HeightMap map_;
};

class MapVectors final : public VectorFunction {
  public:
    explicit MapVectors(VectorMap map) : map_(std::move(map)) {}
    Sample at(const glm::dvec2& uv) const override {
        const VectorSample sample = map_.at(uv);
        return {sample.value, sample.du, sample.dv};
    }
    double deviation(const std::array<glm::dvec2, 3>& uv, const std::array<glm::dvec3, 3>& values,
                     double enough) const override {
        return map_.deviation(uv, values, enough, effort).upper;
    }

  private:
    VectorMap map_;
};

class NoiseHeights final : public SpaceFunction {
  public:
    explicit NoiseHeights(NoiseField field) : field_(std::move(field)) {}
    Sample at(const glm::dvec3& p) const override {
        const NoiseSample sample = field_.sample(p);
        return {sample.value, sample.gradient};
    }
    double deviation(const std::array<glm::dvec3, 3>& p, const std::array<double, 3>& values,
                     double enough) const override {
        // Six bisections of a triangle make what is bounded by second derivatives 64 times smaller.
        constexpr std::uint32_t few = 1u << 6;
        return field_.deviation(p, values, enough, few).upper;
    }
    double steepest() const override { return field_.steepest(); }

  private:
    NoiseField field_;
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

// The triangles of UVs of the faces that have this material.
Charts charts_of(const Mesh& mesh, std::size_t uv_set, std::uint32_t material, int threads) {
    const Domain domain = make_domain(mesh, {}, true, threads);
    Charts covered(mesh.uvs[uv_set]);
    std::vector<std::uint32_t> corners;
    for (std::uint32_t fan = 0; fan < domain.fans(); ++fan) {
        const std::uint32_t face = domain.roots[domain.fan_roots[fan]].face;
        if (material != no_index &&
            (mesh.face_materials.empty() || mesh.face_materials[face] != material))
            continue;
        corners.clear();
        for_fan_corners(domain, fan, [&](std::uint32_t c) { corners.push_back(c); });
        covered.add(corners);
        // A face that was cut is one fan on limit surfaces.
        const std::uint32_t first = mesh.face_offsets[face], last = mesh.face_offsets[face + 1];
        if (corners.size() == last - first) continue;
        corners.clear();
        for (std::uint32_t c = first; c < last; ++c) corners.push_back(c);
        covered.add(corners);
    }
    return covered;
}

bool has_charts(const Mesh* mesh, std::size_t uv_set) {
    return mesh && uv_set < mesh->uvs.size() && !mesh->uvs[uv_set].empty();
}

}  // namespace

std::shared_ptr<const HeightFunction> height_function(const HeightMap& map, const Mesh* charts,
                                                      std::size_t uv_set, std::uint32_t material,
                                                      int threads) {
    if (!has_charts(charts, uv_set)) return std::make_shared<MapHeights>(map);
    return std::make_shared<MapHeights>(
        map.confined(charts_of(*charts, uv_set, material, threads).triangles()));
}

std::shared_ptr<const VectorFunction> vector_function(const VectorMap& map, const Mesh* charts,
                                                      std::size_t uv_set, std::uint32_t material,
                                                      int threads) {
    if (!has_charts(charts, uv_set)) return std::make_shared<MapVectors>(map);
    return std::make_shared<MapVectors>(
        map.confined(charts_of(*charts, uv_set, material, threads).triangles()));
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

Result<std::shared_ptr<const VectorFunction>> vector_function(const Image& image,
                                                              const VectorMapOptions& options,
                                                              const Mesh* charts,
                                                              std::size_t uv_set) {
    VectorMapOptions as_read = options;
    as_read.map.band_limited = false;
    const Result<detail::VectorMap> map = detail::VectorMap::make(image, as_read);
    if (!map) return map.error();
    return detail::vector_function(*map, charts, uv_set, no_index, options.map.threads);
}

Result<std::shared_ptr<const SpaceFunction>> noise_function(const NoiseOptions& options) {
    auto field = detail::NoiseField::make(options);
    if (!field) return field.error();
    return std::shared_ptr<const SpaceFunction>(
        std::make_shared<detail::NoiseHeights>(*std::move(field)));
}

}  // namespace prep
