// Subdivision surfaces by the published rules, in long double: the judge of libprep's. A point is
// found by refining the faces around it, level by level, until it is a vertex, and then by the
// limit masks of that vertex. Nothing here knows patches, eigenvalue formulas of others' code or
// OpenSubdiv.
//
// Rules: Catmull & Clark 1978; Loop 1987; creases of fractional sharpness: DeRose, Kass & Truong
// 1998 (a vertex whose rule changes gets the mean of both rules, weighted by the mean of the
// sharpnesses that end); boundaries and creases of Loop: Biermann, Levin & Zorin 2000; limit
// positions and tangents: Halstead, Kass & DeRose 1993, Biermann et al. 2000 for creases. As
// OpenSubdiv documents it: sharpness 10 and above is infinite; Chaikin's rule for creases that
// change their sharpness; edges with one face, or with more than two, are infinitely sharp; so are
// vertices where faces do not form one fan, unless exactly two edges of three or more faces run
// through them; rule `none` makes holes of the faces at the boundary; triangles may be smoothed
// (0.47).
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "prep/mesh.h"

namespace test {

struct SubdivisionRules {
    enum class Scheme { catmark, loop, bilinear } scheme = Scheme::catmark;
    enum class Boundary { none, edge_and_corner, edge_only } boundary = Boundary::edge_and_corner;
    bool chaikin = false;
    bool smooth_triangles = false;
};

class SubdivisionOracle {
  public:
    using Real = long double;
    using Point = glm::vec<3, Real>;

    // The mesh's faces, positions (about zero, not about its origin) and tags; of these the
    // boundary rule comes from `rules`.
    SubdivisionOracle(const prep::Mesh& mesh, const SubdivisionRules& rules);

    // A point of a face: (x, y) / 2^levels. A quad has its corners at (0, 0), (1, 0), (1, 1), (0,
    // 1), a triangle of Loop's scheme at (0, 0), (1, 0), (0, 1). Every other face is made of a quad
    // for each corner, which runs from that corner (0, 0) along the face's edge to the edge's
    // middle (1, 0) and to the face's middle (1, 1).
    struct Location {
        std::uint32_t face = 0, sub_face = 0;
        std::uint32_t x = 0, y = 0;
    };
    struct Limit {
        Point position{};
        // By (x, y) / 2^levels. Only at regular vertices of the last level: everywhere but at
        // extraordinary vertices and ends of creases.
        Point du{}, dv{};
        bool has_derivatives = false;
        // The unit normal on this face's side, where the rules have one: it is the limit of the
        // normals around. They have none at corners of several faces and at creases where so many
        // faces meet that a mode within them shrinks slower than the crease itself.
        Point normal{};
        bool has_normal = false;
        std::uint32_t valence = 0;  // faces at the vertex, on this side of its creases
    };
    // In the order of the locations; at least one level.
    std::vector<Limit> limits(std::span<const Location> locations, int levels) const;

    // All of the mesh refined `levels` times, and the limits of the result's vertices, seen from
    // one of their faces.
    struct Refined {
        std::vector<Point> control_points;
        std::vector<Limit> limits;
        std::vector<std::array<std::uint32_t, 4>> faces;  // triangles repeat their last vertex
        std::vector<Location> corners;  // 4 (3) for each face: where they are in the cage
        std::vector<std::uint32_t> corner_vertices;
    };
    Refined refine_all(int levels) const;

    // No surface there: holes, and the boundary's faces where the rules say so.
    bool is_hole(std::uint32_t face) const { return holes_[face]; }
    bool is_split_in_quads(std::uint32_t face) const;
    std::size_t face_count() const { return holes_.size(); }
    std::uint32_t corner_count(std::uint32_t face) const {
        return cage_.offsets[face + 1] - cage_.offsets[face];
    }
    Real diagonal() const { return diagonal_; }

    // Faces, edges and their sharpness at one level; around one face, or all of them.
    struct Edge {
        std::uint32_t v0 = 0, v1 = 0;
        Real sharpness = 0;
    };
    struct Level {
        std::vector<Point> points;
        std::vector<Real> sharpness;  // of vertices
        std::vector<std::uint32_t> offsets{0}, vertices,
            edges;  // corners: vertex, edge to the next
        std::vector<Edge> all_edges;
        std::size_t face_count() const { return offsets.size() - 1; }
    };

  private:
    SubdivisionRules rules_;
    Level cage_;
    std::vector<bool> holes_;
    std::vector<std::vector<std::uint32_t>> vertex_faces_;
    Real diagonal_ = 0;
};

}  // namespace test
