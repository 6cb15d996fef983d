// What else a cage carries: skins, morph targets, colours, named attributes, materials and parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "mesh_files.h"
#include "prep/subdivide.h"
#include "shapes.h"
#include "subdivision/refined_skins.h"
#include "subdivision_cages.h"

namespace {

using test::Cage;

// `sets` of four joints for each vertex: `used` of them, with positive weights of sum 1.
void add_skin(prep::Mesh& mesh, std::size_t sets, std::size_t used, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    mesh.skin_influences.assign(sets, {});
    for (auto& set : mesh.skin_influences) {
        set.joints.assign(mesh.vertex_count(), glm::vec<4, std::uint16_t>(0));
        set.weights.assign(mesh.vertex_count(), glm::vec4(0.0F));
    }
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        double sum = 0;
        std::vector<double> weights;
        for (std::size_t k = 0; k < used; ++k) {
            weights.push_back(1 + double(random() % 100));
            sum += weights.back();
        }
        for (std::size_t k = 0; k < used; ++k) {
            mesh.skin_influences[k / 4].weights[v][int(k % 4)] = float(weights[k] / sum);
            mesh.skin_influences[k / 4].joints[v][int(k % 4)] = std::uint16_t((5 * v + k) % 23);
        }
    }
}

void expect_weights(const prep::SubdividedMesh& refined, std::size_t most) {
    const prep::Mesh& mesh = refined.mesh;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
        const std::uint32_t in_file = mesh.file_vertex(v);
        double sum = 0;
        std::size_t used = 0;
        std::vector<std::uint16_t> joints;
        for (const prep::SkinInfluences& set : mesh.skin_influences)
            for (int k = 0; k < 4; ++k) {
                const float w = set.weights[in_file][k];
                ASSERT_GE(w, 0) << "vertex " << v;
                sum += double(w);
                if (w == 0) continue;
                ++used;
                for (const std::uint16_t other : joints)
                    ASSERT_NE(other, set.joints[in_file][k]) << "vertex " << v;
                joints.push_back(set.joints[in_file][k]);
            }
        ASSERT_NEAR(sum, 1, 1e-6) << "vertex " << v;
        ASSERT_LE(used, most) << "vertex " << v;
    }
}

TEST(SubdivideAttributes, SkinWeightsSumToOneAndStayPositive) {
    for (Cage& cage : test::own_cages()) {
        add_skin(cage.mesh, 1, 3, 5);
        for (const bool control_points : {false, true})
            for (const int most : {0, 2, 8}) {
                SCOPED_TRACE(cage.name + ", at most " + std::to_string(most));
                prep::SubdivideOptions options = cage.options;
                options.max_influences = most;
                options.control_points = control_points;
                const auto refined = prep::subdivide(cage.mesh, options);
                if (!refined) {
                    ADD_FAILURE() << refined.error().text;
                    continue;
                }
                EXPECT_EQ(refined->mesh.skin_influences.size(), most == 8 ? 2U : 1U);
                expect_weights(*refined, most == 0 ? 4 : std::size_t(most));
            }
    }
}

// The surface of a cage's positions, and what its skins make of it.
struct SkinWork {
    prep::detail::RootGroups groups;
    prep::detail::RefinedSkins skins;
};
SkinWork skin_work(const Cage& cage) {
    namespace detail = prep::detail;
    const auto positions = detail::position_cage(cage.mesh, cage.options);
    std::vector<double> numbers;
    for (const glm::vec3& p : cage.mesh.positions) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    const auto surface =
        detail::ChannelSurface::make(*positions, numbers, 3, true, cage.options.level, 1);
    const detail::UniformRefinement refinement(cage.mesh, cage.options, *positions, surface->cage,
                                               surface->tree);
    const auto topology = refinement.topology(positions->corner_vertices, positions->vertex_count);
    return {detail::RootGroups(*surface, refinement.roots),
            detail::refined_skins(refinement, *surface, refinement.numbering(topology))};
}

// Gathered for each face again, what all faces of a pole share costs the square of its valence.
TEST(SubdivideAttributes, SkinWeightsOfAPoleGrowWithItsValence) {
    double gathered[2];
    for (const int k : {0, 1}) {
        const std::uint32_t valence = k == 0 ? 64 : 512;
        Cage cage = test::pole(prep::SubdivisionScheme::catmark, valence);
        add_skin(cage.mesh, 1, 4, 7);
        gathered[k] = double(skin_work(cage).skins.gathered) / valence;
    }
    std::printf("points a face: %.1f of valence 64, %.1f of 512\n", gathered[0], gathered[1]);
    EXPECT_GT(gathered[0], 16);
    EXPECT_LT(gathered[1], 1.05 * gathered[0]);
}

// What threads share out is of like size, however large the groups are; the largest come first.
TEST(SubdivideAttributes, SkinsOfManyPolesAreSharedOutByTheirRoots) {
    constexpr std::uint32_t poles = 30, valence = 64;
    const prep::Mesh one = test::pole(prep::SubdivisionScheme::catmark, valence).mesh;
    Cage cage{"poles", {}, {}};
    cage.options.level = 0;
    for (std::uint32_t k = 0; k < poles; ++k) {
        const auto vertices = std::uint32_t(cage.mesh.vertex_count());
        for (const std::uint32_t v : one.corner_vertices)
            cage.mesh.corner_vertices.push_back(vertices + v);
        const std::uint32_t corners = cage.mesh.face_offsets.back();
        for (std::size_t f = 1; f < one.face_offsets.size(); ++f)
            cage.mesh.face_offsets.push_back(corners + one.face_offsets[f]);
        for (const glm::vec3& p : one.positions)
            cage.mesh.positions.push_back(p + glm::vec3(10.0F * float(k), 0, 0));
    }
    add_skin(cage.mesh, 1, 4, 7);
    const prep::detail::RootGroups groups = skin_work(cage).groups;
    std::vector<std::uint32_t> roots = groups.roots;
    std::sort(roots.begin(), roots.end());
    ASSERT_EQ(roots.size(), cage.mesh.face_count());
    for (std::uint32_t k = 0; k < roots.size(); ++k) ASSERT_EQ(roots[k], k);
    for (std::size_t group = 0; group < groups.count(); ++group)
        ASSERT_EQ(groups[group].size(), group < poles ? valence : 1) << group;
    ASSERT_EQ(groups.blocks.front(), 0U);
    ASSERT_EQ(groups.blocks.back(), groups.count());
    for (std::size_t block = 1; block < groups.blocks.size(); ++block) {
        const std::uint32_t begin = groups.blocks[block - 1], end = groups.blocks[block];
        ASSERT_LT(begin, end);
        EXPECT_LE(groups.offsets[end] - groups.offsets[begin], roots.size() / 64) << block;
    }
    EXPECT_LE(groups.blocks.size(), 128U);
}

void expect_same(const prep::Mesh& a, const prep::Mesh& b) {
    EXPECT_EQ(test::exact_difference(a, b), "");
    ASSERT_EQ(a.skin_influences.size(), b.skin_influences.size());
    for (std::size_t k = 0; k < a.skin_influences.size(); ++k) {
        EXPECT_EQ(a.skin_influences[k].joints, b.skin_influences[k].joints);
        EXPECT_EQ(a.skin_influences[k].weights, b.skin_influences[k].weights);
    }
}

// Weights of poles are gathered in groups of faces; UVs and colours are channels of their own.
TEST(SubdivideAttributes, SameBytesForAnyThreadsAndInstructionSet) {
    std::vector<Cage> cages = test::own_cages();
    cages.push_back(test::pole(prep::SubdivisionScheme::catmark, 100));
    cages.push_back(test::pole(prep::SubdivisionScheme::loop, 40));
    for (Cage& cage : cages) {
        SCOPED_TRACE(cage.name);
        add_skin(cage.mesh, 2, 6, 11);
        prep::CornerLayer<glm::vec2> uvs;
        for (std::uint32_t c = 0; c < cage.mesh.corner_count(); ++c) {
            const glm::vec3 p = cage.mesh.positions[cage.mesh.corner_vertices[c]];
            uvs.values.emplace_back(p.x + (c % 11 == 0 ? 1.0F : 0.0F), p.y - 0.3F * p.z);
            uvs.indices.push_back(c);
        }
        cage.mesh.uvs.push_back(std::move(uvs));
        prep::SubdivideOptions options = cage.options;
        options.creasing = prep::CreasingMethod::chaikin;
        test::expect_same_of_any_threads(cage.mesh, options, expect_same);
    }
}

TEST(SubdivideAttributes, DroppedWeightsAreTold) {
    prep::Mesh mesh = shapes::cube();
    add_skin(mesh, 1, 1, 6);  // one joint a vertex: a face's middle is moved by its four and more
    prep::SubdivideOptions options;
    options.max_influences = 8;
    const auto all = prep::subdivide(mesh, options);
    ASSERT_TRUE(all);
    EXPECT_EQ(all->largest_dropped_weight, 0);
    options.max_influences = 1;
    const auto one = prep::subdivide(mesh, options);
    ASSERT_TRUE(one);
    EXPECT_GT(one->largest_dropped_weight, 0.3F);
    EXPECT_LT(one->largest_dropped_weight, 1);
}

// Vertices that no face gives a limit are bound by --max-influences as well.
TEST(SubdivideAttributes, LooseVerticesKeepTheirLargestInfluences) {
    prep::Mesh mesh = shapes::cube();
    mesh.positions.push_back({5, 5, 5});
    mesh.points = {std::uint32_t(mesh.vertex_count() - 1)};
    add_skin(mesh, 2, 8, 9);
    prep::SubdivideOptions options;
    for (const int most : {0, 1, 3, 4, 6}) {
        options.max_influences = most;
        const auto refined = prep::subdivide(mesh, options);
        ASSERT_TRUE(refined) << refined.error().text;
        expect_weights(*refined, most == 0 ? 8 : std::size_t(most));
        ASSERT_EQ(refined->mesh.points.size(), 1U);
        const std::uint32_t loose = refined->mesh.file_vertex(refined->mesh.points[0]);
        float largest = 0;
        for (const prep::SkinInfluences& set : mesh.skin_influences)
            for (int k = 0; k < 4; ++k) largest = std::max(largest, set.weights.back()[k]);
        const glm::vec4 kept = refined->mesh.skin_influences[0].weights[loose];
        EXPECT_GE(kept[0], largest) << "the largest comes first";
        for (int k = 1; k < 4; ++k) EXPECT_LE(kept[k], kept[k - 1]);
        if (most == 1) {
            EXPECT_GT(refined->largest_dropped_weight, 0.5F);
        }
    }
}

// The rules are linear: what is moved and then refined is where what is refined and then moved is.
TEST(SubdivideAttributes, MorphingAndSubdividingChangePlaces) {
    for (Cage& cage : test::own_cages()) {
        std::mt19937_64 random(7);
        auto values = std::make_shared<std::vector<glm::vec3>>();
        for (std::size_t v = 0; v < cage.mesh.vertex_count(); ++v)
            values->emplace_back(float(random() % 100) / 300, float(random() % 100) / 200,
                                 -float(random() % 100) / 400);
        prep::MorphTarget target;
        target.positions.push_back({0, values});
        target.name = "moved";
        target.weight = 0.25F;
        prep::Mesh moved = cage.mesh;
        for (std::size_t v = 0; v < moved.vertex_count(); ++v) moved.positions[v] += (*values)[v];
        glm::vec3 low = moved.positions[0], high = low;
        for (const glm::vec3& p : moved.positions) low = glm::min(low, p), high = glm::max(high, p);
        const float tolerance = 1e-6F * glm::length(high - low);
        cage.mesh.morph_targets.push_back(target);
        for (const bool control_points : {false, true}) {
            SCOPED_TRACE(cage.name);
            prep::SubdivideOptions options = cage.options;
            options.control_points = control_points;
            const auto with_target = prep::subdivide(cage.mesh, options);
            const auto of_moved = prep::subdivide(moved, options);
            if (!with_target || !of_moved) {
                ADD_FAILURE() << cage.name;
                continue;
            }
            ASSERT_EQ(with_target->mesh.morph_targets.size(), 1U);
            const prep::MorphTarget& refined = with_target->mesh.morph_targets[0];
            EXPECT_EQ(refined.name, "moved");
            EXPECT_EQ(refined.weight, 0.25F);
            std::vector<glm::vec3> points = with_target->mesh.positions;
            for (const prep::VertexDeltas& run : refined.positions)
                for (std::uint32_t v = 0; v < points.size(); ++v) {
                    const std::uint32_t in_file = with_target->mesh.file_vertex(v);
                    if (in_file >= run.first_vertex &&
                        in_file - run.first_vertex < run.values->size())
                        points[v] += (*run.values)[in_file - run.first_vertex];
                }
            ASSERT_EQ(points.size(), of_moved->mesh.positions.size());
            for (std::size_t v = 0; v < points.size(); ++v)
                ASSERT_LE(glm::length(points[v] - of_moved->mesh.positions[v]), tolerance)
                    << "vertex " << v;
        }
    }
}

// The value of an attribute at each corner.
std::vector<float> at_corners(const prep::Mesh& mesh, std::size_t attribute) {
    std::vector<float> values;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c)
        values.push_back(mesh.vertex_attributes[attribute].values[mesh.corner_file_vertex(c)]);
    return values;
}

// A file repeats vertices at seams of its UVs; where an attribute's values are the same on both
// sides, it is as smooth there as without the seam.
TEST(SubdivideAttributes, EqualValuesOfRepeatedVerticesMakeNoCrease) {
    prep::Mesh whole = shapes::cube();
    whole.vertex_attributes.push_back({"_HEAT", 1, {0, 1, 4, 9, 16, 25, 36, 49}});
    prep::Mesh repeated = whole;
    for (std::uint32_t c = 0; c < repeated.corner_count(); ++c) {
        const std::uint32_t v = repeated.corner_vertices[c];
        repeated.corner_file_vertices.push_back(c < 4 ? 8 + c : v);
        if (c < 4)
            repeated.vertex_attributes[0].values.push_back(whole.vertex_attributes[0].values[v]);
    }
    const auto expected = prep::subdivide(whole), found = prep::subdivide(repeated);
    ASSERT_TRUE(expected && found);
    EXPECT_EQ(at_corners(found->mesh, 0), at_corners(expected->mesh, 0));
    repeated.vertex_attributes[0].values[9] += 1;  // and where they are not, it is a border
    const auto apart = prep::subdivide(repeated);
    ASSERT_TRUE(apart);
    EXPECT_NE(at_corners(apart->mesh, 0), at_corners(expected->mesh, 0));
}

TEST(SubdivideAttributes, NumbersThatAreNotFiniteLeaveTheirAttributeOut) {
    prep::Mesh mesh = shapes::cube();
    mesh.vertex_attributes.push_back({"_HEAT", 1, {0, 1, 2, 3, NAN, 5, 6, 7}});
    mesh.vertex_attributes.push_back({"_COLD", 1, {7, 6, 5, 4, 3, 2, 1, 0}});
    const auto refined = prep::subdivide(mesh);
    ASSERT_TRUE(refined);
    EXPECT_EQ(refined->attributes_left_out, 1U);
    EXPECT_TRUE(refined->mesh.vertex_attributes[0].values.empty());
    EXPECT_FALSE(refined->mesh.vertex_attributes[1].values.empty());
    EXPECT_EQ(prep::subdivide(shapes::cube())->attributes_left_out, 0U);
}

TEST(SubdivideAttributes, LinesWithoutFacesKeepThem) {
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    mesh.line_vertices = {2, 0};
    mesh.line_offsets = {0, 2};
    mesh.vertex_attributes.push_back({"_HEAT", 1, {5, 6, 7}});
    const auto refined = prep::subdivide(mesh);
    ASSERT_TRUE(refined) << refined.error().text;
    const prep::Mesh& out = refined->mesh;
    ASSERT_EQ(out.line_vertices.size(), 2U);
    ASSERT_EQ(out.vertex_attributes[0].values.size(), 2U);
    EXPECT_EQ(out.vertex_attributes[0].values[out.file_vertex(out.line_vertices[0])], 7);
    EXPECT_EQ(out.vertex_attributes[0].values[out.file_vertex(out.line_vertices[1])], 5);
}

// More targets than are refined at once: each as it is alone.
TEST(SubdivideAttributes, ManyTargetsAreRefinedAsEachAlone) {
    prep::Mesh mesh = shapes::cube();
    for (int t = 0; t < 19; ++t) {
        auto deltas = std::make_shared<std::vector<glm::vec3>>(8, glm::vec3(0.0F));
        (*deltas)[std::size_t(t % 8)] = {float(t), 1, -2};
        mesh.morph_targets.push_back({{}, {}, {}, "target", 0});
        if (t != 3) mesh.morph_targets.back().positions.push_back({0, deltas});
    }
    const auto all = prep::subdivide(mesh);
    ASSERT_TRUE(all);
    ASSERT_EQ(all->mesh.morph_targets.size(), 19U);
    for (std::size_t t = 0; t < 19; ++t) {
        prep::Mesh one = mesh;
        one.morph_targets = {mesh.morph_targets[t]};
        const auto alone = prep::subdivide(one);
        ASSERT_TRUE(alone);
        const auto& found = all->mesh.morph_targets[t].positions;
        const auto& expected = alone->mesh.morph_targets[0].positions;
        ASSERT_EQ(found.size(), t == 3 ? 0U : 1U);
        ASSERT_EQ(found.size(), expected.size());
        if (t != 3) {
            EXPECT_EQ(*found[0].values, *expected[0].values) << t;
        }
    }
}

// A colour or an attribute that is a linear function of the positions is one of the refined ones.
TEST(SubdivideAttributes, ColorsAndNamedAttributesFollowThePoints) {
    Cage cage = test::pole(prep::SubdivisionScheme::catmark, 5);
    prep::CornerLayer<glm::vec4> colors;
    prep::VertexAttribute heat{"_HEAT", 2, {}};
    for (const glm::vec3& p : cage.mesh.positions) {
        colors.values.emplace_back(0.5F + 0.1F * p.x, 0.5F + 0.1F * p.y, 0.5F + 0.1F * p.z, 1);
        heat.values.insert(heat.values.end(), {p.x + p.y, 3 - p.z});
    }
    colors.indices = cage.mesh.corner_vertices;
    cage.mesh.colors.push_back(colors);
    cage.mesh.vertex_attributes.push_back(heat);
    prep::SubdivideOptions options = cage.options;
    options.face_varying = prep::FaceVaryingRule::corners_only;
    for (const bool control_points : {false, true}) {
        options.control_points = control_points;
        const auto refined = prep::subdivide(cage.mesh, options);
        ASSERT_TRUE(refined) << refined.error().text;
        const prep::Mesh& mesh = refined->mesh;
        ASSERT_EQ(mesh.colors.size(), 1U);
        ASSERT_EQ(mesh.vertex_attributes.size(), 1U);
        EXPECT_EQ(mesh.vertex_attributes[0].name, "_HEAT");
        for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
            const glm::vec3 p = mesh.positions[mesh.corner_vertices[c]];
            const glm::vec4 color = mesh.colors[0].values[mesh.colors[0].indices[c]];
            ASSERT_NEAR(color.x, 0.5F + 0.1F * p.x, 2e-6F);
            ASSERT_NEAR(color.y, 0.5F + 0.1F * p.y, 2e-6F);
            ASSERT_NEAR(color.z, 0.5F + 0.1F * p.z, 2e-6F);
            ASSERT_NEAR(color.w, 1, 2e-6F);
            const float* own = &mesh.vertex_attributes[0].values[2 * mesh.corner_file_vertex(c)];
            ASSERT_NEAR(own[0], p.x + p.y, 1e-5F);
            ASSERT_NEAR(own[1], 3 - p.z, 1e-5F);
        }
    }
}

TEST(SubdivideAttributes, FacesKeepMaterialGroupAndPart) {
    prep::Mesh mesh = shapes::cylinder(5);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        mesh.face_materials.push_back(f % 3);
        mesh.face_smoothing.push_back(f + 1);
        mesh.face_parts.push_back(f % 2);
    }
    mesh.parts = {"a", "b"};
    mesh.name = "prism";
    const auto refined = prep::subdivide(mesh);
    ASSERT_TRUE(refined);
    EXPECT_EQ(refined->mesh.parts, mesh.parts);
    EXPECT_EQ(refined->mesh.name, "prism");
    // 5 quads of 16, 2 pentagons of 5 · 4.
    ASSERT_EQ(refined->mesh.face_count(), 5U * 16 + 2 * 20);
    for (std::size_t f = 0; f < refined->mesh.face_count(); ++f) {
        const std::uint32_t of = refined->cage_faces[f];
        EXPECT_EQ(refined->mesh.face_materials[f], mesh.face_materials[of]);
        EXPECT_EQ(refined->mesh.face_smoothing[f], mesh.face_smoothing[of]);
        EXPECT_EQ(refined->mesh.face_parts[f], mesh.face_parts[of]);
    }
}

}  // namespace
