// The plan and the preparation stand on one table: nothing is read that was not provided, and for
// one picture nothing is provided that is not read.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "random_pictures.h"

namespace {

std::string text_of(const prep::AttributeReads& reads) {
    std::string text;
    if (reads.normals) text += "normals ";
    if (reads.tangents) text += "tangents ";
    if (reads.colors) text += "colours ";
    for (const std::uint32_t set : reads.uv_sets) text += "UV set " + std::to_string(set) + " ";
    return text;
}

// What the vertices carry, whoever decided about it.
prep::AttributeReads carried_by(const prep::VertexMesh& mesh) {
    prep::AttributeReads all{
        !mesh.normals.empty(), !mesh.tangents.empty(), !mesh.colors.empty(), {}};
    for (std::uint32_t k = 0; k < mesh.uvs.size(); ++k) all.uv_sets.push_back(k);
    return all;
}

rast::RenderRequest request_of(std::uint32_t seed) {
    rast::RenderRequest request = test::random_request(seed);
    request.samples = 1;
    request.keep_normals = seed % 3 == 0;
    request.keep_uvs = seed % 5 == 0;
    request.keep_color = seed % 7 != 0;
    request.textures = seed % 11 != 0;
    return request;
}

rast::RenderPlan plan_of(const prep::PreparedScene& scene, const rast::RenderRequest& request) {
    auto plan = rast::plan(scene, request);
    if (!plan) throw std::runtime_error(to_string(plan.error()));
    return *std::move(plan);
}

TEST(PlanReads, AreWithinWhatIsProvidedAndAllOfItForOnePicture) {
    std::map<std::string, int> seen;
    for (std::uint32_t seed = 0; seed < 1000; ++seed) {
        const prep::PreparedScene any = test::prepared_random_scene(seed);
        const rast::RenderRequest request = request_of(seed);
        const rast::RenderPlan plan = plan_of(any, request);
        prep::PrepareOptions options;
        options.request.consumer = rast::consumer_of(plan);
        const prep::PreparedScene exact = test::prepared_random_scene(seed, options);
        const auto reads = rast::reads_of(any, plan);
        const auto exact_reads = rast::reads_of(exact, plan_of(exact, request));
        for (std::size_t m = 0; m < reads.size(); ++m) {
            EXPECT_TRUE(reads[m].within(any.requirements[m].provided))
                << "seed " << seed << ", mesh " << m << ": " << text_of(reads[m]) << "of "
                << text_of(any.requirements[m].provided);
            EXPECT_TRUE(exact_reads[m].within(exact.requirements[m].provided))
                << "seed " << seed << ", mesh " << m;
            const prep::VertexMesh& mesh = exact.meshes[m];
            const bool loose = !mesh.points.empty() || !mesh.lines.empty();
            if (mesh.indices.empty() || loose) continue;
            EXPECT_EQ(text_of(exact_reads[m]), text_of(exact.requirements[m].provided))
                << "seed " << seed << ", mesh " << m;
            // And the vertices carry it, with the UV sets below: they are numbered without holes.
            prep::AttributeReads all = exact.requirements[m].provided;
            const std::uint32_t sets = all.uv_sets.empty() ? 0 : all.uv_sets.back() + 1;
            all.uv_sets.clear();
            while (all.uv_sets.size() < sets)
                all.uv_sets.push_back(std::uint32_t(all.uv_sets.size()));
            EXPECT_EQ(text_of(carried_by(mesh)), text_of(all)) << "seed " << seed << ", mesh " << m;
            ++seen[text_of(reads[m])];
        }
    }
    EXPECT_GE(seen.size(), 12u);  // they do differ
}

// A map whose UVs the mesh has not, though it has others, is neither read nor drawn.
TEST(PlanReads, OfASetThatIsNotThereThereAreNone) {
    prep::Scene scene;
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.face_offsets = {0, 3};
    mesh.corner_vertices = {0, 1, 2};
    mesh.face_materials = {0};
    mesh.uvs.resize(2);
    mesh.uvs[1].values = {{0.5f, 0.5f}};
    mesh.uvs[1].indices = {0, 0, 0};
    scene.meshes.push_back(mesh);
    scene.nodes.resize(1);
    scene.nodes[0].mesh = 0;
    scene.images.resize(1);
    scene.textures.resize(1);
    scene.textures[0].image = 0;
    scene.materials.resize(1);
    scene.materials[0].diffuse_map.texture = 0;
    for (const std::uint32_t set : {0u, 1u}) {
        scene.materials[0].diffuse_map.uv_set = set;
        const auto prepared = prep::prepare(scene);
        ASSERT_TRUE(prepared);
        const auto reads = rast::reads_of(*prepared, plan_of(*prepared, {}));
        const std::vector<std::uint32_t> sets(set, 1u);
        EXPECT_EQ(reads[0].uv_sets, sets) << set;
    }
}

// A picture that draws other materials calls for what a scene that has them calls for.
TEST(PlanReads, OfMaterialsInPlaceOfOthersAreThoseOfASceneThatHasThem) {
    int apart = 0, several = 0;
    for (std::uint32_t seed = 0; seed < 300; ++seed) {
        const rast::RenderRequest request = request_of(seed);
        const prep::Scene scene = test::random_scene(seed);
        const std::size_t count = scene.materials.size();
        if (count < 2) continue;
        // Each as the next one, some as themselves beside it.
        prep::Scene others = scene;
        std::vector<prep::StandIn> stand_ins;
        for (std::uint32_t m = 0; m < count; ++m) {
            others.materials[m] = scene.materials[(m + 1) % count];
            stand_ins.push_back({m, others.materials[m]});
        }
        // And where there is none.
        others.materials.push_back(scene.materials[seed % count]);
        for (prep::Mesh& mesh : others.meshes) {
            if (mesh.face_materials.empty())
                mesh.face_materials.assign(mesh.face_count(), prep::no_index);
            for (std::uint32_t& m : mesh.face_materials)
                if (m >= count) m = std::uint32_t(count);
        }
        stand_ins.push_back({prep::no_index, others.materials.back()});
        const rast::RenderPlan plan = plan_of(*prep::prepare(others), request);
        prep::Request asked;
        asked.consumer = rast::consumer_of(plan);
        const auto wanted = prep::requirements(others, asked);
        const auto own = prep::requirements(scene, asked);
        asked.consumer.stand_ins = stand_ins;
        const auto found = prep::requirements(scene, asked);
        for (const prep::StandIn& other : stand_ins)
            asked.consumer.stand_ins.push_back({other.material, {}});
        std::stable_sort(asked.consumer.stand_ins.begin(), asked.consumer.stand_ins.end(),
                         [](const auto& a, const auto& b) { return a.material < b.material; });
        const auto both = prep::requirements(scene, asked);
        for (std::size_t k = 0; k < found.size(); ++k) {
            EXPECT_EQ(text_of(found[k].provided), text_of(wanted[k].provided)) << "seed " << seed;
            EXPECT_EQ(found[k].tangent_uv_set, wanted[k].tangent_uv_set) << "seed " << seed;
            prep::AttributeReads all = wanted[k].provided;
            all |= own[k].provided;
            EXPECT_EQ(text_of(both[k].provided), text_of(all)) << "seed " << seed;
            apart += !(found[k].provided == own[k].provided);
            several += !(both[k].provided == own[k].provided);
        }
    }
    EXPECT_GT(apart, 30);
    EXPECT_GT(several, 10);
}

// Whatever else is asked for: normals and tangents switched off are those that there were.
TEST(PlanReads, WhatIsPreparedForOnePictureGivesThatPicture) {
    using Level = prep::Request::Level;
    for (std::uint32_t seed = 0; seed < 400; ++seed) {
        const rast::RenderRequest request = request_of(seed);
        prep::PrepareOptions options;
        options.request.normals = seed < 200 ? Level::as_called_for : Level(seed % 3);
        options.request.tangents = seed < 200 ? Level::as_called_for : Level(seed / 3 % 3);
        const prep::PreparedScene any = test::prepared_random_scene(seed, options);
        options.request.consumer = rast::consumer_of(plan_of(any, request));
        const prep::PreparedScene exact = test::prepared_random_scene(seed, options);
        // Which vertices there are depends on the attributes: pictures of triangles do not.
        EXPECT_EQ(test::differing(test::draw(any, request), test::draw(exact, request)), "")
            << "seed " << seed;
    }
}

// Whatever stands in attributes that the plan does not read, nobody sees it.
TEST(PlanReads, WhatIsNotReadMayHoldAnything) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    int spoiled = 0;
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        const rast::RenderRequest request = request_of(seed);
        prep::PreparedScene scene = test::prepared_random_scene(seed);
        const auto reads = rast::reads_of(scene, plan_of(scene, request));
        const rast::Frame before = test::draw(scene, request);
        for (std::size_t m = 0; m < reads.size(); ++m) {
            prep::VertexMesh& mesh = scene.meshes[m];
            const auto spoil = [&](auto& values, bool read) {
                if (read) return;
                for (auto& v : values) v.x = nan;
                spoiled += !values.empty();
            };
            spoil(mesh.normals, reads[m].normals);
            spoil(mesh.tangents, reads[m].tangents);
            for (auto& set : mesh.colors) spoil(set, reads[m].colors);
            for (std::uint32_t k = 0; k < mesh.uvs.size(); ++k)
                spoil(mesh.uvs[k],
                      std::count(reads[m].uv_sets.begin(), reads[m].uv_sets.end(), k) > 0);
        }
        EXPECT_EQ(test::differing(before, test::draw(scene, request)), "") << "seed " << seed;
    }
    EXPECT_GT(spoiled, 200);
}

// An attribute of one mesh, to be made something else.
struct Place {
    const char* kind;
    std::size_t mesh, set;
};
std::vector<Place> places_of(const prep::PreparedScene& scene) {
    std::vector<Place> out;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const prep::AttributeReads carried = carried_by(scene.meshes[m]);
        if (scene.meshes[m].indices.empty()) continue;
        if (carried.normals) out.push_back({"normals", m, 0});
        if (carried.tangents) out.push_back({"tangents", m, 0});
        if (carried.colors) out.push_back({"colours", m, 0});
        for (const std::uint32_t set : carried.uv_sets) out.push_back({"UVs", m, set});
    }
    return out;
}
bool carries(const prep::PreparedScene& scene, const Place& place) {
    const std::vector<Place> all = places_of(scene);
    return std::any_of(all.begin(), all.end(), [&](const Place& p) {
        return p.kind == std::string(place.kind) && p.mesh == place.mesh && p.set == place.set;
    });
}
// Other directions, other texels, other colours: ordinary values all.
void poison(prep::VertexMesh& mesh, const Place& place) {
    const std::string kind = place.kind;
    if (kind == "normals")
        for (glm::vec3& n : mesh.normals) n = {n.z, -n.x, n.y};
    if (kind == "tangents")
        for (glm::vec4& t : mesh.tangents) t = {t.z, -t.x, t.y, -t.w};
    if (kind == "colours")
        for (auto& set : mesh.colors)
            for (glm::vec4& c : set) c = {0.9f - 0.7f * c.y, 0.3f + 0.5f * c.z, 0.5f * c.x, 0.4f};
    if (kind == "UVs")
        for (glm::vec2& uv : mesh.uvs[place.set]) uv = {0.37f - uv.y, 0.61f + 0.7f * uv.x};
}

// Held against pictures, not against the table: each attribute in turn is made something else.
TEST(PlanReads, WhatIsLeftOutForOnePictureChangesNoneAndWhatIsKeptDoes) {
    std::map<std::string, int> left_out, kept, matter;
    for (std::uint32_t seed = 0; seed < 400; ++seed) {
        rast::RenderRequest request = request_of(seed);
        if (seed % 2 == 0) request.shading = rast::Shading::normal_mapped;
        const prep::PreparedScene any = test::prepared_random_scene(seed);
        prep::PrepareOptions options;
        options.request.consumer = rast::consumer_of(plan_of(any, request));
        const prep::PreparedScene exact = test::prepared_random_scene(seed, options);
        const rast::Frame before = test::draw(any, request);
        for (const Place& place : places_of(any)) {
            const bool stays = carries(exact, place);
            prep::PreparedScene other = any;
            poison(other.meshes[place.mesh], place);
            const bool changes = !test::differing(before, test::draw(other, request)).empty();
            EXPECT_FALSE(changes && !stays)
                << "seed " << seed << ", mesh " << place.mesh << ": " << place.kind;
            ++(stays ? kept : left_out)[place.kind];
            matter[place.kind] += changes;
        }
    }
    // Not all that is read is seen: meshes are hidden, maps are flat or cannot be read. The shares,
    // in hundredths, are those measured: 71, 34, 75 and 54.
    const std::map<std::string, int> seen{
        {"normals", 70}, {"tangents", 34}, {"colours", 74}, {"UVs", 52}};
    for (const auto& [kind, share] : seen) {
        std::printf("%-9s left out %3d, kept %3d, of which %3d change the picture\n", kind.c_str(),
                    left_out[kind], kept[kind], matter[kind]);
        EXPECT_GE(left_out[kind], 10) << kind;
        EXPECT_GE(100 * matter[kind], share * kept[kind])
            << kind << " are kept where nothing reads them";
    }
}

}  // namespace
