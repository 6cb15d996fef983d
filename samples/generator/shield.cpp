#include <cmath>
#include <string>

#include "gltf_builder.h"
#include "repeatable.h"
#include "sample_files.h"
#include "textures.h"

namespace samples {
namespace {

constexpr int columns = 10;  // of each half
constexpr int rows = 20;
constexpr double width = 0.85, low = -1.2, high = 1.0, thickness = 0.07;
constexpr double boss_y = 0.25, boss_radius = 0.36;

// s from −1 (left rim) to 1 (right rim), t from 0 (tip) to 1 (top).
glm::dvec3 front_point(double s, double t) {
    const double y = mix(low, high, t);
    const double fall = clamp01((0.3 - y) / 1.5);
    const double x = s * (width * (1 - fall * fall) + 0.015);
    const double from_boss = std::sqrt(x * x + (y - boss_y) * (y - boss_y));
    const double boss = 0.17 * (1 - smooth_step(0.08, boss_radius, from_boss));
    return {x, y, 0.30 - 0.42 * x * x - 0.09 * y * y + boss};
}

// What the texture shows at (u, v): u from the middle line to the rim, v from the top down.
struct Pattern {
    double rim, rivet, ring, stripe, dent;  // each 0…1
};

Pattern pattern(double u, double v) {
    u = std::fabs(u);  // the other half continues as the mirror image
    const double x = u * width, y = mix(high, low, v);
    Pattern p{};
    const double to_rim = std::min({(1 - u) * width, high - y, (y - low) * 0.5});
    p.rim = 1 - smooth_step(0.075, 0.09, to_rim);
    const double rivet_v = v * 16 - std::floor(v * 16) - 0.5;
    const double from_rivet = std::sqrt((1 - u - 0.05) * width * (1 - u - 0.05) * width +
                                        rivet_v / 16 * (high - low) * rivet_v / 16 * (high - low));
    p.rivet = 1 - smooth_step(0.012, 0.028, from_rivet);
    const double from_boss = std::sqrt(x * x + (y - boss_y) * (y - boss_y));
    p.ring = smooth_step(0.370, 0.382, from_boss) * (1 - smooth_step(0.428, 0.440, from_boss));
    const double slant = (y + x * 0.9) * 2.6;
    const double wave = slant - std::floor(slant);
    const double outside = smooth_step(0.44, 0.46, from_boss) * (1 - p.rim);
    p.stripe = smooth_step(0.28, 0.34, wave) * (1 - smooth_step(0.66, 0.72, wave)) * outside;
    // Hammered iron on the boss.
    p.dent = (1 - smooth_step(0.33, 0.36, from_boss)) * periodic_noise(x * 14, y * 14 + 40, 64, 7);
    return p;
}

double height(double u, double v) {
    const Pattern p = pattern(u, v);
    return 0.016 * p.rim + 0.018 * p.rivet + 0.014 * p.ring + 0.016 * p.stripe + 0.006 * p.dent;
}

glm::dvec3 color(double u, double v) {
    const Pattern p = pattern(u, v);
    const glm::dvec3 paint{0.56, 0.10, 0.12}, gold{0.86, 0.68, 0.27}, iron{0.60, 0.62, 0.66};
    glm::dvec3 c = glm::mix(paint, gold, p.stripe);
    const double x = u * width, y = mix(high, low, v);
    const double from_boss = std::sqrt(x * x + (y - boss_y) * (y - boss_y));
    c = glm::mix(c, iron, 1 - smooth_step(0.362, 0.372, from_boss));
    return glm::mix(c, iron, std::max(p.rim, p.ring));
}

TriangleMesh front() {
    TriangleMesh mesh;
    for (int j = 0; j <= rows; ++j)
        for (int i = -columns; i <= columns; ++i) {
            const double s = double(i) / columns, t = double(j) / rows;
            mesh.add(front_point(s, t), {std::fabs(s), 1 - t});
        }
    constexpr int stride = 2 * columns + 1;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < 2 * columns; ++i) {
            const auto at = std::uint16_t(j * stride + i);
            const auto above = std::uint16_t(at + stride);
            // Diagonals mirror, too, so that nothing but the UVs tells left from right.
            if (i < columns)
                mesh.quad(at, std::uint16_t(at + 1), std::uint16_t(above + 1), above);
            else
                mesh.quad(std::uint16_t(at + 1), std::uint16_t(above + 1), above, at);
        }
    return mesh;
}

// The back and the rim between, which join the front's border point by point. No UVs.
TriangleMesh back() {
    TriangleMesh mesh;
    constexpr int stride = 2 * columns + 1;
    for (int side = 0; side < 2; ++side)
        for (int j = 0; j <= rows; ++j)
            for (int i = -columns; i <= columns; ++i) {
                glm::dvec3 p = front_point(double(i) / columns, double(j) / rows);
                if (side == 0) p.z -= thickness;
                const bool border = j == 0 || j == rows || i == -columns || i == columns;
                if (side == 0 || border) mesh.add(p);
            }
    const auto behind = [](int i, int j) { return std::uint16_t(j * stride + i); };
    const auto before = [](int i, int j) {  // the border points follow, row by row
        const int base = (rows + 1) * stride;
        if (j == 0) return std::uint16_t(base + i);
        if (j == rows) return std::uint16_t(base + stride + 2 * (rows - 1) + i);
        return std::uint16_t(base + stride + 2 * (j - 1) + (i == 0 ? 0 : 1));
    };
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < 2 * columns; ++i)
            mesh.quad(behind(i, j), behind(i, j + 1), behind(i + 1, j + 1), behind(i + 1, j));
    for (int j = 0; j < rows; ++j) {
        constexpr int right = 2 * columns;
        mesh.quad(behind(0, j), before(0, j), before(0, j + 1), behind(0, j + 1));
        mesh.quad(before(right, j), behind(right, j), behind(right, j + 1), before(right, j + 1));
    }
    for (int i = 0; i < 2 * columns; ++i) {
        mesh.quad(behind(i, 0), behind(i + 1, 0), before(i + 1, 0), before(i, 0));
        mesh.quad(before(i, rows), before(i + 1, rows), behind(i + 1, rows), behind(i, rows));
    }
    return mesh;
}

}  // namespace

std::vector<File> shield() {
    const TextureSize size{128, 256, width, high - low};
    GltfBuilder gltf("shield/shield");
    const int clamp =
        gltf.sampler("\"magFilter\":9729,\"minFilter\":9987,\"wrapS\":33071,\"wrapT\":33071");
    const int diffuse = gltf.texture(gltf.image("shield_color", color_png(size, color)), clamp);
    const int normal =
        gltf.texture(gltf.image("shield_normal", normal_map_png(size, height)), clamp);
    const int painted = gltf.material(
        "\"name\":\"painted\",\"normalTexture\":{\"index\":" + std::to_string(normal) +
        "},\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":" + std::to_string(diffuse) +
        "},\"metallicFactor\":0,\"roughnessFactor\":0.35}");
    const int wood = gltf.material(
        "\"name\":\"wood\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.20,0.11,0.05,1],"
        "\"metallicFactor\":0,\"roughnessFactor\":0.8}");
    const int mesh = gltf.mesh("shield");
    gltf.primitive(front(), painted);
    gltf.primitive(back(), wood);
    gltf.node("shield", "\"mesh\":" + std::to_string(mesh));
    return gltf.files();
}

}  // namespace samples
