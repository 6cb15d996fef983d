// Cages, heights of closed form, and checks of tessellated meshes that share nothing with how they
// are made.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "prep/displacement/tessellate.h"

namespace tessellation_checks {

// Scale · sin(kx u + px) sin(ky v + py): second derivatives are at most scale · k².
class Waves final : public prep::HeightFunction {
  public:
    Waves(double scale, double kx, double ky, double phase = 0)
        : scale_(scale), kx_(kx), ky_(ky), phase_(phase) {}
    Sample at(const glm::dvec2& uv) const override {
        const double x = kx_ * uv.x + phase_, y = ky_ * uv.y + phase_;
        return {
            scale_ * std::sin(x) * std::sin(y),
            scale_ * glm::dvec2(kx_ * std::cos(x) * std::sin(y), ky_ * std::sin(x) * std::cos(y))};
    }
    double deviation(const std::array<glm::dvec2, 3>& uv, const std::array<double, 3>& values,
                     double) const override {
        const glm::dvec2 size =
            glm::max(uv[0], glm::max(uv[1], uv[2])) - glm::min(uv[0], glm::min(uv[1], uv[2]));
        const double a = size.x * kx_, b = size.y * ky_;
        double off = 0;
        for (std::size_t k = 0; k < 3; ++k)
            off = std::max(off, std::abs(values[k] - at(uv[k]).value));
        const double highest =
            std::max({std::abs(values[0]), std::abs(values[1]), std::abs(values[2])});
        return off + std::min(std::abs(scale_) * (a + b) * (a + b) / 8, std::abs(scale_) + highest);
    }

  private:
    double scale_, kx_, ky_, phase_;
};

// A bilinear map of size² texels, all 0 but one.
class Spike final : public prep::HeightFunction {
  public:
    Spike(double size, double x, double y, double height)
        : size_(size), x_(x), y_(y), height_(height) {}
    Sample at(const glm::dvec2& uv) const override {
        const double x = uv.x * size_ - 0.5 - x_, y = uv.y * size_ - 0.5 - y_;
        const double tx = std::max(0.0, 1 - std::abs(x)), ty = std::max(0.0, 1 - std::abs(y));
        if (tx == 0 || ty == 0) return {};
        return {height_ * tx * ty,
                height_ * size_ * glm::dvec2(x < 0 ? ty : -ty, y < 0 ? tx : -tx)};
    }
    double deviation(const std::array<glm::dvec2, 3>& uv, const std::array<double, 3>& values,
                     double) const override {
        glm::dvec2 low = glm::min(uv[0], glm::min(uv[1], uv[2])) * size_ - 0.5;
        glm::dvec2 high = glm::max(uv[0], glm::max(uv[1], uv[2])) * size_ - 0.5;
        low -= glm::dvec2(x_, y_);
        high -= glm::dvec2(x_, y_);
        const auto [least, most] = std::minmax({values[0], values[1], values[2]});
        const auto peak = [](double from, double to) {
            const double nearest = from > 0 ? from : to < 0 ? -to : 0;
            return std::max(0.0, 1 - nearest);
        };
        const double top = height_ * peak(low.x, high.x) * peak(low.y, high.y);
        double bound = std::max(top - least, most);
        const auto one_cell = [](double from, double to) { return from >= 0 || to <= 0; };
        const glm::dvec2 size = high - low;
        if (one_cell(low.x, high.x) && one_cell(low.y, high.y) && low.x >= -1 && high.x <= 1 &&
            low.y >= -1 && high.y <= 1)
            bound = std::min(bound, height_ * size.x * size.y / 4);
        return bound;
    }

  private:
    double size_, x_, y_, height_;
};

inline void add_face(prep::Mesh& mesh, const std::vector<std::uint32_t>& vertices) {
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), vertices.begin(), vertices.end());
    mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
}

inline prep::Mesh cube() {
    prep::Mesh mesh;
    for (int k = 0; k < 8; ++k)
        mesh.positions.emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    for (const auto& f : std::vector<std::vector<std::uint32_t>>{
             {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
        add_face(mesh, f);
    return mesh;
}

// Two n-gons and n quads.
inline prep::Mesh prism(std::uint32_t n) {
    prep::Mesh mesh;
    std::vector<std::uint32_t> bottom, top;
    for (std::uint32_t k = 0; k < n; ++k) {
        const double angle = 2 * std::numbers::pi * k / n;
        for (const double z : {-0.7, 0.8})
            mesh.positions.emplace_back(std::cos(angle), std::sin(angle), z);
        bottom.insert(bottom.begin(), 2 * k);
        top.push_back(2 * k + 1);
    }
    add_face(mesh, bottom);
    add_face(mesh, top);
    for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t l = (k + 1) % n;
        add_face(mesh, {2 * k, 2 * l, 2 * l + 1, 2 * k + 1});
    }
    return mesh;
}

// Quads around a torus; `holes` handles would need more, one is enough: genus 1.
inline prep::Mesh torus(std::uint32_t around, std::uint32_t across) {
    prep::Mesh mesh;
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const double a = 2 * std::numbers::pi * i / around,
                         b = 2 * std::numbers::pi * j / across;
            const double r = 2 + 0.8 * std::cos(b);
            mesh.positions.emplace_back(r * std::cos(a), r * std::sin(a), 0.8 * std::sin(b));
        }
    const auto at = [&](std::uint32_t i, std::uint32_t j) {
        return i % around * across + j % across;
    };
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j)
            add_face(mesh, {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    return mesh;
}

// Joints that move nothing.
inline prep::SkinInfluences unweighted(const prep::Mesh& mesh) {
    prep::SkinInfluences set;
    set.joints.resize(mesh.vertex_count());
    set.weights.resize(mesh.vertex_count());
    return set;
}

inline prep::Mesh unit_quad() {
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    add_face(mesh, {0, 1, 2, 3});
    mesh.uvs.resize(1);
    mesh.uvs[0].values = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.uvs[0].indices = {0, 1, 2, 3};
    return mesh;
}

// Every face a chart of its own, turned, scaled and mirrored by chance: all edges are seams.
inline void add_charts(prep::Mesh& mesh, std::mt19937& random) {
    std::uniform_real_distribution<double> number(0, 1);
    prep::CornerLayer<glm::vec2> layer;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t first = mesh.face_offsets[f], n = mesh.face_offsets[f + 1] - first;
        const double turn = 2 * std::numbers::pi * number(random), size = 0.2 + number(random);
        const double mirror = number(random) < 0.5 ? -1 : 1;
        const glm::dvec2 place(number(random), number(random));
        for (std::uint32_t k = 0; k < n; ++k) {
            const double angle = turn + mirror * 2 * std::numbers::pi * k / n;
            layer.indices.push_back(std::uint32_t(layer.values.size()));
            layer.values.emplace_back(place + size * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
    }
    mesh.uvs.assign(1, layer);
}

// Of a mesh whose points of equal bits are one.
struct Closedness {
    std::uint64_t open_edges = 0;  // not used exactly once each way
    std::uint64_t zero_edges = 0;
    std::int64_t euler = 0;  // vertices − edges + faces
};
inline Closedness closedness(const prep::Mesh& mesh) {
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> points;
    std::vector<std::uint32_t> point(mesh.vertex_count());
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        std::array<std::uint32_t, 3> bits;
        for (int k = 0; k < 3; ++k)
            bits[std::size_t(k)] = std::bit_cast<std::uint32_t>(mesh.positions[v][k] + 0.0F);
        point[v] = points.emplace(bits, std::uint32_t(points.size())).first->second;
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    std::set<std::uint32_t> used;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t first = mesh.face_offsets[f], n = mesh.face_offsets[f + 1] - first;
        for (std::uint32_t k = 0; k < n; ++k) {
            const std::uint32_t a = point[mesh.corner_vertices[first + k]];
            const std::uint32_t b = point[mesh.corner_vertices[first + (k + 1) % n]];
            ++edges[{a, b}];
            used.insert(a);
        }
    }
    Closedness result;
    std::int64_t count = 0;
    for (const auto& [edge, times] : edges) {
        const auto back = edges.find({edge.second, edge.first});
        if (edge.first == edge.second) ++result.zero_edges;
        if (times != 1 || back == edges.end() || back->second != 1) ++result.open_edges;
        if (edge.first < edge.second || back == edges.end()) ++count;
    }
    result.euler = std::int64_t(used.size()) - count + std::int64_t(mesh.face_count());
    return result;
}

inline bool same_bytes(const prep::Mesh& a, const prep::Mesh& b) {
    const auto same = [](const auto& x, const auto& y) {
        return x.size() == y.size() &&
               (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0);
    };
    bool all = same(a.positions, b.positions) && same(a.corner_vertices, b.corner_vertices) &&
               same(a.face_offsets, b.face_offsets) && same(a.normals.values, b.normals.values) &&
               same(a.normals.indices, b.normals.indices) && a.uvs.size() == b.uvs.size();
    for (std::size_t k = 0; all && k < a.uvs.size(); ++k)
        all = same(a.uvs[k].values, b.uvs[k].values) && same(a.uvs[k].indices, b.uvs[k].indices);
    return all;
}

}  // namespace tessellation_checks
