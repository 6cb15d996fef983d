// Each effect in each way of drawing: the table of docs/rasterizer.md, cell by cell.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <string>

#include "shared_data.h"
#include "skip_stage.h"

namespace {

using prep::LightKind;
using prep::Material;
using test::light_of;

// How light at vertices goes with an effect.
enum class AtVertices {
    same,     // as Phong shading has it, under ambient light
    differs,  // from Phong shading, by at most so much
    unread,   // the picture is that without the effect
    refused   // it is another shading
};
struct Effect {
    const char* name;
    AtVertices at_vertices;
    float most;  // `differs`: of any channel
    void (*add)(prep::PreparedScene&, rast::RenderRequest&);
};

// Two by two texels.
std::uint32_t add_map(prep::PreparedScene& s, std::array<glm::vec3, 4> texels) {
    std::vector<float> values;
    for (const glm::vec3& t : texels) values.insert(values.end(), {t.x, t.y, t.z});
    prep::Texture texture;
    texture.image = std::uint32_t(s.scene.images.size());
    s.scene.images.push_back(test::float_picture(2, 2, 3, values));
    s.scene.textures.push_back(texture);
    return std::uint32_t(s.scene.textures.size() - 1);
}
constexpr std::array<glm::vec3, 4> spots = {
    {{0.2f, 0.9f, 0.6f}, {0.8f, 0.3f, 0.5f}, {0.9f, 0.7f, 0.2f}, {0.4f, 0.5f, 0.9f}}};
constexpr std::array<glm::vec3, 4> bumps = {
    {{0.6f, 0.5f, 0.9f}, {0.4f, 0.6f, 0.9f}, {0.5f, 0.4f, 0.95f}, {0.55f, 0.45f, 0.9f}}};

void set_lights(rast::RenderRequest& r, const rast::LightInstance& light) {
    r.lights = {light, light_of(LightKind::ambient, glm::vec3(0.1f), {}, {0, 0, -1})};
}

const Effect effects[] = {
    {"ambient light", AtVertices::same, 0,
     [](prep::PreparedScene&, rast::RenderRequest& r) {
         r.lights = {light_of(LightKind::ambient, glm::vec3(0.5f), {}, {0, 0, -1})};
     }},
    {"directional light", AtVertices::differs, 0.2f,
     [](prep::PreparedScene& s, rast::RenderRequest& r) {
         s.scene.materials[0].specular = glm::vec3(0);
         set_lights(r, light_of(LightKind::directional, glm::vec3(0.9f), {}, {1, -0.5, -1}));
     }},
    {"point light", AtVertices::differs, 0.2f,
     [](prep::PreparedScene& s, rast::RenderRequest& r) {
         s.scene.materials[0].specular = glm::vec3(0);
         set_lights(r, light_of(LightKind::point, glm::vec3(9), {1, 2, 2.5}, {0, 0, -1}, 6));
     }},
    {"spot light", AtVertices::differs, 0.5f,
     [](prep::PreparedScene& s, rast::RenderRequest& r) {
         s.scene.materials[0].specular = glm::vec3(0);
         set_lights(r, light_of(LightKind::spot, glm::vec3(9), {0.3, 0.2, 3.5}, {0, 0, -1}));
         (*r.lights)[0].inner_cone = 0.05f;
         (*r.lights)[0].outer_cone = 0.3f;
     }},
    {"highlights", AtVertices::differs, 0.7f,
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.scene.materials[0].specular = glm::vec3(0.8f);
         s.scene.materials[0].shininess = 30;
     }},
    {"metallic-roughness", AtVertices::differs, 0.7f,
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.scene.materials[0].metallic_roughness = true;
         s.scene.materials[0].metallic = 0.4f;
         s.scene.materials[0].roughness = 0.5f;
     }},
    {"face normals", AtVertices::refused, 0,
     [](prep::PreparedScene&, rast::RenderRequest& r) { r.shading = rast::Shading::flat; }},
    {"normal map, tangent space", AtVertices::unread, 0,
     [](prep::PreparedScene& s, rast::RenderRequest& r) {
         s.scene.materials[0].normal_map.texture = add_map(s, bumps);
         r.shading = rast::Shading::normal_mapped;
     }},
    {"normal map, object space", AtVertices::unread, 0,
     [](prep::PreparedScene& s, rast::RenderRequest& r) {
         s.scene.materials[0].normal_map.texture = add_map(s, bumps);
         s.scene.materials[0].normal_map_space = prep::NormalMapSpace::object;
         r.shading = rast::Shading::normal_mapped;
     }},
    {"diffuse map", AtVertices::same, 0,
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.scene.materials[0].diffuse_map.texture = add_map(s, spots);
     }},
    {"specular map", AtVertices::differs, 0.7f,
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.scene.materials[0].specular = glm::vec3(0.8f);
         s.scene.materials[0].specular_map.texture = add_map(s, spots);
     }},
    {"metallic-roughness map", AtVertices::differs, 2.0f,
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.scene.materials[0].metallic_roughness = true;
         s.scene.materials[0].roughness = 0.8f;
         s.scene.materials[0].metallic_roughness_map.texture = add_map(s, spots);
     }},
    {"occlusion map", AtVertices::same, 0,
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.scene.materials[0].occlusion_map.texture = add_map(s, spots);
     }},
    {"emissive map", AtVertices::same, 0,
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.scene.materials[0].emissive = glm::vec3(0.6f);
         s.scene.materials[0].emissive_map.texture = add_map(s, spots);
     }},
    {"vertex colours", AtVertices::same, 0,
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.meshes[0].colors.emplace_back();
         for (const glm::vec3& p : s.meshes[0].positions)
             s.meshes[0].colors[0].push_back(glm::vec4(0.5f * p + 0.5f, 1.0f));
     }},
    {"alpha mask", AtVertices::same, 0,
     [](prep::PreparedScene& s, rast::RenderRequest&) {
         s.scene.materials[0].alpha_mode = prep::AlphaMode::mask;
         s.meshes[0].colors.emplace_back();
         for (const glm::vec3& p : s.meshes[0].positions)
             s.meshes[0].colors[0].push_back(glm::vec4(1, 1, 1, 0.5f + 0.4f * p.x));
     }},
    {"unlit", AtVertices::same, 0,
     [](prep::PreparedScene& s, rast::RenderRequest&) { s.scene.materials[0].unlit = true; }},
};

struct Picture {
    prep::PreparedScene scene;
    rast::RenderRequest request;
};
// A ball of few triangles, so that many pixels lie inside one.
Picture bare() {
    prep::VertexMesh ball = test::sphere(12, 8);
    for (const glm::vec3& n : ball.normals)
        ball.tangents.push_back(
            glm::vec4(glm::normalize(glm::cross(glm::vec3(0.1f, 1, 0.2f), n)), 1.0f));
    Picture p{test::scene_of(std::move(ball), Material{}), test::stage_request()};
    p.request.shading = rast::Shading::phong;
    p.request.cull = rast::Cull::none;
    return p;
}
Picture picture_of(const Effect& effect) {
    Picture p = bare();
    effect.add(p.scene, p.request);
    return p;
}

rast::Frame draw(const Picture& p) {
    return test::draw_knowing_texels(p.scene, p.request).frame;
}

// Pixels whose triangle is that of all eight around them: it covers all of their samples.
std::vector<std::size_t> inner_pixels(Picture p) {
    p.request.keep_ids = true;
    const rast::Frame f = draw(p);
    std::vector<std::size_t> inner;
    for (std::uint32_t y = 1; y + 1 < f.height; ++y)
        for (std::uint32_t x = 1; x + 1 < f.width; ++x) {
            const std::size_t at = std::size_t(y) * f.width + x;
            bool same = f.triangle[at] != prep::no_index;
            for (std::size_t row = at - f.width; row <= at + f.width; row += f.width)
                for (std::size_t i = row - 1; i <= row + 1; ++i)
                    same = same && f.triangle[i] == f.triangle[at];
            if (same) inner.push_back(at);
        }
    return inner;
}
std::size_t differing_at(const std::vector<std::size_t>& pixels, const rast::Frame& a,
                         const rast::Frame& b) {
    return std::size_t(std::count_if(pixels.begin(), pixels.end(),
                                     [&](std::size_t i) { return a.color[i] != b.color[i]; }));
}

// Without it the picture is another one, in every way of drawing that has it.
TEST(Effects, ShowInEveryPicture) {
    for (const Effect& e : effects)
        EXPECT_NE(draw(picture_of(e)).color, draw(bare()).color) << e.name;
}

TEST(Effects, CropsArePartsOfTheWhole) {
    for (const Effect& e : effects) {
        Picture p = picture_of(e);
        const rast::Frame whole = draw(p);
        const rast::Crop crop{37, 19, 66, 60};
        p.request.crop = crop;
        const rast::Frame part = draw(p);
        for (std::uint32_t y = 0; y < crop.height; ++y)
            for (std::uint32_t x = 0; x < crop.width; ++x)
                ASSERT_EQ(part.color[std::size_t(y) * crop.width + x],
                          whole.color[std::size_t(y + crop.y) * whole.width + x + crop.x])
                    << e.name;
    }
}

TEST(Effects, BandsJoinToTheWhole) {
    for (const Effect& e : effects)
        for (const std::uint32_t rows : {64u, 13u}) {
            const Picture p = picture_of(e);
            auto drawing = test::draw_knowing_texels(p.scene, p.request);
            drawing.plan.band_rows = rows;
            std::vector<glm::vec4> joined;
            ASSERT_TRUE(rast::render_bands(
                p.scene, drawing.plan,
                [&](const rast::Frame& band, std::uint32_t) -> prep::Result<void> {
                    joined.insert(joined.end(), band.color.begin(), band.color.end());
                    return {};
                }));
            EXPECT_EQ(joined, drawing.frame.color) << e.name;
        }
}

TEST(Effects, SamplesInsideATriangleAreThePixelsColour) {
    for (const Effect& e : effects) {
        Picture p = picture_of(e);
        const std::vector<std::size_t> inner = inner_pixels(p);
        ASSERT_GT(inner.size(), 300u) << e.name;
        const rast::Frame one = draw(p);
        p.request.samples = 4;
        const rast::Frame four = draw(p);
        EXPECT_EQ(differing_at(inner, one, four), 0u) << e.name;
        EXPECT_NE(one.color, four.color) << e.name;
    }
}

TEST(Effects, ExactAreasInsideATriangleAreThePixelsColour) {
    for (const Effect& e : effects) {
        Picture p = picture_of(e);
        const std::vector<std::size_t> inner = inner_pixels(p);
        const rast::Frame one = draw(p);
        p.request.coverage = rast::Coverage::area;
        const rast::Frame areas = draw(p);
        EXPECT_EQ(differing_at(inner, one, areas), 0u) << e.name;
        EXPECT_NE(one.color, areas.color) << e.name;
    }
}

TEST(Effects, SupersamplingIsTheMeanOfTheFinerPicture) {
    for (const Effect& e : effects) {
        Picture p = picture_of(e);
        p.request.supersample = 2;
        const rast::Frame coarse = draw(p);
        p.request.supersample = 1;
        p.request.width *= 2;
        p.request.height *= 2;
        const rast::Frame fine = draw(p);
        for (std::uint32_t y = 0; y < coarse.height; ++y)
            for (std::uint32_t x = 0; x < coarse.width; ++x) {
                const std::size_t at = std::size_t(2 * y) * fine.width + 2 * x;
                glm::vec4 mean;
                for (int c = 0; c < 4; ++c)
                    mean[c] = float((double(fine.color[at][c]) + double(fine.color[at + 1][c]) +
                                     double(fine.color[at + fine.width][c]) +
                                     double(fine.color[at + fine.width + 1][c])) /
                                    4);
                ASSERT_EQ(coarse.color[std::size_t(y) * coarse.width + x], mean) << e.name;
            }
    }
}

TEST(Effects, BytesAreTheFloatsRounded) {
    for (const Effect& e : effects) {
        Picture p = picture_of(e);
        const rast::Frame floats = draw(p);
        p.request.pixels = rast::PixelFormat::bytes;
        const rast::Frame bytes = draw(p);
        ASSERT_EQ(bytes.bytes.size(), floats.color.size());
        for (std::size_t i = 0; i < bytes.bytes.size(); ++i)
            for (int c = 0; c < 4; ++c) {
                const float value = std::clamp(floats.color[i][c], 0.0f, 1.0f);
                ASSERT_EQ(bytes.bytes[i] >> (8 * c) & 0xffu, std::uint32_t(value * 255.0f + 0.5f))
                    << e.name;
            }
    }
}

float largest_difference(const rast::Frame& a, const rast::Frame& b) {
    float most = 0;
    for (std::size_t i = 0; i < a.color.size(); ++i)
        for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a.color[i][c] - b.color[i][c]));
    return most;
}

TEST(Effects, LightAtVerticesIsWhatTheTableSays) {
    for (const Effect& e : effects) {
        Picture p = picture_of(e);
        if (e.at_vertices == AtVertices::refused) {
            EXPECT_NE(p.request.shading, rast::Shading::phong) << e.name;
            continue;
        }
        if (e.at_vertices == AtVertices::same)
            p.request.lights = {light_of(LightKind::ambient, glm::vec3(0.5f), {}, {0, 0, -1})};
        const rast::Frame at_pixels = draw(p);
        p.request.shading = rast::Shading::gouraud;
        const rast::Frame at_vertices = draw(p);
        const float most = largest_difference(at_pixels, at_vertices);
        switch (e.at_vertices) {
            case AtVertices::same:
                EXPECT_EQ(at_vertices.color, at_pixels.color) << e.name;
                break;
            case AtVertices::unread: {
                Picture without = bare();
                without.request.shading = rast::Shading::gouraud;
                EXPECT_EQ(at_vertices.color, draw(without).color) << e.name;
                break;
            }
            case AtVertices::differs:
                EXPECT_LE(most, e.most) << e.name;
                EXPECT_GE(most, e.most / 10) << e.name;
                break;
            case AtVertices::refused:
                break;
        }
    }
}

// The page has these rows and says of them what is tested here.
TEST(Effects, AreTheRowsOfTheTable) {
    std::ifstream page(test::source_dir() / "docs/rasterizer.md");
    std::string line, rows;
    while (std::getline(page, line))
        if (line.starts_with("| ")) rows += line + "\n";
    // And no others.
    std::size_t at = rows.find("| effect |"), count = 0;
    ASSERT_NE(at, std::string::npos);
    for (at = rows.find('\n', at); rows.find(" | same inside | mean |", at) != std::string::npos;
         at = rows.find('\n', rows.find(" | same inside | mean |", at)))
        ++count;
    EXPECT_EQ(count, std::size(effects));
    for (const Effect& e : effects) {
        char most[40];
        std::snprintf(most, sizeof most, "differs ≤ %g", double(e.most));
        const std::string last = e.at_vertices == AtVertices::same      ? "same"
                                 : e.at_vertices == AtVertices::unread  ? "not read"
                                 : e.at_vertices == AtVertices::refused ? "refused"
                                                                        : most;
        const std::string row = std::string("| ") + e.name +
                                " | same | same | same inside | mean | same inside | rounded | " +
                                last + " |\n";
        EXPECT_NE(rows.find(row), std::string::npos) << row;
    }
}

}  // namespace
