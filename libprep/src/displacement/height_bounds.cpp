// Bounds of a height map over boxes: whole blocks of the pyramid where they lie inside, cells and
// parts of cells along the border.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "displacement/height_data.h"
#include "displacement/height_field.h"
#include "displacement/map_regions.h"

namespace prep::detail {
namespace {

struct Span {
    double low = 0, high = 0;
};

struct MapBox {
    Span x, y;  // map coordinates
};

// The box around a box of the mesh's UVs, wider by what rounding may have moved at().
MapBox map_box(const HeightMapData& map, const glm::dvec2& low, const glm::dvec2& high) {
    const glm::dvec2 corners[] = {map.map_point(low), map.map_point({high.x, low.y}),
                                  map.map_point({low.x, high.y}), map.map_point(high)};
    MapBox box{{corners[0].x, corners[0].x}, {corners[0].y, corners[0].y}};
    for (const glm::dvec2& c : corners) {
        box.x = {std::min(box.x.low, c.x), std::max(box.x.high, c.x)};
        box.y = {std::min(box.y.low, c.y), std::max(box.y.high, c.y)};
    }
    const auto widen = [](Span& s, double size) {
        const double by = (std::abs(s.low) + std::abs(s.high) + size) * 0x1p-50;
        s.low -= by;
        s.high += by;
    };
    widen(box.x, double(map.x.size));
    widen(box.y, double(map.y.size));
    return box;
}

// The same in cell coordinates: one span for each copy of the map, all of it where there are many.
std::vector<Span> cell_spans(const HeightAxis& axis, const Span& along) {
    const double first = region_of(axis, along.low), last = region_of(axis, along.high);
    const double cells = double(axis.cells());
    if (!(last - first < 3)) return {{0, cells}};
    std::vector<Span> spans;
    for (double number = first; number <= last; ++number) {
        const AxisRegion r = region(axis, number);
        const double a = r.cell(std::max(along.low, r.low)),
                     b = r.cell(std::min(along.high, r.high));
        spans.push_back(
            {std::clamp(std::min(a, b), 0.0, cells), std::clamp(std::max(a, b), 0.0, cells)});
    }
    return spans;
}

// Calls whole(block) for blocks inside the box and part(block x, block y) for blocks of level 0
// across its border; skip(block) says that neither would change anything.
template <class Skip, class Whole, class Part>
void visit(const HeightMapData& map, const Span& x, const Span& y, std::size_t level,
           std::int64_t bx, std::int64_t by, const Skip& skip, const Whole& whole,
           const Part& part) {
    const HeightPyramid::Level& blocks = map.pyramid.levels[level];
    if (bx >= blocks.width || by >= blocks.height) return;
    const double size = std::ldexp(double(cells_in_block), int(level));
    const double x0 = double(bx) * size, y0 = double(by) * size;
    if (x0 > x.high || y0 > y.high || x0 + size < x.low || y0 + size < y.low) return;
    const HeightBlock& block = blocks.blocks[std::size_t(by * blocks.width + bx)];
    if (skip(block)) return;
    const auto inside = [&](double at, const Span& s, std::int64_t cells) {
        return at >= s.low && std::min(at + size, double(cells)) <= s.high;
    };
    if (inside(x0, x, map.x.cells()) && inside(y0, y, map.y.cells())) return whole(block);
    if (level == 0) return part(bx, by);
    for (std::int64_t r = 0; r < 2; ++r)
        for (std::int64_t c = 0; c < 2; ++c)
            visit(map, x, y, level - 1, 2 * bx + c, 2 * by + r, skip, whole, part);
}

template <class Skip, class Whole, class Part>
void visit(const HeightMapData& map, const MapBox& box, const Skip& skip, const Whole& whole,
           const Part& part) {
    const std::vector<Span> across = cell_spans(map.x, box.x), down = cell_spans(map.y, box.y);
    for (const Span& y : down)
        for (const Span& x : across)
            visit(map, x, y, map.pyramid.levels.size() - 1, 0, 0, skip, whole,
                  [&](std::int64_t bx, std::int64_t by) { part(x, y, bx, by); });
}

Interval heights(const HeightMapData& map, double low, double high) {
    const double a = map.height(low), b = map.height(high);
    const double slack = (std::abs(a) + std::abs(b)) * 0x1p-48;
    return {std::min(a, b) - slack, std::max(a, b) + slack};
}

}  // namespace

Interval HeightMap::range() const {
    const HeightBlock& all = data_->pyramid.levels.back().blocks[0];
    return heights(*data_, double(all.low), double(all.high));
}

Interval HeightMap::range(const glm::dvec2& low, const glm::dvec2& high) const {
    const HeightMapData& map = *data_;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    const auto merge = [&](double a, double b) {
        least = std::min(least, a);
        most = std::max(most, b);
    };
    const auto part = [&](const Span& x, const Span& y, std::int64_t bx, std::int64_t by) {
        const auto cells = [](const Span& s, std::int64_t block, std::int64_t count) {
            const std::int64_t first = block * cells_in_block;
            const std::int64_t last = std::min(first + cells_in_block, count) - 1;
            return std::pair(std::clamp(std::int64_t(std::floor(s.low)), first, last),
                             std::clamp(std::int64_t(std::floor(s.high)), first, last));
        };
        const auto [i0, i1] = cells(x, bx, map.x.cells());
        const auto [j0, j1] = cells(y, by, map.y.cells());
        for (std::int64_t j = j0; j <= j1; ++j)
            for (std::int64_t i = i0; i <= i1; ++i) {
                CellNet net = cell_net(map, i, j);
                const auto within = [](double at, std::int64_t cell) {
                    return std::clamp(at - double(cell), 0.0, 1.0);
                };
                net.restrict_to(within(x.low, i), within(x.high, i), within(y.low, j),
                                within(y.high, j));
                merge(net.low(), net.high());
            }
    };
    visit(
        map, map_box(map, low, high),
        [&](const HeightBlock& b) { return double(b.low) >= least && double(b.high) <= most; },
        [&](const HeightBlock& b) { merge(double(b.low), double(b.high)); }, part);
    return heights(map, least, most);
}

double HeightMap::steepest(const glm::dvec2& low, const glm::dvec2& high) const {
    const HeightMapData& map = *data_;
    double step_x = 0, step_y = 0;
    const auto merge = [&](const HeightBlock& b) {
        step_x = std::max(step_x, double(b.step_x));
        step_y = std::max(step_y, double(b.step_y));
    };
    const HeightPyramid::Level& finest = map.pyramid.levels[0];
    visit(
        map, map_box(map, low, high),
        [&](const HeightBlock& b) {
            return double(b.step_x) <= step_x && double(b.step_y) <= step_y;
        },
        merge,
        [&](const Span&, const Span&, std::int64_t bx, std::int64_t by) {
            merge(finest.blocks[std::size_t(by * finest.width + bx)]);
        });
    // Both signs of one component against the other: the length is the same for −g and g.
    const double longest = std::max(glm::length(map.mesh_gradient({step_x, step_y})),
                                    glm::length(map.mesh_gradient({step_x, -step_y})));
    return std::abs(map.unit) * longest * (1 + 0x1p-48);
}

}  // namespace prep::detail
