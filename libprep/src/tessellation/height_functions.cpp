#include "tessellation/height_functions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "displacement/noise_field.h"
#include "surface/edge_key.h"
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
    double deviation(const std::array<glm::dvec3, 3>& p) const override {
        return field_.deviation(p);
    }
    double steepest() const override { return field_.steepest(); }
    double change(double distance) const override { return field_.change(distance); }

  private:
    NoiseField field_;
};

// One fan a face on limit surfaces; polygons are cut where the domain cuts them.
Domain domain_of(const ChartFaces& faces, int threads) {
    return make_domain(*faces.mesh, {}, !faces.of_cage, threads);
}

// Triangles of UVs of the faces: as fans of the domain lie over them.
class Charts {
  public:
    Charts(const ChartFaces& faces, const Domain& domain)
        : mesh_(*faces.mesh), layer_(mesh_.uvs[faces.uv_set]) {
        std::vector<std::uint32_t> corners;
        for (std::uint32_t fan = 0; fan < domain.fans(); ++fan) {
            const std::uint32_t face = domain.roots[domain.fan_roots[fan]].face;
            if (!faces.has(face)) continue;
            corners.clear();
            for_fan_corners(domain, fan, [&](std::uint32_t c) { corners.push_back(c); });
            add(face, corners);
        }
    }
    const std::vector<std::array<glm::dvec2, 3>>& triangles() const { return triangles_; }

    // Each face's area spread over its triangles as their UVs have it; and what is across edges.
    ChartAtlas atlas(std::span<const double> face_areas) const {
        ChartAtlas atlas{.triangles = triangles_};
        const auto of_uvs = [&](std::size_t t) {
            const glm::dvec2 a = triangles_[t][1] - triangles_[t][0];
            const glm::dvec2 b = triangles_[t][2] - triangles_[t][0];
            return 0.5 * std::abs(a.x * b.y - a.y * b.x);
        };
        std::vector<double> whole(face_areas.size(), 0);
        atlas.areas.assign(triangles_.size(), 0);
        for (std::size_t t = 0; t < triangles_.size(); ++t) whole[sources_[t].face] += of_uvs(t);
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            if (const std::uint32_t f = sources_[t].face; whole[f] > 0)
                atlas.areas[t] = face_areas[f] * of_uvs(t) / whole[f];
        find_across(atlas);
        return atlas;
    }

  private:
    struct Source {
        std::uint32_t face = 0;
        std::array<std::uint32_t, 2> corners{};
        std::uint32_t next = 0, previous = 0;  // of the fan
        glm::dvec3 centre{0.0};
        bool is_edge = false;  // of the face: fans of cut faces have diagonals as well
    };
    glm::dvec2 uv(std::uint32_t c) const { return glm::dvec2(layer_.values[layer_.indices[c]]); }
    glm::dvec3 position(std::uint32_t c) const {
        return glm::dvec3(mesh_.positions[mesh_.corner_vertices[c]]);
    }
    // A fan; nothing where a corner has no UV.
    void add(std::uint32_t face, const std::vector<std::uint32_t>& corners) {
        glm::dvec2 mean(0.0);
        glm::dvec3 centre(0.0);
        for (const std::uint32_t c : corners) {
            if (layer_.indices[c] == no_index) return;
            mean += uv(c);
            centre += position(c);
        }
        mean /= double(corners.size());
        centre /= double(corners.size());
        const std::uint32_t begin = mesh_.face_offsets[face], end = mesh_.face_offsets[face + 1];
        const auto is_edge = [&](std::uint32_t a, std::uint32_t b) {
            return b == (a + 1 == end ? begin : a + 1);
        };
        const auto first = std::uint32_t(triangles_.size()), count = std::uint32_t(corners.size());
        for (std::uint32_t k = 0; k < count; ++k) {
            const std::uint32_t after = (k + 1) % count, before = (k + count - 1) % count;
            triangles_.push_back({uv(corners[k]), uv(corners[after]), mean});
            sources_.push_back({face,
                                {corners[k], corners[after]},
                                first + after,
                                first + before,
                                centre,
                                is_edge(corners[k], corners[after])});
        }
    }

    void find_across(ChartAtlas& atlas) const {
        const auto count = std::uint32_t(triangles_.size());
        atlas.flat.resize(count);
        atlas.across.assign(3 * std::size_t(count), no_index);
        atlas.same_way.assign(3 * std::size_t(count), 0);
        std::vector<Edge> edges, diagonals;
        for (std::uint32_t t = 0; t < count; ++t) {
            const Source& source = sources_[t];
            const auto [a, b] = source.corners;
            const glm::dvec3 edge = position(b) - position(a), up = source.centre - position(a);
            const double length = glm::length(edge);
            if (length > 0)
                atlas.flat[t] = {length, glm::dot(up, edge) / length,
                                 glm::length(glm::cross(edge, up)) / length};
            atlas.across[3 * t + 1] = 3 * source.next + 2;
            atlas.across[3 * t + 2] = 3 * source.previous + 1;
            if (source.is_edge)
                edges.push_back({edge_key(mesh_.corner_vertices[a], mesh_.corner_vertices[b]), t});
            else
                diagonals.push_back({edge_key(a, b), t});
        }
        link(edges, atlas);
        link(diagonals, atlas);
    }
    struct Edge {
        std::uint64_t ends;  // vertices; of diagonals, which are within a face, corners
        std::uint32_t triangle;
    };
    void link(std::vector<Edge>& edges, ChartAtlas& atlas) const {
        std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
            return a.ends != b.ends ? a.ends < b.ends : a.triangle < b.triangle;
        });
        for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
            while (last < edges.size() && edges[last].ends == edges[first].ends) ++last;
            if (last - first != 2) continue;
            const std::uint32_t s = edges[first].triangle, t = edges[first + 1].triangle;
            const auto start = [&](std::uint32_t k) {
                return mesh_.corner_vertices[sources_[k].corners[0]];
            };
            atlas.across[3 * s] = 3 * t;
            atlas.across[3 * t] = 3 * s;
            atlas.same_way[3 * s] = atlas.same_way[3 * t] = start(s) == start(t);
        }
    }

    const Mesh& mesh_;
    const CornerLayer<glm::vec2>& layer_;
    std::vector<std::array<glm::dvec2, 3>> triangles_;
    std::vector<Source> sources_;  // per triangle
};

bool has_charts(const ChartFaces& faces) {
    return faces.mesh && faces.uv_set < faces.mesh->uvs.size() &&
           !faces.mesh->uvs[faces.uv_set].empty();
}

// Of the fans of triangles around the mean of their corners, by face.
std::vector<double> areas_of(const Mesh& mesh, const Domain& domain) {
    std::vector<double> areas(mesh.face_count(), 0);
    for (std::uint32_t fan = 0; fan < domain.fans(); ++fan) {
        const std::uint32_t first = domain.fan_roots[fan], last = domain.fan_roots[fan + 1];
        const auto at = [&](std::uint32_t root, std::size_t k) {
            return glm::dvec3(mesh.positions[mesh.corner_vertices[domain.roots[root].corners[k]]]);
        };
        glm::dvec3 middle(0.0);
        for (std::uint32_t r = first; r < last; ++r) middle += at(r, 0) - at(first, 0);
        middle = at(first, 0) + middle / double(last - first);
        for (std::uint32_t r = first; r < last; ++r)
            areas[domain.roots[r].face] +=
                0.5 * glm::length(glm::cross(at(r, 0) - middle, at(r, 1) - middle));
    }
    return areas;
}

template <class Map>
Result<typename Map::Limited> limited_in(const Map& map, const ChartFaces& faces, double spacing,
                                         std::span<const double> face_areas, int threads) {
    if (!has_charts(faces)) return map.limited({}, spacing);
    const Domain domain = domain_of(faces, threads);
    std::vector<double> of_polygons;
    if (face_areas.empty()) face_areas = of_polygons = areas_of(*faces.mesh, domain);
    return map.limited(Charts(faces, domain).atlas(face_areas), spacing);
}

template <class Map>
Map confined_to(const Map& map, std::span<const ChartFaces> all, int threads) {
    std::vector<std::array<glm::dvec2, 3>> triangles;
    bool any = false;
    for (const ChartFaces& faces : all) {
        if (!has_charts(faces)) continue;
        any = true;
        const Charts charts(faces, domain_of(faces, threads));
        triangles.insert(triangles.end(), charts.triangles().begin(), charts.triangles().end());
    }
    return any ? map.confined(triangles) : map;
}

}  // namespace

std::shared_ptr<const HeightFunction> height_function(const HeightMap& map,
                                                      std::span<const ChartFaces> faces,
                                                      int threads) {
    return std::make_shared<MapHeights>(confined_to(map, faces, threads));
}

std::shared_ptr<const VectorFunction> vector_function(const VectorMap& map,
                                                      std::span<const ChartFaces> faces,
                                                      int threads) {
    return std::make_shared<MapVectors>(confined_to(map, faces, threads));
}

std::vector<double> fan_areas(const Mesh& mesh) {
    return areas_of(mesh, make_domain(mesh, {}, false, 1));
}

Result<HeightMap::Limited> band_limited(const HeightMap& map, const ChartFaces& faces,
                                        double spacing, std::span<const double> face_areas,
                                        int threads) {
    return limited_in(map, faces, spacing, face_areas, threads);
}

Result<VectorMap::Limited> band_limited(const VectorMap& map, const ChartFaces& faces,
                                        double spacing, std::span<const double> face_areas,
                                        int threads) {
    return limited_in(map, faces, spacing, face_areas, threads);
}

}  // namespace detail

namespace {

Result<void> check_spacing(double spacing) {
    if (spacing >= 0 && std::isfinite(spacing)) return {};
    return Error{ErrorCode::invalid,
                 "the spacing of samples that heights are limited to must be a positive number, "
                 "or 0",
                 ""};
}

}  // namespace

Result<std::shared_ptr<const HeightFunction>> height_function(
    const Image& image, const HeightMapOptions& options, const Mesh* charts, std::size_t uv_set,
    std::optional<SubdivisionScheme> scheme) {
    if (auto checked = check_spacing(options.sample_spacing); !checked) return checked.error();
    Result<detail::HeightMap> map = detail::HeightMap::make(image, options);
    if (!map) return map.error();
    const detail::ChartFaces faces{.mesh = charts, .uv_set = uv_set, .of_cage = scheme.has_value()};
    if (options.sample_spacing > 0) {
        auto limited =
            detail::band_limited(*map, faces, options.sample_spacing, {}, options.threads);
        if (!limited) return std::move(limited).error();
        *map = std::move(limited->map);
    }
    return detail::height_function(*map, {&faces, 1}, options.threads);
}

Result<std::shared_ptr<const VectorFunction>> vector_function(
    const Image& image, const VectorMapOptions& options, const Mesh* charts, std::size_t uv_set,
    std::optional<SubdivisionScheme> scheme) {
    if (auto checked = check_spacing(options.map.sample_spacing); !checked) return checked.error();
    Result<detail::VectorMap> map = detail::VectorMap::make(image, options);
    if (!map) return map.error();
    const detail::ChartFaces faces{.mesh = charts, .uv_set = uv_set, .of_cage = scheme.has_value()};
    if (options.map.sample_spacing > 0) {
        auto limited =
            detail::band_limited(*map, faces, options.map.sample_spacing, {}, options.map.threads);
        if (!limited) return std::move(limited).error();
        *map = std::move(limited->map);
    }
    return detail::vector_function(*map, {&faces, 1}, options.map.threads);
}

Result<std::shared_ptr<const SpaceFunction>> noise_function(const NoiseOptions& options) {
    auto field = detail::NoiseField::make(options);
    if (!field) return field.error();
    return std::shared_ptr<const SpaceFunction>(
        std::make_shared<detail::NoiseHeights>(*std::move(field)));
}

}  // namespace prep
