// Which mip levels pixels read, and how these are mixed: pictures of a triangle in strong
// perspective, against the definitions of Vulkan 1.3 (15.6 "Texel Input Coordinate Systems" and
// "LOD operation") and OpenGL ES 3.2 (8.14) in double, on every instruction set. Footprints come
// from the projection itself.
#include <array>
#include <cmath>
#include <random>

#include "reference_shading.h"

namespace {

using namespace test;
using prep::Filter;
using prep::MipFilter;
using rast::TextureFilter;

constexpr std::uint32_t width = 76, height = 58;
constexpr double tangent = 0.5;  // of half the field of view

// Corners on whole pixels, so that nothing is moved, at these distances.
struct Corner {
    double x, y, distance;
    glm::dvec2 uv;
};
constexpr std::uint32_t texels_u = 64, texels_v = 32;
using Corners = std::array<Corner, 3>;
constexpr Corners before_the_eye = {
    {{4, 6, 60, {0.125, 0.25}}, {-32, 150, 1, {3.5, 2.75}}, {170, 20, 1, {7.25, -9.5}}}};
// A corner behind the eye, whose place on the screen is the one it is projected to through the eye:
// the near plane cuts the triangle, which fills the picture but for its upper left.
constexpr Corners through_the_eye = {
    {{4, 6, 60, {0.125, 0.25}}, {60, -90, -1.5, {3.5, -2.75}}, {170, 20, 1, {7.25, -9.5}}}};

// UVs times `stretch`.
glm::dvec2 uv_at(const Corners& corners, double x, double y, double stretch) {
    const auto area = [&](const Corner& a, const Corner& b, double px, double py) {
        return (b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x);
    };
    glm::dvec2 sum(0.0);
    double total = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double share =
            area(corners[(k + 1) % 3], corners[(k + 2) % 3], x, y) / corners[k].distance;
        sum += corners[k].uv * share;
        total += share;
    }
    return sum / total * stretch;
}

double level_of_detail(const Corners& corners, double x, double y, double stretch) {
    constexpr double h = 1e-4;
    const glm::dvec2 size(texels_u, texels_v);
    const glm::dvec2 right =
        (uv_at(corners, x + h, y, stretch) - uv_at(corners, x - h, y, stretch)) / (2 * h) * size;
    const glm::dvec2 down =
        (uv_at(corners, x, y + h, stretch) - uv_at(corners, x, y - h, stretch)) / (2 * h) * size;
    return std::log2(std::max(glm::length(right), glm::length(down)));
}

// The pyramid: linear light, each level's texels the means of four of the one before.
struct Level {
    std::int64_t width = 0, height = 0;
    std::vector<glm::dvec3> texels;
    glm::dvec3 at(std::int64_t x, std::int64_t y) const {
        const auto wrapped = [](std::int64_t i, std::int64_t n) { return ((i % n) + n) % n; };
        return texels[std::size_t(wrapped(y, height) * width + wrapped(x, width))];
    }
    // Nothing where rounding decides.
    std::optional<glm::dvec3> nearest(const glm::dvec2& uv) const {
        const glm::dvec2 p = uv * glm::dvec2(width, height);
        if (glm::any(glm::lessThan(glm::abs(p - glm::round(p)), glm::dvec2(2e-3))))
            return std::nullopt;
        return at(std::int64_t(std::floor(p.x)), std::int64_t(std::floor(p.y)));
    }
    glm::dvec3 bilinear(const glm::dvec2& uv) const {
        const glm::dvec2 p = uv * glm::dvec2(width, height) - 0.5, below = glm::floor(p),
                         part = p - below;
        const std::int64_t x = std::int64_t(below.x), y = std::int64_t(below.y);
        return glm::mix(glm::mix(at(x, y), at(x + 1, y), part.x),
                        glm::mix(at(x, y + 1), at(x + 1, y + 1), part.x), part.y);
    }
};
std::vector<Level> pyramid_of(const prep::Image& image) {
    std::vector<Level> levels(1);
    levels[0].width = image.width;
    levels[0].height = image.height;
    for (std::size_t i = 0; i < image.pixels.size(); i += 3)
        levels[0].texels.push_back(
            decoded_srgb(glm::dvec3(image.pixels[i], image.pixels[i + 1], image.pixels[i + 2])));
    while (levels.back().width > 1 || levels.back().height > 1) {
        const Level fine = levels.back();
        Level coarse;
        coarse.width = std::max<std::int64_t>(1, fine.width / 2);
        coarse.height = std::max<std::int64_t>(1, fine.height / 2);
        for (std::int64_t y = 0; y < coarse.height; ++y)
            for (std::int64_t x = 0; x < coarse.width; ++x)
                coarse.texels.push_back((fine.at(2 * x, 2 * y) + fine.at(2 * x + 1, 2 * y) +
                                         fine.at(2 * x, 2 * y + 1) +
                                         fine.at(2 * x + 1, 2 * y + 1)) /
                                        4.0);
        levels.push_back(std::move(coarse));
    }
    return levels;
}

prep::Image noise() {
    std::mt19937 random(17);
    prep::Image image{texels_u, texels_v, 3, {}};
    for (std::uint32_t i = 0; i < 3 * texels_u * texels_v; ++i)
        image.pixels.push_back(float(random() % 256) / 255.0f);
    return image;
}

// How one filter or sampler reads: smooth or not where magnified and where minified, and levels.
struct Reading {
    const char* name;
    TextureFilter filter;
    Filter mag, min;
    MipFilter mip;
};
const Reading readings[] = {
    {"nearest", TextureFilter::nearest, Filter::nearest, Filter::nearest, MipFilter::none},
    {"bilinear", TextureFilter::bilinear, Filter::linear, Filter::linear, MipFilter::none},
    {"nearest mip", TextureFilter::nearest_mip, Filter::linear, Filter::linear, MipFilter::nearest},
    {"trilinear", TextureFilter::trilinear, Filter::linear, Filter::linear, MipFilter::linear},
    {"sampler NEAREST", TextureFilter::by_sampler, Filter::nearest, Filter::nearest,
     MipFilter::none},
    {"sampler LINEAR, NEAREST", TextureFilter::by_sampler, Filter::linear, Filter::nearest,
     MipFilter::none},
    {"sampler LINEAR", TextureFilter::by_sampler, Filter::linear, Filter::linear, MipFilter::none},
    {"sampler NEAREST_MIPMAP_NEAREST", TextureFilter::by_sampler, Filter::nearest, Filter::nearest,
     MipFilter::nearest},
    {"sampler LINEAR_MIPMAP_NEAREST", TextureFilter::by_sampler, Filter::linear, Filter::linear,
     MipFilter::nearest},
    {"sampler NEAREST, LINEAR_MIPMAP_NEAREST", TextureFilter::by_sampler, Filter::nearest,
     Filter::linear, MipFilter::nearest},
    {"sampler NEAREST_MIPMAP_LINEAR", TextureFilter::by_sampler, Filter::linear, Filter::nearest,
     MipFilter::linear},
    {"sampler LINEAR_MIPMAP_LINEAR", TextureFilter::by_sampler, Filter::linear, Filter::linear,
     MipFilter::linear},
};

// By definition; nothing where rounding decides. `read`: how often each level is.
std::optional<glm::dvec3> reference(const Corners& corners, const Reading& reading,
                                    const std::vector<Level>& levels, double x, double y,
                                    double stretch, std::vector<std::size_t>& read) {
    const glm::dvec2 uv = uv_at(corners, x, y, stretch);
    const double lod = level_of_detail(corners, x, y, stretch), last = double(levels.size() - 1);
    const double kept = std::clamp(lod, 0.0, last), part = kept - std::floor(kept);
    if (reading.mag != reading.min && std::abs(lod) < 1e-4) return std::nullopt;
    const Filter within = lod > 0 ? reading.min : reading.mag;
    const auto from = [&](std::size_t l) -> std::optional<glm::dvec3> {
        ++read[l];
        if (within == Filter::nearest) return levels[l].nearest(uv);
        return levels[l].bilinear(uv);
    };
    const auto fine = std::size_t(kept), coarse = std::min(fine + 1, levels.size() - 1);
    switch (reading.mip) {
        case MipFilter::none:
            return from(0);
        case MipFilter::nearest:
            if (std::abs(part - 0.5) < 1e-4) return std::nullopt;
            return from(part > 0.5 ? coarse : fine);
        case MipFilter::linear:
            break;
    }
    const auto a = from(fine), b = from(coarse);
    if (!a || !b) return std::nullopt;
    return glm::mix(*a, *b, part);
}

prep::PreparedScene triangle_scene(const Corners& corners, const prep::Image& image,
                                   prep::PixelType type, float stretch) {
    prep::VertexMesh mesh;
    mesh.uvs.emplace_back();
    for (const Corner& c : corners) {
        const double pixel_size = 2 * tangent / height;
        mesh.positions.push_back(glm::vec3(
            glm::dvec3((c.x - width / 2.0) * pixel_size, (height / 2.0 - c.y) * pixel_size, -1) *
            c.distance));
        mesh.uvs[0].push_back(glm::vec2(c.uv) * stretch);
    }
    mesh.indices = {0, 1, 2};
    prep::Material material = white();
    material.unlit = material.double_sided = true;
    material.diffuse_map.texture = 0;
    prep::PreparedScene scene = test::scene_of(mesh, material);
    prep::ImageRef ref;
    ref.name = "memory.png";
    ref.bytes = *prep::encode_png(image, type);
    scene.scene.images.push_back(ref);
    prep::Texture texture;
    texture.image = 0;
    scene.scene.textures.push_back(texture);
    return scene;
}

// Files of 8 bits are kept packed, of 16 bits as floats.
TEST(MipLevels, AreChosenAndMixedByTheFootprintOfEachPixel) {
    const prep::Image image = noise();
    const std::vector<Level> levels = pyramid_of(image);
    rast::RenderRequest request;
    request.width = width;
    request.height = height;
    rast::View view;
    view.yfov = 2 * std::atan(tangent);
    request.view = view;
    for (const Reading& reading : readings) {
        std::vector<std::size_t> read(levels.size());
        for (const auto& [type, stretch] : {std::pair(prep::PixelType::u8, 0.0625f),
                                            {prep::PixelType::u16, 0.5f},
                                            {prep::PixelType::u8, 4.0f}}) {
            SCOPED_TRACE(reading.name + (" on UVs times " + std::to_string(stretch)));
            prep::PreparedScene scene = triangle_scene(before_the_eye, image, type, stretch);
            prep::Texture& sampler = scene.scene.textures[0];
            if (reading.filter == TextureFilter::by_sampler) {
                sampler.mag = reading.mag;
                sampler.min = reading.min;
                sampler.mip = reading.mip;
            }
            request.filter = reading.filter;
            // Texel coordinates of up to 1000 are rounded to 6e-5, where neighbours differ by one;
            // levels of detail to 1e-5; packed texels by half a step a level.
            const float by = stretch;
            const std::size_t compared = expect_pixels(scene, request, 3e-4, [&](auto x, auto y) {
                return reference(before_the_eye, reading, levels, x + 0.5, y + 0.5, double(by),
                                 read);
            });
            EXPECT_GT(compared, 2500u);
        }
        if (reading.mip == MipFilter::none) continue;
        for (std::size_t l = 0; l < levels.size(); ++l) EXPECT_GT(read[l], 50u) << l;
    }
}

// The same of a triangle that the near plane cuts, by its own way through the rasterizer.
TEST(MipLevels, AreChosenByTheFootprintWhereTheNearPlaneCutsToo) {
    const prep::Image image = noise();
    const std::vector<Level> levels = pyramid_of(image);
    rast::RenderRequest request;
    request.width = width;
    request.height = height;
    rast::View view;
    view.yfov = 2 * std::atan(tangent);
    request.view = view;
    for (const Reading& reading : {readings[2], readings[3]})
        for (const float stretch : {0.0625f, 0.5f}) {
            SCOPED_TRACE(reading.name);
            const prep::PreparedScene scene =
                triangle_scene(through_the_eye, image, prep::PixelType::u8, stretch);
            request.filter = reading.filter;
            std::vector<std::size_t> read(levels.size());
            const std::size_t compared = expect_pixels(scene, request, 3e-4, [&](auto x, auto y) {
                return reference(through_the_eye, reading, levels, x + 0.5, y + 0.5,
                                 double(stretch), read);
            });
            EXPECT_GT(compared, 2500u);
            EXPECT_GT(test::draw(scene, request).counters.crossing, 0u);
            for (std::size_t l = 0; l < 3; ++l) EXPECT_GT(read[l], 20u) << l;
        }
}

}  // namespace
