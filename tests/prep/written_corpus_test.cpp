// The corpus' OBJ, OFF and STL files as GLB, against what a few lines of code read in them: the
// same triangles, corner by corner.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include "mesh_files.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shared_data.h"
#include "written_gltf.h"

namespace {

namespace fs = std::filesystem;
using Numbers = std::vector<double>;

// Faces by corner: place and UV, which counts from the top as in glTF.
struct Faces {
    std::vector<std::vector<Numbers>> all;
    bool uvs = false;
};

// What matters of an OBJ: v, vt and f with indices from 1 or from the end.
Faces read_obj(const std::string& text) {
    Faces out;
    std::vector<Numbers> v, vt;
    const char* at = text.c_str();
    const auto numbers_at = [](const char* from, std::size_t count) {
        Numbers numbers;
        char* end = nullptr;
        for (std::size_t i = 0; i < count; ++i, from = end)
            numbers.push_back(std::strtod(from, &end));
        return numbers;
    };
    const auto rounded = [](Numbers numbers) {
        for (double& x : numbers) x = double(float(x));
        return numbers;
    };
    while (*at) {
        const char* line = at;
        const char* end = std::strchr(at, '\n');
        at = end ? end + 1 : at + std::strlen(at);
        while (*line == ' ' || *line == '\t') ++line;
        if (line[0] == 'v' && line[1] == ' ') v.push_back(rounded(numbers_at(line + 2, 3)));
        if (line[0] == 'v' && line[1] == 't') {
            Numbers uv = numbers_at(line + 3, 2);
            uv[1] = 1 - uv[1];
            vt.push_back(rounded(uv));
        }
        if (line[0] != 'f' || line[1] != ' ') continue;
        std::vector<Numbers> face;
        for (const char* word = line + 1;;) {
            while (*word == ' ' || *word == '\t' || *word == '\r') ++word;
            if (*word == '\n' || *word == 0) break;
            char* next = nullptr;
            const auto resolved = [](long i, std::size_t size) {
                return i < 0 ? std::size_t(long(size) + i) : std::size_t(i - 1);
            };
            Numbers corner = v.at(resolved(std::strtol(word, &next, 10), v.size()));
            Numbers uv = {0, 0};
            if (*next == '/' && next[1] != '/') {
                uv = vt.at(resolved(std::strtol(next + 1, &next, 10), vt.size()));
                out.uvs = true;
            }
            corner.insert(corner.end(), uv.begin(), uv.end());
            face.push_back(corner);
            word = next;
            while (*word && !std::strchr(" \t\r\n", *word)) ++word;
        }
        out.all.push_back(face);
    }
    return out;
}

Faces read_off(const std::string& text) {
    Faces out;
    const char* at = std::strchr(text.c_str(), '\n');
    char* end = nullptr;
    const auto count = [&] {
        const long n = std::strtol(at, &end, 10);
        at = end;
        return std::size_t(n);
    };
    const std::size_t vertices = count(), faces = count();
    count();
    std::vector<Numbers> v;
    for (std::size_t i = 0; i < vertices; ++i) {
        Numbers p;
        for (int k = 0; k < 3; ++k, at = end) p.push_back(double(float(std::strtod(at, &end))));
        p.insert(p.end(), {0, 0});
        v.push_back(p);
    }
    for (std::size_t f = 0; f < faces; ++f) {
        std::vector<Numbers> face(count());
        for (Numbers& corner : face) corner = v.at(count());
        out.all.push_back(face);
        at += std::strcspn(at, "\n");  // colours
    }
    return out;
}

Faces read_binary_stl(const std::string& bytes) {
    Faces out;
    for (std::size_t at = 84; at + 50 <= bytes.size(); at += 50) {
        std::vector<Numbers> face;
        for (std::size_t k = 0; k < 3; ++k) {
            float p[3];
            std::memcpy(p, &bytes[at + 12 + 12 * k], 12);
            face.push_back({p[0], p[1], p[2], 0, 0});
        }
        out.all.push_back(face);
    }
    return out;
}

// The triangles of a written file, in the same form.
std::vector<Numbers> triangles_of(const test::GltfFile& file, bool uvs) {
    std::vector<Numbers> out;
    for (const auto& node : file.json.at("nodes")) {
        if (!node.contains("mesh")) continue;
        EXPECT_FALSE(node.contains("matrix"));
        // Far from zero, positions are about a point that the node has.
        const Numbers origin = node.value("translation", Numbers(3, 0.0));
        const std::size_t m = node["mesh"];
        for (std::size_t p = 0; p < file.json["meshes"][m]["primitives"].size(); ++p) {
            const std::vector<std::size_t> corners = file.triangles(m, p);
            if (corners.empty()) continue;
            const test::GltfValues at = file.attribute(m, p, "POSITION");
            const test::GltfValues uv =
                uvs ? file.attribute(m, p, "TEXCOORD_0") : test::GltfValues{};
            for (std::size_t c = 0; c < corners.size(); ++c) {
                if (c % 3 == 0) out.emplace_back();
                const std::size_t i = corners[c];
                for (std::size_t k = 0; k < 3; ++k)
                    out.back().push_back(double(float(origin[k] + at.values[3 * i + k])));
                for (std::size_t k = 0; k < 2; ++k)
                    out.back().push_back(uvs ? uv.values[2 * i + k] : 0);
            }
        }
    }
    return out;
}

// The sum of all triangles' cross products: the same however polygons are cut. By its largest
// coordinate, and the sum of their sizes for scale.
std::pair<glm::dvec3, double> area(const std::vector<Numbers>& corners_of_faces) {
    glm::dvec3 sum(0);
    double size = 0;
    for (const Numbers& face : corners_of_faces) {
        const auto at = [&](std::size_t c) {
            return glm::dvec3(face[5 * c], face[5 * c + 1], face[5 * c + 2]);
        };
        for (std::size_t c = 2; 5 * c < face.size(); ++c) {
            const glm::dvec3 cross = glm::cross(at(c - 1) - at(0), at(c) - at(0));
            sum += cross;
            size += glm::length(cross);
        }
    }
    return {sum, size};
}

std::string difference(const std::vector<Numbers>& a, const std::vector<Numbers>& b,
                       double rounding) {
    double largest = 0;  // places about another point are as exact as that is far
    for (const Numbers& triangle : b)
        for (const double x : triangle) largest = std::max(largest, std::abs(x));
    for (std::size_t t = 0; t < a.size(); ++t)
        for (std::size_t k = 0; k < a[t].size(); ++k)
            if (!(std::abs(a[t][k] - b[t][k]) <= rounding * largest))
                return "triangle " + std::to_string(t) + ": " + std::to_string(a[t][k]) +
                       ", the source has " + std::to_string(b[t][k]);
    return {};
}

TEST(WrittenCorpus, GlbFilesHaveTheTrianglesOfTheirSources) {
    MESHPREP_REQUIRE_SHARED(shared);
    const test::TempDir dir;
    std::size_t compared = 0, triangles = 0;
    for (const auto& entry : fs::recursive_directory_iterator(shared / "corpus")) {
        const fs::path& path = entry.path();
        const bool obj = path.extension() == ".obj", off = path.extension() == ".off";
        const bool stl = path.extension() == ".stl" && path.stem() != "icosahedron_ascii";
        if ((!obj && !off && !stl) || fs::file_size(path) > 1000000) continue;
        SCOPED_TRACE(path.string());
        const std::string text = test::file_text(path);
        const Faces faces = obj ? read_obj(text) : off ? read_off(text) : read_binary_stl(text);
        auto scene = prep::load_scene(path);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        auto prepared = prep::prepare(*std::move(scene));
        ASSERT_TRUE(prepared.has_value());
        ASSERT_TRUE(prep::save_scene(*prepared, dir / "out.glb").has_value());
        const test::GltfFile file(dir / "out.glb");
        EXPECT_EQ(file.fault(), "");
        std::vector<Numbers> written = triangles_of(file, faces.uvs), flat;
        std::size_t expected = 0;
        for (const auto& face : faces.all) {
            expected += face.size() - 2;
            flat.emplace_back();
            for (const Numbers& corner : face)
                flat.back().insert(flat.back().end(), corner.begin(), corner.end());
        }
        ASSERT_EQ(written.size(), expected);
        ++compared;
        triangles += expected;
        if (expected == faces.all.size()) {
            // Materials sort the triangles; far from zero, a sum may be rounded otherwise.
            const bool far = file.json.at("nodes").dump().find("translation") != std::string::npos;
            if (!far) {
                std::sort(written.begin(), written.end());
                std::sort(flat.begin(), flat.end());
            }
            EXPECT_EQ(difference(written, flat, far ? 0x1p-23 : 0), "");
        } else {
            const auto [sum, size] = area(written);
            const auto [own, ignored] = area(flat);
            for (int k = 0; k < 3; ++k)  // sums of doubles of some 1e5 terms
                EXPECT_NEAR(sum[k], own[k], 1e-9 * size);
        }
    }
    std::cout << compared << " files, " << triangles << " triangles\n";
    EXPECT_GE(compared, 40u);
}

}  // namespace
