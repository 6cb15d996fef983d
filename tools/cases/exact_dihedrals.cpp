#include "exact_dihedrals.h"

#include <cmath>

#include "shapes.h"

namespace hard_cases {

const std::vector<ExactAngle>& exact_angles() {
    static const std::vector<ExactAngle> angles{
        {30, {1, 1, 0}, {1, 2, 1}, 1, 3, 4},     {45, {1, 0, 0}, {1, 1, 0}, 1, 1, 2},
        {60, {1, 1, 0}, {1, 0, 1}, 1, 1, 4},     {90, {1, 2, 0}, {-2, 1, 5}, 0, 0, 1},
        {120, {1, 1, 0}, {-1, 0, 1}, -1, 1, 4},  {135, {1, 0, 0}, {-1, 1, 0}, -1, 1, 2},
        {150, {1, 1, 0}, {-1, -2, 1}, -1, 3, 4},
    };
    return angles;
}

prep::Mesh exact_dihedrals(const ExactAngle& angle, std::uint32_t count, std::mt19937_64& random) {
    std::uniform_int_distribution<int> stretch(1, 6), slide(-6, 6);
    prep::Mesh mesh;
    for (std::uint32_t i = 0; i < count; ++i) {
        const prep::Mesh wedge = shapes::wedge(angle.n0, angle.n1);
        const std::uint32_t base = std::uint32_t(mesh.vertex_count());
        for (std::uint32_t v = 0; v < 4; ++v) {
            // The wings may be any points of their planes.
            glm::vec3 p = wedge.positions[v];
            if (v >= 2) {
                const float along = float(slide(random));
                p = p * float(stretch(random)) + wedge.positions[1] * along;
            }
            mesh.positions.push_back(p);
        }
        for (const std::uint32_t v : wedge.corner_vertices)
            mesh.corner_vertices.push_back(base + v);
        mesh.face_offsets.push_back(6 * i + 3);
        mesh.face_offsets.push_back(6 * i + 6);
    }
    return mesh;
}

glm::dmat3 exact_rotation(int size, std::mt19937_64& random) {
    std::uniform_int_distribution<int> part(-size, size);
    int w = 0, x = 0, y = 0, z = 0;
    while (w * w + x * x + y * y + z * z == 0) {
        w = part(random);
        x = part(random);
        y = part(random);
        z = part(random);
    }
    return {{w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)},
            {2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)},
            {2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z}};
}

bool transform_exactly(prep::Mesh& mesh, const glm::dmat3& matrix, int exponent) {
    bool exact = true;
    for (glm::vec3& p : mesh.positions) {
        glm::dvec3 q = matrix * glm::dvec3(p);
        for (int k = 0; k < 3; ++k) {
            q[k] = std::ldexp(q[k], exponent);
            exact = exact && double(float(q[k])) == q[k];
        }
        p = glm::vec3(q);
    }
    return exact;
}

}  // namespace hard_cases
