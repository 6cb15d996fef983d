// Bump maps against surfaces that are moved by the same heights: normals from tangents in closed
// form, none of it from the code under test.
#include "random_pictures.h"
#include "reference_shading.h"
#include "shading/slopes.h"

namespace {

using namespace test;

prep::ImageRef heights_of(std::uint32_t width, std::uint32_t height,
                          const std::vector<float>& values) {
    return float_picture(width, height, 1, values);
}

// Repeated, between texels' centres: central differences there, linear between them.
struct Slopes {
    std::uint32_t width, height;
    const std::vector<float>& h;

    double texel(std::int64_t x, std::int64_t y) const {
        const auto wrap = [](std::int64_t i, std::int64_t n) { return ((i % n) + n) % n; };
        return double(h[std::size_t(wrap(y, height) * width + wrap(x, width))]);
    }
    glm::dvec2 centre(std::int64_t x, std::int64_t y) const {
        return {(texel(x + 1, y) - texel(x - 1, y)) * width / 2,
                (texel(x, y + 1) - texel(x, y - 1)) * height / 2};
    }
    glm::dvec2 at(const glm::dvec2& uv) const {
        const double x = uv.x * width - 0.5, y = uv.y * height - 0.5;
        const double s = x - std::floor(x), t = y - std::floor(y);
        const auto i = std::int64_t(std::floor(x)), j = std::int64_t(std::floor(y));
        return (centre(i, j) * (1 - s) + centre(i + 1, j) * s) * (1 - t) +
               (centre(i, j + 1) * (1 - s) + centre(i + 1, j + 1) * s) * t;
    }
};

// A square in the mesh's xy plane, its UVs turned and sheared: uv = place · (x, y) + offset.
prep::PreparedScene sheared_square(const glm::dmat2& place, const glm::dvec2& offset,
                                   const prep::ImageRef& heights, prep::TextureRef bump) {
    prep::VertexMesh mesh;
    mesh.uvs.emplace_back();
    for (const glm::dvec2 p : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
        mesh.positions.push_back(glm::vec3(glm::dvec3(p, 0)));
        mesh.normals.push_back({0, 0, 1});
        mesh.uvs[0].push_back(glm::vec2(place * p + offset));
    }
    mesh.indices = {0, 1, 2, 0, 2, 3};
    mesh.ranges.push_back({0, 2, 0, 0});
    prep::Material material;
    bump.texture = 0;
    material.bump_map = bump;
    prep::PreparedScene scene = scene_of(std::move(mesh), material);
    scene.scene.textures.push_back({.image = 0});
    scene.scene.images.push_back(heights);
    return scene;
}

std::vector<float> some_heights(std::uint32_t count) {
    std::mt19937 random(7);
    std::vector<float> values;
    for (std::uint32_t i = 0; i < count; ++i) values.push_back(float(random() % 1024) / 1024);
    return values;
}

// The square fills the picture; one white light.
rast::RenderRequest front_request(const glm::dvec3& towards_light) {
    rast::RenderRequest request;
    request.width = request.height = 40;
    request.view = flat_view(1);
    request.lights = {directional(towards_light, {1, 1, 1})};
    return request;
}

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

// The normal of M (P(u, v) + h n), with P linear: the cross product of its tangents.
TEST(BumpMaps, BendNormalsAsMovingTheSurfaceWould) {
    const std::vector<float> h = some_heights(6 * 5);
    const Slopes slopes{6, 5, h};
    const glm::dmat2 place(0.31, 0.12, -0.22, 0.45);  // columns
    const glm::dvec2 offset(0.4, 0.7);
    prep::TextureRef bump;
    bump.strength = 0.25f;
    bump.offset = {0.3f, -0.2f};
    bump.scale = {1.5f, 0.8f};
    bump.rotation = 0.7f;
    prep::PreparedScene scene = sheared_square(place, offset, heights_of(6, 5, h), bump);
    // KHR_texture_transform: offset + rotation · scale · uv.
    const double c = std::cos(double(bump.rotation)), s = std::sin(double(bump.rotation));
    const glm::dmat2 turned =
        glm::dmat2(c, -s, s, c) * glm::dmat2(double(bump.scale.x), 0, 0, double(bump.scale.y));
    const glm::dmat2 from_xy = turned * place;  // columns: d(uv)/dx, d(uv)/dy
    const glm::dmat2 to_xy = glm::inverse(from_xy);
    // Scaled unevenly and turned: normals go by the inverse transpose.
    glm::dmat4 world(1);
    world[0] = {0.9, 0.1, 0.5, 0};
    world[1] = {-0.1, 0.6, 0.2, 0};
    world[2] = {-0.3, -0.2, 1.4, 0};
    scene.scene.nodes[0].transform = world;
    rast::RenderRequest request;
    request.width = 90;
    request.height = 80;
    request.view = look_at({0.3, -0.2, 3}, {0, 0, 0});
    request.lights = {directional({0, 0, 1}, {1, 1, 1})};
    request.keep_normals = request.keep_positions = true;
    request.filter = rast::TextureFilter::bilinear;
    for (const prep::SimdLevel level : every_level()) {
        request.simd = level;
        const rast::Frame frame = draw(scene, request);
        const glm::dmat4 from_world = glm::inverse(world);
        const glm::dvec3 eye = request.view->eye();
        std::size_t compared = 0;
        double bent = 0;
        for (std::size_t i = 0; i < frame.normal.size(); ++i) {
            if (!(frame.color[i].a > 0)) continue;
            const glm::dvec3 at(from_world * glm::dvec4(eye + glm::dvec3(frame.position[i]), 1));
            const glm::dvec2 uv =
                turned * (place * glm::dvec2(at) + offset) + glm::dvec2(bump.offset);
            const glm::dvec2 slope = slopes.at(uv) * double(bump.strength);
            const glm::dvec3 along_u(to_xy[0], slope.x), along_v(to_xy[1], slope.y);
            glm::dvec3 n = glm::cross(glm::dmat3(world) * along_u, glm::dmat3(world) * along_v);
            const glm::dvec3 plain(glm::transpose(glm::dmat3(from_world)) * glm::dvec3(0, 0, 1));
            if (glm::dot(n, plain) < 0) n = -n;
            EXPECT_LT(degrees_between(n, glm::dvec3(frame.normal[i])), 0.02)
                << "pixel " << i << ", level " << int(level);
            bent = std::max(bent, degrees_between(n, plain));
            ++compared;
        }
        EXPECT_GT(compared, 1500u);
        EXPECT_GT(bent, 20);
    }
}

// A ball with waves on it, its normals by differences of the points that are moved.
TEST(BumpMaps, OnABallLookLikeWavesThatAreThere) {
    constexpr std::uint32_t width = 512, height = 256;
    constexpr double amplitude = 0.03;
    const auto wave = [](double u, double v) {
        return std::sin(2 * std::numbers::pi * 12 * u) * std::sin(std::numbers::pi * 10 * v);
    };
    std::vector<float> h;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            h.push_back(float(wave((x + 0.5) / width, (y + 0.5) / height)));
    prep::Material material;
    material.bump_map.texture = 0;
    material.bump_map.strength = float(amplitude);
    prep::PreparedScene scene = scene_of(sphere(256, 128), material);
    scene.meshes[0].ranges[0].material = 0;
    scene.scene.textures.push_back({.image = 0});
    scene.scene.images.push_back(heights_of(width, height, h));
    rast::RenderRequest request;
    request.width = request.height = 120;
    request.view = look_at({0, 0.4, 3}, {0, 0, 0});
    request.lights = {directional({0, 0, 1}, {1, 1, 1})};
    request.keep_normals = request.keep_uvs = true;
    request.filter = rast::TextureFilter::bilinear;
    const rast::Frame frame = draw(scene, request);
    // As builders.h lays the ball.
    const auto moved = [&](double u, double v) {
        const double theta = std::numbers::pi * v, phi = 2 * std::numbers::pi * u;
        const glm::dvec3 n(std::sin(theta) * std::sin(phi), std::cos(theta),
                           std::sin(theta) * std::cos(phi));
        return n * (1 + amplitude * wave(u, v));
    };
    std::size_t compared = 0;
    double worst = 0, bent = 0;
    for (std::size_t i = 0; i < frame.normal.size(); ++i) {
        const double u = double(frame.uv[i].x), v = double(frame.uv[i].y);
        if (!(frame.color[i].a > 0) || v < 0.2 || v > 0.8) continue;
        constexpr double d = 1e-5;
        const glm::dvec3 n =
            glm::cross(moved(u, v + d) - moved(u, v - d), moved(u + d, v) - moved(u - d, v));
        const double off = degrees_between(n, glm::dvec3(frame.normal[i]));
        worst = std::max(worst, off);
        bent = std::max(bent, degrees_between(n, moved(u, v)));
        ++compared;
    }
    EXPECT_GT(compared, 3000u);
    EXPECT_GT(bent, 25);
    // Heights of a hundredth of the radius scale slopes by as much; faces are flat.
    EXPECT_LT(worst, 1.5);
}

TEST(BumpMaps, LieOnTopOfNormalMaps) {
    const std::vector<float> h = some_heights(16);
    prep::PreparedScene scene =
        sheared_square(glm::dmat2(0.5), {0.5, 0.5}, heights_of(4, 4, h), {});
    scene.scene.materials[0].bump_map.strength = 0.2f;
    scene.meshes[0].tangents.assign(4, {1, 0, 0, 1});
    rast::RenderRequest request = front_request({0, 0, 1});
    request.keep_normals = true;
    const rast::Frame bumped = draw(scene, request);
    const float flat[] = {0.5f, 0.5f, 1};
    const float leaning[] = {0.75f, 0.5f, 0.9f};
    scene.scene.textures.push_back({.image = 1});
    scene.scene.materials[0].normal_map.texture = 1;
    scene.scene.images.push_back(float_picture(1, 1, 3, flat));
    const rast::Frame with_flat = draw(scene, request);
    scene.scene.images[1] = float_picture(1, 1, 3, leaning);
    const rast::Frame both = draw(scene, request);
    const glm::dvec3 base = glm::normalize(glm::dvec3(0.5, 0, 0.8));
    std::size_t compared = 0;
    for (std::size_t i = 0; i < both.normal.size(); ++i) {
        if (!(both.color[i].a > 0)) continue;
        EXPECT_EQ(bumped.normal[i], with_flat.normal[i]);
        // n − ∇h by what is left of it in the plane that the normal is perpendicular to.
        const glm::dvec3 n(bumped.normal[i]);
        const glm::dvec3 gradient(-n.x / n.z, -n.y / n.z, 0);
        const glm::dvec3 bent = base - (gradient - base * glm::dot(base, gradient));
        EXPECT_LT(degrees_between(bent, glm::dvec3(both.normal[i])), 0.01);
        ++compared;
    }
    EXPECT_GT(compared, 1000u);
}

// Flat shading and meshes without normals show none.
TEST(BumpMaps, AreReadWhereThereAreNormalsToBend) {
    const std::vector<float> h = some_heights(16);
    prep::PreparedScene scene =
        sheared_square(glm::dmat2(0.5), {0.5, 0.5}, heights_of(4, 4, h), {});
    rast::RenderRequest request = front_request({1, 1, 2});
    const rast::Frame bumped = draw(scene, request);
    EXPECT_TRUE(rast::plan(scene, request)->warnings.empty()) << "tangents are not needed";
    prep::PreparedScene bare = scene;
    bare.scene.materials[0].bump_map = {};
    EXPECT_NE(differing(bumped, draw(bare, request)), "");
    for (const rast::Shading shading :
         {rast::Shading::flat, rast::Shading::gouraud, rast::Shading::phong}) {
        request.shading = shading;
        EXPECT_EQ(differing(draw(scene, request), draw(bare, request)), "") << int(shading);
    }
    request.shading = rast::Shading::normal_mapped;
    scene.meshes[0].normals.clear();
    bare.meshes[0].normals.clear();
    EXPECT_EQ(differing(draw(scene, request), draw(bare, request)), "");
}

TEST(BumpMaps, HaveTheSlopesThatTheirWrappingGives) {
    prep::Image image{4, 1, 2, {}};
    for (const float h : {1.0f, 2.0f, 5.0f, 3.0f})
        image.pixels.insert(image.pixels.end(), {h, 9.0f});
    using Values = std::vector<float>;
    // Over a unit of the heights' own picture.
    const auto along_u = [&](prep::Wrap wrap) {
        const rast::detail::Slopes slopes =
            rast::detail::slopes_of(image, {.wrap_u = wrap, .wrap_v = prep::Wrap::repeat});
        Values values;
        for (std::uint32_t x = 0; x < slopes.image.width; ++x) {
            values.push_back(slopes.image.at(x, 0)[0] * 4 / float(slopes.image.width));
            EXPECT_EQ(slopes.image.at(x, 0)[1], 0);
        }
        EXPECT_EQ(slopes.image.height, 1u);
        return values;
    };
    // Differences over two texels, a fourth of a unit each. In a mirrored copy slopes turn.
    const Values repeated{(2 - 3) * 2, (5 - 1) * 2, (3 - 2) * 2, (1 - 5) * 2};
    const Values mirrored{2, 8, 2, -4, 4, -2, -8, -2}, clamped{2, 8, 2, -4};
    const auto expect = [](const Values& values, const Values& expected) {
        ASSERT_EQ(values.size(), expected.size());
        for (std::size_t i = 0; i < values.size(); ++i)
            EXPECT_NEAR(values[i], expected[i], 1e-6) << i;
    };
    expect(along_u(prep::Wrap::repeat), repeated);
    expect(along_u(prep::Wrap::mirror), mirrored);
    expect(along_u(prep::Wrap::clamp), clamped);
    expect(along_u(prep::Wrap::border), clamped);
    const Values beside_none{0, 8, 0, -4};
    image.pixels[2] = std::numeric_limits<float>::quiet_NaN();
    expect(along_u(prep::Wrap::clamp), beside_none);
    image.pixels[2] = -std::numeric_limits<float>::infinity();
    expect(along_u(prep::Wrap::clamp), beside_none);
    // Sums of what filters read would leave float's range.
    image.pixels[2] = 0.8e38f;
    expect(along_u(prep::Wrap::clamp), beside_none);
}

// A ramp of one height a unit: the plane of its first copy leans back in a mirrored one.
TEST(BumpMaps, TurnInMirroredCopies) {
    std::vector<float> ramp;
    for (int x = 0; x < 32; ++x) ramp.push_back((float(x) + 0.5f) / 32);
    // u from 0 to 2 over the square's width of 2, so that a unit of u is one of x.
    const glm::dmat2 place(1, 0, 0, 1);
    for (const prep::Wrap wrap : {prep::Wrap::repeat, prep::Wrap::mirror}) {
        prep::TextureRef bump;
        bump.strength = 0.5f;
        prep::PreparedScene scene = sheared_square(place, {1, 0.5}, heights_of(32, 1, ramp), bump);
        scene.scene.textures[0].wrap_u = scene.scene.textures[0].wrap_v = wrap;
        rast::RenderRequest request = front_request({0, 0, 1});
        request.keep_normals = true;
        for (const rast::TextureFilter filter :
             {rast::TextureFilter::nearest, rast::TextureFilter::bilinear,
              rast::TextureFilter::bicubic, rast::TextureFilter::trilinear,
              rast::TextureFilter::ewa}) {
            request.filter = filter;
            const rast::Frame frame = draw(scene, request);
            const double beyond = wrap == prep::Wrap::mirror ? -0.5 : 0.5;
            for (const std::uint32_t x : {8u, 12u, 27u, 32u}) {
                const double slope = x < 20 ? 0.5 : beyond;
                const glm::dvec3 n(frame.normal[20 * frame.width + x]);
                EXPECT_LT(degrees_between(n, {-slope, 0, 1}), 0.1)
                    << "column " << x << ", wrap " << int(wrap) << ", filter " << int(filter);
            }
        }
    }
}

// A slope of a half along u and v; beyond an edge that clamps the one across it is none.
TEST(BumpMaps, AreLevelBeyondTheEdgesOfMapsThatClamp) {
    std::vector<float> slant;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) slant.push_back((float(x) + float(y) + 1) / 32);
    // u from 0 to 2 and v from -0.5 to 1.5 over the square's 2 by 2.
    prep::TextureRef bump;
    bump.strength = 0.5f;
    prep::PreparedScene scene =
        sheared_square(glm::dmat2(1.0), {1, 0.5}, heights_of(32, 32, slant), bump);
    for (const bool u : {true, false})
        for (const bool v : {true, false})
            for (const rast::TextureFilter filter :
                 {rast::TextureFilter::nearest, rast::TextureFilter::bilinear,
                  rast::TextureFilter::trilinear, rast::TextureFilter::ewa}) {
                scene.scene.textures[0].wrap_u = u ? prep::Wrap::clamp : prep::Wrap::repeat;
                scene.scene.textures[0].wrap_v = v ? prep::Wrap::clamp : prep::Wrap::repeat;
                rast::RenderRequest request = front_request({0, 0, 1});
                request.keep_normals = true;
                request.filter = filter;
                const rast::Frame frame = draw(scene, request);
                for (const std::uint32_t x : {8u, 12u, 27u, 32u})
                    for (const std::uint32_t y : {4u, 17u, 23u, 35u}) {
                        const double du = u && x > 20 ? 0 : 0.5;
                        const double dv = v && (y < 10 || y > 30) ? 0 : 0.5;
                        const glm::dvec3 n(frame.normal[y * frame.width + x]);
                        EXPECT_LT(degrees_between(n, {-du, -dv, 1}), 0.1)
                            << x << ", " << y << (u ? ", u" : "") << (v ? ", v" : "") << ", filter "
                            << int(filter);
                    }
            }
}

// A light that shines along a surface reaches what bumps turn towards it.
TEST(BumpMaps, AreLitByLightsBehindTheSurface) {
    const std::vector<float> h = some_heights(16);
    prep::PreparedScene scene =
        sheared_square(glm::dmat2(0.5), {0.5, 0.5}, heights_of(4, 4, h), {});
    rast::RenderRequest request = front_request({0, 0, 1});
    request.cull = rast::Cull::back;
    request.lights = {directional({1, 0, -0.1}, {1, 1, 1}), directional({0, 0, 1}, {0.1f, 0, 0})};
    const rast::Frame bumped = draw(scene, request);
    double brightest = 0;
    for (const glm::vec4& c : bumped.color) brightest = std::max(brightest, double(c.g));
    EXPECT_GT(brightest, 0.1);
}

// A picture that is both colour and heights is read as both.
TEST(BumpMaps, MayBeThePictureThatColoursTheSurface) {
    prep::Image image{4, 4, 3, {}};
    for (const float value : some_heights(16))
        for (int k = 0; k < 3; ++k) image.pixels.push_back(value);
    prep::ImageRef both;
    both.name = "both.png";
    both.bytes = *prep::encode_png(image);
    prep::PreparedScene scene = sheared_square(glm::dmat2(0.5), {0.5, 0.5}, both, {});
    scene.scene.materials[0].bump_map.strength = 0.1f;
    scene.scene.materials[0].diffuse_map.texture = 0;
    prep::PreparedScene apart = scene;
    apart.scene.textures.push_back(apart.scene.textures[0]);
    apart.scene.images.push_back(both);
    apart.scene.textures[1].image = 1;
    apart.scene.materials[0].diffuse_map.texture = 1;
    rast::RenderRequest request = front_request({1, 1, 2});
    EXPECT_EQ(differing(draw(scene, request), draw(apart, request)), "");
}

}  // namespace
