// The command's `validate`: what its page and its figures say.
#include <gtest/gtest.h>

#include <cctype>

#include "command_runner.h"

namespace {

using test::run_here;
using test::TempDir;

// In the bytes of pictures anything may stand.
std::string without_pictures(std::string page) {
    const std::string mark = "base64,";
    for (std::size_t at = page.find(mark); at != std::string::npos; at = page.find(mark, at + 1))
        page.erase(at, page.find('"', at) - at);
    return page;
}

TEST(Validate, ThePageHoldsNoTimes) {
    const TempDir dir;
    test::write_text(dir / "cube.obj", test::textured_cube_obj());
    std::string pages[2];
    for (std::string& page : pages) {
        const std::string out = (dir / (&page == pages ? "a" : "b")).string();
        const test::Ran ran = run_here({"validate", (dir / "cube.obj").string(), "-o", out,
                                        "--panel", "64", "--threads", &page == pages ? "1" : "2"});
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        page = test::file_text(std::filesystem::path(out) / "cube.html");
    }
    ASSERT_FALSE(pages[0].empty());
    EXPECT_TRUE(pages[0] == pages[1]);
    const std::string text = without_pictures(pages[0]);
    for (std::size_t at = text.find(' '); at != std::string::npos; at = text.find(' ', at + 1)) {
        if (at == 0 || !std::isdigit(static_cast<unsigned char>(text[at - 1]))) continue;
        for (const std::string unit : {"ms", "µs", "s"}) {
            const std::size_t end = at + 1 + unit.size();
            EXPECT_FALSE(text.compare(at + 1, unit.size(), unit) == 0 && end < text.size() &&
                         !std::isalpha(static_cast<unsigned char>(text[end])))
                << text.substr(at - 1, 12);
        }
    }
    EXPECT_NE(text.find("Stages"), std::string::npos);
}

// A mesh whose UVs are of set 1 alone: nothing lies on a checker, and no UV is mirrored.
TEST(Validate, ShowsMeshesWithoutTheFirstSetOfUvs) {
    const test::TempDir dir;
    test::GltfText::Primitive p;
    p.name = "second";
    p.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    p.uvs = {0, 0, 1, 0, 0, 1};
    p.indices = {0, 1, 2};
    test::GltfText text;
    text.add(p);
    std::string gltf = text.text("");
    const std::size_t set = gltf.find("TEXCOORD_0");
    ASSERT_NE(set, std::string::npos);
    gltf.replace(set, 10, "TEXCOORD_1");
    test::write_text(dir / "second.gltf", gltf);
    const test::Ran ran = test::run_here({"validate", (dir / "second.gltf").string(), "-o",
                                          (dir / "out").string(), "--panel", "64"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    std::string page;
    for (const auto& entry : std::filesystem::directory_iterator(dir / "out"))
        if (entry.path().extension() == ".html") page = test::file_text(entry.path());
    EXPECT_NE(page.find("No UVs in the file."), std::string::npos);
}

TEST(Validate, CountsTheMaterialsOfTheMesh) {
    const TempDir dir;
    test::write_text(dir / "m.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\nnewmtl c\nKd 0 0 1\n");
    const auto materials = [&](const std::string& faces) -> std::string {
        test::write_text(dir / "m.obj",
                         "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n" + faces);
        const test::Ran ran = run_here(
            {"validate", (dir / "m.obj").string(), "-o", (dir / "out").string(), "--panel", "64"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        const std::string page = test::file_text(dir / "out/m.html");
        const std::string text = without_pictures(page), label = "<dt>materials</dt>";
        const std::size_t begin = text.find(label);
        if (begin == std::string::npos) return "none";
        const std::size_t first = text.find_first_of("0123456789", begin + label.size());
        return text.substr(first, text.find_first_not_of("0123456789", first) - first);
    };
    EXPECT_EQ(materials("usemtl a\nf 1 2 3 4\n"), "1");
    EXPECT_EQ(materials("usemtl a\nf 1 2 3\nusemtl c\nf 1 3 4\n"), "2");
}

// The second mesh has a face twice, the first has no UVs, and neither has a map.
TEST(Validate, TellsWhatIsOfTheMeshesShownAndOfTheFile) {
    const TempDir dir;
    test::GltfText gltf;
    const std::vector<float> p = {0, 0, 0, 1, 0, 0, 0, 1, 0}, n = {0, 0, 1, 0, 0, 1, 0, 0, 1};
    gltf.add({"plain", p, n, {}, {}, {0, 1, 2}, "", ""});
    gltf.add({"twice", p, n, {0, 0, 1, 0, 0, 1}, {}, {0, 1, 2, 0, 1, 2}, "", ""});
    test::write_text(dir / "m.gltf", gltf.text());
    const auto file = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{
            "validate", (dir / "m.gltf").string(), "-o", (dir / "out").string(), "--panel", "64",
            "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        return ran.json()["files"][0];
    };
    const auto all = file({}), first = file({"--mesh", "0"}), second = file({"--mesh", "1"});
    EXPECT_EQ(all["warnings"], nlohmann::json::array());
    EXPECT_FALSE(second["findings"].empty());
    for (const auto& finding : first["findings"]) EXPECT_EQ(finding["mesh"], 0) << finding.dump();
    for (const auto& finding : second["findings"]) EXPECT_EQ(finding["mesh"], 1) << finding.dump();
    EXPECT_EQ(all["findings"].size(), first["findings"].size() + second["findings"].size());
}

}  // namespace
