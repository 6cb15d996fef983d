#include "judge/face_cuts.h"

#include <algorithm>
#include <array>
#include <limits>

#include "cost/measure/surface_distance.h"

namespace judge {
namespace {

using CornerTriple = std::array<std::uint32_t, 3>;

// The triangles by the corners of the first file's face, in an order of their own.
std::vector<CornerTriple> triples_of(const FaceCuts& cuts, std::uint32_t face,
                                     const std::vector<std::uint32_t>& names) {
    std::vector<CornerTriple> out;
    for (std::size_t t = cuts.begin(face); t < cuts.end(face); ++t) {
        CornerTriple triple;
        for (std::uint32_t k = 0; k < 3; ++k)
            triple[k] = names[cuts.cut().corner_in_face(cuts.cut().faces[t], k)];
        std::sort(triple.begin(), triple.end());
        out.push_back(triple);
    }
    std::sort(out.begin(), out.end());
    return out;
}

// Of two segments; the nearest points are ends of one or inside of both.
double segments_apart(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                      const glm::dvec3& d) {
    const auto to = [](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
        return glm::distance(r, cost::nearest_point({p, q, q}, r));
    };
    double least = std::min({to(a, b, c), to(a, b, d), to(c, d, a), to(c, d, b)});
    const glm::dvec3 u = b - a, v = d - c, w = a - c;
    const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v);
    const double area = uu * vv - uv * uv;
    if (area > 0) {
        const double s = (uv * glm::dot(v, w) - vv * glm::dot(u, w)) / area;
        const double t = (uu * glm::dot(v, w) - uv * glm::dot(u, w)) / area;
        // Any two points of them bound it from above, however they were found.
        if (s >= 0 && s <= 1 && t >= 0 && t <= 1)
            least = std::min(least, glm::distance(a + s * u, c + t * v));
    }
    return least;
}

}  // namespace

FaceCuts::FaceCuts(const WorldFaces& faces, const WorldFaces& cut)
    : faces_(faces), cut_(cut), first_(faces.faces.size() + 1) {
    for (const WorldFace& f : cut.faces)
        ++first_[faces.instances[f.instance].first_face + f.face + 1];
    for (std::size_t f = 1; f < first_.size(); ++f) first_[f] += first_[f - 1];
}

double cuts_apart(const FaceCuts& a, const FaceCuts& b, const FacePair& pair) {
    const WorldFace& face = a.faces().faces[pair.a];
    const std::uint32_t count = face.count;
    if (count <= 3) return 0;
    std::vector<std::uint32_t> own(count), partners(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        own[i] = i;
        partners[partner_of(pair, i, count)] = i;
    }
    if (triples_of(a, pair.a, own) == triples_of(b, pair.b, partners)) return 0;
    if (count > 4) return std::numeric_limits<double>::infinity();
    const glm::dvec3* p = &a.faces().points[face.first];
    return segments_apart(p[0], p[2], p[1], p[3]);
}

}  // namespace judge
