// Binary PLY read by places in the file, against the same values written as text, which is read one
// by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "formats/ply/ply.h"
#include "mesh_files.h"

namespace {

// A record's values in the order of its properties; lists with their lengths before them.
struct Value {
    std::string type;
    double value = 0;
};
using Record = std::vector<Value>;

template <class T>
void put(std::string& out, double value, bool big) {
    const T typed = T(value);
    char raw[sizeof typed];
    std::memcpy(raw, &typed, sizeof typed);
    if (big) std::reverse(raw, raw + sizeof typed);
    out.append(raw, sizeof typed);
}

void put(std::string& out, const Value& v, bool big) {
    if (v.type == "char") put<std::int8_t>(out, v.value, big);
    if (v.type == "uchar") put<std::uint8_t>(out, v.value, big);
    if (v.type == "short") put<std::int16_t>(out, v.value, big);
    if (v.type == "ushort") put<std::uint16_t>(out, v.value, big);
    if (v.type == "int") put<std::int32_t>(out, v.value, big);
    if (v.type == "uint") put<std::uint32_t>(out, v.value, big);
    if (v.type == "float") put<float>(out, v.value, big);
    if (v.type == "double") put<double>(out, v.value, big);
}

struct File {
    std::string before_elements;
    std::string vertex_properties, face_properties;
    std::vector<Record> vertices, faces;

    std::string header(const std::string& format) const {
        return "ply\nformat " + format + " 1.0\n" + before_elements + "element vertex " +
               std::to_string(vertices.size()) + "\n" + vertex_properties + "element face " +
               std::to_string(faces.size()) + "\n" + face_properties + "end_header\n";
    }
    std::string text() const {
        std::string out = header("ascii");
        for (const auto* records : {&vertices, &faces})
            for (const Record& record : *records) {
                for (const Value& v : record) {
                    char digits[40];
                    std::snprintf(digits, sizeof digits, "%.17g ", v.value);
                    out += digits;
                }
                out += '\n';
            }
        return out;
    }
    std::string bytes(bool big) const {
        std::string out = header(big ? "binary_big_endian" : "binary_little_endian");
        for (const auto* records : {&vertices, &faces})
            for (const Record& record : *records)
                for (const Value& v : record) put(out, v, big);
        return out;
    }
};

prep::Result<prep::Scene> parse(const std::string& bytes, int threads = 0) {
    return prep::parse_ply(std::as_bytes(std::span(bytes)), "t.ply", nullptr, threads);
}

// Two blocks of records and a part of a third.
constexpr int count = 2 * 4096 + 77;

// A strip of triangles, `corners` a face, with whatever else the flags ask for.
File strip(int corners, bool doubles, bool vertex_values, bool face_values) {
    File file;
    const std::string real = doubles ? "double" : "float";
    file.vertex_properties =
        "property " + real + " x\nproperty " + real + " y\nproperty " + real + " z\n";
    if (vertex_values)
        file.vertex_properties +=
            "property short nx\nproperty char ny\nproperty float nz\nproperty int quality\n"
            "property uchar red\nproperty ushort green\nproperty float blue\nproperty uchar alpha\n"
            "property float s\nproperty double t\n";
    file.face_properties =
        "property list uchar " + std::string(doubles ? "int" : "uint") + " vertex_indices\n";
    if (face_values) {
        file.before_elements = "comment TextureFile a.png\ncomment TextureFile b.png\n";
        file.face_properties = "property short flags\n" + file.face_properties +
                               "property list ushort float texcoord\nproperty int texnumber\n"
                               "property list int short more\n";
    }
    for (int v = 0; v < count; ++v) {
        // Floats exactly, so that text says the same.
        Record record{{real, double(float(v % 97) / 3)},
                      {real, double(v / 97)},
                      {real, double(float(v % 7) * 0.1f)}};
        if (vertex_values)
            for (const Value& value :
                 {Value{"short", double(v - 4000)}, Value{"char", double(v % 256 - 128)},
                  Value{"float", v / 8.0}, Value{"int", -5}, Value{"uchar", double(v % 256)},
                  Value{"ushort", double(v)}, Value{"float", v / 4.0},
                  Value{"uchar", double(v / 100)}, Value{"float", v / 16.0},
                  Value{"double", v / 32.0}})
                record.push_back(value);
        file.vertices.push_back(record);
    }
    for (int f = 0; f < count; ++f) {
        Record record;
        if (face_values) record.push_back({"short", -7});
        record.push_back({"uchar", double(corners)});
        for (int k = 0; k < corners; ++k)
            record.push_back({doubles ? "int" : "uint", double((f + k * k) % count)});
        if (face_values) {
            record.push_back({"ushort", double(2 * corners)});
            for (int k = 0; k < 2 * corners; ++k) record.push_back({"float", (f + k) / 64.0});
            record.push_back({"int", double(f % 5 - 1)});  // -1 and 2, 3 are none of both
            record.push_back({"int", 2});
            record.push_back({"short", 1});
            record.push_back({"short", -1});
        }
        file.faces.push_back(record);
    }
    return file;
}

void expect_same_as_text(const File& file, const std::string& what) {
    const auto text = parse(file.text());
    ASSERT_TRUE(text.has_value()) << what << prep::to_string(text.error());
    for (const bool big : {false, true})
        for (const int threads : {1, 2, 8}) {
            const auto scene = parse(file.bytes(big), threads);
            ASSERT_TRUE(scene.has_value()) << what << prep::to_string(scene.error());
            EXPECT_EQ(test::exact_difference(text->meshes[0], scene->meshes[0]), "")
                << what << (big ? ", big" : ", little");
            EXPECT_EQ(text->warnings, scene->warnings) << what;
            EXPECT_EQ(text->materials.size(), scene->materials.size()) << what;
        }
}

TEST(PlyRecords, SaysWhatTextSays) {
    for (const int corners : {3, 4, 7})
        for (const bool doubles : {false, true})
            for (const bool vertex_values : {false, true})
                for (const bool face_values : {false, true})
                    expect_same_as_text(strip(corners, doubles, vertex_values, face_values),
                                        std::to_string(corners) + (doubles ? " doubles" : "") +
                                            (vertex_values ? " vertex values" : "") +
                                            (face_values ? " face values" : ""));
}

TEST(PlyRecords, FacesWhosePictureIsNotThereHaveNone) {
    File file = strip(3, false, false, true);
    ASSERT_EQ(file.faces[1][12].type, "int");
    for (std::size_t f = 0; f < file.faces.size(); ++f)
        file.faces[f][12].value = f == 1 ? -1 : f == 2 ? 2 : f == 4096 ? 7 : double(f % 2);
    expect_same_as_text(file, "pictures that are not there");
    const auto scene = parse(file.bytes(false));
    ASSERT_TRUE(scene.has_value());
    ASSERT_EQ(scene->materials.size(), 3u);
    EXPECT_EQ(scene->materials[2].diffuse_map.texture, prep::no_index);
    for (const std::size_t f : {1, 2, 4096}) EXPECT_EQ(scene->meshes[0].face_materials[f], 2u) << f;
    EXPECT_EQ(scene->meshes[0].face_materials[3], 1u);
    EXPECT_EQ(std::count_if(scene->warnings.begin(), scene->warnings.end(),
                            [](const std::string& warning) {
                                return warning.ends_with(
                                    ": 2 faces have a texnumber that the file has no picture for: "
                                    "none");
                            }),
              1);
}

TEST(PlyRecords, ListsOfOtherLengthsAreReadOneByOne) {
    for (const int odd : {0, 1, 4095, 4096, count - 1}) {
        for (const int corners : {2, 3, 5}) {
            File file = strip(4, false, false, false);
            Record& face = file.faces[std::size_t(odd)];
            face[0].value = corners;
            face.resize(std::size_t(1 + corners), {"uint", 9});
            expect_same_as_text(
                file, std::to_string(corners) + " corners in " + std::to_string(odd) + " ");
        }
        File file = strip(3, false, false, true);
        Record& face = file.faces[std::size_t(odd)];
        face[5].value = 0;  // no texcoord
        face.erase(face.begin() + 6, face.begin() + 12);
        expect_same_as_text(file, "no texcoord in " + std::to_string(odd) + " ");
    }
    // Also where the vertices have lists.
    File file = strip(3, false, true, false);
    file.vertex_properties += "property list uchar int neighbours\n";
    for (Record& vertex : file.vertices) vertex.push_back({"uchar", 0});
    expect_same_as_text(file, "empty lists of vertices");
    file.vertices[5000].back().value = 2;
    file.vertices[5000].push_back({"int", 1});
    file.vertices[5000].push_back({"int", 2});
    expect_same_as_text(file, "a vertex with a longer list");
}

TEST(PlyRecords, TwoElementsOfFacesAreOneMesh) {
    File file = strip(3, false, false, false);
    const std::string whole = file.bytes(false);
    const std::size_t half = 5000;
    std::string cut = whole;
    const std::string one = "element face " + std::to_string(count) + "\n" + file.face_properties;
    cut.replace(cut.find(one), one.size(),
                "element face " + std::to_string(half) + "\n" + file.face_properties +
                    "element face " + std::to_string(std::size_t(count) - half) + "\n" +
                    file.face_properties);
    const auto first = parse(whole), second = parse(cut);
    ASSERT_TRUE(first.has_value() && second.has_value());
    EXPECT_EQ(test::exact_difference(first->meshes[0], second->meshes[0]), "");
}

TEST(PlyRecords, StripsBeforeFacesHaveTheFirstPicture) {
    for (const bool odd : {false, true}) {
        File file = strip(3, false, true, true);
        if (odd) {
            Record& face = file.faces[1];
            face[1].value = 4;
            face.insert(face.begin() + 2, {"uint", 7});
        }
        std::string text = file.bytes(false);
        const std::string element = "element face ";
        text.insert(text.find(element),
                    "element tristrips 1\nproperty list int int vertex_indices\n");
        std::string strips;
        for (const int v : {4, 0, 1, 2, 3}) put<std::int32_t>(strips, v, false);
        std::size_t faces = 0;
        for (const Record& record : file.faces)
            for (const Value& v : record) {
                std::string bytes;
                put(bytes, v, false);
                faces += bytes.size();
            }
        text.insert(text.size() - faces, strips);
        const auto scene = parse(text);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        const prep::Mesh& mesh = scene->meshes[0];
        ASSERT_EQ(mesh.face_count(), std::size_t(count) + 2);
        EXPECT_EQ(mesh.face_materials[0], 0u);
        EXPECT_EQ(mesh.face_materials[1], 0u);
        for (std::uint32_t f = 0; f < 10; ++f)
            EXPECT_EQ(mesh.face_materials[f + 2], f % 5 == 2 ? 1u : f % 5 == 1 ? 0u : 2u) << f;
    }
}

TEST(PlyRecords, ColoursOfFacesAreWhatTextSays) {
    for (const bool odd : {false, true}) {
        File file = strip(3, false, false, false);
        file.face_properties +=
            "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty ushort "
            "alpha\n";
        for (int f = 0; f < count; ++f)
            for (const Value& value : {Value{"uchar", double(f % 256)}, Value{"uchar", 7.0},
                                       Value{"uchar", 255.0}, Value{"ushort", double(f)}})
                file.faces[std::size_t(f)].push_back(value);
        if (odd) {
            Record& face = file.faces[4100];
            face[0].value = 4;
            face.insert(face.begin() + 1, {"uint", 8});
        }
        expect_same_as_text(file, odd ? "one by one " : "records ");
        const auto scene = parse(file.bytes(true));
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        const prep::Mesh& mesh = scene->meshes[0];
        ASSERT_EQ(mesh.colors.size(), 1u);
        const std::uint32_t corner = mesh.face_offsets[5001];
        const glm::vec4 color = mesh.colors[0].values[mesh.colors[0].indices[corner]];
        // IEC 61966-2-1 of 5001 % 256 = 137.
        EXPECT_NEAR(color.r, std::pow((137 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
        EXPECT_EQ(color.b, 1.0f);
        EXPECT_FLOAT_EQ(color.a, 5001 / 65535.0f);
    }
}

TEST(PlyRecords, ErrorsNameTheRecordAndTheByte) {
    const File good = strip(3, true, false, false);
    const std::size_t faces_begin = good.bytes(false).size() - std::size_t(count) * 13;
    for (const int bad : {0, 4095, 4096, count - 1}) {
        File file = good;
        file.faces[std::size_t(bad)][2].value = -1;
        for (const bool big : {false, true}) {
            const auto scene = parse(file.bytes(big));
            ASSERT_FALSE(scene.has_value());
            EXPECT_EQ(test::error_of(scene),
                      "t.ply, byte " +
                          std::to_string(faces_begin + std::size_t(bad) * 13 + 9 -
                                         (big ? 3 : 0)) +  // "big" is shorter than "little"
                          ": a vertex index that is none");
        }
        // One that is a number, but none of the file's vertices.
        file.faces[std::size_t(bad)][2].value = count;
        EXPECT_NE(test::error_of(parse(file.bytes(false)))
                      .find("vertex index " + std::to_string(count) +
                            " is out of range: the file has " + std::to_string(count)),
                  std::string::npos);
        // Of several, the first.
        file.faces.back()[3].value = count + 5;
        EXPECT_NE(test::error_of(parse(file.bytes(false)))
                      .find("vertex index " + std::to_string(count) + " is out"),
                  std::string::npos);
    }
    const std::string whole = good.bytes(false);
    for (const std::size_t left : {faces_begin + 4096 * 13 + 5, whole.size() - 1})
        EXPECT_NE(
            test::error_of(parse(whole.substr(0, left)))
                .find("the file ends or is malformed in face " +
                      std::to_string((left - faces_begin) / 13) + " of " + std::to_string(count)),
            std::string::npos);
}

TEST(PlyRecords, LengthsBelowZeroAndBeyondTheFileAreErrors) {
    for (const double length : {-1.0, -2147483648.0, 2147483647.0, 1e6}) {
        File file = strip(3, false, false, false);
        file.face_properties = "property list int uint vertex_indices\n";
        for (Record& face : file.faces) face[0].type = "int";
        file.faces[0][0].value = length;
        for (const bool big : {false, true})
            EXPECT_NE(test::error_of(parse(file.bytes(big))).find("in face 0 of"),
                      std::string::npos)
                << length;
    }
}

}  // namespace
