// Where maps are read: UV sets and KHR_texture_transform, against the extension's words and its
// examples, for every map of a material and on every instruction set.
#include <cmath>
#include <random>

#include "reference_shading.h"

namespace {

using namespace test;

// A picture of side × side texels, every one of another colour.
struct Picture {
    prep::Image image;
    std::uint32_t side = 0;

    explicit Picture(std::uint32_t extent, std::uint32_t seed = 1)
        : image{extent, extent, 3, {}}, side(extent) {
        std::mt19937 random(seed);
        for (std::uint32_t i = 0; i < 3 * extent * extent; ++i)
            image.pixels.push_back(float(51 + random() % 205) / 255.0f);
    }
    glm::dvec3 texel(std::int64_t x, std::int64_t y) const {
        const std::int64_t n = side;
        const float* p =
            image.at(std::uint32_t(((x % n) + n) % n), std::uint32_t(((y % n) + n) % n));
        return {p[0], p[1], p[2]};
    }
    // Nothing next to a border of texels, where rounding decides.
    std::optional<glm::dvec3> nearest(const glm::dvec2& uv) const {
        const glm::dvec2 at = uv * double(side);
        if (glm::any(glm::lessThan(glm::abs(at - glm::round(at)), glm::dvec2(1e-3))))
            return std::nullopt;
        return texel(std::int64_t(std::floor(at.x)), std::int64_t(std::floor(at.y)));
    }
};

prep::TextureRef add_map(prep::PreparedScene& scene, const Picture& picture) {
    prep::ImageRef image;
    image.name = "memory.png";
    image.bytes = *prep::encode_png(picture.image, prep::PixelType::u8);
    prep::Texture texture;
    texture.image = std::uint32_t(scene.scene.images.size());
    scene.scene.images.push_back(image);
    prep::TextureRef ref;
    ref.texture = std::uint32_t(scene.scene.textures.size());
    scene.scene.textures.push_back(texture);
    return ref;
}

// "Rotate the UVs by this many radians counter-clockwise around the origin", after the scale and
// before the offset. v points down, so that up in the picture is −v.
glm::dvec2 transformed(const prep::TextureRef& ref, const glm::dvec2& uv) {
    const double right = double(ref.scale.x) * uv.x, up = -double(ref.scale.y) * uv.y;
    const double c = std::cos(double(ref.rotation)), s = std::sin(double(ref.rotation));
    return glm::dvec2(ref.offset) + glm::dvec2(c * right - s * up, -(s * right + c * up));
}

// The floor in full, its pixels' centres at uv = (x + ½) / extent.
rast::RenderRequest floor_request(std::uint32_t extent) {
    rast::RenderRequest request;
    request.width = request.height = extent;
    request.view = test::flat_view(1);
    request.filter = rast::TextureFilter::nearest;
    request.lights = std::vector<LightInstance>{ambient({0.5f, 0.7f, 0.6f}),
                                                directional({-1, 1, 2}, {0.4f, 0.5f, 0.3f})};
    return request;
}
glm::dvec2 uv_at(std::uint32_t x, std::uint32_t y, std::uint32_t extent) {
    return (glm::dvec2(x, y) + 0.5) / double(extent);
}

prep::Material unlit() {
    prep::Material material = white();
    material.unlit = true;
    return material;
}

// The extension's first example: "only the lower left quadrant of the source image, rotated
// clockwise 90°".
TEST(TextureTransform, ItsExampleShowsTheLowerLeftQuadrantTurnedClockwise) {
    prep::PreparedScene scene = test::scene_of(floor_of(1), unlit());
    const Picture picture(8);
    prep::TextureRef& ref = scene.scene.materials[0].diffuse_map;
    ref = add_map(scene, picture);
    ref.offset = {0, 1};
    ref.rotation = 1.57079632679f;
    ref.scale = {0.5f, 0.5f};
    const std::size_t compared =
        expect_pixels(scene, floor_request(4), 1e-5, [&](std::int64_t x, std::int64_t y) {
            // Turned clockwise, the quadrant's column y from below is row y from the left.
            return std::optional(decoded_srgb(picture.texel(y, 4 + (3 - x))));
        });
    EXPECT_EQ(compared, 16u);
}

// Its second example "inverts the T axis, effectively defining a bottom-left origin".
TEST(TextureTransform, ItsExampleTurnsThePictureUpsideDown) {
    prep::PreparedScene scene = test::scene_of(floor_of(1), unlit());
    const Picture picture(8);
    prep::TextureRef& ref = scene.scene.materials[0].diffuse_map;
    ref = add_map(scene, picture);
    ref.offset = {0, 1};
    ref.scale = {1, -1};
    const std::size_t compared =
        expect_pixels(scene, floor_request(8), 1e-5, [&](std::int64_t x, std::int64_t y) {
            return std::optional(decoded_srgb(picture.texel(x, 7 - y)));
        });
    EXPECT_EQ(compared, 64u);
}

TEST(TextureTransform, ScalesThenTurnsThenMoves) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<float> value(-2, 2);
    const Picture picture(8);
    for (int n = 0; n < 12; ++n) {
        prep::PreparedScene scene = test::scene_of(floor_of(1), unlit());
        prep::TextureRef& ref = scene.scene.materials[0].diffuse_map;
        ref = add_map(scene, picture);
        if (n != 1) ref.offset = {value(random), value(random)};
        if (n != 2) ref.scale = {value(random), value(random)};
        if (n != 3) ref.rotation = 2 * value(random);
        std::size_t skipped = 0;
        const std::size_t compared =
            expect_pixels(scene, floor_request(40), 1e-5, [&](auto x, auto y) {
                auto color = picture.nearest(transformed(ref, uv_at(x, y, 40)));
                skipped += !color;
                if (color) color = decoded_srgb(*color);
                return color;
            });
        EXPECT_EQ(compared + skipped, 1600u);
        EXPECT_GT(compared, 1400u);
    }
}

// ------------------------------------------------------------------------------------- every map

enum class Map { diffuse, specular, emissive, occlusion, metallic_roughness, normal };

struct Placed {
    Map map;
    prep::TextureRef ref;
    const Picture* picture;
};

// What the maps at a point come to: docs/conventions.md, "Colour and light". Nothing where a
// texel's border is too close.
std::optional<glm::dvec3> expected_at(const prep::Material& m, const std::vector<Placed>& maps,
                                      const std::vector<glm::dvec2>& uvs,
                                      const std::vector<LightInstance>& lights) {
    glm::dvec3 base(glm::vec3(m.diffuse)), specular(m.specular), emissive(m.emissive);
    glm::dvec3 normal(0, 0, 1);
    double open = 1, metallic = double(m.metallic), roughness = double(m.roughness);
    for (const Placed& placed : maps) {
        const auto texel = placed.picture->nearest(transformed(placed.ref, uvs[placed.ref.uv_set]));
        if (!texel) return std::nullopt;
        switch (placed.map) {
            case Map::diffuse:
                base *= decoded_srgb(*texel);
                break;
            case Map::specular:
                specular *= decoded_srgb(*texel);
                break;
            case Map::emissive:
                emissive *= decoded_srgb(*texel);
                break;
            case Map::occlusion:
                open = texel->r;
                break;
            case Map::metallic_roughness:
                roughness *= texel->g;
                metallic *= texel->b;
                break;
            case Map::normal:
                normal = glm::normalize(*texel * 2.0 - 1.0);
                break;
        }
    }
    Surface s;
    if (m.metallic_roughness) {
        s = from_metallic_roughness(base, metallic, roughness);
    } else {
        s.diffuse = s.ambient = base;
        s.specular = specular;
        s.shininess = double(m.shininess);
    }
    s.ambient *= open;
    s.emissive = emissive;
    return reflected(s, lights, {0, 0, 0}, normal, {0, 0, 1});
}

prep::TextureRef& ref_of(prep::Material& m, Map map) {
    switch (map) {
        case Map::diffuse:
            return m.diffuse_map;
        case Map::specular:
            return m.specular_map;
        case Map::emissive:
            return m.emissive_map;
        case Map::occlusion:
            return m.occlusion_map;
        case Map::metallic_roughness:
            return m.metallic_roughness_map;
        case Map::normal:
            break;
    }
    return m.normal_map;
}

// The floor with three UV sets: itself, turned and stretched, mirrored.
prep::VertexMesh floor_with_sets() {
    prep::VertexMesh mesh = floor_of(1);
    mesh.tangents.assign(4, {1, 0, 0, 1});
    mesh.uvs.resize(3);
    for (const glm::vec2& uv : std::vector<glm::vec2>(mesh.uvs[0])) {
        mesh.uvs[1].push_back({1.5f * uv.y - 0.25f, 0.75f * uv.x + 0.125f});
        mesh.uvs[2].push_back({1.25f - 2.0f * uv.x, 1.75f * uv.y - 0.5f});
    }
    return mesh;
}
std::vector<glm::dvec2> sets_at(const glm::dvec2& uv) {
    return {uv, {1.5 * uv.y - 0.25, 0.75 * uv.x + 0.125}, {1.25 - 2 * uv.x, 1.75 * uv.y - 0.5}};
}

void expect_maps(prep::Material material, std::vector<Placed> maps, std::size_t at_least,
                 const rast::RenderRequest& request = floor_request(40)) {
    prep::PreparedScene scene = test::scene_of(floor_with_sets(), material);
    for (Placed& placed : maps) {
        prep::TextureRef ref = add_map(scene, *placed.picture);
        ref.uv_set = placed.ref.uv_set;
        ref.offset = placed.ref.offset;
        ref.scale = placed.ref.scale;
        ref.rotation = placed.ref.rotation;
        ref_of(scene.scene.materials[0], placed.map) = ref;
    }
    const std::size_t compared = expect_pixels(scene, request, 5e-5, [&](auto x, auto y) {
        return expected_at(material, maps, sets_at(uv_at(x, y, 40)), *request.lights);
    });
    EXPECT_GT(compared, at_least);
}

prep::Material mapped(bool metallic_roughness) {
    prep::Material material;
    material.diffuse = {0.8f, 0.6f, 0.7f, 1};
    material.emissive = {0.2f, 0.3f, 0.4f};
    material.specular = {0.5f, 0.25f, 0.4f};
    material.shininess = 6;
    material.metallic_roughness = metallic_roughness;
    material.metallic = 0.9f;
    return material;
}

prep::TextureRef place(std::uint32_t set, const glm::vec2& offset, const glm::vec2& scale,
                       float rotation) {
    prep::TextureRef ref;
    ref.uv_set = set;
    ref.offset = offset;
    ref.scale = scale;
    ref.rotation = rotation;
    return ref;
}

TEST(TexturePlacement, EveryMapHasItsOwnSetAndTransform) {
    const Picture picture(8);
    for (const Map map : {Map::diffuse, Map::specular, Map::emissive, Map::occlusion,
                          Map::metallic_roughness, Map::normal})
        for (std::uint32_t set = 0; set < 3; ++set) {
            SCOPED_TRACE("map " + std::to_string(int(map)) + ", set " + std::to_string(set));
            expect_maps(
                mapped(map == Map::metallic_roughness || set == 1 ? map != Map::specular : false),
                {{map, place(set, {0.3f, -0.2f}, {1.25f, 0.75f}, 0.5f), &picture}}, 1300);
        }
}

TEST(TexturePlacement, MapsOfOneMaterialMayAllLieDifferently) {
    const Picture a(8, 1), b(8, 2), c(16, 3), d(5, 4), e(8, 5);
    expect_maps(mapped(true),
                {{Map::diffuse, place(0, {0, 0}, {1, 1}, 0), &a},
                 {Map::emissive, place(1, {0.1f, 0.2f}, {1, 1}, 0.3f), &b},
                 {Map::occlusion, place(2, {0, 0}, {1, 1}, 0), &c},
                 {Map::metallic_roughness, place(0, {0, 0}, {1.5f, 1}, 0), &d},
                 {Map::normal, place(1, {0, 0}, {1, 1}, -0.7f), &e}},
                900);
    expect_maps(mapped(false),
                {{Map::diffuse, place(1, {0, 0}, {1, 1}, 0), &a},
                 {Map::specular, place(0, {0.5f, 0}, {1, 1}, 0), &b},
                 {Map::emissive, place(0, {0, 0.5f}, {1, 1}, 0), &c},
                 {Map::occlusion, place(0, {0, 0}, {1, -1}, 0), &d},
                 {Map::normal, place(2, {0, 0}, {0.5f, 0.5f}, 2), &e}},
                900);
}

// Maps of one size at one place are read together, two at a time.
TEST(TexturePlacement, MapsOnTheSameTexelsKeepTheirOwnColours) {
    const Picture a(8, 1), b(8, 2), c(8, 3), d(8, 4), e(8, 5);
    for (const bool turned : {false, true}) {
        const prep::TextureRef at =
            turned ? place(1, {0.1f, 0.2f}, {1.5f, 1}, 0.4f) : place(0, {0, 0}, {1, 1}, 0);
        const prep::TextureRef elsewhere = place(2, {0, 0}, {1, 1}, 0);
        expect_maps(mapped(true),
                    {{Map::diffuse, at, &a},
                     {Map::emissive, at, &b},
                     {Map::occlusion, at, &c},
                     {Map::metallic_roughness, at, &d},
                     {Map::normal, at, &e}},
                    1300);
        expect_maps(mapped(false),
                    {{Map::diffuse, at, &a},
                     {Map::specular, elsewhere, &b},
                     {Map::emissive, at, &c},
                     {Map::occlusion, elsewhere, &d},
                     {Map::normal, at, &e}},
                    1200);
    }
}

TEST(TexturePlacement, MapsOnASetThatTheMeshLacksAreLeftOut) {
    prep::PreparedScene scene = test::scene_of(floor_with_sets(), unlit());
    scene.scene.materials[0].diffuse = {0.25f, 0.5f, 0.75f, 1};
    scene.scene.materials[0].diffuse_map = add_map(scene, Picture(8));
    scene.scene.materials[0].diffuse_map.uv_set = 3;
    EXPECT_EQ(expect_pixels(scene, floor_request(8), 0,
                            [](auto, auto) { return glm::dvec3(0.25, 0.5, 0.75); }),
              64u);
}

}  // namespace
