// Subdivision surfaces: refined meshes, and the limit surface at any point of a cage.
//
// Rules and topology are OpenSubdiv's (Catmull and Clark 1978; Loop 1987; Hoppe et al. 1994 and
// Biermann et al. 2000 for creases and boundaries; DeRose, Kass and Truong 1998 for fractional
// sharpness and Chaikin's averages): the refiner of its Far library decides them. Points are
// evaluated in double, about the mesh's origin, and rounded once; nothing is approximated around
// extraordinary vertices (libprep/src/limit_surface/extraordinary_ring.h says how).
//
// Parameters (u, v) of a cage face are those of OpenSubdiv's Bfr:
//   quads      u along the first edge, v along the last one, both 0 … 1
//   n-gons     (catmark, bilinear) n quads from corner, edge, centre and edge: that of corner i
//              covers [x, x + 0.5] × [y, y + 0.5], where x = i mod d, y = i div d,
//              d = 1 + floor(√(n − 1)); u there runs along the edge that leaves the corner
//   triangles  (loop) u along the first edge, v along the last one, u + v ≤ 1
// Derivatives are by these parameters.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "prep/enum_names.h"
#include "prep/mesh.h"
#include "prep/result.h"
#include "prep/simd.h"

namespace prep {

namespace detail {
struct ChannelSurface;
}

enum class SubdivisionScheme : std::uint8_t { catmark, loop, bilinear };
constexpr auto names_of(SubdivisionScheme) {
    return std::to_array<EnumName<SubdivisionScheme>>({{"catmark", SubdivisionScheme::catmark},
                                                       {"loop", SubdivisionScheme::loop},
                                                       {"bilinear", SubdivisionScheme::bilinear}});
}

// What happens at borders of the cage.
enum class BoundaryRule : std::uint8_t {
    none,             // faces at borders have no limit surface: they are holes
    edge_and_corner,  // borders are creases; corners of one face are sharp
    edge_only,        // borders are creases
};
constexpr auto names_of(BoundaryRule) {
    return std::to_array<EnumName<BoundaryRule>>(
        {{"none", BoundaryRule::none},
         {"edge-and-corner", BoundaryRule::edge_and_corner},
         {"edge-only", BoundaryRule::edge_only}});
}

// Where UVs (and colours) are interpolated linearly rather than smoothly; OpenSubdiv's six rules.
enum class FaceVaryingRule : std::uint8_t {
    none,           // smooth everywhere
    corners_only,   // corners of one face are sharp
    corners_plus1,  // and where more than two regions meet
    corners_plus2,  // and darts and concave corners
    boundaries,     // every boundary of a region is linear
    all,            // everything is
};
constexpr auto names_of(FaceVaryingRule) {
    return std::to_array<EnumName<FaceVaryingRule>>(
        {{"none", FaceVaryingRule::none},
         {"corners-only", FaceVaryingRule::corners_only},
         {"corners-plus1", FaceVaryingRule::corners_plus1},
         {"corners-plus2", FaceVaryingRule::corners_plus2},
         {"boundaries", FaceVaryingRule::boundaries},
         {"all", FaceVaryingRule::all}});
}

enum class CreasingMethod : std::uint8_t { uniform, chaikin };
constexpr auto names_of(CreasingMethod) {
    return std::to_array<EnumName<CreasingMethod>>(
        {{"uniform", CreasingMethod::uniform}, {"chaikin", CreasingMethod::chaikin}});
}

// Above these a cage is refused (limit): its cost would not be bounded by its size.
inline constexpr std::uint32_t max_subdivision_valence = 512;
inline constexpr int max_subdivision_level = 10;

struct SubdivideOptions {
    SubdivisionScheme scheme = SubdivisionScheme::catmark;
    int level = 2;  // 0 … max_subdivision_level
    bool control_points =
        false;  // the refined cage's points instead of points on the limit surface
    std::optional<BoundaryRule> boundary;         // none given: the mesh's tags
    std::optional<FaceVaryingRule> face_varying;  // none given: the mesh's tags
    CreasingMethod creasing = CreasingMethod::uniform;
    bool smooth_triangles = false;  // catmark: other weights in triangles (Stam and Loop 2003)
    // Joints that move a refined vertex; 0: as many sets of four as the cage has. The smallest
    // weights are dropped, the others scaled to the sum that was there.
    int max_influences = 0;
    // Output faces at most; more is an error (limit), before anything is allocated.
    std::uint64_t max_faces = std::uint64_t(1) << 30;
    int threads = 0;  // 0: all cores; the result does not depend on it
    SimdLevel simd = SimdLevel::automatic;
};

// A mesh subdivided `level` times. Every channel of the cage is refined: positions, UV sets,
// colours, skin weights, morph targets' positions, the file's own attributes; faces keep material,
// smoothing group and part of their cage face. `mesh.normals` are the limit normals (none with
// control_points), one per vertex and side of an infinitely sharp crease. Shared points are
// computed once. Tangents, morph targets' normals and tangents are left out: they are computed
// again.
struct SubdividedMesh {
    Mesh mesh;
    std::vector<std::uint32_t> cage_faces;     // per face: the cage's
    std::vector<std::uint32_t> cage_vertices;  // per vertex: the cage's, or no_index
    // Largest share of a vertex' weight that max_influences dropped.
    float largest_dropped_weight = 0;
    std::uint64_t fallback_normals = 0;  // normals where the derivatives do not give one
    std::uint64_t holes = 0;             // cage faces that are left out
    // Sets of which a face has some values, and not all (or one that is not finite): it has none.
    std::uint64_t uv_sets_left_out = 0, color_sets_left_out = 0;
    // The file's own attributes with numbers that are not finite: they would spread to neighbours.
    std::uint64_t attributes_left_out = 0;
    // UV sets, colours and the file's own attributes that were refined with seams for borders,
    // where OpenSubdiv's rules for them would cut the creases into too many faces: values at seams
    // are not OpenSubdiv's where sides of unlike creases depend on each other.
    std::uint64_t approximate_seams = 0;
};

// Errors, with face or vertex: positions that are not finite (invalid), tags out of range
// (invalid), valence or corners above max_subdivision_valence (limit), faces other than triangles
// for loop (unsupported), more output than max_faces or 32-bit indices can hold (limit: the text
// names both numbers).
Result<SubdividedMesh> subdivide(const Mesh& cage, const SubdivideOptions& options = {});

struct SurfaceLocation {
    std::uint32_t face = 0;
    double u = 0, v = 0;
};

struct SurfacePoint {
    glm::dvec3 position{0.0};  // about the mesh's origin
    glm::dvec3 du{0.0}, dv{0.0};
    // Unit. Where the derivatives do not give one (they vanish or are parallel), the mean of limit
    // normals nearby; failing that the cage face's; failing that (0, 0, 1).
    glm::dvec3 normal{0.0, 0.0, 1.0};
    bool has_limit = true;         // false in holes and at borders without a rule: all zero
    bool fallback_normal = false;  // the derivatives do not give it
    // At an extraordinary vertex derivatives by (u, v) are zero or infinite: these are the limit
    // tangents' directions along the face's two edges, scaled as the cage's edges are.
    bool extraordinary = false;
};

// The limit surface of a cage, evaluated anywhere. Holds what it needs; the mesh may go. Options'
// level, max_influences and max_faces are not read.
class LimitSurface {
  public:
    // Errors as those of subdivide.
    static Result<LimitSurface> make(const Mesh& cage, const SubdivideOptions& options = {});
    // The surface of a UV set under options.face_varying: positions are (u, v, 0).
    static Result<LimitSurface> make_uv(const Mesh& cage, std::size_t uv_set,
                                        const SubdivideOptions& options = {});

    std::size_t face_count() const;
    bool has_limit(std::uint32_t face) const;
    // Into points[i] from locations[i]; sizes are equal (asserted), faces in range (asserted).
    // Locations in order of faces are the fast case. Parameters outside the face are clamped.
    void evaluate(std::span<const SurfaceLocation> locations, std::span<SurfacePoint> points) const;

    // Whole grids, the fastest way: each quad of the cage (n-gons: each of its n) at the
    // (rate + 1)² points (i/rate, j/rate), j by j, for rate a power of two up to 1024 (asserted);
    // the triangles of loop at (rate + 1)(rate + 2)/2 points, row by row.
    std::size_t grid_count() const;
    std::uint32_t grid_face(std::size_t grid) const;
    std::size_t grid_size(int rate) const;
    // Derivatives are by the grid's own parameters, 0 … 1. Each output holds `count` · grid_size
    // values for the grids from first_grid on (asserted); du and dv may both be empty.
    struct Grids {
        std::span<glm::dvec3> positions, du, dv;
    };
    void evaluate_grids(int rate, std::size_t first_grid, std::size_t count,
                        const Grids& out) const;

    class Implementation;

  private:
    static LimitSurface of(detail::ChannelSurface&& surface, const Mesh& cage,
                           const SubdivideOptions& options);
    explicit LimitSurface(std::shared_ptr<const Implementation> implementation);
    std::shared_ptr<const Implementation> implementation_;
};

}  // namespace prep
