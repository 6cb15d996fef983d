#include "tangent_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "parallel.h"
#include "prep/triangulate.h"
#include "tangent_math.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
constexpr std::size_t triangle_grain = 16384;

// Step 1, quads: the shorter UV diagonal, then the shorter position diagonal, then 0–2.
bool cut_along_02(const CornerReader& read, Index begin) {
    const auto squared = [](const glm::vec2& d) { return d.x * d.x + d.y * d.y; };
    const float uv02 = squared(read.uv(begin + 2) - read.uv(begin));
    const float uv13 = squared(read.uv(begin + 3) - read.uv(begin + 1));
    if (uv02 < uv13) return true;
    if (uv13 < uv02) return false;
    const float p02 = mikk::length_squared(read.position(begin + 2) - read.position(begin));
    const float p13 = mikk::length_squared(read.position(begin + 3) - read.position(begin + 1));
    return !(p13 < p02);
}

void add_triangle(TangentMesh& mesh, Index face, Index a, Index b, Index c, std::uint8_t flags) {
    mesh.corners.insert(mesh.corners.end(), {a, b, c});
    mesh.faces.push_back(face);
    mesh.flags.push_back(flags);
}

void cut_into_triangles(const TangentInput& in, const TangentOptions& options, TangentMesh& mesh) {
    const CornerReader read{in};
    const std::size_t faces = in.face_offsets.empty() ? 0 : in.face_offsets.size() - 1;
    Triangulation polygons;  // made only when there is a polygon
    std::size_t next_polygon_triangle = 0;
    mesh.corners.reserve(in.corner_vertices.size());
    mesh.faces.reserve(in.corner_vertices.size() / 3);
    mesh.flags.reserve(in.corner_vertices.size() / 3);
    for (Index f = 0; f < faces; ++f) {
        const Index begin = in.face_offsets[f], count = in.face_offsets[f + 1] - begin;
        if (count == 3) {
            add_triangle(mesh, f, begin, begin + 1, begin + 2, 0);
        } else if (count == 4) {
            mesh.any_quad = true;
            if (cut_along_02(read, begin)) {
                add_triangle(mesh, f, begin, begin + 1, begin + 2, quad_half);
                add_triangle(mesh, f, begin, begin + 2, begin + 3, quad_half);
            } else {
                add_triangle(mesh, f, begin, begin + 1, begin + 3, quad_half);
                add_triangle(mesh, f, begin + 1, begin + 2, begin + 3, quad_half);
            }
        } else if (count > 4 && options.mode == TangentMode::mikktspace) {
            mesh.any_polygon = true;
            if (polygons.triangle_faces.empty()) {
                MeshView view;
                view.positions = in.positions;
                view.face_offsets = in.face_offsets;
                view.corner_vertices = in.corner_vertices;
                polygons = triangulate(view, options.threads);
            }
            while (polygons.triangle_faces[next_polygon_triangle] < f) ++next_polygon_triangle;
            for (Index k = 0; k + 2 < count; ++k) {
                const Index* c = polygons.corners.data() + 3 * (next_polygon_triangle + k);
                add_triangle(mesh, f, c[0], c[1], c[2], 0);
            }
        }
    }
}

// Step 3: degenerate triangles behind the good ones, both in their order.
void move_degenerate_behind(const CornerReader& read, TangentMesh& mesh) {
    const std::size_t triangles = mesh.faces.size();
    std::vector<std::uint8_t> degenerate(triangles);
    std::size_t bad = 0;
    for (std::size_t t = 0; t < triangles; ++t) {
        const glm::vec3 a = read.position(mesh.corners[3 * t]);
        const glm::vec3 b = read.position(mesh.corners[3 * t + 1]);
        const glm::vec3 c = read.position(mesh.corners[3 * t + 2]);
        degenerate[t] = a == b || a == c || b == c;
        bad += degenerate[t];
    }
    mesh.good = triangles - bad;
    if (bad == 0) return;
    for (std::size_t t = 0; t + 1 < triangles; ++t) {
        if (!(mesh.flags[t] & quad_half) || mesh.faces[t] != mesh.faces[t + 1]) continue;
        if (degenerate[t] != degenerate[t + 1]) {
            mesh.flags[t] |= half_degenerate_quad;
            mesh.flags[t + 1] |= half_degenerate_quad;
        }
    }
    TangentMesh sorted;
    std::size_t to_good = 0, to_bad = mesh.good;
    sorted.corners.resize(mesh.corners.size());
    sorted.faces.resize(triangles);
    sorted.flags.resize(triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        const std::size_t to = degenerate[t] ? to_bad++ : to_good++;
        std::copy_n(mesh.corners.begin() + std::ptrdiff_t(3 * t), 3,
                    sorted.corners.begin() + std::ptrdiff_t(3 * to));
        sorted.faces[to] = mesh.faces[t];
        sorted.flags[to] = mesh.flags[t];
    }
    mesh.corners = std::move(sorted.corners);
    mesh.faces = std::move(sorted.faces);
    mesh.flags = std::move(sorted.flags);
}

float uv_area2(const CornerReader& read, const Index* corners) {
    const glm::vec2 t0 = read.uv(corners[0]);
    const glm::vec2 a = read.uv(corners[1]) - t0, b = read.uv(corners[2]) - t0;
    return a.x * b.y - a.y * b.x;
}

// Step 4.
void make_frame(const CornerReader& read, const Index* corners, TriangleFrame& frame,
                std::uint8_t& flags) {
    const glm::vec3 p0 = read.position(corners[0]);
    const glm::vec3 d1 = read.position(corners[1]) - p0, d2 = read.position(corners[2]) - p0;
    const glm::vec2 t0 = read.uv(corners[0]);
    const glm::vec2 a = read.uv(corners[1]) - t0, b = read.uv(corners[2]) - t0;
    const float area2 = a.x * b.y - a.y * b.x;
    const glm::vec3 s = mikk::scaled(b.y, d1) - mikk::scaled(a.y, d2);
    const glm::vec3 t = mikk::scaled(-b.x, d1) + mikk::scaled(a.x, d2);
    flags |= group_with_anything;
    if (area2 > 0) flags |= orientation_preserving;
    if (!mikk::not_zero(area2)) return;
    const float magnitude = std::abs(area2), sign = area2 > 0 ? 1.0f : -1.0f;
    const float s_length = mikk::length(s), t_length = mikk::length(t);
    if (mikk::not_zero(s_length)) frame.s = mikk::scaled(sign / s_length, s);
    if (mikk::not_zero(t_length)) frame.t = mikk::scaled(sign / t_length, t);
    frame.s_length = s_length / magnitude;
    frame.t_length = t_length / magnitude;
    if (mikk::not_zero(frame.s_length) && mikk::not_zero(frame.t_length))
        flags &= std::uint8_t(~group_with_anything);
}

void make_frames(const CornerReader& read, int threads, TangentMesh& mesh) {
    mesh.frames.resize(mesh.good);
    parallel_blocks(mesh.good, triangle_grain, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            make_frame(read, &mesh.corners[3 * t], mesh.frames[t], mesh.flags[t]);
    });
    if (!mesh.any_quad) return;
    // The halves of a quad must agree: the one of the larger UV area decides.
    for (std::size_t t = 0; t + 1 < mesh.good; ++t) {
        if (!(mesh.flags[t] & quad_half) || mesh.faces[t] != mesh.faces[t + 1]) continue;
        std::uint8_t &first = mesh.flags[t], &second = mesh.flags[t + 1];
        if ((first ^ second) & orientation_preserving) {
            const bool first_decides = (second & group_with_anything) ||
                                       std::abs(uv_area2(read, &mesh.corners[3 * t])) >=
                                           std::abs(uv_area2(read, &mesh.corners[3 * (t + 1)]));
            const std::uint8_t orientation =
                (first_decides ? first : second) & orientation_preserving;
            first = std::uint8_t((first & ~orientation_preserving) | orientation);
            second = std::uint8_t((second & ~orientation_preserving) | orientation);
        }
        ++t;
    }
}

// Step 2. The corners' bits, with −0 as 0; NaN equals nothing.
struct CornerKey {
    std::uint32_t words[8];
    bool operator==(const CornerKey& other) const {
        return std::equal(words, words + 8, other.words);
    }
};

bool make_key(const CornerReader& read, Index corner, CornerKey& key) {
    const glm::vec3 p = read.position(corner), n = read.normal(corner);
    const glm::vec2 t = read.uv(corner);
    const float values[8] = {p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y};
    bool number = true;
    for (int k = 0; k < 8; ++k) {
        number &= !std::isnan(values[k]);
        key.words[k] = values[k] == 0.0f ? 0u : std::bit_cast<std::uint32_t>(values[k]);
    }
    return number;
}

std::uint64_t hash_of(const CornerKey& key) {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (int k = 0; k < 8; k += 2) {
        h ^= std::uint64_t(key.words[k]) << 32 | key.words[k + 1];
        h *= 0xbf58476d1ce4e5b9u;
        h ^= h >> 29;
    }
    return h ^ (h >> 32);
}

void weld_corners(const CornerReader& read, TangentMesh& mesh) {
    const std::size_t corners = read.in.corner_vertices.size();
    mesh.welded.assign(corners, no_index);
    const std::size_t capacity = std::bit_ceil(corners * 2 + 2);
    std::vector<Index> table(capacity, no_index);
    std::vector<Index> owner;  // per welded vertex: its first corner
    owner.reserve(corners / 4);
    for (Index c = 0; c < corners; ++c) {
        CornerKey key;
        if (!make_key(read, c, key)) {
            mesh.welded[c] = Index(owner.size());
            owner.push_back(c);
            continue;
        }
        std::size_t slot = hash_of(key) & (capacity - 1);
        for (; table[slot] != no_index; slot = (slot + 1) & (capacity - 1)) {
            CornerKey other;
            make_key(read, owner[table[slot]], other);
            if (other == key) break;
        }
        if (table[slot] == no_index) {
            table[slot] = Index(owner.size());
            owner.push_back(c);
        }
        mesh.welded[c] = table[slot];
    }
    mesh.welded_count = Index(owner.size());
}

}  // namespace

TangentMesh build_tangent_mesh(const TangentInput& input, const TangentOptions& options) {
    const CornerReader read{input};
    TangentMesh mesh;
    cut_into_triangles(input, options, mesh);
    move_degenerate_behind(read, mesh);
    make_frames(read, options.threads, mesh);
    weld_corners(read, mesh);
    return mesh;
}

}  // namespace prep::detail
