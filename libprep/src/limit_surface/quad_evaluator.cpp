// Points and grids of Catmull–Clark's scheme.
#include <algorithm>
#include <cmath>

#include "limit_surface/patch_evaluator.h"

namespace prep::detail {
namespace {

// A face whose corner r is a ring's vertex: (s, t) of the face from (a, b) of the sector, and back.
// Whole numbers: within squares of `last` steps.
struct Place {
    int i, j;
};
Place face_place(std::uint32_t r, int a, int b, int last) {
    switch (r) {
        case 0:
            return {a, b};
        case 1:
            return {last - b, a};
        case 2:
            return {last - a, last - b};
        default:
            return {b, last - a};
    }
}
struct Parameters {
    double a, b;
};
Parameters sector_parameters(std::uint32_t r, double s, double t) {
    switch (r) {
        case 0:
            return {s, t};
        case 1:
            return {t, 1 - s};
        case 2:
            return {1 - s, 1 - t};
        default:
            return {1 - t, s};
    }
}

// Derivatives by (s, t) out of those by (a, b), in place.
void turn_derivatives(std::uint32_t r, std::uint32_t width, double scale, double* da, double* db) {
    for (std::uint32_t d = 0; d < width; ++d) {
        const double a = da[d] * scale, b = db[d] * scale;
        switch (r) {
            case 0:
                da[d] = a, db[d] = b;
                break;
            case 1:
                da[d] = -b, db[d] = a;
                break;
            case 2:
                da[d] = -a, db[d] = -b;
                break;
            default:
                da[d] = b, db[d] = -a;
                break;
        }
    }
}

// Second derivatives likewise.
void turn_second(std::uint32_t r, std::uint32_t width, double scale, const SecondDerivatives& of) {
    const double square = scale * scale;
    for (std::uint32_t d = 0; d < width; ++d) {
        const double aa = of.uu[d] * square, ab = of.uv[d] * square, bb = of.vv[d] * square;
        of.uu[d] = r % 2 == 0 ? aa : bb;
        of.uv[d] = r % 2 == 0 ? ab : -ab;
        of.vv[d] = r % 2 == 0 ? bb : aa;
    }
}

void bilinear(const std::array<const double*, 4>& p, std::uint32_t width, double u, double v,
              double* value, double* du, double* dv) {
    for (std::uint32_t d = 0; d < width; ++d) {
        const double bottom = (1 - u) * p[0][d] + u * p[1][d];
        const double top = (1 - u) * p[3][d] + u * p[2][d];
        value[d] = (1 - v) * bottom + v * top;
        if (!du) continue;
        du[d] = (1 - v) * (p[1][d] - p[0][d]) + v * (p[2][d] - p[3][d]);
        dv[d] = top - bottom;
    }
}
void bilinear_second(const std::array<const double*, 4>& p, std::uint32_t width,
                     const SecondDerivatives& second) {
    for (std::uint32_t d = 0; d < width; ++d) {
        second.uu[d] = second.vv[d] = 0;
        second.uv[d] = (p[0][d] - p[1][d]) + (p[2][d] - p[3][d]);
    }
}

// Corner c of a square, counter-clockwise from (0, 0).
int corner_x(std::uint32_t c) {
    return c == 1 || c == 2;
}
int corner_y(std::uint32_t c) {
    return c >= 2;
}

// Sides 0 and 2 of a crease patch run along u; of sides 1 and 2 the crease is at the far end.
bool runs_along_u(const CreasePatch& crease) {
    return crease.side % 2 == 0;
}
bool is_at_far_end(const CreasePatch& crease) {
    return crease.side == 1 || crease.side == 2;
}

}  // namespace

double PatchEvaluator::scale_of(std::uint32_t level, int deeper) const {
    return std::ldexp(1.0, int(level - root_level_) + deeper);
}

const BicubicTable& PatchEvaluator::crease_table(const CreasePatch& crease, std::uint32_t n) {
    const bool reversed = is_at_far_end(crease);
    if (const BicubicTable* table = tables_->crease(n, crease.sharpness, reversed)) return *table;
    own_crease_ = BicubicTable::make_crease(n, pieces_.tree->sharpnesses[crease.sharpness]);
    if (reversed) own_crease_ = own_crease_.reversed();
    return own_crease_;
}

void PatchEvaluator::gather_quad(const RegularPatch& patch) {
    const std::uint32_t width = pieces_.source.width;
    held_ = nothing_held;
    controls_.resize(bicubic_controls(width));
    double* const p = controls_.data();
    const std::uint8_t sides = patch.sharp_sides;
    for (std::uint32_t k = 0; k < 16; ++k)
        if (sides == 0 || patch.is_set(k))
            std::copy_n(pieces_.source.of(patch.controls[k]), width, p + std::size_t(k) * width);
    const auto reflect = [&](std::uint32_t to, std::uint32_t near, std::uint32_t far) {
        for (std::uint32_t d = 0; d < width; ++d)
            p[to * width + d] = 2 * p[near * width + d] - p[far * width + d];
    };
    if (sides & 8)
        for (std::uint32_t j = 0; j < 4; ++j) reflect(4 * j, 4 * j + 1, 4 * j + 2);
    if (sides & 2)
        for (std::uint32_t j = 0; j < 4; ++j) reflect(4 * j + 3, 4 * j + 2, 4 * j + 1);
    if (sides & 1)
        for (std::uint32_t i = 0; i < 4; ++i) reflect(i, 4 + i, 8 + i);
    if (sides & 4)
        for (std::uint32_t i = 0; i < 4; ++i) reflect(12 + i, 8 + i, 4 + i);
}

void PatchEvaluator::quad_cell(const QuadCell& cell, const GridOutput& out) {
    const PatchNode node = pieces_.tree->nodes[cell.level][cell.face];
    switch (node.kind) {
        case PatchNode::regular:
        case PatchNode::crease:
            return quad_patch_grid(node, cell, out);
        case PatchNode::linear:
            return quad_linear_grid(cell, out);
        case PatchNode::ring:
            return quad_ring_grid(cell, out);
        default:
            break;
    }
    if (cell.n == 1) return quad_corners(cell, out);
    const std::uint32_t first = pieces_.cage->levels[cell.level].first_child[cell.face];
    const std::uint32_t half = cell.n / 2;
    for (std::uint32_t c = 0; c < 4; ++c)
        quad_cell({cell.level + 1, first + c, cell.i + (corner_x(c) ? half : 0),
                   cell.j + (corner_y(c) ? half : 0), half},
                  out);
}

void PatchEvaluator::quad_patch_grid(const PatchNode& node, const QuadCell& cell,
                                     const GridOutput& out) {
    const PatchTree& tree = *pieces_.tree;
    GridOutput part = out.at(pieces_.source.width, cell.i, cell.j);
    part.scale = scale_of(cell.level);
    const BicubicTable& smooth = (*tables_)[cell.n];
    const BicubicTable *along_u = &smooth, *along_v = &smooth;
    if (node.kind == PatchNode::crease) {
        const CreasePatch& crease = tree.crease_patches[node.index];
        gather_quad(crease.patch);
        (runs_along_u(crease) ? along_v : along_u) = &crease_table(crease, cell.n);
    } else {
        gather_quad(tree.regular_patches[node.index]);
    }
    bicubic_grid(*along_u, *along_v, control_points_, pieces_.source.width, controls_.data(), part,
                 scratch_.data(), simd_);
}

void PatchEvaluator::quad_patch_point(const PatchNode& node, double u, double v, double* value,
                                      double* du, double* dv, const SecondDerivatives* second) {
    const PatchTree& tree = *pieces_.tree;
    const bool is_crease = node.kind == PatchNode::crease;
    const std::uint64_t held = std::uint64_t(node.kind) << 32 | node.index;
    if (held != held_) {
        gather_quad(is_crease ? tree.crease_patches[node.index].patch
                              : tree.regular_patches[node.index]);
        held_ = held;
    }
    BicubicWeights along_u = bicubic_weights(u), along_v = bicubic_weights(v);
    if (is_crease) {
        const CreasePatch& crease = tree.crease_patches[node.index];
        const float sharpness = tree.sharpnesses[crease.sharpness];
        const double t = runs_along_u(crease) ? v : u;
        (runs_along_u(crease) ? along_v : along_u) =
            is_at_far_end(crease) ? reversed(crease_weights(1 - t, sharpness))
                                  : crease_weights(t, sharpness);
    }
    bicubic_point(pieces_.source.width, controls_.data(), along_u, along_v, value, du, dv, second);
}

void PatchEvaluator::quad_corners(const QuadCell& cell, const GridOutput& out) {
    const std::uint32_t width = pieces_.source.width;
    std::vector<double> unused(out.du ? 0 : 2 * std::size_t(width));
    for (std::uint32_t c = 0; c < 4; ++c) {
        const GridOutput to =
            out.at(width, cell.i + std::uint32_t(corner_x(c)), cell.j + std::uint32_t(corner_y(c)));
        if (control_points_)
            std::copy_n(corner_values(cell.level, cell.face)[c], width, to.value);
        else if (to.du)
            quad_corner(cell.level, cell.face, c, to.value, to.du, to.dv);
        else
            quad_corner(cell.level, cell.face, c, to.value, unused.data(), unused.data() + width);
    }
}

void PatchEvaluator::quad_corner(std::uint32_t level, std::uint32_t face, std::uint32_t c,
                                 double* value, double* du, double* dv) {
    const PatchTree& tree = *pieces_.tree;
    PatchNode node = tree.nodes[level][face];
    while (node.kind == PatchNode::split) {
        face = pieces_.cage->levels[level].first_child[face] + c;
        node = tree.nodes[++level][face];
    }
    const std::uint32_t width = pieces_.source.width;
    if (node.kind == PatchNode::ring) {
        const RingSector& sector = tree.sectors[node.index];
        const std::uint32_t local = (c + 4 - sector.corner) % 4;
        sector_limit(sector, ring_access(sector.ring, 0), corner_x(local), corner_y(local), value,
                     du, dv);
        return turn_derivatives(sector.corner, width, scale_of(level), du, dv);
    }
    quad_patch_point(node, corner_x(c), corner_y(c), value, du, dv, nullptr);
    turn_derivatives(0, width, scale_of(level), du, dv);
}

void PatchEvaluator::quad_ring_grid(const QuadCell& cell, const GridOutput& out) {
    const PatchTree& tree = *pieces_.tree;
    const RingSector sector = tree.sectors[tree.nodes[cell.level][cell.face].index];
    const RingShape& shape = tree.rings[sector.ring].shape;
    const std::uint32_t width = pieces_.source.width, r = sector.corner;
    held_ = nothing_held;
    controls_.resize(bicubic_controls(width));
    std::uint32_t i0 = cell.i, j0 = cell.j, n = cell.n;
    int k = 0;
    for (; n > 1; ++k) {
        const RingAccess access = ring_access(sector.ring, k);
        const std::uint32_t half = n / 2;
        for (int quadrant = 1; quadrant < 4; ++quadrant) {
            const int qa = quadrant & 1, qb = quadrant >> 1;
            ring_patch(shape, width, access.rings, access.next, sector.sector, qa, qb,
                       scratch_.data());
            for (int b = 0; b < 4; ++b)
                for (int a = 0; a < 4; ++a) {
                    const Place p = face_place(r, a, b, 3);
                    for (std::uint32_t d = 0; d < width; ++d)
                        controls_[std::size_t(4 * p.j + p.i) * width + d] =
                            scratch_[std::size_t(4 * b + a) * width + d] + access.centre[d];
                }
            const Place at = face_place(r, qa, qb, 1);
            GridOutput part =
                out.at(width, i0 + std::uint32_t(at.i) * half, j0 + std::uint32_t(at.j) * half);
            part.scale = scale_of(cell.level, k + 1);
            bicubic_grid((*tables_)[half], (*tables_)[half], control_points_, width,
                         controls_.data(), part, scratch_.data(), simd_);
        }
        const Place inner = face_place(r, 0, 0, 1);
        i0 += std::uint32_t(inner.i) * half;
        j0 += std::uint32_t(inner.j) * half;
        n = half;
    }
    // One cell is left: its corners.
    const RingAccess access = ring_access(sector.ring, k);
    spare_.resize(2 * std::size_t(width));
    for (std::uint32_t local = 0; local < 4; ++local) {
        const int x = corner_x(local), y = corner_y(local);
        const Place p = face_place(r, x, y, 1);
        const GridOutput to = out.at(width, i0 + std::uint32_t(p.i), j0 + std::uint32_t(p.j));
        if (control_points_) {
            sector_point(sector, access, x, y, to.value);
            continue;
        }
        double* const du = to.du ? to.du : spare_.data();
        double* const dv = to.du ? to.dv : spare_.data() + width;
        sector_limit(sector, access, x, y, to.value, du, dv);
        turn_derivatives(r, width, scale_of(cell.level, local == 0 ? 0 : k), du, dv);
    }
}

void PatchEvaluator::quad_linear_grid(const QuadCell& cell, const GridOutput& out) {
    const std::uint32_t width = pieces_.source.width;
    const Corners corners = corner_values(cell.level, cell.face);
    for (std::uint32_t j = 0; j <= cell.n; ++j)
        for (std::uint32_t i = 0; i <= cell.n; ++i) {
            const GridOutput to = out.at(width, cell.i + i, cell.j + j);
            bilinear(corners, width, double(i) / cell.n, double(j) / cell.n, to.value, to.du,
                     to.dv);
            if (to.du) turn_derivatives(0, width, scale_of(cell.level), to.du, to.dv);
        }
}

void PatchEvaluator::hold_ring_patch(std::uint32_t sector, int k, int qa, int qb) {
    const std::uint64_t held =
        std::uint64_t(PatchNode::ring) << 32 | sector | std::uint64_t(4 * k + 2 * qb + qa) << 40;
    if (held == held_) return;
    const RingSector& of = pieces_.tree->sectors[sector];
    const std::uint32_t width = pieces_.source.width;
    const RingAccess access = ring_access(of.ring, k);
    controls_.resize(bicubic_controls(width));
    ring_patch(pieces_.tree->rings[of.ring].shape, width, access.rings, access.next, of.sector, qa,
               qb, controls_.data());
    held_centre_.assign(access.centre, access.centre + width);
    held_ = held;
}

PointTraits PatchEvaluator::quad_point(const PatchRoot& root, double u, double v, double* value,
                                       double* du, double* dv, const SecondDerivatives* second) {
    const PatchTree& tree = *pieces_.tree;
    const std::uint32_t width = pieces_.source.width;
    std::uint32_t level = root.level, face = root.face;
    root_level_ = level;
    PatchNode node = tree.nodes[level][face];
    while (node.kind == PatchNode::split) {
        const bool right = u > 0.5, up = v > 0.5;
        const std::uint32_t c = up ? (right ? 2 : 3) : (right ? 1 : 0);
        u = 2 * u - (right ? 1 : 0);
        v = 2 * v - (up ? 1 : 0);
        face = pieces_.cage->levels[level].first_child[face] + c;
        node = tree.nodes[++level][face];
    }
    if (node.kind != PatchNode::ring) {
        if (node.kind == PatchNode::linear) {
            const Corners corners = corner_values(level, face);
            bilinear(corners, width, u, v, value, du, dv);
            if (second) bilinear_second(corners, width, *second);
        } else {
            quad_patch_point(node, u, v, value, du, dv, second);
        }
        turn_derivatives(0, width, scale_of(level), du, dv);
        if (second) turn_second(0, width, scale_of(level), *second);
        return {};
    }
    const RingSector sector = tree.sectors[node.index];
    Parameters p = sector_parameters(sector.corner, u, v);
    const int deepest = tree.rings[sector.ring].shape.deepest_level();
    int k = 0;
    for (; k < deepest && std::max(p.a, p.b) <= 0.5; ++k) p.a *= 2, p.b *= 2;
    if (k == deepest || std::max(p.a, p.b) == 0) {
        sector_limit(sector, ring_access(sector.ring, 0), 0, 0, value, du, dv);
        turn_derivatives(sector.corner, width, scale_of(level), du, dv);
        for (std::uint32_t d = 0; second && d < width; ++d)
            second->uu[d] = second->uv[d] = second->vv[d] = 0;
        return {sector.ring, sector.sector};
    }
    const int qa = p.a > 0.5, qb = p.b > 0.5;
    hold_ring_patch(node.index, k, qa, qb);
    bicubic_point(width, controls_.data(), bicubic_weights(2 * p.a - qa),
                  bicubic_weights(2 * p.b - qb), value, du, dv, second);
    for (std::uint32_t d = 0; d < width; ++d) value[d] += held_centre_[d];
    turn_derivatives(sector.corner, width, scale_of(level, k + 1), du, dv);
    if (second) turn_second(sector.corner, width, scale_of(level, k + 1), *second);
    return {};
}

}  // namespace prep::detail
