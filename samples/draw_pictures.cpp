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
#include "sheets/surfaces/curvature.h"

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

// A small tower of quads with edges of a sharpness around its top and foot. No level: the cage.
prep::PreparedScene tower(float sharpness, std::optional<int> level) {
    prep::Mesh mesh;
    mesh.name = "tower";
    const float half[] = {1, 1, 0.6F, 0.6F}, height[] = {0, 0.7F, 0.7F, 1.6F};
    for (std::uint32_t ring = 0; ring < 4; ++ring)
        for (const glm::vec2 side : {glm::vec2(-1, 1), {1, 1}, {1, -1}, {-1, -1}})
            mesh.positions.emplace_back(half[ring] * side.x, height[ring], half[ring] * side.y);
    const auto add = [&mesh](std::initializer_list<std::uint32_t> face) {
        mesh.corner_vertices.insert(mesh.corner_vertices.end(), face);
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    };
    for (std::uint32_t ring = 0; ring < 3; ++ring)
        for (std::uint32_t i = 0; i < 4; ++i) {
            const std::uint32_t a = 4 * ring + i, b = 4 * ring + (i + 1) % 4;
            add({a, b, b + 4, a + 4});
        }
    add({12, 13, 14, 15});
    add({3, 2, 1, 0});
    for (std::uint32_t i = 0; i < 4 && sharpness > 0; ++i)
        for (const std::uint32_t ring : {0U, 12U})
            mesh.subdivision.creases.push_back({ring + i, ring + (i + 1) % 4, sharpness});
    prep::Scene scene;
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    prep::PrepareOptions options;
    options.subdivide = level.has_value();
    options.subdivision.level = level.value_or(0);
    options.hard_edges.angle_degrees = 10;
    return take(prep::prepare(std::move(scene), options));
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

    // A cage, its points on the surface at level 1, the surface, creased, its curvature.
    const prep::PreparedScene cage = tower(0, {});
    shot.width = shot.height = 200;
    shot.orbit = close_up(cage, 30, 28, 0.98);
    prep::PreparedScene creased = tower(2, 5);
    std::vector<prep::Image> surfaces{
        draw(cage, Shading::flat, shot), draw(tower(0, 1), Shading::flat, shot),
        draw(tower(0, 5), Shading::phong, shot), draw(creased, Shading::phong, shot),
        draw(tower(10, 5), Shading::phong, shot)};
    report::color_by_curvature(creased);
    surfaces.push_back(draw(creased, Shading::phong, shot));
    save(out / "subdivision.png", strip(surfaces));
    shot.width = 450;
    shot.height = 300;

    const prep::PreparedScene octopus = prepared(samples / "octopus/octopus.ply");
    shot.orbit = close_up(octopus, 20, 24, 0.66);
    shot.orbit->aspect = 1.5;
    const prep::PreparedScene room = prepared(samples / "room/room.gltf");
    Shot from_camera;
    from_camera.width = 450;
    save(out / "samples.png", strip({draw(octopus, Shading::phong, shot),
                                     draw(room, Shading::normal_mapped, from_camera)}));
}
