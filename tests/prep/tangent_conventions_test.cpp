// What a mesh's own tangents and its normal map say about how they were made.
#include "prep/tangent_conventions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "prep/prepare.h"
#include "shapes.h"
#include "shared_data.h"

namespace {

using prep::GreenDirection;
using prep::Image;
using prep::TangentMethod;
using prep::TangentSign;

// Heights with bumps of several sizes, as the normals that glTF asks for: green up.
Image bumpy_map(std::uint32_t size, double strength) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> anywhere(0, 1);
    std::vector<double> heights(std::size_t(size) * size, 0.0);
    for (int bump = 0; bump < 60; ++bump) {
        const double cx = anywhere(random) * size, cy = anywhere(random) * size;
        const double radius = (0.02 + 0.06 * anywhere(random)) * size;
        for (std::uint32_t y = 0; y < size; ++y)
            for (std::uint32_t x = 0; x < size; ++x) {
                const double dx = (x - cx) / radius, dy = (y - cy) / radius;
                heights[std::size_t(y) * size + x] += radius * std::exp(-dx * dx - dy * dy);
            }
    }
    Image map{size, size, 3, {}, false};
    for (std::uint32_t y = 0; y < size; ++y) {
        for (std::uint32_t x = 0; x < size; ++x) {
            const auto height = [&](std::uint32_t i, std::uint32_t j) {
                return heights[std::size_t(std::min(j, size - 1)) * size + std::min(i, size - 1)];
            };
            const double right = strength * (height(x + 1, y) - height(x, y));
            const double down = strength * (height(x, y + 1) - height(x, y));
            const double length = std::sqrt(right * right + down * down + 1);
            for (const double n : {-right / length, down / length, 1 / length})
                map.pixels.push_back(float(std::round((n * 0.5 + 0.5) * 255) / 255));
        }
    }
    return map;
}

Image flipped_green(Image map) {
    for (std::size_t i = 1; i < map.pixels.size(); i += map.channels)
        map.pixels[i] = 1 - map.pixels[i];
    return map;
}

TEST(GreenChannel, TellsUpFromDown) {
    for (const double strength : {0.1, 0.5, 1.5}) {
        const Image up = bumpy_map(128, strength);
        const auto told = prep::green_channel(up), other = prep::green_channel(flipped_green(up));
        EXPECT_EQ(int(told.direction), int(GreenDirection::up)) << strength;
        EXPECT_EQ(int(other.direction), int(GreenDirection::down)) << strength;
        EXPECT_GT(told.correlation, 0.8) << strength;
        EXPECT_NEAR(told.correlation, -other.correlation, 0.01) << strength;
    }
}

TEST(GreenChannel, LeavesOpenWhatIsNotThere) {
    Image flat{64, 64, 3, {}, false};
    for (int i = 0; i < 64 * 64; ++i) flat.pixels.insert(flat.pixels.end(), {0.5f, 0.5f, 1.0f});
    EXPECT_EQ(int(prep::green_channel(flat).direction), int(GreenDirection::undecided));

    // Ridges along an axis look the same either way.
    Image ridges = flat;
    for (std::size_t i = 0; i < 64 * 64; ++i)
        ridges.pixels[3 * i] = 0.5f + 0.3f * std::sin(0.7f * float(i % 64));
    EXPECT_EQ(int(prep::green_channel(ridges).direction), int(GreenDirection::undecided));

    std::mt19937 random(5);
    Image noise = flat;
    for (std::size_t i = 0; i < noise.pixels.size(); ++i)
        if (i % 3 != 2) noise.pixels[i] = 0.5f + 0.2f * (float(random() % 1000) / 1000 - 0.5f);
    EXPECT_EQ(int(prep::green_channel(noise).direction), int(GreenDirection::undecided));

    Image broken = bumpy_map(32, 0.5);
    for (float& value : broken.pixels) value = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(int(prep::green_channel(broken).direction), int(GreenDirection::undecided));
    EXPECT_EQ(int(prep::green_channel(Image()).direction), int(GreenDirection::undecided));
    const Image grey{4, 4, 1, std::vector<float>(16, 0.5f), false};
    EXPECT_EQ(int(prep::green_channel(grey).direction), int(GreenDirection::undecided));
}

double covariance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

// Which way green points is plain where the heights are at hand.
TEST(GreenChannel, AgreesWithTheHeightsBesideTheMap) {
    MESHPREP_REQUIRE_SHARED(shared);
    const struct {
        const char *normals, *heights;
    } pairs[] = {
        {"floor_tiles/floor_tiles_normalmap.jpg", "floor_tiles/floor_tiles_bumpmap.png"},
        {"seaside-rocks01/seaside-rocks01-normal.jpg",
         "seaside-rocks01/seaside-rocks01-height.jpg"},
        {"parallax_cube/cube_normal.png", "parallax_cube/cube_depth.png"},
    };
    for (const auto& pair : pairs) {
        SCOPED_TRACE(pair.normals);
        const auto map = prep::load_image(shared / "corpus" / pair.normals);
        const auto heights = prep::load_image(shared / "corpus" / pair.heights);
        ASSERT_TRUE(map.has_value() && heights.has_value());
        const auto height = [&](std::uint32_t x, std::uint32_t y) {
            return double(
                *heights->at(x * heights->width / map->width, y * heights->height / map->height));
        };
        std::vector<double> red, green, falls_right, rises_down;
        for (std::uint32_t y = 8; y + 8 < map->height; y += 2) {
            for (std::uint32_t x = 8; x + 8 < map->width; x += 2) {
                red.push_back(2.0 * double(map->at(x, y)[0]) - 1);
                green.push_back(2.0 * double(map->at(x, y)[1]) - 1);
                falls_right.push_back(height(x - 4, y) - height(x + 4, y));
                rises_down.push_back(height(x, y + 4) - height(x, y - 4));
            }
        }
        // A map of depths turns both signs round.
        const bool up = covariance(red, falls_right) * covariance(green, rises_down) > 0;
        EXPECT_EQ(int(prep::green_channel(*map).direction),
                  int(up ? GreenDirection::up : GreenDirection::down));
    }
}

prep::Mesh sphere_with_tangents() {
    prep::Mesh mesh = shapes::uv_sphere(24, 12);
    mesh.normals.values = mesh.positions;
    mesh.normals.indices = mesh.corner_vertices;
    prep::CornerLayer<glm::vec2>& uv = mesh.uvs.emplace_back();
    for (const glm::vec3& p : mesh.positions) {
        // From one side and from the other: mirrored halves.
        uv.values.push_back({0.5f + 0.4f * p.x, 0.5f - 0.4f * p.y});
    }
    uv.indices = mesh.corner_vertices;
    auto tangents = prep::corner_tangents(prep::TangentInput(prep::MeshView(mesh)));
    EXPECT_TRUE(tangents.has_value());
    mesh.tangents = tangents->tangents;
    return mesh;
}

// Each about its normal.
void turn(prep::Mesh& mesh, double degrees) {
    prep::CornerLayer<glm::vec4> turned;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::vec4 t = mesh.tangents.values[mesh.tangents.indices[c]];
        const glm::dvec3 n(mesh.normals.values[mesh.normals.indices[c]]), d(t);
        const double a = degrees * 3.14159265358979 / 180 * (c % 2 ? 1 : -1);
        turned.values.push_back(
            glm::vec4(glm::vec3(std::cos(a) * d + std::sin(a) * glm::cross(n, d)), t.w));
        turned.indices.push_back(c);
    }
    mesh.tangents = turned;
}

TEST(TangentConventions, KnowsItsOwn) {
    const auto told = prep::tangent_conventions(sphere_with_tangents());
    EXPECT_EQ(int(told.method), int(TangentMethod::mikktspace));
    EXPECT_EQ(int(told.sign), int(TangentSign::as_gltf));
    EXPECT_GT(told.compared, 800u);
    EXPECT_EQ(told.identical, told.compared);
    EXPECT_EQ(told.same_sign, told.compared);
    EXPECT_EQ(told.largest_degrees, 0.0);
}

TEST(TangentConventions, ToleratesBytesAndNoMore) {
    const struct {
        double degrees;
        TangentMethod method;
    } cases[] = {{0.7, TangentMethod::mikktspace},
                 {1.5, TangentMethod::similar},
                 {4.5, TangentMethod::similar},
                 {6, TangentMethod::other},
                 {90, TangentMethod::other}};
    for (const auto& c : cases) {
        prep::Mesh mesh = sphere_with_tangents();
        turn(mesh, c.degrees);
        const auto told = prep::tangent_conventions(mesh);
        EXPECT_EQ(int(told.method), int(c.method)) << c.degrees;
        EXPECT_NEAR(told.median_degrees, c.degrees, 1e-3);
        EXPECT_EQ(int(told.sign), int(TangentSign::as_gltf)) << c.degrees;
    }
}

TEST(TangentConventions, SeesInvertedAndMixedSigns) {
    prep::Mesh mesh = sphere_with_tangents();
    for (glm::vec4& t : mesh.tangents.values) t.w = -t.w;
    const auto inverted = prep::tangent_conventions(mesh);
    EXPECT_EQ(int(inverted.sign), int(TangentSign::inverted));
    EXPECT_EQ(inverted.same_sign, 0u);
    EXPECT_EQ(int(inverted.method), int(TangentMethod::mikktspace));
    // All of one sign, though half of the surface is mirrored.
    for (glm::vec4& t : mesh.tangents.values) t.w = 1;
    EXPECT_EQ(int(prep::tangent_conventions(mesh).sign), int(TangentSign::mixed));
}

TEST(TangentConventions, SeesTangentsTheOtherWayRound) {
    prep::Mesh mesh = sphere_with_tangents();
    turn(mesh, 180);
    const auto told = prep::tangent_conventions(mesh);
    EXPECT_EQ(told.opposite, told.compared);
    EXPECT_EQ(int(told.method), int(TangentMethod::other));
}

TEST(TangentConventions, LeavesOpenWhatIsNotThere) {
    EXPECT_EQ(prep::tangent_conventions(prep::Mesh()).compared, 0u);
    prep::Mesh mesh = sphere_with_tangents();
    mesh.uvs.clear();
    EXPECT_EQ(int(prep::tangent_conventions(mesh).method), int(TangentMethod::undecided));
    mesh = sphere_with_tangents();
    EXPECT_EQ(prep::tangent_conventions(mesh, 5).compared, 0u);
    mesh.tangents.values.assign(mesh.tangents.values.size(),
                                glm::vec4(std::numeric_limits<float>::quiet_NaN()));
    EXPECT_EQ(prep::tangent_conventions(mesh).compared, 0u);
    mesh = sphere_with_tangents();
    mesh.uvs[0].values.assign(mesh.uvs[0].values.size(), glm::vec2(0));
    EXPECT_EQ(prep::tangent_conventions(mesh).compared, 0u);
}

// Triangles in the plane z = 0, u along x and v down: MikkTSpace's tangent is (1, 0, 0, 1) in
// glTF's convention. Each corner has one of its own.
prep::Mesh flat(std::size_t triangles) {
    prep::Mesh mesh;
    mesh.uvs.resize(1);
    for (std::uint32_t c = 0; c < 3 * triangles; ++c) {
        const glm::vec3 p(float(c / 3) + (c % 3 == 1 ? 1.0f : 0.0f), c % 3 == 2 ? 1 : 0, 0);
        mesh.positions.push_back(p);
        mesh.corner_vertices.push_back(c);
        if (c % 3 == 2) mesh.face_offsets.push_back(c + 1);
        mesh.uvs[0].values.push_back({p.x / 64, 1 - p.y / 64});
        mesh.tangents.values.push_back({1, 0, 0, 1});
    }
    mesh.uvs[0].indices = mesh.tangents.indices = mesh.corner_vertices;
    mesh.normals.values = {{0, 0, 1}};
    mesh.normals.indices.assign(3 * triangles, 0);
    return mesh;
}
// The first `count` tangents turned about z.
prep::Mesh flat_turned(std::size_t triangles, std::size_t count, double degrees) {
    prep::Mesh mesh = flat(triangles);
    const double a = degrees * 3.14159265358979 / 180;
    for (std::size_t c = 0; c < count; ++c)
        mesh.tangents.values[c] = glm::vec4(std::cos(a), std::sin(a), 0, 1);
    return mesh;
}

TEST(TangentConventions, KnowsThePlanesOwnDirection) {
    const auto told = prep::tangent_conventions(flat(10));
    EXPECT_EQ(told.compared, 30u);
    EXPECT_EQ(told.identical, 30u);
    EXPECT_EQ(told.same_sign, 30u);
    EXPECT_EQ(int(told.method), int(TangentMethod::mikktspace));
    EXPECT_EQ(int(told.sign), int(TangentSign::as_gltf));
    // At right angles nothing agrees; as many of both signs is neither convention.
    prep::Mesh mesh = flat_turned(10, 30, 90);
    EXPECT_NEAR(prep::tangent_conventions(mesh).median_degrees, 90, 1e-4);
    EXPECT_EQ(prep::tangent_conventions(mesh).within_5, 0u);
}

TEST(TangentConventions, VerdictsTakeTheSharesTheyName) {
    const auto method = [](std::size_t turned, double degrees) {
        return prep::tangent_conventions(flat_turned(100, turned, degrees)).method;
    };
    // Of 300 corners: 99 % within 1°, then 95 % within 5°.
    EXPECT_EQ(int(method(3, 2)), int(TangentMethod::mikktspace));
    EXPECT_EQ(int(method(4, 2)), int(TangentMethod::similar));
    EXPECT_EQ(int(method(15, 30)), int(TangentMethod::similar));
    EXPECT_EQ(int(method(16, 30)), int(TangentMethod::other));
    EXPECT_EQ(int(method(300, 0.99)), int(TangentMethod::mikktspace));
    EXPECT_EQ(int(method(300, 1.01)), int(TangentMethod::similar));
    EXPECT_EQ(int(method(300, 4.99)), int(TangentMethod::similar));
    EXPECT_EQ(int(method(300, 5.01)), int(TangentMethod::other));
    EXPECT_EQ(prep::tangent_conventions(flat_turned(100, 7, 174)).opposite, 0u);
    EXPECT_EQ(prep::tangent_conventions(flat_turned(100, 7, 176)).opposite, 7u);
    const auto sign = [](std::size_t turned) {
        prep::Mesh mesh = flat(10);
        for (std::size_t c = 0; c < turned; ++c) mesh.tangents.values[c].w = -1;
        return prep::tangent_conventions(mesh).sign;
    };
    EXPECT_EQ(int(sign(3)), int(TangentSign::as_gltf));  // of 30
    EXPECT_EQ(int(sign(4)), int(TangentSign::mixed));
    EXPECT_EQ(int(sign(26)), int(TangentSign::mixed));
    EXPECT_EQ(int(sign(27)), int(TangentSign::inverted));
    // Nine corners are too few to tell by, twelve are not.
    EXPECT_EQ(int(prep::tangent_conventions(flat(3)).method), int(TangentMethod::undecided));
    EXPECT_EQ(int(prep::tangent_conventions(flat(3)).sign), int(TangentSign::undecided));
    EXPECT_EQ(prep::tangent_conventions(flat(3)).compared, 9u);
    EXPECT_EQ(int(prep::tangent_conventions(flat(4)).method), int(TangentMethod::mikktspace));
}

TEST(TangentConventions, ComparesOnlyWhatIsATangentAndHasAGradient) {
    prep::Mesh mesh = flat(10);
    mesh.tangents.values[0] = {0, 0, 0, 1};
    mesh.tangents.values[1] = {1, 0, 0, 0};
    mesh.tangents.values[2].x = std::numeric_limits<float>::infinity();
    mesh.tangents.indices[3] = prep::no_index;
    for (std::size_t c = 6; c < 9; ++c) mesh.uvs[0].values[c] = {0.5f, 0.5f};  // a whole triangle
    mesh.tangents.values[9] = {2, 0, 0, 1};  // a direction, but not the same bits
    const auto told = prep::tangent_conventions(mesh);
    EXPECT_EQ(told.compared, 30u - 3 - 1 - 3);
    EXPECT_EQ(told.identical, told.compared - 1);
    EXPECT_EQ(told.within_1, told.compared);
}

// Heights h = k · (x − middle) · up have slopes k · up to the right and k · (x − middle) upwards,
// whose cross derivatives are both k: correlation 1, or −1 where green is turned. It is turned to
// the right of the middle, where its slope is 0.
Image saddle(std::uint32_t size, double k, std::uint32_t middle) {
    Image map{size, size, 3, {}, false};
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            const double up = size / 2.0 - y, right = double(x) - middle;
            const double p = k * up, q = k * right * (x < middle ? 1 : -1);
            const double length = std::sqrt(p * p + q * q + 1);
            for (const double n : {-p / length, -q / length, 1 / length})
                map.pixels.push_back(float(0.5 + 0.5 * n));
        }
    return map;
}

TEST(GreenChannel, CorrelationIsTheShareOfWhatPointsUpLessTheRest) {
    for (const auto& [middle, direction] : {std::pair{96u, GreenDirection::up},
                                            {80u, GreenDirection::undecided},
                                            {48u, GreenDirection::undecided},
                                            {32u, GreenDirection::down}}) {
        const auto told = prep::green_channel(saddle(128, 0.02, middle));
        const double share = middle / 128.0;
        EXPECT_EQ(int(told.direction), int(direction)) << middle;
        // The columns beside the middle have a slope of either sign.
        EXPECT_NEAR(told.correlations[0], 2 * share - 1, 0.03) << middle;
        EXPECT_NEAR(told.correlations[1], 2 * share - 1, 0.06) << middle;
    }
}

TEST(GreenChannel, CountsTheTexelsThatHaveASay) {
    const auto told = prep::green_channel(saddle(128, 0.02, 128));
    EXPECT_EQ(int(told.direction), int(GreenDirection::up));
    EXPECT_NEAR(told.correlation, 1, 1e-3);
    // All but the rim at full size, at half …; of 8 × 8 too few are left.
    for (std::size_t s = 0; s < 4; ++s) {
        const std::uint64_t side = (128u >> s) - 2;
        EXPECT_EQ(told.texels[s], side * side) << s;
        EXPECT_NEAR(told.correlations[s], 1, 1e-3) << s;
    }
    EXPECT_EQ(told.texels[4], 0u);
    EXPECT_EQ(told.correlations[4], 0.0);
    // Slopes that change by less than 1/50 over two texels are rounding: 2 k + 2 k.
    EXPECT_EQ(prep::green_channel(saddle(128, 0.0049, 128)).texels[0], 0u);
    EXPECT_EQ(prep::green_channel(saddle(128, 0.0052, 128)).texels[0], 126u * 126u);
    // Steeper than four is no surface: a band around the middle is left.
    const auto steep = prep::green_channel(saddle(128, 0.125, 64));
    EXPECT_LT(steep.texels[0], 64u * 64);
    EXPECT_GT(steep.texels[0], 58u * 58);
}

TEST(TangentConventions, CountsBitsAndAngles) {
    // A hundredth of a degree off: within every tolerance, but no bits are the same.
    prep::Mesh mesh = sphere_with_tangents();
    turn(mesh, 0.005);
    auto told = prep::tangent_conventions(mesh);
    EXPECT_EQ(told.identical, 0u);
    EXPECT_EQ(told.within_1, told.compared);
    EXPECT_EQ(int(told.method), int(TangentMethod::mikktspace));
    // Four corners in ten by 0.5°, the others by 2°, a handful by 178° and 172°.
    mesh = sphere_with_tangents();
    const prep::Mesh exact = mesh;
    std::uint64_t near = 0, middle = 0, opposite = 0, wide = 0;
    std::vector<prep::Mesh> turned(4, exact);
    const double degrees[] = {0.5, 2, 178, 172};
    for (int k = 0; k < 4; ++k) turn(turned[std::size_t(k)], degrees[k]);
    mesh.tangents = turned[1].tangents;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const std::size_t k = c % 50 == 0 ? 2 : c % 50 == 1 ? 3 : c % 10 < 4 ? 0 : 1;
        mesh.tangents.values[mesh.tangents.indices[c]] =
            turned[k].tangents.values[turned[k].tangents.indices[c]];
        ++(k == 0 ? near : k == 1 ? middle : k == 2 ? opposite : wide);
    }
    told = prep::tangent_conventions(mesh);
    ASSERT_EQ(told.compared, near + middle + opposite + wide);
    EXPECT_NEAR(told.median_degrees, 2, 1e-3);
    EXPECT_NEAR(told.largest_degrees, 178, 1e-3);
    EXPECT_EQ(told.within_1, near);
    EXPECT_EQ(told.within_5, near + middle);
    EXPECT_EQ(told.opposite, opposite);
    EXPECT_EQ(told.identical, 0u);
}

// Waves of 32 texels that point one way, on swells that point the other: at a sixteenth of the
// size two texels are a wave, and only the swell is left. The mean alone would say up.
TEST(GreenChannel, ScalesThatContradictEachOtherLeaveItOpen) {
    constexpr std::uint32_t size = 384;
    const double pi = std::acos(-1.0);
    const auto map_of = [&](double waves, double swell) {
        Image map{size, size, 3, {}, false};
        const auto slope = [&](double along, double length) {
            return std::sin(2 * pi * along / length);
        };
        for (std::uint32_t y = 0; y < size; ++y) {
            for (std::uint32_t x = 0; x < size; ++x) {
                // Heights that go with x + y: both slopes are the same, of which green is shown
                // the other way round where it points down.
                const double fine = waves * slope(x + y, 32), coarse = swell * slope(x + y, 200);
                const double p = fine + coarse, q = fine - coarse;
                const double length = std::sqrt(p * p + q * q + 1);
                for (const double n : {p / length, -q / length, 1 / length})
                    map.pixels.push_back(float(n * 0.5 + 0.5));
            }
        }
        return map;
    };
    const auto up = prep::green_channel(map_of(0.4, 0));
    EXPECT_EQ(int(up.direction), int(GreenDirection::up));
    const auto down = prep::green_channel(map_of(0, 0.4));
    EXPECT_EQ(int(down.direction), int(GreenDirection::down));
    const auto both = prep::green_channel(map_of(0.3, 0.3));
    for (std::size_t scale = 0; scale < 4; ++scale) EXPECT_GT(both.correlations[scale], 0.3);
    EXPECT_LT(both.correlations[4], -0.3);
    EXPECT_GT(both.correlation, 0.3);
    EXPECT_EQ(int(both.direction), int(GreenDirection::undecided));
}

}  // namespace
