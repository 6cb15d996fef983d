// Small scenes for the rasterizer's tests, built without any of libprep's algorithms.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "prep/prepare.h"
#include "rast/render.h"

namespace test {

inline prep::PreparedScene scene_of(prep::VertexMesh mesh, const prep::Material& material = {}) {
    prep::PreparedScene out;
    if (mesh.ranges.empty())
        mesh.ranges.push_back({0, std::uint32_t(mesh.triangle_count()), 0, prep::no_index});
    out.scene.meshes.emplace_back();
    out.scene.materials.push_back(material);
    prep::Node node;
    node.mesh = 0;
    out.scene.nodes.push_back(node);
    out.meshes.push_back(std::move(mesh));
    return out;
}

// A UV sphere with unit normals: vertices on rings, top to bottom, one column twice for the UVs.
inline prep::VertexMesh sphere(std::uint32_t around, std::uint32_t down, double radius = 1,
                               const glm::dvec3& centre = {0, 0, 0}) {
    prep::VertexMesh mesh;
    mesh.uvs.emplace_back();
    for (std::uint32_t j = 0; j <= down; ++j) {
        for (std::uint32_t i = 0; i <= around; ++i) {
            const double theta = std::numbers::pi * j / down;
            const double phi = 2 * std::numbers::pi * (i % around) / around;
            glm::dvec3 n(std::sin(theta) * std::sin(phi), std::cos(theta),
                         std::sin(theta) * std::cos(phi));
            if (j == 0) n = {0, 1, 0};
            if (j == down) n = {0, -1, 0};
            mesh.positions.push_back(glm::vec3(centre + n * radius));
            mesh.normals.push_back(glm::vec3(n));
            mesh.uvs[0].push_back({float(i) / float(around), float(j) / float(down)});
        }
    }
    const std::uint32_t row = around + 1;
    for (std::uint32_t j = 0; j < down; ++j) {
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t a = j * row + i, b = a + row, c = b + 1, d = a + 1;
            if (j + 1 < down) mesh.indices.insert(mesh.indices.end(), {a, b, c});
            if (j > 0) mesh.indices.insert(mesh.indices.end(), {a, c, d});
        }
    }
    return mesh;
}

// An orthographic view from +z that shows y from −half to half over the picture's height.
inline rast::View flat_view(double half) {
    rast::View view;
    view.perspective = false;
    view.half_height = half;
    view.znear = 0;
    view.zfar = 100;
    view.world_to_view[3] = glm::dvec4(0, 0, -50, 1);
    return view;
}

inline rast::View look_at(const glm::dvec3& eye, const glm::dvec3& target, double yfov = 0.8,
                          double znear = 0.01) {
    const glm::dvec3 back = glm::normalize(eye - target);
    const glm::dvec3 hint = std::abs(back.y) > 0.99 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(hint, back));
    const glm::dmat3 rotation = glm::transpose(glm::dmat3(right, glm::cross(back, right), back));
    rast::View view;
    view.yfov = yfov;
    view.znear = znear;
    view.world_to_view = glm::dmat4(rotation);
    view.world_to_view[3] = glm::dvec4(-(rotation * eye), 1.0);
    return view;
}

inline rast::Frame draw(const prep::PreparedScene& scene, const rast::RenderRequest& request) {
    const auto plan = rast::plan(scene, request);
    if (!plan) throw std::runtime_error(to_string(plan.error()));
    auto frame = rast::render(scene, *plan);
    if (!frame) throw std::runtime_error(to_string(frame.error()));
    return *std::move(frame);
}

}  // namespace test
