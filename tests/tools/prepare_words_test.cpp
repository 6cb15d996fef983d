// The words of the preparation's options against the library's values that they name, and the
// defaults against what the pages say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "command_runner.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "shared_data.h"

namespace {

using prep::Authored;
using prep::PrepareOptions;
using test::run_here;
using test::TempDir;
using Level = prep::Request::Level;

// A rough surface of 6 × 6 squares of unequal sizes, as triangles with vertices of their own along
// one line; normals and tangents of which some are bad, UVs of which some have no gradient.
std::string rough_surface() {
    test::GltfText::Primitive p;
    p.name = "rough";
    const auto vertex = [&](int x, int y) {
        const double u = x + 0.17 * std::sin(2.0 * x + y), v = y + 0.21 * std::cos(x + 3.0 * y);
        p.positions.insert(p.positions.end(),
                           {float(u), float(v), float(0.6 * std::sin(3 * u * v))});
        glm::dvec3 n = glm::normalize(glm::dvec3(0.3 * std::sin(x), 0.3 * std::cos(y), 1.0));
        if (x == 2) n *= -1.0;           // against its face
        if (x == 3 && y == 3) n *= 0.0;  // none at all
        p.normals.insert(p.normals.end(), {float(n.x), float(n.y), float(n.z)});
        glm::dvec3 t = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), n + glm::dvec3(0, 0, 1e-9)));
        if (y == 4) t = -t;  // against the UVs
        p.tangents.insert(p.tangents.end(),
                          {float(t.x), float(t.y), float(t.z), x == 5 ? -1.0f : 1.0f});
        const bool flat = x >= 4 && y <= 1;  // no gradient
        p.uvs.insert(p.uvs.end(), {flat ? 0.5f : float(u) / 6, flat ? 0.5f : 1 - float(v) / 6});
    };
    // Columns 0 to 3 and 3 to 6: the third stands there twice.
    for (const int first : {0, 3}) {
        const auto base = std::uint32_t(p.positions.size() / 3);
        for (int x = first; x <= first + 3; ++x)
            for (int y = 0; y <= 6; ++y) vertex(x, y);
        for (std::uint32_t x = 0; x < 3; ++x)
            for (std::uint32_t y = 0; y < 6; ++y) {
                const std::uint32_t a = base + 7 * x + y, b = a + 7;
                for (const std::uint32_t i : {a, b, a + 1, b, b + 1, a + 1}) p.indices.push_back(i);
            }
    }
    p.more = "\"material\":0";
    test::GltfText text;
    text.add(p);
    return text.text(R"("materials":[{"normalTexture":{"index":0}}],"textures":[{"source":0}],)"
                     R"("images":[{"uri":"n.png"}])");
}

class PrepareWords : public testing::Test {
  protected:
    void SetUp() override {
        test::write_text(dir_ / "rough.gltf", rough_surface());
        std::filesystem::copy_file(test::source_dir() / "samples/room/tile_normal.png",
                                   dir_ / "n.png");
    }
    std::string by_words(std::vector<std::string> options) const {
        std::vector<std::string> words = {"prepare", (dir_ / "rough.gltf").string(), "-o",
                                          (dir_ / "words.glb").string(), "--quiet"};
        words.insert(words.end(), options.begin(), options.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return test::file_text(dir_ / "words.glb");
    }
    std::string by_values(const PrepareOptions& options) const {
        auto scene = prep::load_scene(dir_ / "rough.gltf");
        EXPECT_TRUE(scene) << to_string(scene.error());
        const auto prepared = prep::prepare(std::move(*scene), options);
        EXPECT_TRUE(prepared) << to_string(prepared.error());
        EXPECT_TRUE(prep::save_scene(*prepared, dir_ / "values.glb"));
        return test::file_text(dir_ / "values.glb");
    }

    TempDir dir_;
};

TEST_F(PrepareWords, NameThePreparationsChoices) {
    struct Word {
        const char *option, *word;
        std::function<void(PrepareOptions&)> value;
        const char* like = nullptr;  // another word that says the same of this mesh
    };
    const auto weight = [](prep::NormalWeight w) {
        return [=](PrepareOptions& o) { o.normal.weight = w; };
    };
    const auto normals = [](Authored a) { return [=](PrepareOptions& o) { o.normals = a; }; };
    const auto tangents = [](Authored a) { return [=](PrepareOptions& o) { o.tangents = a; }; };
    const auto weld = [](prep::WeldMode w) { return [=](PrepareOptions& o) { o.weld = w; }; };
    const auto mode = [](Level level, prep::TangentMode m) {
        return [=](PrepareOptions& o) {
            o.request.tangents = level;
            o.tangent.mode = m;
        };
    };
    using prep::TangentMode;
    const std::vector<Word> words = {
        {"--normals", "keep", normals(Authored::keep)},
        {"--normals", "replace", normals(Authored::replace)},
        {"--normals", "repair", normals(Authored::repair)},
        {"--weight", "area", weight(prep::NormalWeight::area)},
        {"--weight", "uniform", weight(prep::NormalWeight::uniform)},
        {"--weight", "angle", weight(prep::NormalWeight::angle)},
        {"--weight", "area-angle", weight(prep::NormalWeight::area_angle)},
        {"--weight", "edge-length", weight(prep::NormalWeight::edge_length)},
        {"--authored-tangents", "keep", tangents(Authored::keep)},
        {"--authored-tangents", "replace", tangents(Authored::replace)},
        {"--authored-tangents", "repair", tangents(Authored::repair)},
        {"--tangents", "auto", mode(Level::as_called_for, TangentMode::mikktspace)},
        // The material has a normal map: it calls for them.
        {"--tangents", "mikktspace", mode(Level::always, TangentMode::mikktspace), "auto"},
        {"--tangents", "mikktspace-exact", mode(Level::always, TangentMode::mikktspace_exact)},
        {"--tangents", "none", mode(Level::never, TangentMode::mikktspace)},
        {"--weld", "auto", weld(prep::WeldMode::automatic)},
        {"--weld", "exact", weld(prep::WeldMode::exact), "auto"},  // glTF repeats vertices at seams
        {"--weld", "none", weld(prep::WeldMode::none)}};
    std::map<std::string, std::map<std::string, std::string>> results;  // by option and word
    for (const Word& w : words) {
        SCOPED_TRACE(std::string(w.option) + " " + w.word);
        // Everything computed, so that every option has something to say; then the option's own.
        PrepareOptions options;
        std::vector<std::string> line = {w.option, w.word};
        const std::string option = w.option;
        if (option != "--normals") {
            options.normals = Authored::replace;
            line.insert(line.end(), {"--normals", "replace"});
        }
        if (option == "--tangents") {
            options.tangents = Authored::replace;
            line.insert(line.end(), {"--authored-tangents", "replace"});
        }
        if (option == "--authored-tangents") {  // whose normals stay good
            options.normals = Authored::keep;
            line.resize(2);
        }
        w.value(options);
        const std::string bytes = by_words(line);
        EXPECT_TRUE(bytes == by_values(options));
        auto& others = results[option];
        for (const auto& [word, result] : others)
            EXPECT_EQ(result == bytes, w.like && word == w.like) << word;
        others[w.word] = bytes;
    }
    // Defaults: the first word of each.
    const std::string nothing = by_words({});
    for (const auto& [option, word] :
         std::vector<std::pair<const char*, const char*>>{{"--normals", "keep"},
                                                          {"--weight", "area"},
                                                          {"--precision", "accurate"},
                                                          {"--authored-tangents", "keep"},
                                                          {"--tangents", "auto"},
                                                          {"--tangent-angle", "180"},
                                                          {"--smoothing-groups", "on"},
                                                          {"--hard-angle", "60"},
                                                          {"--weld", "auto"}})
        EXPECT_TRUE(by_words({option, word}) == nothing) << option;
}

// `exact` decides every fan by exact arithmetic, the others none of an everyday mesh; `fast` is the
// only one whose bits may be others (docs/stability.md).
TEST_F(PrepareWords, PrecisionIsThatOfTheArithmetic) {
    const auto fans = [&](const char* word) {
        const test::Ran ran =
            run_here({"prepare", (dir_ / "rough.gltf").string(), "-o", (dir_ / "a.glb").string(),
                      "--normals", "replace", "--precision", word, "--json"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        const nlohmann::json stages = ran.json()["files"][0]["stages"];
        for (const auto& stage : stages)
            if (stage["stage"] == "normals") return stage["decided_exactly"].get<int>();
        return -1;
    };
    EXPECT_EQ(fans("fast"), 0);
    EXPECT_EQ(fans("accurate"), 0);
    EXPECT_GE(fans("exact"), 49);  // a fan at least at each of 7 × 7 points
    const auto by = [&](const char* word) {
        return by_words({"--normals", "replace", "--precision", word});
    };
    EXPECT_TRUE(by("exact") == by("accurate"));
    EXPECT_FALSE(by("fast") == by("accurate"));
}

// An option about normals that were not made is in no output: the file's own were kept, or its
// smoothing groups decided. Three faces of a cube's corner, which turn by 90°.
TEST_F(PrepareWords, ThatChangeNothingAreTold) {
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    const std::string vn = "vn 0.6 0 0.8\n";
    const std::string bare = points + "f 1 2 3\nf 1 3 4\nf 1 4 2\n";
    const std::string own = points + vn + "f 1//1 2//1 3//1\nf 1//1 3//1 4//1\nf 1//1 4//1 2//1\n";
    const std::string grouped = points + "s 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\n";
    const std::string both =
        points + vn + "s 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\nf 1//1 4//1 2//1\n";
    // Another mesh that the angle decides.
    const std::string mixed = own + "o other\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 5 6 7\n";
    using Words = std::vector<std::string>;
    const auto remarks = [&](const std::string& obj, const Words& options) {
        test::write_text(dir_ / "a.obj", obj);
        Words words = {"prepare", (dir_ / "a.obj").string(), "-o", (dir_ / "a.glb").string(),
                       "--json"};
        words.insert(words.end(), options.begin(), options.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        const nlohmann::json file = ran.json()["files"][0];
        EXPECT_TRUE(file["warnings"].empty()) << file["warnings"];
        return file.contains("remarks") ? file["remarks"].get<Words>() : Words();
    };
    const Words kept = {
        "--hard-angle, --weight changed nothing, as the file's own normals are kept: --normals "
        "replace computes new ones"};
    const Words by_groups = {
        "--hard-angle changed nothing, as the file's smoothing groups decide: --smoothing-groups "
        "off leaves it to the angle"};
    const Words angle = {"--hard-angle", "40"}, two = {"--hard-angle", "40", "--weight", "angle"};
    const auto with = [](Words words, const Words& more) {
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    EXPECT_EQ(remarks(own, two), kept);
    EXPECT_EQ(remarks(grouped, two), by_groups);
    EXPECT_EQ(remarks(both, two), kept);
    EXPECT_EQ(remarks(both, with(two, {"--normals", "replace"})), by_groups);
    EXPECT_EQ(remarks(own, {"--tangents", "mikktspace"}),
              Words{"--tangents made none, as no mesh has the UVs for them"});
    // What did change something, and what was not asked for.
    EXPECT_EQ(remarks(own, {"--tangents", "auto"}), Words());
    EXPECT_EQ(remarks(bare, two), Words());
    EXPECT_EQ(remarks(own, {}), Words());
    EXPECT_EQ(remarks(grouped, {"--weight", "angle"}), Words());
    EXPECT_EQ(remarks(own, with(two, {"--normals", "replace"})), Words());
    EXPECT_EQ(remarks(grouped, with(angle, {"--smoothing-groups", "off"})), Words());
    EXPECT_EQ(remarks(mixed, angle), Words());
    EXPECT_EQ(remarks(both, with(angle, {"--subdivide", "catmark:1"})), Words());
    const std::string loose = points + vn + "vn 0 0 1\nl 1 2\nf 1//1 2//1 3//1\n";
    EXPECT_EQ(remarks(loose, with(angle, {"--normals", "replace", "--for", "shading=flat"})),
              Words());
}

}  // namespace
