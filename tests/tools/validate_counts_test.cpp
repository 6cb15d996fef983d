// Each count of the validation page against a plain count of the file's own numbers, and against
// what `inspect` says of the same file.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "command_runner.h"
#include "shared_data.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

using Point = std::array<int, 3>;

// Polygons over integer points, so that equal means equal.
struct Shape {
    std::vector<Point> points;
    std::vector<std::vector<std::size_t>> faces;
    std::vector<int> materials;  // per face
};

// A grid of squares, some cut into triangles or joined to hexagons, with holes, fins, turned faces,
// a second sheet that touches in a corner, and vertices that nothing uses.
Shape odd_shape(unsigned seed, bool fins = true) {
    std::mt19937 random(seed);
    const auto one_in = [&](unsigned n) { return random() % n == 0; };
    Shape shape;
    constexpr int n = 7;
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x)
            shape.points.push_back({4 * x, 4 * y, one_in(3) ? int(random() % 9) : 0});
    const auto at = [](int x, int y) { return std::size_t(y * (n + 1) + x); };
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            if (one_in(9)) continue;  // a hole
            std::vector<std::size_t> quad = {at(x, y), at(x + 1, y), at(x + 1, y + 1),
                                             at(x, y + 1)};
            if (one_in(4)) {
                shape.faces.push_back({quad[0], quad[1], quad[2]});
                shape.faces.push_back({quad[0], quad[2], quad[3]});
            } else {
                shape.faces.push_back(quad);
            }
            if (one_in(8)) std::reverse(shape.faces.back().begin(), shape.faces.back().end());
        }
    for (int fin = 0; fins && fin < 4; ++fin) {  // a third face on an edge
        const int x = int(random() % n), y = int(random() % n);
        shape.points.push_back({4 * x, 4 * y, 40 + fin});
        shape.faces.push_back({at(x, y), at(x + 1, y), shape.points.size() - 1});
    }
    const std::size_t first = shape.points.size();  // a pentagon by itself
    for (int k = 0; k < 5; ++k)
        shape.points.push_back(
            {100 + int(10 * std::cos(k * 1.2566)), int(10 * std::sin(k * 1.2566)), 0});
    shape.faces.push_back({first, first + 1, first + 2, first + 3, first + 4});
    for (int k = 0; k < 3; ++k) shape.points.push_back({200, k, 0});  // unused
    for (std::size_t f = 0; f < shape.faces.size(); ++f)
        shape.materials.push_back(int(random() % 3));
    return shape;
}

// Each corner a vertex of its own.
Shape soup_of(const Shape& shape) {
    Shape soup;
    for (const auto& face : shape.faces) {
        soup.faces.emplace_back();
        for (const std::size_t v : face) {
            soup.faces.back().push_back(soup.points.size());
            soup.points.push_back(shape.points[v]);
        }
    }
    soup.materials = shape.materials;
    return soup;
}

// Faces of even and of odd number have vertices of their own.
Shape patches_of(const Shape& shape) {
    Shape out = shape;
    out.points.insert(out.points.end(), shape.points.begin(), shape.points.end());
    for (std::size_t f = 1; f < out.faces.size(); f += 2)
        for (std::size_t& v : out.faces[f]) v += shape.points.size();
    return out;
}

std::string obj_of(const Shape& shape) {
    std::string text = "mtllib m.mtl\n";
    for (const Point& p : shape.points)
        text += "v " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " +
                std::to_string(p[2]) + "\n";
    for (std::size_t f = 0; f < shape.faces.size(); ++f) {
        text += "usemtl m" + std::to_string(shape.materials[f]) + "\nf";
        for (const std::size_t v : shape.faces[f]) text += " " + std::to_string(v + 1);
        text += "\n";
    }
    return text;
}

// What the page should say, counted with sets and maps over positions.
struct Plain {
    std::size_t triangles = 0, quads = 0, polygons = 0, drawn = 0;
    std::size_t open = 0, bad = 0, mixed = 0, inner = 0, components = 0;
    std::set<int> materials;
};

Plain count(const Shape& shape) {
    Plain out;
    struct Use {
        std::size_t face;
        bool forward;
    };
    std::map<std::pair<Point, Point>, std::vector<Use>> edges;
    for (std::size_t f = 0; f < shape.faces.size(); ++f) {
        const auto& face = shape.faces[f];
        out.triangles += face.size() == 3;
        out.quads += face.size() == 4;
        out.polygons += face.size() > 4;
        out.drawn += face.size() - 2;
        out.materials.insert(shape.materials[f]);
        for (std::size_t k = 0; k < face.size(); ++k) {
            const Point a = shape.points[face[k]], b = shape.points[face[(k + 1) % face.size()]];
            edges[std::minmax(a, b)].push_back({f, a < b});
        }
    }
    std::vector<std::size_t> group(shape.faces.size());
    std::iota(group.begin(), group.end(), std::size_t(0));
    for (const auto& [ends, uses] : edges) {
        if (uses.size() == 1) ++out.open;
        if (uses.size() > 2) ++out.bad;
        if (uses.size() == 2) ++(uses[0].forward == uses[1].forward ? out.mixed : out.inner);
        for (const Use& use : uses) {
            const std::size_t from = group[use.face], to = group[uses[0].face];
            std::replace(group.begin(), group.end(), from, to);
        }
    }
    out.components = std::set<std::size_t>(group.begin(), group.end()).size();
    return out;
}

std::string commas(std::size_t n) {
    std::string text = std::to_string(n);
    for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, ",");
    return text;
}

std::size_t number(const json& group, const char* name) {
    return group.contains(name) ? group[name].get<std::size_t>() : 0;
}

// What `inspect` says of several meshes, as one: sums, and what holds for all of them.
json sum_of(const std::vector<json>& meshes) {
    json sum = {{"closed", true}, {"manifold", true}, {"oriented", true}, {"has_normals", false}};
    for (const json& mesh : meshes)
        for (const auto& [name, value] : mesh.items()) {
            if (value.is_number_unsigned())
                sum[name] = number(sum, name.c_str()) + value.get<std::size_t>();
            else if (name == "has_normals")
                sum[name] = sum[name].get<bool>() || value.get<bool>();
            else if (value.is_boolean() && sum.contains(name))
                sum[name] = sum[name].get<bool>() && value.get<bool>();
        }
    return sum;
}

// A sheet, and what `inspect` says of its meshes.
struct Sheet {
    json figures, mesh, findings;
};

// The first is of the whole file.
std::vector<Sheet> sheets_of(const std::filesystem::path& file, const std::filesystem::path& out) {
    const test::Ran page =
        run_here({"validate", file.string(), "-o", out.string(), "--panel", "64", "--json"});
    const test::Ran inspect = run_here({"inspect", file.string(), "--json"});
    EXPECT_EQ(page.exit_code, 0) << page.err;
    EXPECT_EQ(inspect.exit_code, 0) << inspect.err;
    const json drawn = page.json(), told = inspect.json();
    if (page.exit_code != 0 || inspect.exit_code != 0) return {Sheet{}};
    const std::vector<json> meshes = told["files"][0]["meshes"];
    std::vector<Sheet> sheets;
    const auto add = [&](const std::vector<json>& of, std::optional<std::size_t> mesh) {
        Sheet sheet;
        sheet.figures = drawn["files"][0]["numbers"][sheets.size()]["figures"];
        sheet.mesh = sum_of(of);
        for (const json& f : told["files"][0]["findings"]) {
            const std::string kind = f["kind"];
            if (!mesh || f["mesh"] == *mesh)
                sheet.findings[kind] =
                    number(sheet.findings, kind.c_str()) + f["count"].get<std::size_t>();
        }
        sheets.push_back(std::move(sheet));
    };
    add(meshes, {});
    if (meshes.size() > 1)
        for (std::size_t m = 0; m < meshes.size(); ++m) add({meshes[m]}, m);
    EXPECT_EQ(drawn["files"][0]["numbers"].size(), sheets.size());
    return sheets;
}

// Whether the page agrees with itself and with `inspect`.
void expect_agreement(const Sheet& said, const std::string& what) {
    const json &page = said.figures["Mesh"], &edges = said.figures["Edges"], &mesh = said.mesh;
    const std::size_t open = mesh["open_edges"], bad = mesh["non_manifold_edges"],
                      ties = mesh["non_manifold_vertices"];
    EXPECT_EQ(page["faces"], mesh["faces"]) << what;
    EXPECT_EQ(
        page["triangles, quads, polygons"],
        commas(mesh["triangles"]) + ", " + commas(mesh["quads"]) + ", " + commas(mesh["polygons"]))
        << what;
    EXPECT_EQ(page["components"], mesh["components"]) << what;
    EXPECT_EQ(said.figures["Vertices"]["in the file"], mesh["vertices"]) << what;
    const auto no = [](const std::string& more) { return json("no, " + more); };
    EXPECT_EQ(page["closed"],
              mesh["closed"].get<bool>() ? json(true) : no(commas(open) + " open edges"))
        << what;
    std::string faults = bad > 0 ? commas(bad) + " bad edges" : "";
    if (ties > 0) faults += (bad > 0 ? ", " : "") + commas(ties) + " bad vertices";
    EXPECT_EQ(page["manifold"], mesh["manifold"].get<bool>() ? json(true) : no(faults)) << what;
    EXPECT_EQ(page["consistent orientation"], mesh["oriented"]) << what;
    // The drawn edges are those of the summary.
    EXPECT_EQ(number(edges, "open border"), open) << what;
    EXPECT_EQ(number(edges, "non-manifold"), bad) << what;
    EXPECT_EQ(number(edges, "inconsistent orientation"), mesh["mixed_orientation_edges"]) << what;
    if (!mesh["has_normals"].get<bool>()) {
        EXPECT_EQ(number(edges, "authored normals"), 0u) << what;
    }
    // The findings are those of `inspect`, as far as the page has room for them.
    for (const auto& [kind, count] : said.findings.items())
        if (said.figures["Findings"].contains(kind)) {
            EXPECT_EQ(said.figures["Findings"][kind], count) << what << ": " << kind;
        }
}

TEST(ValidateCounts, AreThoseOfThePlainestCount) {
    const TempDir dir;
    write_text(dir / "m.mtl", "newmtl m0\nnewmtl m1\nnewmtl m2\n");
    std::size_t holes = 0, bad = 0, mixed = 0;
    for (unsigned seed = 1; seed <= 6; ++seed) {
        const Shape shape = odd_shape(seed);
        for (const Shape& s : {shape, soup_of(shape), patches_of(odd_shape(seed, false))}) {
            write_text(dir / "s.obj", obj_of(s));
            const Sheet said = sheets_of(dir / "s.obj", dir / "out")[0];
            const std::string what = "seed " + std::to_string(seed) + ", " +
                                     std::to_string(s.points.size()) + " vertices";
            const Plain plain = count(s);
            const json &page = said.figures["Mesh"], &edges = said.figures["Edges"];
            EXPECT_EQ(page["faces"], s.faces.size()) << what;
            EXPECT_EQ(page["triangles, quads, polygons"], commas(plain.triangles) + ", " +
                                                              commas(plain.quads) + ", " +
                                                              commas(plain.polygons))
                << what;
            EXPECT_EQ(page["components"], plain.components) << what;
            EXPECT_EQ(page["closed"], "no, " + commas(plain.open) + " open edges") << what;
            EXPECT_EQ(page["consistent orientation"], plain.mixed == 0) << what;
            EXPECT_EQ(page["materials"], plain.materials.size()) << what;
            EXPECT_EQ(said.figures["Vertices"]["in the file"], s.points.size()) << what;
            EXPECT_EQ(said.figures["Vertices"]["triangles"], plain.drawn) << what;
            EXPECT_EQ(number(edges, "open border"), plain.open) << what;
            EXPECT_EQ(number(edges, "non-manifold"), plain.bad) << what;
            EXPECT_EQ(number(edges, "inconsistent orientation"), plain.mixed) << what;
            expect_agreement(said, what);
            holes += plain.open;
            bad += plain.bad;
            mixed += plain.mixed;
        }
    }
    EXPECT_GT(std::min({holes, bad, mixed}), 20u);
}

// Faces that share vertices are neighbours before those that share places alone, so that a plain
// count by places is not what a fin between patches has.
TEST(ValidateCounts, OfFinsBetweenPatchesAreThoseOfInspect) {
    const TempDir dir;
    write_text(dir / "m.mtl", "newmtl m0\nnewmtl m1\nnewmtl m2\n");
    for (unsigned seed = 1; seed <= 4; ++seed) {
        write_text(dir / "s.obj", obj_of(patches_of(odd_shape(seed))));
        expect_agreement(sheets_of(dir / "s.obj", dir / "out")[0], "seed " + std::to_string(seed));
    }
}

// A file whose sides have vertices of their own is closed, and its edges say why shading breaks.
TEST(ValidateCounts, SidesWithVerticesOfTheirOwnAreNotOpen) {
    const TempDir dir;
    Shape roof;  // two slopes over a ridge; each side has its own four vertices
    for (const int side : {-1, 1})
        for (const int y : {0, 10}) {
            roof.points.push_back({0, y, 5});
            roof.points.push_back({10 * side, y, 0});
        }
    roof.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    roof.materials = {0, 0, 0, 0};
    write_text(dir / "roof.obj", obj_of(roof));
    const Sheet said = sheets_of(dir / "roof.obj", dir / "out")[0];
    EXPECT_EQ(said.figures["Mesh"]["closed"], "no, 6 open edges");
    EXPECT_EQ(said.figures["Edges"]["open border"], 6);
    EXPECT_EQ(said.figures["Edges"]["vertices apart in the file"], 1);
    expect_agreement(said, "roof");
}

TEST(ValidateCounts, AgreeWithInspectOnTheCorpus) {
    MESHPREP_REQUIRE_SHARED(shared);
    const TempDir dir;
    for (const char* name :
         {"cycloidal.ply", "featuretype.STL", "non_manifold_face_graph.off", "degtri_sliding.off",
          "openscad-nonmanifold-crash.obj", "many_small_holes.ply", "teapot.obj",
          "fandisk_quads.off", "frostAxe.glb", "CesiumMan.glb", "NormalTangentTest.glb",
          "african_head/african_head.obj", "spider/spider.obj",
          "osd-shapes/catmark_nonman_verts.obj", "subdiv/catmark_nonman_edges.obj",
          "icosahedron_binary.stl"}) {
        SCOPED_TRACE(name);
        const std::filesystem::path file = shared / "corpus" / name;
        if (!std::filesystem::exists(file)) continue;
        for (const Sheet& sheet : sheets_of(file, dir / "out")) expect_agreement(sheet, name);
    }
}

}  // namespace
