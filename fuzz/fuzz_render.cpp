// plan() and render() on small hostile meshes, under hostile transforms, seen from anywhere.
#include <cmath>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>

#include "hostile_mesh.h"
#include "prep/prepare.h"
#include "rast/render.h"

namespace {

using fuzz::Bytes;

glm::dmat4 transform_from(Bytes& in) {
    glm::dmat4 m(1.0);
    const std::uint32_t kind = in.below(4);
    if (kind == 1) m[3] = glm::dvec4(fuzz::vector3(in), 1);
    if (kind >= 2)
        for (int column = 0; column < (kind == 2 ? 3 : 4); ++column)
            m[column] = glm::dvec4(fuzz::vector4(in));
    return m;
}

// Rigid and with planes in order, mostly: others are refused.
rast::View view_from(Bytes& in) {
    rast::View view;
    view.perspective = in.below(4) != 0;
    const double near = fuzz::coordinate(in), deep = fuzz::coordinate(in);
    view.half_height = fuzz::coordinate(in);
    if (in.below(8) == 0) {
        view.world_to_view = transform_from(in);
        view.znear = near;
        view.zfar = deep;
        return view;
    }
    const double around = 0.1 * in.take<std::uint8_t>(), up = 0.1 * in.take<std::uint8_t>();
    view.world_to_view = glm::rotate(glm::rotate(glm::dmat4(1), up, glm::dvec3(1, 0, 0)), around,
                                     glm::dvec3(0, 1, 0));
    view.world_to_view[3] = glm::dvec4(fuzz::vector3(in), 1);
    view.znear = view.perspective ? std::abs(near) + 1e-6 : near;
    view.zfar = in.below(2) == 0 ? 0 : view.znear + std::abs(deep);
    view.half_height = std::abs(view.half_height);
    return view;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes in(data, size);
    rast::RenderRequest request;
    request.width = 1 + in.below(70);
    request.height = 1 + in.below(70);
    request.shading = rast::Shading(in.below(4));
    request.cull = rast::Cull(in.below(4));
    request.samples = 1 << in.below(5);
    request.threads = 1;
    request.keep_depth = request.keep_ids = request.keep_normals = request.keep_uvs = true;
    request.keep_barycentrics = request.keep_positions = true;
    if (in.below(2) == 1) {
        request.view = view_from(in);
    }
    prep::Scene scene;
    scene.materials.resize(2);
    scene.materials[1].double_sided = true;
    scene.nodes.resize(1 + in.below(2));
    for (prep::Node& node : scene.nodes) {
        node.mesh = 0;
        node.transform = transform_from(in);
    }
    if (scene.nodes.size() == 2 && in.below(2) == 1) scene.nodes[1].parent = 0;
    scene.meshes.push_back(fuzz::hostile_mesh(in));
    prep::PrepareOptions options;
    options.threads = 1;
    options.request.tangents = prep::Request::Level::always;
    const auto prepared = prep::prepare(std::move(scene), options);
    if (!prepared) return 0;
    const auto plan = rast::plan(*prepared, request);
    if (!plan) return 0;
    const auto frame = rast::render(*prepared, *plan);
    if (!frame) return 0;
    // What a picture promises: its size, finite colours and depths from 0 to 1, every triangle
    // counted.
    if (frame->color.size() != std::size_t(request.width) * request.height) std::abort();
    for (const glm::vec4& c : frame->color)
        if (!std::isfinite(c.x) || !std::isfinite(c.y) || !std::isfinite(c.z) ||
            !std::isfinite(c.w))
            std::abort();
    for (const float d : frame->depth)
        if (!(d >= 0 && d <= 1)) std::abort();
    if (frame->counters.triangles != plan->triangles) std::abort();
    return 0;
}
