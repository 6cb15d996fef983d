// 3MF packages, written here byte by byte: what of them Assimp would lose without a word, pictures
// in them, colours. What is expected follows from the 3MF core, materials and production
// specifications and from PKWARE's APPNOTE.
#include <gtest/gtest.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/assimp/threemf/model_review.h"
#include "formats/assimp/threemf/package_parts.h"
#include "mesh_files.h"
#include "prep/load.h"

namespace {

using prep::detail::PackageParts;
using Strings = std::vector<std::string>;

// --- packages
// --------------------------------------------------------------------------------------

std::string bytes_of(std::uint64_t value, int width) {
    std::string out;
    for (; width > 0; --width, value >>= 8) out += char(value & 255);
    return out;
}

// ISO 3309, bit by bit.
std::uint32_t checksum(const std::string& text) {
    std::uint32_t crc = ~0u;
    for (const char c : text) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
    }
    return ~crc;
}

struct Part {
    std::string name, text;
    bool deflated = false;        // in blocks that are stored (RFC 1951, 3.2.4)
    std::uint64_t told_size = 0;  // 0: its own
};

std::string stored_blocks(std::string text) {
    std::string out;
    while (true) {
        const std::string piece = text.substr(0, 60000);
        text.erase(0, piece.size());
        out += char(text.empty());
        out += bytes_of(piece.size(), 2) + bytes_of(~piece.size(), 2) + piece;
        if (text.empty()) return out;
    }
}

std::string package(const std::vector<Part>& parts, bool zip64 = false) {
    std::string out, list;
    for (const Part& part : parts) {
        const std::string packed = part.deflated ? stored_blocks(part.text) : part.text;
        const std::uint64_t size = part.told_size ? part.told_size : part.text.size();
        const std::string method = bytes_of(part.deflated ? 8 : 0, 2);
        const std::string crc = bytes_of(checksum(part.text), 4);
        const std::string extra = zip64 ? bytes_of(1, 2) + bytes_of(24, 2) + bytes_of(size, 8) +
                                              bytes_of(packed.size(), 8) + bytes_of(out.size(), 8)
                                        : "";
        list += "PK\1\2" + bytes_of(20, 2) + bytes_of(20, 2) + bytes_of(0, 2) + method +
                bytes_of(0, 4) + crc + bytes_of(zip64 ? 0xffffffff : packed.size(), 4) +
                bytes_of(zip64 ? 0xffffffff : size, 4) + bytes_of(part.name.size(), 2) +
                bytes_of(extra.size(), 2) + bytes_of(0, 2 + 2 + 2 + 4) +
                bytes_of(zip64 ? 0xffffffff : out.size(), 4) + part.name + extra;
        out += "PK\3\4" + bytes_of(20, 2) + bytes_of(0, 2) + method + bytes_of(0, 4) + crc +
               bytes_of(packed.size(), 4) + bytes_of(size, 4) + bytes_of(part.name.size(), 2) +
               bytes_of(0, 2) + part.name + packed;
    }
    const std::uint64_t start = out.size(), end = start + list.size();
    out += list;
    if (zip64)
        out += "PK\6\6" + bytes_of(44, 8) + bytes_of(45, 2) + bytes_of(45, 2) + bytes_of(0, 8) +
               bytes_of(parts.size(), 8) + bytes_of(parts.size(), 8) + bytes_of(list.size(), 8) +
               bytes_of(start, 8) + "PK\6\7" + bytes_of(0, 4) + bytes_of(end, 8) + bytes_of(1, 4);
    return out + "PK\5\6" + bytes_of(0, 4) + bytes_of(parts.size(), 2) + bytes_of(parts.size(), 2) +
           bytes_of(zip64 ? 0xffffffff : list.size(), 4) + bytes_of(zip64 ? 0xffffffff : start, 4) +
           bytes_of(0, 2);
}

std::vector<std::byte> raw(const std::string& text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

std::string text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string unpacked(const std::string& file, const char* part) {
    const auto parts = PackageParts::of(raw(file), "a.3mf");
    if (!parts) return prep::to_string(parts.error());
    const auto bytes = parts->unpack(part);
    return bytes ? text_of(*bytes) : prep::to_string(bytes.error());
}

TEST(PackageParts, AreUnpackedStoredAndDeflatedOfZipAndZip64) {
    std::string large(200000, 'x');
    for (std::size_t i = 0; i < large.size(); ++i) large[i] = char(i * i >> 7);
    for (const bool zip64 : {false, true}) {
        const std::string file =
            package({{"3D/a.model", "stored"}, {"B.PNG", large, true}, {"none", "", true}}, zip64);
        EXPECT_EQ(unpacked(file, "/3D/a.model"), "stored");
        EXPECT_EQ(unpacked(file, "b.png"), large);
        EXPECT_EQ(unpacked(file, "none"), "");
        EXPECT_EQ(unpacked(file, "/other"), "a.3mf/other: the package has no such part");
        EXPECT_EQ(unpacked(file + "junk", "/3D/a.model"), "stored");
    }
}

TEST(PackageParts, WhatUnpacksToTooMuchOrIsDamagedIsAnError) {
    const std::uint64_t huge = (std::uint64_t(64) << 20) + 1;
    EXPECT_EQ(unpacked(package({{"a", "text", true, huge}}), "a"),
              "a.3mf/a: a part unpacks to 67108865 bytes, which is more than meshes do (200 times "
              "the packed size, at most 4 GiB)");
    EXPECT_EQ(unpacked(package({{"a", "text", true, 1u << 30}}, true), "a").substr(0, 27),
              "a.3mf/a: a part unpacks to ");
    const std::string damaged = "a.3mf/a: a part of the package is damaged";
    for (const std::uint64_t size : {3, 5}) {
        EXPECT_EQ(unpacked(package({{"a", "text", true, size}}), "a"), damaged);
        EXPECT_EQ(unpacked(package({{"a", "text", false, size}}), "a"), damaged);
    }
    std::string other = package({{"a", "text"}});
    other.replace(other.find("text"), 4, "test");
    EXPECT_EQ(unpacked(other, "a"), damaged);
}

// However often parts share their bytes, or one is unpacked.
TEST(PackageParts, UnpackToNoMoreThanAFewHundredTimesThePackage) {
    const std::string file = package({{"a", std::string(300000, 'x')}});
    const auto parts = PackageParts::of(raw(file), "a.3mf");
    ASSERT_TRUE(parts.has_value());
    const std::size_t most = (std::size_t(64) << 20) / 300000;
    for (std::size_t n = 0; n < most; ++n) ASSERT_TRUE(parts->unpack("a").has_value()) << n;
    const auto more = parts->unpack("a");
    ASSERT_FALSE(more.has_value());
    EXPECT_EQ(more.error().code, prep::ErrorCode::limit);
}

TEST(PackageParts, TwoOfOneNameAreAnError) {
    EXPECT_FALSE(PackageParts::of(raw(package({{"3D/a", "x"}, {"3d/A", "y"}})), "a.3mf"));
}

// --- models
// ----------------------------------------------------------------------------------------

const std::string tetrahedron =
    "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/>"
    "<vertex x='0' y='2' z='0'/><vertex x='0' y='0' z='3'/></vertices>"
    "<triangles><triangle v1='0' v2='2' v3='1'/><triangle v1='0' v2='1' v3='3'/>"
    "<triangle v1='1' v2='2' v3='3'/><triangle v1='0' v2='3' v3='2'/></triangles></mesh>";

std::string object(int id, const std::string& inside, const std::string& attributes = "") {
    return "<object id='" + std::to_string(id) + "' type='model' " + attributes + '>' + inside +
           "</object>";
}

std::string model(const std::string& resources, const std::string& build,
                  const std::string& attributes = "") {
    return "<?xml version='1.0' encoding='UTF-8'?>\n<model unit='millimeter' "
           "xmlns='http://schemas.microsoft.com/3dmanufacturing/core/2015/02' "
           "xmlns:m='http://schemas.microsoft.com/3dmanufacturing/material/2015/02' "
           "xmlns:p='http://schemas.microsoft.com/3dmanufacturing/production/2015/06' " +
           attributes + "><resources>" + resources + "</resources><build>" + build +
           "</build></model>";
}

std::vector<Part> parts_of(const std::string& text) {
    return {{"[Content_Types].xml",
             "<Types xmlns='http://schemas.openxmlformats.org/package/2006/content-types'>"
             "<Default Extension='rels' "
             "ContentType='application/vnd.openxmlformats-package.relationships+xml'/>"
             "<Default Extension='model' "
             "ContentType='application/vnd.ms-package.3dmanufacturing-3dmodel+xml'/></Types>"},
            {"_rels/.rels",
             "<Relationships xmlns='http://schemas.openxmlformats.org/package/2006/relationships'>"
             "<Relationship Target='/3D/3dmodel.model' Id='r' "
             "Type='http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel'/>"
             "</Relationships>"},
            {"3D/3dmodel.model", text, true}};
}

std::string joined(const Strings& lines) {
    std::string all;
    for (const std::string& line : lines) all += (all.empty() ? "" : "\n") + line;
    return all;
}

// The warnings, or the error.
std::string review(const std::string& text) {
    const auto warnings = prep::detail::review_model(text, "/3D/3dmodel.model", "a.3mf");
    return warnings ? joined(*warnings) : prep::to_string(warnings.error());
}

prep::Result<prep::Scene> load(const std::vector<Part>& parts, const test::TempDir& dir) {
    test::write_text(dir / "a.3mf", package(parts));
    return prep::load_scene(dir / "a.3mf");
}

std::string load_error(const std::vector<Part>& parts) {
    const test::TempDir dir;
    const auto scene = load(parts, dir);
    if (scene) return "no error";
    const std::string error = prep::to_string(scene.error());
    return error.substr(error.find("a.3mf"));
}

TEST(ThreeMf, NothingIsSaidOfWhatIsRead) {
    const std::string two = object(2,
                                   "<components><component objectid='1'/><component objectid='01' "
                                   "p:path='/3D/3dmodel.model'/></components>");
    EXPECT_EQ(review(model(object(1, tetrahedron) + two, "<item objectid='2' p:UUID='u'/>",
                           "requiredextensions='m p'")),
              "");
    EXPECT_EQ(review(model("<!-- <object id='8'/> -->" + object(1, tetrahedron),
                           "<item objectid='1' partnumber=\"<item objectid='9'/>\"/>")),
              "");
    const test::TempDir dir;
    const auto scene = load(parts_of(model(object(1, tetrahedron), "<item objectid='1'/>")), dir);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->warnings, Strings{});
    ASSERT_EQ(scene->meshes.size(), 1u);
    EXPECT_EQ(scene->meshes[0].face_count(), 4u);
}

TEST(ThreeMf, RequiredExtensionsThatAreNotReadAreErrors) {
    const auto with = [](const std::string& attributes) {
        return model(object(1, tetrahedron), "<item objectid='1'/>", attributes);
    };
    const std::string unknown =
        "a.3mf/3D/3dmodel.model: it requires the extension http://example.org/unknown, which is "
        "not "
        "read: export it without; materials, production and triangle sets are";
    EXPECT_EQ(review(with("xmlns:z='http://example.org/unknown' requiredextensions='m z'")),
              unknown);
    EXPECT_EQ(review(with("requiredextensions=' q '")),
              "a.3mf/3D/3dmodel.model: it requires the extension 'q', a prefix that it does not "
              "declare");
    EXPECT_EQ(review(with("xmlns:z='http://example.org/unknown' recommendedextensions='z'")), "");
    EXPECT_EQ(
        load_error(parts_of(with("xmlns:z='http://example.org/unknown' requiredextensions='z'"))),
        unknown);
}

TEST(ThreeMf, ObjectsOfOtherPartsAreErrorsOrWarnings) {
    const std::string item = "<item objectid='1' p:path='/3D/part.model'/><item objectid='7'/>";
    const std::string component =
        object(2, "<components><component objectid='7' p:path='/3D/part.model'/></components>");
    const std::string required =
        "a.3mf/3D/3dmodel.model: objects of other parts of the package are not read: "
        "/3D/part.model; save it with all objects in one model part";
    EXPECT_EQ(review(model(object(7, tetrahedron), item, "requiredextensions='p'")), required);
    EXPECT_EQ(review(model(object(7, tetrahedron) + component, "<item objectid='2'/>",
                           "requiredextensions='p'")),
              required);
    EXPECT_EQ(review(model(object(7, tetrahedron), item)),
              "objects of other parts of the package are not read and missing: /3D/part.model");
    EXPECT_EQ(review(model(object(7, tetrahedron) + component, "<item objectid='2'/>")),
              "objects of other parts of the package are not read and missing: /3D/part.model\n"
              "in the place of objects of other parts stand those of the same number here: "
              "component 7 of object 2");
}

TEST(ThreeMf, WhatNamesNoObjectIsAWarning) {
    const std::string two =
        object(2, "<components><component objectid='77'/></components>") + "<object id='5'/>";
    const std::string expected =
        "what names an object that the file does not have is missing: component 77 of object 2, "
        "item 99, item without an object\n"
        "objects without a mesh or components that are read are empty: 5";
    const std::string text =
        model(two + object(1, tetrahedron),
              "<item objectid='99'/><item/><item objectid='1'/><item objectid='5'/>");
    EXPECT_EQ(review(text), expected);
    const test::TempDir dir;
    const auto scene = load(parts_of(text), dir);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(joined(scene->warnings), expected);
}

// What our own reading makes of them; Assimp is not asked.
TEST(ThreeMf, EveryTruncationAndEveryByteTurnedIsTakenWithoutACrash) {
    const std::string whole = package(
        parts_of(model(object(1, tetrahedron), "<item objectid='1'/>", "requiredextensions='p'")),
        true);
    const auto read = [](const std::string& file) {
        const auto parts = PackageParts::of(raw(file), "a.3mf");
        if (!parts) return false;
        const auto bytes = parts->unpack("/3D/3dmodel.model");
        return bytes && prep::detail::review_model(text_of(*bytes), "/3D/3dmodel.model", "a.3mf");
    };
    ASSERT_TRUE(read(whole));
    for (std::size_t n = 0; n < whole.size(); ++n)
        EXPECT_FALSE(read(whole.substr(0, n))) << "cut to " << n;
    std::size_t refused = 0;
    for (std::size_t i = 0; i < whole.size(); ++i)
        for (const int bits : {0x01, 0x80, 0xff}) {
            std::string bent = whole;
            bent[i] = char(bent[i] ^ bits);
            refused += !read(bent);
        }
    EXPECT_GT(refused, whole.size());  // the model's bytes have a checksum
    const std::string text = model(object(1, tetrahedron), "<item objectid='1'/>");
    for (std::size_t n = 0; n < text.size(); ++n) (void)review(text.substr(0, n));
}

TEST(ThreeMf, DamagedModelsAndPackagesWithoutAModelAreErrors) {
    std::vector<Part> parts = parts_of(model(object(1, tetrahedron), "<item objectid='1'/>"));
    parts[2].told_size = 5;
    EXPECT_EQ(load_error(parts), "a.3mf/3D/3dmodel.model: a part of the package is damaged");
    parts = parts_of("");
    parts[1].text = "<Relationships/>";
    EXPECT_EQ(load_error(parts), "a.3mf/_rels/.rels: the package names no model");
    parts[1].name = "other";
    EXPECT_EQ(load_error(parts), "a.3mf/_rels/.rels: the package has no such part");
}

// --- pictures and colours
// --------------------------------------------------------------------------

// A picture and the triangles that have it, each vertex with the UV of its number.
std::string textured(const std::string& attributes) {
    std::string mesh = tetrahedron;
    for (std::size_t at = 0; (at = mesh.find(" v1='", at)) != std::string::npos;) {
        const std::string indices = mesh.substr(at, mesh.find("/>", at) - at);  // " v1='0' …"
        std::string same = indices;
        for (char& c : same)
            if (c == 'v') c = 'p';
        mesh.insert(at, " pid='21'" + same);
        at += 9 + same.size() + 1;
    }
    return model("<m:texture2d id='20' path='/3D/Textures/t.png' contenttype='image/png' " +
                     attributes +
                     "/><m:texture2dgroup id='21' texid='20'><m:tex2coord u='0' v='0'/>"
                     "<m:tex2coord u='1' v='0'/><m:tex2coord u='0' v='1'/>"
                     "<m:tex2coord u='1' v='1'/></m:texture2dgroup>" +
                     object(1, mesh, "pid='21' pindex='0'"),
                 "<item objectid='1'/>");
}

TEST(ThreeMf, PicturesAreThoseOfThePackage) {
    std::vector<Part> parts = parts_of(textured(""));
    const std::string picture = "any bytes: nobody decodes them here";
    parts.push_back({"3D/Textures/other.png", "another"});
    parts.push_back({"3D/Textures/t.png", picture, true});
    const test::TempDir dir;
    const auto scene = load(parts, dir);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(scene->warnings, Strings{});
    ASSERT_EQ(scene->images.size(), 1u);
    EXPECT_EQ(text_of(scene->images[0].bytes), picture);
    ASSERT_EQ(scene->materials.size(), 1u);
    EXPECT_TRUE(scene->materials[0].diffuse_map);
    EXPECT_EQ(scene->materials[0].diffuse, glm::vec4(1));
    ASSERT_EQ(scene->meshes.at(0).uvs.size(), 1u);
}

// The search for pictures would find it by its name.
TEST(ThreeMf, FilesBesideThePackageAreNotItsPictures) {
    const test::TempDir dir;
    test::write_text(dir / "t.png", "beside");
    const auto scene = load(parts_of(textured("tilestyleu='wrap' tilestylev='mirror'")), dir);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_TRUE(scene->images.empty());
    EXPECT_EQ(scene->materials.at(0).diffuse, glm::vec4(1));
    EXPECT_EQ(joined(scene->warnings),
              "pictures that the package does not have, or not whole: /3D/Textures/t.png\n"
              "textures repeat, whatever the file says of their tiles: /3D/Textures/t.png");
}

// Assimp has room for one of each vertex.
TEST(ThreeMf, SeamsOfUvsAreToldWhereTheyAre) {
    // The first three triangles share vertices, in other corners of them.
    const std::string expected =
        "vertices have one UV each, which is wrong at the seams of objects: 1";
    const std::string groups =
        "<m:texture2dgroup id='20' texid='3'/><m:texture2dgroup id='21' texid='3'>"
        "<m:tex2coord u='0' v='0'/><m:tex2coord u='1' v='0'/><m:tex2coord u='0' v='1'/>"
        "<m:tex2coord u='1.0' v='0.0'/></m:texture2dgroup>";
    const auto with = [&](const std::string& first, const std::string& second) {
        const std::string triangles = "<triangles><triangle v1='0' v2='2' v3='1' " + first +
                                      "/><triangle v1='0' v2='1' v3='3' " + second +
                                      "/></triangles></mesh>";
        return model(
            groups + object(1, tetrahedron.substr(0, tetrahedron.find("<triangles>")) + triangles,
                            "pid='21' pindex='1'"),
            "<item objectid='1'/>");
    };
    const std::string first = "pid='21' p1='0' p2='2' p3='1'";
    EXPECT_EQ(review(with(first, "pid='21' p1='0' p2='1' p3='1'")), "");
    EXPECT_EQ(review(with(first, "pid='21' p1='0' p2='3' p3='2'")), "");  // the same in other words
    EXPECT_EQ(review(with(first, "pid='21' p1='0' p2='2' p3='1'")), expected);
    EXPECT_EQ(review(with(first, "pid='21' p1='0'")), expected);  // all three are p1
    EXPECT_EQ(review(with("", "")), "");                          // all have the object's
    EXPECT_EQ(review(with("", first)), expected);
    EXPECT_EQ(review(with(first, "pid='20' p1='7'")), "");  // a group without any
}

TEST(ThreeMf, DisplayColorsAreEncodedInSrgb) {
    const test::TempDir dir;
    const auto scene =
        load(parts_of(model("<basematerials id='10'><base name='Grey' displaycolor='#808080'/>"
                            "<base name='Odd' displaycolor='#FF0A00'/></basematerials>" +
                                object(1, tetrahedron, "pid='10' pindex='0'"),
                            "<item objectid='1'/>")),
             dir);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->materials.size(), 2u);
    // IEC 61966-2-1: ((128/255 + 0.055) / 1.055)^2.4, and 10/255 / 12.92 on the straight part.
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(scene->materials[0].diffuse[k], 0.2158605f, 1e-6f);
    EXPECT_EQ(scene->materials[1].diffuse.r, 1.0f);
    EXPECT_NEAR(scene->materials[1].diffuse.g, 0.00303527f, 1e-8f);
    EXPECT_EQ(scene->materials[1].diffuse.b, 0.0f);
}

}  // namespace
