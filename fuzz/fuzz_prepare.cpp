// prepare() as a whole, every option of it, on small hostile meshes.
#include <cmath>
#include <cstdlib>

#include "hostile_mesh.h"
#include "invariants.h"
#include "prep/check.h"
#include "prep/prepare.h"

namespace {

using fuzz::Bytes;

template <class T>
T choice(Bytes& in, std::uint32_t count) {
    return T(in.below(count));
}

prep::PrepareOptions options_from(Bytes& in) {
    prep::PrepareOptions o;
    o.threads = 1;
    o.request.tangents = prep::Request::Level::always;
    o.request.normals = prep::Request::Level::always;
    o.normals = choice<prep::Authored>(in, 3);
    o.tangents = choice<prep::Authored>(in, 3);
    o.weld = choice<prep::WeldMode>(in, 3);
    o.normal.weight = choice<prep::NormalWeight>(in, 5);
    o.normal.precision = choice<prep::Precision>(in, 3);
    o.tangent.mode = choice<prep::TangentMode>(in, 2) == prep::TangentMode::mikktspace
                         ? prep::TangentMode::mikktspace
                         : prep::TangentMode::mikktspace_exact;
    static constexpr double angles[] = {0, 30, 45, 60, 90, 120, 180};
    const std::uint32_t angle = in.below(9);
    if (angle < 7)
        o.hard_edges.angle_degrees = angles[angle];
    else if (angle == 7)
        o.hard_edges.angle_degrees = in.take<double>();
    else
        o.hard_edges.angle_degrees.reset();
    const std::uint32_t edges = in.take<std::uint8_t>();
    o.hard_edges.smoothing_groups = edges & 1;
    o.hard_edges.angle_inside_groups = edges & 2;
    o.hard_edges.uv_borders = edges & 4;
    o.hard_edges.material_borders = edges & 8;
    o.hard_edges.marks = edges & 16;
    const std::uint32_t repairs = in.take<std::uint8_t>();
    o.repair.degenerate_faces = repairs & 1;
    o.repair.duplicate_faces = repairs & 2;
    o.repair.non_manifold_edges = repairs & 4;
    o.repair.non_manifold_vertices = repairs & 8;
    o.repair.orientation = repairs & 16;
    o.repair.outward = repairs & 32;
    o.repair.isolated_vertices = repairs & 64;
    if (repairs & 128) o.repair.hole_edges = 3 + in.below(16);
    const std::uint32_t weld = in.below(8);
    if (weld == 1) o.repair.weld_tolerance = 0;
    if (weld == 2) o.repair.weld_tolerance = 0.6;
    if (weld == 3) o.repair.weld_tolerance = in.take<double>();
    return o;
}

bool unit(const glm::vec3& v) {
    const double length = glm::length(glm::dvec3(v));
    return length > 0.999 && length < 1.001;
}

bool direction(const glm::vec3& v) {
    const double length = glm::length(glm::dvec3(v));
    return length > 0 && std::isfinite(length);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes in(data, size);
    const prep::PrepareOptions options = options_from(in);
    prep::Scene scene;
    scene.materials.resize(2);
    scene.meshes.push_back(fuzz::hostile_mesh(in));
    (void)prep::check(scene, {1});
    const auto result = prep::prepare(std::move(scene), options);
    if (!result) return 0;
    if (!test::broken_promise(result->scene).empty()) std::abort();
    // What prepare() promises: unit normals, and tangents that are unit and orthogonal to them
    // where it made them all; the reference's bits have no such promise, and for their sake normals
    // that are kept keep their lengths.
    const prep::VertexMesh& out = result->meshes[0];
    for (const std::uint32_t v : out.indices)
        if (v >= out.vertex_count()) std::abort();
    const bool lengths_kept = options.tangent.mode == prep::TangentMode::mikktspace_exact &&
                              options.normals == prep::Authored::keep;
    for (const glm::vec3& n : out.normals)
        if (lengths_kept ? !direction(n) : !unit(n)) std::abort();
    if (options.tangent.mode != prep::TangentMode::mikktspace) return 0;
    for (const glm::vec4& t : out.tangents)
        if (!unit(glm::vec3(t)) || (t.w != 1 && t.w != -1)) std::abort();
    const bool made =
        options.tangents == prep::Authored::replace && result->requirements[0].tangents.needed;
    if (!made || out.normals.empty()) return 0;
    for (std::size_t v = 0; v < out.tangents.size(); ++v)
        if (std::abs(glm::dot(glm::dvec3(glm::vec3(out.tangents[v])), glm::dvec3(out.normals[v]))) >
            1e-5)
            std::abort();
    return 0;
}
