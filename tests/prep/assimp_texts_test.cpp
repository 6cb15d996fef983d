// Files of texts that Assimp alone misreads: AMF's volumes and colours, DirectX' alpha, blocks of
// DXF.
#include <gtest/gtest.h>

#include <algorithm>

#include "formats/assimp/texts/amf_text.h"
#include "formats/assimp/texts/dxf_text.h"
#include "prep/load.h"
#include "temporary_files.h"

namespace {

using prep::detail::with_one_volume_a_mesh;

std::string triangle(const std::string& corners, const std::string& more = "") {
    return "<triangle>" + more + "<v1>" + corners[0] + "</v1><v2>" + corners[1] + "</v2><v3>" +
           corners[2] + "</v3></triangle>";
}
std::string color(const std::string& r, const std::string& g, const std::string& b) {
    return "<color><r>" + r + "</r><g>" + g + "</g><b>" + b + "</b></color>";
}
// A square's corners in the plane z = 0.
std::string corners(const std::string& more = "") {
    std::string out = "<vertices>";
    for (const char* at : {"00", "10", "11", "01"})
        out += std::string("<vertex><coordinates><x>") + at[0] + "</x><y>" + at[1] +
               "</y><z>0</z></coordinates>" + more + "</vertex>";
    return out + "</vertices>";
}
prep::Result<prep::Scene> load_amf(const std::string& inside) {
    const test::TempDir dir;
    test::write_text(dir / "a.amf", "<?xml version=\"1.0\"?>\n<amf>" + inside + "</amf>");
    return prep::load_scene(dir / "a.amf");
}
// The colour at the first corner of each face.
std::vector<glm::vec4> face_colors(const prep::Scene& scene) {
    std::vector<glm::vec4> out;
    for (const prep::Mesh& mesh : scene.meshes)
        for (std::size_t f = 0; f < mesh.face_count(); ++f) {
            const prep::CornerLayer<glm::vec4>& layer = mesh.colors.at(0);
            out.push_back(layer.values.at(layer.indices.at(mesh.face_offsets[f])));
        }
    return out;
}

TEST(AssimpTexts, AllVolumesOfAnAmfMeshAreReadInTheirColours) {
    const auto scene = load_amf(
        "<material id=\"7\">" + color("0", "1", "0") + "</material><object id=\"1\"><mesh>" +
        corners() + "<volume>" + color("1", "0", "0") + triangle("012") +
        "</volume><volume/>\n<!-- --><volume materialid=\"7\">" + triangle("023") +
        triangle("013", color("0", "0", "1")) + "</volume></mesh></object><object id=\"2\"><mesh>" +
        corners() + "<volume>" + triangle("012") + "</volume></mesh></object>");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    ASSERT_EQ(scene->meshes.size(), 2u);
    ASSERT_EQ(scene->meshes[0].face_count(), 3u);
    EXPECT_EQ(scene->meshes[1].face_count(), 1u);
    EXPECT_TRUE(scene->meshes[1].colors.empty());
    prep::Scene first = *scene;
    first.meshes.resize(1);
    EXPECT_EQ(face_colors(first),
              (std::vector<glm::vec4>{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}}));
}

// An object's colour before that of a volume's material, vertices' before both.
TEST(AssimpTexts, ColoursOfAmfHaveTheirOrder) {
    const std::string material = "<material id=\"7\">" + color("0", "1", "0") + "</material>";
    const std::string volumes = "<volume materialid=\"7\">" + triangle("012") +
                                "</volume><volume materialid=\"7\">" + triangle("023") +
                                "</volume></mesh>";
    const auto of_object = load_amf(material + "<object id=\"1\">" + color("0", "0", "1") +
                                    "<mesh>" + corners() + volumes + "</object>");
    ASSERT_TRUE(of_object.has_value()) << prep::to_string(of_object.error());
    EXPECT_EQ(face_colors(*of_object), (std::vector<glm::vec4>{{0, 0, 1, 1}, {0, 0, 1, 1}}));
    const auto of_vertices = load_amf(material + "<object id=\"1\"><mesh>" +
                                      corners(color("1", "0", "0")) + volumes + "</object>");
    ASSERT_TRUE(of_vertices.has_value()) << prep::to_string(of_vertices.error());
    EXPECT_EQ(face_colors(*of_vertices), (std::vector<glm::vec4>{{1, 0, 0, 1}, {1, 0, 0, 1}}));
}

// IEC 61966-2-1 of a half; Assimp has transparent black for what is not said.
TEST(AssimpTexts, ColoursOfAmfAreDecodedAndNoneIsWhite) {
    const auto scene = load_amf("<object id=\"1\"><mesh>" + corners() + "<volume>" +
                                triangle("012", color("0.5", "1", "0")) + triangle("023") +
                                "</volume></mesh></object>");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    const std::vector<glm::vec4> colors = face_colors(*scene);
    ASSERT_EQ(colors.size(), 2u);
    std::size_t white = 0;
    for (const glm::vec4& c : colors) {
        EXPECT_EQ(c.a, 1);
        white += c == glm::vec4(1.0f);
        if (c.b == 0) {
            EXPECT_NEAR(c.r, 0.2140411, 1e-6);
        }
    }
    EXPECT_EQ(white, 1u);
}

TEST(AssimpTexts, OtherAmfTextsStayAsTheyAre) {
    const std::string one = "<amf><object><mesh><volume/></mesh></object></amf>";
    EXPECT_FALSE(with_one_volume_a_mesh(one));
    EXPECT_FALSE(with_one_volume_a_mesh(""));
    EXPECT_FALSE(with_one_volume_a_mesh("<amf><mesh><volume></mesh></volume></amf>"));
    EXPECT_FALSE(with_one_volume_a_mesh("<amf><mesh><volume></volume><volume></volume>"));
    EXPECT_FALSE(with_one_volume_a_mesh("</volume></mesh>"));
    EXPECT_EQ(with_one_volume_a_mesh("<a><mesh><volume/><volume/></mesh></a>"),
              "<a><mesh><volume></volume></mesh></a>");
    EXPECT_EQ(with_one_volume_a_mesh("<mesh><volume><triangle/></volume><volume/></mesh>"),
              "<mesh><volume><triangle/></volume></mesh>");
}

TEST(AssimpTexts, AlphaOfDirectXMaterialsIsOpacity) {
    const test::TempDir dir;
    test::write_text(dir / "a.x",
                     "xof 0303txt 0032\n"
                     "Material Glass { 1.0;0.0;0.0;0.25;; 20.0; 0.5;0.5;0.5;; 0.0;0.0;0.0;; }\n"
                     "Material Clay { 0.0;0.0;1.0;1.0;; 5.0; 0.0;0.0;0.0;; 0.0;0.0;0.0;; }\n"
                     "Mesh m { 4; 0.0;0.0;0.0;, 1.0;0.0;0.0;, 1.0;1.0;0.0;, 0.0;1.0;0.0;;\n"
                     " 2; 3;0,1,2;, 3;0,2,3;;\n"
                     " MeshMaterialList { 2; 2; 0,1;; {Glass} {Clay} } }\n");
    const auto scene = prep::load_scene(dir / "a.x");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    std::size_t found = 0;
    for (const prep::Material& m : scene->materials) {
        if (m.name != "Glass" && m.name != "Clay") continue;
        ++found;
        EXPECT_EQ(m.diffuse.a, m.name == "Glass" ? 0.25f : 1.0f);
        EXPECT_EQ(m.alpha_mode,
                  m.name == "Glass" ? prep::AlphaMode::blend : prep::AlphaMode::opaque);
    }
    EXPECT_EQ(found, 2u);
}

TEST(AssimpTexts, BlocksOfDxfThatAreMisplacedAreCounted) {
    const auto insert = [](const std::string& groups) {
        return "  0\r\nINSERT\r\n  2\r\nTRI\r\n 10\r\n5.0\r\n" + groups;
    };
    const auto misplaced = [](const std::string& inserts) -> std::string {
        const auto said = prep::detail::misread_of_dxf("0\nSECTION\n2\nENTITIES\n" + inserts);
        return said.empty() ? "" : said[0].substr(said[0].find(": ") + 2);
    };
    EXPECT_EQ(misplaced(insert("")), "");
    EXPECT_EQ(misplaced(insert(" 41\r\n1.0\r\n 50\r\n0.0\r\n")), "");
    EXPECT_EQ(misplaced(insert(" 50\r\n90.0\r\n")), "1 is misplaced");
    EXPECT_EQ(misplaced(insert("43\n2\n") + insert("42\n-1\n") + insert("")), "2 are misplaced");
    EXPECT_EQ(misplaced("0\nLINE\n50\n90\n"), "");
    EXPECT_EQ(misplaced("50"), "");
    const test::TempDir dir;
    test::write_text(dir / "a.dxf",
                     "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nTRI\n10\n0.0\n20\n0.0\n30\n0.0\n"
                     "0\n3DFACE\n8\nL\n10\n0.0\n20\n0.0\n30\n0.0\n11\n1.0\n21\n0.0\n31\n0.0\n"
                     "12\n0.0\n22\n1.0\n32\n0.0\n13\n0.0\n23\n1.0\n33\n0.0\n0\nENDBLK\n0\nENDSEC\n"
                     "0\nSECTION\n2\nENTITIES\n" +
                         insert("50\n90.0\n") + "0\nENDSEC\n0\nEOF\n");
    const auto scene = prep::load_scene(dir / "a.dxf");
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    EXPECT_EQ(std::count_if(scene->warnings.begin(), scene->warnings.end(),
                            [](const std::string& text) {
                                return text.find("1 is misplaced") != std::string::npos;
                            }),
              1);
}

// What is put into each triangle is the colour's numbers alone; parts within one another are no
// AMF.
TEST(AssimpTexts, AmfTextsOfNonsenseStaySmall) {
    std::string many = "<amf><object><mesh><volume><color><!--" + std::string(1000000, 'x') +
                       "--><r>1</r></color>";
    for (int k = 0; k < 10000; ++k) many += "<triangle></triangle>";
    many += "</volume><volume></volume></mesh></object></amf>";
    const auto joined = with_one_volume_a_mesh(many);
    ASSERT_TRUE(joined);
    EXPECT_LT(joined->size(), 2000000u);
    EXPECT_NE(joined->find("<triangle><color><r>1</r></color></triangle>"), std::string::npos);
    EXPECT_FALSE(with_one_volume_a_mesh(
        "<amf><object><mesh><volume><color><mesh><volume/><volume/></mesh></color></volume>"
        "<volume/></mesh></object></amf>"));
}

}  // namespace
