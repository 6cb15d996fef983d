// What is prepared for one picture, written back as glTF: valid, and with all that this picture
// reads.
#include <gtest/gtest.h>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "formats/gltf/gltf.h"
#include "mesh_files.h"
#include "prep/save.h"

namespace {

using Json = nlohmann::json;
using Level = prep::Request::Level;

// A square, its accessors in a data URI.
class Document {
  public:
    Json json{{"asset", {{"version", "2.0"}}}};

    template <class T>
    std::size_t add(const std::vector<T>& values, const char* type, int component = 5126) {
        const std::size_t offset = bytes_.size(), size = values.size() * sizeof(T);
        bytes_.append(reinterpret_cast<const char*>(values.data()), size);
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
        json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                     {"componentType", component},
                                     {"count", values.size()},
                                     {"type", type}});
        return json["accessors"].size() - 1;
    }
    std::size_t four(const glm::vec3& v) { return add(std::vector<glm::vec3>(4, v), "VEC3"); }
    std::size_t four(const glm::vec4& v) { return add(std::vector<glm::vec4>(4, v), "VEC4"); }
    std::size_t uvs() {
        return add(std::vector<glm::vec2>{{0, 1}, {1, 1}, {1, 0}, {0, 0}}, "VEC2");
    }
    std::size_t positions() {
        const std::size_t accessor =
            add(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, "VEC3");
        json["accessors"][accessor]["min"] = {0, 0, 0};
        json["accessors"][accessor]["max"] = {1, 1, 0};
        return accessor;
    }
    Json triangles(Json attributes) {
        attributes["POSITION"] = positions();
        const std::size_t indices =
            add(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}, "SCALAR", 5125);
        return {{"attributes", attributes}, {"indices", indices}};
    }
    prep::Scene scene_of(const std::vector<Json>& primitives) {
        static const char* const digits =
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string uri = "data:application/octet-stream;base64,";
        bytes_.resize((bytes_.size() + 2) / 3 * 3);
        for (std::size_t i = 0; i < bytes_.size(); i += 3) {
            unsigned bits = 0;
            for (std::size_t k = 0; k < 3; ++k)
                bits = bits << 8 | static_cast<unsigned char>(bytes_[i + k]);
            for (int shift = 18; shift >= 0; shift -= 6) uri += digits[bits >> shift & 63];
        }
        json["buffers"] = {{{"byteLength", bytes_.size()}, {"uri", uri}}};
        json["meshes"] = {{{"primitives", primitives}}};
        json["nodes"] = {{{"mesh", 0}}};
        json["scenes"] = {{{"nodes", {0}}}};
        const std::string text = json.dump();
        auto scene = prep::parse_gltf(std::as_bytes(std::span(text.data(), text.size())));
        if (!scene) throw std::runtime_error(prep::to_string(scene.error()));
        return *std::move(scene);
    }

  private:
    std::string bytes_;
};

// Colours, and one target that moves, turns and colours.
prep::Scene morphing() {
    Document d;
    Json square = d.triangles({{"NORMAL", d.four(glm::vec3(0, 0, 1))},
                               {"COLOR_0", d.four(glm::vec4(0.2f, 0.4f, 0.6f, 1))}});
    square["targets"] = {{{"POSITION", d.positions()},
                          {"NORMAL", d.four(glm::vec3(0.1f, 0, 0))},
                          {"COLOR_0", d.four(glm::vec4(0.1f, 0.1f, 0, 0))}}};
    return d.scene_of({square});
}

// A normal map, and tangents that its UVs do not give.
prep::Scene normal_mapped() {
    Document d;
    Json square = d.triangles({{"NORMAL", d.four(glm::vec3(0, 0, 1))},
                               {"TANGENT", d.four(glm::vec4(0, -1, 0, -1))},
                               {"TEXCOORD_0", d.uvs()}});
    square["material"] = 0;
    d.json["images"] = {{{"uri", "slant.png"}}};
    d.json["textures"] = {{{"source", 0}}};
    d.json["materials"] = {{{"name", "slanted"}, {"normalTexture", {{"index", 0}}}}};
    return d.scene_of({square});
}

// Normals that are not those of the face, long tangents about them; points or lines beside.
prep::Scene loose(int mode) {
    Document d;
    const Json square = d.triangles(
        {{"NORMAL", d.four(glm::vec3(0.6f, 0, 0.8f))}, {"TANGENT", d.four(glm::vec4(0, 5, 0, 1))}});
    return d.scene_of({square, {{"attributes", {{"POSITION", d.positions()}}}, {"mode", mode}}});
}

struct Written {
    std::string attributes, target;  // their names
    std::vector<std::string> notes;
    prep::PreparedScene scene;
    bool found(const std::string& kind) const {
        for (const prep::Finding& f : scene.findings)
            if (f.kind == kind) return true;
        return false;
    }
};

std::string keys_of(const Json& object) {
    std::string text;
    for (const auto& item : object.items()) text += item.key() + " ";
    return text;
}

Written written(prep::Scene scene, const prep::PrepareOptions& options) {
    auto prepared = prep::prepare(std::move(scene), options);
    if (!prepared) throw std::runtime_error(prep::to_string(prepared.error()));
    const test::TempDir dir;
    const auto notes = prep::save_scene(*prepared, dir / "out.gltf");
    if (!notes) throw std::runtime_error(prep::to_string(notes.error()));
    const Json primitive =
        Json::parse(test::file_text(dir / "out.gltf"))["meshes"][0]["primitives"][0];
    Written out{keys_of(primitive["attributes"]), {}, *notes, *std::move(prepared)};
    if (primitive.contains("targets")) out.target = keys_of(primitive["targets"][0]);
    return out;
}

prep::PrepareOptions for_picture(prep::Shading shading, bool colors = true, bool normals = false) {
    prep::PrepareOptions options;
    options.request.consumer.exact = true;
    options.request.consumer.shading = shading;
    options.request.consumer.colors = colors;
    options.request.consumer.normals = normals;
    return options;
}

// The specification: all that a target has, its primitive has too.
TEST(OnePicture, TargetsHaveNoMoreThanTheirPrimitive) {
    using prep::Shading;
    const auto expect = [](const prep::PrepareOptions& options, const std::string& names) {
        const Written w = written(morphing(), options);
        EXPECT_EQ(w.attributes, names);
        EXPECT_EQ(w.target, names);
    };
    expect({}, "COLOR_0 NORMAL POSITION ");
    expect(for_picture(Shading::phong), "COLOR_0 NORMAL POSITION ");
    expect(for_picture(Shading::flat), "COLOR_0 POSITION ");
    expect(for_picture(Shading::phong, false), "POSITION ");
    expect(for_picture(Shading::phong, false, true), "NORMAL POSITION ");
}

// Nothing is noted of what was asked for.
TEST(OnePicture, LeavesOutOfSubdividedMeshesWithoutANote) {
    prep::PrepareOptions options = for_picture(prep::Shading::phong, false);
    options.subdivide = true;
    options.subdivision.level = 1;
    const Written w = written(morphing(), options);
    EXPECT_EQ(w.attributes, "POSITION ");
    EXPECT_EQ(w.target, "POSITION ");
    EXPECT_EQ(w.notes, std::vector<std::string>{});
}

// Colours are left out where that was decided, not wherever a mesh happens to be without.
TEST(OnePicture, ColoursOfTheFileStayWhereNobodyDecidedAboutThem) {
    auto prepared = prep::prepare(morphing());
    ASSERT_TRUE(prepared.has_value());
    prepared->scene.meshes[0].colors.clear();
    prepared->meshes[0].colors.clear();
    const test::TempDir dir;
    ASSERT_TRUE(prep::save_scene(*prepared, dir / "out.gltf").has_value());
    const Json primitive =
        Json::parse(test::file_text(dir / "out.gltf"))["meshes"][0]["primitives"][0];
    EXPECT_TRUE(primitive["attributes"].contains("COLOR_0"));
}

TEST(OnePicture, KeepsTangentsThatItReads) {
    prep::PrepareOptions options = for_picture(prep::Shading::normal_mapped);
    options.request.tangents = Level::never;
    const Written w = written(normal_mapped(), options);
    EXPECT_EQ(w.attributes, "NORMAL POSITION TANGENT TEXCOORD_0 ");
    ASSERT_FALSE(w.scene.meshes[0].tangents.empty());
    EXPECT_EQ(w.scene.meshes[0].tangents[0], glm::vec4(0, -1, 0, -1));
    options.request.consumer.shading = prep::Shading::phong;
    EXPECT_EQ(written(normal_mapped(), options).attributes, "NORMAL POSITION TEXCOORD_0 ");
}

// What stays is looked at as if it were for any picture: tangents do not outlive their normals.
TEST(OnePicture, ReviewsTangentsThatStay) {
    for (const auto& [exact, mode] : {std::pair(false, 0), {true, 0}, {true, 1}}) {
        prep::PrepareOptions options = for_picture(prep::Shading::phong);
        options.request.consumer.exact = exact;
        const Written kept = written(loose(mode), options);
        EXPECT_EQ(kept.attributes, "NORMAL POSITION TANGENT ");
        EXPECT_EQ(kept.scene.meshes[0].tangents[0], glm::vec4(0, 1, 0, 1));
        EXPECT_TRUE(kept.found("non-unit-tangent")) << exact;
        EXPECT_TRUE(kept.scene.requirements[0].provided.tangents);
        options.normals = prep::Authored::replace;
        const Written replaced = written(loose(mode), options);
        EXPECT_EQ(replaced.attributes, "NORMAL POSITION ");
        EXPECT_TRUE(replaced.found("stale-tangent")) << exact;
    }
}

// Residual maps are baked against what there is, and call for what they are read with.
TEST(OnePicture, ResidualMapsSayWhatTheyCallFor) {
    prep::PrepareOptions options = for_picture(prep::Shading::flat, false);
    options.tessellate = true;
    options.tessellation.edge_length = 0.5;
    options.displacement.noise.emplace();
    options.displacement.residual.emplace();
    options.displacement.residual->size = 16;
    Document d;
    auto prepared = prep::prepare(d.scene_of({d.triangles({{"TEXCOORD_0", d.uvs()}})}), options);
    ASSERT_TRUE(prepared.has_value()) << prep::to_string(prepared.error());
    const prep::MeshRequirements& of = prepared->requirements[0];
    for (const prep::Need* need : {&of.normals, &of.tangents, &of.uvs}) {
        EXPECT_TRUE(need->needed);
        EXPECT_EQ(need->why.label, prep::ReasonLabel::run);
        EXPECT_EQ(need->reason, prep::sentence(need->why, prepared->scene));
        EXPECT_EQ(need->reason, "a residual normal map reads them");
    }
    const prep::AttributeReads all{true, true, false, {0}};
    EXPECT_EQ(of.provided, all);
    EXPECT_FALSE(prepared->meshes[0].normals.empty());
    EXPECT_FALSE(prepared->meshes[0].tangents.empty());
    EXPECT_FALSE(prepared->meshes[0].uvs.empty());
}

}  // namespace
