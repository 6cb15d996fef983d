#include "displacement/height_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/outward.h"
#include "base/parallel.h"
#include "displacement/height_data.h"

namespace prep::detail {
namespace {

// Texels that cells [cx, cx + n) read, at most 8 and 3 a side.
struct Window {
    double texels[(cells_in_block + 3) * (cells_in_block + 3)];
    std::int64_t nx = 0, ny = 0;
    double x = 0, y = 0;  // cell coordinates of the first texel
};

Window window_of(const HeightMapData& map, std::int64_t cx, std::int64_t cy, int n) {
    Window window;
    const int around = map.taps() / 2 - 1;
    window.nx = std::min<std::int64_t>(n, map.x.cells() - cx) + 1 + 2 * around;
    window.ny = std::min<std::int64_t>(n, map.y.cells() - cy) + 1 + 2 * around;
    window.x = double(cx - around);
    window.y = double(cy - around);
    load_texels(map, cx + map.x.first() - around, cy + map.y.first() - around, int(window.nx),
                int(window.ny), window.texels);
    return window;
}

// The plane nearest to the texels, by least squares: about their mean it is two separate slopes.
PlaneBound fitted(const Window& w, double x, double y) {
    const double mean_x = 0.5 * double(w.nx - 1), mean_y = 0.5 * double(w.ny - 1);
    double sum = 0, sum_x = 0, sum_y = 0, squares_x = 0, squares_y = 0;
    for (std::int64_t c = 0; c < w.nx; ++c)
        squares_x += (double(c) - mean_x) * (double(c) - mean_x);
    for (std::int64_t r = 0; r < w.ny; ++r)
        squares_y += (double(r) - mean_y) * (double(r) - mean_y);
    for (std::int64_t r = 0; r < w.ny; ++r) {
        const double* const row = w.texels + r * w.nx;
        double of_row = 0;
        for (std::int64_t c = 0; c < w.nx; ++c) {
            of_row += row[c];
            sum_x += (double(c) - mean_x) * row[c];
        }
        sum += of_row;
        sum_y += (double(r) - mean_y) * of_row;
    }
    PlaneBound plane;
    plane.x = x;
    plane.y = y;
    plane.slope_x = sum_x / (squares_x * double(w.ny));
    plane.slope_y = sum_y / (squares_y * double(w.nx));
    plane.middle = sum / double(w.nx * w.ny) + plane.slope_x * (x - (w.x + mean_x)) +
                   plane.slope_y * (y - (w.y + mean_y));
    return plane;
}

void widen(double& low, double& high, double part) {
    const double by = part * (high - low);
    low -= by;
    high += by;
}

// Both filters go through planes, so what they make of a plane and departures from it is the plane
// and what they make of the departures.
void depart(const Window& w, bool bicubic, PlaneBound& plane) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::int64_t r = 0; r < w.ny; ++r)
        for (std::int64_t c = 0; c < w.nx; ++c) {
            const double d = w.texels[r * w.nx + c] - plane.at(w.x + double(c), w.y + double(r));
            low = std::min(low, d);
            high = std::max(high, d);
        }
    if (bicubic) widen(low, high, bicubic_overshoot);
    plane.below = low;
    plane.above = high;
}

// A block's plane as it stands there, in floats. A call of its own: inlined beside the rounding,
// g++ 12's -O2 goes on with the doubles from before it (the test
// `HeightMap.BlocksHoldWhatTheySay` tells, in release builds).
[[gnu::noinline]] PlaneBound plane_of(const HeightBlock& block, double x, double y) {
    return {double(block.middle), double(block.slope_x), double(block.slope_y), x, y, 0, 0};
}

HeightBlock block_of(const HeightMapData& map, std::int64_t bx, std::int64_t by) {
    const bool bicubic = map.taps() == 4;
    const Window w = window_of(map, bx * cells_in_block, by * cells_in_block, cells_in_block);
    const double half = 0.5 * cells_in_block;
    PlaneBound plane =
        fitted(w, double(bx * cells_in_block) + half, double(by * cells_in_block) + half);
    HeightBlock block;
    block.middle = float(plane.middle);
    block.slope_x = float(plane.slope_x);
    block.slope_y = float(plane.slope_y);
    plane = plane_of(block, plane.x, plane.y);
    depart(w, bicubic, plane);
    block.below = float_not_above(plane.below);
    block.above = float_not_below(plane.above);

    double low = w.texels[0], high = low, step_x = 0, step_y = 0;
    for (std::int64_t r = 0; r < w.ny; ++r)
        for (std::int64_t c = 0; c < w.nx; ++c) {
            const double t = w.texels[r * w.nx + c];
            low = std::min(low, t);
            high = std::max(high, t);
            if (c > 0) step_x = std::max(step_x, std::abs(t - w.texels[r * w.nx + c - 1]));
            if (r > 0) step_y = std::max(step_y, std::abs(t - w.texels[(r - 1) * w.nx + c]));
        }
    if (bicubic) widen(low, high, bicubic_overshoot);
    const double steepening = bicubic ? bicubic_steepening : 1.0;
    block.low = float_not_above(low);
    block.high = float_not_below(high);
    block.step_x = float_not_below(steepening * step_x);
    block.step_y = float_not_below(steepening * step_y);
    return block;
}

// Up to four blocks of `size` cells a side as one. What a child says of its own plane holds of the
// parent's after the difference of both, which is linear and so extreme at the child's corners.
HeightBlock joined(const HeightPyramid::Level& fine, std::int64_t bx, std::int64_t by,
                   std::int64_t size) {
    const HeightBlock* children[2][2] = {};
    for (int r = 0; r < 2; ++r)
        for (int c = 0; c < 2; ++c)
            if (2 * bx + c < fine.width && 2 * by + r < fine.height)
                children[r][c] = &fine.blocks[std::size_t((2 * by + r) * fine.width + 2 * bx + c)];
    const auto mean = [&](const auto& of, bool across, bool down) {
        double sum = 0;
        int count = 0;
        for (int r = 0; r < (down ? 1 : 2); ++r)
            for (int c = 0; c < (across ? 1 : 2); ++c)
                if (children[r][c] && (!across || children[r][1]) && (!down || children[1][c])) {
                    sum += of(r, c);
                    ++count;
                }
        return count > 0 ? sum / count : 0.0;
    };
    const double child = double(size), quarter = 0.5 * child;
    double slope_x = 0, slope_y = 0;
    if (children[0][1])
        slope_x = mean(
            [&](int r, int) {
                return (double(children[r][1]->middle) - double(children[r][0]->middle)) / child;
            },
            true, false);
    else
        slope_x = mean([&](int r, int c) { return double(children[r][c]->slope_x); }, false, false);
    if (children[1][0])
        slope_y = mean(
            [&](int, int c) {
                return (double(children[1][c]->middle) - double(children[0][c]->middle)) / child;
            },
            false, true);
    else
        slope_y = mean([&](int r, int c) { return double(children[r][c]->slope_y); }, false, false);
    HeightBlock block;
    block.slope_x = float(slope_x);
    block.slope_y = float(slope_y);
    block.middle = float(mean(
        [&](int r, int c) {
            return double(children[r][c]->middle) - slope_x * (c ? quarter : -quarter) -
                   slope_y * (r ? quarter : -quarter);
        },
        false, false));
    const PlaneBound plane = plane_of(block, 0, 0);
    double below = std::numeric_limits<double>::infinity(), above = -below;
    bool first = true;
    for (int r = 0; r < 2; ++r)
        for (int c = 0; c < 2; ++c) {
            const HeightBlock* const from = children[r][c];
            if (!from) continue;
            const double difference =
                double(from->middle) - plane.at(c ? quarter : -quarter, r ? quarter : -quarter);
            const double tilt = quarter * (std::abs(double(from->slope_x) - plane.slope_x) +
                                           std::abs(double(from->slope_y) - plane.slope_y));
            below = std::min(below, difference - tilt + double(from->below));
            above = std::max(above, difference + tilt + double(from->above));
            block.low = first ? from->low : std::min(block.low, from->low);
            block.high = first ? from->high : std::max(block.high, from->high);
            block.step_x = std::max(block.step_x, from->step_x);
            block.step_y = std::max(block.step_y, from->step_y);
            first = false;
        }
    block.below = float_not_above(below);
    block.above = float_not_below(above);
    return block;
}

void halves(double* p, std::size_t stride, int n, double t0, double t1) {
    // De Casteljau twice: what lies before t1, and of that what lies behind t0.
    for (int k = 1; k < n; ++k)
        for (int i = n - 1; i >= k; --i)
            p[std::size_t(i) * stride] =
                p[std::size_t(i - 1) * stride] * (1 - t1) + p[std::size_t(i) * stride] * t1;
    const double t = t1 > 0 ? t0 / t1 : 0;
    for (int k = 1; k < n; ++k)
        for (int i = 0; i < n - k; ++i)
            p[std::size_t(i) * stride] =
                p[std::size_t(i) * stride] * (1 - t) + p[std::size_t(i + 1) * stride] * t;
}

}  // namespace

HeightPyramid make_height_pyramid(const HeightMapData& map, int threads) {
    HeightPyramid pyramid;
    pyramid.levels.reserve(32);  // each is made from the one before, which must not move
    const auto add_level = [&](std::int64_t width, std::int64_t height, const auto& make) {
        HeightPyramid::Level level{width, height, {}};
        level.blocks.resize(std::size_t(width * height));
        parallel_blocks(std::size_t(height), 4, threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t y = begin; y < end; ++y)
                for (std::int64_t x = 0; x < width; ++x)
                    level.blocks[y * std::size_t(width) + std::size_t(x)] =
                        make(x, std::int64_t(y));
        });
        pyramid.levels.push_back(std::move(level));
    };
    const auto blocks = [](std::int64_t cells) {
        return (cells + cells_in_block - 1) / cells_in_block;
    };
    add_level(blocks(map.x.cells()), blocks(map.y.cells()),
              [&](std::int64_t x, std::int64_t y) { return block_of(map, x, y); });
    std::int64_t size = cells_in_block;
    while (pyramid.levels.back().width > 1 || pyramid.levels.back().height > 1) {
        const HeightPyramid::Level& fine = pyramid.levels.back();
        add_level((fine.width + 1) / 2, (fine.height + 1) / 2,
                  [&](std::int64_t x, std::int64_t y) { return joined(fine, x, y, size); });
        size *= 2;
    }
    return pyramid;
}

PlaneBound plane_of_cells(const HeightMapData& map, std::int64_t cx, std::int64_t cy, int n) {
    const Window w = window_of(map, cx, cy, n);
    PlaneBound plane = fitted(w, double(cx) + 0.5 * n, double(cy) + 0.5 * n);
    depart(w, map.taps() == 4, plane);
    return plane;
}

void CellNet::restrict_to(double x0, double x1, double y0, double y1) {
    const auto rows = std::size_t(n);
    if (x0 > 0 || x1 < 1)
        for (std::size_t r = 0; r < rows; ++r) halves(control + r * rows, 1, n, x0, x1);
    if (y0 > 0 || y1 < 1)
        for (std::size_t c = 0; c < rows; ++c) halves(control + c, rows, n, y0, y1);
}

double CellNet::low() const {
    return *std::min_element(control, control + n * n);
}
double CellNet::high() const {
    return *std::max_element(control, control + n * n);
}

CellNet cell_net(const HeightMapData& map, std::int64_t cx, std::int64_t cy) {
    CellNet net;
    net.n = map.taps();
    const std::int64_t i = cx + map.x.first(), j = cy + map.y.first();
    if (net.n == 2) {
        load_texels(map, i, j, 2, 2, net.control);
        return net;
    }
    load_texels(map, i - 1, j - 1, 4, 4, net.control);
    const auto to_bernstein = [](double* p, std::size_t stride) {
        const double a = p[0], b = p[stride], c = p[2 * stride], d = p[3 * stride];
        p[0] = b;
        p[stride] = b + (c - a) / 6;
        p[2 * stride] = c - (d - b) / 6;
        p[3 * stride] = c;
    };
    for (std::size_t r = 0; r < 4; ++r) to_bernstein(net.control + 4 * r, 1);
    for (std::size_t c = 0; c < 4; ++c) to_bernstein(net.control + c, 4);
    return net;
}

PlaneBound plane_of_net(const CellNet& net, double x, double y, double width, double height) {
    const auto n = std::size_t(net.n);
    const double* const p = net.control;
    const double a = p[0], b = p[n - 1], c = p[n * (n - 1)], d = p[n * n - 1];
    PlaneBound plane;
    plane.x = x;
    plane.y = y;
    const double across = 0.5 * ((b - a) + (d - c)), down = 0.5 * ((c - a) + (d - b));
    // What is too narrow for a slope that is a number departs from level ground by next to nothing.
    plane.slope_x = width > 0x1p-40 ? across / width : 0;
    plane.slope_y = height > 0x1p-40 ? down / height : 0;
    plane.middle = 0.25 * (a + b + c + d) - 0.5 * (width * plane.slope_x + height * plane.slope_y);
    plane.below = std::numeric_limits<double>::infinity();
    plane.above = -plane.below;
    const double step_x = width / double(n - 1), step_y = height / double(n - 1);
    for (std::size_t r = 0; r < n; ++r)
        for (std::size_t k = 0; k < n; ++k) {
            const double difference =
                p[r * n + k] - plane.at(x + double(k) * step_x, y + double(r) * step_y);
            plane.below = std::min(plane.below, difference);
            plane.above = std::max(plane.above, difference);
        }
    return plane;
}

}  // namespace prep::detail
