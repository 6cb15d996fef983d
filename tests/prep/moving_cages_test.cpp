// Cages of meshes that move: what joints and morph targets move apart is no one surface.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "prep/prepare.h"
#include "shapes.h"

namespace {

// Two lips that lie on each other at rest, a quad each.
class Lips : public testing::TestWithParam<bool> {  // whether each is a primitive of a document
  protected:
    Lips() {
        mesh_ = shapes::mesh_of({{0, -1, 0},
                                 {1, -1, 0},
                                 {1, 0, 0},
                                 {0, 0, 0},
                                 {0, 0, 0},
                                 {1, 0, 0},
                                 {1, 1, 0},
                                 {0, 1, 0}},
                                {{0, 1, 2, 3}, {4, 5, 6, 7}});
        mesh_.indexed_by_vertex = true;
        mesh_.tied_to_file = GetParam();
        if (GetParam()) {
            mesh_.parts = {"lower", "upper"};
            mesh_.face_parts = {0, 1};
        }
    }
    void move(std::vector<glm::vec3> deltas) {
        prep::MorphTarget& target = mesh_.morph_targets.emplace_back();
        target.positions = {{0, std::make_shared<const std::vector<glm::vec3>>(std::move(deltas))}};
    }
    // Of the joints 0 and 1, by vertex.
    void bind(const std::vector<glm::vec2>& weights) {
        prep::SkinInfluences& set = mesh_.skin_influences.emplace_back();
        set.joints.assign(mesh_.vertex_count(), glm::u16vec4(0, 1, 0, 0));
        for (const glm::vec2 w : weights) set.weights.emplace_back(w, 0.0F, 0.0F);
    }
    // How many points are told to stay apart.
    std::uint64_t refine() {
        prep::Scene scene;
        scene.meshes.push_back(mesh_);
        prep::instance_unused_meshes(scene);
        prep::PrepareOptions options;
        options.subdivide = true;
        options.subdivision.level = 1;
        options.subdivision.scheme = prep::SubdivisionScheme::bilinear;
        const auto prepared = prep::prepare(std::move(scene), options);
        EXPECT_TRUE(prepared) << prepared.error().text;
        if (!prepared) return no_count;
        refined_ = prepared->scene.meshes[0];
        for (const auto& f : prepared->findings)
            if (f.kind == "moving-apart") return f.count;
        return 0;
    }
    // `look`: whether the face is of the upper lip, and the corner's vertex in the file.
    template <class Look>
    void at_corners(const Look& look) const {
        for (std::size_t f = 0; f < refined_.face_count(); ++f) {
            float y = 0;
            const std::uint32_t begin = refined_.face_offsets[f],
                                end = refined_.face_offsets[f + 1];
            for (std::uint32_t c = begin; c < end; ++c)
                y += refined_.positions[refined_.corner_vertices[c]].y;
            for (std::uint32_t c = begin; c < end; ++c)
                look(y > 0, refined_.file_vertex(refined_.corner_vertices[c]));
        }
    }
    glm::vec3 delta_of(std::uint32_t vertex) const {
        for (const prep::VertexDeltas& run : refined_.morph_targets.at(0).positions)
            if (vertex >= run.first_vertex && vertex - run.first_vertex < run.values->size())
                return (*run.values)[vertex - run.first_vertex];
        return glm::vec3(0.0F);
    }
    std::size_t points() const {
        return std::set<std::uint32_t>(refined_.corner_vertices.begin(),
                                       refined_.corner_vertices.end())
            .size();
    }
    static constexpr std::uint64_t no_count = ~std::uint64_t(0);
    prep::Mesh mesh_, refined_;
};

TEST_P(Lips, OpenWhereATargetMovesThem) {
    std::vector<glm::vec3> deltas(8, glm::vec3(0.0F));
    for (std::size_t v = 4; v < 8; ++v) deltas[v].y = 1;
    move(deltas);
    EXPECT_EQ(refine(), 2U);
    at_corners([&](bool upper, std::uint32_t v) {
        EXPECT_EQ(delta_of(v), glm::vec3(0, upper ? 1 : 0, 0));
    });
    EXPECT_EQ(points(), 18U);
}

TEST_P(Lips, OpenWhereJointsMoveThem) {
    bind({{1, 0}, {1, 0}, {1, 0}, {1, 0}, {0, 1}, {0, 1}, {0, 1}, {0, 1}});
    EXPECT_EQ(refine(), 2U);
    at_corners([&](bool upper, std::uint32_t v) {
        const prep::SkinInfluences& set = refined_.skin_influences[0];
        for (int k = 0; k < 4; ++k)
            if (set.weights[v][k] != 0) {
                EXPECT_EQ(set.joints[v][k], upper ? 1 : 0);
            }
    });
    EXPECT_EQ(points(), 18U);
}

// Eight bits of weights and the last bits of deltas are rounded as an exporter likes; and which
// joint moves a point stands where it likes.
TEST_P(Lips, StayClosedWhereTheyMoveAlike) {
    std::vector<glm::vec3> deltas(8, glm::vec3(0, 1, 0));
    deltas[3].y += 1e-6F;
    move(deltas);
    const float half = 0.5F + 1.0F / 255;
    bind({{1, 0}, {1, 0}, {half, 0.5F}, {0.5F, 0.5F}, {0.5F, 0.5F}, {0.5F, 0.5F}, {0, 1}, {0, 1}});
    mesh_.skin_influences[0].joints[5] = {1, 0, 0, 0};
    mesh_.skin_influences[0].weights[4] *= 3.0F;  // their sum says nothing
    EXPECT_EQ(refine(), 0U);
    // A primitive is written with points of its own.
    std::map<std::array<float, 3>, std::set<std::pair<float, float>>> weights;
    at_corners([&](bool, std::uint32_t v) {
        const glm::vec3 p = refined_.positions[v];
        const glm::vec4 w = refined_.skin_influences[0].weights[v];
        weights[{p.x, p.y, p.z}].insert({w.x, w.y});
    });
    for (const auto& [point, found] : weights) EXPECT_EQ(found.size(), 1U);
    EXPECT_EQ(weights.size(), 15U);
}

// What no face uses says nothing of how large the mesh is, and small motions count in large ones.
TEST_P(Lips, OpenInMeshesMuchLargerThanTheirMotion) {
    std::vector<glm::vec3> deltas(9, glm::vec3(0.0F));
    for (std::size_t v = 4; v < 8; ++v) deltas[v].y = 1e-4F;
    move(deltas);
    mesh_.positions.emplace_back(7e4F, 0.0F, 0.0F);
    mesh_.points = {8};
    EXPECT_EQ(refine(), 2U);
}

// Eight weights of 8 bits, each a step away.
TEST_P(Lips, StayClosedWhereEachOfEightWeightsIsRounded) {
    for (int set = 0; set < 2; ++set) {
        prep::SkinInfluences& s = mesh_.skin_influences.emplace_back();
        for (std::uint32_t v = 0; v < 8; ++v) {
            const float step = v < 4 ? 0.0F : 1.0F / 255;
            s.joints.emplace_back(4 * set, 4 * set + 1, 4 * set + 2, 4 * set + 3);
            s.weights.emplace_back(32.0F / 255 + step, 32.0F / 255 - step, 32.0F / 255 + step,
                                   (set == 0 ? 32.0F : 31.0F) / 255 - step);
        }
    }
    EXPECT_EQ(refine(), 0U);
}

// One lip of three is moved by nothing: it goes with the first that something moves.
TEST_P(Lips, OfNoJointGoWithOneThatIsMoved) {
    mesh_.positions.insert(mesh_.positions.begin(), {{0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0, 0, 0}});
    for (std::uint32_t& v : mesh_.corner_vertices) v += 4;
    mesh_.corner_vertices.insert(mesh_.corner_vertices.end(), {0, 1, 2, 3});
    mesh_.face_offsets.push_back(12);
    if (GetParam()) mesh_.face_parts.push_back(1);
    const glm::vec2 none(0.0F), low(1, 0), high(0, 1);
    bind({none, none, none, none, low, low, low, low, high, high, high, high});
    EXPECT_EQ(refine(), 2U);
}

INSTANTIATE_TEST_SUITE_P(OneOrTwoPrimitives, Lips, testing::Bool());

}  // namespace
