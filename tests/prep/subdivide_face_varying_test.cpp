// UVs under OpenSubdiv's six face-varying rules, against Far's own values in double, at every
// corner of level 4: refined values where control points are written, limits where limits are.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
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
    std::map<std::pair<std::uint32_t, std::uint32_t>, float> creases;  // the last mark counts
    for (const prep::EdgeMark& mark : mesh.subdivision.creases)
        creases[std::minmax(mark.v0, mark.v1)] = mark.sharpness;
    for (const auto& [edge, sharpness] : creases)
        if (sharpness >= 10) ++sharp[edge.first], ++sharp[edge.second];
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

// The largest difference under all rules; control points and limits.
double largest_difference(const Cage& cage, std::size_t set, int level) {
    double largest = 0;
    for (const FaceVaryingRule rule : every_rule)
        for (const bool limit : {false, true}) {
            SCOPED_TRACE(cage.name + " " + std::string(prep::name_of(rule)) +
                         (limit ? " limits" : " control points") + ", set " + std::to_string(set));
            const Difference d = difference(cage, set, rule, level, limit);
            EXPECT_GT(d.corners, 0U);
            EXPECT_EQ(d.unmatched, 0U);
            EXPECT_LE(d.uv, 1e-6);
            largest = std::max(largest, d.uv);
        }
    return largest;
}

// Gives edges a sharpness of many: each with a chance of share / 5.
void crease_some_edges(prep::Mesh& mesh, std::uint32_t share, std::mt19937_64& random) {
    const auto sharpness = [&] { return 0.25F + float(random() % 11) / 4; };
    mesh.subdivision.creases.clear();
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const std::uint32_t to =
                c + 1 == mesh.face_offsets[f + 1] ? mesh.face_offsets[f] : c + 1;
            if (random() % 5 < share)
                mesh.subdivision.creases.push_back(
                    {mesh.corner_vertices[c], mesh.corner_vertices[to], sharpness()});
        }
    mesh.subdivision.corners.clear();
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
        if (random() % 3 == 0) mesh.subdivision.corners.push_back({v, sharpness()});
}

// Chaikin's averages are of the creases that meet at a vertex of the mesh, on both sides of a seam
// and along it: to the UVs of one side some of these edges are borders, or not there. Under the
// rules corners-plus1 and -plus2 one side is sharp because the other is. Each way of creasing with
// one share of edges; with MESHPREP_LONG_TESTS=1, with both.
TEST(SubdivideFaceVarying, CreasesOfEverySharpnessAtSeamsOfEveryKind) {
    const bool long_tests = std::getenv("MESHPREP_LONG_TESTS") != nullptr;
    std::mt19937_64 random(15);
    double largest = 0;
    std::size_t cages = 0;
    for (const Cage& given : cages_with_seams())
        for (const prep::CreasingMethod creasing :
             {prep::CreasingMethod::uniform, prep::CreasingMethod::chaikin})
            for (const std::uint32_t share : {2U, 5U}) {
                const bool uniform = creasing == prep::CreasingMethod::uniform;
                if (!long_tests && uniform != (share == 2)) continue;
                Cage cage = given;
                if (cage.options.scheme == prep::SubdivisionScheme::bilinear) continue;
                cage.options.creasing = creasing;
                cage.name += uniform ? " uniform" : " chaikin";
                crease_some_edges(cage.mesh, share, random);
                for (const std::size_t set : {0U, 1U})
                    largest = std::max(largest, largest_difference(cage, set, 2));
                ++cages;
            }
    std::printf("UVs of %zu cages differ by %.1e of their extent\n", cages, largest);
    EXPECT_EQ(cages, long_tests ? 48U : 24U);
}

// Two faces on each side of a seam, with a crease on one side: the other is sharp as long as it is,
// to the last step where an edge on the seam is sharp longer; at a vertex that is sharp itself it
// is so by that alone.
TEST(SubdivideFaceVarying, SharpnessOfTheOtherSideOfASeam) {
    Cage cage{"grid", shapes::grid(2, 2), {}};
    prep::Mesh& mesh = cage.mesh;
    constexpr std::uint32_t centre = 4, right = 5, above = 7;
    for (glm::vec3& p : mesh.positions) p -= glm::vec3(1, 1, 0);
    mesh.positions[centre].y += 0.3F;
    add_two_islands(mesh);
    for (const float on_seam : {0.0F, 1.75F, 2.5F})
        for (const float own : {0.0F, 0.5F, 2.5F}) {
            mesh.subdivision.creases = {{centre, right, 1.75F}, {centre, above, on_seam}};
            mesh.subdivision.corners = {{centre, own}};
            EXPECT_LE(largest_difference(cage, 0, 3), 1e-6) << on_seam << ", " << own;
        }
}

// Islands of random faces, some of them apart at single corners too.
void add_random_islands(prep::Mesh& mesh, std::mt19937_64& random) {
    prep::CornerLayer<glm::vec2> layer;
    const std::uint32_t islands = 1 + std::uint32_t(random() % 4);
    const bool tears = random() % 2 == 0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const auto island = std::uint32_t(random() % islands);
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const std::uint32_t v = mesh.corner_vertices[c];
            const std::uint32_t side = tears && random() % 8 == 0 ? 4 + c : island;
            const auto [at, fresh] =
                known.try_emplace({v, side}, std::uint32_t(layer.values.size()));
            if (fresh) {
                const glm::vec3 p = mesh.positions[v];
                layer.values.push_back(glm::vec2(p.x - 0.2F * p.z, p.y + 0.3F * p.z) +
                                       glm::vec2(float(side), 0.5F * float(v % 7)));
            }
            layer.indices.push_back(at->second);
        }
    }
    mesh.uvs.push_back(std::move(layer));
}

// A few cages; many with MESHPREP_LONG_TESTS=1.
TEST(SubdivideFaceVarying, RandomSeamsOnRandomCages) {
    const bool long_tests = std::getenv("MESHPREP_LONG_TESTS") != nullptr;
    double largest = 0;
    std::size_t cages = 0;
    for (std::uint64_t seed = 80; seed < (long_tests ? 200 : 96); ++seed) {
        std::mt19937_64 random(seed);
        Cage cage = test::random_cage(random);
        if (cage.options.scheme == prep::SubdivisionScheme::bilinear) continue;
        cage.name = "seed " + std::to_string(seed);
        const auto lowered = [](float sharpness) {
            return sharpness < 10 ? std::fmod(sharpness, 3.0F) : sharpness;
        };
        for (prep::EdgeMark& mark : cage.mesh.subdivision.creases)
            mark.sharpness = lowered(mark.sharpness);
        for (prep::VertexMark& mark : cage.mesh.subdivision.corners)
            mark.sharpness = lowered(mark.sharpness);
        for (std::uint32_t v = 0; v < cage.mesh.vertex_count(); ++v)
            if (seed % 3 == 0 && random() % 2 == 0)
                cage.mesh.subdivision.corners.push_back({v, float(random() % 24) / 8});
        add_random_islands(cage.mesh, random);
        const auto refined = prep::subdivide(cage.mesh, cage.options);
        ASSERT_TRUE(refined) << refined.error().text;
        if (refined->mesh.face_count() == 0) continue;  // a border at every face, without a rule
        largest = std::max(largest, largest_difference(cage, 0, 3));
        ++cages;
    }
    std::printf("UVs of %zu cages differ by %.1e of their extent\n", cages, largest);
    EXPECT_GT(cages, long_tests ? 50U : 5U);
}

constexpr std::uint32_t strip_length = 6000;

// Four quads wide, with a crease along its middle that would be 70 million faces if it were cut.
Cage strip_with_long_crease() {
    Cage cage{"strip", shapes::grid(strip_length, 4), {}};
    cage.options.level = 1;
    for (std::uint32_t x = 0; x < strip_length; ++x) {
        const std::uint32_t v = 2 * (strip_length + 1) + x;
        cage.mesh.subdivision.creases.push_back({v, v + 1, 9.75F});
    }
    return cage;
}

// UVs of islands: a face's is `island(x, y)`.
template <class Island>
void add_islands(prep::Mesh& mesh, const Island& island) {
    prep::CornerLayer<glm::vec2> layer;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) {
            const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
            layer.indices.push_back(std::uint32_t(layer.values.size()));
            layer.values.push_back(glm::vec2(p.x + p.y + p.z, 0.3F * p.x + p.y) +
                                   glm::vec2(float(island(f % strip_length, f / strip_length))));
        }
    mesh.uvs.push_back(std::move(layer));
}

// One vertex of a seam, far from most of a long crease, is not what the crease is cut for.
TEST(SubdivideFaceVarying, LongCreasesAreCutAtSeamsAlone) {
    Cage cage = strip_with_long_crease();
    add_islands(cage.mesh, [](std::uint32_t x, std::uint32_t) { return x < 10 ? 0 : 7; });
    const std::uint32_t v = (strip_length + 1) + 10;  // on the seam
    cage.mesh.subdivision.creases.push_back({v, v + 1, 1.5F});
    cage.mesh.subdivision.creases.push_back({v, v - (strip_length + 1), 2.5F});
    cage.options.face_varying = FaceVaryingRule::corners_plus1;
    const auto refined = prep::subdivide(cage.mesh, cage.options);
    ASSERT_TRUE(refined) << refined.error().text;
    EXPECT_EQ(refined->approximate_seams, 0U);
    EXPECT_LE(difference(cage, 0, FaceVaryingRule::corners_plus1, 1, false).uv, 1e-6);
}

// Where the seam runs beside the crease, UVs are refined as a cage of their own, and that is told.
TEST(SubdivideFaceVarying, TooLongCreasesBesideSeamsAreToldAndRefined) {
    Cage cage = strip_with_long_crease();
    add_islands(cage.mesh, [](std::uint32_t, std::uint32_t y) { return y < 1 ? 0 : 7; });
    cage.options.face_varying = FaceVaryingRule::corners_plus1;
    const auto alike = prep::subdivide(cage.mesh, cage.options);
    ASSERT_TRUE(alike) << alike.error().text;
    EXPECT_EQ(alike->approximate_seams, 0U);
    const std::uint32_t v = (strip_length + 1) + 10;  // on the seam
    cage.mesh.subdivision.creases.push_back({v, v - (strip_length + 1), 1.5F});
    cage.mesh.subdivision.creases.push_back({v, v + 1, 2.5F});
    const auto refined = prep::subdivide(cage.mesh, cage.options);
    ASSERT_TRUE(refined) << refined.error().text;
    EXPECT_EQ(refined->approximate_seams, 1U);
    // Far from that vertex nothing is different.
    ASSERT_EQ(refined->mesh.corner_count(), alike->mesh.corner_count());
    const auto at = [](const prep::Mesh& mesh, std::uint32_t c) {
        return mesh.uvs[0].values[mesh.uvs[0].indices[c]];
    };
    for (std::uint32_t f = 0; f < refined->mesh.face_count(); ++f)
        for (std::uint32_t c = 4 * f; c < 4 * f + 4; ++c) {
            if (refined->cage_faces[f] % strip_length <= 20) continue;
            ASSERT_EQ(at(refined->mesh, c), at(alike->mesh, c)) << f;
        }
}

// A cage of its own is bounded too: the error says of what.
TEST(SubdivideFaceVarying, CreasesThatSeamsCutTooOftenAreNamed) {
    Cage cage = strip_with_long_crease();
    add_islands(cage.mesh, [](std::uint32_t, std::uint32_t) { return 0; });
    add_islands(cage.mesh, [](std::uint32_t x, std::uint32_t) { return x % 2; });
    cage.mesh.name = "road";
    const auto refused = prep::subdivide(cage.mesh, cage.options);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, prep::ErrorCode::limit);
    EXPECT_EQ(refused.error().place, "mesh 'road', UV set 1") << refused.error().text;
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
