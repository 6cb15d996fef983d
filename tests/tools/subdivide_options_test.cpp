// Every subdivision option of `prepare`: the written points against the published rules (the
// tests' own oracle) and counts by Euler's formula; the report's findings against counts made here.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "command_runner.h"
#include "prep/load.h"
#include "subdivision_oracle.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::SubdivisionRules;
using test::TempDir;
using test::write_text;
using Points = std::vector<glm::dvec3>;

const std::string cube =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";
const std::string quads = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
const std::string triangles =
    "f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\n"
    "f 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";
// A bent sheet of 3 × 3 quads.
std::string sheet() {
    std::string text;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x)
            text += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
                    std::to_string((x * x + 2 * y) % 3) + "\n";
    for (int y = 0; y < 3; ++y)
        for (int x = 1; x < 4; ++x) {
            const auto at = [&](int i, int j) { return " " + std::to_string(4 * j + i); };
            text += "f" + at(x, y) + at(x + 1, y) + at(x + 1, y + 1) + at(x, y + 1) + "\n";
        }
    return text;
}

// The lines of an OBJ file that begin so, as numbers.
std::vector<std::vector<double>> lines(const std::string& text, const std::string& head) {
    std::vector<std::vector<double>> found;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(head + " ")) continue;
        std::istringstream words(line.substr(head.size()));
        found.emplace_back();
        for (double x; words >> x;) found.back().push_back(x);
    }
    return found;
}

struct Prepared {
    json file;
    std::string obj;
    Points points;
    std::uint64_t count(const std::string& finding) const {
        for (const json& f : file["findings"])
            if (f["kind"] == finding) return f["count"];
        return 0;
    }
};
Prepared prepared(const std::string& obj, std::vector<std::string> options) {
    const TempDir dir;
    write_text(dir / "cage.obj", obj);
    options.insert(options.begin(), {"prepare", (dir / "cage.obj").string(), "-o",
                                     (dir / "out.obj").string(), "--json"});
    const test::Ran ran = run_here(options);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    Prepared out;
    if (ran.exit_code != 0) return out;
    out.file = ran.json()["files"][0];
    out.obj = test::file_text(dir / "out.obj");
    for (const auto& v : lines(out.obj, "v")) out.points.emplace_back(v[0], v[1], v[2]);
    return out;
}

// By the rules, in long double.
Points truth(const std::string& obj, const SubdivisionRules& rules, int level,
             bool control_points = false) {
    const TempDir dir;
    write_text(dir / "cage.obj", obj);
    const auto scene = prep::load_scene(dir / "cage.obj");
    if (!scene) {
        ADD_FAILURE() << to_string(scene.error());
        return {};
    }
    const test::SubdivisionOracle oracle(scene->meshes[0], rules);
    const auto refined = oracle.refine_all(level);
    Points points;
    for (std::size_t c = 0; c < refined.corners.size(); ++c) {
        const std::uint32_t v = refined.corner_vertices[c];
        if (oracle.is_hole(refined.corners[c].face)) continue;
        points.push_back(
            glm::dvec3(control_points ? refined.control_points[v] : refined.limits[v].position));
    }
    return points;
}

double farthest(const Points& from, const Points& to) {
    double worst = 0;
    for (const glm::dvec3& p : from) {
        double best = 1e300;
        for (const glm::dvec3& q : to) best = std::min(best, glm::length(p - q));
        worst = std::max(worst, best);
    }
    return worst;
}
// The same set: floats of a few units' size, and their text.
void expect_same(const Points& found, const Points& expected) {
    ASSERT_FALSE(found.empty());
    EXPECT_LE(farthest(found, expected), 1e-6);
    EXPECT_LE(farthest(expected, found), 1e-6);
}
// A check that cannot tell two choices apart proves neither.
void expect_other(const Points& found, const Points& expected) {
    EXPECT_GT(std::max(farthest(found, expected), farthest(expected, found)), 1e-3);
}

SubdivisionRules with(SubdivisionRules::Scheme scheme) {
    SubdivisionRules rules;
    rules.scheme = scheme;
    return rules;
}
using Scheme = SubdivisionRules::Scheme;

TEST(SubdivideOptions, SchemesAndLevels) {
    for (const auto& [word, scheme] :
         {std::pair{"catmark", Scheme::catmark}, std::pair{"bilinear", Scheme::bilinear},
          std::pair{"loop", Scheme::loop}}) {
        const bool loop = scheme == Scheme::loop;
        const std::string obj = cube + (loop ? triangles : quads);
        for (const int level : {1, 2, 3}) {
            SCOPED_TRACE(std::string(word) + ":" + std::to_string(level));
            const Prepared found =
                prepared(obj, {"--subdivide", std::string(word) + ":" + std::to_string(level)});
            const std::size_t faces = (loop ? 12U : 6U) << (2 * level);
            EXPECT_EQ(found.file["after"]["triangles"], loop ? faces : 2 * faces);
            EXPECT_EQ(lines(found.obj, "f").size(), faces);
            // Closed, of genus 0: V = E − F + 2; bilinear faces are flat, and what turns by less
            // than the hard angle stays smooth as well.
            EXPECT_EQ(found.points.size(), loop ? faces / 2 + 2 : faces + 2);
            expect_same(found.points, truth(obj, with(scheme), level));
        }
        const Prepared without = prepared(obj, {"--subdivide", word});
        expect_same(without.points, truth(obj, with(scheme), 2));  // the default level
    }
}

TEST(SubdivideOptions, ControlPoints) {
    const Prepared found = prepared(cube + quads, {"--subdivide", "catmark:2", "--control-points"});
    const SubdivisionRules rules = with(Scheme::catmark);
    expect_same(found.points, truth(cube + quads, rules, 2, true));
    expect_other(found.points, truth(cube + quads, rules, 2, false));
}

TEST(SubdivideOptions, Boundaries) {
    using Boundary = SubdivisionRules::Boundary;
    const std::string obj = sheet();
    for (const auto& [word, boundary, faces] :
         {std::tuple{"none", Boundary::none, 1U},
          std::tuple{"edge-and-corner", Boundary::edge_and_corner, 9U},
          std::tuple{"edge-only", Boundary::edge_only, 9U}}) {
        SCOPED_TRACE(word);
        const Prepared found =
            prepared(obj, {"--subdivide", "catmark:2", "--subdivide-boundary", word});
        SubdivisionRules rules = with(Scheme::catmark);
        rules.boundary = boundary;
        EXPECT_EQ(found.file["after"]["triangles"], 2 * 16 * faces);
        EXPECT_EQ(found.count("hole"), 9 - faces);
        expect_same(found.points, truth(obj, rules, 2));
    }
    // The file's own word counts where none is given.
    const std::string tagged = obj + "t interpolateboundary 1/0/0 2\n";
    SubdivisionRules rules = with(Scheme::catmark);
    rules.boundary = Boundary::edge_only;
    expect_same(prepared(tagged, {"--subdivide", "catmark:2"}).points, truth(tagged, rules, 2));
}

TEST(SubdivideOptions, Creasing) {
    const std::string obj = cube + quads +
                            "t crease 2/1/0 4 5 1.5\nt crease 2/1/0 5 6 3.0\n"
                            "t crease 2/1/0 6 7 0.5\nt crease 2/1/0 7 4 2.5\n";
    SubdivisionRules uniform = with(Scheme::catmark), chaikin = uniform;
    chaikin.chaikin = true;
    const auto by = [&](const char* word) {
        return prepared(obj, {"--subdivide", "catmark:3", "--creasing", word}).points;
    };
    expect_same(by("uniform"), truth(obj, uniform, 3));
    expect_same(by("chaikin"), truth(obj, chaikin, 3));
    expect_other(by("chaikin"), truth(obj, uniform, 3));
    expect_same(prepared(obj, {"--subdivide", "catmark:3"}).points, truth(obj, uniform, 3));
}

TEST(SubdivideOptions, CreasesFromHardEdges) {
    std::string creased = cube + quads;
    for (const char* edge :
         {"0 1", "1 2", "2 3", "3 0", "4 5", "5 6", "6 7", "7 4", "0 4", "1 5", "2 6", "3 7"})
        creased += std::string("t crease 2/1/0 ") + edge + " 10.0\n";
    const SubdivisionRules rules = with(Scheme::catmark);
    const auto at = [](const char* degrees) {
        return prepared(cube + quads, {"--subdivide", "catmark:2", "--crease-from", "hard-edges",
                                       "--hard-angle", degrees});
    };
    const Prepared sharp = at("80");
    expect_same(sharp.points, truth(creased, rules, 2));
    // Six flat sides of 5 × 5 vertices, each with its normal.
    EXPECT_EQ(sharp.file["after"]["vertices"], 6 * 25);
    // No edge turns by more than 100 degrees.
    expect_same(at("100").points, truth(cube + quads, rules, 2));
}

TEST(SubdivideOptions, Quads) {
    const Prepared found = prepared(cube + triangles, {"--subdivide", "catmark:2", "--quads"});
    EXPECT_EQ(found.file["after"]["triangles"], 6 * 16 * 2);
    EXPECT_EQ(found.count("ambiguous-quad"), 0U);
    EXPECT_EQ(found.count("lone-triangle"), 0U);
    EXPECT_EQ(found.count("triangulated-cage"), 0U);
    expect_same(found.points, truth(cube + quads, with(Scheme::catmark), 2));
    // Without it each triangle is three quads, and that is told.
    const Prepared without = prepared(cube + triangles, {"--subdivide", "catmark:2"});
    EXPECT_EQ(without.file["after"]["triangles"], 12 * 3 * 4 * 2);
    EXPECT_EQ(without.count("triangulated-cage"), 12U);
    expect_same(without.points, truth(cube + triangles, with(Scheme::catmark), 2));
}

TEST(SubdivideOptions, SmoothTriangles) {
    SubdivisionRules rules = with(Scheme::catmark);
    const Points plain = truth(cube + triangles, rules, 2);
    rules.smooth_triangles = true;
    const Prepared found =
        prepared(cube + triangles, {"--subdivide", "catmark:2", "--smooth-triangles"});
    expect_same(found.points, truth(cube + triangles, rules, 2));
    expect_other(found.points, plain);
}

// A sheet with UVs that are no linear function of the place: three islands meet at vertex (1, 1),
// and two at (2, 2), of which one has three of the four faces there.
std::string islands() {
    std::string text = sheet();
    text.resize(text.find("f "));
    const int island[3][3] = {{0, 0, 1}, {1, 2, 1}, {1, 1, 1}};  // of faces, row by row
    std::string faces;
    int value = 0;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x) {
            faces += "f";
            for (const auto& [i, j] : {std::pair{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}) {
                text += "vt " + std::to_string(10 * island[y][x] + i * i) + " " +
                        std::to_string(j * j) + "\n";
                faces += " " + std::to_string(4 * j + i + 1) + "/" + std::to_string(++value);
            }
            faces += "\n";
        }
    return text + faces;
}

// What each rule keeps of the cage's own values, and where it is linear. Islands: 0 is faces (0, 0)
// and (1, 0), 2 is face (1, 1), 1 are the others.
TEST(SubdivideOptions, FaceVaryingRules) {
    struct Row {
        const char* rule;
        bool corner;    // (0, 0) of island 0: sharp as the mesh is there
        bool junction;  // (1, 1) of island 0: two of its faces where three islands meet
        bool concave;   // (2, 2) of island 1: three of its faces beside one of island 2
        bool linear;    // halfway from (1, 0) to (2, 0) on the border of island 0
    };
    const std::string obj = islands();
    for (const Row& row :
         {Row{"none", true, false, false, false}, Row{"corners-only", true, false, false, false},
          Row{"corners-plus1", true, true, false, false},
          Row{"corners-plus2", true, true, true, false}, Row{"boundaries", true, true, true, true},
          Row{"all", true, true, true, true}}) {
        SCOPED_TRACE(row.rule);
        const Prepared found =
            prepared(obj, {"--subdivide", "catmark:1", "--face-varying", row.rule});
        const auto values = lines(found.obj, "vt");
        const auto has = [&](double u, double v) {
            return std::any_of(values.begin(), values.end(), [&](const auto& uv) {
                return std::abs(uv[0] - u) < 1e-5 && std::abs(uv[1] - v) < 1e-5;
            });
        };
        EXPECT_EQ(has(0, 0), row.corner);
        EXPECT_EQ(has(1, 1), row.junction);
        EXPECT_EQ(has(10 + 4, 4), row.concave);
        EXPECT_EQ(has((1 + 4) / 2.0, 0), row.linear);
        // `all` alone has the mean of a face's corners in its middle: face (0, 2) of island 1, two
        // edges of which are inside of it.
        EXPECT_EQ(has(10 + 0.5, (4 + 9) / 2.0), std::string(row.rule) == "all");
    }
}

TEST(SubdivideOptions, AreUsageErrorsWithoutSubdivision) {
    const TempDir dir;
    write_text(dir / "cage.obj", cube + quads);
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"--control-points"},
                                               {"--subdivide-boundary", "none"},
                                               {"--face-varying", "all"},
                                               {"--creasing", "chaikin"},
                                               {"--smooth-triangles"},
                                               {"--crease-from", "hard-edges"},
                                               {"--quads"},
                                               {"--max-influences", "2"},
                                               {"--subdivide", "catmark:11"},
                                               {"--subdivide", "doo-sabin"}}) {
        std::vector<std::string> all{"prepare", (dir / "cage.obj").string(), "-o",
                                     (dir / "out.obj").string()};
        all.insert(all.end(), words.begin(), words.end());
        const test::Ran ran = run_here(all);
        EXPECT_EQ(ran.exit_code, 2) << words[0];
        EXPECT_NE(ran.err.find(words[0]), std::string::npos) << ran.err;
    }
}

// The report's own lines.
TEST(SubdivideOptions, AreToldInTheReport) {
    const Prepared found =
        prepared(cube + quads + "t hole 1/0/0 3\n", {"--subdivide", "catmark:3", "--explain"});
    EXPECT_EQ(found.count("hole"), 1U);
    EXPECT_EQ(found.file["after"]["triangles"], 5 * 64 * 2);
    const TempDir dir;
    write_text(dir / "cage.obj", cube + quads);
    const auto words = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"prepare", (dir / "cage.obj").string(), "-o",
                                   (dir / "out.obj").string(), "--explain"});
        return run_here(more).out;
    };
    const std::string limits = words({"--subdivide", "catmark:3"});
    EXPECT_NE(limits.find("catmark, level 3, points on the limit surface"), std::string::npos)
        << limits;
    EXPECT_NE(limits.find("the normals of the limit surface stand"), std::string::npos) << limits;
    const std::string control = words({"--subdivide", "bilinear", "--control-points"});
    EXPECT_NE(control.find("bilinear, level 2, points of the refined cage"), std::string::npos)
        << control;
    EXPECT_EQ(words({}).find("subdivide"), std::string::npos);
}

}  // namespace
