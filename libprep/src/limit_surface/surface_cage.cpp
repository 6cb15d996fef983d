#include "limit_surface/surface_cage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/finite.h"

namespace prep::detail {
namespace {

std::string place_of(const Mesh& mesh, std::string_view what, std::size_t index) {
    return mesh.name.empty() ? fmt::format("{} {}", what, index)
                             : fmt::format("mesh '{}', {} {}", mesh.name, what, index);
}

// Positions are finite; valences and corners are bounded.
Result<void> check_faces(const Mesh& mesh, SubdivisionScheme scheme) {
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        if (!is_finite(mesh.positions[v]))
            return Error{ErrorCode::invalid,
                         "a position is not finite: no surface can be computed; give the vertex "
                         "coordinates, or take its faces away",
                         place_of(mesh, "vertex", v)};
    std::vector<std::uint32_t> valence(mesh.vertex_count(), 0);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        const std::uint32_t size = end - begin;
        if (scheme == SubdivisionScheme::loop && size != 3)
            return Error{
                ErrorCode::unsupported,
                fmt::format("Loop's scheme subdivides triangles, found a face of {} corners; "
                            "triangulate the mesh or use catmark",
                            size),
                place_of(mesh, "face", f)};
        if (size < 3)
            return Error{ErrorCode::invalid, fmt::format("face {} has fewer than 3 corners", f),
                         place_of(mesh, "face", f)};
        if (size > max_subdivision_valence)
            return Error{ErrorCode::limit,
                         fmt::format("a face of {} corners; subdivision takes at most {}: split it",
                                     size, max_subdivision_valence),
                         place_of(mesh, "face", f)};
        for (std::uint32_t c = begin; c < end; ++c)
            if (++valence[mesh.corner_vertices[c]] > max_subdivision_valence)
                return Error{
                    ErrorCode::limit,
                    fmt::format("a vertex of more than {} faces (the limit of subdivision): "
                                "split the pole",
                                max_subdivision_valence),
                    place_of(mesh, "vertex", mesh.corner_vertices[c])};
    }
    return {};
}

Result<void> check_tags(const Mesh& mesh) {
    const SubdivisionTags& tags = mesh.subdivision;
    const auto bad_sharpness = [](float sharpness) { return !(sharpness >= 0); };
    const auto error = [&](std::string text, std::string_view what, std::size_t k) {
        return Error{ErrorCode::invalid, std::move(text), place_of(mesh, what, k)};
    };
    for (std::size_t k = 0; k < tags.creases.size(); ++k) {
        const EdgeMark& mark = tags.creases[k];
        if (std::max(mark.v0, mark.v1) >= mesh.vertex_count())
            return error(fmt::format("names vertices {} and {}; there are {}", mark.v0, mark.v1,
                                     mesh.vertex_count()),
                         "crease", k);
        if (bad_sharpness(mark.sharpness))
            return error(fmt::format("has sharpness {}; 0 and more is expected", mark.sharpness),
                         "crease", k);
    }
    for (std::size_t k = 0; k < tags.corners.size(); ++k) {
        const VertexMark& mark = tags.corners[k];
        if (mark.vertex >= mesh.vertex_count())
            return error(
                fmt::format("names vertex {}; there are {}", mark.vertex, mesh.vertex_count()),
                "corner", k);
        if (bad_sharpness(mark.sharpness))
            return error(fmt::format("has sharpness {}; 0 and more is expected", mark.sharpness),
                         "corner", k);
    }
    for (std::size_t k = 0; k < tags.holes.size(); ++k)
        if (tags.holes[k] >= mesh.face_count())
            return error(
                fmt::format("names face {}; there are {}", tags.holes[k], mesh.face_count()),
                "hole", k);
    return {};
}

}  // namespace

Result<BoundaryRule> boundary_rule(const Mesh& mesh, const SubdivideOptions& options) {
    if (options.boundary) return *options.boundary;
    const int number = mesh.subdivision.interpolate_boundary;
    if (number < 0 || number > 2)
        return Error{
            ErrorCode::invalid,
            fmt::format("'interpolateboundary' is {}; 0 (none), 1 (edges and corners) or 2 (edges) "
                        "is expected",
                        number),
            mesh.name.empty() ? "" : fmt::format("mesh '{}'", mesh.name)};
    return BoundaryRule(number);
}

Result<FaceVaryingRule> face_varying_rule(const Mesh& mesh, const SubdivideOptions& options) {
    if (options.face_varying) return *options.face_varying;
    const int number = mesh.subdivision.face_varying_boundary;
    if (number < 0 || number > 5)
        return Error{
            ErrorCode::invalid,
            fmt::format("'facevaryinginterpolateboundary' is {}; 0 to 5 is expected", number),
            mesh.name.empty() ? "" : fmt::format("mesh '{}'", mesh.name)};
    return FaceVaryingRule(number);
}

Result<SurfaceCage> position_cage(const Mesh& mesh, const SubdivideOptions& options) {
    if (Result<void> checked = check_faces(mesh, options.scheme); !checked) return checked.error();
    if (Result<void> checked = check_tags(mesh); !checked) return checked.error();
    const Result<BoundaryRule> boundary = boundary_rule(mesh, options);
    if (!boundary) return boundary.error();
    SurfaceCage cage;
    cage.scheme = options.scheme;
    cage.linear = options.scheme == SubdivisionScheme::bilinear;
    cage.boundary = *boundary;
    cage.creasing = options.creasing;
    cage.smooth_triangles = options.smooth_triangles;
    cage.vertex_count = std::uint32_t(mesh.vertex_count());
    cage.face_offsets = mesh.face_offsets;
    cage.corner_vertices = mesh.corner_vertices;
    cage.creases = mesh.subdivision.creases;
    cage.corners = mesh.subdivision.corners;
    cage.holes.assign(mesh.face_count(), 0);
    for (const std::uint32_t face : mesh.subdivision.holes) cage.holes[face] = 1;
    return cage;
}

}  // namespace prep::detail
