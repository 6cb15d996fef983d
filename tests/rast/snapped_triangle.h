// What a triangle is worth at a pixel, in long double, from its snapped corners: weights,
// derivatives.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "oracles.h"

namespace test {

using Real = long double;

// A corner on the screen: 1/256 pixels from the picture's centre, and its homogeneous w.
struct Corner {
    std::int64_t x = 0, y = 0;
    Real w = 1, depth = 0;
};

// The view looks along −z from the origin, or orthographically from there.
inline Corner corner_of(const rast::View& view, std::uint32_t width, std::uint32_t height,
                        const glm::vec3& p) {
    const Real aspect = Real(width) / Real(height);
    const Real w = view.perspective ? -Real(p.z) : 1;
    const Real half = view.perspective ? std::tan(Real(view.yfov) / 2) : Real(view.half_height);
    const Real x = Real(p.x) / (w * half * aspect) * Real(width) / 2;
    const Real y = -Real(p.y) / (w * half) * Real(height) / 2;
    Corner c;
    c.x = std::int64_t(std::floor(x * 256 + 0.5L));
    c.y = std::int64_t(std::floor(y * 256 + 0.5L));
    c.w = w;
    c.depth = view.perspective ? Real(view.znear) / w
                               : (Real(view.zfar) + Real(p.z)) / Real(view.zfar - view.znear);
    return c;
}

// Perspective-correct weights of the corners and their change per pixel at a sample.
struct Weights {
    Real at[3] = {}, right[3] = {}, down[3] = {}, affine[3] = {};
};
inline Weights weights_of(const Corner c[3], std::int64_t x, std::int64_t y) {
    Real q[3], qx[3], qy[3], sum = 0, sum_x = 0, sum_y = 0, area = 0;
    Weights out;
    for (int k = 0; k < 3; ++k) {
        const Corner &a = c[(k + 1) % 3], &b = c[(k + 2) % 3];
        const Real e = Real((a.x - x) * (b.y - y) - (a.y - y) * (b.x - x));
        out.affine[k] = e;
        area += e;
        q[k] = e * a.w * b.w;
        qx[k] = Real(a.y - b.y) * 256 * a.w * b.w;
        qy[k] = Real(b.x - a.x) * 256 * a.w * b.w;
        sum += q[k];
        sum_x += qx[k];
        sum_y += qy[k];
    }
    for (int k = 0; k < 3; ++k) {
        out.at[k] = q[k] / sum;
        out.affine[k] /= area;
        out.right[k] = (qx[k] - out.at[k] * sum_x) / sum;
        out.down[k] = (qy[k] - out.at[k] * sum_y) / sum;
    }
    return out;
}

// The centre of a pixel, in 1/256 pixels from the picture's centre.
inline std::int64_t centre_from_middle(std::uint32_t pixel, std::uint32_t extent) {
    return (2 * std::int64_t(pixel) + 1 - std::int64_t(extent)) * 128;
}

inline rast::View perspective_view() {
    rast::View view;
    view.yfov = 0.9;
    view.znear = 0.125;
    return view;
}

// Corners about a part of the picture, their distances up to 1 : 1000 apart.
inline void place_corners(prep::VertexMesh& mesh, const rast::View& view,
                          const rast::RenderRequest& r, const rast::Crop& about,
                          std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    const double stretch = std::pow(10.0, 3 * unit(random));
    for (int k = 0; k < 3; ++k) {
        const double x = about.x + (1.5 * unit(random) - 0.25) * about.width;
        const double y = about.y + (1.5 * unit(random) - 0.25) * about.height;
        const Ray ray = ray_at(view, r.width, r.height, x, y);
        mesh.positions.push_back(
            glm::vec3(ray.direction * (0.5 * std::pow(stretch, unit(random)))));
    }
}

}  // namespace test
