// Points and grids of Loop's scheme.
//
// A piece covers a triangle of its root: a frame in lattice steps.
#include <algorithm>
#include <cmath>

#include "limit_surface/patch_evaluator.h"

namespace prep::detail {
namespace {

template <class T>
using Frame = LatticeFrame<T>;

// Derivatives by the root's parameters out of those by the piece's, in place; the determinant of
// the steps is 1.
template <class T>
void to_root(const Frame<T>& frame, std::uint32_t width, double scale, double* da, double* db) {
    for (std::uint32_t d = 0; d < width; ++d) {
        const double a = da[d] * scale, b = db[d] * scale;
        da[d] = frame.by * a - frame.ay * b;
        db[d] = frame.ax * b - frame.bx * a;
    }
}

template <class T>
void to_root(const Frame<T>& f, std::uint32_t width, double scale, const SecondDerivatives& of) {
    for (std::uint32_t d = 0; d < width; ++d) {
        const double aa = of.uu[d] * scale * scale, ab = of.uv[d] * scale * scale;
        const double bb = of.vv[d] * scale * scale;
        of.uu[d] = f.by * f.by * aa - 2 * f.by * f.ay * ab + f.ay * f.ay * bb;
        of.uv[d] = (f.ax * f.by + f.ay * f.bx) * ab - f.by * f.bx * aa - f.ay * f.ax * bb;
        of.vv[d] = f.bx * f.bx * aa - 2 * f.ax * f.bx * ab + f.ax * f.ax * bb;
    }
}

void no_second(std::uint32_t width, const SecondDerivatives* second) {
    for (std::uint32_t d = 0; second && d < width; ++d)
        second->uu[d] = second->uv[d] = second->vv[d] = 0;
}

void linear(const std::array<const double*, 4>& p, std::uint32_t width, double u, double v,
            double* value, double* du, double* dv) {
    for (std::uint32_t d = 0; d < width; ++d) {
        value[d] = (1 - u - v) * p[0][d] + u * p[1][d] + v * p[2][d];
        if (!du) continue;
        du[d] = p[1][d] - p[0][d];
        dv[d] = p[2][d] - p[0][d];
    }
}

void combine(const double* weights, const double* controls, std::uint32_t width, double* out) {
    for (std::uint32_t d = 0; d < width; ++d) {
        double sum = 0;
        for (std::uint32_t k = 0; k < 12; ++k) sum += weights[k] * controls[k * width + d];
        out[d] = sum;
    }
}

}  // namespace

void PatchEvaluator::gather_triangle(const TrianglePatch& patch) {
    const std::uint32_t width = pieces_.source.width;
    controls_.assign(12 * std::size_t(width), 0.0);
    for (const TrianglePatch::Term& term : patch.terms) {
        const double* from = pieces_.source.of(term.vertex);
        double* to = controls_.data() + std::size_t(term.control) * width;
        for (std::uint32_t d = 0; d < width; ++d) to[d] += term.weight * from[d];
    }
}

// Of the part at the sector's first edge (1), at its last one (2), or between (3); about the
// centre.
void PatchEvaluator::gather_triangle_ring(const RingSector& sector, const RingAccess& access,
                                          int part) {
    const std::uint32_t width = pieces_.source.width;
    controls_.resize(12 * std::size_t(width));
    ring_patch(pieces_.tree->rings[sector.ring].shape, width, access.rings, access.next,
               sector.sector, part & 1, part >> 1, controls_.data());
}

struct PatchEvaluator::TriangleCell {
    std::uint32_t level, face;
    Frame<int> frame;
    std::uint32_t n;
    double scale;  // of derivatives
};

GridOutput PatchEvaluator::triangle_at(const GridOutput& out, int x, int y) const {
    const std::size_t n = triangle_n_, row = std::size_t(y);
    const std::size_t by =
        (row * (n + 1) - row * (row - 1) / 2 + std::size_t(x)) * pieces_.source.width;
    GridOutput to{out.value + by};
    if (out.du) to.du = out.du + by, to.dv = out.dv + by;
    return to;
}

void PatchEvaluator::triangle_grid(const PatchRoot& root, std::uint32_t n, const GridOutput& out) {
    triangle_n_ = n;
    triangle_cell({root.level, root.face, {0, 0, 1, 0, 0, 1}, n, 1}, out);
}

void PatchEvaluator::triangle_patch_point(double u, double v, double* value, double* du, double* dv,
                                          const SecondDerivatives* second) const {
    const LoopWeights weights = loop_weights(u, v);
    combine(weights.value, controls_.data(), pieces_.source.width, value);
    combine(weights.du, controls_.data(), pieces_.source.width, du);
    combine(weights.dv, controls_.data(), pieces_.source.width, dv);
    if (!second) return;
    const LoopSecondWeights of = loop_second_weights(u, v);
    combine(of.uu, controls_.data(), pieces_.source.width, second->uu);
    combine(of.uv, controls_.data(), pieces_.source.width, second->uv);
    combine(of.vv, controls_.data(), pieces_.source.width, second->vv);
}

// The points of a cell whose 12 controls are gathered.
void PatchEvaluator::triangle_patch_grid(const TriangleCell& cell, const GridOutput& out) {
    const std::uint32_t width = pieces_.source.width;
    const LoopTable& table = tables_->triangle(cell.n);
    std::size_t k = 0;
    for (int b = 0; b <= int(cell.n); ++b)
        for (int a = 0; a + b <= int(cell.n); ++a, ++k) {
            const Frame<int> p = cell.frame.moved(a, b);
            const GridOutput to = triangle_at(out, p.x, p.y);
            if (control_points_) {
                combine(table.control.data() + 12 * k, controls_.data(), width, to.value);
                continue;
            }
            combine(table.weights[k].value, controls_.data(), width, to.value);
            if (!out.du) continue;
            combine(table.weights[k].du, controls_.data(), width, to.du);
            combine(table.weights[k].dv, controls_.data(), width, to.dv);
            to_root(cell.frame, width, cell.scale, to.du, to.dv);
        }
}

void PatchEvaluator::triangle_cell(const TriangleCell& cell, const GridOutput& out) {
    const PatchTree& tree = *pieces_.tree;
    const PatchNode node = tree.nodes[cell.level][cell.face];
    const std::uint32_t width = pieces_.source.width;
    const int n = int(cell.n);
    if (node.kind == PatchNode::regular) {
        gather_triangle(tree.triangle_patches[node.index]);
        return triangle_patch_grid(cell, out);
    }
    if (node.kind == PatchNode::linear) {
        const Corners corners = corner_values(cell.level, cell.face);
        for (int b = 0; b <= n; ++b)
            for (int a = 0; a + b <= n; ++a) {
                const Frame<int> at = cell.frame.moved(a, b);
                const GridOutput to = triangle_at(out, at.x, at.y);
                linear(corners, width, double(a) / n, double(b) / n, to.value, to.du, to.dv);
            }
        return;
    }
    if (node.kind == PatchNode::split && n > 1) {
        const std::uint32_t level = cell.level + 1;
        const std::uint32_t first = pieces_.cage->levels[cell.level].first_child[cell.face];
        const int half = n / 2;
        for (std::uint32_t c = 0; c < 4; ++c) {
            const Frame<int> frame = child_frame(*pieces_.cage, level, first, c, cell.frame, half);
            triangle_cell({level, first + c, frame, cell.n / 2, 2 * cell.scale}, out);
        }
        return;
    }
    if (node.kind == PatchNode::ring && n > 1) return triangle_ring_grid(cell, out);
    std::vector<double> unused(out.du ? 0 : 2 * std::size_t(width));
    for (std::uint32_t c = 0; c < 3; ++c) {
        const Frame<int> at = cell.frame.moved(c == 1 ? n : 0, c == 2 ? n : 0);
        const GridOutput to = triangle_at(out, at.x, at.y);
        if (control_points_) {
            std::copy_n(corner_values(cell.level, cell.face)[c], width, to.value);
            continue;
        }
        double* const du = to.du ? to.du : unused.data();
        double* const dv = to.du ? to.dv : unused.data() + width;
        triangle_point(cell.level, cell.face, c == 1, c == 2, to.value, du, dv, nullptr);
        to_root(cell.frame, width, cell.scale, du, dv);
    }
}

void PatchEvaluator::triangle_ring_grid(const TriangleCell& cell, const GridOutput& out) {
    const PatchTree& tree = *pieces_.tree;
    const RingSector sector = tree.sectors[tree.nodes[cell.level][cell.face].index];
    const std::uint32_t width = pieces_.source.width;
    const Frame<int> frame = cell.frame.at_corner(sector.corner, int(cell.n));
    std::uint32_t n = cell.n;
    int k = 0;
    double scale = cell.scale;
    for (; n > 1; ++k) {
        const RingAccess access = ring_access(sector.ring, k);
        const int half = int(n / 2);
        scale *= 2;
        for (int part = 1; part < 4; ++part) {
            gather_triangle_ring(sector, access, part);
            for (std::uint32_t p = 0; p < 12; ++p)
                for (std::uint32_t d = 0; d < width; ++d)
                    controls_[p * width + d] += access.centre[d];
            const Frame<int> at = part == 3
                                      ? frame.moved(half, half).inverted()
                                      : frame.moved(part == 1 ? half : 0, part == 2 ? half : 0);
            triangle_patch_grid({cell.level, cell.face, at, n / 2, scale}, out);
        }
        n /= 2;
    }
    const RingAccess access = ring_access(sector.ring, k);
    std::vector<double> unused(out.du ? 0 : 2 * std::size_t(width));
    for (int c = 0; c < 3; ++c) {
        const int x = c == 1, y = c == 2;
        const Frame<int> at = frame.moved(x, y);
        const GridOutput to = triangle_at(out, at.x, at.y);
        if (control_points_) {
            sector_point(sector, access, x, y, to.value);
            continue;
        }
        double* const du = to.du ? to.du : unused.data();
        double* const dv = to.du ? to.dv : unused.data() + width;
        sector_limit(sector, access, x, y, to.value, du, dv);
        to_root(frame, width, c == 0 ? cell.scale : scale, du, dv);
    }
}

PointTraits PatchEvaluator::triangle_point(std::uint32_t level, std::uint32_t face, double u,
                                           double v, double* value, double* du, double* dv,
                                           const SecondDerivatives* second) {
    const PatchTree& tree = *pieces_.tree;
    const std::uint32_t width = pieces_.source.width;
    PatchNode node = tree.nodes[level][face];
    Frame<double> frame{0, 0, 1, 0, 0, 1};
    double unit = 1;
    const auto into = [&](const Frame<double>& inner) {  // inner: in the frame's own steps
        const Frame<double> f = frame;
        const auto x = [&](double a, double b) { return a * f.ax + b * f.bx; };
        const auto y = [&](double a, double b) { return a * f.ay + b * f.by; };
        frame = {0,
                 0,
                 x(inner.ax, inner.ay),
                 y(inner.ax, inner.ay),
                 x(inner.bx, inner.by),
                 y(inner.bx, inner.by)};
        const double p = u - inner.x, q = v - inner.y;  // its determinant is 1
        u = inner.by * p - inner.bx * q;
        v = inner.ax * q - inner.ay * p;
    };
    while (node.kind == PatchNode::split) {
        const std::uint32_t first = pieces_.cage->levels[level].first_child[face];
        const std::uint32_t c = u > 0.5 ? 1 : v > 0.5 ? 2 : u + v <= 0.5 ? 0 : 3;
        u *= 2, v *= 2, unit *= 2;
        const Frame<double> whole{0, 0, 1, 0, 0, 1};
        into(child_frame(*pieces_.cage, level + 1, first, c, whole, 1.0));
        node = tree.nodes[++level][face = first + c];
    }
    PointTraits traits;
    if (node.kind == PatchNode::linear) {
        linear(corner_values(level, face), width, u, v, value, du, dv);
        no_second(width, second);
    } else if (node.kind == PatchNode::regular) {
        gather_triangle(tree.triangle_patches[node.index]);
        triangle_patch_point(u, v, value, du, dv, second);
    } else {
        const RingSector sector = tree.sectors[node.index];
        into(Frame<double>{0, 0, 1, 0, 0, 1}.at_corner(sector.corner, 1));
        u = std::max(u, 0.0), v = std::max(v, 0.0);
        const int deepest = tree.rings[sector.ring].shape.deepest_level();
        int k = 0;
        for (; k < deepest && u + v <= 0.5; ++k) u *= 2, v *= 2;
        if (k == deepest || u + v == 0) {
            sector_limit(sector, ring_access(sector.ring, 0), 0, 0, value, du, dv);
            no_second(width, second);
            traits = {sector.ring, sector.sector};
        } else {
            const int part = u > 0.5 ? 1 : v > 0.5 ? 2 : 3;
            const RingAccess access = ring_access(sector.ring, k);
            gather_triangle_ring(sector, access, part);
            u *= 2, v *= 2, unit = std::ldexp(unit, k + 1);
            if (part == 1) u -= 1;
            if (part == 2) v -= 1;
            if (part == 3) into({1, 1, -1, 0, 0, -1});
            triangle_patch_point(u, v, value, du, dv, second);
            for (std::uint32_t d = 0; d < width; ++d) value[d] += access.centre[d];
        }
    }
    to_root(frame, width, unit, du, dv);
    if (second) to_root(frame, width, unit, *second);
    return traits;
}

}  // namespace prep::detail
