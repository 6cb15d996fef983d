// What corner_tangents needs at its peak beside input and output: every allocation is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <numbers>
#include <random>
#include <string>

#include "corner_soup.h"
#include "prep/tangents.h"

namespace {

std::atomic<long> live{0}, peak{0};

// What was asked for stands before the memory, `room` bytes for it.
void* counted(std::size_t size, std::size_t room) {
    void* p = nullptr;
    if (posix_memalign(&p, room, size + room) != 0) throw std::bad_alloc();
    *static_cast<std::size_t*>(p) = size;
    const long now = live += long(size);
    for (long known = peak; now > known && !peak.compare_exchange_weak(known, now);) {
    }
    return static_cast<char*>(p) + room;
}

void discount(void* given, std::size_t room) {
    if (given == nullptr) return;
    void* const p = static_cast<char*>(given) - room;
    live -= long(*static_cast<std::size_t*>(p));
    std::free(p);
}

constexpr std::size_t usual_room = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

}  // namespace

void* operator new(std::size_t size) {
    return counted(size, usual_room);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return counted(size, std::size_t(alignment));
}
void operator delete(void* p) noexcept {
    discount(p, usual_room);
}
void operator delete(void* p, std::size_t) noexcept {
    discount(p, usual_room);
}
void operator delete(void* p, std::align_val_t alignment) noexcept {
    discount(p, std::size_t(alignment));
}
void operator delete(void* p, std::size_t, std::align_val_t alignment) noexcept {
    discount(p, std::size_t(alignment));
}

namespace {

using Index = std::uint32_t;
constexpr double pi = std::numbers::pi;

using Layers = test::IndexedSoup;

// A torus of size² squares, UVs with two seams, cut into triangles or not.
Layers torus(Index size, bool quads = false) {
    Layers m;
    for (Index i = 0; i <= size; ++i) {
        for (Index j = 0; j <= size; ++j) {
            m.uvs.push_back({double(i) / size, double(j) / size});
            if (i == size || j == size) continue;
            const double a = 2 * pi * i / size, b = 2 * pi * j / size;
            const glm::dvec3 out(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
            m.positions.push_back(glm::dvec3(std::cos(a), std::sin(a), 0.0) + 0.4 * out);
            m.normals.push_back(out);
        }
    }
    const auto corner = [&](Index i, Index j) {
        m.vertices.push_back(i % size * size + j % size);
        m.uv_indices.push_back(i * (size + 1) + j);
    };
    for (Index i = 0; i < size; ++i) {
        for (Index j = 0; j < size; ++j) {
            corner(i, j);
            corner(i + 1, j);
            corner(i + 1, j + 1);
            if (!quads) {
                m.end_face();
                corner(i, j);
                corner(i + 1, j + 1);
            }
            corner(i, j + 1);
            m.end_face();
        }
    }
    m.normal_indices = m.vertices;
    return m;
}

// Every `every`-th face has normals of its own, so that its edges are hard.
Layers hard(Layers m, Index every) {
    for (std::size_t f = 0; f + 1 < m.offsets.size(); f += every) {
        for (Index c = m.offsets[f]; c < m.offsets[f + 1]; ++c) {
            const glm::vec3 n = m.normals[m.normal_indices[c]];
            m.normal_indices[c] = Index(m.normals.size());
            m.normals.push_back(glm::normalize(n + glm::vec3(0.1f * float(f % 7), 0, 0.1f)));
        }
    }
    return m;
}

Layers soup(const Layers& from) {
    Layers m;
    m.offsets = from.offsets;
    for (std::size_t c = 0; c < from.vertices.size(); ++c) {
        m.positions.push_back(from.positions[from.vertices[c]]);
        m.normals.push_back(from.normals[from.normal_indices[c]]);
        m.uvs.push_back(from.uvs[from.uv_indices[c]]);
        m.vertices.push_back(Index(c));
    }
    m.normal_indices = m.uv_indices = m.vertices;
    return m;
}

Layers in_random_order(const Layers& from) {
    Layers m = from;
    const std::size_t faces = from.offsets.size() - 1;
    std::vector<std::size_t> order(faces);
    for (std::size_t f = 0; f < faces; ++f) order[f] = f;
    std::mt19937 random(1);
    for (std::size_t f = faces; f-- > 1;) std::swap(order[f], order[random() % (f + 1)]);
    for (std::size_t f = 0; f < faces; ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
            m.vertices[3 * f + k] = from.vertices[3 * order[f] + k];
            m.normal_indices[3 * f + k] = from.normal_indices[3 * order[f] + k];
            m.uv_indices[3 * f + k] = from.uv_indices[3 * order[f] + k];
        }
    }
    return m;
}

// A disc around one vertex, UVs seen from above or around it.
Layers pole(Index valence, bool around) {
    Layers m;
    m.positions = {{0, 0, 0}};
    m.normals = {{0, 0, 1}};
    m.uvs = {{0.5f, 0.5f}};
    for (Index i = 0; i < valence; ++i) {
        const double a = 2 * pi * i / valence, x = std::cos(a), y = std::sin(a);
        m.positions.push_back({x, y, 0});
        m.uvs.push_back(around ? glm::vec2(double(i) / valence, 1)
                               : glm::vec2(0.5 + 0.5 * x, 0.5 - 0.5 * y));
        for (const Index v : {Index(0), i + 1, (i + 1) % valence + 1}) m.vertices.push_back(v);
        m.end_face();
    }
    m.uv_indices = m.vertices;
    m.normal_indices.assign(m.vertices.size(), 0);
    return m;
}

struct Case {
    std::string name;
    Layers mesh;
};

std::vector<Case> cases(std::initializer_list<Index> sizes, std::initializer_list<Index> valences) {
    std::vector<Case> all;
    for (const Index size : sizes) {
        const std::string squares = " of " + std::to_string(size) + " squares by as many";
        const Layers plain = torus(size);
        all.push_back({"torus" + squares, plain});
        all.push_back({"all edges hard" + squares, hard(plain, 1)});
        all.push_back({"half of the faces hard" + squares, hard(plain, 2)});
        all.push_back({"a fifth of the faces hard" + squares, hard(plain, 5)});
        all.push_back({"soup" + squares, soup(plain)});
        all.push_back({"random order" + squares, in_random_order(plain)});
        all.push_back({"random order, hard" + squares, in_random_order(hard(plain, 3))});
        all.push_back({"quads" + squares, torus(size, true)});
        all.push_back({"quads, hard" + squares, hard(torus(size, true), 2)});
    }
    for (const Index valence : valences) {
        const std::string triangles = " of " + std::to_string(valence);
        all.push_back({"pole, UVs from above" + triangles, pole(valence, false)});
        all.push_back({"pole, UVs around" + triangles, pole(valence, true)});
    }
    return all;
}

double bytes_per_triangle(const Layers& mesh, int threads) {
    prep::TangentOptions options;
    options.threads = threads;
    const prep::TangentInput input = mesh.input();
    const long before = live;
    peak = before;
    const auto result = prep::corner_tangents(input, options);
    const long most = peak;
    EXPECT_TRUE(result.has_value());
    const double output = double(result->tangents.values.size() * sizeof(glm::vec4) +
                                 result->tangents.indices.size() * sizeof(Index));
    std::size_t triangles = 0;
    for (std::size_t f = 0; f + 1 < mesh.offsets.size(); ++f)
        triangles += mesh.offsets[f + 1] - mesh.offsets[f] - 2;
    return (double(most - before) - output) / double(triangles);
}

// The limit is the product's own; the most that any of these takes is 115.
TEST(TangentsMemory, StaysBelow120BytesPerTriangle) {
    for (const auto& [name, mesh] : cases({70, 151, 260}, {10000})) {
        EXPECT_LE(bytes_per_triangle(mesh, 1), 120) << name;
    }
}

// Without the word by which the thread sanitizer's tests are chosen: those always have four.
TEST(TangentsMemory, StaysBelow120BytesPerTriangleOnTwoCores) {
    for (const auto& [name, mesh] : cases({101, 151, 182}, {20100})) {
        EXPECT_LE(bytes_per_triangle(mesh, 2), 120) << name;
    }
}

}  // namespace
