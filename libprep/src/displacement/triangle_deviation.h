// How far a map departs from what is linear over a triangle: branch and bound over its blocks.
//
// The triangle is cut by the blocks' borders; each piece keeps its cell coordinates and the linear
// function's values, so a triangle whose UVs lie on a line, or in a point, is one like any other.
// Over a piece the map is a plane and a departure from it (height_pyramid.h), plane minus linear
// function is extreme at the piece's corners. The piece of the largest bound is split next, into
// blocks, cells and parts of cells; in a cell of a single bilinear channel the extreme is known:
// along an edge of the piece it is that of a parabola, and inside there is only a saddle.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "displacement/bilinear_deviation.h"
#include "displacement/height_data.h"
#include "displacement/map_regions.h"

namespace prep::detail {

template <int N>
class TriangleDeviation {
  public:
    using Values = std::array<double, N>;

    TriangleDeviation(const std::array<const HeightMapData*, N>& maps,
                      const std::array<glm::dvec2, 3>& uv, const std::array<Values, 3>& values,
                      double enough, std::uint32_t effort)
        : maps_(maps), map_(*maps[0]), enough_(enough), effort_(effort) {
        bool finite = true;
        for (std::size_t k = 0; k < 3; ++k) {
            finite &= std::isfinite(uv[k].x) && std::isfinite(uv[k].y);
            triangle_.corner[k].value = values[k];
            for (const double v : values[k]) finite_values_ &= std::isfinite(v);
        }
        triangle_.count = 3;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 p = map_.map_point(finite ? uv[k] : glm::dvec2(0.0));
            triangle_.corner[k].x = p.x;
            triangle_.corner[k].y = p.y;
        }
    }

    Deviation run() {
        if (!finite_values_) return {std::numeric_limits<double>::infinity(), 0};
        start();
        while (!heap_.empty() && heap_.front().upper > threshold() && nodes_ < effort_) {
            std::pop_heap(heap_.begin(), heap_.end(), smaller);
            const Node node = heap_.back();
            heap_.pop_back();
            split(node);
        }
        const double found = heap_.empty() ? 0.0 : heap_.front().upper;
        const double upper = std::max(found, settled_);
        return {upper + slack(), std::min(lower_, upper + slack())};
    }

  private:
    struct Corner {
        double x = 0, y = 0;
        Values value{};
    };
    // A triangle cut by the four borders of a box has seven corners at most.
    struct Piece {
        static constexpr int most = 12;
        int count = 0;
        std::array<Corner, most> corner;
    };
    // Of 8 · 2^level cells a side; a cell is at level −3.
    struct Node {
        double upper = 0;
        int level = 0;
        std::int64_t bx = 0, by = 0;
        Piece piece;
    };
    static constexpr int cell_level = -3, last_level = -14;
    static bool smaller(const Node& a, const Node& b) { return a.upper < b.upper; }

    double threshold() const { return std::max(enough_, 1.1 * lower_); }
    static double size_of(int level) { return std::ldexp(double(cells_in_block), level); }

    double slack() const {
        double largest = 0, x = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            x = std::max({x, std::abs(triangle_.corner[k].x), std::abs(triangle_.corner[k].y)});
            for (const double v : triangle_.corner[k].value)
                largest = std::max(largest, std::abs(v));
        }
        double sum = 0;
        for (const HeightMapData* map : maps_) sum += deviation_slack(*map, x, largest);
        return sum;
    }

    // Part of `from` with sign · (coordinate − at) ≤ 0. Corners made here lie exactly on the
    // border.
    static Piece cut(const Piece& from, bool along_y, double at, double sign) {
        const auto coordinate = [&](const Corner& c) { return along_y ? c.y : c.x; };
        Piece out;
        for (int i = 0; i < from.count; ++i) {
            const Corner& a = from.corner[std::size_t(i)];
            const Corner& b = from.corner[std::size_t(i + 1 == from.count ? 0 : i + 1)];
            const double da = sign * (coordinate(a) - at), db = sign * (coordinate(b) - at);
            if (out.count + 2 > Piece::most) return from;  // never but by rounding: stays a bound
            if (da <= 0) out.corner[std::size_t(out.count++)] = a;
            if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
                const double t = da / (da - db);
                Corner& c = out.corner[std::size_t(out.count++)];
                c.x = along_y ? a.x + t * (b.x - a.x) : at;
                c.y = along_y ? at : a.y + t * (b.y - a.y);
                for (std::size_t k = 0; k < N; ++k)
                    c.value[k] = a.value[k] + t * (b.value[k] - a.value[k]);
            }
        }
        return out;
    }

    struct Box {
        double x0, x1, y0, y1;
    };
    static Box box_of(const Piece& piece) {
        Box box{piece.corner[0].x, piece.corner[0].x, piece.corner[0].y, piece.corner[0].y};
        for (int i = 1; i < piece.count; ++i) {
            const Corner& c = piece.corner[std::size_t(i)];
            box.x0 = std::min(box.x0, c.x);
            box.x1 = std::max(box.x1, c.x);
            box.y0 = std::min(box.y0, c.y);
            box.y1 = std::max(box.y1, c.y);
        }
        return box;
    }

    // Both parts; what only touches the border belongs to one of them.
    static void halve(const Piece& from, bool along_y, double at, Piece& below, Piece& above) {
        const Box box = box_of(from);
        const double low = along_y ? box.y0 : box.x0, high = along_y ? box.y1 : box.x1;
        below.count = above.count = 0;
        if (high <= at)
            below = from;
        else if (low >= at)
            above = from;
        else {
            below = cut(from, along_y, at, 1);
            above = cut(from, along_y, at, -1);
        }
    }

    void start() {
        for (std::size_t k = 0; k < 3; ++k) sample_map(triangle_.corner[k]);
        Corner middle;
        for (std::size_t k = 0; k < 3; ++k) {
            middle.x += triangle_.corner[k].x / 3;
            middle.y += triangle_.corner[k].y / 3;
            for (std::size_t c = 0; c < N; ++c) middle.value[c] += triangle_.corner[k].value[c] / 3;
        }
        sample_map(middle);
        const Box box = box_of(triangle_);
        const double x0 = region_of(map_.x, box.x0), x1 = region_of(map_.x, box.x1);
        const double y0 = region_of(map_.y, box.y0), y1 = region_of(map_.y, box.y1);
        constexpr double most_regions = 4096;
        const double largest = std::max(std::max(std::abs(box.x0), std::abs(box.x1)),
                                        std::max(std::abs(box.y0), std::abs(box.y1)));
        if ((x1 - x0 + 1) * (y1 - y0 + 1) > most_regions || largest > 0x1p45) return everywhere();
        for (double j = y0; j <= y1; ++j)
            for (double i = x0; i <= x1; ++i) {
                const AxisRegion rx = region(map_.x, i), ry = region(map_.y, j);
                Piece piece = triangle_;
                if (i > x0) piece = cut(piece, false, rx.low, -1);
                if (i < x1 && piece.count > 0) piece = cut(piece, false, rx.high, 1);
                if (j > y0 && piece.count > 0) piece = cut(piece, true, ry.low, -1);
                if (j < y1 && piece.count > 0) piece = cut(piece, true, ry.high, 1);
                if (piece.count == 0) continue;
                for (int k = 0; k < piece.count; ++k) {
                    Corner& c = piece.corner[std::size_t(k)];
                    c.x = std::clamp(rx.cell(c.x), 0.0, double(map_.x.cells()));
                    c.y = std::clamp(ry.cell(c.y), 0.0, double(map_.y.cells()));
                }
                start_in(piece);
            }
    }

    static std::int64_t block_at(double x, std::int64_t cells, double size) {
        const double last = std::ceil(double(cells) / size) - 1;
        return std::int64_t(std::clamp(std::floor(x / size), 0.0, last));
    }

    // Most small triangles of a tessellation are within what is asked for by a wide margin: the
    // planes of the blocks around, without a texel, often say so. Each is a bound for the part that
    // lies in its block, taken over the whole piece.
    bool settle_by_blocks(const Piece& piece, const Box& box) {
        const double size = cells_in_block;
        const std::int64_t bx0 = block_at(box.x0, map_.x.cells(), size);
        const std::int64_t bx1 = block_at(box.x1, map_.x.cells(), size);
        const std::int64_t by0 = block_at(box.y0, map_.y.cells(), size);
        const std::int64_t by1 = block_at(box.y1, map_.y.cells(), size);
        double most = 0;
        int worst = 0;
        for (std::int64_t by = by0; by <= by1; ++by)
            for (std::int64_t bx = bx0; bx <= bx1; ++bx) {
                ++nodes_;
                most = std::max(most, bound_of(0, bx, by, piece, worst));
                if (most > threshold()) return false;
            }
        settled_ = std::max(settled_, most);
        return true;
    }

    // The blocks, few, that a piece of the map is small enough for.
    void start_in(const Piece& piece) {
        const Box box = box_of(piece);
        const double extent = std::max(box.x1 - box.x0, box.y1 - box.y0);
        const int top = int(map_.pyramid.levels.size()) - 1;
        int level = cell_level;
        while (level < top && size_of(level) < extent) ++level;
        if (level < 0 && settle_by_blocks(piece, box)) return;
        const double size = size_of(level);
        const auto block = [&](double x, std::int64_t cells) { return block_at(x, cells, size); };
        const std::int64_t bx0 = block(box.x0, map_.x.cells()), bx1 = block(box.x1, map_.x.cells());
        const std::int64_t by0 = block(box.y0, map_.y.cells()), by1 = block(box.y1, map_.y.cells());
        Piece rest = piece, row;
        for (std::int64_t by = by0; by <= by1; ++by) {
            Piece in_row = rest;
            if (by < by1) halve(rest, true, double(by + 1) * size, in_row, row);
            rest = row;
            if (in_row.count == 0) continue;
            Piece behind = in_row, next;
            for (std::int64_t bx = bx0; bx <= bx1; ++bx) {
                Piece here = behind;
                if (bx < bx1) halve(behind, false, double(bx + 1) * size, here, next);
                behind = next;
                if (here.count > 0) add(level, bx, by, here);
            }
        }
    }

    void split(const Node& node) {
        const int level = node.level - 1;
        const double size = size_of(level);
        const double x = double(2 * node.bx + 1) * size, y = double(2 * node.by + 1) * size;
        std::array<Piece, 2> rows;
        halve(node.piece, true, y, rows[0], rows[1]);
        for (std::size_t r = 0; r < 2; ++r) {
            if (rows[r].count == 0) continue;
            std::array<Piece, 2> parts;
            halve(rows[r], false, x, parts[0], parts[1]);
            for (std::size_t c = 0; c < 2; ++c)
                if (parts[c].count > 0)
                    add(level, 2 * node.bx + std::int64_t(c), 2 * node.by + std::int64_t(r),
                        parts[c]);
        }
    }

    PlaneBound plane(const HeightMapData& map, int level, std::int64_t bx, std::int64_t by,
                     const Piece& piece) const {
        if (level >= 0) {
            const HeightPyramid::Level& blocks = map.pyramid.levels[std::size_t(level)];
            const HeightBlock& b = blocks.blocks[std::size_t(by * blocks.width + bx)];
            const double size = size_of(level);
            return {double(b.middle),
                    double(b.slope_x),
                    double(b.slope_y),
                    (double(bx) + 0.5) * size,
                    (double(by) + 0.5) * size,
                    double(b.below),
                    double(b.above)};
        }
        if (level > cell_level) {
            const std::int64_t cells = std::int64_t(size_of(level));
            return plane_of_cells(map, bx * cells, by * cells, int(cells));
        }
        const int deeper = cell_level - level;
        const std::int64_t cx = bx >> deeper, cy = by >> deeper;
        // Inside a cell the piece's own box, which may be much smaller than the block.
        CellNet net = cell_net(map, cx, cy);
        const auto within = [](double at, std::int64_t cell) {
            return std::clamp(at - double(cell), 0.0, 1.0);
        };
        const Box box = box_of(piece);
        const double x0 = within(box.x0, cx), x1 = within(box.x1, cx);
        const double y0 = within(box.y0, cy), y1 = within(box.y1, cy);
        net.restrict_to(x0, x1, y0, y1);
        return plane_of_net(net, double(cx) + x0, double(cy) + y0, x1 - x0, y1 - y0);
    }

    static double length(const Values& v) {
        if constexpr (N == 1) {
            return std::abs(v[0]);
        } else {
            double sum = 0;
            for (const double x : v) sum += x * x;
            return std::sqrt(sum);
        }
    }

    // Of one piece in one block: the departures' middle is the plane's, their half stays.
    double bound_of(int level, std::int64_t bx, std::int64_t by, const Piece& piece,
                    int& worst) const {
        std::array<PlaneBound, N> planes;
        Values half{}, middle{};
        for (std::size_t k = 0; k < N; ++k) {
            const HeightMapData& map = *maps_[k];
            planes[k] = plane(map, level, bx, by, piece);
            half[k] = std::abs(map.unit) * 0.5 * (planes[k].above - planes[k].below);
            middle[k] = 0.5 * (planes[k].above + planes[k].below);
        }
        double at_corner = 0;
        for (int i = 0; i < piece.count; ++i) {
            const Corner& c = piece.corner[std::size_t(i)];
            Values d{};
            for (std::size_t k = 0; k < N; ++k)
                d[k] = maps_[k]->height(planes[k].at(c.x, c.y) + middle[k]) - c.value[k];
            const double l = length(d);
            if (l > at_corner) {
                at_corner = l;
                worst = i;
            }
        }
        return at_corner + length(half);
    }

    void add(int level, std::int64_t bx, std::int64_t by, const Piece& piece) {
        ++nodes_;
        if (N == 1 && level == cell_level && map_.taps() == 2) return settle_cell(bx, by, piece);
        int worst = 0;
        const double upper = bound_of(level, bx, by, piece, worst);
        if (upper > threshold()) sample_piece(piece, worst);
        if (upper <= threshold() || level <= last_level) {
            settled_ = std::max(settled_, upper);
            return;
        }
        heap_.push_back({upper, level, bx, by, piece});
        std::push_heap(heap_.begin(), heap_.end(), smaller);
    }

    void settle_cell(std::int64_t bx, std::int64_t by, const Piece& piece) {
        const CellNet net = cell_net(map_, bx, by);
        const double* const t = net.control;
        const double twist = map_.unit * ((t[0] - t[1]) - (t[2] - t[3]));
        std::array<double, Piece::most> g;
        double most = 0;
        for (int i = 0; i < piece.count; ++i) {
            const Corner& c = piece.corner[std::size_t(i)];
            const double fx = c.x - double(bx), fy = c.y - double(by);
            g[std::size_t(i)] = map_.height(bilinear(t, fx, fy)) - c.value[0];
            most = std::max(most, std::abs(g[std::size_t(i)]));
        }
        for (int i = 0; i < piece.count; ++i) {
            const auto a = std::size_t(i), b = std::size_t(i + 1 == piece.count ? 0 : i + 1);
            const double bend = twist * (piece.corner[b].x - piece.corner[a].x) *
                                (piece.corner[b].y - piece.corner[a].y);
            const double slope = g[b] - g[a] - bend;
            // At t = −slope/(2 bend), where that lies on the edge.
            if (bend == 0 || slope * bend > 0 || std::abs(slope) > 2 * std::abs(bend)) continue;
            most = std::max(most, std::abs(g[a] - slope * slope / (4 * bend)));
        }
        lower_ = std::max(lower_, most);
        settled_ = std::max(settled_, most);
    }

    // No sample finds more than what is there; these find most of it.
    void sample_piece(const Piece& piece, int worst) {
        sample_cells(piece.corner[std::size_t(worst)]);
        Corner middle;
        const double part = 1.0 / piece.count;
        for (int i = 0; i < piece.count; ++i) {
            const Corner& c = piece.corner[std::size_t(i)];
            middle.x += part * c.x;
            middle.y += part * c.y;
            for (std::size_t k = 0; k < N; ++k) middle.value[k] += part * c.value[k];
        }
        sample_cells(middle);
    }
    void sample_cells(const Corner& c) {
        const CellPoint x = cell_point(map_.x, c.x), y = cell_point(map_.y, c.y);
        Values d{};
        for (std::size_t k = 0; k < N; ++k) {
            const HeightMapData& map = *maps_[k];
            d[k] = map.height(raw_at(map, x.cell + map.x.first(), y.cell + map.y.first(), x.part,
                                     y.part, nullptr)) -
                   c.value[k];
        }
        lower_ = std::max(lower_, length(d));
    }
    void sample_map(const Corner& c) {
        const AxisRegion rx = region(map_.x, region_of(map_.x, c.x));
        const AxisRegion ry = region(map_.y, region_of(map_.y, c.y));
        Corner inside = c;
        inside.x = rx.cell(c.x);
        inside.y = ry.cell(c.y);
        sample_cells(inside);
    }

    // Over thousands of copies of the map: its range against the values'.
    void everywhere() {
        Values most{};
        for (std::size_t k = 0; k < N; ++k) {
            const HeightBlock& all = maps_[k]->pyramid.levels.back().blocks[0];
            for (std::size_t i = 0; i < 3; ++i)
                for (const float raw : {all.low, all.high})
                    most[k] = std::max(most[k], std::abs(maps_[k]->height(double(raw)) -
                                                         triangle_.corner[i].value[k]));
        }
        settled_ = std::max(settled_, length(most));
    }

    std::array<const HeightMapData*, N> maps_;
    const HeightMapData& map_;  // of the shape that all have
    double enough_;
    std::uint32_t effort_, nodes_ = 0;
    Piece triangle_;
    bool finite_values_ = true;
    std::vector<Node> heap_;
    double settled_ = 0, lower_ = 0;  // `settled_`: of pieces that are not split any further
};

}  // namespace prep::detail
