// UVs under OpenSubdiv's six face-varying rules, against Far's own values in double, at every
// corner of level 4: refined values where control points are written, limits where limits are.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <span>

#include "opensubdiv_peer.h"
#include "prep/subdivide.h"
#include "shapes.h"
#include "shared_data.h"
#include "subdivision_cages.h"

namespace {

using prep::FaceVaryingRule;
using test::Cage;

// UVs by position, cut along some edges: each face of `apart` has values of its own, so that seams
// end inside (darts), cross borders, and meet in threes.
void add_uvs(prep::Mesh& mesh, std::initializer_list<std::uint32_t> apart) {
    prep::CornerLayer<glm::vec2> layer;
    for (const glm::vec3& p : mesh.positions)
        layer.values.emplace_back(0.5F + 0.3F * p.x + 0.1F * p.z, 0.5F + 0.3F * p.y - 0.07F * p.z);
    layer.indices = mesh.corner_vertices;
    for (const std::uint32_t f : apart) {
        std::map<std::uint32_t, std::uint32_t> moved;
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            layer.indices[c] = std::uint32_t(layer.values.size());
            layer.values.push_back(layer.values[mesh.corner_vertices[c]] +
                                   glm::vec2(float(f + 1), 0.1F * float(c)));
        }
    }
    mesh.uvs.push_back(std::move(layer));
}

// Faces of the left half are an island: a straight seam that ends at both borders.
void add_two_islands(prep::Mesh& mesh) {
    prep::CornerLayer<glm::vec2> layer;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        float side = 0;
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            side += mesh.positions[mesh.corner_vertices[c]].x;
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
            layer.indices.push_back(std::uint32_t(layer.values.size()));
            layer.values.push_back(glm::vec2(p.y, p.z - 0.2F * p.x) * (side > 0 ? 1.0F : 0.5F) +
                                   glm::vec2(side > 0 ? 3 : 0));
        }
    }
    mesh.uvs.push_back(std::move(layer));
}

std::vector<Cage> cages_with_seams() {
    std::vector<Cage> cages;
    for (Cage& cage : test::own_cages()) {
        const bool wanted = cage.name == "cube_smooth" || cage.name == "cube_dart" ||
                            cage.name == "cube_fractional" || cage.name == "pentagons" ||
                            cage.name == "triangles" || cage.name == "moebius" ||
                            cage.name == "hole" || cage.name.starts_with("grid_") ||
                            cage.name == "loop_dart" || cage.name == "loop_grid_edge-only" ||
                            cage.name == "bilinear_pentagons";
        if (!wanted) continue;
        add_uvs(cage.mesh, {0, 2});
        add_two_islands(cage.mesh);
        cages.push_back(std::move(cage));
    }
    return cages;
}

struct Difference {
    double uv = 0;  // of the UVs' extent
    std::size_t unmatched = 0, corners = 0;
};

// Far's limit masks take no notice of sharpness that still wears off: its limits are compared at a
// level where there is none.
int settled_level(const Cage& cage, int level) {
    for (const prep::EdgeMark& mark : cage.mesh.subdivision.creases)
        if (mark.sharpness < 10) level = std::max(level, int(std::ceil(mark.sharpness)));
    for (const prep::VertexMark& mark : cage.mesh.subdivision.corners)
        if (mark.sharpness < 10) level = std::max(level, int(std::ceil(mark.sharpness)));
    return level;
}

// Nor are its masks limits inside where two faces meet at a vertex, or where a crease ends.
std::vector<bool> vertices_without_far_limit(const prep::Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    std::vector<int> faces(mesh.vertex_count()), borders(mesh.vertex_count()),
        sharp(mesh.vertex_count());
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const std::uint32_t a = mesh.corner_vertices[c];
            const std::uint32_t b =
                mesh.corner_vertices[c + 1 == mesh.face_offsets[f + 1] ? mesh.face_offsets[f]
                                                                       : c + 1];
            ++edges[{std::min(a, b), std::max(a, b)}];
            ++faces[a];
        }
    for (const auto& [edge, count] : edges) {
        borders[edge.first] += count == 1;
        borders[edge.second] += count == 1;
    }
    for (const prep::EdgeMark& mark : mesh.subdivision.creases)
        if (mark.sharpness >= 10) ++sharp[mark.v0], ++sharp[mark.v1];
    std::vector<bool> found;
    for (std::size_t v = 0; v < faces.size(); ++v)
        found.push_back(!borders[v] && (faces[v] == 2 || sharp[v] == 1));
    return found;
}

// Corners of a cage face near a place, sorted along a direction in which hardly any two are alike:
// along an axis whole rows of them are.
class CornersByPlace {
  public:
    CornersByPlace(const test::FarValues& far, std::size_t cage_faces, double reach)
        : far_(far), reach_(reach), faces_(cage_faces) {
        for (std::size_t f = 0; f < far.cage_faces.size(); ++f)
            for (std::size_t c = far.face_offsets[f]; c < far.face_offsets[f + 1]; ++c)
                faces_[far.cage_faces[f]].push_back({along(far.corner_points[c]), c});
        for (auto& corners : faces_) std::sort(corners.begin(), corners.end());
    }
    // The least distance of UVs of corners within reach; below 0: there is none.
    double least(std::uint32_t face, const glm::dvec3& p, const glm::dvec2& uv) const {
        double best = -1;
        const auto& corners = faces_[face];
        for (auto at = std::lower_bound(corners.begin(), corners.end(),
                                        std::pair{along(p) - reach_, std::size_t(0)});
             at != corners.end() && at->first <= along(p) + reach_; ++at) {
            if (glm::length(far_.corner_points[at->second] - p) > reach_) continue;
            const double d = glm::length(far_.corner_uvs[at->second] - uv);
            best = best < 0 ? d : std::min(best, d);
        }
        return best;
    }

  private:
    // No longer than what is projected: nothing within reach is missed.
    static double along(const glm::dvec3& p) { return 0.2113 * p.x + 0.5471 * p.y + 0.8073 * p.z; }
    const test::FarValues& far_;
    double reach_;
    std::vector<std::vector<std::pair<double, std::size_t>>> faces_;
};

Difference difference(const Cage& cage, std::size_t set, FaceVaryingRule rule, int level,
                      bool limit) {
    Difference found;
    prep::SubdivideOptions options = cage.options;
    options.level = limit ? settled_level(cage, level) : level;
    options.control_points = !limit;
    options.face_varying = rule;
    const auto refined = prep::subdivide(cage.mesh, options);
    options.control_points = true;  // the same faces in the same order
    const auto control = prep::subdivide(cage.mesh, options);
    if (!refined || !control) {
        ADD_FAILURE() << cage.name << ": " << (refined ? control : refined).error().text;
        return found;
    }
    // Refined bilinearly, values are where they stay, whatever Far's limit masks make of them.
    const bool bilinear = cage.options.scheme == prep::SubdivisionScheme::bilinear;
    const test::FarValues far =
        test::far_values(cage, set, rule, options.level, limit && !bilinear);
    double extent = 0, size = 0;
    for (const glm::vec2& uv : cage.mesh.uvs[set].values)
        extent = std::max({extent, std::abs(double(uv.x)), std::abs(double(uv.y))});
    for (const glm::vec3& p : cage.mesh.positions) size = std::max(size, double(glm::length(p)));
    const CornersByPlace corners(far, cage.mesh.face_count(), 1e-6 * size);
    const std::vector<bool> without = vertices_without_far_limit(cage.mesh);
    const prep::Mesh& mesh = refined->mesh;
    EXPECT_EQ(mesh.face_count(), far.cage_faces.size());
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const std::uint32_t of_cage = refined->cage_vertices[mesh.corner_vertices[c]];
            if (limit && of_cage != prep::no_index && without[of_cage]) continue;
            const glm::dvec3 p = control->mesh.positions[control->mesh.corner_vertices[c]];
            const auto& layer = mesh.uvs[set];
            const double d =
                corners.least(refined->cage_faces[f], p, layer.values[layer.indices[c]]);
            ++found.corners;
            if (d < 0)
                ++found.unmatched;
            else
                found.uv = std::max(found.uv, d / extent);
        }
    return found;
}

constexpr FaceVaryingRule every_rule[] = {
    FaceVaryingRule::none,          FaceVaryingRule::corners_only, FaceVaryingRule::corners_plus1,
    FaceVaryingRule::corners_plus2, FaceVaryingRule::boundaries,   FaceVaryingRule::all};

TEST(SubdivideFaceVarying, SixRulesAreOpenSubdivsOnSeamsOfEveryKind) {
    for (const Cage& cage : cages_with_seams())
        for (const FaceVaryingRule rule : every_rule)
            for (const bool limit : {false, true})
                for (std::size_t set = 0; set < 2; ++set) {
                    SCOPED_TRACE(cage.name + " " + std::string(prep::name_of(rule)) +
                                 (limit ? " limits" : " control points") + ", set " +
                                 std::to_string(set));
                    const Difference d = difference(cage, set, rule, 3, limit);
                    EXPECT_GT(d.corners, 0U);
                    EXPECT_LE(d.uv, 1e-6);
                    EXPECT_EQ(d.unmatched, 0U);
                }
}

// A face with all faces around its vertices, its values and its tags: what its limits depend on.
Cage piece_of(const Cage& cage, std::uint32_t middle) {
    const prep::Mesh& mesh = cage.mesh;
    const auto corners = [&](std::size_t f) {
        return std::span(mesh.corner_vertices)
            .subspan(mesh.face_offsets[f], mesh.face_offsets[f + 1] - mesh.face_offsets[f]);
    };
    std::vector<std::uint32_t> renamed(mesh.vertex_count(), prep::no_index);
    Cage piece{cage.name + " about face " + std::to_string(middle), {}, cage.options};
    prep::Mesh& out = piece.mesh;
    out.uvs.push_back({mesh.uvs[0].values, {}});
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const auto own = corners(f), of_middle = corners(middle);
        if (std::find_first_of(own.begin(), own.end(), of_middle.begin(), of_middle.end()) ==
            own.end())
            continue;
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            std::uint32_t& v = renamed[mesh.corner_vertices[c]];
            if (v == prep::no_index) {
                v = std::uint32_t(out.positions.size());
                out.positions.push_back(mesh.positions[mesh.corner_vertices[c]]);
            }
            out.corner_vertices.push_back(v);
            out.uvs[0].indices.push_back(mesh.uvs[0].indices[c]);
        }
        out.face_offsets.push_back(std::uint32_t(out.corner_vertices.size()));
    }
    out.subdivision.interpolate_boundary = mesh.subdivision.interpolate_boundary;
    for (const prep::EdgeMark& mark : mesh.subdivision.creases)
        if (renamed[mark.v0] != prep::no_index && renamed[mark.v1] != prep::no_index)
            out.subdivision.creases.push_back({renamed[mark.v0], renamed[mark.v1], mark.sharpness});
    return piece;
}

// `count` faces, evenly, of those with a vertex on a semi-sharp edge.
std::vector<Cage> pieces_at_creases(const Cage& cage, std::size_t count) {
    std::vector<bool> semi_sharp(cage.mesh.vertex_count());
    for (const prep::EdgeMark& mark : cage.mesh.subdivision.creases)
        if (mark.sharpness < 10) semi_sharp[mark.v0] = semi_sharp[mark.v1] = true;
    std::vector<std::uint32_t> faces;
    for (std::uint32_t f = 0; f < cage.mesh.face_count(); ++f)
        for (std::uint32_t c = cage.mesh.face_offsets[f]; c < cage.mesh.face_offsets[f + 1]; ++c)
            if (semi_sharp[cage.mesh.corner_vertices[c]]) {
                faces.push_back(f);
                break;
            }
    std::vector<Cage> pieces;
    for (std::size_t k = 0; k < count; ++k)
        pieces.push_back(piece_of(cage, faces[k * faces.size() / count]));
    return pieces;
}

// Where sharpness wears off at a level that the whole cage cannot be compared at, limits are those
// of pieces of it. Cages of many faces, and limits at levels above 6 (of catmark_rook, half a
// million faces), are compared under one rule, and with MESHPREP_LONG_TESTS=1 under all.
TEST(SubdivideFaceVarying, SixRulesAreOpenSubdivsOnTheCorpus) {
    MESHPREP_REQUIRE_SHARED(shared);
    std::size_t with_uvs = 0;
    std::printf("%-26s largest difference of UVs at level 4, six rules: control points | limits\n",
                "shape");
    for (const std::string& name : test::corpus_cage_names(shared)) {
        SCOPED_TRACE(name);
        const Cage cage = test::corpus_cage(shared, name);
        if (cage.mesh.uvs.empty()) continue;
        ++with_uvs;
        std::printf("%-26s", name.c_str());
        for (const bool limit : {false, true}) {
            for (const FaceVaryingRule rule : every_rule) {
                const int settled = settled_level(cage, 4);
                const bool large = cage.mesh.face_count() > 1000 || (limit && settled > 6);
                if (large && rule != FaceVaryingRule::corners_only &&
                    !std::getenv("MESHPREP_LONG_TESTS"))
                    continue;
                SCOPED_TRACE(std::string(prep::name_of(rule)) + (limit ? " limits" : " control"));
                std::vector<Cage> pieces;
                if (limit && (cage.mesh.face_count() << (2 * settled)) > 500000)
                    pieces = pieces_at_creases(cage, settled > 6 ? 1 : 4);
                else
                    pieces.push_back(cage);
                double largest = 0;
                for (const Cage& piece : pieces) {
                    SCOPED_TRACE(piece.name);
                    const Difference d = difference(piece, 0, rule, 4, limit);
                    largest = std::max(largest, d.uv);
                    EXPECT_GT(d.corners, 0U);
                    EXPECT_LE(d.uv, 1e-6);
                    EXPECT_EQ(d.unmatched, 0U);
                }
                std::printf(" %.0e", largest);
            }
            std::printf(limit ? "\n" : " |");
        }
    }
    EXPECT_EQ(with_uvs, 18U);  // all but the two poles
}

// Chaikin's averages are of the creases that meet at a vertex of the mesh: so they are in Far. Ours
// are of those that meet at a value of the channel, to which an edge with a seam along it is a
// border. The two differ where such an edge is semi-sharp and meets others, and nowhere else.
TEST(SubdivideFaceVarying, ChaikinsAveragesDifferAtSemiSharpSeamsAlone) {
    for (Cage& cage : test::own_cages()) {
        if (cage.name != "cube_chaikin") continue;
        prep::Mesh other = cage.mesh;
        other.subdivision.creases.clear();
        // Around the bottom, none of them on the seam; then along it.
        for (const std::uint32_t c : {0U, 1U, 2U, 3U})
            other.subdivision.creases.push_back({other.corner_vertices[c],
                                                 other.corner_vertices[(c + 1) % 4],
                                                 0.7F + 0.9F * float(c)});
        for (const bool seam_on_crease : {false, true}) {
            Cage one = cage;
            one.mesh = other;
            add_uvs(one.mesh, {seam_on_crease ? 0U : 1U});
            double largest = 0;
            for (const FaceVaryingRule rule : every_rule)
                for (const bool limit : {false, true})
                    largest = std::max(largest, difference(one, 0, rule, 3, limit).uv);
            std::printf("UVs differ by %.1e of their extent, seam on crease: %d\n", largest,
                        seam_on_crease);
            if (seam_on_crease) {
                EXPECT_LE(largest, 1e-2);
            } else {
                EXPECT_LE(largest, 1e-6);
            }
        }
        // Of several creases at a vertex, some on the seam and some not.
        other.subdivision.creases.clear();
        for (std::uint32_t c = 0; c < other.corner_count(); ++c)
            if (const std::uint32_t v0 = other.corner_vertices[c],
                v1 = other.corner_vertices[c % 4 == 3 ? c - 3 : c + 1];
                v0 < v1)
                other.subdivision.creases.push_back({v0, v1, 0.4F + 0.3F * float(c % 7)});
        Cage mixed = cage;
        mixed.mesh = other;
        add_uvs(mixed.mesh, {0, 2});
        double largest = 0;
        for (const FaceVaryingRule rule : every_rule)
            for (const bool limit : {false, true})
                largest = std::max(largest, difference(mixed, 0, rule, 3, limit).uv);
        std::printf("UVs differ by %.1e of their extent\n", largest);
        EXPECT_GT(largest, 1e-6);
        EXPECT_LE(largest, 1e-2);
    }
}

// Faces that use the same few values in different places are apart all the same.
TEST(SubdivideFaceVarying, ValuesSharedByFarFacesJoinNothing) {
    Cage cage{"cube", shapes::cube(), {}};
    prep::CornerLayer<glm::vec2> layer;
    layer.values = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (std::uint32_t c = 0; c < cage.mesh.corner_count(); ++c) layer.indices.push_back(c % 4);
    cage.mesh.uvs.push_back(layer);
    for (const FaceVaryingRule rule : every_rule)
        for (const bool limit : {false, true}) {
            SCOPED_TRACE(prep::name_of(rule));
            EXPECT_LE(difference(cage, 0, rule, 3, limit).uv, 1e-6);
        }
}

}  // namespace
