#include "cost/ladders/scenes.h"

#include <cmath>
#include <numbers>

namespace cost {

prep::PreparedScene scene_of(prep::VertexMesh mesh, const prep::Material& material) {
    prep::PreparedScene out;
    mesh.ranges = {{0, std::uint32_t(mesh.triangle_count()), 0, prep::no_index}};
    out.scene.meshes.emplace_back();
    out.scene.materials.push_back(material);
    prep::Node node;
    node.mesh = 0;
    out.scene.nodes.push_back(node);
    out.meshes.push_back(std::move(mesh));
    return out;
}

prep::Result<void> add_texture(prep::PreparedScene& scene, const prep::Image& image,
                               prep::PixelType type) {
    auto png = prep::encode_png(image, type);
    if (!png) return png.error();
    prep::ImageRef ref;
    ref.name = "picture";
    ref.bytes = *std::move(png);
    ref.mime_type = "image/png";
    prep::Texture texture;
    texture.image = std::uint32_t(scene.scene.images.size());
    scene.scene.images.push_back(std::move(ref));
    scene.scene.textures.push_back(texture);
    return {};
}

prep::Material plain_white() {
    prep::Material white;
    white.diffuse = glm::vec4(1);
    white.unlit = true;
    white.double_sided = true;
    return white;
}

rast::View flat_view(double half) {
    rast::View view;
    view.perspective = false;
    view.half_height = half;
    view.znear = 0;
    view.zfar = 100;
    view.world_to_view[3] = glm::dvec4(0, 0, -50, 1);
    return view;
}

rast::View pitched_view(double height, double pitch, double yfov) {
    const double a = pitch * std::numbers::pi / 180;
    const glm::dvec3 right(1, 0, 0), up(0, std::cos(a), -std::sin(a)),
        back(0, std::sin(a), std::cos(a));
    const glm::dmat3 rotation = glm::transpose(glm::dmat3(right, up, back));
    rast::View view;
    view.yfov = yfov;
    view.znear = 0.01;
    view.world_to_view = glm::dmat4(rotation);
    view.world_to_view[3] = glm::dvec4(-(rotation * glm::dvec3(0, height, 0)), 1.0);
    return view;
}

Pixels first_channel(const rast::Frame& frame) {
    Pixels out{frame.width, frame.height, 1, {}};
    out.values.reserve(frame.color.size());
    for (const glm::vec4& c : frame.color) out.values.push_back(double(c.x));
    return out;
}

prep::Result<void> Drawing::draw() {
    const prep::Result<rast::RenderPlan> plan = rast::plan(*scene_, request_);
    if (!plan) return plan.error();
    return renderer_.render(*plan, frame_);
}

}  // namespace cost
