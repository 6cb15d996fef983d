// Corner normals of every precision against the true ones, on every hard case.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <random>

#include "hard_cases.h"
#include "normal_oracle.h"
#include "prep/corner_normals.h"
#include "shapes.h"

namespace {

using prep::CornerNormals;
using prep::Mesh;
using prep::MeshView;
using prep::NormalWeight;
using prep::Precision;

constexpr double degrees = 180 / 3.141592653589793;
// Rounding three components of a unit vector to float: √3 · 2⁻²⁵ (half an ulp below 1), and the
// oracle's own conversion.
constexpr double rounding = 5.2e-8;

double bound_of(Precision precision) {
    return precision == Precision::fast       ? prep::fast_normal_error
           : precision == Precision::accurate ? prep::accurate_normal_error
                                              : prep::exact_normal_error;
}

CornerNormals normals_of(const Mesh& mesh, NormalWeight weight, Precision precision) {
    const MeshView view(mesh);
    const prep::Topology topology = prep::build_topology(view);
    const prep::FaceNormals faces = prep::face_normals(view, precision);
    prep::HardEdgeOptions edges;
    edges.angle_degrees.reset();
    const auto hard = prep::hard_edges(view, topology, faces, edges);
    prep::NormalOptions options;
    options.weight = weight;
    options.precision = precision;
    options.keep_doubles = true;
    return *prep::corner_normals(view, topology, faces, *hard, options);
}

// Corners by fan; some dozens of them, and always the largest.
std::vector<std::vector<std::uint32_t>> fans_of(const CornerNormals& normals) {
    std::vector<std::vector<std::uint32_t>> fans(normals.normals.values.size());
    for (std::uint32_t c = 0; c < normals.normals.indices.size(); ++c)
        fans[normals.normals.indices[c]].push_back(c);
    const std::size_t stride = 1 + fans.size() / 40;
    std::size_t largest = 0;
    for (std::size_t i = 0; i < fans.size(); ++i)
        if (fans[i].size() > fans[largest].size()) largest = i;
    for (std::size_t i = 0; i < fans.size(); ++i)
        if (i % stride != 0 && i != largest) fans[i].clear();
    return fans;
}

struct Worst {
    double before = 0, after = 0;  // of rounding to float
    int undetermined = 0;
};

class Stability : public testing::Test {
  protected:
    // Holds one mesh against the truth, for all weights and precisions.
    void check(const hard_cases::Case& hard_case) {
        SCOPED_TRACE(hard_case.axis + " " + std::to_string(hard_case.value));
        const exact::NormalOracle oracle(hard_case.mesh);
        const auto fans =
            fans_of(normals_of(hard_case.mesh, NormalWeight::area, Precision::accurate));
        std::vector<std::array<exact::NormalSum, exact::weight_count>> truths(fans.size());
        std::vector<char> has_angles(fans.size());
        for (std::size_t i = 0; i < fans.size(); ++i) {
            has_angles[i] = fans[i].size() <= 30;
            if (!fans[i].empty()) truths[i] = oracle.sums(fans[i], has_angles[i]);
        }
        for (const Precision precision : {Precision::fast, Precision::accurate, Precision::exact}) {
            const bool slow = precision == Precision::exact;
            if (slow && fans.size() > 2000) continue;  // seconds of rationals
            Worst worst;
            for (std::size_t w = 0; w < exact::weight_count; ++w) {
                // One weight that is rational and one that is not.
                if (slow && NormalWeight(w) != NormalWeight::area &&
                    NormalWeight(w) != NormalWeight::angle)
                    continue;
                const CornerNormals normals =
                    normals_of(hard_case.mesh, NormalWeight(w), precision);
                ASSERT_EQ(normals.normals.values.size(), fans.size());
                const bool by_angle = NormalWeight(w) == NormalWeight::angle ||
                                      NormalWeight(w) == NormalWeight::area_angle;
                for (std::size_t i = 0; i < fans.size(); ++i) {
                    const glm::vec3 value = normals.normals.values[i];
                    EXPECT_NEAR(glm::length(glm::dvec3(value)), 1.0, 1e-7);
                    if (fans[i].empty() || (by_angle && !has_angles[i])) continue;
                    const exact::NormalSum& truth = truths[i][w];
                    const bool flagged =
                        std::any_of(normals.fallbacks.begin(), normals.fallbacks.end(),
                                    [&](const auto& f) { return f.corner == fans[i].front(); });
                    EXPECT_EQ(flagged, !truth.determined) << "weight " << w << " fan " << i;
                    if (!truth.determined) {
                        ++worst.undetermined;
                        continue;
                    }
                    worst.before =
                        std::max(worst.before, exact::angle_between(truth, normals.doubles[i]));
                    worst.after =
                        std::max(worst.after, exact::angle_between(truth, glm::dvec3(value)));
                }
            }
            EXPECT_LE(worst.before, bound_of(precision)) << int(precision);
            EXPECT_LE(worst.after, bound_of(precision) + rounding) << int(precision);
            static constexpr const char* names[] = {"fast", "accurate", "exact"};
            std::cout << std::left << std::setw(16) << hard_case.axis << std::setw(9)
                      << hard_case.value << std::setw(9) << names[int(precision)]
                      << std::setprecision(2) << std::setw(9) << worst.before * degrees
                      << std::setw(9) << worst.after * degrees << worst.undetermined
                      << " undetermined\n";
        }
    }

    void check_axis(const std::string& axis) {
        int found = 0;
        for (const hard_cases::Case& c : hard_cases::measured())
            if (c.axis.starts_with(axis)) {
                check(c);
                ++found;
            }
        EXPECT_GT(found, 5);
    }
};

TEST_F(Stability, Scales) {
    check_axis("scale");
}
TEST_F(Stability, Offsets) {
    check_axis("offset");
}
TEST_F(Stability, AspectRatios) {
    check_axis("aspect");
}
TEST_F(Stability, Valences) {
    check_axis("valence");
}
TEST_F(Stability, CancellingSums) {
    check_axis("thickness");
}

// A polygon with a slit that ends at (1, 1, 1): doubles cannot tell its sides apart where it is
// narrow, and the angle there is nearly a whole turn.
TEST_F(Stability, SlitsOfPolygons) {
    for (const float width : {1e-3f, 1e-10f, 1e-16f, 1e-17f, 1e-20f, 1e-30f})
        check({"slit", width,
               shapes::mesh_of({{1, 1, 1},
                                {width, -width, 0},
                                {3, -3, 0},
                                {7, 1, 4},
                                {1, 7, 4},
                                {-3, 3, 0},
                                {-width, width, 0},
                                {0, 0, 5}},
                               {{0, 1, 2, 3, 4, 5, 6}, {1, 0, 7}})});
}

// Quads with a corner whose plane is at right angles to the face's, exactly: it is convex, and the
// whole numbers say so.
TEST_F(Stability, CornersAtRightAnglesToTheirQuads) {
    std::mt19937_64 random(5);
    const auto whole = [&](int most) { return int(random() % (2 * most + 1)) - most; };
    int found = 0;
    while (found < 60) {
        // The corner at the origin has the edges a and b; the area vector is c × (b − a) for the
        // point c between them.
        const glm::dvec3 a(whole(3), whole(3), whole(3)), b(whole(3), whole(3), whole(3));
        const glm::dvec3 turn = glm::cross(a, b), d = glm::cross(b - a, turn);
        // It is at right angles to a × b where c is to d.
        const glm::dvec3 any(whole(3), whole(3), whole(3));
        const glm::dvec3 c = any * glm::dot(d, d) - d * glm::dot(any, d);
        if (turn == glm::dvec3(0.0) || glm::dot(glm::cross(c, b - a), turn) != 0) continue;
        if (glm::length(c) > 0x1p23 || glm::cross(c, b - a) == glm::dvec3(0.0)) continue;
        ++found;
        check({"right angle", double(found),
               shapes::mesh_of({{0, 0, 0},
                                glm::vec3(a),
                                glm::vec3(c),
                                glm::vec3(b),
                                glm::vec3(whole(9), whole(9), whole(9) + 20)},
                               {{0, 1, 2, 3}, {1, 0, 4}})});
    }
}

// Quads of which every point has a scale of its own.
TEST_F(Stability, QuadsOfManyScales) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> place(-0.3, 0.3), power(-30, 18);
    for (int k = 0; k < 150; ++k) {
        Mesh mesh = shapes::grid(3, 3);
        for (glm::vec3& p : mesh.positions) {
            const double scale = std::pow(10, power(random));
            p = glm::vec3(scale * (glm::dvec3(p) +
                                   glm::dvec3(place(random), place(random), 3 * place(random))));
        }
        check({"mixed quads", double(k), std::move(mesh)});
    }
}

// The case without the faces that have a position that is not finite, and the corners it keeps.
Mesh finite_part(const Mesh& mesh, std::vector<std::uint32_t>& corners) {
    const auto finite = [&](std::uint32_t v) {
        const glm::vec3& p = mesh.positions[v];
        return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    };
    Mesh part;
    part.positions = mesh.positions;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
        if (!finite(v)) part.positions[v] = {};
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        bool keep = true;
        for (std::uint32_t c = begin; c < end; ++c) keep = keep && finite(mesh.corner_vertices[c]);
        if (!keep) continue;
        for (std::uint32_t c = begin; c < end; ++c) {
            part.corner_vertices.push_back(mesh.corner_vertices[c]);
            corners.push_back(c);
        }
        part.face_offsets.push_back(std::uint32_t(part.corner_vertices.size()));
    }
    return part;
}

TEST_F(Stability, OddMeshes) {
    for (const hard_cases::Case& c : hard_cases::odd()) {
        std::vector<std::uint32_t> corners;
        const Mesh part = finite_part(c.mesh, corners);
        // The pole: CornerNormals.PoleOfHundredThousandFaces, and Valences holds as many to the
        // truth.
        if (c.mesh.corner_count() <= 100'000) check({c.axis, c.value, part});
        // What is not finite harms no other face.
        for (const Precision precision : {Precision::fast, Precision::accurate}) {
            const auto whole = normals_of(c.mesh, NormalWeight::area, precision).normals;
            const auto expected = normals_of(part, NormalWeight::area, precision).normals;
            for (std::size_t i = 0; i < corners.size(); ++i)
                ASSERT_EQ(whole.values[whole.indices[corners[i]]],
                          expected.values[expected.indices[i]])
                    << c.axis;
            for (const glm::vec3& n : whole.values)
                ASSERT_NEAR(glm::length(glm::dvec3(n)), 1.0, 1e-7) << c.axis;
        }
    }
}

}  // namespace
