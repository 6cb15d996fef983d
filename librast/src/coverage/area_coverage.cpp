#include "coverage/area_coverage.h"

#include <algorithm>
#include <cmath>

namespace rast::detail {
namespace {

using Polygon = PixelCoverage::Polygon;

// Pixels. Far above rounding (snapped corners are within 2^15 pixels, whose ulp is 2^-38; corners
// beyond the guard band lose digits with their distance) and far below what a float picture can
// show.
constexpr double on_line = 1e-12;
// Of depth: four of float's steps, in which corners come.
constexpr double same_depth = 0x1p-22;

// Twice the area, from the first corner: a unit square far away would lose digits.
double twice_area(const Polygon& p) {
    double sum = 0;
    for (std::size_t i = 2; i < p.size(); ++i) sum += cross(p[i - 1] - p[0], p[i] - p[0]);
    return sum;
}

// Parts of a convex polygon where a linear function is positive and negative. Values within
// `tolerance` of zero count as zero. A part without corners of its own sign is empty.
template <class Value>
void split(const Polygon& p, const Value& value, double tolerance, Polygon& positive,
           Polygon& negative) {
    positive.clear();
    negative.clear();
    bool above = false, below = false;
    const auto rounded = [&](const glm::dvec2& at) {
        const double v = value(at);
        return std::abs(v) <= tolerance ? 0.0 : v;
    };
    double before = rounded(p.back());
    for (std::size_t i = 0; i < p.size(); ++i) {
        const glm::dvec2 &from = p[i == 0 ? p.size() - 1 : i - 1], &to = p[i];
        const double here = rounded(to);
        above = above || here > 0;
        below = below || here < 0;
        if ((before > 0 && here < 0) || (before < 0 && here > 0)) {
            // From the positive end, so that both neighbours of an edge find the same point.
            const glm::dvec2 &a = before > 0 ? from : to, &b = before > 0 ? to : from;
            const double va = before > 0 ? before : here, vb = before > 0 ? here : before;
            const glm::dvec2 cut = a + (b - a) * (va / (va - vb));
            positive.push_back(cut);
            negative.push_back(cut);
        }
        if (here >= 0) positive.push_back(to);
        if (here <= 0) negative.push_back(to);
        before = here;
    }
    if (!above) positive.clear();
    if (!below) negative.clear();
}

// The lines along a polygon's edges: distances from them, positive on its inner side where its area
// is positive.
struct Line {
    glm::dvec2 a, along;
    double operator()(const glm::dvec2& p) const { return cross(along, p - a); }
};
std::vector<Line> edges_of(const Polygon& p) {
    std::vector<Line> lines;
    lines.reserve(p.size());
    for (std::size_t k = 0; k < p.size(); ++k) {
        const glm::dvec2 &a = p[k], &b = p[k + 1 == p.size() ? 0 : k + 1];
        lines.push_back({a, (b - a) / std::hypot(b.x - a.x, b.y - a.y)});
    }
    return lines;
}

// Positive area, no corner twice; empty where there is no area.
Polygon tidy(const Polygon& polygon) {
    Polygon p;
    for (const glm::dvec2& corner : polygon)
        if (p.empty() ||
            std::max(std::abs(corner.x - p.back().x), std::abs(corner.y - p.back().y)) > on_line)
            p.push_back(corner);
    while (p.size() > 1 && glm::distance(p.front(), p.back()) <= on_line) p.pop_back();
    if (p.size() < 3) return {};
    const double area = twice_area(p);
    if (!(std::abs(area) > 0)) return {};
    if (area < 0) std::reverse(p.begin(), p.end());
    return p;
}

const Polygon& pixel_square() {
    static const Polygon square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    return square;
}

// What of `p` lies inside a polygon of positive area, of which these are the edges; the rest, in
// convex parts, is given to outside(part).
template <class Outside>
Polygon intersect(Polygon p, const std::vector<Line>& by, const Outside& outside) {
    Polygon in, out;
    for (std::size_t k = 0; k < by.size() && !p.empty(); ++k) {
        split(p, by[k], on_line, in, out);
        if (!out.empty() && !in.empty()) outside(out);
        p.swap(in);
    }
    return p;
}

// Leaves of `common` what lies before the far plane, `far` is the rest. Exactly on it all over:
// before it.
void keep_before_far_plane(Polygon& common, const DepthPlane& depth, Polygon& near, Polygon& far) {
    double most = 0;
    for (const glm::dvec2& p : common) most = std::max(most, std::abs(depth(p)));
    split(common, depth, most * same_depth, near, far);
    if (!near.empty() || !far.empty()) common = near;
}

void add_moments(const Polygon& p, double& area, glm::dvec2& first) {
    for (std::size_t i = 2; i < p.size(); ++i) {
        const double a = cross(p[i - 1] - p[0], p[i] - p[0]) / 2;
        area += a;
        first += (p[0] + p[i - 1] + p[i]) * (a / 3);
    }
}

}  // namespace

void PixelCoverage::clear() {
    surfaces_.clear();
    pieces_.assign(1, Piece{pixel_square(), none});
}

bool PixelCoverage::clip_to_pixel(const Polygon& polygon, Polygon& inside, glm::dvec2& centroid) {
    const Polygon p = tidy(polygon);
    if (p.empty()) return false;
    inside = intersect(pixel_square(), edges_of(p), [](const Polygon&) {});
    double area = 0;
    glm::dvec2 first(0);
    add_moments(inside, area, first);
    if (!(area > 0)) return false;
    centroid = first / area;
    return true;
}

void PixelCoverage::add(const Polygon& polygon, const DepthPlane& depth, std::uint32_t owner) {
    const Polygon by = tidy(polygon);
    if (by.empty()) return;
    const auto surface = std::uint32_t(surfaces_.size());
    surfaces_.push_back({depth, owner});
    next_.clear();
    const std::vector<Line> edges = edges_of(by);
    for (const Piece& piece : pieces_) {
        std::vector<Polygon> rest;
        Polygon common =
            intersect(piece.polygon, edges, [&rest](const Polygon& part) { rest.push_back(part); });
        cover(piece, std::move(common), std::move(rest), surface);
    }
    pieces_.swap(next_);
}

bool PixelCoverage::add_to_union(const Polygon& polygon, const DepthPlane& depth) {
    const Polygon by = tidy(polygon);
    if (by.empty()) return !pieces_.empty();
    next_.clear();
    const std::vector<Line> edges = edges_of(by);
    Polygon near, far;
    for (Piece& piece : pieces_) {
        const std::size_t before = next_.size();
        Polygon common = intersect(piece.polygon, edges, [this](const Polygon& part) {
            next_.push_back({part, none});
        });
        if (!common.empty()) {
            keep_before_far_plane(common, depth, near, far);
            if (!far.empty()) next_.push_back({far, none});
        }
        if (!common.empty()) continue;
        next_.resize(before);  // none of it is covered: not cut
        next_.push_back(std::move(piece));
    }
    pieces_.swap(next_);
    return !pieces_.empty();
}

void PixelCoverage::cover(const Piece& piece, Polygon common, std::vector<Polygon> rest,
                          std::uint32_t surface) {
    const DepthPlane& depth = surfaces_[surface].depth;
    Polygon near, far;
    if (!common.empty()) {
        keep_before_far_plane(common, depth, near, far);
        if (!far.empty()) rest.push_back(far);
    }
    if (common.empty()) {
        next_.push_back(piece);
        return;
    }
    if (piece.surface != none) {
        const Surface& front = surfaces_[piece.surface];
        double most = 0;
        for (const glm::dvec2& p : common)
            most = std::max({most, std::abs(depth(p)), std::abs(front.depth(p))});
        split(
            common, [&](const glm::dvec2& p) { return depth(p) - front.depth(p); },
            most * same_depth, near, far);
        if (near.empty() && far.empty())
            (surfaces_[surface].owner < front.owner ? near : far) = common;
        if (near.empty()) {
            next_.push_back(piece);  // behind all over: not cut
            return;
        }
        if (!far.empty()) rest.push_back(far);
        common = near;
    }
    for (const Polygon& part : rest) next_.push_back({part, piece.surface});
    next_.push_back({common, surface});
}

std::vector<PixelCoverage::Share> PixelCoverage::shares() const {
    std::vector<Share> by_surface(surfaces_.size());
    for (std::size_t s = 0; s < surfaces_.size(); ++s) by_surface[s].owner = surfaces_[s].owner;
    for (const Piece& piece : pieces_)
        if (piece.surface != none)
            add_moments(piece.polygon, by_surface[piece.surface].area,
                        by_surface[piece.surface].centroid);
    std::stable_sort(by_surface.begin(), by_surface.end(),
                     [](const Share& a, const Share& b) { return a.owner < b.owner; });
    std::vector<Share> out;
    for (const Share& share : by_surface) {
        if (!out.empty() && out.back().owner == share.owner) {  // parts of one triangle
            out.back().area += share.area;
            out.back().centroid += share.centroid;
        } else {
            out.push_back(share);
        }
    }
    out.erase(std::remove_if(out.begin(), out.end(), [](const Share& s) { return !(s.area > 0); }),
              out.end());
    for (Share& share : out) share.centroid /= share.area;
    return out;
}

double PixelCoverage::empty_area() const {
    double area = 0;
    glm::dvec2 first(0);
    for (const Piece& piece : pieces_)
        if (piece.surface == none) add_moments(piece.polygon, area, first);
    return area;
}

}  // namespace rast::detail
