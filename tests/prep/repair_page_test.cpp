// docs/repair.md's table of corpus meshes against the meshes: every figure of the page, and none
// that it should have and has not.
#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "mesh_files.h"
#include "prep/check.h"
#include "prep/load.h"
#include "prep/save.h"
#include "shared_data.h"

namespace {

// 97374 as 97,374.
std::string grouped(std::uint64_t number) {
    std::string text = std::to_string(number);
    for (int at = int(text.size()) - 3; at > 0; at -= 3) text.insert(std::size_t(at), ",");
    return text;
}

// The cells of the page's row about a mesh.
std::vector<std::string> row_of(const std::string& mesh) {
    std::istringstream page(test::file_text(test::source_dir() / "docs/repair.md"));
    for (std::string line; std::getline(page, line);) {
        if (!line.starts_with("| `" + mesh + "`")) continue;
        std::vector<std::string> cells;
        std::istringstream in(line.substr(1));
        for (std::string cell; std::getline(in, cell, '|');) cells.push_back(cell);
        return cells;
    }
    ADD_FAILURE() << "docs/repair.md has no row about " << mesh;
    return std::vector<std::string>(4);
}

std::uint64_t count(const std::vector<prep::Finding>& findings, const std::string& kind) {
    std::uint64_t sum = 0;
    for (const prep::Finding& f : findings)
        if (f.kind == kind) sum += f.count;
    return sum;
}

struct Mended {
    std::uint64_t faces = 0;
    prep::SceneCheck before, after;  // of the input and of the written file
    std::map<std::string, prep::RepairStep> steps;
};

Mended mended(const std::filesystem::path& file) {
    Mended result;
    auto scene = prep::load_scene(file);
    EXPECT_TRUE(scene.has_value());
    result.before = prep::check(*scene);
    for (const prep::MeshSummary& m : result.before.meshes) result.faces += m.faces;
    prep::PrepareOptions options;  // --repair weld,all
    prep::RepairOptions& all = options.repair;
    all.weld_tolerance = 0;
    all.degenerate_faces = all.duplicate_faces = all.non_manifold_edges = true;
    all.non_manifold_vertices = all.orientation = all.outward = all.isolated_vertices = true;
    all.hole_edges = 100;
    const auto prepared = prep::prepare(*std::move(scene), options);
    EXPECT_TRUE(prepared.has_value());
    EXPECT_EQ(prepared->scene.meshes.size(), 1u);
    for (const prep::RepairStep& s : prepared->repairs) result.steps[s.step] = s;
    const test::TempDir dir;
    EXPECT_TRUE(prep::save_scene(*prepared, dir / "out.glb").has_value());
    const auto written = prep::load_scene(dir / "out.glb");
    EXPECT_TRUE(written.has_value());
    result.after = prep::check(*written);
    return result;
}

class RepairPage : public testing::Test {
  protected:
    void SetUp() override {
        MESHPREP_REQUIRE_SHARED(shared);
        corpus_ = shared / "corpus";
    }
    void read(const std::string& mesh) {
        row_ = row_of(mesh);
        ASSERT_EQ(row_.size(), 4u) << mesh;
        got_ = mended(corpus_ / mesh);
    }
    // That a cell says a number of something: "3 holes".
    void says(std::size_t cell, std::uint64_t number, const std::string& of) {
        const std::string text = grouped(number) + " " + of;
        const std::size_t at = row_[cell].find(text);
        EXPECT_TRUE(at != std::string::npos && !std::isdigit(row_[cell][at - 1]))
            << "'" << text << "' is not in:" << row_[cell];
    }
    std::uint64_t before(const std::string& kind) { return count(got_.before.findings, kind); }
    std::uint64_t after(const std::string& kind) { return count(got_.after.findings, kind); }
    const prep::RepairStep& step(const std::string& name) { return got_.steps.at(name); }
    const prep::MeshSummary& summary() { return got_.after.meshes.at(0); }

    std::filesystem::path corpus_;
    std::vector<std::string> row_;
    Mended got_;
};

TEST_F(RepairPage, DegeneratedSd) {
    read("degenerated-sd.off");
    says(0, got_.faces, "triangles");
    says(1, before("repeated-vertex-face"), "faces that repeat a vertex");
    says(1, before("non-manifold-vertex"), "non-manifold vertex");
    says(1, before("repeated-position"), "repeated positions");
    says(1, before("hole"), "holes of " + grouped(before("open-edge")) + " edges together");
    says(1, got_.before.meshes[0].components, "components");
    says(2, step("weld").changed, "vertices welded");
    says(2, step("degenerate").changed, "faces removed");
    says(2, step("holes").changed, "holes filled, " + grouped(step("holes").left) + " left");
    says(2, step("isolated").changed, "isolated vertices removed");
    EXPECT_TRUE(summary().manifold);
    says(3, summary().holes, "loop of " + grouped(summary().open_edges) + " edges");
    says(3, summary().components, "components");
}

TEST_F(RepairPage, NonManifoldFaceGraph) {
    read("non_manifold_face_graph.off");
    says(0, got_.faces, "faces");
    says(1, before("repeated-position"), "repeated positions");
    says(1, before("hole"), "loops of " + grouped(before("open-edge")) + " open edges");
    says(2, step("weld").changed, "vertices welded");
    says(2, step("edges").changed, "edge split");
    says(2, step("vertices").changed, "vertex split");
    says(2, step("holes").changed, "loops closed");
    says(2, step("isolated").changed, "isolated vertices removed");
    EXPECT_TRUE(summary().closed && summary().manifold);
    says(3, summary().components, "components");
    says(3, after("folded-edge"), "folded edges");
    says(3, after("opposite-face"), "opposite faces");
}

TEST_F(RepairPage, B9) {
    read("b9_mesh.off");
    says(0, got_.faces, "triangles");
    says(1, before("inside-out-shell"), "shells inside out");
    says(1, before("hole"), "loops of " + grouped(before("open-edge")) + " open edges");
    says(2, step("holes").changed, "loops closed, " + grouped(step("holes").left) + " left");
    says(2, step("outward").changed, "components turned outward");
    EXPECT_TRUE(summary().manifold);
    says(3, summary().holes, "loops of " + grouped(summary().open_edges) + " edges");
    says(3, after("folded-edge"), "folded edges");
    says(3, after("opposite-face"), "opposite faces");
}

TEST_F(RepairPage, TowerHoles) {
    read("tower_holes.obj");
    says(0, got_.faces, "triangles");
    says(1, before("hole"), "loops of " + grouped(before("open-edge")) + " open edges");
    says(2, step("holes").changed, "holes filled, " + grouped(step("holes").left) + " left");
    says(3, summary().holes, "loop of " + grouped(summary().open_edges) + " edges");
}

TEST_F(RepairPage, Teapot) {
    read("teapot.obj");
    says(0, got_.faces, "triangles");
    says(1, before("repeated-position"), "repeated positions");
    says(1, before("non-manifold-vertex"), "non-manifold vertex");
    says(1, before("hole"), "loops of " + grouped(before("open-edge")) + " open edges");
    says(2, step("weld").changed, "vertices welded");
    says(2, step("vertices").changed, "vertex split");
    says(2, step("holes").changed, "holes filled");
    says(2, step("isolated").changed, "isolated vertices removed");
    EXPECT_TRUE(summary().closed && summary().manifold);
    says(3, summary().components, "components");
    EXPECT_NE(row_[3].find("genus " + std::to_string(summary().genus)), std::string::npos);
}

// The page's last figures: corners whose smoothed normal stands against the fill.
TEST_F(RepairPage, NormalsAgainstTheirFill) {
    std::string expected = "(`flipped-normal`: ";
    for (const char* mesh : {"degenerated-sd.off", "b9_mesh.off", "tower_holes.obj"}) {
        read(mesh);
        expected += std::to_string(after("flipped-normal")) +
                    (std::string(mesh) == "tower_holes.obj" ? " corners in"
                     : std::string(mesh) == "b9_mesh.off"   ? " and "
                                                            : ", ");
    }
    std::string page = test::file_text(test::source_dir() / "docs/repair.md");
    for (char& c : page)
        if (c == '\n') c = ' ';
    EXPECT_NE(page.find(expected), std::string::npos) << expected;
}

}  // namespace
