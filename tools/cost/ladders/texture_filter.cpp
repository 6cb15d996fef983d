// Texture filters and anisotropy on a floor that runs towards the horizon.
#include <random>

#include "cost/ladders/scenes.h"
#include "cost/measure/flip.h"
#include "cost/oracles/pictures.h"

namespace cost {
namespace {

constexpr std::uint32_t floor_width = 128, floor_height = 96, texels = 128;

// Black and white only: sRGB and linear light agree about those. Blocks of 8, 4 and 2 texels.
TexturedPlane floor_of_blocks() {
    TexturedPlane plane;
    plane.pitch = 24;
    plane.size = texels;
    plane.texels.resize(std::size_t(texels) * texels);
    std::mt19937_64 random(3);
    for (const std::uint32_t block : {8u, 4u, 2u}) {
        for (std::uint32_t y = 0; y < texels; y += block)
            for (std::uint32_t x = 0; x < texels; x += block) {
                if (block < 8 && random() % 3 != 0) continue;
                const double value = double(random() % 2);
                for (std::uint32_t j = 0; j < block; ++j)
                    for (std::uint32_t i = 0; i < block; ++i)
                        plane.texels[std::size_t(y + j) * texels + x + i] = value;
            }
    }
    return plane;
}

prep::Result<prep::PreparedScene> scene_of_floor(const TexturedPlane& plane) {
    // From behind the eye to beyond the top of the picture; UVs are x and z.
    prep::VertexMesh mesh;
    mesh.positions = {{-32, 0, 8}, {32, 0, 8}, {32, 0, -56}, {-32, 0, -56}};
    mesh.uvs = {{{-32, 8}, {32, 8}, {32, -56}, {-32, -56}}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    prep::Material material = plain_white();
    material.diffuse_map.texture = 0;
    prep::PreparedScene scene = scene_of(std::move(mesh), material);
    prep::Image image{texels, texels, 3, {}};
    for (const double t : plane.texels)
        for (int c = 0; c < 3; ++c) image.pixels.push_back(float(t));
    if (auto done = add_texture(scene, image); !done) return done.error();
    return scene;
}

}  // namespace

prep::Result<Ladder> texture_filter_ladder(const Subject& subject) {
    const TexturedPlane plane = floor_of_blocks();
    auto made = scene_of_floor(plane);
    if (!made) return made.error();
    const auto scene = std::make_shared<const prep::PreparedScene>(*std::move(made));
    const auto truth =
        std::make_shared<const Pixels>(textured_plane(plane, floor_width, floor_height));
    const double noise =
        picture_error(textured_plane(plane, floor_width, floor_height, 24), *truth).rmse;
    const auto shown = [](const Pixels& grey) {  // as FLIP takes it
        Pixels out{grey.width, grey.height, 3, {}};
        for (const double v : grey.values) out.values.insert(out.values.end(), {v, v, v});
        return srgb_encoded(out);
    };
    const auto shown_truth = std::make_shared<const Pixels>(shown(*truth));

    Ladder ladder;
    ladder.name = "texture-filter";
    ladder.title = "Texture filters";
    ladder.setting = "pictures: --filter and --max-anisotropy";
    ladder.subject = "a floor of black and white blocks towards the horizon, 128 × 96 pixels";
    ladder.oracle =
        "1,024 samples a pixel and more towards the horizon of the interpolated texture, by a "
        "plain "
        "loop in long double";
    ladder.timed = {"plan", "transform, visibility and shading (one map, no light)",
                    "not: reading the picture, making its levels"};
    ladder.metrics = {{"RMSE", "", "linear light"},
                      {"largest", "", "linear light"},
                      {"PSNR", "dB", "linear light"},
                      {"FLIP", "", "sRGB, mean over the picture"}};
    ladder.floor = noise;
    ladder.floor_text = "what three quarters of the oracle's lines of samples miss of it";
    ladder.reference_is_default = false;
    struct Setting {
        prep::TextureFilter filter;
        int anisotropy = 0;
    };
    using F = prep::TextureFilter;
    const Setting settings[] = {{F::nearest},        {F::bilinear},       {F::nearest_mip},
                                {F::trilinear},      {F::bicubic},        {F::anisotropic, 2},
                                {F::anisotropic, 4}, {F::anisotropic, 8}, {F::anisotropic, 16},
                                {F::ripmap},         {F::ewa, 8},         {F::ewa, 16}};
    for (const Setting& setting : settings) {
        rast::RenderRequest request;
        request.width = floor_width;
        request.height = floor_height;
        request.filter = setting.filter;
        if (setting.anisotropy > 0) request.max_anisotropy = setting.anisotropy;
        request.threads = subject.threads;
        request.view = pitched_view(plane.height, plane.pitch, plane.yfov);
        request.lights = std::vector<rast::LightInstance>{};
        const std::string word(prep::name_of(setting.filter));
        Rung rung;
        rung.name = word;
        rung.command = "render --filter " + word;
        if (setting.anisotropy > 0) {
            rung.name += " " + std::to_string(setting.anisotropy);
            rung.command += " --max-anisotropy " + std::to_string(setting.anisotropy);
        }
        const auto drawing = std::make_shared<Drawing>(scene, request);
        rung.run = [drawing] { return drawing->draw(); };
        rung.judge = [drawing, truth, shown_truth, shown] {
            const Pixels picture = first_channel(drawing->frame());
            const PictureError e = picture_error(picture, *truth);
            return std::vector<double>{e.rmse, e.largest, e.psnr,
                                       flip(*shown_truth, shown(picture)).mean};
        };
        rung.look = [drawing, truth] { return look_of(first_channel(drawing->frame()), *truth); };
        if (setting.filter == F::bicubic)
            rung.because = "it is smoother where textures are magnified; here they are minified";
        else if (setting.filter == F::ewa)
            rung.because = "its Gaussian is wider than the box of a pixel, which is the truth here";
        else if (setting.filter == F::ripmap)
            rung.because =
                "its levels are narrower along u or v only: footprints that lie askew are blurred";
        else if (setting.filter == F::anisotropic)
            rung.because =
                "footprints beyond the first rows are no longer than so many probes reach";
        else if (setting.filter == F::bilinear)
            rung.because = "without levels it reads four texels of the many that a pixel covers";
        if (setting.filter == F::trilinear) ladder.reference = ladder.rungs.size();
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
