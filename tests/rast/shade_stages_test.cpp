// Lists of shading stages: that each stage finds what it reads where it looks for it, that what
// nobody reads is not there, how many planes a point takes, and how many points each stage had.
#include "plan/shade_stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "kernels/kernels.h"
#include "random_pictures.h"
#include "skip_stage.h"

namespace {

using rast::detail::coordinates_of;
using rast::detail::drawn_maps;
using rast::detail::MapKind;
using rast::detail::NormalSource;
using rast::detail::PointValue;
using rast::detail::Stage;
using rast::detail::StageKind;
using rast::detail::StageList;
using rast::detail::StageRequest;
using rast::detail::texels_of;

std::size_t number_of(StageKind kind) {
    return std::size_t(kind);
}

StageRequest random_request(test::RandomNumbers& r) {
    StageRequest s;
    s.color = r.chance(0.8);
    s.unlit = r.chance(0.15);
    s.highlights = r.chance(0.7);
    s.metallic_roughness = !s.unlit && r.chance(0.3);
    s.glows = r.chance(0.5);
    s.vertex_light = !s.unlit && r.chance(0.2);
    s.vertex_colors = r.chance(0.4);
    s.in_full = r.chance(0.2);
    if (!s.color) {
        s.normals = r.chance(0.6);
        s.uvs = r.chance(0.5);
        s.weights = r.chance(0.5);
        s.positions = r.chance(0.5);
    }
    for (std::size_t k = 0; k < drawn_maps; ++k) {
        if (r.chance(0.5)) continue;
        StageRequest::Map& map = s.maps[s.map_count];
        map.kind = MapKind(k);
        map.same_texels = s.map_count > 0 && r.chance(0.5);
        map.place =
            map.same_texels ? s.maps[s.map_count - 1u].place : std::uint8_t(r.below(drawn_maps));
        ++s.map_count;
        if (map.kind == MapKind::normal)
            s.source = r.chance(0.5) ? NormalSource::tangent_map : NormalSource::object_map;
    }
    if (s.source == NormalSource::interpolated && r.chance(0.3)) s.source = NormalSource::face;
    return s;
}

std::vector<bool> random_lights(test::RandomNumbers& r) {
    std::vector<bool> local(r.below(5));
    for (std::size_t l = 0; l < local.size(); ++l) local[l] = r.chance(0.5);
    return local;
}

// What a kernel reads and writes, as kernels/ has it. Values are told apart by what made them: the
// same one after another stage has changed it is a new one.
class Machine {
  public:
    Machine(const StageRequest& request, const std::vector<bool>& local, const StageList& list)
        : r_(request), local_(local), list_(list) {}

    // Empty, or what went wrong.
    std::string run() {
        for (const Stage& stage : list_.stages) {
            reads_.clear();
            writes_.clear();
            list(stage);
            const bool apart =
                stage.kind == StageKind::interpolation || stage.kind == StageKind::maps;
            if (apart) write(stage);
            for (const PointValue v : reads_) check(stage, v);
            if (!apart) write(stage);
        }
        return wrong_;
    }

  private:
    bool mapped(MapKind kind) const {
        return std::any_of(r_.maps.begin(), r_.maps.begin() + r_.map_count,
                           [&](const auto& map) { return map.kind == kind; });
    }
    void read_texels(MapKind kind) {
        if (mapped(kind) && list_.has(texels_of(kind))) reads_.push_back(texels_of(kind));
    }
    void read_highlight(std::size_t light) {
        reads_.insert(reads_.end(), {PointValue::angle, PointValue::exponent});
        if (light > 0) reads_.push_back(PointValue::gloss);
        if (r_.metallic_roughness && mapped(MapKind::metallic_roughness))
            reads_.push_back(texels_of(MapKind::metallic_roughness));
        if (local_[light]) reads_.push_back(PointValue::position);
    }
    void list(const Stage& s) {
        switch (s.kind) {
            case StageKind::interpolation:
                for (const PointValue v :
                     {PointValue::id, PointValue::normal, PointValue::tangent, PointValue::color,
                      PointValue::position, PointValue::vertex_light, PointValue::weights,
                      PointValue::uv, PointValue::uv_gradients})
                    if (list_.has(v) &&
                        !(v == PointValue::normal && r_.source == NormalSource::object_map))
                        writes_.push_back(v);
                for (std::size_t p = 0; p < drawn_maps; ++p)
                    if (list_.has(coordinates_of(p))) writes_.push_back(coordinates_of(p));
                break;
            case StageKind::maps:
                for (std::uint32_t m = s.begin; m < s.end; ++m) {
                    reads_.push_back(coordinates_of(r_.maps[s.begin].place));
                    writes_.push_back(texels_of(r_.maps[m].kind));
                }
                break;
            case StageKind::normals:
                reads_.push_back(PointValue::id);
                if (r_.source != NormalSource::object_map) reads_.push_back(PointValue::normal);
                if (r_.source == NormalSource::tangent_map) reads_.push_back(PointValue::tangent);
                if (r_.source == NormalSource::tangent_map || r_.source == NormalSource::object_map)
                    reads_.push_back(texels_of(MapKind::normal));
                if (mapped(MapKind::bump))
                    reads_.insert(reads_.end(),
                                  {texels_of(MapKind::bump), PointValue::uv_gradients});
                writes_.push_back(PointValue::normal);
                break;
            case StageKind::eye:
                writes_.push_back(PointValue::eye);
                break;
            case StageKind::light:
                reads_.push_back(PointValue::eye);
                writes_.insert(writes_.end(), {PointValue::angle, PointValue::half});
                [[fallthrough]];
            case StageKind::matte_light:
                reads_.push_back(PointValue::normal);
                if (local_[s.begin]) reads_.push_back(PointValue::position);
                if (s.begin > 0) reads_.push_back(PointValue::light);
                writes_.push_back(PointValue::light);
                break;
            case StageKind::exponents:
                reads_.insert(reads_.end(), {PointValue::angle, PointValue::half});
                if (r_.metallic_roughness && mapped(MapKind::metallic_roughness))
                    reads_.push_back(texels_of(MapKind::metallic_roughness));
                writes_.push_back(PointValue::exponent);
                break;
            case StageKind::gloss:
                read_highlight(s.begin);
                writes_.push_back(PointValue::gloss);
                break;
            case StageKind::color:
                if (r_.vertex_colors) reads_.push_back(PointValue::color);
                for (const MapKind kind : {MapKind::diffuse, MapKind::emissive, MapKind::specular,
                                           MapKind::occlusion, MapKind::metallic_roughness})
                    read_texels(kind);
                if (r_.vertex_light) {
                    reads_.push_back(PointValue::vertex_light);
                } else if (!r_.unlit && !local_.empty()) {
                    reads_.push_back(PointValue::light);
                    if (r_.highlights) reads_.push_back(PointValue::gloss);
                }
                break;
            case StageKind::attributes:
                if (r_.normals) reads_.push_back(PointValue::normal);
                if (r_.uvs) reads_.push_back(PointValue::uv);
                if (r_.weights) reads_.push_back(PointValue::weights);
                if (r_.positions) reads_.push_back(PointValue::position);
                break;
            case StageKind::count:
                break;
        }
    }
    using Content = std::pair<PointValue, int>;
    void write(const Stage&) {
        for (const PointValue v : writes_) {
            if (!list_.has(v)) {
                wrong_ += "a value that is made has no plane; ";
                continue;
            }
            ++version_[v];
            for (std::size_t p = 0; p < planes_of(v); ++p)
                planes_[list_.first[std::size_t(v)] + p] = {v, version_[v]};
        }
    }
    void check(const Stage& stage, PointValue v) {
        if (!list_.has(v)) {
            wrong_ += "stage " + std::to_string(int(stage.kind)) + " reads what has no plane; ";
            return;
        }
        for (std::size_t p = 0; p < planes_of(v); ++p) {
            const std::size_t at = list_.first[std::size_t(v)] + p;
            if (at >= list_.planes) wrong_ += "a plane beyond the last; ";
            if (version_[v] == 0 || planes_[at] != Content{v, version_[v]})
                wrong_ += "stage " + std::to_string(int(stage.kind)) + " finds value " +
                          std::to_string(int(v)) + " gone; ";
        }
    }

    const StageRequest& r_;
    const std::vector<bool>& local_;
    const StageList& list_;
    std::vector<PointValue> reads_, writes_;
    std::map<PointValue, int> version_;
    std::array<Content, rast::detail::most_planes + 8> planes_{};
    std::string wrong_;
};

TEST(ShadeStages, FindWhatTheyReadWhereItWasLeft) {
    test::RandomNumbers r(1);
    std::size_t shared = 0;
    for (int i = 0; i < 20000; ++i) {
        const StageRequest request = random_request(r);
        const std::vector<bool> lights = random_lights(r);
        const StageList list = stages_for(request, lights);
        ASSERT_EQ(Machine(request, lights, list).run(), "") << i;
        std::size_t apart = 0;
        for (std::size_t v = 0; v < rast::detail::point_values; ++v)
            if (list.has(PointValue(v))) apart += planes_of(PointValue(v));
        ASSERT_LE(list.planes, apart);
        shared += list.planes < apart;
    }
    EXPECT_GT(shared, 10000u);  // planes are used again
}

// A Phong point and one with a normal map and a diffuse map on the same texels, one directional
// light: 16 and 32 floats where each value has planes of its own; 19 under several lights.
TEST(ShadeStages, ThePointOfOneLightTakesSevenFloats) {
    StageRequest request;
    const std::vector<bool> one{false};
    EXPECT_EQ(stages_for(request, one).planes, 7u);
    EXPECT_EQ(stages_for(request, {false, false, false}).planes, 18u);
    request.highlights = false;
    EXPECT_EQ(stages_for(request, one).planes, 4u);
    request.highlights = true;
    request.source = NormalSource::tangent_map;
    request.maps[0] = {MapKind::diffuse, 0, false};
    request.maps[1] = {MapKind::normal, 0, true};
    request.map_count = 2;
    EXPECT_EQ(stages_for(request, one).planes, 20u);
    request.unlit = true;
    request.map_count = 1;
    EXPECT_EQ(stages_for(request, one).planes, 9u);
}

TEST(ShadeStages, WhatNobodyReadsIsNotThere) {
    StageRequest request;
    request.maps[0] = {MapKind::emissive, 0, false};
    request.maps[1] = {MapKind::normal, 1, false};
    request.map_count = 2;
    request.source = NormalSource::tangent_map;
    request.vertex_colors = true;
    const StageList dark = stages_for(request, {});  // no light, and nothing glows
    EXPECT_EQ(dark.map_count, 0u);
    for (const PointValue v : {PointValue::id, PointValue::normal, PointValue::tangent,
                               PointValue::position, PointValue::light, PointValue::eye,
                               coordinates_of(0), coordinates_of(1), texels_of(MapKind::normal)})
        EXPECT_FALSE(dark.has(v)) << int(v);
    EXPECT_TRUE(dark.has(PointValue::color));
    EXPECT_EQ(dark.stages.size(), 2u);
    // Positions are those of lights at places.
    EXPECT_FALSE(stages_for(request, {false}).has(PointValue::position));
    EXPECT_TRUE(stages_for(request, {true}).has(PointValue::position));
    request.glows = true;
    EXPECT_EQ(stages_for(request, {}).map_count, 1u);
    request.in_full = true;
    request.glows = false;
    EXPECT_EQ(stages_for(request, {}).map_count, 1u);
    // Several on the same texels, the middle one for nothing.
    StageRequest three;
    three.highlights = false;
    three.maps[0] = {MapKind::diffuse, 0, false};
    three.maps[1] = {MapKind::specular, 0, true};
    three.maps[2] = {MapKind::emissive, 0, true};
    three.map_count = 3;
    three.glows = true;
    const StageList list = stages_for(three, {});
    EXPECT_EQ(list.map_count, 2u);
    EXPECT_EQ(list.stages.at(1), (Stage{StageKind::maps, 0, 1}));
    EXPECT_EQ(list.stages.at(2), (Stage{StageKind::maps, 2, 3}));
}

// Two lights, one of them at a place: each of them at every point, the first one's highlights
// summed apart.
TEST(ShadeStages, CountTheirPoints) {
    prep::Material material;
    const prep::PreparedScene scene = test::stage_of(material);
    rast::RenderRequest request = test::stage_request();
    request.lights->push_back(
        test::light_of(prep::LightKind::point, glm::vec3(9), {2, 2, 2}, {0, 0, -1}));
    for (const int samples : {1, 4}) {
        request.samples = samples;
        for (const bool areas : {false, true}) {
            if (areas && samples > 1) continue;
            request.coverage = areas ? rast::Coverage::area : rast::Coverage::samples;
            const rast::Frame frame = test::draw(scene, request);
            const rast::Counters& c = frame.counters;
            const auto points = [&](StageKind kind) { return c.stage_points[number_of(kind)]; };
            const std::uint64_t all = c.pixels_shaded;
            EXPECT_GT(all, 0u);
            EXPECT_EQ(points(StageKind::interpolation), all);
            EXPECT_EQ(points(StageKind::maps), 0u);
            EXPECT_EQ(points(StageKind::normals), all);
            EXPECT_EQ(points(StageKind::eye), all);
            EXPECT_EQ(points(StageKind::light), 2 * all);
            EXPECT_EQ(points(StageKind::matte_light), 0u);
            EXPECT_EQ(points(StageKind::exponents), 2 * all);
            EXPECT_EQ(points(StageKind::gloss), 2 * all);
            EXPECT_EQ(points(StageKind::color), all);
            EXPECT_EQ(c.light_points, 2 * all);
            EXPECT_EQ(c.highlight_points, 2 * all);
        }
    }
}

// After each stage, all planes that no later one reads are filled with something.
struct Spoiler : rast::detail::StageWatch {
    float with = 0;
    std::uint64_t spoiled = 0, left = 0;
    explicit Spoiler(float value) : with(value) {
        after = [](StageWatch& self, const StageList& list, std::size_t stage, float* planes,
                   std::size_t stride) {
            auto& spoiler = static_cast<Spoiler&>(self);
            for (std::size_t p = 0; p < rast::detail::most_planes; ++p) {
                (list.live[stage].test(p) ? spoiler.left : spoiler.spoiled) += 1;
                if (!list.live[stage].test(p))
                    std::fill_n(planes + p * stride, stride, spoiler.with);
            }
        };
    }
};

// Kernels read no plane that the list takes for free: whatever is in those, the picture is the
// same.
TEST(ShadeStages, PlanesThatNoLaterStageReadsMayHoldAnything) {
    Spoiler spoilers[] = {Spoiler(std::numeric_limits<float>::quiet_NaN()), Spoiler(-3e30f)};
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        const prep::PreparedScene scene = test::prepared_random_scene(seed);
        rast::RenderRequest request = test::random_request(seed);
        request.threads = 1;
        request.prune = seed % 8 != 0;
        request.simd = prep::SimdLevel(seed % 5);
        if (seed % 10 == 0) {
            request.samples = 1;
            request.coverage = rast::Coverage::area;
        }
        rast::RenderPlan plan = *rast::plan(scene, request);
        const rast::Frame frame = *rast::render(scene, plan);
        for (Spoiler& spoiler : spoilers) {
            plan.watch = &spoiler;
            EXPECT_EQ(test::differing(frame, *rast::render(scene, plan)), "") << "seed " << seed;
        }
    }
    for (const Spoiler& spoiler : spoilers) {
        EXPECT_GT(spoiler.spoiled, 100000u);
        EXPECT_GT(spoiler.left, 10000u);
    }
}

// And they read those that it does not: each plane in turn.
TEST(ShadeStages, PlanesThatALaterStageReadsMatter) {
    struct One : rast::detail::StageWatch {
        std::size_t stage = 0, plane = 0;
        bool live = false;
        One() {
            after = [](StageWatch& self, const StageList& list, std::size_t s, float* planes,
                       std::size_t stride) {
                auto& one = static_cast<One&>(self);
                if (s != one.stage || !list.live[s].test(one.plane)) return;
                one.live = true;
                for (std::size_t n = 0; n < stride; ++n) {
                    float& v = planes[one.plane * stride + n];
                    v = -0.7f - 1.5f * v;
                }
            };
        }
    };
    prep::Material material;
    const prep::PreparedScene scene = test::stage_of(material);
    rast::RenderRequest request = test::stage_request();
    request.threads = 1;
    request.lights->push_back(
        test::light_of(prep::LightKind::point, glm::vec3(9), {2, 2, 2}, {0, 0, -1}));
    rast::RenderPlan plan = *rast::plan(scene, request);
    const rast::Frame frame = *rast::render(scene, plan);
    int live = 0;
    for (std::size_t s = 0; s < 10; ++s)
        for (std::size_t p = 0; p < rast::detail::most_planes; ++p) {
            One one;
            one.stage = s;
            one.plane = p;
            plan.watch = &one;
            const rast::Frame other = *rast::render(scene, plan);
            live += one.live;
            EXPECT_EQ(test::differing(frame, other) != "", one.live) << s << ", " << p;
        }
    EXPECT_GT(live, 40);
}

}  // namespace
