// The plan: what it names, what is left out, and that leaving it out changes no pixel.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "builders.h"
#include "shading/texture.h"

namespace {

using rast::Shading;
using rast::TextureFilter;

prep::ImageRef picture_with(std::uint32_t size) {
    prep::Image image;
    image.width = image.height = size;
    image.channels = 3;
    for (std::uint32_t i = 0; i < size * size * 3; ++i)
        image.pixels.push_back(float((i * 2654435761u) >> 24) / 255.0f);
    prep::ImageRef ref;
    ref.name = "pattern.png";
    ref.bytes = *prep::encode_png(image);
    return ref;
}

prep::VertexMesh sphere_with_tangents() {
    prep::VertexMesh mesh = test::sphere(40, 30);
    for (const glm::vec3& n : mesh.normals)
        mesh.tangents.push_back(
            glm::vec4(glm::normalize(glm::cross(glm::vec3(0.1f, 1, 0.2f), n)), 1.0f));
    return mesh;
}

// Two spheres; with textures, the first's material has those.
prep::PreparedScene two_spheres(bool textured, bool metallic) {
    prep::Material material;
    material.metallic_roughness = metallic;
    material.metallic = 0.3f;
    material.roughness = 0.4f;
    prep::PreparedScene scene = test::scene_of(sphere_with_tangents(), material);
    prep::Node node = scene.scene.nodes[0];
    node.transform[3] = glm::dvec4(1.1, 0.3, -0.4, 1);
    scene.scene.nodes.push_back(node);
    if (!textured) return scene;
    for (const std::uint32_t size : {64u, 16u}) {
        prep::Texture texture;
        texture.image = std::uint32_t(scene.scene.images.size());
        scene.scene.images.push_back(picture_with(size));
        scene.scene.textures.push_back(texture);
    }
    scene.scene.materials[0].diffuse_map.texture = 0;
    scene.scene.materials[0].normal_map.texture = 1;
    return scene;
}

rast::RenderRequest small() {
    rast::RenderRequest request;
    request.width = 120;
    request.height = 90;
    return request;
}

bool same_colors(const rast::Frame& a, const rast::Frame& b) {
    return a.color.size() == b.color.size() && !a.color.empty() &&
           std::memcmp(a.color.data(), b.color.data(), a.color.size() * sizeof(glm::vec4)) == 0;
}

const rast::PlanStep& step(const rast::RenderPlan& plan, const std::string& name) {
    const auto found =
        std::find_if(plan.steps.begin(), plan.steps.end(),
                     [&](const rast::PlanStep& s) { return prep::name_of(s.kind) == name; });
    if (found == plan.steps.end()) throw std::runtime_error("no step " + name);
    return *found;
}

rast::RenderPlan planned(const prep::PreparedScene& scene, const rast::RenderRequest& request) {
    auto plan = rast::plan(scene, request);
    if (!plan) throw std::runtime_error(to_string(plan.error()));
    return *std::move(plan);
}

TEST(Pruning, ChangesNoBitOfThePicture) {
    for (const bool textured : {false, true})
        for (const bool metallic : {false, true}) {
            const prep::PreparedScene scene = two_spheres(textured, metallic);
            for (const Shading shading :
                 {Shading::flat, Shading::gouraud, Shading::phong, Shading::normal_mapped})
                for (const int samples : {1, 4}) {
                    rast::RenderRequest request = small();
                    request.shading = shading;
                    request.samples = samples;
                    const rast::Frame pruned = test::draw(scene, request);
                    request.prune = false;
                    const rast::Frame all = test::draw(scene, request);
                    EXPECT_TRUE(same_colors(pruned, all))
                        << textured << " " << metallic << " " << int(shading) << " " << samples;
                    EXPECT_GT(all.counters.texture_samples, pruned.counters.texture_samples);
                    EXPECT_GT(all.counters.buffer_bytes, pruned.counters.buffer_bytes);
                }
        }
}

TEST(Pruning, ChangesNoBitForAnyFilter) {
    const prep::PreparedScene scene = two_spheres(true, false);
    for (const TextureFilter filter :
         {TextureFilter::by_sampler, TextureFilter::nearest, TextureFilter::bilinear,
          TextureFilter::nearest_mip, TextureFilter::trilinear, TextureFilter::bicubic,
          TextureFilter::anisotropic, TextureFilter::ripmap, TextureFilter::ewa}) {
        rast::RenderRequest request = small();
        request.filter = filter;
        const rast::Frame pruned = test::draw(scene, request);
        request.prune = false;
        const rast::Frame all = test::draw(scene, request);
        EXPECT_TRUE(same_colors(pruned, all)) << int(filter);
        EXPECT_GE(all.counters.texture_levels, pruned.counters.texture_levels);
    }
}

TEST(Pruning, WithoutTexturesNoneIsReadOrSampled) {
    const rast::Frame frame = test::draw(two_spheres(false, false), small());
    EXPECT_GT(frame.counters.pixels_shaded, 1000u);
    EXPECT_EQ(frame.counters.textures_read, 0u);
    EXPECT_EQ(frame.counters.texture_samples, 0u);
    EXPECT_EQ(frame.counters.texture_levels, 0u);
    EXPECT_EQ(frame.counters.buffer_bytes, 120u * 90 * 16);
    // Meshes without UVs bind none, whatever their material says.
    prep::PreparedScene bare = two_spheres(true, false);
    bare.meshes[0].uvs.clear();
    const rast::Frame no_uvs = test::draw(bare, small());
    EXPECT_EQ(no_uvs.counters.texture_samples, 0u);
    EXPECT_EQ(no_uvs.counters.textures_read, 0u);
    // Switched off: not even read.
    rast::RenderRequest off = small();
    off.textures = false;
    EXPECT_EQ(test::draw(two_spheres(true, false), off).counters.textures_read, 0u);
}

// Nobody would be told of a file that nothing samples: the UVs that are missing are told instead.
TEST(Pruning, FilesOfMapsWithoutUvsAreNotRead) {
    prep::PreparedScene scene = two_spheres(true, false);
    scene.scene.images[0].bytes.resize(20);
    const auto warned = [&](const char* words) {
        const rast::Frame frame = test::draw(scene, small());
        return std::any_of(frame.warnings.begin(), frame.warnings.end(),
                           [&](const auto& text) { return text.find(words) != std::string::npos; });
    };
    EXPECT_TRUE(warned("texture left out"));
    EXPECT_FALSE(warned("UV set"));
    scene.scene.materials[0].diffuse_map.uv_set = 1;
    EXPECT_FALSE(warned("texture left out"));
    EXPECT_TRUE(warned("UV set"));
    const rast::RenderPlan plan = planned(scene, small());
    EXPECT_EQ(plan.textures_read,
              (std::vector<bool>{false, false, false, true, false, false}));  // the normal map
    // One mesh that has them is enough.
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes[1].uvs.push_back(scene.meshes[1].uvs[0]);
    scene.scene.nodes[1].mesh = 1;
    EXPECT_TRUE(warned("texture left out"));
    EXPECT_TRUE(warned("UV set"));
}

TEST(Pruning, OnlyTheMapsThatShadingReadsAreSampled) {
    const prep::PreparedScene scene = two_spheres(true, false);
    rast::RenderRequest request = small();
    request.shading = Shading::phong;
    const rast::Frame phong = test::draw(scene, request);
    EXPECT_EQ(phong.counters.textures_read, 1u);  // not the normal map
    EXPECT_EQ(phong.counters.texture_samples, phong.counters.pixels_shaded);
    request.shading = Shading::normal_mapped;
    const rast::Frame mapped = test::draw(scene, request);
    EXPECT_EQ(mapped.counters.textures_read, 2u);
    EXPECT_EQ(mapped.counters.texture_samples, 2 * mapped.counters.pixels_shaded);
}

TEST(Pruning, LevelsAreMadeWhenAPixelAsksForThem) {
    prep::PreparedScene scene = two_spheres(true, false);
    scene.scene.materials[0].normal_map = {};
    rast::RenderRequest request = small();
    const auto levels = [&](TextureFilter filter, std::uint32_t width) {
        request.filter = filter;
        request.width = width;
        request.height = width * 3 / 4;
        return test::draw(scene, request).counters.texture_levels;
    };
    EXPECT_EQ(levels(TextureFilter::bilinear, 120), 1u);
    // 64 texels: 7 levels. Seen from near, only the poles, where a texel's width shrinks, ask for
    // coarse ones; from afar, all of it does.
    EXPECT_GT(levels(TextureFilter::trilinear, 120), 1u);
    EXPECT_LE(levels(TextureFilter::trilinear, 120), 7u);
    // A ripmap of 64 by 64 has 49.
    EXPECT_LT(levels(TextureFilter::ripmap, 1200), 49u);
    const rast::RenderPlan plan = planned(scene, request);
    EXPECT_TRUE(step(plan, "ripmap levels").run);
    EXPECT_FALSE(step(plan, "mip levels").run);
}

TEST(MipTexture, MakesOnlyTheLevelsThatAreRead) {
    prep::Image image;
    image.width = image.height = 64;
    image.channels = 1;
    image.pixels.assign(64 * 64, 0.25f);
    const rast::MipTexture texture(image, prep::Texture{}, false, rast::TextureLevels::mipmap);
    const auto sample = [&](float texels) {
        texture.sample({0.3f, 0.6f}, {{texels / 64, 0}, {0, texels / 64}},
                       TextureFilter::trilinear);
        return texture.levels_made();
    };
    EXPECT_EQ(texture.level_count(), 7u);
    EXPECT_EQ(texture.levels_made(), 1u);
    EXPECT_EQ(sample(0.5f), 1u);
    EXPECT_EQ(sample(2.0f), 2u);  // exactly the second
    EXPECT_EQ(sample(3.0f), 3u);  // between it and the third
    EXPECT_EQ(sample(1000.0f), 7u);
    const rast::MipTexture ripmap(image, prep::Texture{}, false, rast::TextureLevels::ripmap);
    EXPECT_EQ(ripmap.levels_made(), 1u);
    ripmap.sample({0.3f, 0.6f}, {{4.0f / 64, 0}, {0, 1.0f / 64}}, TextureFilter::ripmap);
    EXPECT_EQ(ripmap.levels_made(), 3u);  // of quarter width, and half on the way to it
    ripmap.make_all_levels();
    EXPECT_EQ(ripmap.levels_made(), 49u);
}

TEST(Pruning, ColoursThatNobodyReadsAreNotShaded) {
    const prep::PreparedScene scene = two_spheres(true, false);
    rast::RenderRequest request = small();
    request.keep_depth = request.keep_ids = true;
    const rast::Frame all = test::draw(scene, request);
    request.keep_color = false;
    const rast::Frame bare = test::draw(scene, request);
    EXPECT_TRUE(bare.color.empty());
    EXPECT_EQ(bare.depth, all.depth);
    EXPECT_EQ(bare.triangle, all.triangle);
    EXPECT_EQ(bare.counters.pixels_shaded, 0u);
    EXPECT_EQ(bare.counters.textures_read, 0u);
    EXPECT_EQ(bare.counters.buffer_bytes, 120u * 90 * 12);
    EXPECT_EQ(planned(scene, request).memory_estimate,
              planned(scene, small()).memory_estimate - 120u * 90 * 16 + 120u * 90 * 12);
    // Normals as they are lit read the normal map all the same.
    request.keep_normals = true;
    const rast::Frame normals = test::draw(scene, request);
    rast::RenderRequest colored = request;
    colored.keep_color = true;
    EXPECT_EQ(normals.normal, test::draw(scene, colored).normal);
    EXPECT_EQ(normals.counters.textures_read, 1u);
    for (const int super : {2, 3}) {
        request.supersample = super;
        EXPECT_TRUE(test::draw(scene, request).color.empty());
    }
    request.supersample = 1;
    request.coverage = rast::Coverage::area;
    EXPECT_TRUE(test::draw(scene, request).color.empty());
}

TEST(Pruning, VerticesAreLitForColoursAlone) {
    const prep::PreparedScene scene = two_spheres(false, false);
    rast::RenderRequest request = small();
    request.shading = rast::Shading::gouraud;
    request.keep_normals = true;
    const rast::Frame all = test::draw(scene, request);
    std::size_t vertices = 0;  // of every instance
    for (const prep::Node& node : scene.scene.nodes)
        if (node.mesh != prep::no_index) vertices += scene.meshes[node.mesh].vertex_count();
    EXPECT_GT(all.counters.vertices_lit, 0u);
    EXPECT_LE(all.counters.vertices_lit, vertices);
    request.keep_color = false;
    const rast::Frame bare = test::draw(scene, request);
    EXPECT_EQ(bare.counters.vertices_lit, 0u);
    EXPECT_EQ(bare.normal, all.normal);
    request.shading = rast::Shading::phong;
    request.keep_color = true;
    EXPECT_EQ(test::draw(scene, request).counters.vertices_lit, 0u);
}

TEST(Plan, NamesSamplesFiltersLevelsBuffersVariantsAndBands) {
    const prep::PreparedScene scene = two_spheres(true, false);
    rast::RenderRequest request = small();
    request.samples = 8;
    request.filter = TextureFilter::anisotropic;
    request.max_anisotropy = 4;
    request.keep_uvs = true;
    request.band_bytes = 120 * 24 * 10;
    const rast::RenderPlan plan = planned(scene, request);
    EXPECT_TRUE(step(plan, "multisampling").run);
    EXPECT_NE(step(plan, "multisampling").reason.find('8'), std::string::npos);
    EXPECT_NE(step(plan, "texture filter").reason.find("up to 4"), std::string::npos);
    EXPECT_TRUE(step(plan, "mip levels").run);
    EXPECT_TRUE(step(plan, "UV output").run);
    EXPECT_FALSE(step(plan, "depth output").run);
    EXPECT_TRUE(step(plan, "bands").run);
    EXPECT_FALSE(step(plan, "exact areas").run);
    EXPECT_FALSE(step(plan, "supersampling").run);
    ASSERT_EQ(plan.variants.size(), 1u);
    EXPECT_EQ(plan.variants[0].name, "tangent-space normal map, diffuse map");
    EXPECT_EQ(plan.variants[0].triangles, plan.triangles);
    for (const rast::PlanStep& s : plan.steps)
        EXPECT_FALSE(s.reason.empty()) << prep::name_of(s.kind);
}

}  // namespace
