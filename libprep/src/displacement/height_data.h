// What a height map holds, and how its texels become a function.
//
// Map coordinates (x, y): texel (i, j) has its centre at (i, j), so x = width · u − ½. Between
// texels lie cells; the map's cells, counted from 0, are those that differ: with Wrap::repeat as
// many as texels, else one more, from the one before the first texel to the one behind the last.
// Cell coordinates are x − first. Raw heights are codes of integer files and values of others; a
// height is unit · (raw − mid).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "displacement/height_field.h"
#include "displacement/height_pyramid.h"

namespace prep::detail {

struct HeightAxis {
    std::int64_t size = 1;
    Wrap wrap = Wrap::repeat;
    // The texel before cell 0's middle.
    std::int64_t first() const { return wrap == Wrap::repeat ? 0 : -1; }
    std::int64_t cells() const { return wrap == Wrap::repeat ? size : size + 1; }
    std::int64_t texel(std::int64_t i) const {
        if (i >= 0 && i < size) return i;
        if (wrap == Wrap::repeat) return ((i % size) + size) % size;
        if (wrap == Wrap::mirror) {
            const std::int64_t period = 2 * size, r = ((i % period) + period) % period;
            return std::min(r, period - 1 - r);
        }
        return i < 0 ? 0 : size - 1;
    }
};

struct HeightMapData {
    HeightMapOptions options;
    HeightAxis x, y;
    std::vector<float> raw;  // row by row
    // Texels that are no gutter although no chart covers them; empty: none.
    std::vector<std::uint8_t> kept;
    double unit = 1, mid = 0;
    int bits = 0, file_bits = 0;
    // Map coordinates over those of the mesh, without the last half: size · (matrix · uv + offset).
    glm::dmat2 matrix{1.0};
    glm::dvec2 offset{0.0};
    HeightPyramid pyramid;

    int taps() const { return options.filter == HeightFilter::bicubic ? 4 : 2; }
    double height(double value) const { return unit * (value - mid); }
    double texel(std::int64_t i, std::int64_t j) const {
        return double(raw[std::size_t(y.texel(j) * x.size + x.texel(i))]);
    }
    // (0, 0) for what is not finite; beyond 2^52 there is nothing between texels.
    glm::dvec2 map_point(const glm::dvec2& uv) const {
        const glm::dvec2 placed = matrix * uv + offset;
        const glm::dvec2 p(placed.x * double(x.size) - 0.5, placed.y * double(y.size) - 0.5);
        if (!std::isfinite(p.x) || !std::isfinite(p.y)) return glm::dvec2(0.0);
        return p;
    }
    // Gradients by map coordinates become gradients by the mesh's.
    glm::dvec2 mesh_gradient(const glm::dvec2& by_map) const {
        return glm::transpose(matrix) *
               glm::dvec2(by_map.x * double(x.size), by_map.y * double(y.size));
    }
};

// The map as read: raw height and its gradient by map coordinates, by the mesh's UVs or at a point
// in map coordinates.
struct RawSample {
    double value = 0;
    glm::dvec2 gradient{0.0};
};
RawSample raw_sample(const HeightMapData& map, const glm::dvec2& uv);
double raw_value(const HeightMapData& map, const glm::dvec2& uv);
double raw_value_at(const HeightMapData& map, const glm::dvec2& point);

// Catmull-Rom weights of four texels at t in the cell between the middle two, and by t.
inline void catmull_rom(double t, double weights[4], double slopes[4]) {
    const double t2 = t * t, t3 = t2 * t;
    weights[0] = 0.5 * (-t3 + 2 * t2 - t);
    weights[1] = 0.5 * (3 * t3 - 5 * t2 + 2);
    weights[2] = 0.5 * (-3 * t3 + 4 * t2 + t);
    weights[3] = 0.5 * (t3 - t2);
    slopes[0] = 0.5 * (-3 * t2 + 4 * t - 1);
    slopes[1] = 0.5 * (9 * t2 - 10 * t);
    slopes[2] = 0.5 * (-9 * t2 + 8 * t + 1);
    slopes[3] = 0.5 * (3 * t2 - 2 * t);
}

// Raw texels [i, i + n) × [j, j + n), row by row.
inline void load_texels(const HeightMapData& map, std::int64_t i, std::int64_t j, int nx, int ny,
                        double* out) {
    if (i >= 0 && j >= 0 && i + nx <= map.x.size && j + ny <= map.y.size) {
        for (int r = 0; r < ny; ++r) {
            const float* const row = &map.raw[std::size_t((j + r) * map.x.size + i)];
            for (int c = 0; c < nx; ++c) *out++ = double(row[c]);
        }
        return;
    }
    for (int r = 0; r < ny; ++r) {
        const std::size_t row = std::size_t(map.y.texel(j + r) * map.x.size);
        for (int c = 0; c < nx; ++c)
            *out++ = double(map.raw[row + std::size_t(map.x.texel(i + c))]);
    }
}

// Of two rows of two texels. Equal texels give themselves, and (0, 0) the first one's own bits.
inline double bilinear(const double* t, double fx, double fy) {
    const double upper = t[0] + fx * (t[1] - t[0]), lower = t[2] + fx * (t[3] - t[2]);
    return upper + fy * (lower - upper);
}

// Raw height and its gradient by map coordinates at (fx, fy) of the cell between texels i, i + 1
// and j, j + 1.
inline double raw_at(const HeightMapData& map, std::int64_t i, std::int64_t j, double fx, double fy,
                     glm::dvec2* gradient) {
    double t[16];
    if (map.taps() == 2) {
        load_texels(map, i, j, 2, 2, t);
        const double top = t[1] - t[0], left = t[2] - t[0], twist = (t[3] - t[2]) - top;
        if (gradient) *gradient = {top + fy * twist, left + fx * twist};
        return bilinear(t, fx, fy);
    }
    load_texels(map, i - 1, j - 1, 4, 4, t);
    double wx[4], wy[4], sx[4], sy[4];
    catmull_rom(fx, wx, sx);
    catmull_rom(fy, wy, sy);
    // About one of the texels: what is level comes out with its own bits.
    const double about = t[5];
    double value = 0, dx = 0, dy = 0;
    for (int r = 0; r < 4; ++r) {
        double along = 0, slope = 0;
        for (int c = 0; c < 4; ++c) {
            const double d = t[4 * r + c] - about;
            along += wx[c] * d;
            slope += sx[c] * d;
        }
        value += wy[r] * along;
        dy += sy[r] * along;
        dx += wy[r] * slope;
    }
    if (gradient) *gradient = {dx, dy};
    return about + value;
}

}  // namespace prep::detail
