// The scenes that tests draw at random: that they hold everything, and are the same each time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "prep/image.h"
#include "prep/load.h"
#include "random_pictures.h"

namespace {

constexpr std::uint32_t scene_count = 200;

std::vector<prep::Scene> scenes() {
    std::vector<prep::Scene> all;
    for (std::uint32_t seed = 0; seed < scene_count; ++seed)
        all.push_back(test::random_scene(seed));
    return all;
}

TEST(RandomScenes, HoldEveryFeature) {
    const std::vector<prep::Scene> all = scenes();
    if (std::getenv("MESHPREP_PRINT_COVERAGE") != nullptr)
        std::fputs(test::coverage_table(all).c_str(), stdout);
    for (const test::SceneFeature& feature : test::scene_features()) {
        const auto count = std::count_if(all.begin(), all.end(), feature.in);
        EXPECT_GE(count, 3) << feature.name << "\n" << test::coverage_table(all);
        EXPECT_LT(count, std::ptrdiff_t(all.size())) << feature.name << " is in every scene";
    }
}

TEST(RandomScenes, AreTheSameForOneSeedAndDifferForTwo) {
    const rast::RenderRequest request = test::random_request(3);
    const auto hash = [&](std::uint32_t seed) {
        return test::hash_of(test::draw(test::prepared_random_scene(seed), request));
    };
    EXPECT_EQ(hash(5), hash(5));
    EXPECT_NE(hash(5), hash(6));
}

TEST(RandomScenes, PicturesOfFloatsKeepTheirBits) {
    for (const std::uint32_t channels : {1u, 2u, 3u, 4u}) {
        std::vector<float> values;
        for (std::uint32_t i = 0; i < 6 * channels; ++i)
            values.push_back(0.5f + float(i) * 0.37f * (i % 2 == 0 ? 1 : -1));
        const auto image = prep::load_image(test::float_picture(3, 2, channels, values));
        ASSERT_TRUE(image) << to_string(image.error());
        EXPECT_EQ(image->width, 3u);
        EXPECT_EQ(image->height, 2u);
        EXPECT_EQ(image->channels, channels);
        EXPECT_TRUE(image->floating);
        EXPECT_EQ(image->pixels, values);
    }
}

// A line for each picture: its hash, and what it is of. MESHPREP_HASHES names the file, so that two
// builds can be compared (scripts/picture-hashes); MESHPREP_HASH_FOLDERS (divided by ':') what is
// drawn beside the random scenes.
class HashList {
  public:
    HashList() {
        if (const char* path = std::getenv("MESHPREP_HASHES")) list_.open(path);
    }
    bool wanted() const { return list_.is_open(); }
    void add(std::uint64_t hash, const std::string& of) {
        if (!wanted()) return;
        char text[20];
        std::snprintf(text, sizeof text, "%016llx ", static_cast<unsigned long long>(hash));
        list_ << text << of << "\n";
    }

  private:
    std::ofstream list_;
};

// Of formats whose readers are this project's own.
bool ours(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return ending == ".obj" || ending == ".ply" || ending == ".stl" || ending == ".off" ||
           ending == ".glb" || ending == ".gltf";
}

// With 1 and 4 samples, on every instruction set: the same bits.
void expect_same_everywhere(const prep::PreparedScene& scene, rast::RenderRequest request,
                            const std::string& name, HashList& list) {
    for (const int samples : {1, 4}) {
        request.samples = samples;
        std::uint64_t first = 0;
        for (const prep::SimdLevel simd : {prep::SimdLevel::scalar, prep::SimdLevel::sse4,
                                           prep::SimdLevel::avx2, prep::SimdLevel::avx512}) {
            request.simd = simd;
            const std::uint64_t h = test::hash_of(test::draw_knowing_texels(scene, request).frame);
            if (simd == prep::SimdLevel::scalar) first = h;
            const std::string of = name + ", " + std::to_string(samples) + " samples, " +
                                   std::string(prep::to_string(simd));
            EXPECT_EQ(h, first) << of;
            list.add(h, of);
        }
    }
}

TEST(RandomScenes, HaveTheSamePicturesOnEveryInstructionSet) {
    HashList list;
    for (std::uint32_t seed = 0; seed < (list.wanted() ? scene_count : 24); ++seed)
        expect_same_everywhere(test::prepared_random_scene(seed), test::random_request(seed),
                               "scene " + std::to_string(seed), list);
    const char* folders = std::getenv("MESHPREP_HASH_FOLDERS");
    std::stringstream text(folders != nullptr ? folders : "");
    for (std::string folder; std::getline(text, folder, ':');) {
        std::vector<std::filesystem::path> files;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
            if (entry.is_regular_file() && entry.file_size() < 4u << 20 && ours(entry.path()))
                files.push_back(entry.path());
        std::sort(files.begin(), files.end());
        for (const std::filesystem::path& file : files) {
            auto scene = prep::load_scene(file);
            if (!scene) continue;
            auto prepared = prep::prepare(*std::move(scene));
            if (!prepared || prepared->meshes.empty()) continue;
            rast::RenderRequest request = test::random_request(0);
            for (int shading = 0; shading < 4; ++shading) {
                request.shading = rast::Shading(shading);
                expect_same_everywhere(*prepared, request,
                                       file.string() + ", shading " + std::to_string(shading),
                                       list);
            }
        }
    }
}

}  // namespace
