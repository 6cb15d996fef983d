// The table of formats, as the command's lists and directories read it.
#include "prep/formats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "mesh_files.h"
#include "prep/prep.h"

namespace {

TEST(FileFormats, AnEndingIsOneFormatsWhateverItsCase) {
    std::set<std::string_view> seen;
    for (const prep::FileFormat& format : prep::file_formats())
        for (const std::string_view ending : format.endings) {
            EXPECT_EQ(ending.front(), '.');
            EXPECT_TRUE(seen.insert(ending).second) << ending;
            std::string capitals(ending);
            for (char& c : capitals) c = char(std::toupper(static_cast<unsigned char>(c)));
            EXPECT_EQ(prep::file_format("some.mesh" + capitals), &format) << capitals;
        }
    EXPECT_EQ(prep::file_format("a.txt"), nullptr);
    EXPECT_EQ(prep::file_format("obj"), nullptr) << "a name, not an ending";
    EXPECT_EQ(prep::file_format("avatar.vrm")->name, "glTF");
    EXPECT_FALSE(prep::file_format("room.json")->meshes);
}

TEST(FileFormats, WhatIsSaidToBeWrittenIsWrittenAndReadAgain) {
    prep::Scene scene;
    prep::Mesh& mesh = scene.meshes.emplace_back();
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.face_offsets = {0, 3};
    mesh.corner_vertices = {0, 1, 2};
    prep::instance_unused_meshes(scene);
    const auto prepared = prep::prepare(std::move(scene));
    ASSERT_TRUE(prepared);
    const test::TempDir dir;
    std::set<std::string_view> written;
    for (const prep::FileFormat& format : prep::file_formats())
        for (const std::string_view ending : format.endings) {
            const auto path = dir / ("a" + std::string(ending));
            const auto notes = prep::save_scene(*prepared, path);
            EXPECT_EQ(notes.has_value(), std::find(format.written.begin(), format.written.end(),
                                                   ending) != format.written.end())
                << ending;
            if (!notes) continue;
            written.insert(ending);
            const auto read = prep::load_scene(path);
            ASSERT_TRUE(read) << prep::to_string(read.error());
            EXPECT_EQ(read->meshes.at(0).face_count(), 1u) << ending;
        }
    EXPECT_EQ(written,
              (std::set<std::string_view>{".glb", ".gltf", ".obj", ".off", ".ply", ".stl"}));
}

}  // namespace
