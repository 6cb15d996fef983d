// Passes beside the main one: whoever looks beyond a pixel sees the same in the whole picture, in
// crops and in bands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "plan/frame_pass.h"
#include "skip_stage.h"

namespace {

using rast::detail::FramePass;
using rast::detail::FramePlane;
using rast::detail::PassTask;

// The mean of a value over a square of pixels, those of the picture.
template <class Value>
float box_mean(std::int64_t x, std::int64_t y, std::int64_t radius, std::int64_t width,
               std::int64_t height, const Value& value) {
    double sum = 0;
    std::int64_t count = 0;
    for (std::int64_t j = std::max<std::int64_t>(0, y - radius);
         j <= std::min(height - 1, y + radius); ++j)
        for (std::int64_t i = std::max<std::int64_t>(0, x - radius);
             i <= std::min(width - 1, x + radius); ++i, ++count)
            sum += double(value(std::size_t(j * width + i)));
    return float(sum / double(count));
}

// The mean depth of what is near goes to a plane, and from there, times a normal's z, to green.
FramePass depth_mean(std::uint32_t radius) {
    FramePass pass;
    pass.name = "mean depth";
    pass.radius = radius;
    pass.planes = 1;
    pass.reads_depth = pass.reads_normals = true;
    pass.run = [radius](const PassTask& t) {
        FramePlane& plane = t.planes[t.pass][0];
        EXPECT_EQ(plane.width, t.part.width);
        EXPECT_EQ(plane.height, t.part.height);
        EXPECT_EQ(t.frame->color.size(), plane.values.size());
        for (std::uint32_t y = 0; y < t.part.height; ++y)
            for (std::uint32_t x = 0; x < t.part.width; ++x) {
                const std::size_t at = std::size_t(y) * t.part.width + x;
                EXPECT_EQ(plane.values[at], 0.0f);
                plane.values[at] = box_mean(x, y, radius, t.part.width, t.part.height,
                                            [&](std::size_t i) { return t.frame->depth[i]; });
                t.frame->color[at].y = plane.values[at] * (100 + 50 * t.frame->normal[at].z);
            }
    };
    return pass;
}

// Green once more: the mean of what is there.
FramePass green_mean(std::uint32_t radius) {
    FramePass pass;
    pass.name = "mean green";
    pass.radius = radius;
    pass.run = [radius](const PassTask& t) {
        const std::vector<glm::vec4> before = t.frame->color;
        for (std::uint32_t y = 0; y < t.part.height; ++y)
            for (std::uint32_t x = 0; x < t.part.width; ++x)
                t.frame->color[std::size_t(y) * t.part.width + x].y =
                    box_mean(x, y, radius, t.part.width, t.part.height,
                             [&](std::size_t i) { return before[i].y; });
    };
    return pass;
}

rast::RenderPlan plan_for(const prep::PreparedScene& scene, const rast::RenderRequest& request) {
    auto plan = rast::plan(scene, request);
    if (!plan) throw std::runtime_error(to_string(plan.error()));
    return *std::move(plan);
}
// The same plan with one pass more.
void add_pass(const prep::PreparedScene& scene, rast::RenderPlan& plan, FramePass pass) {
    rast::RenderRequest request = plan.request;
    rast::detail::add_pass(request, std::move(pass));
    plan = plan_for(scene, request);
}
rast::Frame drawn(const prep::PreparedScene& scene, const rast::RenderPlan& plan) {
    auto frame = rast::render(scene, plan);
    if (!frame) throw std::runtime_error(to_string(frame.error()));
    return *std::move(frame);
}

prep::PreparedScene scene_with_edges() {
    return test::stage_of(prep::Material{});
}
rast::RenderRequest usual_request() {
    rast::RenderRequest request = test::stage_request();
    request.width = 150;
    request.height = 200;
    request.view = test::look_at({0.4, 0.3, 4}, {0, 0, 0});
    return request;
}

// The ways of drawing that a pass stands beside.
std::vector<std::pair<std::string, rast::RenderRequest>> ways() {
    std::vector<std::pair<std::string, rast::RenderRequest>> all;
    all.emplace_back("plain", usual_request());
    all.emplace_back("samples", usual_request()).second.samples = 4;
    all.emplace_back("supersampling", usual_request()).second.supersample = 2;
    all.emplace_back("areas", usual_request()).second.coverage = rast::Coverage::area;
    all.emplace_back("bytes", usual_request()).second.pixels = rast::PixelFormat::bytes;
    all.emplace_back("Gouraud", usual_request()).second.shading = rast::Shading::gouraud;
    return all;
}

// Pixels that differ from those of the whole picture, in bands of so many bytes.
std::size_t wrong_in_bands(const prep::PreparedScene& scene, rast::RenderPlan plan,
                           std::uint32_t rows, const rast::Frame& whole) {
    plan.band_rows = rows;
    std::size_t wrong = 0, seen = 0;
    const auto done = rast::render_bands(
        scene, plan, [&](const rast::Frame& band, std::uint32_t first) -> prep::Result<void> {
            const std::size_t at = std::size_t(first) * whole.width;
            for (std::size_t i = 0; i < band.color.size(); ++i)
                wrong += band.color[i] != whole.color[at + i];
            for (std::size_t i = 0; i < band.bytes.size(); ++i)
                wrong += band.bytes[i] != whole.bytes[at + i];
            seen += band.color.size() + band.bytes.size();
            EXPECT_EQ(band.depth.size(), 0u);
            EXPECT_EQ(band.normal.size(), 0u);
            return {};
        });
    EXPECT_TRUE(done);
    EXPECT_EQ(seen, std::size_t(whole.width) * whole.height);
    return wrong;
}

std::size_t wrong_in_crop(const prep::PreparedScene& scene, rast::RenderPlan plan,
                          const rast::Crop& crop, const rast::Frame& whole) {
    plan.request.crop = crop;
    const rast::Frame part = drawn(scene, plan);
    std::size_t wrong = 0;
    EXPECT_EQ(part.width, crop.width);
    EXPECT_EQ(part.color.size() + part.bytes.size(), std::size_t(crop.width) * crop.height);
    for (std::uint32_t y = 0; y < crop.height; ++y)
        for (std::uint32_t x = 0; x < crop.width; ++x) {
            const std::size_t in = std::size_t(y) * crop.width + x;
            const std::size_t of = std::size_t(y + crop.y) * whole.width + x + crop.x;
            if (!part.color.empty())
                wrong += part.color[in] != whole.color[of];
            else
                wrong += part.bytes[in] != whole.bytes[of];
        }
    return wrong;
}

constexpr rast::Crop crops[] = {
    {0, 0, 60, 70}, {60, 67, 88, 80}, {149, 199, 1, 1}, {3, 190, 140, 10}};

// The wider part, drawn and cut out, is what is drawn without it.
TEST(FramePasses, ThatDoNothingChangeNoByte) {
    const prep::PreparedScene scene = scene_with_edges();
    for (const auto& [way, request] : ways()) {
        rast::RenderPlan plan = plan_for(scene, request);
        const rast::Frame without = drawn(scene, plan);
        FramePass nothing;
        nothing.name = "nothing";
        nothing.radius = 9;
        nothing.run = [](const PassTask&) {};
        add_pass(scene, plan, nothing);
        EXPECT_EQ(test::differing(drawn(scene, plan), without), "") << way;
        EXPECT_EQ(wrong_in_bands(scene, plan, 64, without), 0u) << way;
        EXPECT_EQ(wrong_in_crop(scene, plan, {30, 40, 70, 80}, without), 0u) << way;
    }
}

// Radii of any size: what is beyond the largest picture is not there.
TEST(FramePasses, HalosEndWithTheLargestPicture) {
    const prep::PreparedScene scene = scene_with_edges();
    rast::RenderPlan plan = plan_for(scene, usual_request());
    FramePass far;
    far.radius = 1u << 31;
    far.run = [](const PassTask&) {};
    add_pass(scene, plan, far);
    add_pass(scene, plan, far);
    EXPECT_EQ(plan.halo, rast::max_picture_extent);
}

TEST(FramePasses, SeeTheSameInPartsAsInTheWhole) {
    const prep::PreparedScene scene = scene_with_edges();
    for (const auto& [way, request] : ways())
        for (const std::uint32_t radius : {1u, 9u}) {
            rast::RenderPlan plan = plan_for(scene, request);
            add_pass(scene, plan, depth_mean(radius));
            ASSERT_EQ(plan.halo, radius);
            const rast::Frame whole = drawn(scene, plan);
            rast::RenderPlan bare = plan;
            bare.halo = 0;
            for (const std::uint32_t rows : {64u, 7u}) {
                EXPECT_EQ(wrong_in_bands(scene, plan, rows, whole), 0u) << way << " " << radius;
                EXPECT_GT(wrong_in_bands(scene, bare, rows, whole), 0u) << way << " " << radius;
            }
            for (const rast::Crop& crop : crops)
                EXPECT_EQ(wrong_in_crop(scene, plan, crop, whole), 0u) << way << " " << radius;
            EXPECT_GT(wrong_in_crop(scene, bare, crops[1], whole), 0u) << way << " " << radius;
        }
}

// What two passes look at lies as far away as both of them look.
TEST(FramePasses, LookAsFarAsAllOfThem) {
    const prep::PreparedScene scene = scene_with_edges();
    rast::RenderPlan plan = plan_for(scene, usual_request());
    add_pass(scene, plan, depth_mean(4));
    add_pass(scene, plan, green_mean(6));
    EXPECT_EQ(plan.halo, 10u);
    const rast::Frame whole = drawn(scene, plan);
    EXPECT_EQ(wrong_in_bands(scene, plan, 7, whole), 0u);
    EXPECT_EQ(wrong_in_crop(scene, plan, crops[1], whole), 0u);
    plan.halo = 6;
    EXPECT_GT(wrong_in_bands(scene, plan, 7, whole), 0u);
    EXPECT_GT(wrong_in_crop(scene, plan, crops[1], whole), 0u);
}

// The whole picture is that of plain loops over the buffers of one drawn without passes.
TEST(FramePasses, MakeWhatPlainLoopsMake) {
    const prep::PreparedScene scene = scene_with_edges();
    rast::RenderRequest request = usual_request();
    request.keep_depth = request.keep_normals = true;
    rast::RenderPlan plan = plan_for(scene, request);
    const rast::Frame plain = drawn(scene, plan);
    add_pass(scene, plan, depth_mean(3));
    const rast::Frame frame = drawn(scene, plan);
    EXPECT_EQ(frame.depth, plain.depth);
    EXPECT_EQ(frame.normal, plain.normal);
    for (std::uint32_t y = 0; y < request.height; ++y)
        for (std::uint32_t x = 0; x < request.width; ++x) {
            const std::size_t at = std::size_t(y) * request.width + x;
            const float mean = box_mean(x, y, 3, request.width, request.height,
                                        [&](std::size_t i) { return plain.depth[i]; });
            glm::vec4 expected = plain.color[at];
            expected.y = mean * (100 + 50 * plain.normal[at].z);
            ASSERT_EQ(frame.color[at], expected) << x << " " << y;
        }
}

// A pass before the main one is run once, however many bands there are, and its plane is there for
// those after it.
TEST(FramePasses, BeforeTheMainOneRunOnceAPicture) {
    const prep::PreparedScene scene = scene_with_edges();
    rast::RenderPlan plan = plan_for(scene, usual_request());
    int times = 0;
    FramePass before;
    before.before = true;
    before.radius = 9;  // of its own plane: no halo
    before.planes = 1;
    before.run = [&times](const PassTask& t) {
        ++times;
        EXPECT_EQ(t.frame, nullptr);
        EXPECT_EQ(t.planes[1].size(), 0u);
        t.planes[t.pass][0] = {2, 1, {0.25f, 0.5f}};
    };
    FramePass after;
    after.run = [](const PassTask& t) {
        for (glm::vec4& c : t.frame->color) c.x = t.planes[0][0].values[1];
    };
    add_pass(scene, plan, before);
    add_pass(scene, plan, after);
    EXPECT_EQ(plan.halo, 0u);
    const rast::Frame whole = drawn(scene, plan);
    EXPECT_EQ(times, 1);
    for (const glm::vec4& c : whole.color) ASSERT_EQ(c.x, 0.5f);
    EXPECT_EQ(wrong_in_bands(scene, plan, 7, whole), 0u);
    EXPECT_EQ(times, 2);
}

// Buffers that are read and planes are there for the passes alone, and are counted.
TEST(FramePasses, CostNothingWhereThereAreNone) {
    const prep::PreparedScene scene = scene_with_edges();
    const rast::RenderPlan bare = plan_for(scene, usual_request());
    EXPECT_EQ(bare.halo, 0u);
    EXPECT_TRUE(bare.passes.empty());
    rast::RenderPlan passing = bare;
    add_pass(scene, passing, depth_mean(3));
    rast::SceneRenderer renderer(scene);
    rast::Frame frame;
    const std::uint64_t pixels = 150 * 200;
    ASSERT_TRUE(renderer.render(passing, frame));
    EXPECT_EQ(frame.depth.size(), 0u);
    EXPECT_EQ(frame.counters.buffer_bytes, pixels * (16 + (16 + 4 + 12) + 4));
    ASSERT_TRUE(renderer.render(bare, frame));
    EXPECT_EQ(frame.counters.buffer_bytes, pixels * 16);
    EXPECT_EQ(test::differing(frame, drawn(scene, bare)), "");
}

// What is drawn about a part, what passes read and their planes: estimated as they come.
TEST(FramePasses, AreInTheEstimatesOfMemory) {
    const prep::PreparedScene scene = scene_with_edges();
    struct Case {
        std::optional<rast::Crop> crop;
        std::uint32_t first, second;
        bool keeps_depth, bytes;
    };
    const Case cases[] = {{{}, 3, 0, false, false},
                          {{}, 0, 0, true, true},
                          {rast::Crop{40, 50, 30, 60}, 7, 20, true, false},
                          {rast::Crop{0, 150, 150, 50}, 70, 0, false, true}};
    for (const Case& c : cases) {
        rast::RenderRequest request = usual_request();
        request.crop = c.crop;
        request.keep_depth = c.keeps_depth;
        if (c.bytes) request.pixels = rast::PixelFormat::bytes;
        request.band_bytes = 16 * 1024;
        rast::RenderPlan plan = plan_for(scene, request);
        const rast::Frame bare = drawn(scene, plan);
        const std::uint64_t beside = plan.memory_estimate - bare.counters.buffer_bytes;
        const std::uint64_t bare_rows = plan.band_rows;
        add_pass(scene, plan, depth_mean(c.first));
        add_pass(scene, plan, green_mean(c.second));
        // Bytes are made of floats, which are gone when they are counted.
        const std::uint64_t width = c.crop ? c.crop->width : 150,
                            height = c.crop ? c.crop->height : 200,
                            floats = c.bytes ? 12 * width : 0;
        EXPECT_EQ(plan.memory_estimate - beside,
                  drawn(scene, plan).counters.buffer_bytes + floats * height);
        EXPECT_LE(plan.band_rows, bare_rows);
        std::uint64_t most = 0;
        const auto take = [&](const rast::Frame& band, std::uint32_t) -> prep::Result<void> {
            most = std::max(most, band.counters.buffer_bytes);
            return {};
        };
        ASSERT_TRUE(rast::render_bands(scene, plan, take));
        most += floats * plan.band_rows;
        const std::uint64_t tiles = 2 * 63 * (width + 2 * std::uint64_t(plan.halo)) * 36;
        EXPECT_LE(most, plan.band_memory_estimate - beside);
        EXPECT_GE(most + tiles, plan.band_memory_estimate - beside);
    }
    // Planes of a pass before the main one are as large as it says.
    rast::RenderPlan plan = plan_for(scene, usual_request());
    const std::uint64_t before = plan.memory_estimate;
    FramePass shadows;
    shadows.before = true;
    shadows.bytes = 1000;
    shadows.planes = 1;
    shadows.run = [](const PassTask& task) {
        task.planes[task.pass][0] = {25, 10, std::vector<float>(250)};
    };
    add_pass(scene, plan, shadows);
    EXPECT_EQ(drawn(scene, plan).counters.buffer_bytes, 150 * 200 * (16 + 16) + 1000);
    EXPECT_EQ(plan.memory_estimate, before + 150 * 200 * 16 + 1000);
}

// Passes are known before anything is proved: a flat normal map shows in the sign of a zero.
TEST(FramePasses, AreInThePlanBeforeItProvesAnything) {
    prep::Material material;
    material.normal_map.texture = 0;
    const float flat[] = {0.5f, 0.5f, 1};
    const prep::PreparedScene scene =
        test::stage_of(material, {test::float_picture(1, 1, 3, flat)});
    rast::RenderRequest request = test::stage_request();
    EXPECT_TRUE(test::is_skipped("normal_map_flat", scene, request));
    rast::RenderRequest kept = request;
    kept.keep_normals = true;
    const std::vector<glm::vec3> normals = test::draw_knowing_texels(scene, kept).frame.normal;
    std::vector<glm::vec3> seen;
    FramePass pass;
    pass.reads_normals = true;
    pass.run = [&seen](const PassTask& t) { seen = t.frame->normal; };
    rast::detail::add_pass(request, pass);
    const test::Drawing drawing = test::draw_knowing_texels(scene, request);
    EXPECT_EQ(test::proved_zero(drawing.plan).count("normal_map_flat"), 0u);
    EXPECT_TRUE(drawing.plan.textures_read[1]);
    ASSERT_EQ(seen.size(), normals.size());
    EXPECT_EQ(std::memcmp(seen.data(), normals.data(), seen.size() * sizeof(seen[0])), 0);
}

// What the step says of bands is what is drawn.
TEST(FramePasses, AreInTheStepOfBands) {
    const prep::PreparedScene scene = scene_with_edges();
    rast::RenderRequest request = usual_request();
    request.pixels = rast::PixelFormat::bytes;
    request.band_bytes = 4 * 150 * 256;  // of bytes all rows, of floats a part
    const auto told = [&](const rast::RenderPlan& plan) {
        const auto bands = std::find_if(
            plan.steps.begin(), plan.steps.end(),
            [](const rast::PlanStep& step) { return step.kind == rast::PlanStepKind::bands; });
        EXPECT_EQ(bands->reasons.at(0).value, plan.band_rows);
        return bands->run;
    };
    EXPECT_FALSE(told(plan_for(scene, request)));
    rast::detail::add_pass(request, depth_mean(3));
    EXPECT_TRUE(told(plan_for(scene, request)));
}

}  // namespace
