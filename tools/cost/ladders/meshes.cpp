#include "cost/ladders/meshes.h"

#include <random>

namespace cost {

KnownMesh known_torus(int around, int across, double jitter) {
    KnownMesh known;
    std::mt19937_64 random(18);
    const auto moved = [&] { return jitter * (double(random() >> 11) * 0x1p-52 - 1); };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            const Real u = (Real(i) + Real(moved())) / around,
                       v = (Real(j) + Real(moved())) / across;
            known.at.push_back(torus_at(u, v));
            known.mesh.positions.push_back(glm::vec3(known.at.back().position));
        }
    }
    const auto vertex = [&](int i, int j) {
        return std::uint32_t((i % around) * across + j % across);
    };
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        known.mesh.corner_vertices.insert(known.mesh.corner_vertices.end(), {a, b, c});
        known.mesh.face_offsets.push_back(std::uint32_t(known.mesh.corner_vertices.size()));
    };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            const std::uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1),
                                d = vertex(i, j + 1);
            if (random() % 2 == 0) {
                triangle(a, b, c);
                triangle(a, c, d);
            } else {
                triangle(a, b, d);
                triangle(b, c, d);
            }
        }
    }
    return known;
}

std::vector<double> three_of(const std::vector<double>& errors) {
    const Summary s = summary_of(errors);
    return {s.largest, s.p999, s.mean};
}

}  // namespace cost
