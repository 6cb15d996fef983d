// Seeded closed cages of any genus, displaced by the command with seams, mirrored charts, creases
// and several materials; the written files are read by other programs and welded by bits: every
// edge once each way, the cage's Euler number, no edge without length, and in GLB along 4 random
// directions as many hits of fronts as of backs in each of 64² pixels (what is narrower than a
// pixel is seen by welding alone). MESHPREP_LONG_TESTS=1 takes 200 cages and 20 directions.
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <assimp/Importer.hpp>
#include <cstdlib>
#include <sstream>

#include "command_runner.h"
#include "gltf_oracle.h"
#include "hits.h"
#include "npm_tools.h"
#include "prep/image.h"
#include "tessellation_checks.h"

namespace {

using tessellation_checks::Closedness;
using tessellation_checks::closedness;

using Face = std::vector<std::uint32_t>;

struct Cage {
    std::vector<glm::dvec3> points;
    std::vector<Face> faces;
    int genus = 0;
    std::size_t most_corners = 0, fewest_corners = 99, highest_valence = 0;
};

// The edge from a to b in a face: the index of a, or none.
std::size_t edge_in(const Face& face, std::uint32_t a, std::uint32_t b) {
    for (std::size_t k = 0; k < face.size(); ++k)
        if (face[k] == a && face[(k + 1) % face.size()] == b) return k;
    return face.size();
}

bool are_joined(const Cage& cage, std::uint32_t a, std::uint32_t b) {
    for (const Face& face : cage.faces)
        if (edge_in(face, a, b) < face.size() || edge_in(face, b, a) < face.size()) return true;
    return false;
}

// A new vertex in the middle of an edge, in both of its faces; not where one would have over nine.
bool split_edge(Cage& cage, std::uint32_t a, std::uint32_t b) {
    Face *one = nullptr, *other = nullptr;
    for (Face& face : cage.faces) {
        if (edge_in(face, a, b) < face.size()) one = &face;
        if (edge_in(face, b, a) < face.size()) other = &face;
    }
    if (!one || !other || one == other || one->size() >= 9 || other->size() >= 9) return false;
    const auto middle = std::uint32_t(cage.points.size());
    cage.points.push_back(0.5 * (cage.points[a] + cage.points[b]));
    one->insert(one->begin() + std::ptrdiff_t(edge_in(*one, a, b)) + 1, middle);
    other->insert(other->begin() + std::ptrdiff_t(edge_in(*other, b, a)) + 1, middle);
    return true;
}

// Takes vertices that only two faces have out of them, where a face with a corner less is left.
void smooth_out_pairs(Cage& cage) {
    for (std::uint32_t v = 0; v < cage.points.size(); ++v) {
        std::vector<Face*> around;
        for (Face& face : cage.faces)
            if (std::find(face.begin(), face.end(), v) != face.end()) around.push_back(&face);
        if (around.size() != 2 || around[0]->size() < 4 || around[1]->size() < 4) continue;
        const Face& face = *around[0];
        const std::size_t n = face.size();
        const auto k = std::size_t(std::find(face.begin(), face.end(), v) - face.begin());
        if (are_joined(cage, face[(k + n - 1) % n], face[(k + 1) % n])) continue;
        for (Face* const one : around) one->erase(std::find(one->begin(), one->end(), v));
    }
}

// A plate of cubes with as many holes as its genus, its faces cut, grown and fanned by chance.
Cage random_cage(std::mt19937& random) {
    Cage cage;
    cage.genus = int(random() % 8);
    const int length = 2 * cage.genus + 1 + int(random() % 2), width = cage.genus > 0 ? 3 : 2;
    const auto solid = [&](int x, int y, int z) {
        if (x < 0 || y < 0 || z < 0 || x >= length || y >= width || z >= 1) return false;
        return !(width == 3 && y == 1 && x % 2 == 1 && x < 2 * cage.genus);
    };
    std::map<std::array<int, 3>, std::uint32_t> ids;
    const auto point = [&](std::array<int, 3> at) {
        const auto [found, fresh] = ids.emplace(at, std::uint32_t(cage.points.size()));
        if (fresh) cage.points.emplace_back(at[0], at[1], at[2]);
        return found->second;
    };
    for (int x = 0; x < length; ++x)
        for (int y = 0; y < width; ++y)
            for (int axis = 0; axis < 3; ++axis)
                for (const int side : {-1, 1}) {
                    std::array<int, 3> beyond{x, y, 0};
                    beyond[std::size_t(axis)] += side;
                    if (!solid(x, y, 0) || solid(beyond[0], beyond[1], beyond[2])) continue;
                    Face face;
                    for (const auto& [p, q] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
                        std::array<int, 3> at{x, y, 0};
                        at[std::size_t(axis)] += side > 0;
                        at[std::size_t((axis + 1) % 3)] += p;
                        at[std::size_t((axis + 2) % 3)] += q;
                        face.push_back(point(at));
                    }
                    if (side < 0) std::reverse(face.begin(), face.end());
                    cage.faces.push_back(face);
                }
    const std::size_t changes = 3 + random() % 12;
    for (std::size_t k = 0; k < changes; ++k) {
        const std::size_t f = random() % cage.faces.size();
        const Face face = cage.faces[f];
        const std::size_t n = face.size(), i = random() % n;
        if (random() % 3 == 0) {
            split_edge(cage, face[i], face[(i + 1) % n]);
        } else if (n >= 4 && random() % 2 == 0) {
            const std::size_t j = (i + 2) % n;
            if (are_joined(cage, face[i], face[j])) continue;
            cage.faces.push_back({face[i], face[(i + 1) % n], face[j]});
            cage.faces[f].erase(cage.faces[f].begin() + std::ptrdiff_t((i + 1) % n));
        } else {
            const auto centre = std::uint32_t(cage.points.size());
            glm::dvec3 mean(0.0);
            for (const std::uint32_t v : face) mean += cage.points[v] / double(n);
            cage.points.push_back(mean);
            std::vector<std::array<std::uint32_t, 2>> rim;
            for (std::size_t c = 0; c < n; ++c) rim.push_back({face[c], face[(c + 1) % n]});
            cage.faces.erase(cage.faces.begin() + std::ptrdiff_t(f));
            for (const auto& [a, b] : rim) cage.faces.push_back({a, b, centre});
            // Up to twenty around it: each triangle in two, its neighbour one corner more.
            std::size_t valence = n;
            const std::size_t wanted = 3 + random() % 18;
            for (std::size_t r = 0; r < rim.size() && valence < wanted; ++r) {
                const auto [a, b] = rim[r];
                if (!split_edge(cage, a, b)) continue;
                const auto middle = std::uint32_t(cage.points.size() - 1);
                for (Face& t : cage.faces)
                    if (t.size() == 4 && edge_in(t, b, centre) < 4 && edge_in(t, centre, a) < 4) {
                        t = {a, middle, centre};
                        break;
                    }
                cage.faces.push_back({middle, b, centre});
                rim.push_back({a, middle});
                rim.push_back({middle, b});
                ++valence;
            }
        }
    }
    smooth_out_pairs(cage);
    std::uniform_real_distribution<double> jitter(-0.08, 0.08);
    for (glm::dvec3& p : cage.points)
        p += glm::dvec3(jitter(random), jitter(random), jitter(random));
    std::map<std::uint32_t, std::size_t> valences;  // without those taken out
    for (const Face& face : cage.faces) {
        cage.most_corners = std::max(cage.most_corners, face.size());
        cage.fewest_corners = std::min(cage.fewest_corners, face.size());
        for (const std::uint32_t v : face)
            cage.highest_valence = std::max(cage.highest_valence, ++valences[v]);
    }
    for (const auto& [v, valence] : valences)
        if (valence < 3) return random_cage(random);
    return cage;
}

// Each face as a fan about its first corner.
void cut_into_triangles(Cage& cage) {
    std::vector<Face> triangles;
    for (const Face& face : cage.faces)
        for (std::size_t k = 2; k < face.size(); ++k)
            triangles.push_back({face[0], face[k - 1], face[k]});
    cage.faces = std::move(triangles);
}

// Each edge with a chance of a fourth, of sharpness 0 to 10.
std::string random_creases(const Cage& cage, std::mt19937& random) {
    std::uniform_real_distribution<double> sharpness(0, 10);
    std::string lines;
    for (const Face& face : cage.faces)
        for (std::size_t k = 0; k < face.size(); ++k) {
            const std::uint32_t a = face[k], b = face[(k + 1) % face.size()];
            if (a > b || random() % 4 != 0) continue;
            lines += "t crease 2/1/0 " + std::to_string(a) + ' ' + std::to_string(b) + ' ' +
                     std::to_string(sharpness(random)) + '\n';
        }
    return lines;
}

// How many pixels have another number of hits of fronts than of backs, seen along a direction
// chance gives, without perspective; `hit` grows by those that have any.
std::size_t uneven_pixels(const prep::Mesh& mesh, std::mt19937& random, std::size_t& hit) {
    constexpr std::uint32_t extent = 64;
    std::normal_distribution<double> number;
    const auto direction = [&] {
        return glm::normalize(glm::dvec3(number(random), number(random), number(random)));
    };
    const glm::dvec3 along = direction(), x = glm::normalize(glm::cross(along, direction()));
    const glm::dvec3 y = glm::cross(along, x);
    glm::dvec3 low(1e9), high(-1e9);
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    const double pixels = 0.9 * extent / glm::length(high - low);
    std::vector<hits::ScreenVertex> seen;
    for (const glm::vec3& p : mesh.positions) {
        const glm::dvec3 d = pixels * (glm::dvec3(p) - 0.5 * (low + high));
        seen.push_back({glm::dot(d, x), glm::dot(d, y), 0.5, 1});
    }
    std::vector<hits::Triangle> triangles;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t* const v = mesh.corner_vertices.data() + 3 * f;
        triangles.push_back({v[0], v[1], v[2]});
    }
    const hits::Hits counted = hits::count_hits(seen, triangles, extent, extent);
    std::size_t uneven = 0;
    for (std::size_t i = 0; i < counted.front.size(); ++i) {
        uneven += counted.front[i] != counted.back[i];
        hit += counted.front[i] > 0;
    }
    return uneven;
}

// OBJ with one to four charts, mirrored, turned and half a texel off, and one to three materials.
std::string obj_of(const Cage& cage, std::mt19937& random) {
    std::ostringstream out;
    out.precision(9);
    for (const glm::dvec3& p : cage.points) out << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    const std::size_t charts = 1 + random() % 4, materials = 1 + random() % 3;
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<std::array<glm::dvec3, 2>> axes(charts);
    for (auto& chart : axes)
        for (glm::dvec3& axis : chart)
            axis = 0.3 * glm::dvec3(number(random), number(random), number(random));
    std::string faces;
    std::size_t uv = 0;
    for (const Face& face : cage.faces) {
        const std::size_t c = random() % charts;
        faces += "usemtl m" + std::to_string(random() % materials) + "\nf";
        const glm::dvec2 offset =
            glm::dvec2(double(random() % 128), double(random() % 128)) / 128.0;
        for (const std::uint32_t v : face) {
            out << "vt " << offset.x + glm::dot(axes[c][0], cage.points[v]) << ' '
                << offset.y + glm::dot(axes[c][1], cage.points[v]) << '\n';
            faces += ' ' + std::to_string(v + 1) + '/' + std::to_string(++uv);
        }
        faces += '\n';
    }
    return out.str() + faces;
}

prep::Mesh read_by_assimp(const std::filesystem::path& path) {
    Assimp::Importer importer;
    prep::Mesh mesh;
    const aiScene* const scene = importer.ReadFile(path.string(), 0);
    EXPECT_NE(scene, nullptr) << importer.GetErrorString();
    for (unsigned m = 0; scene && m < scene->mNumMeshes; ++m) {
        const aiMesh& part = *scene->mMeshes[m];
        const auto first = std::uint32_t(mesh.positions.size());
        for (unsigned v = 0; v < part.mNumVertices; ++v)
            mesh.positions.emplace_back(part.mVertices[v].x, part.mVertices[v].y,
                                        part.mVertices[v].z);
        for (unsigned f = 0; f < part.mNumFaces; ++f) {
            const aiFace& face = part.mFaces[f];
            EXPECT_EQ(face.mNumIndices, 3U);
            tessellation_checks::add_face(mesh, {first + face.mIndices[0], first + face.mIndices[1],
                                                 first + face.mIndices[2]});
        }
    }
    return mesh;
}

prep::Mesh read_by_gltf_transform(const test::DecodedGltf& file) {
    prep::Mesh mesh;
    for (const auto& primitive : file.json["meshes"][0]["primitives"]) {
        const auto first = std::uint32_t(mesh.positions.size());
        const std::vector<double> points = file.numbers(primitive["attributes"]["POSITION"]);
        for (std::size_t k = 0; k + 2 < points.size(); k += 3)
            mesh.positions.emplace_back(points[k], points[k + 1], points[k + 2]);
        const std::vector<double> indices = file.numbers(primitive["indices"]);
        for (std::size_t k = 0; k + 2 < indices.size(); k += 3)
            tessellation_checks::add_face(
                mesh, {first + std::uint32_t(indices[k]), first + std::uint32_t(indices[k + 1]),
                       first + std::uint32_t(indices[k + 2])});
    }
    return mesh;
}

class DisplacedFiles : public testing::Test {
  protected:
    DisplacedFiles() {
        std::mt19937 random(7);
        prep::Image image{.width = 64, .height = 64, .channels = 1, .pixels = {}};
        for (int k = 0; k < 64 * 64; ++k)
            image.pixels.push_back(float(double(random()) / 4294967296.0));
        const auto saved = prep::save_image(dir_ / "map.exr", image, prep::PixelType::f32);
        EXPECT_TRUE(saved) << to_string(saved.error());
    }

    // By its number: with a limit surface of either scheme or the polygons, as GLB and OBJ. The
    // Euler number.
    std::int64_t write(int seed) {
        std::mt19937 random{std::uint32_t(seed)};
        Cage cage = random_cage(random);
        corners_ = {std::min(corners_[0], cage.fewest_corners),
                    std::max(corners_[1], cage.most_corners)};
        highest_valence_ = std::max(highest_valence_, cage.highest_valence);
        if (seed % 4 == 3) cut_into_triangles(cage);
        const std::string in = (dir_ / "cage.obj").string();
        std::string text = obj_of(cage, random);
        if (seed % 4 >= 2) text += random_creases(cage, random);
        test::write_text(in, text);
        for (const char* const ending : {".glb", ".obj"}) {
            std::vector<std::string> options = {
                "prepare",           in,           "-o",
                name(seed) + ending, "--displace", (dir_ / "map.exr").string(),
                "--height-scale",    "0.06"};
            const char* const errors[] = {"0.03", "0.012", "0.006"};
            // Where a cage folds its limit surface the normal jumps, and no error is ever reached.
            options.insert(options.end(),
                           {"--chord-error", errors[seed % 3], "--max-triangles", "12k"});
            if (seed % 2 == 0) options.insert(options.end(), {"--subdivide", "catmark"});
            if (seed % 4 == 3) options.insert(options.end(), {"--subdivide", "loop"});
            // Edges that an angle calls hard are infinitely sharp.
            if (seed % 4 == 0) options.insert(options.end(), {"--crease-from", "hard-edges"});
            const test::Ran ran = test::run_here(options);
            EXPECT_EQ(ran.exit_code, 0) << seed << ": " << ran.err;
        }
        return 2 - 2 * cage.genus;
    }
    std::string name(int seed) const { return (dir_ / ("out" + std::to_string(seed))).string(); }

    void expect_even(const prep::Mesh& mesh, int seed) {
        std::mt19937 random{std::uint32_t(seed)};
        const int views = std::getenv("MESHPREP_LONG_TESTS") ? 20 : 4;
        std::size_t hit = 0;
        for (int view = 0; view < views; ++view)
            EXPECT_EQ(uneven_pixels(mesh, random, hit), 0U) << seed << ", view " << view;
        EXPECT_GT(hit, 100U * std::size_t(views));  // long ones have fewer from their ends
    }

    void expect_closed(const prep::Mesh& mesh, std::int64_t euler, const std::string& what) {
        const Closedness c = closedness(mesh);
        EXPECT_EQ(c.open_edges, 0U) << what;
        EXPECT_EQ(c.zero_edges, 0U) << what;
        EXPECT_EQ(c.euler, euler) << what;
        triangles_ += mesh.face_count();
    }

    test::TempDir dir_;
    std::array<std::size_t, 2> corners_{99, 0};
    std::size_t highest_valence_ = 0;
    std::uint64_t triangles_ = 0;
};

TEST_F(DisplacedFiles, AreClosedInWhatOthersRead) {
    const int count = std::getenv("MESHPREP_LONG_TESTS") ? 200 : 12;
    std::vector<std::filesystem::path> files;
    std::vector<std::int64_t> eulers;
    for (int seed = 0; seed < count; ++seed) {
        eulers.push_back(write(seed));
        for (const char* const ending : {".glb", ".obj"}) {
            const prep::Mesh mesh = read_by_assimp(name(seed) + ending);
            expect_closed(mesh, eulers.back(), "Assimp, " + std::to_string(seed) + ending);
            if (ending == std::string(".glb")) expect_even(mesh, seed);
        }
        files.emplace_back(name(seed) + ".glb");
    }
    EXPECT_EQ(corners_[0], 3U);
    EXPECT_GE(corners_[1], count > 100 ? 8U : 6U);
    EXPECT_GE(highest_valence_, count > 100 ? 18U : 8U);
    std::printf(
        "%d cages, faces of %zu to %zu corners, up to %zu around a vertex, %llu triangles "
        "read\n",
        count, corners_[0], corners_[1], highest_valence_, (unsigned long long)triangles_);
    // A hole is seen.
    prep::Mesh open = read_by_assimp(name(0) + ".glb");
    std::mt19937 random(1);
    open.face_offsets.resize(open.face_count() * 7 / 8);
    std::size_t hit = 0;
    EXPECT_GT(uneven_pixels(open, random, hit), 10U);
    MESHPREP_REQUIRE_GLTF_TRANSFORM(modules);
    const auto decoded = test::decode_gltf(modules, files, dir_.path());
    ASSERT_TRUE(decoded);
    for (std::size_t k = 0; k < files.size(); ++k) {
        ASSERT_FALSE((*decoded)[k].json.contains("error")) << (*decoded)[k].json["error"];
        expect_closed(read_by_gltf_transform((*decoded)[k]), eulers[k],
                      "gltf-transform, " + std::to_string(k));
    }
}

}  // namespace
