// Samples, supersampling and exact areas, and samples by supersampling: how much of each pixel is
// covered.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "cost/ladders/scenes.h"
#include "cost/oracles/pictures.h"

namespace cost {
namespace {

constexpr std::uint32_t width = 160, height = 120;

// Spokes and gaps of equal width around the middle, 3° each.
prep::VertexMesh star() {
    prep::VertexMesh mesh;
    constexpr int spokes = 60;
    for (int i = 0; i < spokes; ++i) {
        const double a = (2 * i + 0.31) * std::numbers::pi / spokes,
                     b = (2 * i + 1.31) * std::numbers::pi / spokes;
        for (const auto& [r, t] : {std::pair(0.02, a), std::pair(0.97, a), std::pair(0.97, b)}) {
            mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
            mesh.positions.push_back({float(r * std::cos(t)), float(r * std::sin(t)), 0.0f});
        }
    }
    return mesh;
}

bool is_finite(const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// The user's mesh as a white shape, without triangles that are nowhere.
prep::VertexMesh shape_of(const prep::Mesh& mesh) {
    prep::VertexMesh out;
    out.positions = mesh.positions;
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::uint32_t c = mesh.face_offsets[f] + 1; c + 1 < mesh.face_offsets[f + 1]; ++c) {
            const std::uint32_t corners[] = {mesh.face_offsets[f], c, c + 1};
            if (std::all_of(std::begin(corners), std::end(corners), [&](std::uint32_t k) {
                    return is_finite(mesh.positions[mesh.corner_vertices[k]]);
                }))
                for (const std::uint32_t k : corners)
                    out.indices.push_back(mesh.corner_vertices[k]);
        }
    return out;
}

// Triangles in pixels, by the definition of an orthographic view along −z.
std::vector<Triangle2> in_pixels(const prep::VertexMesh& mesh, const glm::dvec3& centre,
                                 double half) {
    std::vector<Triangle2> out;
    const Real scale = Real(height) / (2 * Real(half));
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        Triangle2 triangle;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3& p = mesh.positions[mesh.indices[t + k]];
            triangle[k] = {Real(width) / 2 + (Real(p.x) - Real(centre.x)) * scale,
                           Real(height) / 2 - (Real(p.y) - Real(centre.y)) * scale};
        }
        out.push_back(triangle);
    }
    return out;
}

struct Setting {
    std::string name;
    int samples = 1, supersample = 1;
    bool area = false;
};

// What the setting says that a pixel has, corners on the grid of 1/256 pixel as the renderer has
// them. Areas of triangles that may overlap are sampled.
Pixels defined_coverage(const std::vector<Triangle2>& triangles, bool disjoint,
                        const Setting& setting) {
    std::vector<Triangle2> snapped = triangles;
    const Real grid = Real(256) * setting.supersample;
    for (Triangle2& t : snapped)
        for (Point2& p : t) p = glm::round(p * grid) / grid;
    if (setting.area)
        return disjoint ? exact_coverage(snapped, width, height)
                        : sampled_coverage(snapped, width, height);
    // A finer picture has the samples in each of its own pixels.
    const int side = setting.supersample;
    std::vector<Point2> places;
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
            for (const Point2& p : standard_places(setting.samples))
                places.push_back((p + Point2(i, j)) / Real(side));
    return coverage_at(snapped, width, height, places);
}

// What rungs are drawn of and held against.
struct Silhouette {
    std::shared_ptr<const prep::PreparedScene> scene;
    std::shared_ptr<const Pixels> truth;
    std::shared_ptr<const std::vector<Triangle2>> triangles;
    bool disjoint = false;  // the triangles
    rast::View view;
    int threads = 0;
};

Rung rung_of(const Silhouette& shape, const Setting& setting) {
    rast::RenderRequest request;
    request.width = width;
    request.height = height;
    request.cull = prep::Cull::none;
    request.samples = setting.samples;
    request.supersample = setting.supersample;
    request.coverage = setting.area ? prep::Coverage::area : prep::Coverage::samples;
    request.threads = shape.threads;
    request.view = shape.view;
    request.lights = std::vector<rast::LightInstance>{};
    Rung rung;
    rung.name = setting.name;
    rung.exact = setting.area;
    const auto drawing = std::make_shared<Drawing>(shape.scene, request);
    rung.run = [drawing] { return drawing->draw(); };
    // Made with the first judgement: rungs that are not asked for need none.
    const auto own = std::make_shared<std::optional<Pixels>>();
    rung.judge = [drawing, own, setting, truth = shape.truth, plain = shape.triangles,
                  disjoint = shape.disjoint] {
        const Pixels picture = first_channel(drawing->frame());
        const PictureError e = picture_error(picture, *truth);
        if (!*own) *own = defined_coverage(*plain, disjoint, setting);
        return std::vector<double>{e.rmse, e.largest, e.psnr, picture_error(picture, **own).rmse};
    };
    rung.look = [drawing, truth = shape.truth] {
        return look_of(first_channel(drawing->frame()), *truth);
    };
    return rung;
}

// What both share: the shape, its truth, and what is said of them.
prep::Result<Silhouette> silhouette(const Subject& subject, Ladder& ladder) {
    prep::VertexMesh mesh = subject.mesh ? shape_of(*subject.mesh) : star();
    glm::vec3 low(1e30f), high(-1e30f);
    for (const std::uint32_t v : mesh.indices) {
        const glm::vec3& p = mesh.positions[v];
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const glm::dvec3 centre = (glm::dvec3(low) + glm::dvec3(high)) * 0.5;
    const glm::dvec3 size = glm::dvec3(high) - glm::dvec3(low);
    const double half = subject.mesh ? std::max(size.y, size.x * height / width) * 0.55 : 1.0;
    // Beyond these, what the renderer computes in floats ends.
    if (!(half > 1e-30) || !(half < 1e30) || !(size.z < 1e30))
        return prep::Error{prep::ErrorCode::invalid,
                           "the mesh has no extent that can be drawn: 1e-30 to 1e30 units",
                           subject.name};
    Silhouette shape;
    shape.threads = subject.threads;
    shape.disjoint = subject.mesh == nullptr;
    shape.view = flat_view(half);
    if (subject.mesh) {
        shape.view.world_to_view[3] =
            glm::dvec4(-centre.x, -centre.y, -centre.z - size.z - half, 1);
        shape.view.zfar = 3 * (size.z + half);
    }
    std::vector<Triangle2> triangles = in_pixels(mesh, subject.mesh ? centre : glm::dvec3(0), half);
    shape.truth =
        std::make_shared<const Pixels>(subject.mesh ? sampled_coverage(triangles, width, height)
                                                    : exact_coverage(triangles, width, height));
    ladder.setting = "pictures: --samples, --supersample and --coverage";
    ladder.subject =
        subject.mesh
            ? subject.name + ", white, from +z: " + std::to_string(triangles.size()) + " triangles"
            : "a star of 60 spokes";
    ladder.subject += ", 160 × 120 pixels";
    ladder.oracle = subject.mesh ? "1,024 samples a pixel by a plain loop in long double"
                                 : "exact areas of the spokes in each pixel, in long double";
    ladder.timed = {"plan", "transform, visibility and shading (one colour)", "resolve"};
    ladder.metrics = {{"RMSE", "", "linear light"},
                      {"largest", "", "linear light"},
                      {"PSNR", "dB", "linear light"},
                      {"from its definition", "",
                       subject.mesh ? "RMSE; the setting's own samples, 1,024 for areas"
                                    : "RMSE; the setting's own samples or areas"}};
    if (subject.mesh) {
        ladder.floor =
            picture_error(sampled_coverage(triangles, width, height, 24), *shape.truth).rmse;
        ladder.floor_text = "what 576 samples a pixel miss of the oracle's 1,024";
    } else {
        std::vector<Triangle2> snapped = triangles;
        for (Triangle2& t : snapped)
            for (Point2& p : t) p = glm::round(p * Real(256)) / Real(256);
        ladder.floor = picture_error(exact_coverage(snapped, width, height), *shape.truth).rmse;
        ladder.floor_text =
            "exact areas of corners rounded to 1/256 pixel, as the renderer has them";
    }
    shape.scene =
        std::make_shared<const prep::PreparedScene>(scene_of(std::move(mesh), plain_white()));
    shape.triangles = std::make_shared<const std::vector<Triangle2>>(std::move(triangles));
    return shape;
}

constexpr const char* samples_cost_more =
    "what covers each pixel is looked up sample by sample, and a pixel with an edge is shaded once "
    "for each triangle in it; a finer picture of as many samples is plain, and has them on a grid";

constexpr const char* sixteen_are_off_centre =
    "the 16 standard samples are 1/32 pixel off the middle on average, which a finer picture "
    "divides by no more than its own factor; and samples cost more than as many finer pixels";
constexpr const char* grids_see_less =
    "a grid has fewer different places across a slanted edge than as many samples at standard ones";

const char* why_more_costs(int samples) {
    return samples == 16 ? sixteen_are_off_centre : samples > 1 ? samples_cost_more : "";
}

}  // namespace

prep::Result<Ladder> anti_aliasing_ladder(const Subject& subject) {
    Ladder ladder;
    ladder.name = "anti-aliasing";
    ladder.title = "Samples, supersampling and exact areas";
    const auto shape = silhouette(subject, ladder);
    if (!shape) return shape.error();
    std::vector<Setting> settings;
    for (const int n : {1, 2, 4, 8, 16})
        settings.push_back({std::to_string(n) + (n == 1 ? " sample" : " samples"), n});
    for (const int n : {2, 4, 8}) settings.push_back({"supersample " + std::to_string(n), 1, n});
    settings.push_back({"exact areas", 1, 1, true});
    for (const Setting& setting : settings) {
        Rung rung = rung_of(*shape, setting);
        rung.command = setting.area ? "render --coverage area"
                       : setting.supersample > 1
                           ? "render --supersample " + std::to_string(setting.supersample)
                           : "render --samples " + std::to_string(setting.samples);
        rung.because = setting.samples > 1       ? samples_cost_more
                       : setting.supersample > 1 ? grids_see_less
                                                 : "";
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

prep::Result<Ladder> samples_by_supersampling_grid(const Subject& subject) {
    Ladder ladder;
    ladder.name = "samples-by-supersampling";
    ladder.title = "Samples by supersampling";
    const auto shape = silhouette({subject.name, nullptr, subject.threads}, ladder);
    if (!shape) return shape.error();
    ladder.setting = "pictures: --samples and --supersample together";
    const std::vector<int> samples = {1, 2, 4, 8, 16}, sides = {1, 2, 3, 4};
    const auto words = [](const std::vector<int>& numbers, const char* before) {
        std::vector<std::string> out;
        for (const int n : numbers) out.push_back(before + std::to_string(n));
        return out;
    };
    make_grid(ladder, {"samples", words(samples, "")}, {"supersampling", words(sides, "× ")},
              [&](std::size_t i, std::size_t j) {
                  Rung rung = rung_of(*shape, {"", samples[i], sides[j]});
                  rung.command = "render --samples " + std::to_string(samples[i]) +
                                 " --supersample " + std::to_string(sides[j]);
                  rung.because = why_more_costs(samples[i]);
                  return rung;
              });
    return ladder;
}

}  // namespace cost
