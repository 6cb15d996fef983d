#include "tangents/worklist.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
// A multiple of 64, so that no two blocks have bits in one word.
constexpr std::size_t triangle_grain = 65536;

}  // namespace

void list_split_neighbours(std::span<const Index> vertices, int threads,
                           std::span<std::uint8_t> states) {
    // Numbers, so that three are looked at without branches.
    const auto is_split = [&](std::size_t i) -> unsigned {
        return states[vertices[i]] == split_vertex;
    };
    const std::size_t triangles = vertices.size() / 3;
    std::vector<std::vector<Index>> found((triangles + triangle_grain - 1) / triangle_grain);
    parallel_blocks(triangles, triangle_grain, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = 3 * begin; i < 3 * end; i += 3) {
            if (!(is_split(i) | is_split(i + 1) | is_split(i + 2))) continue;
            for (std::size_t k = 0; k < 3; ++k)
                if (!is_split(i + k)) found[begin / triangle_grain].push_back(vertices[i + k]);
        }
    });
    for (const auto& list : found)
        for (const Index v : list) states[v] = listed_vertex;
}

ListedCorners place_corners(const TangentTriangles& triangles, const Terms& terms,
                            std::span<const Index> vertices, std::span<const std::uint8_t> states,
                            std::span<const Index> places, int threads,
                            std::span<Index> corner_values) {
    ListedCorners result;
    result.lists.resize((triangles.count + triangle_grain - 1) / triangle_grain);
    result.triangles.assign((triangles.count + 63) / 64, 0);
    const bool any_degenerate = terms.counts.degenerate > 0;
    std::atomic<bool> any = false;
    const bool plain = !states.empty() && !any_degenerate && places.empty();
    constexpr std::size_t most_lanes = 16, most_pause = 256, most_found = 1024;
    const FanSearch search = states.size() >> 31 == 0 ? fan_search() : nullptr;
    parallel_blocks(
        triangles.count, triangle_grain, threads, [&](std::size_t begin, std::size_t end) {
            std::vector<Index>& list = result.lists[begin / triangle_grain];
            const std::uint8_t* const state = states.data();
            std::uint64_t* const words = result.triangles.data();
            const bool none_told = states.empty(), placed = !places.empty();
            std::size_t next_search = begin, pause = most_lanes;
            Index members[most_found];
            std::size_t found = 0;
            const auto flush = [&] {
                list.insert(list.end(), members, members + found);
                found = 0;
            };
            for (std::size_t t = begin; t < end; ++t) {
                if (plain && search != nullptr && t >= next_search) {
                    const std::size_t fans = search(state, vertices.data() + 3 * t, end - t);
                    t += fans;
                    // Where there are none, rather not the next time, either.
                    pause = fans > 0 ? most_lanes : std::min(2 * pause, most_pause);
                    next_search = t + pause;
                    if (t == end) break;
                }
                const Index* const v = vertices.data() + 3 * t;
                Index* const values = corner_values.data() + 3 * t;
                if (plain && (state[v[0]] | state[v[1]] | state[v[2]]) == fan_vertex) continue;
                if (any_degenerate && (terms.flags(t) & degenerate_triangle)) {
                    values[0] = values[1] = values[2] = no_index;
                    continue;
                }
                if (placed)
                    for (std::size_t k = 0; k < 3; ++k) values[k] = places[v[k]];
                bool listed[3] = {true, true, true};
                if (!none_told)
                    for (std::size_t k = 0; k < 3; ++k) listed[k] = needs_list(state[v[k]]);
                if (!(listed[0] | listed[1] | listed[2])) continue;
                words[t / 64] |= std::uint64_t(1) << (t % 64);
                if (found + 3 > most_found) flush();
                for (std::size_t k = 0; k < 3; ++k) {
                    if (!listed[k]) continue;
                    values[k] = no_index;
                    members[found++] = Index(4 * t + k);
                }
            }
            flush();
            if (!list.empty()) any = true;
        });
    result.any = any;
    return result;
}

}  // namespace prep::detail
