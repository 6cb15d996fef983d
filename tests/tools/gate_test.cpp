// The gate of `meshprep diff`: what changes nothing raises no alarm, what changes something is
// found and told for what it is. Scenes are changed in memory here, by rules that are written out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <random>
#include <set>

#include "command_runner.h"
#include "gltf_oracle.h"
#include "judge/judged_views.h"
#include "judge/judgement.h"
#include "mesh_files.h"
#include "npm_tools.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shapes.h"
#include "shared_data.h"

namespace {

using prep::CornerLayer;
using prep::Mesh;
using prep::no_index;
using prep::Scene;
using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
    return low + (high - low) * double(random() >> 11) * 0x1p-53;
}
std::size_t below(Random& random, std::size_t count) {
    return std::size_t(random() % count);
}

// A layer with an entry for each corner.
template <class T, class F>
CornerLayer<T> by_corner(const Mesh& mesh, const F& value) {
    CornerLayer<T> layer;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        layer.values.push_back(value(c, glm::dvec3(mesh.positions[mesh.corner_vertices[c]])));
        layer.indices.push_back(c);
    }
    return layer;
}

// A torus of two materials with everything that a mesh can carry, and two balls, one mirrored.
Scene rich_scene(Random& random, int around = 28) {
    Scene scene;
    scene.source = "rich";
    for (int m = 0; m < 3; ++m) {
        prep::Material material;
        material.name = "paint " + std::to_string(m);
        material.metallic_roughness = true;
        material.diffuse = glm::vec4(0.2f + 0.3f * float(m), 0.9f - 0.4f * float(m), 0.3f, 1);
        material.roughness = 0.3f + 0.2f * float(m);
        if (m < 2) material.diffuse_map.texture = std::uint32_t(m);
        scene.materials.push_back(material);
    }
    for (int i = 0; i < 2; ++i) {
        prep::Image picture{4, 4, 3, {}, true};
        for (int k = 0; k < 48; ++k) picture.pixels.push_back(float(below(random, 256)) / 255.0f);
        prep::ImageRef image;
        image.name = "picture " + std::to_string(i);
        image.bytes = *prep::encode_png(picture);
        image.mime_type = "image/png";
        scene.images.push_back(image);
        prep::Texture texture;
        texture.image = std::uint32_t(i);
        scene.textures.push_back(texture);
    }
    Mesh torus = shapes::fan_triangulated(shapes::torus(around, around / 2));
    shapes::jitter(torus, 0.01f, random);
    torus.name = "torus";
    torus.normals = by_corner<glm::vec3>(torus, [](std::uint32_t, const glm::dvec3& p) {
        const double r = std::hypot(p.x, p.y);
        return glm::vec3(glm::normalize(p - glm::dvec3(p.x / r, p.y / r, 0)));
    });
    torus.tangents = by_corner<glm::vec4>(torus, [](std::uint32_t, const glm::dvec3& p) {
        return glm::vec4(glm::vec3(glm::normalize(glm::dvec3(-p.y, p.x, 0))), p.z < 0 ? -1 : 1);
    });
    for (int set = 0; set < 2; ++set)
        torus.uvs.push_back(by_corner<glm::vec2>(torus, [&](std::uint32_t, const glm::dvec3& p) {
            return glm::vec2(glm::dvec2(std::atan2(p.y, p.x), p.z + set) * (1.0 + set));
        }));
    torus.colors.push_back(by_corner<glm::vec4>(torus, [](std::uint32_t, const glm::dvec3& p) {
        return glm::vec4(glm::vec3(p * 0.2 + 0.5), 1);
    }));
    for (std::uint32_t f = 0; f < torus.face_count(); ++f)
        torus.face_materials.push_back(f % 7 < 4 ? 0 : 1);
    prep::SkinInfluences set;
    auto bend = std::make_shared<std::vector<glm::vec3>>();
    for (const glm::vec3& p : torus.positions) {
        const float w = std::clamp(p.x * 0.3f + 0.5f, 0.0f, 1.0f);
        set.joints.push_back({0, 1, 2, 0});
        set.weights.push_back(glm::vec4(w, (1 - w) * 0.75f, (1 - w) * 0.25f, 0));
        bend->push_back(glm::vec3(0, 0, p.x * p.x * 0.1f));
    }
    torus.skin_influences = {set};
    prep::MorphTarget target;
    target.name = "bend";
    target.positions = {{0, bend}};
    torus.morph_targets = {target};
    Mesh ball = shapes::icosphere(2);
    ball.name = "ball";
    ball.normals = by_corner<glm::vec3>(
        ball, [](std::uint32_t, const glm::dvec3& p) { return glm::vec3(glm::normalize(p)); });
    ball.uvs.push_back(by_corner<glm::vec2>(
        ball, [](std::uint32_t, const glm::dvec3& p) { return glm::vec2(p.x, p.z); }));
    ball.face_materials.assign(ball.face_count(), 2);
    scene.meshes = {torus, ball};
    const auto node = [&](const char* name, std::uint32_t parent, const glm::dvec3& at,
                          const glm::dvec3& scale, std::uint32_t mesh) {
        prep::Node n;
        n.name = name;
        n.parent = parent;
        n.transform =
            glm::dmat4(scale.x, 0, 0, 0, 0, scale.y, 0, 0, 0, 0, scale.z, 0, at.x, at.y, at.z, 1);
        n.mesh = mesh;
        scene.nodes.push_back(n);
        return std::uint32_t(scene.nodes.size() - 1);
    };
    const std::uint32_t root = node("root", no_index, {0, 0, 0}, {1, 1, 1}, no_index);
    const std::uint32_t ring = node("ring", no_index, {0, 0, 0}, {1, 1, 1}, 0);
    node("left", root, {-2.5, 0.25, 0}, {0.5, 0.5, 0.5}, 1);
    node("right", root, {2.5, -0.25, 0.5}, {-0.5, 0.75, 0.5}, 1);
    prep::Skin skin;
    for (int j = 0; j < 3; ++j) {
        skin.joints.push_back(node("joint", root, {double(j) - 1, 0.5, 0}, {1, 1, 1}, no_index));
        glm::mat4 inverse(1.0f);
        inverse[3] = glm::vec4(1 - float(j), -0.5f, 0, 1);
        skin.inverse_bind.push_back(inverse);
    }
    scene.skins = {skin};
    scene.nodes[ring].skin = 0;
    prep::Animation wave;
    wave.name = "wave";
    wave.samplers.push_back(
        {prep::Interpolation::linear,
         std::make_shared<const std::vector<float>>(std::vector<float>{0, 1}),
         std::make_shared<const std::vector<float>>(std::vector<float>{0, 0, 0, 1, 0, 0})});
    wave.channels.push_back({0, skin.joints[0], prep::AnimationPath::translation});
    scene.animations = {wave};
    return scene;
}

// --- Changes that change nothing
// ------------------------------------------------------------------

template <class T>
void take_layer(CornerLayer<T>& layer, const std::vector<std::uint32_t>& corners) {
    if (layer.empty()) return;
    CornerLayer<T> out;
    for (const std::uint32_t c : corners) out.indices.push_back(layer.indices[c]);
    out.values = layer.values;
    layer = out;
}

// Faces in another order, each begun at another corner.
void shuffle_faces(Mesh& mesh, Random& random) {
    const std::vector<std::uint32_t> order = shapes::random_order(mesh.face_count(), random);
    std::vector<std::uint32_t> corners, materials;
    for (const std::uint32_t f : order) {
        const std::uint32_t first = mesh.face_offsets[f], count = mesh.face_offsets[f + 1] - first;
        const std::uint32_t turn = std::uint32_t(below(random, count));
        for (std::uint32_t i = 0; i < count; ++i) corners.push_back(first + (i + turn) % count);
        materials.push_back(mesh.face_materials[f]);
    }
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t c : corners) vertices.push_back(mesh.corner_vertices[c]);
    mesh.corner_vertices = vertices;  // all faces are triangles: offsets stay
    mesh.face_materials = materials;
    take_layer(mesh.normals, corners);
    take_layer(mesh.tangents, corners);
    for (auto& layer : mesh.uvs) take_layer(layer, corners);
    for (auto& layer : mesh.colors) take_layer(layer, corners);
}

void shuffle_vertices(Mesh& mesh, Random& random) {
    const std::vector<std::uint32_t> order = shapes::random_order(mesh.vertex_count(), random);
    std::vector<std::uint32_t> place(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
    const auto taken = [&](const auto& list) {
        auto out = list;
        for (std::size_t i = 0; i < order.size(); ++i) out[i] = list[order[i]];
        return out;
    };
    mesh.positions = taken(mesh.positions);
    for (std::uint32_t& v : mesh.corner_vertices) v = place[v];
    for (prep::SkinInfluences& set : mesh.skin_influences) {
        set.joints = taken(set.joints);
        set.weights = taken(set.weights);
    }
    for (prep::MorphTarget& target : mesh.morph_targets)
        for (prep::VertexDeltas& run : target.positions)
            run.values = std::make_shared<const std::vector<glm::vec3>>(taken(*run.values));
}

float next(float v, Random& random) {
    const std::uint64_t r = random() % 3;
    return r == 0 ? v : std::nextafter(v, r == 1 ? INFINITY : -INFINITY);
}
template <int N>
void round_list(std::vector<glm::vec<N, float>>& list, Random& random, int components = N) {
    for (auto& v : list)
        for (int k = 0; k < components; ++k) v[k] = next(v[k], random);
}
void round_last_bits(Mesh& mesh, Random& random) {
    round_list<3>(mesh.positions, random);
    round_list<3>(mesh.normals.values, random);
    round_list<4>(mesh.tangents.values, random, 3);
    for (auto& layer : mesh.uvs) round_list<2>(layer.values, random);
    for (auto& layer : mesh.colors) round_list<4>(layer.values, random);
    for (prep::SkinInfluences& set : mesh.skin_influences) round_list<4>(set.weights, random, 3);
}

void rename(Scene& scene, Random& random) {
    for (prep::Node& node : scene.nodes) node.name = "n" + std::to_string(random() % 100);
    for (Mesh& mesh : scene.meshes) mesh.name = "m" + std::to_string(random() % 100);
    for (prep::Material& material : scene.materials) material.name.clear();
}

// Meshes, materials and joints in another order.
void reorder_lists(Scene& scene, Random& random) {
    const auto turned = [&](auto& list) {
        const std::vector<std::uint32_t> order = shapes::random_order(list.size(), random);
        auto out = list;
        std::vector<std::uint32_t> place(order.size());
        for (std::uint32_t i = 0; i < order.size(); ++i) {
            out[i] = list[order[i]];
            place[order[i]] = i;
        }
        list = out;
        return place;
    };
    const auto meshes = turned(scene.meshes), materials = turned(scene.materials);
    for (prep::Node& node : scene.nodes)
        if (node.mesh != no_index) node.mesh = meshes[node.mesh];
    for (Mesh& mesh : scene.meshes)
        for (std::uint32_t& m : mesh.face_materials) m = materials[m];
    prep::Skin& skin = scene.skins[0];
    const auto joints = turned(skin.joints);
    std::vector<glm::mat4> inverse(skin.inverse_bind.size());
    for (std::size_t j = 0; j < joints.size(); ++j) inverse[joints[j]] = skin.inverse_bind[j];
    skin.inverse_bind = inverse;
    for (Mesh& mesh : scene.meshes)
        for (prep::SkinInfluences& set : mesh.skin_influences)
            for (auto& four : set.joints)
                for (int k = 0; k < 4; ++k) four[k] = std::uint16_t(joints[four[k]]);
}

// A node between the balls and their parent: the same places by two matrices.
void split_transforms(Scene& scene) {
    prep::Node middle;
    middle.parent = scene.nodes[2].parent;
    middle.transform = glm::dmat4(2.0);
    middle.transform[3] = glm::dvec4(1, 2, 3, 1);
    const glm::dmat4 back = glm::inverse(middle.transform);
    scene.nodes.push_back(middle);
    for (const std::size_t n : {2, 3}) {
        scene.nodes[n].transform = back * scene.nodes[n].transform;
        scene.nodes[n].parent = std::uint32_t(scene.nodes.size() - 1);
    }
}

// Two of these at least, by the bits of `which`.
Scene harmless(Scene scene, std::uint64_t which, Random& random) {
    for (Mesh& mesh : scene.meshes) {
        if ((which & 1) != 0) shuffle_faces(mesh, random);
        if ((which & 2) != 0) shuffle_vertices(mesh, random);
        if ((which & 4) != 0) round_last_bits(mesh, random);
    }
    if ((which & 8) != 0) rename(scene, random);
    if ((which & 16) != 0) split_transforms(scene);
    if ((which & 32) != 0) reorder_lists(scene, random);
    return scene;
}

std::string failures(const judge::Judgement& judgement) {
    std::string names;
    for (const judge::Measured& m : judgement.measured)
        if (!m.within) {
            names += std::string(m.row->name) + " " + std::to_string(m.value);
            for (const judge::Finding& f : m.findings) names += " [" + f.text + "]";
            names += "; ";
        }
    return names;
}

TEST(Gate, AThousandHarmlessChangesRaiseNoAlarm) {
    Random random(0x9a7e1);
    int alarms = 0, changes = 0;
    for (int base = 0; base < 16; ++base) {
        const Scene scene = rich_scene(random, 14);
        for (std::uint64_t which = 1; which < 64; ++which, ++changes) {
            judge::JudgeOptions options;
            options.limits.positions = options.limits.distance = 0;  // last bits are no difference
            const auto judged = judge::judge(scene, harmless(scene, which, random), options);
            ASSERT_TRUE(judged) << prep::to_string(judged.error());
            if (judged->within()) continue;
            ++alarms;
            ADD_FAILURE() << "base " << base << ", changes " << which << ": " << failures(*judged);
        }
    }
    EXPECT_EQ(changes, 1008);
    EXPECT_EQ(alarms, 0);
}

// Every face the other way round.
void turn_faces(Mesh& mesh) {
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto turn = [&](auto& by_corner) {
            if (!by_corner.empty())
                std::reverse(by_corner.begin() + mesh.face_offsets[f],
                             by_corner.begin() + mesh.face_offsets[f + 1]);
        };
        turn(mesh.corner_vertices);
        turn(mesh.normals.indices);
        turn(mesh.tangents.indices);
        for (auto& set : mesh.uvs) turn(set.indices);
        for (auto& set : mesh.colors) turn(set.indices);
    }
}

// A mirrored and stretched node, and a mesh that has all of that in its own numbers: faces of a
// mirrored node run clockwise around what is in front of them (glTF 2.0, 3.7.4).
TEST(Gate, TransformsThatAreInTheVerticesInsteadRaiseNoAlarm) {
    Random random(3);
    const Scene rich = rich_scene(random);
    Scene placed;
    placed.meshes = {rich.meshes[0]};
    placed.meshes[0].skin_influences.clear();
    placed.meshes[0].morph_targets.clear();
    placed.meshes[0].face_materials.clear();
    Scene baked = placed;
    const glm::dvec3 scale(-0.5, 0.75, 1.5), at(1, 2, 3);
    prep::Node node;
    node.mesh = 0;
    baked.nodes = {node};
    node.transform =
        glm::dmat4(scale.x, 0, 0, 0, 0, scale.y, 0, 0, 0, 0, scale.z, 0, at.x, at.y, at.z, 1);
    placed.nodes = {node};
    Mesh& mesh = baked.meshes[0];
    for (glm::vec3& p : mesh.positions) p = glm::vec3(glm::dvec3(p) * scale + at);
    for (glm::vec3& n : mesh.normals.values)
        n = glm::vec3(glm::normalize(glm::dvec3(n) / scale));  // the inverse transposed
    for (glm::vec4& t : mesh.tangents.values)
        t = glm::vec4(glm::vec3(glm::normalize(glm::dvec3(t) * scale)), -t.w);
    const auto inside_out = judge::judge(placed, baked);
    ASSERT_TRUE(inside_out);
    EXPECT_FALSE(inside_out->within());
    turn_faces(mesh);
    const auto judged = judge::judge(placed, baked);
    ASSERT_TRUE(judged);
    EXPECT_TRUE(judged->within()) << failures(*judged);
}

// By a program that knows nothing of ours; what is compared is the file as we wrote it and as it
// did.
TEST(Gate, FilesThatGltfTransformWritesAgainRaiseNoAlarm) {
    MESHPREP_REQUIRE_GLTF_TRANSFORM(modules);
    const test::TempDir dir;
    Random random(77);
    std::string list = "[";
    for (int k = 0; k < 12; ++k) {
        const auto prepared = prep::prepare(rich_scene(random), {});
        ASSERT_TRUE(prepared);
        const std::string name = std::to_string(k);
        const std::string ending = k % 2 == 0 ? ".glb" : ".gltf";
        ASSERT_TRUE(prep::save_scene(*prepared, dir / (name + ending)));
        list += std::string(k > 0 ? "," : "") +
                "{\"input\":" + test::json_quoted((dir / (name + ending)).string()) +
                ",\"output\":" + test::json_quoted((dir / (name + "-again.glb")).string()) + "}";
    }
    test::write_text(dir / "list.json", list + "]");
    const test::Ran ran = test::run_program(
        "/usr/bin/env", {"node", (test::source_dir() / "tests/tools/rewrite_gltf.mjs").string(),
                         modules.string(), (dir / "list.json").string()});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    for (int k = 0; k < 12; ++k) {
        const auto a =
            prep::load_scene(dir / (std::to_string(k) + (k % 2 == 0 ? ".glb" : ".gltf")));
        const auto b = prep::load_scene(dir / (std::to_string(k) + "-again.glb"));
        ASSERT_TRUE(a && b);
        const auto judged = judge::judge(*a, *b);
        ASSERT_TRUE(judged);
        EXPECT_TRUE(judged->within()) << failures(*judged);
        for (const judge::Measured& m : judged->measured)
            if (m.row->limit != &judge::Limits::flip) {
                EXPECT_GT(m.compared, 0u) << m.row->name << ": nothing was compared";
            }
    }
}

// --- Changes that change something
// ----------------------------------------------------------------

// What was done, and how it is to be told: the row that stands for itself, the mesh of the first
// file, faces of it of which one is to be named (none: any), the value in the row's unit.
struct Planted {
    std::string row;
    std::uint32_t mesh = 0;
    std::set<std::uint32_t> faces = {};
    double value = 0, tolerance = 0;
    std::string words = {};  // of the finding's text
};

glm::vec3 turned_by(const glm::vec3& v, double degrees) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(v));
    const glm::dvec3 side = glm::normalize(
        glm::cross(n, std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const double r = degrees * 3.14159265358979 / 180;
    return glm::vec3(std::cos(r) * n + std::sin(r) * side);
}

template <class T>
void drop_face(CornerLayer<T>& layer, std::uint32_t first) {
    if (!layer.empty())
        layer.indices.erase(layer.indices.begin() + first, layer.indices.begin() + first + 3);
}

constexpr int kinds = 15;
constexpr std::uint32_t drawn_size = 128;

Planted plant(Scene& scene, int kind, Random& random) {
    Mesh& torus = scene.meshes[0];
    const auto corners = std::uint32_t(torus.corner_count());
    const auto c = std::uint32_t(below(random, corners));
    const std::uint32_t v = torus.corner_vertices[c];
    std::set<std::uint32_t> around;  // faces at that vertex
    for (std::uint32_t k = 0; k < corners; ++k)
        if (torus.corner_vertices[k] == v) around.insert(k / 3);
    switch (kind) {
        case 0: {  // half a degree on a thousandth of the corners
            Planted out{"normals", 0, {}, 0.5, 0.001, ""};
            for (std::uint32_t k = 0; k < std::max(1u, corners / 1000); ++k) {
                const auto at = std::uint32_t(below(random, corners));
                if (!out.faces.insert(at / 3).second) continue;
                torus.normals.values[at] = turned_by(torus.normals.values[at], 0.5);
            }
            return out;
        }
        case 1:
            torus.tangents.values[c].w = -torus.tangents.values[c].w;
            return {"tangent_signs", 0, {c / 3}, 1, 0, ""};
        case 2:
            torus.uvs.pop_back();
            return {"lost", 0, {}, double(corners), 0, "UV set 1"};
        case 3: {  // 0.3 pixels of the outlines that the gate draws
            Planted out{"positions", 1, {}, 0, 0, ""};
            const auto bare = judge::judge(scene, scene);
            const double pixel = judge::ViewFrame{{}, bare->diagonal / 2}.pixel(drawn_size);
            scene.nodes[2].transform[3] += glm::dvec4(
                0.3 * pixel * glm::normalize(glm::dvec3(uniform(random, -1, 1), 1, 0.3)), 0);
            out.value = 0.3 * pixel / bare->diagonal;
            out.tolerance = 1e-6;
            return out;
        }
        case 4: {  // some faces get the material of the others
            Planted out{"materials", 0, {}, 0, 0, "swapped"};
            for (std::uint32_t f = c / 3; f < torus.face_count() && out.faces.size() < 5; ++f)
                if (torus.face_materials[f] == 0) {
                    torus.face_materials[f] = 1;
                    out.faces.insert(f);
                }
            out.value = double(out.faces.size());
            return out;
        }
        case 5:
            std::swap(scene.materials[0], scene.materials[1]);
            return {"materials", 0, {}, 448, 0, "swapped"};
        case 6: {
            glm::vec4& t = torus.tangents.values[c];
            t = glm::vec4(turned_by(glm::vec3(t), 0.5), t.w);
            return {"tangents", 0, {c / 3}, 0.5, 0.001, ""};
        }
        case 7:
            torus.colors.clear();
            return {"lost", 0, {}, double(corners), 0, "colours 0"};
        case 8:
            torus.colors[0].values[c].g += 2.0f / 255;
            return {"colors", 0, {c / 3}, 2.0 / 255, 1e-6, ""};
        case 9:
            torus.uvs[1].values[c].y += 0.001f;
            return {"uvs", 0, {c / 3}, 0.001, 1e-6, "UV set 1"};
        case 10: {  // a face that is gone
            const std::uint32_t first = c / 3 * 3;
            torus.corner_vertices.erase(torus.corner_vertices.begin() + first,
                                        torus.corner_vertices.begin() + first + 3);
            torus.face_offsets.pop_back();
            torus.face_materials.erase(torus.face_materials.begin() + c / 3);
            drop_face(torus.normals, first);
            drop_face(torus.tangents, first);
            for (auto& layer : torus.uvs) drop_face(layer, first);
            for (auto& layer : torus.colors) drop_face(layer, first);
            return {"faces", 0, {c / 3}, 1, 0, "first file alone"};
        }
        case 11: {
            glm::vec4& w = torus.skin_influences[0].weights[v];
            w = glm::vec4(w[0] - 0.01f, w[1] + 0.01f, w[2], w[3]);
            // Of joints that stand a unit apart, in a pose that moves nothing.
            return {"skins", 0, around, 0.01 / judge::judge(scene, scene)->diagonal, 1e-6, ""};
        }
        case 12: {
            auto values = *torus.morph_targets[0].positions[0].values;
            values[v].y += 0.01f;
            torus.morph_targets[0].positions[0].values =
                std::make_shared<const std::vector<glm::vec3>>(values);
            return {"morphs",        0, around, 0.01 / judge::judge(scene, scene)->diagonal, 1e-6,
                    "morph target 0"};
        }
        case 13: {  // a face turned round
            const std::uint32_t first = c / 3 * 3;
            const auto swap = [&](auto& list) { std::swap(list[first + 1], list[first + 2]); };
            swap(torus.corner_vertices);
            swap(torus.normals.indices);
            swap(torus.tangents.indices);
            for (auto& layer : torus.uvs) swap(layer.indices);
            for (auto& layer : torus.colors) swap(layer.indices);
            return {"faces", 0, {c / 3}, 1, 0, "other way round"};
        }
        default: {  // another picture
            prep::Image picture = *prep::load_image(scene.images[1]);
            picture.pixels[below(random, 48)] += 0.1f;
            for (float& p : picture.pixels) p = std::min(p, 0.8f);
            scene.images[1].bytes = *prep::encode_png(picture);
            const auto painted =
                std::count(torus.face_materials.begin(), torus.face_materials.end(), 1u);
            return {"materials", 0, {}, double(painted), 0, "another picture"};
        }
    }
}

// Each of 15 kinds four times, with harmless changes on top of it.
TEST(Gate, OfSixtyPlantedChangesAtLeast59AreFoundAndRightlyTold) {
    Random random(0xfa117);
    int found = 0;
    for (int k = 0; k < 4 * kinds; ++k) {
        const int kind = k % kinds;
        const Scene scene = rich_scene(random);
        Scene changed = scene;
        const Planted planted = plant(changed, kind, random);
        changed = harmless(std::move(changed), 1 + random() % 63, random);
        judge::JudgeOptions options;
        options.size = drawn_size;
        const auto judged = judge::judge(scene, changed, options);
        ASSERT_TRUE(judged) << prep::to_string(judged.error());
        std::string causes;
        bool told = false;
        for (const judge::Measured& m : judged->measured) {
            if (m.within || !m.follows.empty()) continue;
            causes += (causes.empty() ? "" : ", ") + std::string(m.row->name);
            if (m.row->name != planted.row) continue;
            for (const judge::Finding& f : m.findings)
                told |= f.mesh == planted.mesh &&
                        (planted.faces.empty() || planted.faces.count(f.face) > 0) &&
                        std::abs(f.value - planted.value) <= planted.tolerance &&
                        f.text.find(planted.words) != std::string::npos;
            // Counts are of faces or corners together.
            told &= planted.row != "faces" || m.value == planted.value;
        }
        const bool right = causes == planted.row && told;
        found += right;
        if (!right)
            std::printf("kind %d: '%s' told as: %s\n", kind, planted.row.c_str(),
                        failures(*judged).c_str());
        if (kind == 3) {  // the outlines moved by as much, but for what is seen from above
            double largest = 0;
            for (const judge::ViewJudged& view : judged->views)
                largest = std::max(largest, view.outline);
            EXPECT_GT(largest, 0.2);
            EXPECT_LT(largest, 0.35);
        }
    }
    EXPECT_GE(found, 59);
    std::printf("%d of %d\n", found, 4 * kinds);
}

}  // namespace
