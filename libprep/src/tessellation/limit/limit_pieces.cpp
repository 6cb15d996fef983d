#include "tessellation/limit/limit_pieces.h"

#include <cmath>

namespace prep::detail {
namespace {

using Points = std::array<glm::dvec3, 16>;

bool overlap(const ParameterBox& a, const ParameterBox& b) {
    return a.low.x < b.high.x && b.low.x < a.high.x && a.low.y < b.high.y && b.low.y < a.high.y;
}

ParameterBox common(const ParameterBox& a, const ParameterBox& b) {
    return {glm::max(a.low, b.low), glm::min(a.high, b.high)};
}

class Collector {
  public:
    Collector(const ChannelSurface& surface, const ParameterBox& box, LimitPieces& pieces)
        : surface_(surface), box_(box), pieces_(pieces) {}

    void node(std::uint32_t level, std::uint32_t face, const ParameterBox& place) {
        if (!overlap(place, box_)) return;
        const PatchNode node = surface_.tree.nodes[level][face];
        switch (node.kind) {
            case PatchNode::regular: {
                const RegularPatch& regular = surface_.tree.regular_patches[node.index];
                const glm::dvec3 origin = origin_of(regular);
                return patch(gather(regular, origin), origin, place);
            }
            case PatchNode::crease:
                return crease(surface_.tree.crease_patches[node.index], place);
            case PatchNode::linear:
                return linear(level, face, place);
            case PatchNode::ring:
                return ring(surface_.tree.sectors[node.index], place);
            default:
                break;
        }
        if (node.kind != PatchNode::split) return;
        const std::uint32_t first = surface_.cage.levels[level].first_child[face];
        const glm::dvec2 half = 0.5 * place.size();
        for (std::uint32_t c = 0; c < 4; ++c) {
            const glm::dvec2 low = place.low + half * glm::dvec2(c == 1 || c == 2, c >= 2);
            this->node(level + 1, first + c, {low, low + half});
        }
    }

  private:
    // Control points about the origin over `place`, cut to the box.
    void patch(const Points& controls, const glm::dvec3& origin, const ParameterBox& place) {
        if (!overlap(place, box_)) return;
        const ParameterBox cut = common(place, box_);
        const glm::dvec2 low = (cut.low - place.low) / place.size();
        const glm::dvec2 high = (cut.high - place.low) / place.size();
        pieces_.patches.push_back(
            {transformed(controls, bezier_weights(low.x, high.x), bezier_weights(low.y, high.y)),
             cut, origin});
    }

    glm::dvec3 origin_of(const RegularPatch& regular) const {
        return vector_at(surface_.values.of(regular.controls[5]));  // never beyond a side
    }
    Points gather(const RegularPatch& regular, const glm::dvec3& origin) const {
        Points p;
        for (std::uint32_t k = 0; k < 16; ++k)
            if (regular.is_set(k))
                p[k] = vector_at(surface_.values.of(regular.controls[k])) - origin;
        const std::uint8_t sides = regular.sharp_sides;
        const auto reflect = [&](std::size_t to, std::size_t near, std::size_t far) {
            p[to] = 2.0 * p[near] - p[far];
        };
        for (std::size_t j = 0; j < 4 && sides & 8; ++j) reflect(4 * j, 4 * j + 1, 4 * j + 2);
        for (std::size_t j = 0; j < 4 && sides & 2; ++j) reflect(4 * j + 3, 4 * j + 2, 4 * j + 1);
        for (std::size_t i = 0; i < 4 && sides & 1; ++i) reflect(i, 4 + i, 8 + i);
        for (std::size_t i = 0; i < 4 && sides & 4; ++i) reflect(12 + i, 8 + i, 4 + i);
        return p;
    }

    // Towards the crease halves are patches, until its sharpness is used up (bicubic.h).
    void crease(const CreasePatch& crease, const ParameterBox& place) {
        const glm::dvec3 origin = origin_of(crease.patch);
        const Points p = gather(crease.patch, origin);
        const bool across_u = crease.side % 2 == 1;
        const bool far = crease.side == 1 || crease.side == 2;
        constexpr CubicWeights same{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
        CubicWeights rows = same;
        double end = 1;  // the interval is 0 … end, from the crease
        const auto piece = [&](const CubicWeights& of, double from, double to) {
            CubicWeights weights = of;
            ParameterBox part = place;
            const glm::length_t axis = across_u ? 0 : 1;
            const double length = place.size()[axis];
            if (far) {
                for (std::size_t r = 0; r < 4; ++r)
                    for (std::size_t k = 0; k < 4; ++k) weights[r][k] = of[3 - r][3 - k];
                part.low[axis] = place.high[axis] - to * length;
                part.high[axis] = place.high[axis] - from * length;
            } else {
                part.low[axis] = place.low[axis] + from * length;
                part.high[axis] = place.low[axis] + to * length;
            }
            patch(across_u ? transformed(p, weights, same) : transformed(p, same, weights), origin,
                  part);
        };
        for (double left = double(surface_.tree.sharpnesses[crease.sharpness]); left > 0;
             left -= 1, end /= 2) {
            std::array<std::array<double, 4>, 5> next;
            const double sharp = std::min(left, 1.0);
            for (std::size_t k = 0; k < 4; ++k) {
                const auto at = [&](std::size_t r) { return rows[r][k]; };
                next[0][k] = 0.5 * (at(0) + at(1));
                next[1][k] = sharp * at(1) + (1 - sharp) * (0.75 * at(1) + 0.125 * (at(0) + at(2)));
                next[2][k] = 0.5 * (at(1) + at(2));
                next[3][k] = 0.75 * at(2) + 0.125 * (at(1) + at(3));
                next[4][k] = 0.5 * (at(2) + at(3));
            }
            piece({next[1], next[2], next[3], next[4]}, end / 2, end);
            rows = {next[0], next[1], next[2], next[3]};
        }
        piece(rows, 0, end);
    }

    void linear(std::uint32_t level, std::uint32_t face, const ParameterBox& place) {
        const RefinedLevel& at = surface_.cage.levels[level];
        const std::uint32_t* const vertices = at.corner_vertices.data() + at.first_corner(face, 4);
        std::array<glm::dvec3, 4> c;
        for (std::size_t k = 0; k < 4; ++k)
            c[k] = vector_at(surface_.values.of(at.first_vertex + vertices[k]));
        BezierPatch out;
        out.box = common(place, box_);
        for (std::size_t j = 0; j < 4; ++j)
            for (std::size_t i = 0; i < 4; ++i) {
                const glm::dvec2 step = glm::dvec2(i, j) / 3.0;
                const glm::dvec2 t =
                    (out.box.low + step * out.box.size() - place.low) / place.size();
                out.p[4 * j + i] = (1 - t.y) * ((1 - t.x) * c[0] + t.x * c[1]) +
                                   t.y * ((1 - t.x) * c[3] + t.x * c[2]);
            }
        pieces_.patches.push_back(out);
    }

    void ring(const RingSector& sector, const ParameterBox& place) {
        // The vertex is at corner r of the face; (a, b) turn with it.
        const std::uint32_t r = sector.corner;
        const glm::dvec2 size = place.size();
        const glm::dvec2 corner = place.low + size * glm::dvec2(r == 1 || r == 2, r >= 2);
        const std::array<glm::dvec2, 4> first{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
        const glm::dvec2 along_a = first[r] * size, along_b = first[(r + 1) % 4] * size;
        const auto turned = [&](const ParameterBox& part) {
            const glm::dvec2 p = corner + part.low.x * along_a + part.low.y * along_b;
            const glm::dvec2 q = corner + part.high.x * along_a + part.high.y * along_b;
            return ParameterBox{glm::min(p, q), glm::max(p, q)};
        };
        RingWalk walk(surface_, sector);
        for (int k = 0;; ++k) {
            const double tip = std::ldexp(1.0, -k);
            const ParameterBox rest = turned({glm::dvec2(0.0), glm::dvec2(tip)});
            if (!overlap(rest, box_)) return;
            const RingWalk::Level level = walk.level(k);
            if (walk.is_last(k, box_.has(rest))) {
                pieces_.tips.push_back(walk.tip(k, level, common(rest, box_)));
                return;
            }
            for (int q = 1; q < 4; ++q) {
                const int qa = q & 1, qb = q >> 1;
                const glm::dvec2 low = 0.5 * tip * glm::dvec2(qa, qb);
                const ParameterBox part = turned({low, low + 0.5 * tip});
                if (!overlap(part, box_)) continue;
                std::array<double, 48> numbers;
                ring_patch(walk.ring().shape, 3, level.rings, level.next, sector.sector, qa, qb,
                           numbers.data());
                Points p;
                for (int b = 0; b < 4; ++b)
                    for (int a = 0; a < 4; ++a) {
                        // Of the face: first a along along_a, then turned.
                        const int i = r == 0 ? a : r == 1 ? 3 - b : r == 2 ? 3 - a : b;
                        const int j = r == 0 ? b : r == 1 ? a : r == 2 ? 3 - b : 3 - a;
                        p[std::size_t(4 * j + i)] = vector_at(numbers.data() + 3 * (4 * b + a));
                    }
                patch(p, walk.centre(), part);
            }
        }
    }

    const ChannelSurface& surface_;
    const ParameterBox& box_;
    LimitPieces& pieces_;
};

}  // namespace

void collect_pieces(const ChannelSurface& surface, std::uint32_t root, const ParameterBox& box,
                    LimitPieces& pieces) {
    pieces.clear();
    const PatchRoot& at = surface.tree.roots[root];
    Collector(surface, box, pieces).node(at.level, at.face, {glm::dvec2(0.0), glm::dvec2(1.0)});
}

}  // namespace prep::detail
