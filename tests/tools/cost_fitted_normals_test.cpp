// Normals of cubics fitted to dense meshes, and those near a torus: against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cost/oracles/fitted_normals.h"
#include "cost/oracles/surfaces.h"

namespace {

using cost::Real;
using cost::Vector;

// A torus of triangles around and across, its vertices by their closed form.
struct TorusMesh {
    std::vector<glm::vec3> positions;
    std::vector<Vector> normals;
    std::vector<std::uint32_t> corners, all;
};
TorusMesh torus_mesh(int around, int across) {
    TorusMesh m;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            const cost::SurfaceSample s =
                cost::torus_at((i + Real(0.3) * (j % 2)) / around, Real(j) / across);
            m.all.push_back(std::uint32_t(m.positions.size()));
            m.positions.push_back(glm::vec3(s.position));
            m.normals.push_back(s.normal);
            const auto at = [&](int a, int b) {
                return std::uint32_t(a % around * across + b % across);
            };
            for (const std::uint32_t v : {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j),
                                          at(i + 1, j + 1), at(i, j + 1)})
                m.corners.push_back(v);
        }
    return m;
}

TEST(CostOracles, FittedNormalsAreThoseOfTheSurface) {
    double last = 12;
    for (const int fine : {1, 2, 4}) {
        const TorusMesh m = torus_mesh(40 * fine, 20 * fine);
        const auto fitted = cost::fitted_normals(m.positions, m.corners, m.all);
        double worst = 0;
        for (std::size_t v = 0; v < fitted.size(); ++v) {
            ASSERT_TRUE(fitted[v].known);
            EXPECT_LT(fitted[v].misfit, 0.02);
            worst = std::max(worst, cost::degrees_between(fitted[v].normal, m.normals[v]));
        }
        EXPECT_LT(worst, last / 6) << fine;  // the third power of the distance: an eighth
        last = worst;
    }
    EXPECT_LT(last, 0.01);
}

TEST(CostOracles, FittedNormalsKnowWhereTheyKnowNothing) {
    // A cube of 10 × 10 squares a side: its edges are where no cubic fits; a sheet has a rim.
    constexpr int n = 10;
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> corners, all;
    const auto vertex = [&](const glm::ivec3& p) {
        for (std::uint32_t v = 0; v < positions.size(); ++v)
            if (positions[v] == glm::vec3(p)) return v;
        positions.push_back(glm::vec3(p));
        all.push_back(std::uint32_t(all.size()));
        return std::uint32_t(positions.size() - 1);
    };
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side <= n; side += n)
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const auto at = [&](int a, int b) {
                        glm::ivec3 p;
                        p[axis] = side;
                        p[(axis + 1) % 3] = side > 0 ? a : b;
                        p[(axis + 2) % 3] = side > 0 ? b : a;
                        return vertex(p);
                    };
                    const std::uint32_t q[4] = {at(i, j), at(i + 1, j), at(i + 1, j + 1),
                                                at(i, j + 1)};
                    corners.insert(corners.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
                }
    const auto fitted = cost::fitted_normals(positions, corners, all, 3);
    std::size_t flat = 0, edges = 0;
    for (std::size_t v = 0; v < positions.size(); ++v) {
        int least = n;  // from the nearest edge
        int inside = 0;
        for (int k = 0; k < 3; ++k)
            if (positions[v][k] != 0 && positions[v][k] != n) {
                ++inside;
                least = std::min({least, int(positions[v][k]), n - int(positions[v][k])});
            }
        ASSERT_TRUE(fitted[v].known) << v;
        if (inside == 2 && least > 3) {
            ++flat;
            EXPECT_LT(fitted[v].misfit, 1e-15);
            const glm::vec3 out = positions[v] - glm::vec3(n / 2.0f);
            Vector normal(0);
            for (int k = 0; k < 3; ++k)
                if (std::abs(out[k]) == n / 2.0f) normal[k] = out[k];
            EXPECT_LT(cost::degrees_between(fitted[v].normal, normal), 1e-12);
        } else if (inside < 2) {
            ++edges;
            EXPECT_GT(fitted[v].misfit, 0.02) << v;
        }
    }
    EXPECT_EQ(flat, 6u * 9u);
    EXPECT_EQ(edges, 8u + 12u * 9u);
    // Rims, single triangles, faces that meet in a point or twice.
    TorusMesh m = torus_mesh(20, 10);
    std::vector<std::uint32_t> open(m.corners.begin() + 6, m.corners.end());
    const auto rim = cost::fitted_normals(m.positions, open, m.all);
    std::size_t unknown = 0;
    for (std::size_t v = 0; v < rim.size(); ++v) unknown += !rim[v].known;
    EXPECT_EQ(unknown, 4u);
    std::vector<std::uint32_t> twice = m.corners;
    twice.insert(twice.end(), m.corners.begin(), m.corners.begin() + 3);
    EXPECT_FALSE(cost::fitted_normals(m.positions, twice, m.all)[m.corners[0]].known);
    const std::vector<std::uint32_t> one = {0, 1, 2}, first = {0};
    EXPECT_FALSE(cost::fitted_normals(m.positions, one, first)[0].known);
}

TEST(CostOracles, NormalsNearATorusAreThoseOfItsNearestPoint) {
    for (const Real u : {Real(0.1), Real(0.6)})
        for (const Real v : {Real(0), Real(0.3), Real(0.8)}) {
            const cost::SurfaceSample s = cost::torus_at(u, v);
            for (const Real off : {Real(-0.2), Real(0), Real(0.3)})
                EXPECT_LT(cost::degrees_between(
                              cost::torus_normal_near(s.position + s.normal * off), s.normal),
                          1e-15);
        }
}

}  // namespace
