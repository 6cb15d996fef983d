// The same scene about zero and ten thousand kilometres away: the same picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "builders.h"
#include "formats/obj/obj.h"
#include "hard_cases.h"
#include "prep/image.h"
#include "shapes.h"

namespace {

// A grid of multiples of 2⁻¹², so that adding the offset to a coordinate rounds nothing in double.
double on_grid(double x) {
    return std::round(x * 4096) / 4096;
}

prep::Mesh rough_torus(bool gridded) {
    std::mt19937_64 random(91);
    prep::Mesh mesh = shapes::torus(60, 30);
    shapes::jitter(mesh, 0.02f, random);
    if (gridded)
        for (glm::vec3& p : mesh.positions) p = {on_grid(p.x), on_grid(p.y), on_grid(p.z)};
    return mesh;
}

const glm::dvec3 offset(1e7, -1e7, 1e7);

enum class By { nothing, node, origin, both, text };

std::string obj_text(const prep::Mesh& mesh, const glm::dvec3& by) {
    std::ostringstream text;
    text.precision(17);
    for (const glm::vec3& p : mesh.positions) {
        const glm::dvec3 q = glm::dvec3(p) + by;
        text << "v " << q.x << ' ' << q.y << ' ' << q.z << '\n';
    }
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        text << 'f';
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            text << ' ' << mesh.corner_vertices[c] + 1;
        text << '\n';
    }
    return text.str();
}

prep::PreparedScene scene_by(const prep::Mesh& mesh, By by, bool as_text) {
    prep::Scene scene;
    if (as_text) {
        const std::string text = obj_text(mesh, by == By::text ? offset : glm::dvec3(0));
        auto parsed = prep::parse_obj(std::as_bytes(std::span(text.data(), text.size())));
        if (!parsed) throw std::runtime_error(to_string(parsed.error()));
        scene = *std::move(parsed);
        prep::instance_unused_meshes(scene);
    } else {
        scene = hard_cases::scene_of({"", 0, hard_cases::with_uvs(mesh)});
        if (by == By::node) scene.nodes[0].transform[3] = glm::dvec4(offset, 1);
        if (by == By::origin) scene.meshes[0].origin = offset;
        if (by == By::both) {  // there and back again, and there
            scene.meshes[0].origin = -offset;
            scene.nodes[0].transform[3] = glm::dvec4(2.0 * offset, 1);
        }
    }
    auto prepared = prep::prepare(std::move(scene));
    if (!prepared) throw std::runtime_error(to_string(prepared.error()));
    return *std::move(prepared);
}

prep::Image picture(const prep::PreparedScene& scene, const std::optional<rast::View>& view) {
    rast::RenderRequest request;
    request.width = 400;
    request.height = 300;
    request.samples = 4;
    request.shading = rast::Shading::phong;
    request.view = view;
    if (view) request.lights = rast::three_light_setup(*view);
    return rast::to_srgb(test::draw(scene, request));
}

std::size_t drawn_pixels(const prep::PreparedScene& scene) {
    rast::RenderRequest request;
    request.width = 400;
    request.height = 300;
    std::size_t count = 0;
    for (const glm::vec4& p : test::draw(scene, request).color) count += p.w > 0;
    return count;
}

std::vector<std::byte> png(const prep::Image& image) {
    auto bytes = prep::encode_png(image);
    if (!bytes) throw std::runtime_error(to_string(bytes.error()));
    return *std::move(bytes);
}

rast::View view_from(const glm::dvec3& at) {
    return test::look_at(at + glm::dvec3(2, 1.5, 2.5), at);
}

TEST(Offset, NodesAndOriginsTenThousandKilometresAwayGiveTheSamePng) {
    const prep::Mesh mesh = rough_torus(true);
    const prep::PreparedScene here = scene_by(mesh, By::nothing, false);
    ASSERT_GT(drawn_pixels(here), 20'000u);
    const auto fixed = png(picture(here, view_from(glm::dvec3(0))));
    const auto fitted = png(picture(here, std::nullopt));
    for (const By by : {By::node, By::origin, By::both}) {
        const prep::PreparedScene there = scene_by(mesh, by, false);
        EXPECT_EQ(png(picture(there, view_from(offset))), fixed) << int(by);
        EXPECT_EQ(png(picture(there, std::nullopt)), fitted) << int(by);
    }
}

TEST(Offset, TextIsReadInDoubleAndGivesTheSamePng) {
    const prep::Mesh mesh = rough_torus(true);
    const prep::PreparedScene here = scene_by(mesh, By::nothing, true);
    const prep::PreparedScene there = scene_by(mesh, By::text, true);
    EXPECT_EQ(here.meshes[0].origin, glm::dvec3(0));
    EXPECT_NE(there.meshes[0].origin, glm::dvec3(0));
    EXPECT_EQ(png(picture(there, view_from(offset))), png(picture(here, view_from(glm::dvec3(0)))));
    EXPECT_EQ(png(picture(there, std::nullopt)), png(picture(here, std::nullopt)));
}

// Coordinates of any digits: about zero each is rounded to float where it stands, far away about
// the box's centre, so that vertices differ by up to 1e-7 of the model, a few 1/256 pixel snap
// differently, and samples on their edges change hands.
TEST(Offset, AnyCoordinatesDifferByRoundingAlone) {
    const prep::Mesh mesh = rough_torus(false);
    for (const bool fitted : {false, true}) {
        const auto draw = [&](By by, const glm::dvec3& at) {
            return picture(scene_by(mesh, by, true),
                           fitted ? std::nullopt : std::optional(view_from(at)));
        };
        const prep::Image here = draw(By::nothing, glm::dvec3(0)), there = draw(By::text, offset);
        ASSERT_EQ(here.pixels.size(), there.pixels.size());
        std::size_t differing = 0;
        float largest = 0;
        for (std::size_t i = 0; i < here.pixels.size(); ++i) {
            const float step =
                std::abs(std::round(here.pixels[i] * 255) - std::round(there.pixels[i] * 255));
            differing += step > 0;
            largest = std::max(largest, step);
        }
        RecordProperty(fitted ? "fitted_bytes" : "fixed_bytes", int(differing));
        EXPECT_LT(differing, here.pixels.size() / 1000);
        EXPECT_LE(largest, 64);  // one of four samples
    }
}

}  // namespace
