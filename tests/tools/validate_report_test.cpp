// The pages and sheets that `validate` writes: their figures against counts made here, which meshes
// they are of, and how the command ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "command_runner.h"
#include "prep/image.h"
#include "prep/version.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

// A cube without its last side, a UV square on each of its faces.
const std::size_t faces[5][4] = {
    {3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}};

std::string open_cube() {
    std::string text = test::textured_cube_obj();
    text.resize(text.rfind("f "));
    return text;
}

// All names and values of the page's lists, and the cells of its tables.
std::map<std::string, std::string> figures_of(const std::string& page) {
    std::map<std::string, std::string> out;
    const auto between = [&page](std::size_t at, const char* end) {
        return page.substr(at, page.find(end, at) - at);
    };
    for (std::size_t at = page.find("<dt>"); at != std::string::npos;
         at = page.find("<dt>", at + 1)) {
        const std::size_t value = page.find('>', page.find("<dd", at)) + 1;
        EXPECT_TRUE(out.emplace(between(at + 4, "</dt>"), between(value, "</dd>")).second);
    }
    return out;
}

// A figure of the JSON as the page shows it.
std::string as_text(const json& value) {
    if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
    return value.is_string() ? value.get<std::string>() : value.dump();
}

TEST(Validate, TheFiguresOfThePageAreThoseOfTheMesh) {
    const TempDir dir;
    write_text(dir / "open.obj", open_cube());
    const test::Ran ran =
        run_here({"validate", (dir / "open.obj").string(), "-o", (dir / "out").string(), "--panel",
                  "64", "--weight", "angle", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    // Every corner of every face is a vertex of its own: all edges turn by 90°. A copy is split by
    // UVs where it has not those of its vertex's first corner.
    std::map<std::size_t, std::size_t> first;
    int seams = 0;
    for (const auto& face : faces)
        for (std::size_t k = 0; k < 4; ++k) {
            const auto [at, fresh] = first.emplace(face[k], k);
            seams += !fresh && at->second != k;
        }
    const std::map<std::string, std::string> expected = {
        {"faces", "5"},
        {"triangles, quads, polygons", "0, 5, 0"},
        {"components", "1"},
        {"closed", "no, 4 open edges"},
        {"manifold", "yes"},
        {"consistent orientation", "yes"},
        {"materials", "0"},
        {"in the file", "8"},
        {"prepared", "20"},
        {"triangles", "10"},
        {"split at hard edges", "12"},
        {"split at UV seams", std::to_string(seams)},
        {"normal length off 1 by", "0"},
        {"turn against the face", "mean 0.0°, max 0.0°"},
        {"corners lit from behind", "0"},
        {"tangent length off 1 by", "0"},
        {"normal · tangent at most", "0"},
        {"mirrored triangles", "0 of 10"},
        {"tangents called for", "no"},
        {"angle", "8"},
        {"open border", "4"},
        {"open-edge", "4"},
        {"hole", "1"}};
    const std::string page = test::file_text(dir / "out/open.html");
    std::map<std::string, std::string> found = figures_of(page);
    for (const char* name : {"flat – Gouraud", "Gouraud – Phong", "Phong – normal-mapped"})
        EXPECT_EQ(found.erase(name), 1u) << name;  // Panels.* measures them
    EXPECT_EQ(found, expected);
    // JSON has the same, group by group.
    const json file = ran.json()["files"][0];
    std::size_t figures = 0;
    for (const auto& [title, group] : file["numbers"][0]["figures"].items())
        for (const auto& [name, value] : group.items()) {
            const auto said = found.find(name);
            EXPECT_TRUE(said == found.end() || as_text(value) == said->second)
                << title << " " << name << ": " << value;
            ++figures;
        }
    EXPECT_EQ(figures, expected.size() + 3);
    EXPECT_EQ(file["page"], (dir / "out/open.html").string());
    EXPECT_EQ(file["sheets"], json::array({(dir / "out/open.png").string()}));
    EXPECT_EQ(file["numbers"][0]["sheet"], "open.obj");
    EXPECT_EQ(file["numbers"][0]["panels"].size(), 10u);
    for (const json& panel : file["numbers"][0]["panels"]) EXPECT_EQ(panel["drawn"], true);
    // Words around them.
    for (const char* text :
         {"<h1>open.obj</h1>\n<p>1 mesh, 5 faces, 10 triangles; 8 → 20 vertices</p>",
          "<strong>Tangents</strong>No mirrored UVs<", "alt=\"mesh 'open', flat shading",
          "<tr><td>tangents</td><td>run</td><td>asked for by the request</td></tr>",
          "<tr><td>weld</td><td>skipped</td><td>the file indexes positions apart from",
          "<tr><td>info</td><td>4</td><td>open-edge</td><td>open</td><td>only one face has the "
          "edge</td><td>edges "})
        EXPECT_NE(page.find(text), std::string::npos) << text;
    EXPECT_NE(page.find("<footer>meshprep " + std::string(prep::version()) +
                        " · hard angle 60° · weight angle</footer>"),
              std::string::npos);
    const auto sheet = prep::load_image(dir / "out/open.png");
    ASSERT_TRUE(sheet);
    EXPECT_GT(sheet->width, 4 * 64u);
}

// Three meshes; the last has mirrored UVs and a normal map that calls for tangents.
std::string three() {
    test::GltfText gltf;
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    gltf.add({"first", positions, {}, {}, {}, {0, 1, 2}, "", ""});
    gltf.add({"second", positions, {}, {}, {}, {0, 1, 2}, "", ""});
    gltf.add({"2", positions, {}, {0, 0, 1, 0, 0, 1}, {}, {0, 1, 2}, "\"material\":0", ""});
    return gltf.text(R"("materials":[{"normalTexture":{"index":0}}],"textures":[{"source":0}],)"
                     R"("images":[{"uri":"none.png"}])");
}

TEST(Validate, SheetsAreOfTheSceneAndOfEachMesh) {
    const TempDir dir;
    write_text(dir / "a.gltf", three());
    const auto run = [&](std::vector<std::string> more) {
        std::vector<std::string> words = {
            "validate", (dir / "a.gltf").string(), "-o", (dir / "out").string(), "--panel", "64",
            "--json"};
        words.insert(words.end(), more.begin(), more.end());
        return run_here(words);
    };
    const test::Ran all = run({});
    ASSERT_EQ(all.exit_code, 0) << all.err;
    const json numbers = all.json()["files"][0]["numbers"];
    std::vector<std::string> sheets, called, triangles, mirrored;
    for (const json& n : numbers) {
        sheets.push_back(n["sheet"]);
        called.push_back(as_text(n["figures"]["Normals and tangents"]["tangents called for"]));
        triangles.push_back(as_text(n["figures"]["Vertices"]["triangles"]));
        mirrored.push_back(n["figures"]["Normals and tangents"].value("mirrored triangles", "–"));
    }
    EXPECT_EQ(sheets, (std::vector<std::string>{"a.gltf · whole scene", "a.gltf · mesh 'first'",
                                                "a.gltf · mesh 'second'", "a.gltf · mesh '2'"}));
    EXPECT_EQ(called, (std::vector<std::string>{"yes", "no", "no", "yes"}));
    EXPECT_EQ(triangles, (std::vector<std::string>{"3", "1", "1", "1"}));
    EXPECT_EQ(mirrored, (std::vector<std::string>{"1 of 3", "–", "–", "1 of 1"}));
    EXPECT_EQ(numbers[0]["figures"]["Mesh"]["meshes"], 3);
    EXPECT_EQ(numbers[0]["figures"]["Findings"]["open-edge"], 9);
    EXPECT_EQ(numbers[1]["figures"]["Findings"]["open-edge"], 3);
    EXPECT_EQ(numbers[1]["figures"]["Mesh"].contains("meshes"), false);
    // Names come before numbers, in the order of the meshes.
    const auto chosen = [&](std::vector<std::string> more) {
        std::string names;
        const json document = run(std::move(more)).json();
        for (const json& n : document["files"][0]["numbers"])
            names += n["sheet"].get<std::string>().substr(10) + ";";
        return names;
    };
    EXPECT_EQ(chosen({"--mesh", "second", "--mesh", "0"}), "mesh 'second';mesh 'first';");
    EXPECT_EQ(chosen({"--mesh", "2"}), "mesh '2';");
    const test::Ran none = run({"--mesh", "third"});
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_NE(none.err.find("no mesh 'third'; the file has 0 'first', 1 'second', 2 '2'"),
              std::string::npos)
        << none.err;
    const test::Ran few = run({"--max-meshes", "1"});
    EXPECT_EQ(few.exit_code, 0);
    EXPECT_EQ(few.json()["files"][0]["sheets"].size(), 2u);  // the whole, and one
    EXPECT_NE(few.err.find("2 meshes left out; --max-meshes N draws more"), std::string::npos);
}

// What tangents the options ask for is prepared; by default the sheet shows them where there can
// be some.
TEST(Validate, OptionsOfPreparationReachTheSheet) {
    const TempDir dir;
    write_text(dir / "open.obj", open_cube());
    const auto run = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words = {
            "validate", (dir / "open.obj").string(), "-o", (dir / "out").string(), "--panel", "64",
            "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.json()["files"][0]["numbers"][0];
    };
    const json off = run({"--tangents", "none", "--hard-angle", "off"});
    EXPECT_FALSE(off["figures"]["Normals and tangents"].contains("mirrored triangles"));
    EXPECT_EQ(off["figures"]["Vertices"].contains("split at hard edges"), false);
    EXPECT_EQ(off["figures"]["Edges"].contains("angle"), false);
    for (const json& panel : off["panels"])
        EXPECT_EQ(panel["drawn"], panel["id"] != "tangents" && panel["id"] != "normal-mapped")
            << panel;
    EXPECT_NE(test::file_text(dir / "out/open.html").find(" · hard angle off · weight area<"),
              std::string::npos);
}

TEST(Validate, EndsAsItsInputsDo) {
    const TempDir dir;
    // Points alone are drawn at once: no faces to be shaded.
    const std::string points = "v 0 0 0\nv 1 0 0\np 1 2\n";
    std::filesystem::create_directory(dir / "sub");
    write_text(dir / "a.obj", points);
    write_text(dir / "a.off", "OFF\n2 0 0\n0 0 0\n1 0 0\n");
    write_text(dir / "sub/a.obj", points);
    write_text(dir / "bad.obj", "v 0 0 0\nf 1 2 3\n");
    const std::string a = (dir / "a.obj").string(), off = (dir / "a.off").string(),
                      bad = (dir / "bad.obj").string(), out = (dir / "out").string();
    const auto run = [&](std::vector<std::string> inputs) {
        std::vector<std::string> words = {"validate"};
        words.insert(words.end(), inputs.begin(), inputs.end());
        words.insert(words.end(), {"-o", out, "--panel", "64", "--json"});
        return run_here(words);
    };
    EXPECT_EQ(run({(dir / "none.obj").string()}).exit_code, 1);
    EXPECT_EQ(run({bad}).exit_code, 1);
    const test::Ran twice = run({a, (dir / "sub/a.obj").string(), off});
    EXPECT_EQ(twice.exit_code, 0) << twice.err;  // a, and then by their whole names
    EXPECT_TRUE(std::filesystem::exists(dir / "out/a.html"));
    EXPECT_TRUE(std::filesystem::exists(dir / "out/a.obj.html"));
    EXPECT_TRUE(std::filesystem::exists(dir / "out/a.off.html"));
    const test::Ran thrice = run({a, a, a, off});
    EXPECT_EQ(thrice.exit_code, 1);  // the third alone
    EXPECT_NE(thrice.err.find(a + ": an earlier input has the sheets of this name"),
              std::string::npos)
        << thrice.err;
    EXPECT_EQ(thrice.json()["summary"], (json{{"files", 4}, {"ok", 3}, {"failed", 1}}));
    const test::Ran mixed = run({bad, a});
    EXPECT_EQ(mixed.exit_code, 1);
    EXPECT_EQ(mixed.json()["files"][0]["status"], "failed");
    EXPECT_EQ(mixed.json()["files"][1]["status"], "ok");
    EXPECT_EQ(run_here({"validate", a, "-o", out, "--camera", "1,95"}).exit_code, 2);
    EXPECT_EQ(run_here({"validate", a, "-o", out, "--panel", "63"}).exit_code, 2);
}

}  // namespace
