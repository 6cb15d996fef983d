// What `prepare` says it did, in JSON and in words, against what it was given and what it wrote.
#include <gtest/gtest.h>

#include "command_runner.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

// A square of two triangles with a UV seam on the diagonal, a line of two segments and two points.
const std::string mixed =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nv 6 5 5\nv 7 5 5\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.5\n"
    "f 1/1 2/2 3/3\nf 1/5 3/3 4/4\nl 5 6 7\np 5\np 6\n";

std::string single_spaced(const std::string& text) {
    std::string out;
    for (const char c : text)
        if (c != ' ' || out.empty() || out.back() != ' ') out += c;
    return out;
}

TEST(PrepareReport, CountsAreThoseBeforeAndAfter) {
    const TempDir dir;
    write_text(dir / "m.obj", mixed);
    const std::string in = (dir / "m.obj").string(), out = (dir / "m.gltf").string();
    const test::Ran ran = run_here({"prepare", in, "-o", out, "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json file = ran.json()["files"][0];
    EXPECT_EQ(file["input"], in);
    EXPECT_EQ(file["output"], out);
    EXPECT_EQ(file["before"], (json{{"meshes", 1},
                                    {"vertices", 7},
                                    {"faces", 2},
                                    {"triangles", 2},
                                    {"polylines", 1},
                                    {"points", 2},
                                    {"materials", 0},
                                    {"textures", 0}}));
    // Corner 1 is split by its two UVs.
    EXPECT_EQ(file["after"], (json{{"meshes", 1},
                                   {"vertices", 8},
                                   {"triangles", 2},
                                   {"line_segments", 2},
                                   {"points", 2},
                                   {"materials", 0},
                                   {"textures", 0}}));
    EXPECT_EQ(file["splits"], (json{{"hard_edge", 0},
                                    {"smoothing_group", 0},
                                    {"authored_normal", 0},
                                    {"uv_seam", 1},
                                    {"mirrored_uv", 0},
                                    {"tangent", 0},
                                    {"color", 0},
                                    {"material", 0}}));
    EXPECT_FALSE(file.contains("gltf_before"));
    EXPECT_EQ(file["gltf_after"]["meshes"], 1);
    EXPECT_EQ(ran.json()["summary"]["files"], 1);
    EXPECT_EQ(ran.json()["summary"]["ok"], 1);
    EXPECT_EQ(ran.json()["summary"]["failed"], 0);
    EXPECT_EQ(ran.json()["summary"]["with_warnings"], 0);
    const std::string words = single_spaced(run_here({"prepare", in, "-o", out}).out);
    EXPECT_NE(words.find("\n vertices 7 8\n"), std::string::npos) << words;
    EXPECT_NE(words.find("\n faces 2 –\n"), std::string::npos);
    EXPECT_NE(words.find("\n line segments – 2\n"), std::string::npos);
    EXPECT_EQ(words.find("materials"), std::string::npos);  // none before and none after
    EXPECT_NE(words.find("\n vertices split at: UV seam 1\n"), std::string::npos) << words;
    // From glTF on, both documents are counted.
    const std::string again = (dir / "again.glb").string();
    const test::Ran second = run_here({"prepare", out, "-o", again, "--json"});
    EXPECT_EQ(second.json()["files"][0]["gltf_before"]["nodes"], 1);
    EXPECT_EQ(second.json()["files"][0]["gltf_after"]["nodes"], 1);
    const std::string both = run_here({"prepare", out, "-o", again}).out;
    EXPECT_NE(both.find("  primitives"), std::string::npos) << both;
}

TEST(PrepareReport, RepairsAreToldStepByStep) {
    const TempDir dir;
    // The same triangle twice, and a vertex that nothing uses.
    write_text(dir / "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 1 2 3\nf 1 2 3\n");
    const std::string in = (dir / "m.obj").string(), out = (dir / "m.ply").string();
    const test::Ran ran = run_here(
        {"prepare", in, "-o", out, "--repair", "duplicates,isolated,degenerate", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json repairs = ran.json()["files"][0]["repairs"];
    ASSERT_EQ(repairs.size(), 3u);
    EXPECT_EQ(repairs[0]["step"], "degenerate");
    EXPECT_EQ(repairs[0]["changed"], 0);
    EXPECT_EQ(repairs[1]["step"], "duplicates");
    EXPECT_EQ(repairs[1]["changed"], 1);
    EXPECT_EQ(repairs[1]["left"], 0);
    EXPECT_EQ(repairs[1]["place_kind"], "face");
    EXPECT_EQ(repairs[1]["places"], json::array({1}));
    EXPECT_EQ(repairs[2]["step"], "isolated");
    EXPECT_EQ(repairs[2]["place_kind"], "vertex");
    EXPECT_EQ(repairs[2]["places"], json::array({3}));
    const std::string words =
        run_here({"prepare", in, "-o", out, "--repair", "duplicates,isolated,degenerate"}).out;
    EXPECT_NE(words.find("repair  degenerate  0 changed    nothing to do\n"), std::string::npos)
        << words;
    EXPECT_NE(words.find("repair  duplicates  1 changed    "), std::string::npos);
    EXPECT_NE(words.find("(face 1)\n"), std::string::npos);
    EXPECT_NE(words.find("(vertex 3)\n"), std::string::npos);
}

TEST(PrepareReport, FilesThatFailAndFilesWithWarningsAreCountedApart) {
    const TempDir dir;
    write_text(dir / "good.obj", test::cube_obj());
    write_text(dir / "bad.obj", "v 0 0 0\nf 1 2 3\n");
    // A normal of no length is replaced, which is a warning.
    write_text(dir / "odd.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 0\nf 1//1 2//1 3//2\n");
    // A corner without a normal gets one, which is merely told.
    write_text(dir / "some.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\n"
               "f 1//1 2//1 3//1\nf 2 4 3\n");
    const std::vector<std::string> words = {"prepare",
                                            (dir / "good.obj").string(),
                                            (dir / "bad.obj").string(),
                                            (dir / "odd.obj").string(),
                                            (dir / "some.obj").string(),
                                            "-o",
                                            (dir / "out").string()};
    const test::Ran ran = run_here(words);
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.out.find("4 files: 3 ok, 1 failed, 1 with warnings, "), std::string::npos)
        << ran.out;
    EXPECT_NE(ran.out.find("  8 → 24 vertices, 12 triangles, "), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("failed  " + (dir / "bad.obj").string() + "\n"), std::string::npos);
    const std::size_t odd = ran.out.find("odd.glb");
    EXPECT_NE(ran.out.substr(odd, ran.out.find('\n', odd) - odd).find(", 1 warning"),
              std::string::npos)
        << ran.out;
    std::vector<std::string> as_json = words;
    as_json.push_back("--json");
    const json document = run_here(as_json).json();
    EXPECT_EQ(document["files"][3]["findings"][0]["kind"], "missing-normal");
    EXPECT_EQ(document["files"][3]["findings"][0]["severity"], "info");
    EXPECT_EQ(document["summary"]["ok"], 3);
    EXPECT_EQ(document["summary"]["failed"], 1);
    EXPECT_EQ(document["summary"]["with_warnings"], 1);
    EXPECT_EQ(document["files"][1]["status"], "failed");
    EXPECT_NE(document["files"][1]["error"]["place"].get<std::string>().find("bad.obj:2"),
              std::string::npos);
    const json finding = document["files"][2]["findings"][0];
    EXPECT_EQ(finding["kind"], "zero-normal");
    EXPECT_EQ(finding["severity"], "warning");
    EXPECT_EQ(finding["count"], 1);
    EXPECT_EQ(finding["place_kind"], "corner");
    EXPECT_EQ(finding["places"], json::array({2}));
    EXPECT_EQ(finding["mesh_name"], "odd");
}

// The words of --repair, --hard-angle and --hard-borders, each by what only it does.
TEST(PrepareOptions, WordsDoWhatTheySay) {
    const TempDir dir;
    const auto run = [&](const std::string& text, std::vector<std::string> options) {
        write_text(dir / "in.obj", text);
        std::vector<std::string> words = {"prepare", (dir / "in.obj").string(), "-o",
                                          (dir / "out.ply").string(), "--json"};
        words.insert(words.end(), options.begin(), options.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.json()["files"][0];
    };
    const auto steps = [&](const std::string& list) {
        std::string names;
        const json file = run(test::cube_obj(), {"--repair", list});
        for (const json& r : file["repairs"])
            names += (names.empty() ? "" : " ") + r["step"].get<std::string>();
        return names;
    };
    EXPECT_EQ(steps("all"),
              "degenerate duplicates edges vertices orientation holes outward isolated");
    for (const char* name : {"weld", "degenerate", "duplicates", "edges", "vertices", "orientation",
                             "holes", "outward", "isolated"})
        EXPECT_EQ(steps(name), name);
    EXPECT_EQ(steps("weld=0.5,holes=3"), "weld holes");
    // A square hole: filled with four edges, not with three; by default up to a hundred.
    std::string open = test::cube_obj();
    open.resize(open.rfind("f "));
    const auto filled = [&](const char* list) {
        return run(open, {"--repair", list})["repairs"][0]["changed"];
    };
    EXPECT_EQ(filled("holes=3"), 0);
    EXPECT_EQ(filled("holes=4"), 1);
    EXPECT_EQ(filled("holes"), 1);
    // Vertices a quarter apart.
    const std::string near = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.25 0 0\nv 0 2 0\nf 1 2 3\nf 4 3 5\n";
    EXPECT_EQ(run(near, {"--repair", "weld=0.3"})["repairs"][0]["changed"], 1);
    EXPECT_EQ(run(near, {"--repair", "weld=0.2"})["repairs"][0]["changed"], 0);
    EXPECT_EQ(run(near, {"--repair", "weld"})["repairs"][0]["changed"], 0);
    // Two faces that turn by 45° over their edge.
    const std::string wedge = "v 0 0 0\nv 0 1 0\nv -1 0 0\nv 1 0 -1\nf 1 2 3\nf 2 1 4\n";
    const auto vertices = [&](const std::string& text, const std::vector<std::string>& options) {
        return run(text, options)["after"]["vertices"];
    };
    EXPECT_EQ(vertices(wedge, {}), 4);  // 60
    EXPECT_EQ(vertices(wedge, {"--hard-angle", "44"}), 6);
    EXPECT_EQ(vertices(wedge, {"--hard-angle", "auto"}), 4);
    EXPECT_EQ(vertices(test::cube_obj(), {"--hard-angle", "auto"}), 24);
    EXPECT_EQ(vertices(test::cube_obj(), {"--hard-angle", "off"}), 8);
    // A UV seam and a border of materials, over the same edge.
    const std::string seam =
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 5 5\nvt 6 5\nvt 6 6\nusemtl a\nf 1/1 2/2 3/3\n";
    const std::string vs = "v 0 0 0\nv 0 1 0\nv -1 0 0\nv 1 0 -1\n";
    const auto reasons = [&](const std::string& text, const std::vector<std::string>& options) {
        const json splits = run(text, options)["splits"];
        return std::to_string(splits["hard_edge"].get<int>()) + " " +
               std::to_string(splits["uv_seam"].get<int>()) + " " +
               std::to_string(splits["material"].get<int>());
    };
    EXPECT_EQ(reasons(vs + seam + "f 2/4 1/5 4/6\n", {}), "0 2 0");
    EXPECT_EQ(reasons(vs + seam + "f 2/4 1/5 4/6\n", {"--hard-borders", "uv"}), "2 2 0");
    EXPECT_EQ(reasons(vs + seam + "f 2/4 1/5 4/6\n", {"--hard-borders", "material"}), "0 2 0");
    write_text(dir / "m.mtl", "newmtl a\nnewmtl b\n");
    const std::string materials = "mtllib m.mtl\n" + vs + "usemtl a\nf 1 2 3\nusemtl b\nf 2 1 4\n";
    EXPECT_EQ(reasons(materials, {"--hard-borders", "uv"}), "0 0 2");
    EXPECT_EQ(reasons(materials, {"--hard-borders", "material"}), "2 0 2");
    EXPECT_EQ(reasons(materials, {"--hard-borders", "uv,material"}), "2 0 2");
    // Smoothing groups part the faces, unless they are told not to.
    const std::string groups = vs + "s 1\nf 1 2 3\ns 2\nf 2 1 4\n";
    EXPECT_EQ(vertices(groups, {}), 6);
    EXPECT_EQ(vertices(groups, {"--smoothing-groups", "off"}), 4);
    EXPECT_EQ(vertices(groups, {"--smoothing-groups", "on"}), 6);
}

TEST(PrepareOptions, NumbersAreReadToTheirEndOrRefused) {
    const TempDir dir;
    write_text(dir / "c.obj", test::cube_obj());
    for (const std::vector<std::string>& more :
         std::vector<std::vector<std::string>>{{"--hard-angle", "30x"},
                                               {"--hard-angle", "-1"},
                                               {"--hard-angle", "180.5"},
                                               {"--hard-angle", "1,2"},
                                               {"--hard-angle", "inf"},
                                               {"--hard-angle", ""},
                                               {"--repair", "holes=2"},
                                               {"--repair", "holes=1001"},
                                               {"--repair", "holes=3.5"},
                                               {"--repair", "degenerate,"},
                                               {"--repair", "weld=-1"},
                                               {"--repair", "weld=1,2"},
                                               {"--repair", "degenerate=1"},
                                               {"--repair", ""},
                                               {"--repair", "everything"},
                                               {"--hard-borders", "uv,x"},
                                               {"--tangent-angle", "180.1"},
                                               {"--normals", "fix"},
                                               {"--weld", "close"},
                                               {"--weight", "Area"},
                                               {"--precision", "double"},
                                               {"--tangents", "always"},
                                               {"--smoothing-groups", "true"},
                                               {"--authored-tangents", "none"}}) {
        std::vector<std::string> words = {"prepare", (dir / "c.obj").string(), "-o",
                                          (dir / "x.glb").string()};
        words.insert(words.end(), more.begin(), more.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 2) << more[0] << " " << more[1];
        EXPECT_NE(ran.err.find(more[0]), std::string::npos) << ran.err;
    }
    for (const char* angle : {"0", "180", "1e1"})
        EXPECT_EQ(run_here({"prepare", (dir / "c.obj").string(), "-o", (dir / "x.glb").string(),
                            "--hard-angle", angle})
                      .exit_code,
                  0)
            << angle;
    for (const char* list : {"holes=3", "holes=1000", "weld=0"})
        EXPECT_EQ(run_here({"prepare", (dir / "c.obj").string(), "-o", (dir / "x.glb").string(),
                            "--repair", list})
                      .exit_code,
                  0)
            << list;
}

}  // namespace
