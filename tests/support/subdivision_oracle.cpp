#include "subdivision_oracle.h"

#include <algorithm>
#include <map>

#include "subdivision_refinement.h"

namespace test {

namespace {

using namespace subdivision;
using Scheme = SubdivisionRules::Scheme;
using Boundary = SubdivisionRules::Boundary;
using Location = SubdivisionOracle::Location;
using Limit = SubdivisionOracle::Limit;
using Lattice = std::array<std::array<std::uint32_t, 2>, 4>;

// What of a cage is not smooth by its topology alone.
struct CageEdges {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> by_ends;
    std::vector<std::uint32_t> face_count;
    std::vector<bool> non_manifold;
};

std::pair<std::uint32_t, std::uint32_t> ends(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

// As OpenSubdiv documents it, an edge that a face uses twice is an edge for each use, and so is one
// that ends where it begins.
CageEdges connect(Level& cage) {
    CageEdges found;
    struct Use {
        std::uint32_t along = 0, against = 0, last_face = 0;
        bool shared_badly = false;
    };
    std::vector<Use> uses;
    for (std::uint32_t f = 0; f < cage.face_count(); ++f)
        for (std::uint32_t c = cage.offsets[f]; c < cage.offsets[f + 1]; ++c) {
            const std::uint32_t a = cage.vertices[c];
            const std::uint32_t b =
                cage.vertices[c + 1 == cage.offsets[f + 1] ? cage.offsets[f] : c + 1];
            const std::uint32_t fresh = std::uint32_t(cage.all_edges.size());
            std::uint32_t e = found.by_ends.try_emplace(ends(a, b), fresh).first->second;
            if (e != fresh && (a == b || uses[e].last_face == f)) {
                uses[e].shared_badly = true;
                e = fresh;
            }
            if (e == fresh) {
                cage.all_edges.push_back({a, b, 0});
                uses.push_back({0, 0, f, a == b || found.by_ends.at(ends(a, b)) != fresh});
            }
            cage.edges.push_back(e);
            uses[e].last_face = f;
            ++(cage.all_edges[e].v0 == a ? uses[e].along : uses[e].against);
        }
    for (const Use& use : uses) {
        found.face_count.push_back(use.along + use.against);
        found.non_manifold.push_back(use.along > 1 || use.against > 1 || use.shared_badly);
    }
    return found;
}

// Faces around a vertex are one fan when a walk over manifold edges reaches all of them.
bool is_one_fan(const Level& cage, std::span<const std::uint32_t> faces, std::uint32_t vertex) {
    std::vector<std::array<std::uint32_t, 2>> sides;
    for (const std::uint32_t f : faces) {
        const std::uint32_t first = cage.offsets[f], n = cage.offsets[f + 1] - first;
        std::size_t times = 0;
        for (std::uint32_t i = 0; i < n; ++i)
            if (cage.vertices[first + i] == vertex) {
                sides.push_back({cage.edges[first + i], cage.edges[first + (i + n - 1) % n]});
                ++times;
            }
        if (times > 1) return false;
    }
    std::vector<std::size_t> reached{0};
    std::vector<bool> seen(sides.size());
    seen[0] = true;
    for (std::size_t next = 0; next < reached.size(); ++next)
        for (std::size_t other = 0; other < sides.size(); ++other)
            for (const std::uint32_t e : sides[reached[next]])
                if (!seen[other] && (sides[other][0] == e || sides[other][1] == e)) {
                    seen[other] = true;
                    reached.push_back(other);
                }
    return reached.size() == sides.size();
}

Lattice cage_corners(Scheme scheme, std::uint32_t size) {
    if (scheme == Scheme::loop) return {{{0, 0}, {size, 0}, {0, size}, {}}};
    return {{{0, 0}, {size, 0}, {size, size}, {0, size}}};
}

Lattice child_corners(const Lattice& parent, Scheme scheme, std::uint32_t child) {
    const auto middle = [&](std::size_t a, std::size_t b) {
        return std::array{(parent[a][0] + parent[b][0]) / 2, (parent[a][1] + parent[b][1]) / 2};
    };
    if (scheme == Scheme::loop) {
        if (child == 3) return {{middle(0, 1), middle(1, 2), middle(2, 0), {}}};
        return {
            {parent[child], middle(child, (child + 1) % 3), middle(child, (child + 2) % 3), {}}};
    }
    return {{parent[child], middle(child, (child + 1) % 4), middle(0, 2),
             middle(child, (child + 3) % 4)}};
}

// Whether a point is in a face or on its border.
bool contains(const Lattice& face, Scheme scheme, const Location& at) {
    if (scheme != Scheme::loop) {
        const auto [x0, x1] = std::minmax(face[0][0], face[2][0]);
        const auto [y0, y1] = std::minmax(face[0][1], face[2][1]);
        return at.x >= x0 && at.x <= x1 && at.y >= y0 && at.y <= y1;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const auto &a = face[i], &b = face[(i + 1) % 3];
        const std::int64_t side = (std::int64_t(b[0]) - a[0]) * (std::int64_t(at.y) - a[1]) -
                                  (std::int64_t(b[1]) - a[1]) * (std::int64_t(at.x) - a[0]);
        if (side < 0) return false;
    }
    return true;
}

bool is_settled(const Level& level, std::uint32_t vertex) {
    if (is_semi_sharp(level.sharpness[vertex])) return false;
    for (const Edge& edge : level.all_edges)
        if ((edge.v0 == vertex || edge.v1 == vertex) && is_semi_sharp(edge.sharpness)) return false;
    return true;
}

class Descent {
  public:
    Descent(const SubdivisionRules& rules, std::span<const Location> locations, int levels,
            std::span<Limit> limits)
        : rules_(rules), locations_(locations), levels_(levels), limits_(limits) {}

    // `asked` lie in face 0 of the level, whose other faces are those around.
    void descend(const Level& level, const Lattice& corners, int depth,
                 std::vector<std::uint32_t> asked) {
        if (depth == levels_) {
            for (const std::uint32_t k : asked) limits_[k] = at_corner(level, corners, k);
            return;
        }
        const Level next = refine(level, rules_);
        const std::uint32_t children = rules_.scheme == Scheme::loop ? 4 : level.offsets[1];
        for (std::uint32_t child = 0; child < children && !asked.empty(); ++child) {
            const Lattice own = child_corners(corners, rules_.scheme, child);
            const auto first_inside = std::partition(
                asked.begin(), asked.end(),
                [&](std::uint32_t k) { return !contains(own, rules_.scheme, locations_[k]); });
            std::vector<std::uint32_t> inside(first_inside, asked.end());
            asked.erase(first_inside, asked.end());
            if (inside.empty()) continue;
            descend(part_of(next, faces_around(next, child)), own, depth + 1, std::move(inside));
        }
    }

  private:
    Limit at_corner(const Level& level, const Lattice& corners, std::uint32_t k) const {
        const std::uint32_t n = level.offsets[1];
        std::uint32_t corner = 0;
        while (corners[corner][0] != locations_[k].x || corners[corner][1] != locations_[k].y)
            ++corner;
        // Sharpness that is left wears off; the corner stays where it is.
        Level deeper = level;
        Real size = 1;
        std::uint32_t at = corner;
        while (!is_settled(deeper, deeper.vertices[at])) {
            const Level next = refine(deeper, rules_);
            deeper = part_of(next, faces_around(next, at));
            size /= 2;
            at = 0;  // a child starts at its parent's corner
        }
        Limit limit = limit_at(deeper, rules_, 0, at);
        if (!limit.has_derivatives) return limit;
        // From derivatives along both edges to those by x and y.
        const auto difference = [&](std::uint32_t to, int axis) {
            return (Real(corners[to][std::size_t(axis)]) -
                    Real(corners[corner][std::size_t(axis)])) *
                   size / Real(std::uint32_t(1) << levels_);
        };
        const std::uint32_t a = (corner + 1) % n, b = (corner + n - 1) % n;
        const Real ax = difference(a, 0), ay = difference(a, 1);
        const Real bx = difference(b, 0), by = difference(b, 1);
        const Real det = ax * by - ay * bx;
        const Point along_a = limit.du, along_b = limit.dv;
        limit.du = (by * along_a - ay * along_b) / det;
        limit.dv = (ax * along_b - bx * along_a) / det;
        return limit;
    }

    const SubdivisionRules& rules_;
    std::span<const Location> locations_;
    int levels_;
    std::span<Limit> limits_;
};

}  // namespace

SubdivisionOracle::SubdivisionOracle(const prep::Mesh& mesh, const SubdivisionRules& rules)
    : rules_(rules), holes_(mesh.face_count()), vertex_faces_(mesh.positions.size()) {
    for (const glm::vec3& p : mesh.positions) cage_.points.emplace_back(p);
    cage_.offsets = mesh.face_offsets;
    cage_.vertices = mesh.corner_vertices;
    cage_.sharpness.assign(cage_.points.size(), 0);
    const CageEdges edges = connect(cage_);

    for (const prep::EdgeMark& mark : mesh.subdivision.creases)
        if (const auto e = edges.by_ends.find(ends(mark.v0, mark.v1)); e != edges.by_ends.end())
            cage_.all_edges[e->second].sharpness = mark.sharpness;
    for (const prep::VertexMark& mark : mesh.subdivision.corners)
        cage_.sharpness[mark.vertex] = mark.sharpness;
    for (const std::uint32_t face : mesh.subdivision.holes) holes_[face] = true;

    std::vector<bool> at_boundary(cage_.points.size());
    std::vector<std::uint32_t> edge_count(cage_.points.size()), odd_edges(cage_.points.size()),
        spine_edges(cage_.points.size());  // of more than two faces
    for (std::size_t e = 0; e < cage_.all_edges.size(); ++e) {
        Edge& edge = cage_.all_edges[e];
        const bool boundary = edges.face_count[e] < 2;
        if (boundary || edges.non_manifold[e]) edge.sharpness = infinite;
        for (const std::uint32_t v : {edge.v0, edge.v1}) {
            if (boundary) at_boundary[v] = true;
            ++edge_count[v];
            odd_edges[v] += edges.non_manifold[e];
            spine_edges[v] += edges.face_count[e] > 2;
        }
    }
    for (std::uint32_t f = 0; f < cage_.face_count(); ++f)
        for (std::uint32_t c = cage_.offsets[f]; c < cage_.offsets[f + 1]; ++c) {
            auto& faces = vertex_faces_[cage_.vertices[c]];
            if (faces.empty() || faces.back() != f) faces.push_back(f);
        }
    for (std::uint32_t v = 0; v < cage_.points.size(); ++v) {
        const auto& faces = vertex_faces_[v];
        if (faces.empty()) continue;
        const bool non_manifold = odd_edges[v] > 0 || !is_one_fan(cage_, faces, v);
        if (faces.size() == 1 && edge_count[v] == 2) {
            if (rules.boundary != Boundary::edge_only) cage_.sharpness[v] = infinite;
        } else if (non_manifold && !(odd_edges[v] == 2 && spine_edges[v] == 2)) {
            cage_.sharpness[v] = infinite;
        }
        if (rules.boundary == Boundary::none && rules.scheme != Scheme::bilinear && at_boundary[v])
            for (const std::uint32_t f : faces) holes_[f] = true;
    }
    Point low = cage_.points.empty() ? Point{} : cage_.points[0], high = low;
    for (const Point& p : cage_.points) low = glm::min(low, p), high = glm::max(high, p);
    diagonal_ = glm::length(high - low);
}

bool SubdivisionOracle::is_split_in_quads(std::uint32_t face) const {
    return rules_.scheme != Scheme::loop && corner_count(face) != 4;
}

std::vector<Limit> SubdivisionOracle::limits(std::span<const Location> locations,
                                             int levels) const {
    std::vector<Limit> out(locations.size());
    std::map<std::uint32_t, std::vector<std::uint32_t>> by_face;
    for (std::uint32_t k = 0; k < locations.size(); ++k) by_face[locations[k].face].push_back(k);
    Descent descent(rules_, locations, levels, out);
    const Lattice corners = cage_corners(rules_.scheme, std::uint32_t(1) << levels);
    for (const auto& [face, asked] : by_face) {
        std::vector<std::uint32_t> around{face};
        for (std::uint32_t c = cage_.offsets[face]; c < cage_.offsets[face + 1]; ++c)
            for (const std::uint32_t f : vertex_faces_[cage_.vertices[c]])
                if (std::ranges::find(around, f) == around.end()) around.push_back(f);
        const Level level = part_of(cage_, around);
        if (!is_split_in_quads(face)) {
            descent.descend(level, corners, 0, asked);
            continue;
        }
        const Level next = refine(level, rules_);
        for (std::uint32_t child = 0; child < corner_count(face); ++child) {
            std::vector<std::uint32_t> inside;
            for (const std::uint32_t k : asked)
                if (locations[k].sub_face == child) inside.push_back(k);
            if (!inside.empty())
                descent.descend(part_of(next, faces_around(next, child)), corners, 0, inside);
        }
    }
    return out;
}

SubdivisionOracle::Refined SubdivisionOracle::refine_all(int levels) const {
    const std::uint32_t size = std::uint32_t(1) << levels;
    Level level = cage_;
    struct Place {
        std::uint32_t face, sub_face;
        Lattice corners;
    };
    std::vector<Place> places;
    for (std::uint32_t f = 0; f < face_count(); ++f)
        places.push_back({f, 0, cage_corners(rules_.scheme, size)});
    for (int step = 0; step < levels; ++step) {
        const Level next = refine(level, rules_);
        std::vector<Place> children;
        for (std::uint32_t f = 0; f < level.face_count(); ++f) {
            const bool loop = rules_.scheme == Scheme::loop;
            const std::uint32_t count = loop ? 4 : level.offsets[f + 1] - level.offsets[f];
            const bool split = step == 0 && is_split_in_quads(f);
            for (std::uint32_t child = 0; child < count; ++child)
                children.push_back(
                    split ? Place{f, child, cage_corners(rules_.scheme, size)}
                          : Place{places[f].face, places[f].sub_face,
                                  child_corners(places[f].corners, rules_.scheme, child)});
        }
        level = next;
        places = std::move(children);
    }
    Refined out;
    out.control_points = level.points;
    out.limits.resize(level.points.size());
    std::vector<std::vector<std::uint32_t>> faces_of(level.points.size());
    for (std::uint32_t f = 0; f < level.face_count(); ++f)
        for (std::uint32_t c = level.offsets[f]; c < level.offsets[f + 1]; ++c)
            faces_of[level.vertices[c]].push_back(f);
    for (std::uint32_t v = 0; v < level.points.size(); ++v) {
        if (faces_of[v].empty()) continue;
        Level around = part_of(level, faces_of[v]);
        const std::uint32_t f = faces_of[v][0];
        std::uint32_t corner = 0;
        while (level.vertices[level.offsets[f] + corner] != v) ++corner;
        while (!is_settled(around, around.vertices[corner])) {
            const Level next = refine(around, rules_);
            around = part_of(next, faces_around(next, corner));
            corner = 0;
        }
        out.limits[v] = limit_at(around, rules_, 0, corner);
    }
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
        const std::uint32_t n = level.offsets[f + 1] - level.offsets[f];
        std::array<std::uint32_t, 4> corners{};
        for (std::uint32_t i = 0; i < 4; ++i) {
            const std::uint32_t own = std::min(i, n - 1);
            corners[i] = level.vertices[level.offsets[f] + own];
            if (i < n) {
                const auto& lattice = places[f].corners[i];
                out.corners.push_back({places[f].face, places[f].sub_face, lattice[0], lattice[1]});
                out.corner_vertices.push_back(corners[i]);
            }
        }
        out.faces.push_back(corners);
    }
    return out;
}

}  // namespace test
