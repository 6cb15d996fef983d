// Materials and their maps against docs/conventions.md in closed form, on every instruction set:
// which channel of which map means what, and what each factor and strength does.
#include "reference_shading.h"

namespace {

using namespace test;

// A picture of one colour, 16 bits a channel: within 8e-6. Or 8 bits: within 2e-3, unless the
// colour is made of steps of 1/255.
prep::ImageRef picture(const glm::dvec4& color, std::uint32_t channels,
                       prep::PixelType type = prep::PixelType::u16) {
    prep::Image image{2, 2, channels, {}};
    for (int i = 0; i < 4; ++i)
        for (std::uint32_t c = 0; c < channels; ++c) image.pixels.push_back(float(color[int(c)]));
    prep::ImageRef ref;
    ref.name = "memory.png";
    ref.bytes = *prep::encode_png(image, type);
    return ref;
}

prep::TextureRef add_map(prep::PreparedScene& scene, const prep::ImageRef& image) {
    prep::Texture texture;
    texture.image = std::uint32_t(scene.scene.images.size());
    scene.scene.images.push_back(image);
    prep::TextureRef ref;
    ref.texture = std::uint32_t(scene.scene.textures.size());
    scene.scene.textures.push_back(texture);
    return ref;
}
prep::TextureRef add_map(prep::PreparedScene& scene, const glm::dvec3& color) {
    return add_map(scene, picture(glm::dvec4(color, 1), 3));
}

std::vector<LightInstance> some_lights() {
    return {ambient({0.3f, 0.2f, 0.4f}), directional({-1, 1, 2}, {0.7f, 0.6f, 0.5f}),
            point_light({0.6, -0.3, 1.5}, {1.2f, 1.0f, 0.8f})};
}

// A unit of the floor is 10 pixels: its corners lie on the grid that corners are moved to.
rast::RenderRequest floor_request() {
    rast::RenderRequest request;
    request.width = 37;
    request.height = 40;
    request.view = test::look_at({0.4, -0.7, 4}, {0.4, -0.7, 0}, 2 * std::atan(0.5));
    request.lights = some_lights();
    return request;
}

// Maps of 16 bits are off by 8e-6 at most, and each of them scales what is of order one.
constexpr double bound = 5e-5;

void expect_floor(const prep::PreparedScene& scene, const Surface& surface,
                  const glm::dvec3& normal = {0, 0, 1}, double within = bound,
                  const rast::RenderRequest& request = floor_request()) {
    const std::size_t compared = expect_pixels(scene, request, within, [&](auto x, auto y) {
        const Floor at = floor_at(request, x, y);
        return reflected(surface, *request.lights, at.position, normal, at.to_eye);
    });
    EXPECT_GT(compared, 1400u);
}

prep::Material glossy() {
    prep::Material material;
    material.diffuse = {0.7f, 0.5f, 0.3f, 1};
    material.specular = {0.3f, 0.4f, 0.5f};
    material.shininess = 12;
    material.ambient = {0.5f, 0.25f, 1.0f};
    material.emissive = {0.1f, 0.3f, 0.2f};
    return material;
}
prep::Material metal() {
    prep::Material material;
    material.metallic_roughness = true;
    material.diffuse = {0.9f, 0.6f, 0.3f, 1};
    material.metallic = 0.8f;
    material.roughness = 0.9f;
    return material;
}
Surface metal_with(double metallic, double roughness) {
    return from_metallic_roughness({0.9f, 0.6f, 0.3f}, metallic, roughness);
}

// ------------------------------------------------------------------------------ maps and factors

TEST(Materials, FactorsAloneAreThoseOfBlinnPhong) {
    expect_floor(test::scene_of(floor_of(4), glossy()), from_factors(glossy()));
    prep::Material dull = glossy();
    dull.shininess = 0;  // (n·h)^0 is 1
    expect_floor(test::scene_of(floor_of(4), dull), from_factors(dull));
}

TEST(Materials, DiffuseMapsMultiplyTheFactorAndVertexColours) {
    prep::PreparedScene scene = test::scene_of(floor_of(4), glossy());
    const glm::dvec3 map(0.8, 0.4, 0.6);
    scene.scene.materials[0].diffuse_map = add_map(scene, map);
    Surface s = from_factors(glossy());
    s.diffuse *= decoded_srgb(map);
    s.ambient *= decoded_srgb(map);
    expect_floor(scene, s);
    const glm::vec3 color(0.25f, 1.5f, 0.75f);
    scene.meshes[0].colors = {std::vector<glm::vec4>(4, glm::vec4(color, 1))};
    s.diffuse *= glm::dvec3(color);
    s.ambient *= glm::dvec3(color);
    expect_floor(scene, s);
    rast::RenderRequest untextured = floor_request();
    untextured.textures = false;
    s = from_factors(glossy());
    s.diffuse *= glm::dvec3(color);
    s.ambient *= glm::dvec3(color);
    expect_floor(scene, s, {0, 0, 1}, bound, untextured);
}

// A colour without a value is no colour: white.
TEST(Materials, VertexColoursThatAreNotFiniteCountAsWhite) {
    for (const float broken : {NAN, INFINITY, -INFINITY}) {
        prep::PreparedScene scene = test::scene_of(floor_of(4), glossy());
        scene.meshes[0].colors = {std::vector<glm::vec4>(4, glm::vec4(0.5f, broken, 0.5f, 1))};
        expect_floor(scene, from_factors(glossy()));
    }
}

TEST(Materials, SpecularMapsMultiplyTheSpecularFactorAlone) {
    for (const bool encoded_8 : {false, true}) {
        prep::PreparedScene scene = test::scene_of(floor_of(4), glossy());
        const glm::dvec3 map = glm::dvec3(204, 51, 153) / 255.0;
        scene.scene.materials[0].specular_map = add_map(
            scene,
            picture(glm::dvec4(map, 1), 3, encoded_8 ? prep::PixelType::u8 : prep::PixelType::u16));
        Surface s = from_factors(glossy());
        s.specular *= decoded_srgb(map);
        expect_floor(scene, s);
    }
}

TEST(Materials, EmissiveMapsMultiplyTheEmissiveFactor) {
    prep::PreparedScene scene = test::scene_of(floor_of(4), glossy());
    const glm::dvec3 map(0.9, 0.2, 0.7);
    prep::Material& material = scene.scene.materials[0];
    material.emissive_map = add_map(scene, map);
    material.emissive = {2.5f, 0.5f, 0.25f};  // above 1: KHR_materials_emissive_strength
    Surface s = from_factors(material);
    s.emissive *= decoded_srgb(map);
    expect_floor(scene, s);
    material.emissive = {0, 0, 0.5f};
    s.emissive = glm::dvec3(0, 0, 0.5) * decoded_srgb(map);
    expect_floor(scene, s);
    material.emissive = glm::vec3(0.0f);  // glTF: no emission, whatever the map holds
    s.emissive = glm::dvec3(0.0);
    expect_floor(scene, s);
}

// KHR_materials_unlit: the base colour, and nothing else.
TEST(Materials, UnlitOnesShowTheirColourUnderAnyLight) {
    prep::PreparedScene scene = test::scene_of(floor_of(4), glossy());
    const glm::dvec3 map(0.8, 0.4, 0.6), glow(0.5, 0.9, 0.3);
    prep::Material& material = scene.scene.materials[0];
    material.unlit = true;
    material.diffuse_map = add_map(scene, map);
    material.emissive_map = add_map(scene, glow);
    material.specular_map = material.occlusion_map = material.diffuse_map;
    Surface s;
    s.emissive = glm::dvec3(0.7f, 0.5f, 0.3f) * decoded_srgb(map);
    expect_floor(scene, s);
    rast::RenderRequest gouraud = floor_request();
    gouraud.shading = Shading::gouraud;
    expect_floor(scene, s, {0, 0, 1}, bound, gouraud);
}

// glTF: only red is read, 1 + strength · (red − 1), and of ambient light alone.
TEST(Materials, OcclusionIsRedByItsStrengthAndDimsAmbientLightAlone) {
    for (const double strength : {0.0, 0.25, 0.6, 1.0})
        for (const bool metallic : {false, true}) {
            const prep::Material plain = metallic ? metal() : glossy();
            prep::PreparedScene scene = test::scene_of(floor_of(4), plain);
            prep::TextureRef& map = scene.scene.materials[0].occlusion_map;
            map = add_map(scene, {0.3, 0.8, 0.6});
            map.strength = float(strength);
            Surface s = metallic ? metal_with(0.8f, 0.9f) : from_factors(plain);
            s.ambient *= 1 + strength * (0.3 - 1);
            SCOPED_TRACE("strength " + std::to_string(strength));
            expect_floor(scene, s);
        }
}

// One texture, decoded for those that read colours in it and as it is for those that read data.
TEST(Materials, OneTextureMayBeAColourAndData) {
    const glm::dvec3 map(0.5, 0.8, 0.6);
    for (const bool same_material : {true, false}) {
        prep::PreparedScene scene = test::scene_of(floor_of(4), glossy());
        const prep::TextureRef ref = add_map(scene, map);
        Surface s = from_factors(glossy());
        if (same_material) {
            scene.scene.materials[0].diffuse_map = ref;
            s.diffuse *= decoded_srgb(map);
            s.ambient *= decoded_srgb(map);
        } else {  // out of sight
            scene.scene.materials.push_back(glossy());
            scene.scene.materials[1].diffuse_map = ref;
            scene.scene.meshes.emplace_back();
            scene.meshes.push_back(scene.meshes[0]);
            scene.meshes[1].ranges[0].material = 1;
            scene.scene.nodes.push_back(scene.scene.nodes[0]);
            scene.scene.nodes[1].mesh = 1;
            scene.scene.nodes[1].transform[3] = glm::dvec4(0, 0, -1e4, 1);
        }
        scene.scene.materials[0].occlusion_map = ref;
        s.ambient *= map.r;
        SCOPED_TRACE(same_material);
        expect_floor(scene, s);
    }
}

// ------------------------------------------------------------------------------ metallic-roughness

// glTF: roughness is green, metalness is blue; both linear, times their factors. Red is another's.
TEST(Materials, RoughnessIsGreenAndMetalnessIsBlue) {
    for (const glm::dvec3 steps : {glm::dvec3(230, 127, 64), {25, 77, 255}, {127, 204, 0}}) {
        const glm::dvec3 map = steps / 255.0;  // which 16 bits hold exactly
        prep::PreparedScene scene = test::scene_of(floor_of(4), metal());
        scene.scene.materials[0].metallic_roughness_map = add_map(scene, map);
        const Surface s = metal_with(double(0.8f) * map.b, double(0.9f) * map.g);
        expect_floor(scene, s, {0, 0, 1}, 1e-5 * std::max(1.0, s.specular.r));
    }
}

TEST(Materials, OneMapMayHoldOcclusionRoughnessAndMetalness) {
    prep::PreparedScene scene = test::scene_of(floor_of(4), metal());
    prep::Material& material = scene.scene.materials[0];
    const glm::dvec3 base(0.7, 0.9, 0.4), glow(0.3, 0.6, 0.8);
    material.metallic_roughness_map = add_map(scene, {0.35, 0.6, 0.45});
    material.occlusion_map = material.metallic_roughness_map;
    material.occlusion_map.strength = 0.5f;
    material.diffuse_map = add_map(scene, base);
    material.emissive_map = add_map(scene, glow);
    material.emissive = {0.5f, 1, 0.25f};
    Surface s = from_metallic_roughness(glm::dvec3(0.9f, 0.6f, 0.3f) * decoded_srgb(base),
                                        double(0.8f) * 0.45, double(0.9f) * 0.6);
    s.ambient *= 1 + 0.5 * (0.35 - 1);
    s.emissive = glm::dvec3(0.5, 1, 0.25) * decoded_srgb(glow);
    expect_floor(scene, s);
}

TEST(Materials, OfMetallicRoughnessDoNotReadTheSpecularFieldsNorTheOthersTheirs) {
    prep::PreparedScene scene = test::scene_of(floor_of(4), metal());
    prep::Material& material = scene.scene.materials[0];
    material.specular = {5, 5, 5};
    material.shininess = 3;
    expect_floor(scene, metal_with(0.8f, 0.9f));
    scene.scene.materials[0] = glossy();
    scene.scene.materials[0].metallic_roughness_map = add_map(scene, {0.1, 0.1, 0.1});
    expect_floor(scene, from_factors(glossy()));
}

// KHR_materials_specular: of what is no metal, the reflectance is the material's, times its map;
// as by docs/conventions.md, F0 + (c − F0) · metallic, spread over the lobe.
TEST(Materials, ReflectanceOfDielectricsIsTheMaterialsTimesItsMap) {
    const glm::dvec3 base(0.9f, 0.6f, 0.3f), reflectance(0.3f, 0.2f, 0.1f), map(0.8, 0.5, 0.25);
    for (const bool mapped : {false, true})
        for (const float metallic : {0.0f, 0.5f, 1.0f}) {
            prep::PreparedScene scene = test::scene_of(floor_of(4), metal());
            prep::Material& material = scene.scene.materials[0];
            material.metallic = metallic;
            material.reflectance = glm::vec3(reflectance);
            if (mapped) material.specular_map = add_map(scene, map);
            Surface s = metal_with(double(metallic), double(material.roughness));
            const glm::dvec3 f0 = reflectance * (mapped ? decoded_srgb(map) : glm::dvec3(1.0));
            const glm::dvec3 usual(0.04);
            s.specular *=
                (f0 + (base - f0) * double(metallic)) / (usual + (base - usual) * double(metallic));
            expect_floor(scene, s, {0, 0, 1}, 1e-5 * std::max(1.0, s.specular.r));
        }
}

// The published mapping for every roughness, down to the exponent's limit of 4998 at 0.1414. The
// light and the eye stand so that the highlight's middle and its flank are in the picture.
TEST(Materials, HighlightsNarrowWithRoughnessDownToTheLimit) {
    rast::RenderRequest request = floor_request();
    request.lights =
        std::vector<LightInstance>{directional({0.05, 0.02, 1}, {0.02f, 0.02f, 0.02f})};
    for (const float roughness :
         {1.0f, 0.7f, 0.5f, 0.3f, 0.2f, 0.17f, 0.15f, 0.1415f, 0.12f, 0.05f, 0.0f})
        for (const float metallic : {0.0f, 1.0f}) {
            prep::Material material = metal();
            material.roughness = roughness;
            material.metallic = metallic;
            SCOPED_TRACE("roughness " + std::to_string(roughness));
            const Surface s = metal_with(double(metallic), double(roughness));
            // 1e-4 of the highlight's peak, 0.02 times the specular colour.
            expect_floor(test::scene_of(floor_of(4), material), s, {0, 0, 1},
                         std::max(1e-6, 2e-6 * s.specular.r), request);
        }
}

TEST(Materials, ShininessIsWhatTheMaterialSays) {
    rast::RenderRequest request = floor_request();
    request.lights = std::vector<LightInstance>{directional({0.05, 0.02, 1}, {1, 1, 1})};
    for (const float shininess : {0.5f, 1.0f, 30.0f, 1000.0f, 20000.0f}) {
        prep::Material material = glossy();
        material.shininess = shininess;
        SCOPED_TRACE("shininess " + std::to_string(shininess));
        expect_floor(test::scene_of(floor_of(4), material), from_factors(material), {0, 0, 1}, 1e-4,
                     request);
    }
}

// ----------------------------------------------------------------------------------- normal maps

// glTF: normalize((2 · texel − 1) · (scale, scale, 1)); green up (docs/conventions.md), down where
// the material says so.
TEST(NormalMaps, LeanByTheirStrengthAndGreenMayPointDown) {
    const glm::dvec3 texel(0.8, 0.35, 0.85);
    for (const double strength : {0.0, 0.5, 1.0, 2.0})
        for (const bool flipped : {false, true})
            for (const bool object : {false, true}) {
                prep::PreparedScene scene = test::scene_of(floor_of(4), glossy());
                prep::Material& material = scene.scene.materials[0];
                material.normal_map = add_map(scene, texel);
                material.normal_map.strength = float(strength);
                material.normal_map_flip_green = flipped;
                if (object) material.normal_map_space = prep::NormalMapSpace::object;
                glm::dvec3 n = texel * 2.0 - 1.0;
                if (flipped) n.y = -n.y;
                // An object-space map is the normal itself.
                if (!object) n *= glm::dvec3(strength, strength, 1);
                SCOPED_TRACE("strength " + std::to_string(strength) + (flipped ? ", flipped" : "") +
                             (object ? ", object space" : ""));
                // Two steps of 16 bits in a normal of length 0.9, times the highlight's slope.
                expect_floor(scene, from_factors(glossy()), glm::normalize(n), 2e-4);
            }
}

// A tangent that is not the mesh's x axis, and a bitangent on its other side.
TEST(NormalMaps, LieAlongTangentAndBitangent) {
    for (const float sign : {1.0f, -1.0f}) {
        prep::PreparedScene scene = test::scene_of(floor_of(4), glossy());
        scene.meshes[0].tangents.assign(4, {0.6f, 0.8f, 0, sign});
        const glm::dvec3 texel(0.7, 0.9, 0.8);
        scene.scene.materials[0].normal_map = add_map(scene, texel);
        const glm::dvec3 n = texel * 2.0 - 1.0, t(0.6, 0.8, 0), b(-0.8 * sign, 0.6 * sign, 0);
        expect_floor(scene, from_factors(glossy()),
                     glm::normalize(t * n.x + b * n.y + glm::dvec3(0, 0, n.z)), 2e-4);
    }
}

// A surface seen from behind is lit on that side, whatever its normals come from.
TEST(Normals, ArePointedToTheSideThatIsSeen) {
    enum { of_vertices, of_faces, of_a_tangent_map, of_an_object_map };
    for (const int source : {of_vertices, of_faces, of_a_tangent_map, of_an_object_map}) {
        prep::Material material = glossy();
        material.double_sided = true;
        prep::PreparedScene scene = test::scene_of(floor_of(4), material);
        scene.meshes[0].indices = {0, 2, 1, 0, 3, 2};  // the back is up, its normals point down
        scene.meshes[0].normals.assign(4, {0, 0, -1});
        glm::dvec3 normal(0, 0, 1);
        if (source == of_faces) scene.meshes[0].normals.clear();
        if (source >= of_a_tangent_map) {
            const glm::dvec3 texel(0.8, 0.35, 0.85);
            prep::Material& mapped = scene.scene.materials[0];
            mapped.normal_map = add_map(scene, texel);
            const glm::dvec3 n = texel * 2.0 - 1.0;
            // Tangent +X, normal −Z: the bitangent is −Y. All of it is then turned over.
            normal = glm::normalize(-glm::dvec3(n.x, -n.y, -n.z));
            if (source == of_an_object_map) {
                mapped.normal_map_space = prep::NormalMapSpace::object;
                normal = -glm::normalize(n);
            }
        }
        SCOPED_TRACE("source " + std::to_string(source));
        rast::RenderRequest request = floor_request();
        if (source == of_an_object_map)  // from below, where that points
            request.lights = std::vector<LightInstance>{ambient({0.3f, 0.2f, 0.4f}),
                                                        directional({-1, 1, -2}, {1, 1, 1})};
        expect_floor(scene, from_factors(material), normal, 2e-4, request);
    }
}

TEST(NormalMaps, ShowTheSameInTheNormalBuffer) {
    prep::PreparedScene scene = test::scene_of(floor_of(4), glossy());
    prep::Material& material = scene.scene.materials[0];
    const glm::dvec3 texel(0.8, 0.35, 0.85);
    material.normal_map = add_map(scene, texel);
    material.normal_map.strength = 0.5f;
    material.normal_map_flip_green = true;
    const glm::dvec3 n = glm::normalize((texel * 2.0 - 1.0) * glm::dvec3(0.5, -0.5, 1));
    rast::RenderRequest request = floor_request();
    request.keep_normals = true;
    for (const prep::SimdLevel level : every_level()) {
        request.simd = level;
        const rast::Frame frame = test::draw(scene, request);
        for (std::size_t i = 0; i < frame.normal.size(); ++i)
            if (frame.color[i].a > 0) {
                ASSERT_LT(distance(glm::dvec3(frame.normal[i]), n), 4e-5);
            }
    }
}

}  // namespace
