// Bit parity with results of the MikkTSpace reference and of its definition (../shared/golden).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "prep/tangents.h"
#include "shared_data.h"

namespace {

struct Soup {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<std::uint32_t> offsets{0}, identity;
};

template <class T>
void read(std::ifstream& in, T* to, std::size_t count) {
    in.read(reinterpret_cast<char*>(to), std::streamsize(sizeof(T) * count));
}

Soup read_soup(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    char magic[4];
    std::uint32_t faces = 0, corners = 0;
    read(in, magic, 4);
    read(in, &faces, 1);
    read(in, &corners, 1);
    std::vector<std::uint8_t> sizes(faces);
    Soup soup;
    read(in, sizes.data(), faces);
    for (const std::uint8_t k : sizes) soup.offsets.push_back(soup.offsets.back() + k);
    soup.positions.resize(corners);
    soup.normals.resize(corners);
    soup.uvs.resize(corners);
    read(in, soup.positions.data(), corners);
    read(in, soup.normals.data(), corners);
    read(in, soup.uvs.data(), corners);
    soup.identity.resize(corners);
    for (std::uint32_t c = 0; c < corners; ++c) soup.identity[c] = c;
    EXPECT_TRUE(in.good()) << path;
    return soup;
}

std::vector<glm::vec4> read_tangents(const std::filesystem::path& path, std::size_t corners) {
    std::vector<glm::vec4> tangents(corners);
    std::ifstream in(path, std::ios::binary);
    read(in, tangents.data(), corners);
    EXPECT_TRUE(in.good()) << path;
    return tangents;
}

prep::TangentInput input_of(const Soup& soup) {
    prep::TangentInput input;
    input.positions = soup.positions;
    input.face_offsets = soup.offsets;
    input.corner_vertices = soup.identity;
    input.normals = {soup.normals, soup.identity};
    input.uv = {soup.uvs, soup.identity};
    return input;
}

std::vector<std::filesystem::path> golden_inputs(const std::filesystem::path& shared) {
    std::vector<std::filesystem::path> inputs;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(shared / "golden" / "mikktspace"))
        if (entry.path().extension() == ".mkt") inputs.push_back(entry.path());
    std::sort(inputs.begin(), inputs.end());
    return inputs;
}

TEST(TangentsGolden, DefinitionMatchesEveryBit) {
    MESHPREP_REQUIRE_SHARED(shared);
    const auto inputs = golden_inputs(shared);
    ASSERT_FALSE(inputs.empty());
    for (const auto& path : inputs) {
        const Soup soup = read_soup(path);
        prep::TangentOptions options;
        options.mode = prep::TangentMode::mikktspace_exact;
        options.uv_origin = prep::UvOrigin::bottom_left;
        const auto result = prep::corner_tangents(input_of(soup), options);
        ASSERT_TRUE(result.has_value()) << path;
        auto expected_path = path;
        const auto expected =
            read_tangents(expected_path.replace_extension(".fix"), soup.positions.size());
        std::size_t different = 0;
        for (std::size_t c = 0; c < expected.size(); ++c) {
            const glm::vec4 got = result->tangents.values[result->tangents.indices[c]];
            if (std::memcmp(&got, &expected[c], sizeof got) != 0 && different++ < 3)
                ADD_FAILURE() << path.filename() << " corner " << c << ": (" << got.x << ", "
                              << got.y << ", " << got.z << ", " << got.w << ") instead of ("
                              << expected[c].x << ", " << expected[c].y << ", " << expected[c].z
                              << ", " << expected[c].w << ")";
        }
        EXPECT_EQ(different, 0u) << path.filename() << ": of " << expected.size() << " corners";
    }
}

}  // namespace
