// prepare() with tessellation and residual normal maps, on small hostile meshes: any UVs,
// materials, sources of displacement.
#include <cmath>
#include <cstdlib>

#include "hostile_mesh.h"
#include "prep/prepare.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Bytes in(data, size);
    prep::PrepareOptions options;
    options.threads = 1;
    options.tessellate = true;
    options.subdivide = in.below(2) == 1;
    options.subdivision.scheme =
        in.below(2) ? prep::SubdivisionScheme::catmark : prep::SubdivisionScheme::bilinear;
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
    scene.meshes.push_back(fuzz::hostile_mesh(in));
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
