#include <cmath>
#include <string>

#include "gltf_builder.h"
#include "repeatable.h"
#include "sample_files.h"
#include "textures.h"

namespace samples {
namespace {

constexpr double room_size = 3.0, room_height = 2.4, texture_metres = 0.6;

// A flat grid from `corner` along `right` and `up`, seen from right × up; the texture covers
// texture_metres, its top at the top.
TriangleMesh plane(const glm::dvec3& corner, const glm::dvec3& right, const glm::dvec3& up,
                   int columns, int rows) {
    TriangleMesh mesh;
    const double wide = std::sqrt(glm::dot(right, right)), high = std::sqrt(glm::dot(up, up));
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const double s = double(i) / columns, t = double(j) / rows;
            mesh.add(corner + right * s + up * t,
                     {s * wide / texture_metres, (1 - t) * high / texture_metres});
        }
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto at = std::uint16_t(j * (columns + 1) + i);
            const auto above = std::uint16_t(at + columns + 1);
            mesh.quad(at, std::uint16_t(at + 1), std::uint16_t(above + 1), above);
        }
    return mesh;
}

// Bevelled all round, on the floor. Eight corners of three points each; flat faces between them.
TriangleMesh pedestal(const glm::dvec3& centre, const glm::dvec3& half, double bevel) {
    TriangleMesh mesh;
    // Corner c has the sign of axis k in bit k; point k of a corner lies on the face of axis k.
    const auto at = [](int corner, int axis) { return std::uint16_t(corner * 3 + axis); };
    for (int corner = 0; corner < 8; ++corner)
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 p = half - bevel;
            p[axis] = half[axis];
            for (int k = 0; k < 3; ++k)
                if (!(corner >> k & 1)) p[k] = -p[k];
            mesh.add(centre + p);
        }
    for (int axis = 0; axis < 3; ++axis) {
        const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, own = 1 << axis;
        mesh.quad(at(own, axis), at(own | u, axis), at(own | u | v, axis), at(own | v, axis));
        mesh.quad(at(0, axis), at(v, axis), at(u | v, axis), at(u, axis));
        // The four bevels parallel to this axis lie between the faces of the other two.
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        for (int signs = 0; signs < 4; ++signs) {
            const int low = (signs & 1 ? u : 0) | (signs & 2 ? v : 0), high = low | own;
            if (signs == 0 || signs == 3)
                mesh.quad(at(low, b), at(low, c), at(high, c), at(high, b));
            else
                mesh.quad(at(low, c), at(low, b), at(high, b), at(high, c));
        }
    }
    for (int corner = 0; corner < 8; ++corner) {
        const bool positive = ((corner & 1) + (corner >> 1 & 1) + (corner >> 2 & 1)) % 2 == 1;
        const int second = positive ? 1 : 2;
        mesh.indices.insert(mesh.indices.end(),
                            {at(corner, 0), at(corner, second), at(corner, 3 - second)});
    }
    return mesh;
}

TriangleMesh vase(const glm::dvec3& foot) {
    constexpr int around = 28;
    constexpr double profile[][2] = {{0.000, 0.000}, {0.090, 0.000}, {0.105, 0.010}, {0.135, 0.060},
                                     {0.160, 0.120}, {0.170, 0.185}, {0.158, 0.250}, {0.125, 0.305},
                                     {0.085, 0.345}, {0.062, 0.385}, {0.060, 0.425}, {0.080, 0.460},
                                     {0.092, 0.468}, {0.084, 0.470}, {0.052, 0.425}, {0.054, 0.385},
                                     {0.000, 0.360}};
    constexpr int count = int(sizeof profile / sizeof *profile);
    TriangleMesh mesh;
    const std::uint16_t bottom = mesh.add(foot);
    for (int ring = 1; ring + 1 < count; ++ring)
        for (int i = 0; i < around; ++i) {
            const double angle = 2 * pi * i / around;
            mesh.add(foot + glm::dvec3(profile[ring][0] * cosine(angle), profile[ring][1],
                                       -profile[ring][0] * sine(angle)));
        }
    const std::uint16_t inside = mesh.add(foot + glm::dvec3(0, profile[count - 1][1], 0));
    const auto at = [](int ring, int i) {
        return std::uint16_t(1 + (ring - 1) * around + i % around);
    };
    for (int i = 0; i < around; ++i) {
        mesh.indices.insert(mesh.indices.end(), {bottom, at(1, i + 1), at(1, i)});
        for (int ring = 1; ring + 2 < count; ++ring)
            mesh.quad(at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i));
        mesh.indices.insert(mesh.indices.end(), {at(count - 2, i), at(count - 2, i + 1), inside});
    }
    return mesh;
}

// Distance to the border of a cell of the unit square cut into `across` × `down`, every other row
// shifted by half, in metres; and the cell's number.
struct Cell {
    double to_border;
    std::int64_t column, row;
};

Cell cell_at(double u, double v, int across, int down, bool bond) {
    const double y = v * down, row = std::floor(y);
    const auto row_number = std::int64_t(row);
    const double shift = bond && ((row_number % 2 + 2) % 2 == 1) ? 0.5 : 0.0;
    const double x = u * across + shift, column = std::floor(x);
    const double fx = x - column, fy = y - row;
    const double wide = texture_metres / across, high = texture_metres / down;
    const auto wrap = [](std::int64_t i, int n) { return (i % n + n) % n; };
    return {std::min(std::min(fx, 1 - fx) * wide, std::min(fy, 1 - fy) * high),
            wrap(std::int64_t(column), across), wrap(row_number, down)};
}

constexpr int brick_columns = 2, brick_rows = 6, tile_count = 2;

double brick_height(double u, double v) {
    const Cell cell = cell_at(u, v, brick_columns, brick_rows, true);
    const double body = smooth_step(0.005, 0.014, cell.to_border);
    const double grain = periodic_noise(u * 24, v * 24, 24, 1) - 0.5;
    return body * (0.010 + 0.003 * hash01(cell.column, cell.row) + 0.0022 * grain);
}

glm::dvec3 brick_color(double u, double v) {
    const Cell cell = cell_at(u, v, brick_columns, brick_rows, true);
    const double body = smooth_step(0.006, 0.010, cell.to_border);
    const double shade = 0.85 + 0.25 * hash01(cell.column + 10, cell.row);
    const double grain = 0.95 + 0.1 * periodic_noise(u * 24, v * 24, 24, 2);
    return glm::mix(glm::dvec3(0.72, 0.70, 0.66), glm::dvec3(0.66, 0.33, 0.24) * shade, body) *
           grain;
}

double tile_height(double u, double v) {
    const Cell cell = cell_at(u, v, tile_count, tile_count, false);
    return 0.006 * smooth_step(0.003, 0.012, cell.to_border);
}

glm::dvec3 tile_color(double u, double v) {
    const Cell cell = cell_at(u, v, tile_count, tile_count, false);
    const bool dark = (cell.column + cell.row) % 2 == 0;
    const double cloud = periodic_noise(u * 8, v * 8, 8, 3) - 0.5;
    const glm::dvec3 tile =
        (dark ? glm::dvec3(0.34, 0.38, 0.40) : glm::dvec3(0.82, 0.80, 0.75)) + 0.06 * cloud;
    return glm::mix(glm::dvec3(0.45), tile, smooth_step(0.004, 0.006, cell.to_border));
}

}  // namespace

std::vector<File> room() {
    const TextureSize size{128, 128, texture_metres, texture_metres};
    GltfBuilder gltf("room/room");
    const int repeat = gltf.sampler("\"magFilter\":9729,\"minFilter\":9987");
    const auto textured = [&](const std::string& name, const HeightFunction& height,
                              const ColorFunction& color, const char* roughness) {
        const int diffuse =
            gltf.texture(gltf.image(name + "_color", color_png(size, color)), repeat);
        const int normal =
            gltf.texture(gltf.image(name + "_normal", normal_map_png(size, height)), repeat);
        return gltf.material("\"name\":\"" + name +
                             "\",\"normalTexture\":{\"index\":" + std::to_string(normal) +
                             "},\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":" +
                             std::to_string(diffuse) +
                             "},\"metallicFactor\":0,\"roughnessFactor\":" + roughness + "}");
    };
    const auto plain = [&](const std::string& name, const char* color, const char* roughness) {
        return gltf.material("\"name\":\"" + name +
                             "\",\"pbrMetallicRoughness\":{\"baseColorFactor\":" + color +
                             ",\"metallicFactor\":0,\"roughnessFactor\":" + roughness + "}");
    };
    const int brick = textured("brick", brick_height, brick_color, "0.8");
    const int tile = textured("tile", tile_height, tile_color, "0.3");
    const int stone = plain("stone", "[0.55,0.53,0.49,1]", "0.7");
    const int glaze = plain("glaze", "[0.05,0.16,0.36,1]", "0.25");

    const auto object = [&](const std::string& name, const TriangleMesh& triangles, int material) {
        const int mesh = gltf.mesh(name);
        gltf.primitive(triangles, material);
        gltf.node(name, "\"mesh\":" + std::to_string(mesh));
    };
    const double s = room_size, h = room_height;
    object("floor", plane({0, 0, s}, {s, 0, 0}, {0, 0, -s}, 6, 6), tile);
    object("back wall", plane({0, 0, 0}, {s, 0, 0}, {0, h, 0}, 6, 5), brick);
    object("left wall", plane({0, 0, s}, {0, 0, -s}, {0, h, 0}, 6, 5), brick);
    object("pedestal", pedestal({0.95, 0.4, 0.95}, {0.28, 0.4, 0.28}, 0.03), stone);
    object("vase", vase({0.95, 0.8, 0.95}), glaze);

    const auto light = [&](const std::string& name, const std::string& json,
                           const glm::dvec3& position, const glm::dvec4& rotation) {
        const int index = gltf.light("\"name\":\"" + name + "\"," + json);
        gltf.node(
            name,
            "\"extensions\":{\"KHR_lights_punctual\":{\"light\":" + std::to_string(index) + "}}",
            position, rotation);
    };
    light("lamp", "\"type\":\"point\",\"color\":[1,0.86,0.68],\"intensity\":1.9", {1.9, 1.9, 1.2},
          {0, 0, 0, 1});
    light("window", "\"type\":\"directional\",\"color\":[0.75,0.85,1],\"intensity\":0.45", {},
          turned(0.65, -0.6));
    const int camera = gltf.camera(
        "\"name\":\"corner\",\"type\":\"perspective\",\"perspective\":{\"yfov\":0.8,"
        "\"aspectRatio\":1.5,\"znear\":0.05,\"zfar\":20}");
    gltf.node("corner", "\"camera\":" + std::to_string(camera), {2.75, 1.65, 2.95},
              turned(0.755, -0.26));
    return gltf.files();
}

}  // namespace samples
