// subdivide() and the limit surface on small hostile cages: any topology, tags, options.
#include <cmath>
#include <cstdlib>
#include <vector>

#include "hostile_mesh.h"
#include "prep/subdivide.h"

namespace {

bool unit(const glm::dvec3& n) {
    const double length = glm::length(n);
    return length > 0.999 && length < 1.001;
}

bool finite(const glm::vec2& uv) {
    return std::isfinite(uv.x) && std::isfinite(uv.y);
}

// Pieces of a face that has UVs in all corners have them, and pieces of any other have none.
void require_uvs_where_the_cage_has_them(const prep::Mesh& cage,
                                         const prep::CornerLayer<glm::vec2>& given,
                                         const prep::SubdividedMesh& refined,
                                         const prep::CornerLayer<glm::vec2>& made) {
    const std::vector<std::uint32_t>& offsets = refined.mesh.face_offsets;
    if (made.empty() && refined.uv_sets_left_out == 0 && !given.empty()) {
        // No face that is there has any.
        for (const std::uint32_t face : refined.cage_faces)
            for (std::uint32_t c = cage.face_offsets[face]; c < cage.face_offsets[face + 1]; ++c)
                if (given.indices[c] < given.values.size()) std::abort();
    }
    if (made.empty()) return;
    for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
        const std::uint32_t face = refined.cage_faces[f];
        bool has_uvs = true;
        for (std::uint32_t c = cage.face_offsets[face]; c < cage.face_offsets[face + 1]; ++c)
            has_uvs = has_uvs && given.indices[c] < given.values.size() &&
                      finite(given.values[given.indices[c]]);
        for (std::uint32_t c = offsets[f]; c < offsets[f + 1]; ++c) {
            const std::uint32_t index = made.indices[c];
            if (has_uvs ? index >= made.values.size() : index != prep::no_index) std::abort();
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Bytes in(data, size);
    prep::SubdivideOptions options;
    options.threads = 1;
    options.scheme = prep::SubdivisionScheme(in.below(3));
    options.level = int(in.below(4));
    options.control_points = in.below(2) == 1;
    if (in.below(2)) options.boundary = prep::BoundaryRule(in.below(3));
    if (in.below(2)) options.face_varying = prep::FaceVaryingRule(in.below(6));
    options.creasing = prep::CreasingMethod(in.below(2));
    options.smooth_triangles = in.below(2) == 1;
    options.max_influences = int(in.below(6));
    options.max_faces = 100000;
    const std::uint32_t creases = in.below(8), corners = in.below(4), holes = in.below(3);
    std::vector<prep::EdgeMark> edges;
    std::vector<prep::VertexMark> vertices;
    std::vector<std::uint32_t> faces;
    for (std::uint32_t k = 0; k < creases; ++k) {
        const std::uint32_t v0 = in.below(22), v1 = in.below(22);
        edges.push_back({v0, v1, in.below(4) ? float(in.below(120)) / 10 : in.take<float>()});
    }
    for (std::uint32_t k = 0; k < corners; ++k)
        vertices.push_back(
            {in.below(22), in.below(4) ? float(in.below(120)) / 10 : in.take<float>()});
    for (std::uint32_t k = 0; k < holes; ++k) faces.push_back(in.below(24));
    prep::Mesh mesh =
        fuzz::hostile_mesh(in, options.scheme == prep::SubdivisionScheme::loop && in.below(8) != 0);
    mesh.subdivision.creases = std::move(edges);
    mesh.subdivision.corners = std::move(vertices);
    mesh.subdivision.holes = std::move(faces);

    const auto refined = prep::subdivide(mesh, options);
    if (refined) {
        const prep::Mesh& out = refined->mesh;
        if (refined->cage_faces.size() != out.face_count()) std::abort();
        for (const std::uint32_t v : out.corner_vertices)
            if (v >= out.vertex_count()) std::abort();
        for (const glm::vec3& n : out.normals.values)
            if (!unit(n)) std::abort();
        if (out.uvs.size() != mesh.uvs.size()) std::abort();
        for (std::size_t k = 0; k < out.uvs.size(); ++k)
            require_uvs_where_the_cage_has_them(mesh, mesh.uvs[k], *refined, out.uvs[k]);
        for (const prep::SkinInfluences& set : out.skin_influences)
            for (const glm::vec4& weights : set.weights)
                for (int k = 0; k < 4; ++k)
                    if (!std::isfinite(weights[k])) std::abort();
    }
    const auto surface = prep::LimitSurface::make(mesh, options);
    if (!surface) return 0;
    std::vector<prep::SurfaceLocation> places;
    for (std::uint32_t f = 0; f < surface->face_count(); ++f)
        for (const double u : {0.0, 0.3, 0.5, 1.0})
            for (const double v : {0.0, 1.0 / 512, 0.7}) places.push_back({f, u, v});
    std::vector<prep::SurfacePoint> points(places.size());
    surface->evaluate(places, points);
    for (const prep::SurfacePoint& p : points)
        if (p.has_limit && !unit(p.normal)) std::abort();
    return 0;
}
