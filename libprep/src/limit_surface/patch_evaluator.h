// Points of a surface, one at a time and as grids, out of its pieces (patch_tree.h).
// quad_evaluator.cpp has Catmull–Clark's pieces, triangle_evaluator.cpp those of Loop's scheme.
#pragma once

#include <array>
#include <span>
#include <unordered_map>
#include <vector>

#include "limit_surface/bicubic.h"
#include "limit_surface/loop_patch.h"
#include "limit_surface/ring_values.h"

namespace prep::detail {

// Weights for grids of 1, 2, 4, … 2^k cells a side: smooth ones, across creases, of triangles.
class GridTables {
  public:
    // Tables across creases are made for as many sharpnesses, the first ones, as `most_bytes` hold:
    // at k = 10 one takes 0.4 MB.
    static constexpr std::size_t most_crease_bytes = std::size_t(64) << 20;
    GridTables(int log2_most, std::span<const float> sharpnesses, bool triangles,
               std::size_t most_bytes = most_crease_bytes);

    const LoopTable& triangle(std::uint32_t n) const { return triangles_[log2(n)]; }
    const BicubicTable& operator[](std::uint32_t n) const { return smooth_[log2(n)]; }
    // Null where there is none; BicubicTable::make_crease gives the same numbers.
    const BicubicTable* crease(std::uint32_t n, std::uint32_t sharpness, bool reversed) const {
        const std::size_t k = sharpness * smooth_.size() + log2(n);
        return k < creases_.size() ? &(reversed ? reversed_ : creases_)[k] : nullptr;
    }
    int log2_most() const { return int(smooth_.size()) - 1; }

  private:
    static std::size_t log2(std::uint32_t n) {
        std::size_t k = 0;
        while (n > (1U << k)) ++k;
        return k;
    }
    std::vector<BicubicTable> smooth_, creases_, reversed_;
    std::vector<LoopTable> triangles_;
};

// Which pieces a surface has, and its values.
struct SurfacePieces {
    const RefinedCage* cage = nullptr;
    const PatchTree* tree = nullptr;
    ControlSource source;
    // None: rings are refined where they are met, and those of many sectors kept for the others.
    const RingValues* rings = nullptr;
};

// Rings of so many sectors are worth keeping for the roots that share them.
inline constexpr std::uint32_t many_sectors = 32;

struct PointTraits {
    std::uint32_t ring = no_index;  // the point is this ring's vertex, …
    std::uint32_t sector = 0;       // … seen from this sector
};

// Values stay as they are while it lives.
class PatchEvaluator {
  public:
    // Rings that are not stored are refined here; those of many sectors stay while all of their
    // levels are `most_kept_numbers` at most (64 MB).
    PatchEvaluator(const SurfacePieces& pieces, SimdLevel simd,
                   std::size_t most_kept_numbers = std::size_t(1) << 23)
        : pieces_(pieces), simd_(simd), most_kept_numbers_(most_kept_numbers) {}

    // The root's (n + 1)² points or, with `control_points`, vertices of the cage refined log2 n
    // times; derivatives (null, or with points on the surface) by the root's parameters, 0 … 1.
    // n is a power of two within the tables. Triangles: (n + 1)(n + 2)/2 points, row by row;
    // `stride` does not matter.
    void grid(std::uint32_t root, std::uint32_t n, bool control_points, const GridTables& tables,
              const GridOutput& out);

    // u, v in 0 … 1. Derivatives by the root's parameters. `second` may be null; at a ring's vertex
    // they are none, and 0. Of quads, points that follow each other in one piece take much less
    // time than others.
    PointTraits point(std::uint32_t root, double u, double v, double* value, double* du, double* dv,
                      const SecondDerivatives* second = nullptr);

    // Of rings: what is held now, and the points that were gathered so far.
    std::size_t held_ring_numbers() const;
    std::uint64_t gathered_ring_points() const { return gathered_points_; }

  private:
    using Corners = std::array<const double*, 4>;  // a triangle's first three
    Corners corner_values(std::uint32_t level, std::uint32_t face) const;
    // The rings of a sector's vertex: numbers of level k and of the next one, and value, t0, t1.
    struct RingAccess {
        const double *rings, *next, *centre;
    };
    RingAccess ring_access(std::uint32_t ring, int k);
    // At the point (x, y) of a sector, 0 ≤ x, y ≤ 1: the limit and its derivatives by the sector's
    // (a, b), of the scale of the level accessed, at the vertex of that of level 0; or the vertex
    // of the refined cage.
    void sector_limit(const RingSector& sector, const RingAccess& access, int x, int y,
                      double* value, double* da, double* db) const;
    void sector_point(const RingSector& sector, const RingAccess& access, int x, int y,
                      double* value) const;

    struct QuadCell {  // of a grid: a node and the part that it covers
        std::uint32_t level, face, i, j, n;
    };
    double scale_of(std::uint32_t level, int deeper = 0) const;  // of derivatives
    void quad_cell(const QuadCell& cell, const GridOutput& out);
    void quad_patch_grid(const PatchNode& node, const QuadCell& cell, const GridOutput& out);
    void quad_ring_grid(const QuadCell& cell, const GridOutput& out);
    void quad_linear_grid(const QuadCell& cell, const GridOutput& out);
    void quad_corners(const QuadCell& cell, const GridOutput& out);
    // The limit at corner c of a node.
    void quad_corner(std::uint32_t level, std::uint32_t face, std::uint32_t c, double* value,
                     double* du, double* dv);
    PointTraits quad_point(const PatchRoot& root, double u, double v, double* value, double* du,
                           double* dv, const SecondDerivatives* second);
    void quad_patch_point(const PatchNode& node, double u, double v, double* value, double* du,
                          double* dv, const SecondDerivatives* second);
    void gather_quad(const RegularPatch& patch);
    // Control points of a patch of a ring's sector, relative to its centre, which is kept with
    // them.
    void hold_ring_patch(std::uint32_t sector, int k, int qa, int qb);
    // Stored, or made where there are too many.
    const BicubicTable& crease_table(const CreasePatch& crease, std::uint32_t n);

    struct TriangleCell;
    void triangle_cell(const TriangleCell& cell, const GridOutput& out);
    void triangle_patch_grid(const TriangleCell& cell, const GridOutput& out);
    void triangle_ring_grid(const TriangleCell& cell, const GridOutput& out);
    GridOutput triangle_at(const GridOutput& out, int x, int y) const;
    void triangle_grid(const PatchRoot& root, std::uint32_t n, const GridOutput& out);
    // Derivatives by the parameters of that face.
    PointTraits triangle_point(std::uint32_t level, std::uint32_t face, double u, double v,
                               double* value, double* du, double* dv,
                               const SecondDerivatives* second);
    void triangle_patch_point(double u, double v, double* value, double* du, double* dv,
                              const SecondDerivatives* second) const;
    void gather_triangle(const TrianglePatch& patch);
    void gather_triangle_ring(const RingSector& sector, const RingAccess& access, int part);

    SurfacePieces pieces_;
    SimdLevel simd_;
    const GridTables* tables_ = nullptr;
    bool control_points_ = false;
    std::uint32_t root_level_ = 0;
    std::size_t triangle_n_ = 1;
    std::vector<double> controls_, scratch_, spare_;
    // Whose control points point() left there; none where something else is.
    static constexpr std::uint64_t nothing_held = ~std::uint64_t(0);
    std::uint64_t held_ = nothing_held;
    std::vector<double> held_centre_;
    BicubicTable own_crease_;
    struct WalkedRing {
        std::uint32_t ring = no_index;
        RingLevels levels;
        std::vector<double> centre;  // where none is stored
    };
    // One whose level k can be had.
    WalkedRing& walked_ring(std::uint32_t ring, int k);
    WalkedRing walked_;  // the one met last
    std::unordered_map<std::uint32_t, WalkedRing> kept_;
    int kept_levels_ = 0;  // that grids ask for, with the one after
    std::size_t most_kept_numbers_, kept_numbers_ = 0;
    std::uint64_t gathered_points_ = 0;
};

}  // namespace prep::detail
