// limit_pieces.h, of Loop's scheme, whose positions have no linear pieces.
#include <cmath>

#include "limit_surface/loop_patch.h"
#include "tessellation/limit/limit_pieces.h"

namespace prep::detail {
namespace {

using LoopControls = std::array<glm::dvec3, 12>;
using Frame = LatticeFrame<double>;

double doubled_area(const ParameterTriangle& t) {
    return std::abs(cross_of(t[1] - t[0], t[2] - t[0]));
}

// Whether all of `other` is beyond an edge of `t`, or on it.
bool is_beyond_an_edge(const ParameterTriangle& t, const ParameterTriangle& other) {
    const double side = cross_of(t[1] - t[0], t[2] - t[0]) > 0 ? 1 : -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 along = t[(k + 1) % 3] - t[k];
        if (side * cross_of(along, other[0] - t[k]) <= 0 &&
            side * cross_of(along, other[1] - t[k]) <= 0 &&
            side * cross_of(along, other[2] - t[k]) <= 0)
            return true;
    }
    return false;
}

ParameterTriangle triangle_of(const Frame& frame, double side) {
    return {glm::dvec2(frame.x, frame.y),
            glm::dvec2(frame.x + side * frame.ax, frame.y + side * frame.ay),
            glm::dvec2(frame.x + side * frame.bx, frame.y + side * frame.by)};
}

LoopControls controls_of(const RingShape& shape, const double* rings, const double* next,
                         std::uint32_t sector, int part) {
    std::array<double, 36> numbers;
    ring_patch(shape, 3, rings, next, sector, part & 1, part >> 1, numbers.data());
    LoopControls controls;
    for (std::size_t c = 0; c < 12; ++c) controls[c] = vector_at(numbers.data() + 3 * c);
    return controls;
}

// Where those of a ring's level are, `half` the side of what is left.
Frame part_frame(const Frame& frame, double half, int part) {
    return part == 3 ? frame.moved(half, half).inverted()
                     : frame.moved(part == 1 ? half : 0, part == 2 ? half : 0);
}

class TriangleCollector {
  public:
    TriangleCollector(const ChannelSurface& surface, const ParameterTriangle& asked,
                      const ParameterAxes& axes, LimitPieces& pieces)
        : surface_(surface),
          asked_(asked),
          axes_(axes),
          area_(doubled_area(asked)),
          pieces_(pieces) {}

    void node(std::uint32_t level, std::uint32_t face, const Frame& frame, double side) {
        if (is_apart(triangle_of(frame, side))) return;
        const PatchNode node = surface_.tree.nodes[level][face];
        if (node.kind == PatchNode::regular) {
            const TrianglePatch& regular = surface_.tree.triangle_patches[node.index];
            const glm::dvec3 origin = vector_at(surface_.values.of(regular.terms[0].vertex));
            return patch(gather(regular, origin), origin, frame, side);
        }
        if (node.kind == PatchNode::ring)
            return ring(surface_.tree.sectors[node.index], frame, side);
        if (node.kind != PatchNode::split) return;
        const std::uint32_t first = surface_.cage.levels[level].first_child[face];
        for (std::uint32_t c = 0; c < 4; ++c)
            this->node(level + 1, first + c,
                       child_frame(surface_.cage, level + 1, first, c, frame, side / 2), side / 2);
    }

  private:
    bool is_apart(const ParameterTriangle& other) const {
        return is_beyond_an_edge(asked_, other) || is_beyond_an_edge(other, asked_);
    }

    // Of control points about the origin.
    void patch(const LoopControls& controls, const glm::dvec3& origin, const Frame& frame,
               double side) {
        const ParameterTriangle own = triangle_of(frame, side);
        const TriangleNet<4> points = quartic_points(controls);
        const double size = size_of(points);
        if (doubled_area(own) < area_) {
            pieces_.quartics.push_back(
                {points, own, box_of(own), axes_, origin, quartic_points_error(size)});
            return;
        }
        std::array<glm::dvec3, 3> weights;
        double reach = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 at = asked_[k] - own[0];
            const double u = (frame.by * at.x - frame.bx * at.y) / side;
            const double v = (frame.ax * at.y - frame.ay * at.x) / side;
            weights[k] = {1 - u - v, u, v};
            reach = std::max(reach, std::abs(1 - u - v) + std::abs(u) + std::abs(v));
        }
        pieces_.quartics.push_back({over_triangle(points, weights), asked_, box_of(asked_), axes_,
                                    origin, over_triangle_error(size, reach)});
    }

    // A control's terms have weights that add up to 1.
    LoopControls gather(const TrianglePatch& patch, const glm::dvec3& origin) const {
        LoopControls controls;
        controls.fill(glm::dvec3(0.0));
        for (const TrianglePatch::Term& term : patch.terms)
            controls[term.control] +=
                double(term.weight) * (vector_at(surface_.values.of(term.vertex)) - origin);
        return controls;
    }

    void ring(const RingSector& sector, const Frame& face, double side) {
        const Frame frame = face.at_corner(sector.corner, side);
        const ParameterBox box = box_of(asked_);
        RingWalk walk(surface_, sector);
        for (int k = 0;; ++k, side /= 2) {
            const ParameterTriangle rest = triangle_of(frame, side);
            if (is_apart(rest)) return;
            const RingWalk::Level level = walk.level(k);
            if (walk.is_last(k, box.has(box_of(rest)))) {
                pieces_.tips.push_back(walk.tip(k, level, box_of(rest)));
                return;
            }
            for (int part = 1; part < 4; ++part) {
                const Frame own = part_frame(frame, side / 2, part);
                if (is_apart(triangle_of(own, side / 2))) continue;
                patch(controls_of(walk.ring().shape, level.rings, level.next, sector.sector, part),
                      walk.centre(), own, side / 2);
            }
        }
    }

    const ChannelSurface& surface_;
    const ParameterTriangle& asked_;
    const ParameterAxes& axes_;
    double area_;
    LimitPieces& pieces_;
};

}  // namespace

void collect_pieces(const ChannelSurface& surface, std::uint32_t root,
                    const ParameterTriangle& triangle, const ParameterAxes& axes,
                    LimitPieces& pieces) {
    pieces.clear();
    const PatchRoot& at = surface.tree.roots[root];
    TriangleCollector(surface, triangle, axes, pieces)
        .node(at.level, at.face, {0, 0, 1, 0, 0, 1}, triangle_root_side);
}

}  // namespace prep::detail
