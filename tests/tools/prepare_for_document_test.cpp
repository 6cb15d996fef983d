// `prepare --for` of glTF documents that are written back: what stays of them.
#include <gtest/gtest.h>

#include <cstring>

#include "command_runner.h"
#include "prep/image.h"
#include "written_primitive.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::written;

// A glTF document whose primitives carry what each test wants.
class Document {
  public:
    std::size_t add(const std::vector<float>& values, int width, int component = 5126) {
        const std::size_t offset = bytes_.size(), count = values.size() / std::size_t(width);
        for (const float value : values) {
            const bool real = component == 5126;
            const std::uint32_t whole = real ? 0 : std::uint32_t(value);
            char four[4];
            std::memcpy(four, real ? static_cast<const void*>(&value) : &whole, 4);
            bytes_.append(four, 4);
        }
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes_.size() - offset}});
        const char* const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
        json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                     {"componentType", component},
                                     {"count", count},
                                     {"type", types[width - 1]}});
        return json["accessors"].size() - 1;
    }
    // Of a unit square.
    std::size_t positions() {
        const std::size_t accessor = add({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
        json["accessors"][accessor]["min"] = {0, 0, 0};
        json["accessors"][accessor]["max"] = {1, 1, 0};
        return accessor;
    }
    std::size_t four_times(std::vector<float> values) {
        const int width = int(values.size());
        values.insert(values.end(), values.begin(), values.end());
        values.insert(values.end(), values.begin(), values.end());
        return add(values, width);
    }
    void write(const std::filesystem::path& file, nlohmann::json primitives) {
        json["asset"] = {{"version", "2.0"}};
        json["meshes"] = {{{"primitives", std::move(primitives)}}};
        json["nodes"] = {{{"mesh", 0}}};
        json["scenes"] = {{{"nodes", {0}}}};
        json["scene"] = 0;
        json["buffers"] = {
            {{"byteLength", bytes_.size()},
             {"uri", "data:application/octet-stream;base64," + test::base64_of(bytes_)}}};
        test::write_text(file, json.dump());
    }
    nlohmann::json json;

  private:
    std::string bytes_;
};

json indexed(json attributes, Document& d) {
    return {{"attributes", std::move(attributes)}, {"indices", d.add({0, 1, 2, 0, 2, 3}, 1, 5125)}};
}

// A square with colours and one target that moves, turns and colours it.
void write_morph(const std::filesystem::path& file) {
    Document d;
    json square = indexed({{"POSITION", d.positions()},
                           {"NORMAL", d.four_times({0, 0, 1})},
                           {"COLOR_0", d.four_times({0.2f, 0.4f, 0.6f, 1})},
                           {"COLOR_1", d.four_times({1, 0, 0, 1})}},
                          d);
    square["targets"] = {{{"POSITION", d.positions()},
                          {"NORMAL", d.four_times({0.1f, 0, 0})},
                          {"COLOR_0", d.four_times({0.1f, 0.1f, 0, 0})}}};
    d.write(file, {square});
}

// A square with a normal map that slants everything, and tangents that no UVs give.
void write_authored_tangents(const std::filesystem::path& file) {
    Document d;
    const json square = indexed({{"POSITION", d.positions()},
                                 {"NORMAL", d.four_times({0, 0, 1})},
                                 {"TANGENT", d.four_times({0, -1, 0, -1})},
                                 {"TEXCOORD_0", d.add({0, 0, 1, 0, 1, 1, 0, 1}, 2)}},
                                d);
    json with_material = square;
    with_material["material"] = 0;
    d.json["images"] = {{{"uri", "slant.png"}}};
    d.json["textures"] = {{{"source", 0}}};
    d.json["materials"] = {{{"name", "slanted"}, {"normalTexture", {{"index", 0}}}}};
    d.write(file, {with_material});
    prep::Image slant;
    slant.width = slant.height = 1;
    slant.channels = 3;
    slant.pixels = {0.8f, 0.3f, 0.7f};
    const auto png = prep::encode_png(slant);
    ASSERT_TRUE(png.has_value());
    test::write_text(file.parent_path() / "slant.png",
                     {reinterpret_cast<const char*>(png->data()), png->size()});
}

// A square whose normals are wrong, its tangents about them, and a point.
void write_loose(const std::filesystem::path& file) {
    Document d;
    const json square = indexed({{"POSITION", d.positions()},
                                 {"NORMAL", d.four_times({0.6f, 0, 0.8f})},
                                 {"TANGENT", d.four_times({5, 0, 0, 1})}},
                                d);
    d.write(file, {square, {{"attributes", {{"POSITION", d.positions()}}}, {"mode", 0}}});
}

json first_primitive(const std::filesystem::path& file) {
    return json::parse(test::file_text(file), nullptr, false)["meshes"][0]["primitives"][0];
}
std::string keys_of(const json& object) {
    std::string text;
    for (const auto& item : object.items()) text += item.key() + " ";
    return text;
}

class PrepareForDocument : public ::testing::Test {
  protected:
    test::Ran prepare(const std::string& input, std::vector<std::string> options) {
        options.insert(options.begin(), {"prepare", (dir_ / input).string(), "-o",
                                         (dir_ / "out.gltf").string(), "--json"});
        const test::Ran ran = run_here(options);
        EXPECT_EQ(ran.exit_code, 0) << ran.err << ran.out;
        return ran;
    }
    std::string attributes() { return keys_of(first_primitive(dir_ / "out.gltf")["attributes"]); }
    std::string target() { return keys_of(first_primitive(dir_ / "out.gltf")["targets"][0]); }
    test::TempDir dir_;
};

// The specification: all that a target has, its primitive has too.
TEST_F(PrepareForDocument, TargetsHaveNoMoreThanTheirPrimitive) {
    write_morph(dir_ / "m.gltf");
    prepare("m.gltf", {});
    EXPECT_EQ(attributes(), "COLOR_0 COLOR_1 NORMAL POSITION ");
    EXPECT_EQ(target(), "COLOR_0 NORMAL POSITION ");
    prepare("m.gltf", {"--for", "shading=phong"});
    EXPECT_EQ(attributes(), "COLOR_0 COLOR_1 NORMAL POSITION ");
    EXPECT_EQ(target(), "COLOR_0 NORMAL POSITION ");
    prepare("m.gltf", {"--for", "shading=flat"});
    EXPECT_EQ(attributes(), "COLOR_0 COLOR_1 POSITION ");  // sets of colours stay together
    EXPECT_EQ(target(), "COLOR_0 POSITION ");
    prepare("m.gltf", {"--for", "colors=off"});
    EXPECT_EQ(attributes(), "POSITION ");
    EXPECT_EQ(target(), "POSITION ");
    prepare("m.gltf", {"--for", "colors=off,normals=on"});
    EXPECT_EQ(attributes(), "NORMAL POSITION ");
    EXPECT_EQ(target(), "NORMAL POSITION ");
}

// What was asked for is no loss.
TEST_F(PrepareForDocument, LeavesOutOfSubdividedMeshesWithoutAWarning) {
    write_morph(dir_ / "m.gltf");
    prepare("m.gltf", {"--subdivide", "loop:1", "--for", "colors=off", "--strict"});
    EXPECT_EQ(attributes(), "POSITION ");
    EXPECT_EQ(target(), "POSITION ");
}

TEST_F(PrepareForDocument, KeepsTangentsThatThePictureReads) {
    write_authored_tangents(dir_ / "t.gltf");
    prepare("t.gltf", {"--tangents", "none", "--for", "shading=normal-mapped"});
    EXPECT_EQ(attributes(), "NORMAL POSITION TANGENT TEXCOORD_0 ");
    prepare("t.gltf", {"--tangents", "none", "--for", "shading=phong"});
    EXPECT_EQ(attributes(), "NORMAL POSITION TEXCOORD_0 ");
}

// As without --for: tangents do not outlive their normals, which a flat picture needs no new ones
// of.
TEST_F(PrepareForDocument, ReviewsTangentsThatStay) {
    write_loose(dir_ / "l.gltf");
    for (const char* picture : {"", "shading=phong", "shading=flat"}) {
        std::vector<std::string> options{"--normals", "replace"};
        if (*picture) options.insert(options.end(), {"--for", picture});
        const json findings = prepare("l.gltf", options).json()["files"][0]["findings"];
        const bool replaced = std::string(picture) != "shading=flat";
        EXPECT_EQ(findings.dump().find("stale-tangent") != std::string::npos, replaced) << findings;
        EXPECT_EQ(attributes().find("TANGENT") == std::string::npos, replaced) << picture;
        // Nobody has replaced the normals here: they stay, of unit length.
        options.erase(options.begin(), options.begin() + 2);
        const json kept = prepare("l.gltf", options).json()["files"][0]["findings"];
        EXPECT_NE(kept.dump().find("non-unit-tangent"), std::string::npos) << kept;
        EXPECT_NE(attributes().find("TANGENT"), std::string::npos) << picture;
    }
}

TEST_F(PrepareForDocument, SaysWhatIsProvided) {
    write_loose(dir_ / "l.gltf");
    write_authored_tangents(dir_ / "t.gltf");
    const auto provided = [&](const char* input, std::vector<std::string> options) {
        options.push_back("--explain");
        return prepare(input, options).json()["files"][0]["requirements"][0]["provided"];
    };
    EXPECT_EQ(provided("l.gltf", {})["tangents"], true);
    EXPECT_EQ(provided("l.gltf", {"--for", "shading=flat"})["tangents"], true);
    EXPECT_EQ(provided("t.gltf", {"--for", "shading=phong"})["tangents"], false);
}

TEST_F(PrepareForDocument, PicturesAreThoseOfTheInput) {
    write_morph(dir_ / "m.gltf");
    write_authored_tangents(dir_ / "t.gltf");
    write_loose(dir_ / "l.gltf");
    const auto picture = [&](const std::string& file, const std::string& shading) {
        const test::Ran ran =
            run_here({"render", (dir_ / file).string(), "-o", (dir_ / "x.png").string(), "--size",
                      "40x30", "--shading", shading});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return test::file_text(dir_ / "x.png");
    };
    for (const char* input : {"m.gltf", "t.gltf", "l.gltf"})
        for (const char* shading : {"flat", "gouraud", "phong", "normal-mapped"})
            for (const char* tangents : {"auto", "none"}) {
                prepare(input,
                        {"--tangents", tangents, "--for", std::string("shading=") + shading});
                EXPECT_EQ(picture("out.gltf", shading), picture(input, shading))
                    << input << ", " << shading << ", tangents " << tangents;
            }
}

// Lines are drawn by somebody else, who has their maps in mind.
TEST_F(PrepareForDocument, LinesKeepWhatTheyHave) {
    test::write_text(dir_ / "t.ppm", std::string("P6 1 1 255\n") + "abc");
    test::write_text(dir_ / "b.mtl", "newmtl m\nKd 1 1 1\nmap_Kd t.ppm\n");
    test::write_text(dir_ / "b.obj",
                     "mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                     "usemtl m\nf 1/1 2/2 3/3\nl 1/1 2/2\n");
    prepare("b.obj", {"--for", "textures=off"});
    EXPECT_NE(written(dir_ / "out.gltf").find("TEXCOORD_0 1 textures"), std::string::npos)
        << written(dir_ / "out.gltf");
}

TEST_F(PrepareForDocument, ResidualMapsSayWhatTheyCallFor) {
    test::write_text(dir_ / "h.pgm",
                     "P2\n4 4\n255\n0 90 20 200 40 255 10 3 77 0 31 9 100 7 0 60\n");
    test::write_text(dir_ / "d.mtl", "newmtl m\nKd 1 1 1\ndisp h.pgm\n");
    test::write_text(dir_ / "d.obj",
                     "mtllib d.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
                     "vt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n");
    const json mesh =
        prepare("d.obj", {"--displace", "materials", "--residual-normal-map", "16", "--edge-length",
                          "0.5", "--explain", "--for", "shading=flat"})
            .json()["files"][0]["requirements"][0];
    for (const char* what : {"tangents", "uvs"}) {
        EXPECT_EQ(mesh[what]["needed"], true);
        EXPECT_EQ(mesh[what]["why"]["code"], "residual_map") << what;
        EXPECT_EQ(mesh[what]["why"]["label"], "run") << what;
        EXPECT_EQ(mesh[what]["why"]["sentence"], "a residual normal map reads them") << what;
    }
    EXPECT_EQ(mesh["provided"]["normals"], true);
    EXPECT_EQ(mesh["provided"]["tangents"], true);
    EXPECT_EQ(mesh["provided"]["uv_sets"], json::array({0}));
}

}  // namespace
