// Adaptive tessellation of a displaced surface: triangles as fine as an error asks, closed, with a
// certificate.
//
// The surface is P(p) = S(p) + h(p) n(p). S is the cage's limit surface or, without a scheme, its
// polygons: triangles are plane; other faces are fans about the mean of their corners (faces that
// do not lie around that point are cut into triangles first). n is the unit direction: the limit
// normal or, on polygons, the normalised interpolation of one normal a vertex (of the faces around
// it, by angle). h = scale · (height − midlevel) in units of the mesh, at the UVs of the face's
// corners, interpolated linearly over each triangle of the fan, whose centre has their mean.
//
// Vector maps and noise are moved by as well: P = S + h n + d, and h has the noise at S in it. The
// vector d is (x, y, z) of the map in the mesh's own space, or x T + y B + z n: T and B are the
// tangent and the bitangent of the UVs there, made perpendicular to n and unit
// (docs/displacement.md, vector maps).
//
// A plain triangle starts as one and a quad as two, along the diagonal nearer to the surface, which
// stand for the fan as long as that is near enough. Triangles are halved at their newest vertex
// (libprep/src/tessellation/bisection.h): both sides of
// an edge share its middle, so that the result is as closed as the cage. Where several faces meet,
// there is one position: the mean of the least and the greatest of their heights, along the
// normalised sum of their directions, and the middle of the box around their vectors.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "prep/displacement/sources.h"
#include "prep/hard_edges.h"
#include "prep/image.h"
#include "prep/mesh.h"
#include "prep/result.h"
#include "prep/subdivide.h"

namespace prep {

// A height over the UV plane: continuous, the same for the same UV, safe to call from several
// threads.
class HeightFunction {
  public:
    virtual ~HeightFunction() = default;
    struct Sample {
        double value = 0;
        glm::dvec2 gradient{0.0};  // by UV
    };
    virtual Sample at(const glm::dvec2& uv) const = 0;
    // at(uv).value, the same bits.
    virtual double value(const glm::dvec2& uv) const { return at(uv).value; }
    // An upper bound, over the triangle `uv`, of |height − the linear function that has `values` at
    // its corners|. May be looser where it does not exceed `enough`.
    virtual double deviation(const std::array<glm::dvec2, 3>& uv,
                             const std::array<double, 3>& values, double enough) const = 0;
};

// A height map (sources.h) as read: its own scale and mid-level are applied already, those of a
// Displacement then stay 1 and 0. With `charts`, texels outside the faces of that mesh's UV set are
// not read (docs/displacement.md, gutters); `scheme`: where TessellateOptions has one, as a limit
// surface reads other texels of a concave face than the polygon. Errors: those of a height map.
Result<std::shared_ptr<const HeightFunction>> height_function(
    const Image& image, const HeightMapOptions& options = {}, const Mesh* charts = nullptr,
    std::size_t uv_set = 0, std::optional<SubdivisionScheme> scheme = std::nullopt);

// A height over the mesh's own space, where the surface is before it is displaced; as
// HeightFunction.
class SpaceFunction {
  public:
    virtual ~SpaceFunction() = default;
    struct Sample {
        double value = 0;
        glm::dvec3 gradient{0.0};
    };
    virtual Sample at(const glm::dvec3& p) const = 0;
    // An upper bound, over the plane triangle `p`, of |height − the linear function that has the
    // values at the corners|, which gets small with the square of the triangle's size: triangles
    // are halved where it is too large.
    virtual double deviation(const std::array<glm::dvec3, 3>& p) const = 0;
    virtual double steepest() const = 0;  // no gradient is longer
    // Heights of points so far apart differ by no more; not less for more distance. Of infinity:
    // what all heights span. Bounds are made of it.
    virtual double change(double distance) const { return steepest() * distance; }
};

// Noise (sources.h), with its own scale and mid-level. Errors: invalid options.
Result<std::shared_ptr<const SpaceFunction>> noise_function(const NoiseOptions& options);

// A vector over the UV plane: x, y, z of the mesh's own space, or along the tangent, the bitangent
// and the normal (Displacement::tangent_space); as HeightFunction.
class VectorFunction {
  public:
    virtual ~VectorFunction() = default;
    struct Sample {
        glm::dvec3 value{0.0}, du{0.0}, dv{0.0};
    };
    virtual Sample at(const glm::dvec2& uv) const = 0;
    // Of the length of the difference.
    virtual double deviation(const std::array<glm::dvec2, 3>& uv,
                             const std::array<glm::dvec3, 3>& values, double enough) const = 0;
};

// A vector map, as height_function(); a Displacement by it has `tangent_space` unless its axes are
// those of object space. Errors: also invalid (fewer than three channels).
Result<std::shared_ptr<const VectorFunction>> vector_function(
    const Image& image, const VectorMapOptions& options = {}, const Mesh* charts = nullptr,
    std::size_t uv_set = 0, std::optional<SubdivisionScheme> scheme = std::nullopt);

// P = S + (scale · (height − midlevel) + noise) n + vector, of those that are there.
struct Displacement {
    std::shared_ptr<const HeightFunction> height;
    double scale = 1, midlevel = 0;  // of `height` alone
    std::size_t uv_set = 0;          // of `height` and `vector`
    std::shared_ptr<const SpaceFunction> noise = nullptr;
    std::shared_ptr<const VectorFunction> vector = nullptr;
    bool tangent_space = false;  // `vector` is along tangent, bitangent and normal
};

// What a length is on the screen. A point p (with pixel errors of a mesh: about its origin) is seen
// at (x·p, y·p) / (w·p), with p = (p, 1); w is the depth. The picture is −1 … 1 in both, as far as
// it is no nearer than the near distance.
struct ScreenMetric {
    glm::dvec4 x{1, 0, 0, 0}, y{0, 1, 0, 0}, w{0, 0, 0, 1};
    glm::dvec2 pixels{1.0};  // to a unit of that
    double near_distance = 0.01;
};
// The same of points that `transform` takes to where the metric is of.
ScreenMetric transformed(const ScreenMetric& metric, const glm::dmat4& transform);

struct TessellateOptions {
    std::optional<SubdivisionScheme> scheme;  // none: the polygons themselves
    SubdivideOptions subdivision;             // its scheme and level are not read

    std::vector<Displacement> displacements;
    // Per material its displacement, or no_index; empty: all faces have the first.
    std::vector<std::uint32_t> material_displacements;

    // At least one of these; the first three together: all hold.
    std::optional<double> chord_error;  // distance to the surface, in units of the mesh
    // The same in pixels of all `screens`: between the places of two points of the same parameters
    // one of which is in the picture. What no picture shows stays coarse.
    std::optional<double> pixel_error;
    std::optional<double> edge_length;  // longest edge, beside gaps of seams, in units of the mesh
    // The least error for so many triangles: the worst is halved first. With an error asked for as
    // well: whichever is reached first.
    std::optional<std::uint64_t> max_triangles;
    std::vector<ScreenMetric> screens;  // read with pixel_error: one or more

    bool keep_errors = false;       // TessellatedMesh::errors
    HardEdgeOptions hard_edges;     // of polygons without normals of their own
    std::uint64_t samples = 20000;  // at which the error is measured; 0: it is not
    // More is an error; 2²⁶ take 14 GB.
    std::uint64_t triangle_limit = std::uint64_t(1) << 26;
    int threads = 0;  // 0: all cores; the result does not depend on it
};

// How far the triangles are from the surface. Distances are between points of the same parameters,
// which is never less than the distance to the nearest point.
struct TessellationCertificate {
    std::optional<double> asked;  // chord_error
    // At no point of any triangle more, roundings included; infinite where nothing could be proved.
    double proved = 0;
    double measured = 0;  // the largest of `samples` points
    std::uint64_t samples = 0;
    // `proved` is, triangle by triangle, the sum of what finer triangles make smaller, and of what
    // they do not: positions shared where sides have different heights or directions, and rounding
    // to floats. The largest of each; only the first is refined away.
    double proved_refinable = 0, largest_shared_gap = 0;
    // With pixel_error: asked, and proved as `proved` is; infinite where that reaches the eye.
    std::optional<double> asked_pixels, proved_pixels;
    std::uint32_t worst_triangle = no_index;  // where `proved` is reached
    std::uint32_t worst_face = no_index;      // the cage's
    // Triangles that miss what is asked but cannot be halved: floats or halvings are used up; and
    // those that max_triangles left as they are.
    std::uint64_t unresolved = 0, over_budget = 0;
    std::uint64_t triangles = 0;
    int deepest = 0;  // most halvings of a cage face's triangle
};

struct TessellatedMesh {
    Mesh mesh;  // triangles; normals of the displaced surface, UV sets, colours, groups
    std::vector<std::uint32_t> cage_faces;     // per triangle
    std::vector<std::uint32_t> cage_vertices;  // per vertex: the cage's, or no_index
    // Per triangle what is proved of it, of which certificate.proved is the largest, rounded up to
    // floats; empty unless keep_errors asks for it.
    std::vector<float> errors;
    TessellationCertificate certificate;
    std::uint64_t holes = 0;  // cage faces that are left out
    // Sets of which a face has some values, and not all (or one that is not finite): it has none.
    std::uint64_t uv_sets_left_out = 0, color_sets_left_out = 0;
};

// Errors: nothing asked for, an option that is not a positive number, a pixel error without a
// screen (invalid) or with more than 4096 that can decide (limit); positions or UVs that are not
// finite, faces without the UVs that their displacement reads (invalid, with the face); an error or
// an edge length finer than floats of that size can hold, heights beyond floats (limit); morph
// targets or skins (unsupported: they would not fit the new points); more triangles than
// triangle_limit (limit); those of LimitSurface. An empty mesh gives an empty mesh.
// O(triangles), O(log) times that with max_triangles. Lines and points are left out.
Result<TessellatedMesh> tessellate(const Mesh& cage, const TessellateOptions& options);

}  // namespace prep
