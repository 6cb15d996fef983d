// The corners at each vertex, against lists that are made one corner at a time.
#include "vertices/source_corners.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace {

using prep::detail::SourceCorners;
using Index = std::uint32_t;

struct Case {
    std::vector<Index> corner_vertices;
    std::size_t vertices;
    std::vector<std::vector<Index>> lists;  // by vertex
};

Case make(std::size_t corners, std::size_t vertices, Index reach) {
    std::mt19937 random(11);
    Case made{{}, vertices, std::vector<std::vector<Index>>(vertices)};
    for (std::size_t c = 0; c < corners; ++c) {
        // Near its place, or anywhere: then blocks of corners meet at vertices.
        const Index near = Index(c * vertices / corners + random() % reach);
        const Index v = random() % 16 == 0 ? Index(random() % vertices) : Index(near % vertices);
        // Every seventh vertex has none.
        made.corner_vertices.push_back(v % 7 == 3 ? v - 1 : v);
        made.lists[made.corner_vertices.back()].push_back(Index(c));
    }
    return made;
}

void check(const Case& of, const prep::detail::VertexCorners* around, int threads,
           unsigned listed) {
    SourceCorners corners(of.corner_vertices, of.vertices, around, threads);
    std::vector<std::uint8_t> wanted(of.vertices, 0);
    for (std::size_t v = 0; v < of.vertices; ++v)
        wanted[v] = listed > 0 && v % listed == 0 && !of.lists[v].empty();
    corners.make_lists(wanted);
    for (std::size_t v = 0; v < of.vertices; ++v) {
        ASSERT_EQ(corners.is_used(v), !of.lists[v].empty()) << v;
        if (of.lists[v].empty()) continue;
        ASSERT_EQ(corners.first(v), of.lists[v].front()) << v;
        if (wanted[v] == 0) continue;
        const std::span<const Index> list = corners.of(v);
        ASSERT_EQ(std::vector<Index>(list.begin(), list.end()), of.lists[v]) << v;
    }
}

TEST(SourceCorners, AreThoseOfEachVertexWithAnyThreads) {
    for (const auto& [corners, vertices, reach] :
         {std::tuple(0, 0, 1u), std::tuple(3, 12, 3u), std::tuple(700'000, 120'000, 40u),
          std::tuple(500'000, 9, 9u)}) {
        const Case of = make(std::size_t(corners), std::size_t(vertices), reach);
        const auto around =
            prep::detail::corners_by_vertex(of.corner_vertices, std::size_t(vertices), 1);
        for (const int threads : {1, 2, 5})
            for (const unsigned listed : {0u, 1u, 97u}) {
                check(of, nullptr, threads, listed);
                check(of, &around, threads, listed);
            }
    }
}

}  // namespace
