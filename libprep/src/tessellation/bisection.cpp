#include "tessellation/bisection.h"

#include <algorithm>

namespace prep::detail {

// In whole numbers, 2³⁰ to 1, those of a and b side by side: every second halving halves lengths,
// so that so many hold all of them, and no sum of two reaches into its neighbour.
std::array<glm::dvec3, 3> path_weights(std::uint64_t path) {
    constexpr int bits = deepest_bisection / 2;
    constexpr std::uint64_t one = std::uint64_t(1) << bits;
    std::uint64_t a = one << 32, b = one, c = 0;
    // What a bit chooses is chosen by a mask: no branch could be foreseen.
    for (int bit = int(std::bit_width(path)) - 2; bit >= 0; --bit) {
        const std::uint64_t middle = (a + b) >> 1;
        const std::uint64_t second = 0 - (path >> bit & 1);
        const std::uint64_t from = c ^ ((b ^ c) & second), to = a ^ ((a ^ c) & second);
        a = from;
        b = to;
        c = middle;
    }
    const auto three = [](std::uint64_t w) {
        constexpr double unit = 1 / double(one);
        const auto x = std::uint32_t(w >> 32), y = std::uint32_t(w);
        return unit * glm::dvec3(double(x), double(y), double(std::uint32_t(one) - x - y));
    };
    return {three(a), three(b), three(c)};
}

RootPoint BisectionMesh::HalvedEdge::middle() const {
    if (path == 0) return {root, {0, 0, 1}};
    const std::array<glm::dvec3, 3> w = path_weights(path);
    return {root, 0.5 * (w[0] + w[1])};
}

BisectionMesh::BisectionMesh(std::uint32_t vertices, std::span<const FirstTriangle> first)
    : first_vertices_(vertices), vertices_(vertices) {
    triangles_.resize(first.size());
    for (std::size_t t = 0; t < first.size(); ++t) {
        BisectedTriangle& triangle = triangles_[t];
        triangle.vertices = first[t].vertices;
        triangle.next = first[t].next;
        triangle.root = first[t].root;
        if (first[t].other == first[t].root) continue;
        triangle.path = 0;
        triangle.on_border = first[t].is_whole ? 0b111 : 0b110;
        others_.resize(first.size());
        others_[t] = first[t].other;
    }
    news_.first = vertices;
    news_.offsets.push_back(0);
}

void BisectionMesh::take_touched(LargeVector<Touched>& touched) {
    news_.first = vertices_;
    news_.offsets.clear();
    news_.offsets.push_back(0);
    news_.edges.clear();
    std::swap(touched, touched_);
    touched_.clear();
}

std::uint64_t BisectionMesh::cost(std::uint32_t t) {
    std::uint64_t added = 0;
    worklist_.assign(1, t);
    while (!worklist_.empty()) {
        const std::uint32_t h0 = 3 * worklist_.back();
        worklist_.pop_back();
        if (triangles_[h0 / 3].is_whole()) {
            added += 2;
            continue;
        }
        std::uint32_t h = h0;
        do {
            ++added;
            if (is_before(h)) worklist_.push_back(h / 3);
            h = next(h);
        } while (h != h0);
    }
    return added;
}

void BisectionMesh::bisect(std::uint32_t t) {
    worklist_.assign(1, t);
    while (!worklist_.empty()) {
        const std::uint32_t h0 = 3 * worklist_.back();
        if (triangles_[h0 / 3].is_whole()) {
            worklist_.pop_back();
            open(h0 / 3);
            continue;
        }
        std::uint32_t h = next(h0);
        while (h != h0 && !is_before(h)) h = next(h);
        if (h != h0) {
            worklist_.push_back(h / 3);
            continue;
        }
        worklist_.pop_back();
        halve_ring(h0);
    }
}

// Puts `by` in the place of `old` in its ring.
void BisectionMesh::replace(std::uint32_t old, std::uint32_t by) {
    const std::uint32_t after = next(old);
    if (after == old) {
        next(by) = by;
        return;
    }
    std::uint32_t before = after;
    while (next(before) != old) before = next(before);
    next(before) = by;
    next(by) = after;
}

void BisectionMesh::link(std::span<const std::uint32_t> ring) {
    for (std::size_t k = 0; k < ring.size(); ++k) next(ring[k]) = ring[(k + 1) % ring.size()];
}

void BisectionMesh::open(std::uint32_t t) {
    const std::uint32_t centre = vertices_++;
    const BisectedTriangle whole = triangles_[t];
    only_edges_.push_back({0, several_roots});
    news_.edges.push_back({whole.path, whole.root});
    news_.offsets.push_back(std::uint32_t(news_.edges.size()));
    const auto n = std::uint32_t(triangles_.size());
    triangles_.emplace_back();
    triangles_.emplace_back();
    replace(3 * t + 1, 3 * n);
    replace(3 * t + 2, 3 * n + 3);
    const std::array<std::uint32_t, 3> parts{t, n, n + 1};
    const std::array<std::uint32_t, 3> roots{whole.root, others_[t], others_[t] + 1};
    for (std::size_t k = 0; k < 3; ++k) {
        BisectedTriangle& part = triangles_[parts[k]];
        part.vertices = {whole.vertices[k], whole.vertices[(k + 1) % 3], centre};
        part.path = 1;
        part.root = roots[k];
        part.on_border = 1;
        part.next[1] = 3 * parts[(k + 1) % 3] + 2;
        part.next[2] = 3 * parts[(k + 2) % 3] + 1;
        touched_.push_back(as_it_is(parts[k]));
    }
}

void BisectionMesh::halve_ring(std::uint32_t h0) {
    members_.clear();
    std::uint32_t h = h0;
    do {
        members_.push_back(h / 3);
        h = next(h);
    } while (h != h0);
    const std::uint32_t middle = vertices_++;
    const std::uint32_t start = triangles_[members_[0]].vertices[0];
    const bool border_of_root = (triangles_[members_[0]].on_border & 1) != 0;
    const BisectedTriangle& one = triangles_[members_[0]];
    const bool in_one_root =
        !one.is_closed() && std::all_of(members_.begin(), members_.end(), [&](std::uint32_t t) {
            return triangles_[t].root == one.root;
        });
    only_edges_.push_back({one.path, in_one_root ? one.root : several_roots});
    near_.clear();
    far_.clear();
    for (const std::uint32_t t : members_) {
        if (border_of_root || t == members_[0])
            news_.edges.push_back({triangles_[t].path, triangles_[t].root});
        const auto n = std::uint32_t(triangles_.size());
        triangles_.emplace_back();
        const BisectedTriangle old = triangles_[t];
        const auto [a, b, c] = old.vertices;
        replace(3 * t + 1, 3 * n);
        replace(3 * t + 2, 3 * t);
        BisectedTriangle &first = triangles_[t], &second = triangles_[n];
        first.vertices = {c, a, middle};
        second.vertices = {b, c, middle};
        second.root = old.root;
        if (old.is_closed()) {
            first.path = second.path = 1;
            first.root = others_[t];
        } else {
            first.path = 2 * old.path;
            second.path = 2 * old.path + 1;
        }
        // Of the first the edges ca, am and mc; of the second bc, cm and mb.
        first.on_border = std::uint8_t((old.on_border >> 2 & 1) | (old.on_border & 1) << 1);
        second.on_border = std::uint8_t((old.on_border >> 1 & 1) | (old.on_border & 1) << 2);
        first.next[2] = 3 * n + 1;
        second.next[1] = 3 * t + 2;
        (a == start ? near_ : far_).push_back(3 * t + 1);
        (a == start ? far_ : near_).push_back(3 * n + 2);
        touched_.push_back(as_it_is(t));
        touched_.push_back(as_it_is(n));
    }
    link(near_);
    link(far_);
    news_.offsets.push_back(std::uint32_t(news_.edges.size()));
}

}  // namespace prep::detail
