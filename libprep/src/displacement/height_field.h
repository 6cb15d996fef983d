// Height and vector maps as continuous functions of the mesh's UVs, with true bounds of them over
// boxes and triangles.
//
// UVs are the mesh's, before the map's placement; gradients and spacings are by them. Coordinates
// that are not finite read the origin. Everything is in double; texels are floats or the file's own
// integers.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "prep/displacement/sources.h"
#include "prep/image.h"
#include "prep/result.h"

namespace prep::detail {

struct HeightSample {
    double value = 0;
    glm::dvec2 gradient{0.0};  // by (u, v)
};

struct Interval {
    double low = 0, high = 0;
};

// Of a function from what is linear over a triangle: no more than `upper` anywhere, and at some
// point of it at least `lower`.
struct Deviation {
    double upper = 0, lower = 0;
};

// How coarse a map's values are: `half_step` in the units of heights, 0 for floats. `bits` are
// those that the values use: 8 also for a map of 8 bits that was saved with 16 or as floats, for
// which `file_bits` says 16 or 0.
struct MapPrecision {
    int bits = 0, file_bits = 0;
    double half_step = 0;
};

// Triangles of UVs that make the charts of an atlas. They cover the texels whose centres lie in a
// triangle or, to within rounding, on its border; a chart without any, those that its border runs
// through.
using ChartTriangles = std::span<const std::array<glm::dvec2, 3>>;

// A triangle of the surface, laid flat: its corners are (0, 0), (length, 0) and (along, height). Of
// no length: it has no edges that others are across of.
struct FlatTriangle {
    double length = 0, along = 0, height = 0;
};

// A surface in the map: triangles of UVs, and what they are of the surface.
struct ChartAtlas {
    std::vector<std::array<glm::dvec2, 3>> triangles;
    std::vector<double> areas = {};  // of the surface; empty: those of the UVs
    // What filters read across edges by; empty: nothing is across. Half-edge 3 t + e runs from
    // corner e of triangle t to the next one; `across`: the other half-edge of that edge, or
    // no_index. `same_way`: both begin at the same end.
    std::vector<FlatTriangle> flat = {};
    std::vector<std::uint32_t> across = {};
    std::vector<std::uint8_t> same_way = {};
};

struct HeightMapData;

class HeightMap {
  public:
    // Errors: invalid (no pixels; no such channel; texels, scale, midlevel or placement that are
    // not finite: the first such texel is named).
    static Result<HeightMap> make(const Image& image, const HeightMapOptions& options = {});

    // The map as read: the truth.
    HeightSample at(const glm::dvec2& uv) const;
    double value(const glm::dvec2& uv) const;  // at(uv).value, the same bits

    // Bounds of at() over a box, rounded outwards.
    Interval range(const glm::dvec2& low, const glm::dvec2& high) const;
    Interval range() const;  // everywhere

    // An upper bound of |gradient| over a box.
    double steepest(const glm::dvec2& low, const glm::dvec2& high) const;

    // Of at(Σ λ uv) from Σ λ values over all λ. Ends as soon as `upper` is no more than `enough` or
    // 1.1 times `lower`; costs what it takes to get there, at most about `effort` nodes (then
    // `upper` still holds, but may be further off). Triangles of any shape, collinear ones too.
    Deviation deviation(const std::array<glm::dvec2, 3>& uv, const std::array<double, 3>& values,
                        double enough, std::uint32_t effort = 1u << 20) const;

    // The same map with texels outside all charts replaced by what lies inside: extrapolated
    // linearly for two texels around a chart, by the nearest further off. at() then never depends
    // on what the file has between charts. Charts less than two texels apart (bilinear; four:
    // bicubic) share the texels between them.
    HeightMap confined(ChartTriangles charts) const;

    // Without what samples `spacing` apart, a length of the surface, cannot carry, chart by chart
    // (chart_filter.h): of amplitudes beyond 1/(2 spacing) cycles a unit at most 2 % are left, of
    // those below 1/(4 spacing) at least 95 %. No triangles: all of the map, by UVs. Errors: limit
    // (too many texels).
    struct Limited;
    Result<Limited> limited(const ChartAtlas& atlas, double spacing) const;

    // Half a step of the file's integers, in the units of heights; 0 for floats.
    double quantum() const;
    MapPrecision precision() const;

    std::uint32_t width() const;
    std::uint32_t height() const;
    // A texel in UVs of the mesh: the lengths that one step along the map's axes makes there.
    glm::dvec2 texel_size() const;
    std::size_t memory() const;  // bytes

  private:
    friend class VectorMap;
    explicit HeightMap(std::shared_ptr<const HeightMapData> data) : data_(std::move(data)) {}
    std::shared_ptr<const HeightMapData> data_;
};

struct HeightMap::Limited {
    HeightMap map;
    double change = 0;  // the largest of a height
};

struct VectorSample {
    glm::dvec3 value{0.0};
    glm::dvec3 du{0.0}, dv{0.0};
};

// Three channels; (tangent, bitangent, normal) or (x, y, z), whatever their order in the file.
class VectorMap {
  public:
    // Errors: as HeightMap's; invalid where there are fewer than three channels.
    static Result<VectorMap> make(const Image& image, const VectorMapOptions& options = {});
    bool in_object_space() const { return axes_ == VectorAxes::object; }
    VectorSample at(const glm::dvec2& uv) const;
    // Of the length of at(Σ λ uv) − Σ λ values.
    Deviation deviation(const std::array<glm::dvec2, 3>& uv,
                        const std::array<glm::dvec3, 3>& values, double enough,
                        std::uint32_t effort = 1u << 20) const;
    // Bounds of each component over a box, of the vectors' lengths, and of the length of their
    // change by a unit of UV in any direction.
    std::array<Interval, 3> range(const glm::dvec2& low, const glm::dvec2& high) const;
    double longest(const glm::dvec2& low, const glm::dvec2& high) const;
    double steepest(const glm::dvec2& low, const glm::dvec2& high) const;
    VectorMap confined(ChartTriangles charts) const;
    struct Limited;
    Result<Limited> limited(const ChartAtlas& atlas, double spacing) const;
    double quantum() const;
    // The most bits of a channel; half_step is that of vectors.
    MapPrecision precision() const;
    glm::dvec2 texel_size() const { return channels_[0].texel_size(); }

  private:
    VectorMap(VectorAxes axes, std::array<HeightMap, 3> channels)
        : axes_(axes), channels_(std::move(channels)) {}
    VectorAxes axes_;
    std::array<HeightMap, 3> channels_;  // in the order of results
};

struct VectorMap::Limited {
    VectorMap map;
    double change = 0;  // of a vector, no more than this
};

}  // namespace prep::detail
