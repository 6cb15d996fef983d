// A sphere drawn with a material from MTL, and drawn again from the glTF file that was written of
// it: the same picture, with the exact values in extras and by glTF's own alone.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "builders.h"
#include "mesh_files.h"
#include "prep/image.h"
#include "prep/load.h"
#include "prep/save.h"

namespace {

void write_sphere(const std::filesystem::path& path) {
    const prep::VertexMesh s = test::sphere(48, 32);
    std::string text = "mtllib a.mtl\nusemtl m\n";
    char line[256];
    for (std::size_t v = 0; v < s.positions.size(); ++v) {
        const glm::vec3 &p = s.positions[v], &n = s.normals[v];
        std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\nvn %.9g %.9g %.9g\nvt %.9g %.9g\n",
                      double(p.x), double(p.y), double(p.z), double(n.x), double(n.y), double(n.z),
                      double(s.uvs[0][v].x), double(1 - s.uvs[0][v].y));
        text += line;
    }
    for (std::size_t i = 0; i < s.indices.size(); i += 3) {
        text += 'f';
        for (std::size_t k = 0; k < 3; ++k) {
            const std::string n = std::to_string(s.indices[i + k] + 1);
            text.append(" ").append(n).append("/").append(n).append("/").append(n);
        }
        text += '\n';
    }
    test::write_text(path, text);
}

prep::PreparedScene prepared(const std::filesystem::path& path) {
    auto scene = prep::load_scene(path);
    EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    auto made = prep::prepare(*std::move(scene));
    EXPECT_TRUE(made.has_value());
    return *std::move(made);
}

rast::Frame picture_of(const std::filesystem::path& path) {
    rast::RenderRequest request;
    request.width = request.height = 160;
    rast::LightInstance sun, fill, ambient;
    sun.kind = fill.kind = prep::LightKind::directional;
    sun.direction = glm::normalize(glm::dvec3(-1, -1, -1));
    sun.color = glm::vec3(0.8f);
    fill.direction = glm::normalize(glm::dvec3(1, 0.2, -0.5));
    fill.color = {0.1f, 0.15f, 0.2f};
    ambient.kind = prep::LightKind::ambient;
    ambient.color = glm::vec3(0.1f);
    request.lights = std::vector<rast::LightInstance>{sun, fill, ambient};
    return test::draw(prepared(path), request);
}

double level(float linear) {
    const double c = std::min(std::max(double(linear), 0.0), 1.0);
    return 255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055);
}

// The largest difference of a channel, in levels of an 8-bit picture before they are rounded.
double difference(const rast::Frame& a, const rast::Frame& b) {
    double most = a.color.size() == b.color.size() ? 0 : 255;
    for (std::size_t i = 0; i < std::min(a.color.size(), b.color.size()); ++i)
        for (int k = 0; k < 3; ++k)
            most = std::max(most, std::abs(level(a.color[i][k]) - level(b.color[i][k])));
    return most;
}

// With MESHPREP_KEEP_PICTURES=DIR the pictures are written there, to be looked at.
void keep(const rast::Frame& frame, const std::string& name) {
    const char* const dir = std::getenv("MESHPREP_KEEP_PICTURES");
    if (!dir) return;
    prep::Image image;
    image.width = frame.width;
    image.height = frame.height;
    image.channels = 3;
    for (const glm::vec4& c : frame.color)
        for (int k = 0; k < 3; ++k) image.pixels.push_back(float(level(c[k]) / 255));
    EXPECT_TRUE(prep::save_image(std::filesystem::path(dir) / (name + ".png"), image).has_value());
}

struct Look {
    const char* name;
    const char* mtl;
    bool within_limits = true;  // glTF's own values say it all
};
const Look looks[] = {
    {"Ordinary", "Kd 0.8 0.1 0.1\n"},
    {"FullHighlight", "Kd 0.7 0.2 0.1\nKs 1 1 1\nNs 32\n"},
    {"Sharp", "Kd 0.1 0.3 0.6\nKs 0.5 0.6 0.7\nNs 250\n"},
    {"Sharper", "Kd 0.1 0.3 0.6\nKs 0.9 0.9 0.9\nNs 1000\n"},
    {"Dim", "Kd 0.5 0.5 0.5\nKs 0.1 0.1 0.1\nNs 5\n"},
    {"Matte", "Kd 0.5 0.5 0.5\nKs 0 0 0\n"},
    {"Metal", "Kd 0.1 0.08 0.02\nKs 0.9 0.7 0.3\nNs 20\n"},
    {"Glowing", "Kd 0.1 0.1 0.1\nKe 0.2 0.1 0.4\nKs 0.3 0.3 0.3\nNs 60\n"},
    {"Wide", "Kd 0.9 0.2 0.2\nKs 1 1 1\nNs 4\n", false},
    {"Textured", "Kd 1 1 1\nKs 1 1 1\nNs 40\nmap_Kd color.png\nmap_Ks gloss.png\n"},
    {"PhysicalGold", "Kd 1 0.8 0.3\nPr 0.4\nPm 1\n"},
    {"PhysicalPlastic", "Kd 0.1 0.5 0.2\nPr 0.3\nPm 0\nNi 1.8\n"},
    {"PhysicalMaps", "Kd 0.8 0.8 0.8\nPr 1\nPm 1\nmap_Pr gloss.png\nmap_Pm metal.png\n"},
};

class MaterialSpheres : public testing::TestWithParam<Look> {};

TEST_P(MaterialSpheres, LookTheSameFromMtlAndFromGltf) {
    const Look& look = GetParam();
    const test::TempDir dir;
    const auto checker = [&](const char* file, const std::vector<float>& odd,
                             const std::vector<float>& even) {
        prep::Image image;
        image.width = 16;
        image.height = 8;
        image.channels = std::uint32_t(odd.size());
        for (std::uint32_t i = 0; i < 16 * 8; ++i) {
            const auto& color = (i + i / 16) % 2 ? odd : even;
            image.pixels.insert(image.pixels.end(), color.begin(), color.end());
        }
        ASSERT_TRUE(prep::save_image(dir / file, image).has_value());
    };
    checker("color.png", {0.8f, 0.2f, 0.2f}, {0.2f, 0.4f, 0.8f});
    checker("gloss.png", {0.8f, 0.8f, 0.8f}, {0.4f, 0.4f, 0.4f});
    checker("metal.png", {1}, {0});
    write_sphere(dir / "a.obj");
    test::write_text(dir / "a.mtl", std::string("newmtl m\n") + look.mtl);
    const rast::Frame from_mtl = picture_of(dir / "a.obj");
    keep(from_mtl, std::string(look.name) + "-mtl");
    // Something is to be seen, and the highlight is where it should be.
    double brightest = 0;
    for (const glm::vec4& c : from_mtl.color) brightest = std::max(brightest, level(c.r));
    EXPECT_GT(brightest, 60);

    const auto saved = prep::save_scene(prepared(dir / "a.obj"), dir / "b.gltf");
    ASSERT_TRUE(saved.has_value()) << prep::to_string(saved.error());
    const rast::Frame exact = picture_of(dir / "b.gltf");
    keep(exact, std::string(look.name) + "-gltf");
    EXPECT_LT(difference(from_mtl, exact), 0.01);

    auto json = nlohmann::json::parse(test::file_text(dir / "b.gltf"));
    for (auto& material : json["materials"]) material.erase("extras");
    test::write_text(dir / "c.gltf", json.dump());
    const rast::Frame own = picture_of(dir / "c.gltf");
    keep(own, std::string(look.name) + "-gltf-own");
    if (look.within_limits) {
        EXPECT_LT(difference(from_mtl, own), 1.0);
    }

    // And back to MTL.
    ASSERT_TRUE(prep::save_scene(prepared(dir / "b.gltf"), dir / "d.obj").has_value());
    EXPECT_LT(difference(from_mtl, picture_of(dir / "d.obj")), 1.0);
}

INSTANTIATE_TEST_SUITE_P(Looks, MaterialSpheres, testing::ValuesIn(looks),
                         [](const auto& look) { return std::string(look.param.name); });

}  // namespace
