#include "torus_scene.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "torus.h"

namespace bench {
namespace {

float hashed(std::uint32_t x, std::uint32_t y) {
    std::uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u;
    h = (h ^ h >> 15) * 0x2C1B3C6Du;
    h = (h ^ h >> 12) * 0x297A2D39u;
    return float((h ^ h >> 15) >> 8) / float(1 << 24);
}

prep::Image empty_image(bool srgb) {
    prep::Image image;
    image.width = image.height = 1024;
    image.channels = 3;
    image.srgb = srgb;
    image.pixels.resize(std::size_t(image.width) * image.height * 3);
    return image;
}

}  // namespace

prep::Image diffuse_image() {
    prep::Image image = empty_image(true);
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const bool light = ((x / 64) + (y / 64)) % 2 == 0;
            float* p = &image.pixels[(std::size_t(y) * image.width + x) * 3];
            for (int c = 0; c < 3; ++c)
                p[c] = std::floor((light ? 170.0f - 20.0f * float(c) : 90.0f + 25.0f * float(c)) +
                                  60.0f * hashed(x / 4, y / 4)) /
                       255.0f;
        }
    return image;
}

prep::Image normal_image() {
    prep::Image image = empty_image(false);
    constexpr float turn = 6.2831853f / 64;
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const glm::vec3 n = glm::normalize(glm::vec3(0.4f * std::cos(turn * float(x)),
                                                         0.4f * std::cos(turn * float(y)), 1.0f));
            for (int c = 0; c < 3; ++c)
                image.pixels[(std::size_t(y) * image.width + x) * 3 + std::size_t(c)] =
                    std::floor((n[c] * 0.5f + 0.5f) * 255.0f + 0.5f) / 255.0f;
        }
    return image;
}

prep::PreparedScene torus_scene(std::uint64_t triangles, const prep::Image& diffuse,
                                const prep::Image& normals) {
    prep::Scene scene;
    scene.meshes.push_back(bumpy_torus(torus_size(triangles)));
    scene.meshes[0].face_materials.assign(scene.meshes[0].face_count(), 0);
    for (const prep::Image* image : {&diffuse, &normals}) {
        prep::ImageRef ref;
        ref.name = "made here.png";
        auto png = prep::encode_png(*image);
        if (!png) {
            std::fprintf(stderr, "%s\n", prep::to_string(png.error()).c_str());
            std::exit(1);
        }
        ref.bytes = *std::move(png);
        scene.images.push_back(std::move(ref));
        prep::Texture texture;
        texture.image = std::uint32_t(scene.textures.size());
        scene.textures.push_back(texture);
    }
    prep::Material material;
    material.diffuse = {0.8f, 0.75f, 0.7f, 1.0f};
    material.specular = glm::vec3(0.25f);
    material.shininess = 40;
    material.diffuse_map.texture = 0;
    material.normal_map.texture = 1;
    scene.materials.push_back(material);
    prep::Node node;
    node.mesh = 0;
    scene.nodes.push_back(node);
    auto prepared = prep::prepare(std::move(scene));
    if (!prepared) {
        std::fprintf(stderr, "%s\n", prep::to_string(prepared.error()).c_str());
        std::exit(1);
    }
    return std::move(*prepared);
}

rast::RenderRequest torus_request(const prep::PreparedScene& scene, bool mapped) {
    rast::RenderRequest request;
    request.width = width;
    request.height = height;
    rast::OrbitOptions orbit;
    // Fills the picture a little beyond its top and bottom.
    orbit.elevation_degrees = 65;
    orbit.distance = 4.15;
    orbit.aspect = double(width) / height;
    request.view = rast::orbit_view(scene, orbit);
    request.shading = mapped ? rast::Shading::normal_mapped : rast::Shading::phong;
    request.textures = mapped;
    request.cull = rast::Cull::back;
    request.pixels = rast::PixelFormat::bytes;
    rast::LightInstance sun, ambient;
    sun.direction = glm::normalize(glm::dvec3(-0.4, -0.8, -0.45));
    sun.color = glm::vec3(0.7f);
    ambient.kind = prep::LightKind::ambient;
    ambient.color = glm::vec3(0.1f);
    request.lights = std::vector<rast::LightInstance>{sun, ambient};
    return request;
}

}  // namespace bench
