// Materials of real files, and of what exporters write, as they come out in glTF: a specular colour
// taken for a reflectance made a near-mirror of every second one of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "mesh_files.h"
#include "prep/formats.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

namespace fs = std::filesystem;
using Json = test::GltfFile::Json;

// The materials of a scene alone, a triangle each, without their maps.
prep::Scene materials_of(const prep::Scene& from) {
    prep::Scene scene;
    scene.materials = from.materials;
    prep::Mesh& mesh = scene.meshes.emplace_back();
    for (std::uint32_t m = 0; m < scene.materials.size(); ++m) {
        for (const prep::MaterialMap& map : prep::material_maps)
            scene.materials[m].*map.ref = prep::TextureRef{};
        for (std::uint32_t k = 0; k < 3; ++k) {
            mesh.positions.push_back({float(3 * m + k), float(k * k), 0});
            mesh.corner_vertices.push_back(3 * m + k);
        }
        mesh.face_offsets.push_back(3 * m + 3);
        mesh.face_materials.push_back(m);
    }
    prep::instance_unused_meshes(scene);
    return scene;
}

double largest(const Json& color) {
    double most = 0;
    for (const Json& channel : color) most = std::max(most, channel.get<double>());
    return most;
}

struct Counts {
    std::size_t materials = 0;
    std::size_t mirrors = 0;         // as they are written
    std::size_t mirrors_before = 0;  // had the specular colour been taken for F0
    std::string names;
};

// By what a reader of glTF takes: reflects more than half head-on, or sharply what it reflects.
void count(const prep::Scene& scene, Counts& counts) {
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(test::untouched(materials_of(scene)), dir / "m.glb").has_value());
    const test::GltfFile file(dir / "m.glb");
    ASSERT_EQ(file.json["materials"].size(), scene.materials.size());
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        const Json& written = file.json["materials"][m];
        const Json& pbr = written["pbrMetallicRoughness"];
        const Json extensions = written.value("extensions", Json::object());
        const Json specular = extensions.value("KHR_materials_specular", Json::object());
        const double ior = extensions.value("KHR_materials_ior", Json::object()).value("ior", 1.5);
        const double f0 =
            std::min(1.0, std::pow((ior - 1) / (ior + 1), 2) *
                              largest(specular.value("specularColorFactor", Json{1, 1, 1}))) *
            specular.value("specularFactor", 1.0);
        const double metallic = pbr.value("metallicFactor", 1.0);
        const double roughness = pbr.value("roughnessFactor", 1.0);
        const bool mirror =
            f0 > 0.5 || (roughness < 0.1 && f0 > 0.25) || (metallic > 0.5 && roughness < 0.1);
        counts.mirrors += mirror;
        if (mirror) counts.names += scene.materials[m].name + " ";
        const prep::Material& stated = scene.materials[m];
        counts.mirrors_before +=
            !stated.metallic_roughness &&
            std::max({stated.specular.r, stated.specular.g, stated.specular.b}) > 0.5f;
        ++counts.materials;
    }
}

TEST(MaterialCollection, RealFilesHaveNoNearMirrors) {
    MESHPREP_REQUIRE_SHARED(shared);
    const std::set<std::string> endings = {".obj", ".fbx", ".dae", ".3ds"};
    Counts counts;
    for (const char* const folder : {"corpus", "real_files"}) {
        if (!fs::is_directory(shared / folder)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(shared / folder)) {
            if (!endings.contains(prep::lower_ending(entry.path()))) continue;
            // Large ones are scans without materials.
            if (entry.file_size() > (4 << 20)) continue;
            const auto scene = prep::load_scene(entry.path());
            if (scene && !scene->materials.empty()) count(*scene, counts);
        }
    }
    std::cout << counts.materials << " materials, " << counts.mirrors
              << " near-mirrors; with F0 = Ks " << counts.mirrors_before << '\n';
    EXPECT_GE(counts.materials, 19u);
    EXPECT_EQ(counts.mirrors, 0u) << counts.names;
}

// What exporters write where their user has chosen nothing: Ks and Ns of 3ds Max, Blender, Maya,
// ZBrush, Assimp, MeshLab, Wings, SketchUp, and a sweep of both.
TEST(MaterialCollection, SpecularColoursOfExportersAreNoMirrors) {
    std::string mtl, obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
    auto add = [&, number = 0](double ks, double ns) mutable {
        const std::string name = "m" + std::to_string(number++);
        mtl += "newmtl " + name + "\nKd 0.8 0.8 0.8\nKs " + std::to_string(ks) + " " +
               std::to_string(ks) + " " + std::to_string(ks) + "\nNs " + std::to_string(ns) + "\n";
        obj += "usemtl " + name + "\nf 1 2 3\n";
    };
    add(0.9, 10);
    add(0.5, 96.078431);
    add(0.5, 250);
    add(1, 32);
    add(0.33, 0);
    add(1, 50);
    add(1, 16);
    add(1, 1000);
    for (int k = 0; k <= 10; ++k)
        for (const double ns : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0})
            add(k / 10.0, ns);
    const test::TempDir dir;
    test::write_text(dir / "m.mtl", mtl);
    test::write_text(dir / "m.obj", obj);
    const auto scene = prep::load_scene(dir / "m.obj");
    ASSERT_TRUE(scene.has_value());
    Counts counts;
    count(*scene, counts);
    EXPECT_EQ(counts.materials, 107u);
    EXPECT_EQ(counts.mirrors, 0u) << counts.names;
    EXPECT_GE(counts.mirrors_before, 49u) << "the sample has none to tell";
}

}  // namespace
