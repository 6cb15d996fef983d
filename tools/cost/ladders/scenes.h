// Scenes that ladders of pictures draw, and pictures as plain numbers.
#pragma once

#include <memory>

#include "cost/ladders/ladder.h"
#include "cost/measure/metrics.h"
#include "prep/prepared_scene.h"
#include "rast/render.h"

namespace cost {

// One mesh, one material, as preparation would leave them.
prep::PreparedScene scene_of(prep::VertexMesh mesh, const prep::Material& material);
// Adds a picture and a texture of it, the scene's last. Errors: those of writing a PNG.
prep::Result<void> add_texture(prep::PreparedScene& scene, const prep::Image& image,
                               prep::PixelType type = prep::PixelType::u8);
// White whatever the light.
prep::Material plain_white();

// A scene, and how it is drawn but for size and samples.
struct ScenePicture {
    std::shared_ptr<const prep::PreparedScene> scene;
    rast::RenderRequest request;
};
inline constexpr std::uint32_t scene_width = 160, scene_height = 120;

// From +z without perspective, y from −half to half over the picture's height.
rast::View flat_view(double half);
// From (0, height, 0) along −z, `pitch` degrees downwards, without roll.
rast::View pitched_view(double height, double pitch, double yfov);

// The first channel, linear.
Pixels first_channel(const rast::Frame& frame);

// A picture that is drawn again and again.
class Drawing {
  public:
    Drawing(std::shared_ptr<const prep::PreparedScene> scene, const rast::RenderRequest& request)
        : scene_(std::move(scene)), request_(request), renderer_(*scene_) {}
    // The plan is made anew; textures and their levels stay.
    prep::Result<void> draw();
    const rast::Frame& frame() const { return frame_; }

  private:
    std::shared_ptr<const prep::PreparedScene> scene_;
    rast::RenderRequest request_;
    rast::SceneRenderer renderer_;
    rast::Frame frame_;
};

}  // namespace cost
