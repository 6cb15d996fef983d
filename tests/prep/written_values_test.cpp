// What the writers of OBJ, PLY, STL and OFF write, read by small parsers of these tests' own and
// held against the definitions: positions by the matrix, normals by its inverse transpose, tangents
// by the matrix, v from the bottom, the front side in front also of mirrored instances.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <sstream>
#include <string>

#include "mesh_files.h"
#include "prep/save.h"

namespace {

namespace fs = std::filesystem;

struct Corner {
    glm::dvec3 position{0}, normal{0};
    glm::dvec4 tangent{0};
    glm::dvec2 uv{0};  // as files have it: v from the bottom
};
using Face = std::vector<Corner>;
using Segment = std::array<glm::dvec3, 2>;

struct Content {
    std::vector<Face> faces;
    std::vector<Segment> segments;
};

// A slanted quad with a line, and a triangle with another; normals, UVs and tangents at corners.
prep::Scene two_meshes() {
    prep::Scene scene;
    for (const std::size_t corners : {4u, 3u}) {
        prep::Mesh mesh;
        mesh.name = corners == 4 ? "quad" : "triangle";
        mesh.positions = {{0, 0, 0}, {1, 0, 0.5f}, {1, 1, 1}, {0, 1, 0.5f}};
        mesh.positions.resize(corners);
        mesh.face_offsets = {0, std::uint32_t(corners)};
        for (std::uint32_t c = 0; c < corners; ++c) {
            mesh.corner_vertices.push_back(c);
            mesh.normals.values.push_back(corners == 4 ? glm::vec3(-0.6f, 0, 0.8f)
                                                       : glm::vec3(0, -0.6f, 0.8f));
            mesh.tangents.values.push_back({0.8f, 0, 0.6f, corners == 4 ? 1.0f : -1.0f});
        }
        mesh.normals.indices = mesh.tangents.indices = mesh.corner_vertices;
        mesh.uvs.push_back(
            {{{0, 0}, {0.25f, 0}, {0.5f, 0.75f}, {0, 0.125f}}, mesh.corner_vertices});
        mesh.uvs[0].values.resize(corners);
        if (corners == 3)
            for (glm::vec2& uv : mesh.uvs[0].values) uv.x += 0.5f;
        mesh.line_offsets = {0, 2};
        mesh.line_vertices = {corners == 4 ? 0u : 1u, 2};
        scene.meshes.push_back(std::move(mesh));
    }
    return scene;
}

// The quad as it is, the triangle scaled unevenly, turned and moved, the quad again in a mirror.
prep::Scene instances() {
    prep::Scene scene = two_meshes();
    scene.nodes.resize(3);
    scene.nodes[0].mesh = scene.nodes[2].mesh = 0;
    scene.nodes[1].mesh = 1;
    // Columns: (0, 2, 0), (−1, 0, 0), (0, 0, 0.5); then moved.
    scene.nodes[1].transform = glm::dmat4(0, 2, 0, 0, -1, 0, 0, 0, 0, 0, 0.5, 0, 3, 4, 5, 1);
    scene.nodes[2].transform = glm::dmat4(-1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 4, 0, 10, 0, 0, 1);
    return scene;
}

Content expected(const prep::Scene& scene) {
    Content all;
    for (const prep::Node& node : scene.nodes) {
        const prep::Mesh& mesh = scene.meshes[node.mesh];
        const glm::dmat3 linear(node.transform);
        const glm::dmat3 for_normals = glm::transpose(glm::inverse(linear));
        const bool mirrored = glm::determinant(linear) < 0;
        const auto place = [&](std::uint32_t v) {
            return glm::dvec3(node.transform *
                              glm::dvec4(glm::dvec3(mesh.positions[v]) + mesh.origin, 1));
        };
        Face face;
        for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
            Corner corner;
            corner.position = place(mesh.corner_vertices[c]);
            corner.normal = glm::normalize(for_normals * glm::dvec3(mesh.normals.values[c]));
            const glm::dvec4 t(mesh.tangents.values[c]);
            corner.tangent =
                glm::dvec4(glm::normalize(linear * glm::dvec3(t)), mirrored ? -t.w : t.w);
            corner.uv = {mesh.uvs[0].values[c].x, 1 - mesh.uvs[0].values[c].y};
            face.push_back(corner);
        }
        if (mirrored) std::reverse(face.begin(), face.end());
        all.faces.push_back(face);
        all.segments.push_back({place(mesh.line_vertices[0]), place(mesh.line_vertices[1])});
    }
    return all;
}

double difference(const Corner& a, const Corner& b, bool normals, bool tangents, bool uvs) {
    double worst = glm::length(a.position - b.position);
    if (normals) worst = std::max(worst, glm::length(a.normal - b.normal));
    if (tangents) worst = std::max(worst, glm::length(a.tangent - b.tangent));
    if (uvs) worst = std::max(worst, glm::length(a.uv - b.uv));
    return worst;
}

// A face may begin at any of its corners.
void expect_same(const Content& found, const Content& wanted, bool tangents = false,
                 bool segments = true) {
    ASSERT_EQ(found.faces.size(), wanted.faces.size());
    for (std::size_t f = 0; f < wanted.faces.size(); ++f) {
        const std::size_t corners = wanted.faces[f].size();
        ASSERT_EQ(found.faces[f].size(), corners);
        double best = 1e9;
        for (std::size_t turn = 0; turn < corners; ++turn) {
            double worst = 0;
            for (std::size_t c = 0; c < corners; ++c)
                worst = std::max(
                    worst, difference(found.faces[f][c], wanted.faces[f][(c + turn) % corners],
                                      true, tangents, true));
            best = std::min(best, worst);
        }
        // Unit vectors and UVs are written as floats: some 2^-24 a component.
        EXPECT_LT(best, 3e-7) << "face " << f;
    }
    if (!segments) return;
    ASSERT_EQ(found.segments.size(), wanted.segments.size());
    for (std::size_t s = 0; s < wanted.segments.size(); ++s)
        EXPECT_EQ(found.segments[s], wanted.segments[s]) << s;
}

std::vector<std::string> words_of(const std::string& line) {
    std::istringstream in(line);
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    return words;
}

std::vector<std::vector<std::string>> lines_of(const fs::path& path) {
    std::istringstream in(test::file_text(path));
    std::vector<std::vector<std::string>> lines;
    for (std::string line; std::getline(in, line);)
        if (!line.empty() && line[0] != '#') lines.push_back(words_of(line));
    return lines;
}

glm::dvec3 three(const std::vector<std::string>& words, std::size_t from) {
    return {std::stod(words.at(from)), std::stod(words.at(from + 1)),
            std::stod(words.at(from + 2))};
}

Content read_obj(const fs::path& path) {
    Content all;
    std::vector<glm::dvec3> v, vn;
    std::vector<glm::dvec2> vt;
    for (const auto& words : lines_of(path)) {
        if (words[0] == "v") v.push_back(three(words, 1));
        if (words[0] == "vn") vn.push_back(three(words, 1));
        if (words[0] == "vt") vt.push_back({std::stod(words[1]), std::stod(words[2])});
        if (words[0] == "l")
            all.segments.push_back(
                {v.at(std::stoul(words[1]) - 1), v.at(std::stoul(words[2]) - 1)});
        if (words[0] != "f") continue;
        Face face;
        for (std::size_t k = 1; k < words.size(); ++k) {
            std::size_t i = 0, j = 0, n = 0;
            EXPECT_EQ(std::sscanf(words[k].c_str(), "%zu/%zu/%zu", &i, &j, &n), 3);
            face.push_back({v.at(i - 1), vn.at(n - 1), {}, vt.at(j - 1)});
        }
        all.faces.push_back(face);
    }
    return all;
}

// Text only; properties by their names.
Content read_ply(const fs::path& path) {
    Content all;
    std::istringstream in(test::file_text(path));
    std::vector<std::pair<std::string, std::size_t>> elements;
    std::vector<std::string> properties;  // of the vertices
    for (std::string line; std::getline(in, line) && line != "end_header";) {
        const auto words = words_of(line);
        if (words[0] == "element") elements.push_back({words[1], std::stoul(words[2])});
        if (words[0] == "property" && elements.size() == 1) properties.push_back(words[2]);
    }
    std::vector<Corner> vertices;
    for (const auto& [name, count] : elements)
        for (std::size_t i = 0; i < count; ++i) {
            if (name == "vertex") {
                std::map<std::string, double> p;
                for (const std::string& property : properties) in >> p[property];
                vertices.push_back({{p["x"], p["y"], p["z"]},
                                    {p["nx"], p["ny"], p["nz"]},
                                    {p["tx"], p["ty"], p["tz"], p["tw"]},
                                    {p["s"], p["t"]}});
                continue;
            }
            std::size_t corners = 2;
            if (name == "face") in >> corners;
            Face face;
            for (std::size_t k = 0; k < corners; ++k) {
                std::size_t v = 0;
                in >> v;
                face.push_back(vertices.at(v));
            }
            if (name == "face")
                all.faces.push_back(face);
            else
                all.segments.push_back({face[0].position, face[1].position});
        }
    return all;
}

// STNOFF: position, normal, texture. Faces of two corners are segments.
Content read_off(const fs::path& path) {
    Content all;
    const auto lines = lines_of(path);
    EXPECT_EQ(lines.at(0).at(0), "STNOFF");
    const std::size_t count = std::stoul(lines.at(1).at(0));
    const auto vertex = [&](const std::string& index) {
        const auto& words = lines.at(2 + std::stoul(index));
        return Corner{
            three(words, 0), three(words, 3), {}, {std::stod(words.at(6)), std::stod(words.at(7))}};
    };
    for (std::size_t f = 2 + count; f < lines.size(); ++f) {
        Face face;
        for (std::size_t k = 1; k < lines[f].size(); ++k) face.push_back(vertex(lines[f][k]));
        EXPECT_EQ(std::to_string(face.size()), lines[f][0]);
        if (face.size() == 2)
            all.segments.push_back({face[0].position, face[1].position});
        else
            all.faces.push_back(face);
    }
    return all;
}

void save(const prep::Scene& scene, const fs::path& path, bool ascii = false) {
    prep::SaveOptions options;
    options.ascii = ascii;
    const auto saved = prep::save_scene(test::untouched(scene), path, options);
    ASSERT_TRUE(saved.has_value()) << prep::to_string(saved.error());
}

TEST(WrittenInstances, StandWhereTheirNodesPutThemInObj) {
    const test::TempDir dir;
    prep::Scene scene = instances();
    scene.meshes[1].subdivision.creases = {{0, 1, 2.5f}};
    scene.meshes[1].subdivision.corners = {{2, 3}};
    scene.meshes[1].subdivision.holes = {0};
    scene.meshes[1].points = {2};
    save(scene, dir / "a.obj");
    expect_same(read_obj(dir / "a.obj"), expected(scene));
    // Tags count from 0; four vertices and a face stand before the triangle's. Points from 1.
    std::vector<std::vector<std::string>> tags;
    for (const auto& words : lines_of(dir / "a.obj"))
        if (words[0] == "t" || words[0] == "p") tags.push_back(words);
    EXPECT_EQ(tags,
              (std::vector<std::vector<std::string>>{{"p", "7"},
                                                     {"t", "crease", "2/1/0", "4", "5", "2.5"},
                                                     {"t", "corner", "1/1/0", "6", "3"},
                                                     {"t", "hole", "1/0/0", "1"}}));
}

TEST(WrittenInstances, StandWhereTheirNodesPutThemInPly) {
    const test::TempDir dir;
    const prep::Scene scene = instances();
    const prep::PreparedScene prepared = test::untouched(scene);
    ASSERT_FALSE(prepared.meshes[0].tangents.empty());
    save(scene, dir / "a.ply", true);
    expect_same(read_ply(dir / "a.ply"), expected(scene), true);
}

TEST(WrittenInstances, StandWhereTheirNodesPutThemInOff) {
    const test::TempDir dir;
    const prep::Scene scene = instances();
    save(scene, dir / "a.off");
    expect_same(read_off(dir / "a.off"), expected(scene));
}

// Triangles of the same planes, and as much of each: the fan is the writer's choice.
TEST(WrittenInstances, StandWhereTheirNodesPutThemInStl) {
    const test::TempDir dir;
    const prep::Scene scene = instances();
    save(scene, dir / "a.stl");
    save(scene, dir / "b.stl", true);
    const std::string bytes = test::file_text(dir / "a.stl");
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, 4);
    ASSERT_EQ(count, 5u);
    ASSERT_EQ(bytes.size(), 84u + 5 * 50);
    const Content wanted = expected(scene);
    const auto text = lines_of(dir / "b.stl");
    std::size_t line = 1;
    for (std::size_t t = 0; t < 5; ++t) {
        glm::vec3 facet[4];  // the normal, then the corners
        std::memcpy(facet, bytes.data() + 84 + 50 * t, 48);
        // In text the same numbers.
        EXPECT_EQ(glm::vec3(three(text.at(line), 2)), facet[0]);
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_EQ(glm::vec3(three(text.at(line + 2 + k), 1)), facet[1 + k]);
        line += 7;
        const Face& face = wanted.faces[t < 2 ? 0 : t < 3 ? 1 : 2];
        const glm::dvec3 plane = glm::normalize(
            glm::cross(face[1].position - face[0].position, face[2].position - face[0].position));
        EXPECT_LT(glm::length(glm::dvec3(facet[0]) - plane), 1e-6) << t;
        const glm::dvec3 area =
            glm::cross(glm::dvec3(facet[2] - facet[1]), glm::dvec3(facet[3] - facet[1]));
        EXPECT_LT(glm::length(glm::normalize(area) - plane), 1e-6) << t;
        for (std::size_t k = 1; k < 4; ++k) {
            const bool there = std::any_of(face.begin(), face.end(), [&](const Corner& c) {
                return glm::vec3(c.position) == facet[k];
            });
            EXPECT_TRUE(there) << t;
        }
    }
}

// The same for one mesh about an origin far away, where no node moves anything.
TEST(WrittenInstances, OriginsAreAddedInEveryFormat) {
    const test::TempDir dir;
    prep::Scene scene = two_meshes();
    scene.meshes.pop_back();
    scene.meshes[0].origin = {5e6, -3e6, 0.0625};
    prep::instance_unused_meshes(scene);
    const Content wanted = expected(scene);
    save(scene, dir / "a.obj");
    expect_same(read_obj(dir / "a.obj"), wanted);
    save(scene, dir / "a.ply", true);
    expect_same(read_ply(dir / "a.ply"), wanted, true);
    save(scene, dir / "a.off");
    expect_same(read_off(dir / "a.off"), wanted);
}

TEST(WrittenPly, FacesOfMoreThan255CornersKeepTheirLength) {
    const test::TempDir dir;
    for (const std::uint32_t corners : {255u, 256u, 300u}) {
        prep::Scene scene;
        scene.meshes.emplace_back();
        prep::Mesh& mesh = scene.meshes[0];
        for (std::uint32_t c = 0; c < corners; ++c) {
            const double angle = 6.283185307179586 * c / corners;
            mesh.positions.push_back({float(std::cos(angle)), float(std::sin(angle)), 0});
            mesh.corner_vertices.push_back(c);
        }
        mesh.face_offsets = {0, corners};
        prep::instance_unused_meshes(scene);
        save(scene, dir / "a.ply", true);
        const Content found = read_ply(dir / "a.ply");
        ASSERT_EQ(found.faces.size(), 1u);
        EXPECT_EQ(found.faces[0].size(), corners);
        const std::string type = corners == 255 ? "list uchar" : "list uint";
        EXPECT_NE(test::file_text(dir / "a.ply").find(type), std::string::npos);
    }
}

// Materials that the triangle's faces use, in turn.
prep::Scene with_materials(const std::vector<prep::Material>& materials) {
    prep::Scene scene = two_meshes();
    prep::Mesh triangle = scene.meshes[1];
    triangle.line_offsets = {0};
    triangle.line_vertices.clear();
    scene.meshes = {triangle};
    prep::Mesh& mesh = scene.meshes[0];
    for (std::uint32_t m = 1; m < materials.size(); ++m) {
        mesh.face_offsets.push_back(3 * (m + 1));
        for (auto* indices : {&mesh.corner_vertices, &mesh.normals.indices, &mesh.tangents.indices,
                              &mesh.uvs[0].indices})
            indices->insert(indices->end(), {0, 1, 2});
    }
    for (std::uint32_t m = 0; m < materials.size(); ++m) mesh.face_materials.push_back(m);
    scene.materials = materials;
    prep::instance_unused_meshes(scene);
    return scene;
}

TEST(WrittenMtl, MaterialsOfOneNameStayApart) {
    const test::TempDir dir;
    std::vector<prep::Material> materials(4);
    for (std::size_t m = 0; m < 4; ++m) {
        materials[m].name = m == 2 ? "red_2" : m == 3 ? "" : "red";
        materials[m].diffuse = {0.25f * float(m), 0, 0, 1};
    }
    save(with_materials(materials), dir / "a.obj");
    std::map<std::string, std::string> reds;
    std::string name;
    for (const auto& words : lines_of(dir / "a.mtl")) {
        if (words.empty()) continue;
        if (words[0] == "newmtl") name = words.at(1);
        if (words[0] == "Kd") {
            EXPECT_TRUE(reds.emplace(name, words.at(1)).second) << name;
        }
    }
    std::vector<std::string> used;
    for (const auto& words : lines_of(dir / "a.obj"))
        if (words[0] == "usemtl") used.push_back(reds.at(words.at(1)));
    EXPECT_EQ(used, (std::vector<std::string>{"0", "0.25", "0.5", "0.75"}));
}

// 2/α² − 2 with α = 0.5² is 30; 4 % spread over the lobe by (30 + 2)/8 + 1/(2 · 30 + 4).
TEST(WrittenMtl, MetallicRoughnessBecomesBlinnPhong) {
    const test::TempDir dir;
    prep::Material material;
    material.name = "m";
    material.metallic_roughness = true;
    material.metallic = 0;
    material.roughness = 0.5f;
    material.emissive = {0.5f, 0.25f, 0.125f};
    material.ambient = glm::vec3(1);
    save(with_materials({material}), dir / "a.obj");
    std::map<std::string, double> first;
    for (const auto& words : lines_of(dir / "a.mtl"))
        if (words.size() > 1 && words[0] != "newmtl") first[words[0]] = std::stod(words[1]);
    EXPECT_NEAR(first["Ns"], 30, 1e-4);
    EXPECT_NEAR(first["Ks"], 0.04 * (4 + 1.0 / 64), 1e-6);
    EXPECT_EQ(first["Ke"], 0.5);
    EXPECT_EQ(first["Ka"], 1);
}

TEST(WrittenMtl, EmbeddedPicturesStandBesideItUnderTheirOwnEnding) {
    const test::TempDir dir;
    std::vector<prep::Material> materials(2);
    prep::Scene scene = with_materials(materials);
    const std::string bytes[] = {"\x89PNG\r\n\x1a\n and so on", "\xff\xd8\xff\xe0 and so on"};
    for (std::uint32_t m = 0; m < 2; ++m) {
        prep::ImageRef image;
        const auto* begin = reinterpret_cast<const std::byte*>(bytes[m].data());
        image.bytes.assign(begin, begin + bytes[m].size());
        scene.images.push_back(image);
        scene.textures.emplace_back().image = m;
        scene.materials[m].name = m == 0 ? "png" : "jpg";
        scene.materials[m].diffuse_map.texture = m;
    }
    scene.materials[0].diffuse_map.scale = {2, 4};
    scene.materials[0].diffuse_map.offset = {0.25f, -3.5f};
    save(scene, dir / "a.obj");
    EXPECT_EQ(test::file_text(dir / "a_image0.png"), bytes[0]);
    EXPECT_EQ(test::file_text(dir / "a_image1.jpg"), bytes[1]);
    std::vector<std::vector<std::string>> maps;
    for (const auto& words : lines_of(dir / "a.mtl"))
        if (!words.empty() && words[0] == "map_Kd") maps.push_back(words);
    // v = 1 − (1 − v) · 4 − 0.5 there is (1 − v) · 4 + 0.5 from the bottom.
    EXPECT_EQ(maps, (std::vector<std::vector<std::string>>{
                        {"map_Kd", "-s", "2", "4", "1", "-o", "0.25", "0.5", "0", "a_image0.png"},
                        {"map_Kd", "a_image1.jpg"}}));
}

}  // namespace
