// `prepare --explain`: which stage ran, and for which reason, on inputs made for each reason.
#include <gtest/gtest.h>

#include <map>

#include "command_runner.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

struct Stage {
    bool run = false;
    std::string reason;
};

// The stages of one file by name; also their order, as one text.
struct Stages : std::map<std::string, Stage> {
    std::string order;
};

Stages stages_of(const json& file) {
    Stages stages;
    for (const json& s : file["stages"]) {
        const std::string name = s["stage"];
        stages[name] = {s["run"].get<bool>(), s["reason"].get<std::string>()};
        stages.order += (stages.order.empty() ? "" : ", ") + name;
    }
    return stages;
}

class Explain : public ::testing::Test {
  protected:
    Stages of(const std::string& name, const std::string& text,
              const std::vector<std::string>& options = {}) {
        write_text(dir_ / name, text);
        std::vector<std::string> words = {"prepare", (dir_ / name).string(), "-o",
                                          (dir_ / "out.glb").string(), "--json"};
        words.insert(words.end(), options.begin(), options.end());
        ran_ = run_here(words);
        EXPECT_EQ(ran_.exit_code, 0) << ran_.err;
        return ran_.exit_code == 0 ? stages_of(ran_.json()["files"][0]) : Stages();
    }
    static void expect_run(Stages stages, const std::string& stage, const std::string& reason) {
        ASSERT_EQ(stages.count(stage), 1u) << stage;
        EXPECT_TRUE(stages[stage].run) << stage << ": " << stages[stage].reason;
        EXPECT_EQ(stages[stage].reason, reason) << stage;
    }
    static void expect_skipped(Stages stages, const std::string& stage, const std::string& reason) {
        ASSERT_EQ(stages.count(stage), 1u) << stage;
        EXPECT_FALSE(stages[stage].run) << stage << ": " << stages[stage].reason;
        EXPECT_EQ(stages[stage].reason, reason) << stage;
    }
    static constexpr const char* geometry[] = {"topology", "face normals", "hard edges", "normals"};

    TempDir dir_;
    test::Ran ran_;
};

// Two triangles that share an edge.
const std::string two = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const std::string plain = two + "f 1 2 3\nf 1 3 4\n";

TEST_F(Explain, WeldingSaysWhatTheFileIsLike) {
    expect_skipped(of("plain.obj", plain), "weld",
                   "the file's faces share vertices, and nothing repeats them");
    const std::string mapped =
        two + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 9 9\nf 1/1 2/2 3/3\nf 1/1 3/5 4/4\n";
    expect_skipped(of("mapped.obj", mapped), "weld",
                   "the file indexes positions apart from attributes");
    expect_skipped(of("plain.obj", plain, {"--weld", "none"}), "weld", "switched off");
    const char* repeated = "vertices are repeated at seams: equal positions are one point";
    expect_run(of("plain.obj", plain, {"--weld", "exact"}), "weld", repeated);
    // UVs by vertex: the file repeats points where they differ.
    const std::string by_vertex =
        two + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
    expect_run(of("by_vertex.obj", by_vertex), "weld", repeated);
    const std::string soup = two + "v 0 0 0\nv 1 1 0\nf 1 2 3\nf 5 6 4\n";
    expect_run(of("soup.obj", soup), "weld",
               "every corner has a vertex of its own: those at one point are shared");
    expect_skipped(of("soup.obj", soup, {"--weld", "none"}), "weld", "switched off");
    test::GltfText gltf;
    gltf.add({"m", {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, {}, {}, {}, {0, 1, 2, 0, 2, 3}, "", ""});
    expect_run(of("shared.gltf", gltf.text()), "weld", repeated);
}

TEST_F(Explain, NormalsSayWhatCallsForThem) {
    const std::string mtl =
        "newmtl lit\nKd 1 0 0\nnewmtl mapped\nnorm n.png\nnewmtl bare\nKd 0 0 0\nillum 0\n";
    write_text(dir_ / "m.mtl", mtl);
    for (const char* stage : geometry) {
        expect_run(of("plain.obj", plain), stage,
                   "faces without a material are lit by the default one");
        expect_run(of("lit.obj", "mtllib m.mtl\nusemtl lit\n" + plain), stage,
                   "material 'lit' is lit");
        const std::string own = two + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n";
        expect_skipped(of("own.obj", own), stage, "the file's own normals are kept");
        expect_skipped(of("own.obj", own), "weld", "the file's own normals are kept");
        expect_run(of("own.obj", own, {"--normals", "replace"}), stage,
                   "faces without a material are lit by the default one");
        const std::string missing = two + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4\n";
        expect_run(of("missing.obj", missing), stage, "some authored normals are missing or bad");
        test::GltfText unlit;
        unlit.add({"m", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {}, {}, {}, {0, 1, 2}, "\"material\":0", ""});
        expect_skipped(
            of("unlit.gltf", unlit.text(R"("extensionsUsed":["KHR_materials_unlit"],"materials":[)"
                                        R"({"extensions":{"KHR_materials_unlit":{}}}])")),
            stage, "every material used is unlit");
        expect_skipped(of("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\np 1\n"), stage,
                       "no faces: points and lines carry no normals");
    }
    // Held against the faces first, whether they are replaced then or not.
    const std::string turned = two + "vn 0 0 1\nvn 0 0 -1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//2\n";
    const Stages stages = of("turned.obj", turned, {"--normals", "repair"});
    expect_run(stages, "face normals", "authored normals are held against them");
    expect_run(stages, "normals", "some authored normals are missing or bad");
}

// A triangle of a glTF file with what is given.
std::string triangle(const std::string& material, const std::vector<float>& normals,
                     const std::vector<float>& tangents, const std::vector<float>& uvs) {
    test::GltfText gltf;
    gltf.add({"m",
              {0, 0, 0, 1, 0, 0, 0, 1, 0},
              normals,
              uvs,
              tangents,
              {0, 1, 2},
              "\"material\":0",
              ""});
    return gltf.text(R"("textures":[{"source":0}],"images":[{"uri":"n.png"}],"materials":[)" +
                     material + "]");
}

TEST_F(Explain, TangentsSayWhatCallsForThemOrWhatIsInTheWay) {
    const std::string mapped = R"({"name":"rough","normalTexture":{"index":0}})";
    const std::string second = R"({"name":"rough","normalTexture":{"index":0,"texCoord":1}})";
    const std::string bare = R"({"name":"bare"})";
    const std::vector<float> n = {0, 0, 1, 0, 0, 1, 0, 0, 1}, uv = {0, 0, 1, 0, 0, 1};
    const std::vector<float> t = {1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1};
    const std::vector<float> zero = {1, 0, 0, -1, 0, 0, 0, 1, 1, 0, 0, -1};
    const char* map = "material 'rough' has a tangent-space normal map";
    expect_run(of("a.gltf", triangle(mapped, n, {}, uv)), "tangents", map);
    expect_skipped(of("a.gltf", triangle(mapped, n, {}, uv), {"--tangents", "none"}), "tangents",
                   "switched off by the request");
    expect_skipped(of("a.gltf", triangle(mapped, n, t, uv)), "tangents",
                   "the file's own tangents are kept");
    expect_run(of("a.gltf", triangle(mapped, n, t, uv), {"--authored-tangents", "replace"}),
               "tangents", map);
    expect_run(of("a.gltf", triangle(mapped, n, t, uv), {"--authored-tangents", "repair"}),
               "tangents", "authored tangents are held against them");
    expect_run(of("a.gltf", triangle(mapped, n, t, uv), {"--normals", "replace"}), "tangents",
               "the normals changed, so the file's own tangents no longer fit");
    expect_run(of("a.gltf", triangle(mapped, n, zero, uv)), "tangents",
               "some authored tangents are missing, unusable or of normals that were replaced");
    expect_skipped(of("a.gltf", triangle(second, n, {}, uv)), "tangents",
                   "material 'rough' has a tangent-space normal map, but UV set 1 is missing");
    expect_skipped(of("a.gltf", triangle(bare, n, {}, uv)), "tangents",
                   "no material in use has a tangent-space normal map");
    expect_run(of("a.gltf", triangle(bare, n, {}, uv), {"--tangents", "mikktspace"}), "tangents",
               "asked for by the request");
    expect_skipped(of("a.gltf", triangle(bare, n, {}, {}), {"--tangents", "mikktspace"}),
                   "tangents", "asked for by the request, but the mesh has no UVs");
    expect_skipped(of("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"), "tangents",
                   "no faces: points and lines carry no tangents");
}

TEST_F(Explain, StagesStandInTheirOrderAndRepairOnlyWhereAskedFor) {
    const Stages stages = of("plain.obj", plain);
    EXPECT_EQ(stages.order,
              "requirements, weld, topology, face normals, hard edges, normals, tangents, split");
    expect_run(stages, "requirements", "decides what the stages below are needed for");
    expect_run(stages, "split", "vertices carry one set of attributes each");
    const Stages mended = of("plain.obj", plain, {"--repair", "duplicates"});
    EXPECT_EQ(mended.order.substr(0, 22), "requirements, repair, ");
    expect_run(mended, "repair", "asked for");
}

TEST_F(Explain, SeveralMeshesAreCounted) {
    test::GltfText gltf;
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::vector<float> own = {0, 0, 1, 0, 0, 1, 0, 0, 1};
    gltf.add({"a", positions, own, {}, {}, {0, 1, 2}, "", ""});
    gltf.add({"b", positions, {}, {}, {}, {0, 1, 2}, "", ""});
    gltf.add({"c", positions, own, {}, {}, {0, 1, 2}, "", ""});
    expect_run(of("abc.gltf", gltf.text()), "normals",
               "1 of 3 meshes: faces without a material are lit by the default one; others: the "
               "file's own normals are kept");
}

// Bytes against sums by hand, memory against what the kernel says of the process.
TEST_F(Explain, MemoryOfEachStage) {
    write_text(dir_ / "ball.obj", test::sphere_obj(200, 100));
    const std::string in = (dir_ / "ball.obj").string(), out = (dir_ / "ball.glb").string();
    const test::Ran ran = test::run_command({"prepare", in, "-o", out, "--json", "--explain"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json file = ran.json()["files"][0];
    const std::uint64_t vertices = file["before"]["vertices"], faces = file["before"]["faces"];
    const std::uint64_t triangles = file["before"]["triangles"], corners = triangles + 2 * faces;
    const std::uint64_t surface = 12 * vertices + 4 * (faces + 1) + 4 * corners;
    std::uint64_t faults = 0, peak = file["memory"]["read"]["peak_bytes"];
    for (const json& stage : file["stages"]) {
        const std::string name = stage["stage"];
        if (!stage["run"]) {
            EXPECT_EQ(stage["page_faults"], 0) << name;
            EXPECT_FALSE(stage.contains("moved_bytes")) << name;
            continue;
        }
        faults += stage["page_faults"].get<std::uint64_t>();
        EXPECT_GE(stage["peak_bytes"], peak) << name;
        peak = stage["peak_bytes"];
        const std::uint64_t moved = stage.value("moved_bytes", std::uint64_t(0));
        // Three doubles and a byte a face.
        if (name == "face normals") {
            EXPECT_EQ(moved, surface + 25 * faces);
        }
        // A double-checked lower bound: what is read of the surface, what is written of vertices.
        if (name == "split") {
            EXPECT_GT(moved, surface + 24 * vertices + 12 * triangles);
            EXPECT_LT(moved, 4 * (surface + 24 * vertices + 12 * triangles));
        }
        EXPECT_EQ(moved > 0, name != "requirements") << name;
    }
    const json prepare = file["memory"]["prepare"];
    EXPECT_LE(faults, prepare["page_faults"]);
    EXPECT_LE(peak, prepare["peak_bytes"]);
    EXPECT_LE(prepare["peak_bytes"], file["memory"]["write"]["peak_bytes"]);
    // The process holds its input and its output at once, in bytes and not in pages or kB.
    EXPECT_GT(peak, surface);
    EXPECT_LT(peak, std::uint64_t(1) << 30);
    const std::string words = test::run_command({"prepare", in, "-o", out, "--explain"}).out;
    EXPECT_NE(words.find(" moved "), std::string::npos) << words;
    EXPECT_NE(words.find(" page fault"), std::string::npos) << words;
    EXPECT_NE(words.find(" at most "), std::string::npos) << words;
}

// In words: one line a stage, with what exact arithmetic decided beside its reason.
TEST_F(Explain, WordsAreThoseOfTheReport) {
    write_text(dir_ / "cube.obj", test::cube_obj());
    const std::string cube = (dir_ / "cube.obj").string(), out = (dir_ / "c.glb").string();
    const std::string words =
        run_here({"prepare", cube, "-o", out, "--explain", "--hard-angle", "90"}).out;
    const auto line = [&words](const std::string& start) {
        const std::size_t at = words.find("\n    " + start);
        return at == std::string::npos ? ""
                                       : words.substr(at + 1, words.find('\n', at + 1) - at - 1);
    };
    const std::string weld = line("weld"), hard = line("hard edges");
    EXPECT_EQ(weld.find("run"), std::string::npos) << words;
    EXPECT_NE(weld.find("skipped"), std::string::npos);
    EXPECT_EQ(weld.find(" ms"), std::string::npos);  // what did not run took no time
    EXPECT_NE(weld.find("the file's faces share vertices, and nothing repeats them"),
              std::string::npos);
    EXPECT_NE(hard.find("  run "), std::string::npos) << hard;
    EXPECT_NE(hard.find(" ms  faces without a material are lit by the default one; 12 decided by "
                        "exact arithmetic"),
              std::string::npos)
        << hard;
    EXPECT_EQ(run_here({"prepare", cube, "-o", out}).out.find("stages"), std::string::npos);
    // Of several files each has its own.
    write_text(dir_ / "b.obj", plain);
    const std::string both = run_here({"prepare", cube, (dir_ / "b.obj").string(), "-o",
                                       (dir_ / "o").string(), "--explain"})
                                 .out;
    std::size_t count = 0;
    for (std::size_t at = both.find("      split "); at != std::string::npos;
         at = both.find("      split ", at + 1))
        ++count;
    EXPECT_EQ(count, 2u) << both;
}

}  // namespace
