// What clocks tell of each part of drawing: of which there are times, that they lie within the time
// of the whole, and that no byte of the picture knows of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "plan/frame_pass.h"
#include "skip_stage.h"

namespace {

using rast::DrawingPart;

double ms_of(const rast::Frame& frame, DrawingPart part) {
    return frame.part_ms[std::size_t(part)];
}
DrawingPart stage(std::string_view name) {
    for (std::size_t k = 0; k < rast::shade_stages; ++k)
        if (rast::shade_stage_names[k] == name) return DrawingPart(k);
    throw std::runtime_error("no such stage");
}

rast::RenderRequest timed_request() {
    rast::RenderRequest request = test::stage_request();
    request.width = 480;
    request.height = 360;
    request.threads = 1;
    request.timed = true;
    return request;
}

prep::ImageRef noise() {
    prep::Image image;
    image.width = image.height = 64;
    image.channels = 3;
    test::RandomNumbers r(1);
    for (int k = 0; k < 3 * 64 * 64; ++k) image.pixels.push_back(float(r.between(0.3, 0.7)));
    prep::ImageRef out;
    out.name = "noise.png";
    out.bytes = *prep::encode_png(image);
    return out;
}

TEST(PartTimes, HaveNamesOfTheirOwn) {
    std::set<std::string_view> names;
    for (std::size_t p = 0; p < rast::drawing_parts; ++p) names.insert(name_of(DrawingPart(p)));
    EXPECT_EQ(names.size(), rast::drawing_parts);
    EXPECT_EQ(names.count(""), 0u);
    EXPECT_EQ(name_of(DrawingPart::count), "");
}

TEST(PartTimes, ChangeNoByteAndNoCounter) {
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        const prep::PreparedScene scene = test::prepared_random_scene(seed);
        rast::RenderRequest request = test::random_request(seed);
        if (seed % 5 == 0) {
            request.samples = 1;
            request.coverage = rast::Coverage::area;
        }
        if (seed % 7 == 0) request.supersample = 3;
        const rast::Frame plain = test::draw(scene, request);
        for (const double ms : plain.part_ms) EXPECT_EQ(ms, 0);
        request.timed = true;
        const rast::Frame timed = test::draw(scene, request);
        EXPECT_EQ(test::differing(plain, timed), "") << seed;
        EXPECT_EQ(plain.counters.stage_points, timed.counters.stage_points) << seed;
    }
}

// On one thread: parts do not overlap, and most of the time is in one of them.
TEST(PartTimes, AddUpToTheTimeOfTheWall) {
    prep::Material material;
    material.diffuse_map.texture = 0;
    const prep::PreparedScene scene = test::stage_of(material, {noise()});
    for (const bool bands : {false, true})
        for (const int samples : {1, 4}) {
            rast::RenderRequest request = timed_request();
            request.samples = samples;
            request.keep_depth = request.keep_normals = true;
            if (bands) request.band_bytes = 480 * 32 * 64;
            const auto plan = rast::plan(scene, request);
            rast::SceneRenderer renderer(scene);
            rast::Frame frame;
            const auto take = [](const rast::Frame&, std::uint32_t) {
                return prep::Result<void>();
            };
            double share = 0;
            for (int turn = 0; turn < 6; ++turn) {
                if (bands) {
                    EXPECT_LT(plan->band_rows, 360u);
                    frame = *renderer.render_bands(*plan, take);
                } else {
                    ASSERT_TRUE(renderer.render(*plan, frame));
                }
                double sum = 0;  // but for what the first turn made
                for (std::size_t p = 0; p < rast::drawing_parts; ++p)
                    if (DrawingPart(p) != DrawingPart::textures &&
                        DrawingPart(p) != DrawingPart::levels)
                        sum += frame.part_ms[p];
                EXPECT_LE(sum, frame.geometry_ms + frame.raster_ms);
                share = std::max(share, sum / (frame.geometry_ms + frame.raster_ms));
            }
            EXPECT_GE(share, 0.6);
            EXPECT_GT(ms_of(frame, DrawingPart::textures), 0);
        }
}

TEST(PartTimes, AreThoseOfWhatRuns) {
    prep::Material bent;
    bent.normal_map.texture = 0;
    const prep::PreparedScene ball = test::stage_of({}), bumpy = test::stage_of(bent, {noise()});
    struct Case {
        const char* name;
        void (*ask)(rast::RenderRequest&);
        bool bumpy;
        DrawingPart part;
        bool at_points;  // stages of shading are told apart
    };
    const Case cases[] = {
        {"Phong", [](rast::RenderRequest&) {}, false, DrawingPart::sorting, true},
        {"MSAA", [](rast::RenderRequest& r) { r.samples = 4; }, false, DrawingPart::resolving,
         true},
        {"exact areas", [](rast::RenderRequest& r) { r.coverage = rast::Coverage::area; }, false,
         DrawingPart::areas, false},
        {"supersampling", [](rast::RenderRequest& r) { r.supersample = 2; }, false,
         DrawingPart::reducing, true},
        {"Gouraud", [](rast::RenderRequest& r) { r.shading = rast::Shading::gouraud; }, false,
         DrawingPart::vertex_light, true},
        {"normal map", [](rast::RenderRequest& r) { r.shading = rast::Shading::normal_mapped; },
         true, DrawingPart::normal_mapping, true},
        {"buffers", [](rast::RenderRequest& r) { r.keep_normals = true; }, false,
         DrawingPart::buffers, true},
    };
    for (const Case& c : cases) {
        rast::RenderRequest request = timed_request();
        c.ask(request);
        const rast::Frame frame = test::draw(c.bumpy ? bumpy : ball, request);
        EXPECT_GT(ms_of(frame, c.part), 0) << c.name;
        for (const Case& other : cases) {
            if (other.part == DrawingPart::sorting || other.part == DrawingPart::buffers) continue;
            if (&other == &c) continue;
            EXPECT_EQ(ms_of(frame, other.part), 0) << c.name << other.name;
        }
        EXPECT_GT(ms_of(frame, DrawingPart::vertices), 0) << c.name;
        EXPECT_GT(ms_of(frame, DrawingPart::culling), 0) << c.name;
        // Stages that have points have times, and no others do.
        for (std::size_t k = 0; k < rast::shade_stages; ++k) {
            const bool is_bent = c.bumpy && DrawingPart(k) == stage("normals");
            EXPECT_EQ(frame.part_ms[k] > 0,
                      c.at_points && !is_bent && frame.counters.stage_points[k] > 0)
                << c.name << ": " << rast::shade_stage_names[k];
        }
    }
    rast::RenderRequest passing = timed_request();
    rast::detail::FramePass pass;
    pass.run = [](const rast::detail::PassTask& task) {
        for (glm::vec4& c : task.frame->color) c.x = std::sqrt(c.x);
    };
    add_pass(passing, pass);
    EXPECT_GT(ms_of(test::draw(ball, passing), DrawingPart::passes), 0);
}

// A hundred lights take longer than all other stages together, and nothing else does.
TEST(PartTimes, GoToTheStageThatTakesThem) {
    prep::Material matte;
    matte.specular = glm::vec3(0);
    const prep::PreparedScene scene = test::stage_of(matte);
    rast::RenderRequest request = timed_request();
    for (int l = 0; l < 100; ++l) request.lights->push_back(request.lights->front());
    const rast::Frame frame = test::draw(scene, request);
    double others = 0;
    for (std::size_t k = 0; k < rast::shade_stages; ++k)
        if (DrawingPart(k) != stage("light without highlights")) others += frame.part_ms[k];
    EXPECT_GT(ms_of(frame, stage("light without highlights")), others);
}

}  // namespace
