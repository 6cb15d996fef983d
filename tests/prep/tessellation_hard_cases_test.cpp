// Hard and odd meshes: an error or a mesh without tears, never a crash or a hang.
#include <gtest/gtest.h>

#include "hard_cases.h"
#include "prep/displacement/tessellate.h"
#include "sanitized.h"
#include "tessellation/limit/limit_base.h"
#include "tessellation/tessellation.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;

double extent(const Mesh& mesh) {
    glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    return mesh.positions.empty() ? 1 : std::max(glm::length(high - low), 1e-40);
}

// How often each pair of vertices is an edge, by how many faces: both must be that of the cage's
// edges along which they lie. So: the lengths of edges of one, two, three, … faces.
std::map<int, double> edge_lengths(const Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t first = mesh.face_offsets[f], n = mesh.face_offsets[f + 1] - first;
        for (std::uint32_t k = 0; k < n; ++k) {
            const std::uint32_t a = mesh.corner_vertices[first + k];
            const std::uint32_t b = mesh.corner_vertices[first + (k + 1) % n];
            if (a != b) ++edges[std::minmax(a, b)];
        }
    }
    std::map<int, double> lengths;
    for (const auto& [edge, faces] : edges)
        lengths[faces] += glm::length(glm::dvec3(mesh.positions[edge.first]) -
                                      glm::dvec3(mesh.positions[edge.second]));
    return lengths;
}

TEST(TessellationHardCases, BordersAndEdgesOfManyFacesStayWhatTheyAre) {
    Mesh book;  // five pages at one edge, one of them turned the other way
    book.positions = {{0, 0, 0}, {0, 0, 1}};
    for (std::uint32_t k = 0; k < 5; ++k) {
        const double a = k;
        book.positions.emplace_back(std::cos(a), std::sin(a), 1);
        book.positions.emplace_back(std::cos(a), std::sin(a), 0);
        const std::uint32_t v = 2 + 2 * k;
        if (k == 3)
            add_face(book, {v + 1, v, 1, 0});
        else
            add_face(book, {0, 1, v, v + 1});
    }
    Mesh moebius;
    constexpr std::uint32_t n = 7;
    for (std::uint32_t k = 0; k < n; ++k) {
        const double a = 2 * std::numbers::pi * k / n;
        for (const double side : {-0.4, 0.4}) {
            const double r = 2 + side * std::cos(a / 2);
            moebius.positions.emplace_back(r * std::cos(a), r * std::sin(a),
                                           side * std::sin(a / 2));
        }
    }
    for (std::uint32_t k = 0; k + 1 < n; ++k)
        add_face(moebius, {2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1});
    add_face(moebius, {2 * n - 2, 1, 0, 2 * n - 1});
    Mesh concave;  // an L, and a star whose mean of corners is no kernel point
    concave.positions = {{0, 0, 0}, {4, 0, 0}, {4, 0.2, 0}, {0.2, 0.2, 0}, {0.2, 4, 0}, {0, 4, 0}};
    add_face(concave, {0, 1, 2, 3, 4, 5});
    for (const Mesh& mesh : {book, moebius, concave}) {
        TessellateOptions options;
        options.edge_length = 0.13;
        const auto made = tessellate(mesh, options);
        ASSERT_TRUE(made) << to_string(made.error());
        const auto before = edge_lengths(mesh), after = edge_lengths(made->mesh);
        for (const auto& [faces, length] : after) {
            if (faces == 2) continue;
            ASSERT_TRUE(before.contains(faces)) << faces;
            EXPECT_NEAR(length, before.at(faces), 1e-5 * length) << faces;
        }
        for (const auto& [faces, length] : before)
            EXPECT_TRUE(faces == 2 || after.contains(faces)) << faces;
    }
    // Triangles of the concave one lie in it: areas add up.
    TessellateOptions options;
    options.chord_error = 0.1;
    const auto made = tessellate(concave, options);
    ASSERT_TRUE(made);
    double area = 0;
    const Mesh& out = made->mesh;
    for (std::size_t t = 0; t < out.face_count(); ++t) {
        const auto at = [&](std::size_t k) {
            return glm::dvec3(out.positions[out.corner_vertices[3 * t + k]]);
        };
        const double twice = glm::cross(at(1) - at(0), at(2) - at(0)).z;
        EXPECT_GT(twice, 0);
        area += twice / 2;
    }
    EXPECT_NEAR(area, 4 * 0.2 + 3.8 * 0.2, 1e-5);
}

// The mean of its corners is the notch of an L of width 1 and arms of 2: on the lines of two edges.
TEST(TessellationHardCases, AReflexCornerAtTheMeanCollapsesNothing) {
    for (const float notch : {1.0F, 1.0001F, 0.9999F, 1.01F, 0.97F, 1.2F}) {
        Mesh mesh;
        mesh.positions = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {notch, notch, 0}, {1, 2, 0}, {0, 2, 0}};
        add_face(mesh, {0, 1, 2, 3, 4, 5});
        TessellateOptions options;
        options.edge_length = 0.4;
        const auto made = tessellate(mesh, options);
        ASSERT_TRUE(made) << to_string(made.error());
        const Mesh& out = made->mesh;
        double area = 0;
        for (std::size_t t = 0; t < out.face_count(); ++t) {
            const auto at = [&](std::size_t k) {
                return glm::dvec3(out.positions[out.corner_vertices[3 * t + k]]);
            };
            const double twice = glm::cross(at(1) - at(0), at(2) - at(0)).z;
            EXPECT_GT(twice, 0.01) << notch;
            area += twice / 2;
        }
        // The square of the corner, and two triangles on each arm's inner edge.
        EXPECT_NEAR(area, 2 + double(notch), 1e-5) << notch;
    }
}

// Where no error is left none of a budget is spent, however much rounding the proof allows for.
TEST(TessellationHardCases, AFlatSurfaceTakesNoBudget) {
    Image image{2, 2, 1, {0.75F, 0.75F, 0.75F, 0.75F}};
    image.floating = true;
    const auto height = height_function(image, HeightMapOptions{});
    ASSERT_TRUE(height) << to_string(height.error());
    for (const bool displaced : {false, true})
        for (const bool cage : {false, true}) {
            TessellateOptions options;
            options.max_triangles = 5000;
            if (displaced) options.displacements = {{*height, 1, 0, 0}};
            if (cage) options.scheme = SubdivisionScheme::bilinear;
            const auto made = tessellate(unit_quad(), options);
            ASSERT_TRUE(made) << to_string(made.error());
            EXPECT_LE(made->mesh.face_count(), 4U) << displaced << cage;
        }
}

// More sides at a vertex than are compared one by one: what each face has stays its own, and equal
// values stay one.
TEST(TessellationHardCases, AVertexOfManySeamsKeepsWhatEachFaceHas) {
    constexpr std::uint32_t n = 200;
    Mesh mesh;
    mesh.positions.emplace_back(0, 0, 1);
    for (std::uint32_t k = 0; k < 2 * n; ++k) {
        const double a = std::numbers::pi * k / n;
        mesh.positions.emplace_back(std::cos(a), std::sin(a), k % 2 == 0 ? 0.2 : 0.1);
    }
    mesh.uvs.resize(1);
    std::set<std::pair<float, float>> at_apex;
    for (std::uint32_t k = 0; k < n; ++k) {
        add_face(mesh, {0, 1 + 2 * k, 2 + 2 * k, 1 + (2 * k + 2) % (2 * n)});
        mesh.hard_marks.emplace_back(0, 1 + 2 * k);
        // Every third face has the UV of the one before.
        const auto place = float(k % 3 == 2 ? k - 1 : k);
        at_apex.insert({place, 0.0F});
        for (const glm::vec2& uv :
             {glm::vec2(place, k % 2 == 0 ? 0.0F : -0.0F), glm::vec2(place + 0.1F, 1),
              glm::vec2(place + 0.2F, 2), glm::vec2(place + 0.3F, 3)}) {
            mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
            mesh.uvs[0].values.push_back(uv);
        }
    }
    TessellateOptions options;
    options.max_triangles = 1;
    const auto made = tessellate(mesh, options);
    ASSERT_TRUE(made) << to_string(made.error());
    ASSERT_EQ(made->mesh.face_count(), 2 * n);
    std::set<std::uint32_t> uvs, normals;
    std::size_t corners = 0;
    for (std::size_t c = 0; c < made->mesh.corner_count(); ++c) {
        const std::uint32_t v = made->cage_vertices[made->mesh.corner_vertices[c]];
        if (v != 0) continue;
        ++corners;
        const std::uint32_t f = made->cage_faces[c / 3];
        const std::uint32_t uv = made->mesh.uvs[0].indices[c];
        EXPECT_EQ(made->mesh.uvs[0].values[uv], mesh.uvs[0].values[4 * f]);
        uvs.insert(uv);
        normals.insert(made->mesh.normals.indices[c]);
        // Of its own face: across both diagonals (Newell).
        const auto at = [&](std::uint32_t k) {
            return glm::dvec3(mesh.positions[mesh.corner_vertices[4 * f + k]]);
        };
        const glm::dvec3 side(made->mesh.normals.values[made->mesh.normals.indices[c]]);
        EXPECT_GT(glm::dot(side, glm::normalize(glm::cross(at(2) - at(0), at(3) - at(1)))),
                  0.999999);
    }
    EXPECT_EQ(corners, n);  // diagonals are across, where faces are narrow
    EXPECT_EQ(uvs.size(), at_apex.size());
    EXPECT_EQ(normals.size(), n);
}

TEST(TessellationHardCases, EveryCaseGivesAMeshOrAnError) {
    std::uint64_t done = 0, refused = 0;
    std::vector<hard_cases::Case> cases;
    std::size_t number = 0;
    for (auto& measured : hard_cases::measured())
        if (number++ % (::test::sanitized ? 48 : 4) == 0) cases.push_back(std::move(measured));
    for (auto& odd : hard_cases::odd()) cases.push_back(std::move(odd));
    for (const auto& hard_case : cases) {
        if (hard_case.mesh.face_count() > 250) continue;
        const Mesh mesh = hard_cases::with_uvs(hard_case.mesh);
        const double size = extent(mesh);
        if (!std::isfinite(size)) continue;
        for (const bool limit : {false, true})
            for (const bool budget : {false, true}) {
                if (limit && budget) continue;
                SCOPED_TRACE(hard_case.axis + " " + std::to_string(hard_case.value));
                TessellateOptions options;
                if (limit) options.scheme = SubdivisionScheme::catmark;
                if (budget)
                    options.max_triangles = 4 * mesh.corner_count() + 200;
                else
                    options.chord_error = 0.02 * size;
                options.displacements = {{std::make_shared<Waves>(1, 3, 2), 0.05 * size, 0, 0}};
                options.triangle_limit = 30000;
                options.samples = ::test::sanitized ? 100 : 500;
                const auto made = tessellate(mesh, options);
                if (!made) {
                    ++refused;
                    EXPECT_FALSE(made.error().text.empty());
                    continue;
                }
                ++done;
                const TessellationCertificate& c = made->certificate;
                EXPECT_LE(c.measured, c.proved);
                if (budget) {
                    EXPECT_LE(c.triangles, std::max(*options.max_triangles,
                                                    std::uint64_t(8 * mesh.corner_count())));
                } else if (c.unresolved == 0) {
                    EXPECT_LE(c.proved_refinable, 0.02 * size);
                }
                for (const glm::vec3& p : made->mesh.positions)
                    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
                for (const glm::vec3& n : made->mesh.normals.values)
                    EXPECT_NEAR(glm::length(n), 1, 1e-5);
            }
    }
    EXPECT_GT(done, refused);
    std::printf("%llu meshes, %llu errors\n", (unsigned long long)done,
                (unsigned long long)refused);
}

// A dome of quads whose first edges are all the tip.
Mesh dome(std::uint32_t around) {
    Mesh mesh;
    constexpr std::uint32_t rows = 4;
    for (std::uint32_t row = 0; row < rows; ++row)
        for (std::uint32_t k = 0; k < around; ++k) {
            const double a = 2 * std::numbers::pi * k / around, b = 0.4 * row;
            mesh.positions.emplace_back(0.1 + std::sin(b) * std::cos(a),
                                        0.3 + std::sin(b) * std::sin(a), 0.7 + std::cos(b));
        }
    for (std::uint32_t row = 0; row + 1 < rows; ++row)
        for (std::uint32_t k = 0; k < around; ++k) {
            const std::uint32_t next = (k + 1) % around, at = row * around;
            add_face(mesh, {at + k, at + next, at + around + next, at + around + k});
        }
    return mesh;
}

// Beside the tip they are those of a little further away.
TEST(TessellationHardCases, FramesBesideCollapsedEdgesTurnQuietly) {
    const Mesh cage = dome(7);
    auto base = detail::LimitBase::make(cage, {}, true);
    ASSERT_TRUE(base) << to_string(base.error());
    const detail::Domain domain = detail::make_domain(cage, base->left_out(), false, 1);
    base->set_domain(domain);
    int beside = 0;
    for (std::uint32_t root = 0; root < domain.roots.size(); ++root) {
        const detail::DomainRoot& at = domain.roots[root];
        const std::uint32_t first = cage.face_offsets[at.face];
        const std::uint32_t a = at.corners[0] - first, b = at.corners[1] - first;
        if (at.face >= 7 || std::min(a, b) != 0 || std::max(a, b) != 1) continue;
        ++beside;
        for (const double y : {0.2, 0.3, 0.7}) {
            const auto frame = [&](int k) {
                const double z = std::ldexp(1.0, -k);
                const detail::RootPoint point{root, {1 - y - z, y, z}};
                detail::BaseFrame made;
                base->frames({&point, 1}, {&made, 1});
                return made;
            };
            const detail::BaseFrame far = frame(10);
            for (int k = 12; k <= 44; ++k) {
                const detail::BaseFrame near = frame(k);
                for (std::size_t s = 0; s < 2; ++s)
                    EXPECT_LE(glm::length(near.direction_steps[s] - far.direction_steps[s]), 0.02)
                        << root << ' ' << y << ' ' << k << ' ' << s;
            }
        }
    }
    EXPECT_EQ(beside, 7);
}

}  // namespace
}  // namespace prep
