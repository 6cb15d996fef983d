// prepare() with tessellation and residual normal maps, on small hostile meshes that share
// materials: any UVs, materials, sources of displacement.
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "hostile_mesh.h"
#include "prep/prepare.h"

namespace {

// Two by two texels of grey, which a material moves its faces by.
void add_heights(fuzz::Bytes& in, prep::Scene& scene) {
    prep::ImageRef image;
    image.name = "heights.pgm";
    for (const char c : std::string_view("P5 2 2 255\n")) image.bytes.push_back(std::byte(c));
    for (int k = 0; k < 4; ++k) image.bytes.push_back(std::byte(in.take<std::uint8_t>()));
    scene.images.push_back(std::move(image));
    scene.textures.resize(1);
    scene.textures[0].image = 0;
    prep::Material& material = scene.materials[in.below(2)];
    material.displacement_map = {.texture = 0, .uv_set = std::uint32_t(in.below(2))};
    material.displacement_scale = 0.1F;
}

void add_sharing_mesh(fuzz::Bytes& in, prep::Scene& scene) {
    prep::Mesh mesh = scene.meshes[0];
    switch (in.below(4)) {
        case 0:
            mesh.uvs.clear();
            break;
        case 1:
            mesh.skin_influences.emplace_back();
            break;
        case 2:
            mesh.variant_materials = {0, 1};
            break;
        default:
            break;
    }
    scene.meshes.push_back(std::move(mesh));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Bytes in(data, size);
    prep::PrepareOptions options;
    options.threads = 1;
    options.tessellate = true;
    options.subdivide = in.below(2) == 1;
    options.subdivision.scheme = prep::SubdivisionScheme(in.below(3));
    const bool triangles =
        options.subdivide && options.subdivision.scheme == prep::SubdivisionScheme::loop;
    options.tessellation.samples = 50;
    options.tessellation.triangle_limit = 5000;
    options.tessellation.max_triangles = 10 + in.below(250);
    prep::ResidualMapOptions residual;
    residual.size = in.below(40);
    residual.bits = in.below(8) ? 16 : in.take<std::uint8_t>();
    options.displacement.residual = residual;
    if (in.below(2)) {
        prep::NoiseOptions noise;
        noise.kind = prep::NoiseKind(in.below(2));
        noise.octaves = int(in.below(4));
        noise.frequency = in.below(8) ? 0.5 * in.below(10) : in.take<double>();
        noise.scale = in.below(8) ? 0.1 * in.below(20) : in.take<double>();
        options.displacement.noise = noise;
    }
    prep::Scene scene;
    scene.materials.resize(2);
    scene.materials[1].unlit = in.below(4) == 0;
    if (in.below(4) == 0) scene.materials[1].normal_map.texture = 0;
    scene.meshes.push_back(fuzz::hostile_mesh(in, triangles));
    if (in.below(4) == 1)
        for (auto& set : scene.meshes[0].uvs)
            for (glm::vec2& uv : set.values) uv -= glm::vec2(std::ldexp(1.0F, in.below(21)));
    if (in.below(3) == 1) {
        options.displacement.noise.reset();
        options.displacement.from_materials = true;
        add_heights(in, scene);
    }
    if (in.below(3) == 1) add_sharing_mesh(in, scene);
    const auto made = prep::prepare(std::move(scene), options);
    if (!made) return 0;
    for (const prep::ResidualMap& map : made->residual_maps) {
        const std::uint64_t all = std::uint64_t(map.size) * map.size;
        if (map.size != residual.size || map.bits != residual.bits) std::abort();
        if (map.texels > all || map.overlapping > map.texels || map.facing_away > map.texels)
            std::abort();
        if (!(map.mean_degrees >= 0 && map.mean_degrees <= map.largest_degrees + 1e-9 &&
              map.largest_degrees <= 180.0001))
            std::abort();
        if (map.material >= made->scene.materials.size() || map.image >= made->scene.images.size())
            std::abort();
        if (!made->scene.materials[map.material].normal_map ||
            made->scene.images[map.image].bytes.empty())
            std::abort();
    }
    for (const std::uint32_t m : made->scene.meshes[0].face_materials)
        if (!made->residual_maps.empty() && m != prep::no_index &&
            m >= made->scene.materials.size())
            std::abort();
    return 0;
}
