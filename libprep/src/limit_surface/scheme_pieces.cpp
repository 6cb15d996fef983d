#include "limit_surface/scheme_pieces.h"

#include "limit_surface/loop_patch.h"

namespace prep::detail {

std::optional<std::uint8_t> QuadPieces::crease_side(const LevelFaces& faces, std::uint32_t face) {
    const std::vector<float>& sharpness = faces.level().sharpness;
    if (sharpness.empty()) return std::nullopt;
    const std::uint32_t begin = faces.begin(face);
    std::uint32_t side = 4;
    for (std::uint32_t c = 0; c < 4; ++c)
        if (sharpness[begin + c] > 0) {
            if (side < 4) return std::nullopt;
            side = c;
        }
    if (side == 4) return std::nullopt;
    const float own = sharpness[begin + side];
    for (std::uint32_t c = 0; c < 4; ++c) {
        const std::uint32_t h = begin + c;
        constexpr std::uint8_t excluded =
            VertexFlags::own_sharpness | VertexFlags::corner_rule | VertexFlags::border;
        if (faces.flags(h) & excluded) return std::nullopt;
        const Fan fan = faces.fan(h);
        if (!fan.closed || fan.sharp_edge || fan.corners.size() != 4) return std::nullopt;
        std::uint32_t sharp = 0, first = 0;
        for (std::uint32_t k = 0; k < 4; ++k) {
            if (faces.size(faces.face(fan.corners[k])) != 4) return std::nullopt;
            const float s = sharpness[fan.corners[k]];
            if (s == 0) continue;
            if (s != own) return std::nullopt;
            if (sharp++ == 0) first = k;
        }
        const bool at_crease = c == side || c == (side + 1) % 4;
        if (sharp != (at_crease ? 2U : 0U)) return std::nullopt;
        if (at_crease && (first > 1 || sharpness[fan.corners[first + 2]] != own))
            return std::nullopt;
    }
    return std::uint8_t(side);
}

RegularPatch QuadPieces::patch(const LevelFaces& faces, std::uint32_t face) {
    const std::uint32_t begin = faces.begin(face);
    // Places of corner c, of what lies beyond its edge, beyond the one before, and diagonally.
    static constexpr std::uint8_t own[4] = {5, 6, 10, 9}, beyond[4] = {1, 7, 14, 8},
                                  beyond_end[4] = {2, 11, 13, 4}, diagonal[4] = {0, 3, 15, 12};
    RegularPatch patch{};
    for (std::uint32_t c = 0; c < 4; ++c) {
        const std::uint32_t h = begin + c;
        patch.controls[own[c]] = faces.control(h);
        const std::uint32_t o = faces.across(h);
        if (o == no_index) {
            patch.sharp_sides = std::uint8_t(patch.sharp_sides | 1U << c);
            continue;
        }
        const std::uint32_t side = faces.next(o), out = faces.next(side);
        patch.controls[beyond[c]] = faces.control(out);
        patch.controls[beyond_end[c]] = faces.control(faces.next(out));
        if (faces.across(begin + (c + 3) % 4) == no_index) continue;
        patch.controls[diagonal[c]] = faces.control(faces.previous(faces.across(side)));
    }
    return patch;
}

bool QuadPieces::is_surrounded(const LevelFaces& faces, std::uint32_t h) {
    const std::uint32_t n1 = faces.next(h), n2 = faces.next(n1);
    return faces.across(n1) != no_index && faces.across(n2) != no_index &&
           faces.across(faces.previous(faces.across(n1))) != no_index;
}

void QuadPieces::ring_points(const LevelFaces& faces, const RingShape& shape, std::uint32_t j,
                             std::uint32_t h, std::uint32_t* points) {
    const std::uint32_t n1 = faces.next(h), n2 = faces.next(n1);
    const std::uint32_t right = faces.next(faces.across(n1));  // from (1,0) out to (2,0)
    const std::uint32_t r2 = faces.next(right), r3 = faces.next(r2);
    const std::uint32_t left = faces.next(faces.across(n2));  // from (1,1) out to (1,2)
    const std::uint32_t l2 = faces.next(left), l3 = faces.next(l2);
    const std::uint32_t far = faces.across(r3);  // from (1,1) to (2,1), in the face between
    points[shape.one_step(j)] = faces.control(n1);
    points[shape.two_steps(j)] = faces.control(r2);
    points[shape.one_step(j + 1)] = faces.control(faces.next(n2));
    points[shape.two_steps(j + 1)] = faces.control(l3);
    points[shape.inner(j, 0)] = faces.control(n2);
    points[shape.inner(j, 1)] = faces.control(r3);
    points[shape.inner(j, 2)] = faces.control(l2);
    points[shape.inner(j, 3)] = faces.control(faces.next(faces.next(far)));
}

// A corner is regular inside with six triangles around it; at a border or crease with three; where
// it is sharp with one.
TrianglePatch TrianglePieces::patch(const LevelFaces& faces, std::uint32_t face) {
    TrianglePatch patch;
    bool set[12] = {};
    const auto put = [&](std::uint32_t control,
                         std::initializer_list<std::pair<std::uint32_t, int>> sum) {
        if (set[control]) return;
        set[control] = true;
        for (const auto& [vertex, weight] : sum)
            patch.terms.push_back({vertex, std::int8_t(weight), std::uint8_t(control)});
    };
    for (std::uint32_t c = 0; c < 3; ++c) put(c, {{faces.control(3 * face + c), 1}});
    for (std::uint32_t c = 0; c < 3; ++c) {
        const Fan fan = faces.fan(3 * face + c);
        const std::uint32_t m = std::uint32_t(fan.corners.size()), v = faces.control(3 * face + c);
        std::uint32_t own = 0;
        while (fan.corners[own] != 3 * face + c) ++own;
        const auto place = [&](std::uint32_t k) { return loop_corner_rings[c][(k + 6 - own) % 6]; };
        const auto neighbour = [&](std::uint32_t k) {
            return k < m ? faces.control(faces.next(fan.corners[k]))
                         : faces.control(faces.previous(fan.corners[m - 1]));
        };
        for (std::uint32_t k = 0; k < m + (fan.closed ? 0 : 1); ++k)
            put(place(k), {{neighbour(k), 1}});
        if (fan.closed) continue;
        put(place(m + 1), {{v, 1}, {neighbour(m), 1}, {neighbour(m - 1), -1}});
        put(place(5), {{v, 1}, {neighbour(0), 1}, {neighbour(1), -1}});
        if (m == 3) continue;
        put(place(3), {{v, 2}, {neighbour(0), -1}});
        put(place(4), {{v, 2}, {neighbour(1), -1}});
    }
    return patch;
}

bool TrianglePieces::is_surrounded(const LevelFaces& faces, std::uint32_t h) {
    const std::uint32_t over = faces.across(faces.next(h));
    return over != no_index && faces.across(faces.next(over)) != no_index &&
           faces.across(faces.previous(over)) != no_index;
}

void TrianglePieces::ring_points(const LevelFaces& faces, const RingShape& shape, std::uint32_t j,
                                 std::uint32_t h, std::uint32_t* points) {
    const std::uint32_t outer = faces.next(h), over = faces.across(outer);  // from (0,1) to (1,0)
    const std::uint32_t right = faces.across(faces.next(over));             // from (1,1) to (1,0)
    const std::uint32_t left = faces.across(faces.previous(over));          // from (0,1) to (1,1)
    points[shape.one_step(j)] = faces.control(outer);
    points[shape.one_step(j + 1)] = faces.control(faces.next(outer));
    points[shape.inner(j, 0)] = faces.control(faces.previous(over));
    points[shape.two_steps(j)] = faces.control(faces.previous(right));
    points[shape.two_steps(j + 1)] = faces.control(faces.previous(left));
}

}  // namespace prep::detail
