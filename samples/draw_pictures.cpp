// Draws the documentation's pictures from the samples: draw_pictures SAMPLES-DIR OUT-DIR.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "prep/image.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "rast/render.h"

namespace {

constexpr std::uint32_t supersampling = 3;  // a side; box-filtered in linear light

[[noreturn]] void fail(const prep::Error& error) {
    std::fprintf(stderr, "draw_pictures: %s\n", prep::to_string(error).c_str());
    std::exit(1);
}

template <class T>
T take(prep::Result<T> result) {
    if (!result) fail(result.error());
    return std::move(*result);
}

prep::PreparedScene prepared(const std::filesystem::path& file,
                             const prep::PrepareOptions& options = {}) {
    return take(prep::prepare(take(prep::load_scene(file)), options));
}

rast::Frame smaller(const rast::Frame& large) {
    rast::Frame small;
    small.width = large.width / supersampling;
    small.height = large.height / supersampling;
    small.color.assign(std::size_t(small.width) * small.height, glm::vec4(0.0f));
    for (std::uint32_t y = 0; y < small.height * supersampling; ++y)
        for (std::uint32_t x = 0; x < small.width * supersampling; ++x)
            small.color[std::size_t(y / supersampling) * small.width + x / supersampling] +=
                glm::min(large.color[std::size_t(y) * large.width + x], glm::vec4(1.0f)) /
                float(supersampling * supersampling);
    return small;
}

struct Shot {
    std::uint32_t width = 300, height = 300;
    std::optional<rast::OrbitOptions> orbit;  // none: the scene's camera
};

prep::Image draw(const prep::PreparedScene& scene, rast::Shading shading, const Shot& shot) {
    rast::RenderRequest request;
    request.width = shot.width * supersampling;
    request.height = shot.height * supersampling;
    request.shading = shading;
    request.background = glm::vec3(0.07f, 0.08f, 0.10f);
    if (shot.orbit) request.view = rast::orbit_view(scene, *shot.orbit);
    const rast::RenderPlan plan = take(rast::plan(scene, request));
    return rast::to_srgb(smaller(take(rast::render(scene, plan))));
}

// Side by side, a few white pixels between.
prep::Image strip(const std::vector<prep::Image>& pictures) {
    constexpr std::uint32_t gap = 4;
    prep::Image all;
    all.channels = 3;
    all.srgb = true;
    all.height = pictures[0].height;
    for (const prep::Image& picture : pictures) all.width += picture.width + (all.width ? gap : 0);
    for (std::uint32_t y = 0; y < all.height; ++y)
        for (std::size_t k = 0; k < pictures.size(); ++k) {
            if (k) all.pixels.insert(all.pixels.end(), gap * 3, 1.0f);
            const float* row = pictures[k].at(0, y);
            all.pixels.insert(all.pixels.end(), row, row + pictures[k].width * 3);
        }
    return all;
}

void save(const std::filesystem::path& path, const prep::Image& image) {
    const auto saved = prep::save_image(path, image);
    if (!saved) fail(saved.error());
    std::printf("%s: %u x %u\n", path.c_str(), image.width, image.height);
}

rast::OrbitOptions close_up(const prep::PreparedScene& scene, double azimuth, double elevation,
                            double nearer) {
    rast::OrbitOptions orbit;
    orbit.azimuth_degrees = azimuth;
    orbit.elevation_degrees = elevation;
    orbit.aspect = 1;
    const auto bounds = rast::world_bounds(scene);
    // The bounding sphere is larger than the thing: come closer than it asks for.
    if (bounds) orbit.distance = bounds->radius() / std::sin(orbit.yfov / 2) * nearer;
    return orbit;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: draw_pictures SAMPLES-DIR OUT-DIR\n");
        return 2;
    }
    const std::filesystem::path samples = argv[1], out = argv[2];
    std::filesystem::create_directories(out);
    using rast::Shading;

    const prep::PreparedScene shield = prepared(samples / "shield/shield.gltf");
    Shot shot;
    shot.orbit = close_up(shield, 30, 16, 0.82);
    std::vector<prep::Image> shadings;
    for (const Shading shading :
         {Shading::flat, Shading::gouraud, Shading::phong, Shading::normal_mapped})
        shadings.push_back(draw(shield, shading, shot));
    save(out / "shadings.png", strip(shadings));

    // The machine part with every edge smooth, as tools do that drop smoothing groups, and
    // prepared.
    const auto part = samples / "machine_part/machine_part.obj";
    prep::PrepareOptions pillow;
    pillow.hard_edges.smoothing_groups = false;
    pillow.hard_edges.angle_degrees.reset();
    const prep::PreparedScene smooth = prepared(part, pillow), obeyed = prepared(part);
    shot.width = 450;
    shot.height = 300;
    shot.orbit = close_up(obeyed, 25, 35, 0.62);
    shot.orbit->aspect = 1.5;
    save(out / "hard_edges.png",
         strip({draw(smooth, Shading::phong, shot), draw(obeyed, Shading::phong, shot)}));

    const prep::PreparedScene octopus = prepared(samples / "octopus/octopus.ply");
    shot.orbit = close_up(octopus, 20, 24, 0.66);
    shot.orbit->aspect = 1.5;
    const prep::PreparedScene room = prepared(samples / "room/room.gltf");
    Shot from_camera;
    from_camera.width = 450;
    save(out / "samples.png", strip({draw(octopus, Shading::phong, shot),
                                     draw(room, Shading::normal_mapped, from_camera)}));
}
