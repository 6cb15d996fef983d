// What `inspect` says of a cage, against counts made here from the file's faces and tags.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "command_runner.h"
#include "prep/load.h"
#include "shared_data.h"

namespace {

using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

using Face = std::vector<std::size_t>;
using Edge = std::pair<std::size_t, std::size_t>;

// Faces and tags of an OBJ file without seams; indices from 0.
struct Cage {
    std::vector<Face> faces;
    std::size_t semi_sharp = 0, infinitely_sharp = 0, sharp_vertices = 0, holes = 0;
    std::map<std::size_t, std::size_t> crease_ends;  // how many creases meet at a vertex
};
Cage parsed(const std::string& text) {
    Cage cage;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string head, word;
        words >> head;
        if (head == "f") {
            cage.faces.emplace_back();
            while (words >> word) cage.faces.back().push_back(std::stoul(word) - 1);
        }
        if (head != "t") continue;
        std::string kind, counts;
        words >> kind >> counts;
        if (kind == "crease") {
            std::size_t a = 0, b = 0;
            double sharpness = 0;
            words >> a >> b >> sharpness;
            if (sharpness <= 0) continue;
            ++(sharpness < 10 ? cage.semi_sharp : cage.infinitely_sharp);
            ++cage.crease_ends[a];
            ++cage.crease_ends[b];
        }
        if (kind == "corner") {
            std::size_t v = 0;
            double sharpness = 0;
            words >> v >> sharpness;
            cage.sharp_vertices += sharpness > 0;
        }
        cage.holes += kind == "hole";
    }
    return cage;
}

// Every vertex by its faces: how many groups the faces make that share a good edge there.
void expect_counts(const json& told, const Cage& cage) {
    std::map<Edge, std::vector<std::pair<std::size_t, bool>>> edges;  // faces, and which way
    std::map<std::size_t, std::vector<std::size_t>> around;
    bool triangles = true;
    for (std::size_t f = 0; f < cage.faces.size(); ++f) {
        const Face& face = cage.faces[f];
        triangles &= face.size() == 3;
        for (std::size_t k = 0; k < face.size(); ++k) {
            const std::size_t a = face[k], b = face[(k + 1) % face.size()];
            edges[std::minmax(a, b)].emplace_back(f, a < b);
            around[a].push_back(f);
        }
    }
    std::set<Edge> bad;
    std::set<std::size_t> border;
    for (const auto& [edge, sides] : edges) {
        if (sides.size() == 1) border.insert({edge.first, edge.second});
        if (sides.size() > 2 || (sides.size() == 2 && sides[0].second == sides[1].second))
            bad.insert(edge);
    }
    std::size_t extraordinary = 0, several_fans = 0, ends = 0;
    for (const auto& [v, faces] : around) {
        const std::size_t inside = triangles ? 6 : 4;
        extraordinary += border.contains(v) ? faces.size() != 1 && faces.size() != inside / 2
                                            : faces.size() != inside;
        std::map<std::size_t, std::size_t> group;
        for (const std::size_t f : faces) group[f] = f;
        for (bool changed = true; changed;) {
            changed = false;
            for (const auto& [edge, sides] : edges) {
                if (sides.size() != 2 || bad.contains(edge) ||
                    (edge.first != v && edge.second != v))
                    continue;
                std::size_t &a = group[sides[0].first], &b = group[sides[1].first];
                if (a == b) continue;
                a = b = std::min(a, b);
                changed = true;
            }
        }
        std::set<std::size_t> groups;
        for (const auto& [f, g] : group) groups.insert(g);
        several_fans += groups.size() > 1;
        const auto creases = cage.crease_ends.find(v);
        ends += creases != cage.crease_ends.end() && creases->second == 1 && !border.contains(v);
    }
    EXPECT_EQ(told["scheme"], triangles ? "loop" : "catmark");
    EXPECT_EQ(told["extraordinary_vertices"], extraordinary);
    EXPECT_EQ(told["semi_sharp_edges"], cage.semi_sharp);
    EXPECT_EQ(told["infinitely_sharp_edges"], cage.infinitely_sharp);
    EXPECT_EQ(told["sharp_vertices"], cage.sharp_vertices);
    EXPECT_EQ(told["crease_ends"], ends);
    EXPECT_EQ(told["hole_faces"], cage.holes);
    // Where a face uses a vertex twice, what its edges are is the topology's own choice.
    const bool folded = std::any_of(cage.faces.begin(), cage.faces.end(), [](const Face& face) {
        return std::set<std::size_t>(face.begin(), face.end()).size() < face.size();
    });
    if (!folded) {
        EXPECT_EQ(told["non_manifold_edges"], bad.size());
    }
    EXPECT_EQ(told["non_manifold_vertices"], several_fans);
}

json told_of(const std::filesystem::path& path) {
    const test::Ran ran = run_here({"inspect", path.string(), "--json"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    const json document = ran.json();
    return document.contains("files") ? document["files"][0]["meshes"][0]["cage"] : json();
}

// A cube with a crease around its top, two ends of another, a sharp vertex and a hole.
const std::string tagged =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
    "t crease 2/1/0 4 5 2.5\nt crease 2/1/0 5 6 10.0\nt crease 2/1/0 6 7 0.0\n"
    "t crease 2/1/0 0 1 3.0\nt corner 1/1/0 3 4.0\nt hole 1/0/0 4\n";

TEST(InspectCage, TagsAndExtraordinaryVertices) {
    const TempDir dir;
    write_text(dir / "cage.obj", tagged);
    const json told = told_of(dir / "cage.obj");
    expect_counts(told, parsed(tagged));
    EXPECT_EQ(told["extraordinary_vertices"], 8);  // three faces each
    EXPECT_EQ(told["crease_ends"], 4);             // of 4–5–6 and of 0–1
    EXPECT_EQ(told["non_manifold_edges"], 0);
    EXPECT_EQ(told["non_manifold_vertices"], 0);
    const std::string words = run_here({"inspect", (dir / "cage.obj").string()}).out;
    EXPECT_NE(words.find("as a cage (catmark): 8 extraordinary vertices, 3 creased edges (1 "
                         "infinitely sharp), 4 crease ends, 1 sharp vertex, 1 hole face\n"),
              std::string::npos)
        << words;
}

// Three pages of two quads at a spine; two pyramids that touch at their tips; a face turned over in
// a strip of three.
TEST(InspectCage, WhatIsNotManifold) {
    const TempDir dir;
    const std::string book =
        "v 0 0 0\nv 0 0 1\nv 0 0 2\nv 1 0 0\nv 1 0 1\nv 1 0 2\n"
        "v 0 1 0\nv 0 1 1\nv 0 1 2\nv -1 0 0\nv -1 0 1\nv -1 0 2\n"
        "f 1 4 5 2\nf 2 5 6 3\nf 1 7 8 2\nf 2 8 9 3\nf 1 10 11 2\nf 2 11 12 3\n";
    const std::string tips =
        "v 0 0 0\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
        "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\n"
        "f 1 2 3\nf 1 3 4\nf 1 4 5\nf 1 5 2\nf 2 5 4 3\n"
        "f 1 7 6\nf 1 8 7\nf 1 9 8\nf 1 6 9\nf 6 7 8 9\n";
    const std::string turned =
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 3 1 0\n"
        "f 1 2 6 5\nf 2 6 7 3\nf 3 4 8 7\n";
    struct Row {
        const char* name;
        std::string obj;
        int edges, vertices;
        const char* words;
    };
    for (const Row& row :
         {Row{"book", book, 2, 3, ", 2 non-manifold edges, 3 non-manifold vertices\n"},
          Row{"tips", tips, 0, 1, ", 1 non-manifold vertex\n"},
          Row{"turned", turned, 2, 4, ", 2 non-manifold edges, 4 non-manifold vertices\n"}}) {
        SCOPED_TRACE(row.name);
        // A tag, so that the words are there for triangles too.
        const std::string text = row.obj + "t corner 1/1/0 4 1.0\n";
        write_text(dir / "cage.obj", text);
        const json told = told_of(dir / "cage.obj");
        expect_counts(told, parsed(text));
        EXPECT_EQ(told["non_manifold_edges"], row.edges);
        EXPECT_EQ(told["non_manifold_vertices"], row.vertices);
        const std::string words = run_here({"inspect", (dir / "cage.obj").string()}).out;
        EXPECT_NE(words.find(row.words), std::string::npos) << words;
    }
}

TEST(InspectCage, CountsOfTheCorpus) {
    MESHPREP_REQUIRE_SHARED(shared);
    std::size_t files = 0, non_manifold = 0;
    for (const auto& entry : std::filesystem::directory_iterator(shared / "corpus" / "subdiv")) {
        if (entry.path().extension() != ".obj") continue;
        SCOPED_TRACE(entry.path().stem().string());
        ++files;
        const json told = told_of(entry.path());
        expect_counts(told, parsed(test::file_text(entry.path())));
        if (told.is_object()) non_manifold += told["non_manifold_vertices"] > 0;
    }
    EXPECT_EQ(files, 20U);
    EXPECT_GE(non_manifold, 2U);
}

}  // namespace
