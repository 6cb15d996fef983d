// Halves triangles until what was asked for holds, or a budget is used up.
//
// Rounds: the bounds of all new triangles on all threads, then the halvings on one, in the order of
// BisectionMesh::Touched (for a budget: of excess). So nothing depends on the number of threads.
// What an error asks for does not depend on the order either: it is the coarsest mesh of its kind
// where all triangles comply.
#pragma once

#include <span>
#include <vector>

#include "prep/result.h"
#include "tessellation/displaced_surface.h"
#include "tessellation/screen_bound.h"

namespace prep::detail {

class Refinement {
  public:
    // All must outlive it.
    Refinement(const Mesh& cage, const Domain& domain, const DisplacedSurface& surface,
               const TessellateOptions& options);

    // Errors: limit, as tessellate's.
    Result<void> run();

    const BisectionMesh& mesh() const { return mesh_; }
    const VertexSamples& samples() const { return samples_; }
    // Per triangle.
    std::span<const TriangleBound> bounds() const { return bounds_; }
    std::uint64_t unresolved() const { return unresolved_; }
    std::uint64_t over_budget() const { return over_budget_; }
    // What is proved of a triangle on the screens.
    double proved_pixels(std::uint32_t t) const;

  private:
    using Touched = BisectionMesh::Touched;
    void make_cage_vertices();
    std::vector<Nearer> nearer_diagonals() const;
    void start();
    void make_new_vertices();
    // Looking: bounds are left out where something cheaper decides, or nothing depends on them, and
    // are no tighter than a decision takes. Proving: as tight as may be where what is asked for, or
    // without an error the largest that is there, is exceeded.
    enum class Effort : std::uint8_t { looking, proving };
    void measure(std::span<const Touched> fresh, Effort effort);
    void fetch_ahead(std::span<const Touched> fresh, std::size_t k) const;
    void fetch_rings_ahead(std::size_t k) const;
    void look(std::span<const Touched> fresh);
    void prove(std::uint32_t t, const Asked& asked);
    double longest_edge(std::uint32_t t) const;
    bool has_long_edge(std::uint32_t t) const;
    // Is an edge longer than asked, whatever makes it so?
    bool stays_long(std::uint32_t t) const;
    bool surely_misses(std::uint32_t t, const glm::dvec3& middle) const;
    bool is_shared(const BisectedTriangle& triangle) const;
    float excess(std::uint32_t t) const;
    Asked asked(const BisectedTriangle& triangle) const;
    Asked worth_proving(std::uint32_t t) const;
    double largest_point_error() const;  // in the middles of edges that would be halved
    std::array<glm::dvec3, 3> corners(const BisectedTriangle& triangle) const;
    bool can_be_halved(std::uint32_t t) const;
    glm::dvec3 middle_position(std::uint32_t t) const;
    Result<void> take_news();
    Result<void> refine_to_error();
    Result<void> refine_to_budget();
    Error too_many() const;
    // Of the first triangles. Errors: limit (more screens than can be looked at for every triangle;
    // fewer pixels than floats hold).
    Result<void> focus_screens();
    Result<void> check_pixels() const;
    // Of vertices from `first` on.
    Result<void> check_range(std::uint32_t first) const;

    const Mesh& cage_;
    const Domain& domain_;
    const DisplacedSurface& surface_;
    const TessellateOptions& options_;
    Screens screens_;
    BisectionMesh mesh_;
    VertexSamples samples_;
    LargeVector<TriangleBound> bounds_;
    LargeVector<float> excess_;
    LargeVector<Touched> fresh_;          // what the last halvings touched
    LargeVector<std::uint8_t> to_halve_;  // those of them that exceed what was asked
    double largest_coordinate_ = 0;
    double largest_seen_ = 0;  // error of a point, where edges alone are asked for; else 0
    std::uint64_t unresolved_ = 0, over_budget_ = 0;
};

}  // namespace prep::detail
