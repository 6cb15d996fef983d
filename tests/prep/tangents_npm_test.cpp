// Mode mikktspace_exact against the npm package mikktspace 1.1.1, which is the C reference in
// WebAssembly: every bit, on hostile soups and on every mesh with UVs of the shared corpus.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>

#include "corner_soup.h"
#include "npm_tools.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;
using test::CornerSoup;

struct Case {
    std::string name;
    CornerSoup soup;
};

// The folder and what is in it go with the object.
class Workspace {
  public:
    explicit Workspace(const std::string& name)
        : path_(fs::temp_directory_path() /
                ("meshprep-" + name + "-" + std::to_string(std::random_device()()))) {
        fs::create_directories(path_);
    }
    ~Workspace() {
        std::error_code ec;
        fs::remove_all(path_, ec);
    }
    Workspace(const Workspace&) = delete;
    Workspace& operator=(const Workspace&) = delete;
    fs::path operator/(const char* name) const { return path_ / name; }

  private:
    fs::path path_;
};

template <class T>
void write(std::ofstream& out, const std::vector<T>& values) {
    out.write(reinterpret_cast<const char*>(values.data()),
              std::streamsize(values.size() * sizeof(T)));
}

// Per case the package's tangents; empty where it crashed.
std::vector<std::vector<glm::vec4>> run_package(const fs::path& package,
                                                const std::vector<Case>& cases) {
    const Workspace space("mikktspace");
    {
        std::ofstream out(space / "input", std::ios::binary);
        for (const Case& c : cases) {
            write(out, std::vector<std::uint32_t>{std::uint32_t(c.soup.corners())});
            write(out, c.soup.positions);
            write(out, c.soup.normals);
            write(out, c.soup.uvs);
        }
    }
    const fs::path script = test::source_dir() / "tests/tools/mikktspace_oracle.mjs";
    std::cout.flush();
    const std::string command = "node '" + script.string() + "' '" + package.string() + "' '" +
                                (space / "input").string() + "' '" + (space / "output").string() +
                                "' 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0);
    std::vector<std::vector<glm::vec4>> results(cases.size());
    std::ifstream in(space / "output", std::ios::binary);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        std::uint32_t done = 0;
        in.read(reinterpret_cast<char*>(&done), sizeof done);
        if (!done) continue;
        results[i].resize(cases[i].soup.corners());
        in.read(reinterpret_cast<char*>(results[i].data()),
                std::streamsize(results[i].size() * sizeof(glm::vec4)));
    }
    EXPECT_TRUE(in.good()) << "the package's output is short";
    return results;
}

// Equal bits; which NaN it is, WebAssembly leaves open.
bool same(float a, float b) {
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

// The package traps where no triangle has three different positions, and on some positions that are
// NaN; on nothing else.
bool may_crash(const CornerSoup& soup) {
    bool nan = false, proper = false;
    for (const glm::vec3& p : soup.positions)
        nan |= std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z);
    for (std::size_t c = 0; c < soup.corners(); c += 3) {
        const glm::vec3* p = soup.positions.data() + c;
        proper |= p[0] != p[1] && p[1] != p[2] && p[2] != p[0];
    }
    return nan || !proper;
}

// All are compared but those on which the package may crash, and does. Returns how many are.
std::size_t expect_parity(const fs::path& package, const std::vector<Case>& cases) {
    const auto expected = run_package(package, cases);
    std::size_t compared = 0, corners = 0, different_cases = 0;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Case& c = cases[i];
        if (c.soup.corners() > 0 && expected[i].empty()) {
            EXPECT_TRUE(may_crash(c.soup)) << c.name << " is not compared";
            continue;
        }
        prep::TangentOptions options;
        options.mode = prep::TangentMode::mikktspace_exact;
        options.uv_origin = prep::UvOrigin::bottom_left;
        const auto result = prep::corner_tangents(c.soup.input(), options);
        if (!result) {
            ADD_FAILURE() << c.name << ": " << to_string(result.error());
            continue;
        }
        const auto tangents = test::flattened(*result);
        std::size_t different = 0;
        for (std::size_t k = 0; k < tangents.size(); ++k) {
            bool equal = true;
            for (int j = 0; j < 4; ++j) equal &= same(tangents[k][j], expected[i][k][j]);
            different += !equal;
        }
        if (different > 0 && different_cases++ < 10)
            ADD_FAILURE() << c.name << ": " << different << " of " << tangents.size()
                          << " corners differ";
        ++compared;
        corners += tangents.size();
    }
    EXPECT_EQ(different_cases, 0u);
    std::cout << compared << " of " << cases.size() << " meshes compared, " << corners
              << " corners, " << different_cases << " meshes differ\n";
    return compared;
}

TEST(TangentsNpm, EveryBitOnHostileSoups) {
    MESHPREP_REQUIRE_NPM(package, "mikktspace");
    std::vector<Case> cases;
    for (std::uint32_t seed = 0; seed < 2000; ++seed) {
        std::mt19937 random(seed);
        test::HostileOptions hostile;
        hostile.minus_zeros = seed & 1;
        hostile.nans = seed & 2;
        hostile.odd_scales = seed & 4;
        cases.push_back({"seed " + std::to_string(seed), test::hostile_soup(random, hostile)});
    }
    // It crashes on 137 of the 2000.
    EXPECT_EQ(expect_parity(package, cases), 1863u);
}

// tests/prep/tangents_reference.txt is what machines without the package go by
// (TangentsReference).
TEST(TangentsNpm, TheRecordIsThePackages) {
    MESHPREP_REQUIRE_NPM(package, "mikktspace");
    std::vector<Case> cases;
    for (test::NamedSoup& soup : test::recorded_soups())
        cases.push_back({std::move(soup.name), std::move(soup.soup)});
    const auto tangents = run_package(package, cases);
    std::ostringstream lines;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        lines << cases[i].name << ' ';
        if (tangents[i].empty() && cases[i].soup.corners() > 0)
            lines << "crash\n";
        else
            lines << std::hex << test::hash_of(tangents[i]) << std::dec << '\n';
    }
    std::ifstream recorded(test::source_dir() / "tests/prep/tangents_reference.txt");
    std::ostringstream known;
    known << recorded.rdbuf();
    EXPECT_TRUE(known.str() == lines.str());
    // What to record where the soups have changed: MESHPREP_RECORD names the file.
    if (const char* file = std::getenv("MESHPREP_RECORD")) std::ofstream(file) << lines.str();
}

// Faces with more corners are cut into fans; normals that the file does not have are computed.
CornerSoup triangle_soup(const prep::Mesh& mesh) {
    CornerSoup soup;
    const auto add = [&](std::uint32_t c) {
        const std::uint32_t n = mesh.normals.indices[c], t = mesh.uvs[0].indices[c];
        soup.add(mesh.positions[mesh.corner_vertices[c]], mesh.normals.values[n],
                 t == prep::no_index ? glm::vec2(0.0f) : mesh.uvs[0].values[t]);
    };
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        for (std::uint32_t c = begin + 1; c + 1 < end; ++c) {
            add(begin);
            add(c);
            add(c + 1);
            soup.end_face();
        }
    }
    return soup;
}

TEST(TangentsNpm, EveryBitOnTheCorpus) {
    MESHPREP_REQUIRE_SHARED(shared);
    MESHPREP_REQUIRE_NPM(package, "mikktspace");
    std::vector<fs::path> files;
    const std::set<std::string> endings{".obj", ".ply", ".off", ".glb", ".gltf"};
    for (auto it = fs::recursive_directory_iterator(shared / "corpus"); it != fs::end(it); ++it) {
        if (it->is_directory() && it->path().filename() == "gltf-validator")
            it.disable_recursion_pending();
        else if (endings.contains(it->path().extension().string()))
            files.push_back(it->path());
    }
    std::sort(files.begin(), files.end());
    std::vector<Case> cases;
    std::size_t triangle_files = 0;
    for (const fs::path& file : files) {
        auto scene = prep::load_scene(file);
        ASSERT_TRUE(scene.has_value()) << to_string(scene.error());
        prep::PrepareOptions options;
        options.request.normals = prep::Request::Level::always;
        options.request.tangents = prep::Request::Level::never;
        auto prepared = prep::prepare(*std::move(scene), options);
        ASSERT_TRUE(prepared.has_value()) << to_string(prepared.error());
        bool any = false;
        for (const prep::Mesh& mesh : prepared->scene.meshes) {
            if (mesh.uvs.empty() || mesh.uvs[0].empty() || mesh.normals.empty()) continue;
            cases.push_back({file.filename().string() + " " + mesh.name, triangle_soup(mesh)});
            any = true;
        }
        triangle_files += any;
    }
    std::cout << triangle_files << " files have UVs\n";
    EXPECT_GE(triangle_files, 15u);
    EXPECT_EQ(expect_parity(package, cases), cases.size());
}

}  // namespace
