#include "meshprep/commands/mesh_diff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "prep/triangulate.h"

namespace meshprep {
namespace {

using prep::no_index;

struct Corner {
    glm::vec3 position;
    glm::vec2 uv;
    glm::vec4 value;  // normals: w = 0
    bool present = false;
    std::uint32_t mesh = 0, face = 0, corner = 0;
};

using Triangle = std::array<Corner, 3>;

std::vector<Triangle> triangles_of(const prep::Scene& scene, Attribute attribute) {
    std::vector<Triangle> triangles;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
        const prep::Mesh& mesh = scene.meshes[m];
        const prep::Triangulation t = prep::triangulate(prep::MeshView(mesh));
        for (std::size_t k = 0; k < t.triangle_faces.size(); ++k) {
            Triangle triangle;
            for (std::size_t i = 0; i < 3; ++i) {
                const std::uint32_t c = t.corners[3 * k + i];
                Corner& corner = triangle[i];
                corner.mesh = m;
                corner.face = t.triangle_faces[k];
                corner.corner = c - mesh.face_offsets[corner.face];
                // Rounded to float, so that an origin kept apart makes no difference. −0 becomes 0.
                corner.position =
                    glm::vec3(glm::dvec3(mesh.positions[mesh.corner_vertices[c]]) + mesh.origin) +
                    0.0f;
                if (!mesh.uvs.empty() && !mesh.uvs[0].empty() && mesh.uvs[0].indices[c] != no_index)
                    corner.uv = mesh.uvs[0].values[mesh.uvs[0].indices[c]];
                else
                    corner.uv = glm::vec2(0);
                corner.value = glm::vec4(0);
                if (attribute == Attribute::normals) {
                    if (!mesh.normals.empty() && mesh.normals.indices[c] != no_index) {
                        corner.value = glm::vec4(mesh.normals.values[mesh.normals.indices[c]], 0);
                        corner.present = true;
                    }
                } else if (!mesh.tangents.empty() && mesh.tangents.indices[c] != no_index) {
                    corner.value = mesh.tangents.values[mesh.tangents.indices[c]];
                    corner.present = true;
                }
            }
            triangles.push_back(triangle);
        }
    }
    return triangles;
}

std::array<std::uint32_t, 3> bits(const glm::vec3& v) {
    std::array<std::uint32_t, 3> b;
    std::memcpy(b.data(), &v, sizeof b);
    return b;
}

// The triangle's positions from its smallest corner on: the same for every rotation.
using Key = std::array<std::uint32_t, 9>;
std::pair<Key, int> key_of(const Triangle& t) {
    Key best{};
    int turn = 0;
    for (int r = 0; r < 3; ++r) {
        Key key;
        for (int i = 0; i < 3; ++i) {
            const auto b = bits(t[static_cast<std::size_t>((i + r) % 3)].position);
            std::copy(b.begin(), b.end(), key.begin() + 3 * i);
        }
        if (r == 0 || key < best) {
            best = key;
            turn = r;
        }
    }
    return {best, turn};
}

double uv_distance(const Triangle& a, int turn_a, const Triangle& b, int turn_b) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec2 d(a[static_cast<std::size_t>((i + turn_a) % 3)].uv -
                           b[static_cast<std::size_t>((i + turn_b) % 3)].uv);
        sum += glm::dot(d, d);
    }
    return std::isfinite(sum) ? sum : 1e300;
}

class Comparer {
  public:
    explicit Comparer(Attribute attribute) { out_.attribute = attribute; }

    void compare(const Corner& a, const Corner& b) {
        if (!a.present && !b.present) return;
        ++out_.compared;
        const glm::dvec3 u(a.value), v(b.value);
        const double length_u = glm::length(u), length_v = glm::length(v);
        if (!a.present || !b.present || !(length_u > 0) || !(length_v > 0) ||
            !std::isfinite(length_u) || !std::isfinite(length_v)) {
            ++out_.invalid;
            return;
        }
        out_.identical += std::memcmp(&a.value, &b.value, sizeof a.value) == 0;
        out_.sign_differences += (a.value.w < 0) != (b.value.w < 0);
        constexpr double degrees = 57.29577951308232;
        const glm::dvec3 p = u / length_u, q = v / length_v;
        // Kahan's form: keeps its digits near 0° and near 180°.
        const double angle = 2 * std::atan2(glm::length(p - q), glm::length(p + q)) * degrees;
        angles_.push_back(angle);
        if (angle > 0) worst_.push_back({a.mesh, a.face, a.corner, angle});
        if (worst_.size() > 4096) keep_worst();
    }

    AttributeDiff finish(bool same_order, std::uint64_t unmatched) {
        out_.same_order = same_order;
        out_.unmatched = unmatched;
        keep_worst();
        out_.worst = std::move(worst_);
        if (angles_.empty()) return std::move(out_);
        std::sort(angles_.begin(), angles_.end());
        double sum = 0, squares = 0;
        for (const double angle : angles_) {
            sum += angle;
            squares += angle * angle;
        }
        const auto n = static_cast<double>(angles_.size());
        out_.mean = sum / n;
        out_.rms = std::sqrt(squares / n);
        const std::size_t half = angles_.size() / 2;
        out_.median =
            angles_.size() % 2 == 1 ? angles_[half] : (angles_[half - 1] + angles_[half]) / 2;
        out_.p99 = angles_[(angles_.size() * 99 + 99) / 100 - 1];
        out_.largest = angles_.back();
        return std::move(out_);
    }

  private:
    void keep_worst() {
        std::stable_sort(worst_.begin(), worst_.end(),
                         [](const auto& a, const auto& b) { return a.degrees > b.degrees; });
        if (worst_.size() > 8) worst_.resize(8);
    }

    AttributeDiff out_;
    std::vector<double> angles_;
    std::vector<WorstCorner> worst_;
};

bool same_positions(const std::vector<Triangle>& a, const std::vector<Triangle>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t t = 0; t < a.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i)
            if (bits(a[t][i].position) != bits(b[t][i].position)) return false;
    return true;
}

}  // namespace

bool has_attribute(const prep::Scene& scene, Attribute attribute) {
    return std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const prep::Mesh& mesh) {
        return attribute == Attribute::normals ? !mesh.normals.empty() : !mesh.tangents.empty();
    });
}

prep::Result<AttributeDiff> diff_attribute(const prep::Scene& a, const prep::Scene& b,
                                           Attribute attribute) {
    const char* const name = attribute == Attribute::normals ? "normals" : "tangents";
    for (const prep::Scene* scene : {&a, &b})
        if (!has_attribute(*scene, attribute))
            return prep::Error{
                prep::ErrorCode::invalid,
                std::string("the file carries no ") + name + "; 'meshprep prepare" +
                    (attribute == Attribute::tangents ? " --tangents mikktspace'" : "'") +
                    " writes a copy with them",
                scene->source.string()};
    const std::vector<Triangle> left = triangles_of(a, attribute);
    const std::vector<Triangle> right = triangles_of(b, attribute);
    Comparer comparer(attribute);
    if (same_positions(left, right)) {
        for (std::size_t t = 0; t < left.size(); ++t)
            for (std::size_t i = 0; i < 3; ++i) comparer.compare(left[t][i], right[t][i]);
        return comparer.finish(true, 0);
    }
    std::map<Key, std::vector<std::pair<std::uint32_t, int>>> by_key;
    for (std::uint32_t t = 0; t < right.size(); ++t) {
        const auto [key, turn] = key_of(right[t]);
        by_key[key].emplace_back(t, turn);
    }
    std::uint64_t unmatched = 0, matched = 0;
    for (const Triangle& triangle : left) {
        const auto [key, turn] = key_of(triangle);
        const auto found = by_key.find(key);
        if (found == by_key.end() || found->second.empty()) {
            ++unmatched;
            continue;
        }
        // Of several triangles at one place, the one with the nearest UVs; the first on a tie.
        auto& list = found->second;
        std::size_t best = 0;
        double best_distance = uv_distance(triangle, turn, right[list[0].first], list[0].second);
        for (std::size_t k = 1; k < list.size(); ++k) {
            const double d = uv_distance(triangle, turn, right[list[k].first], list[k].second);
            if (d < best_distance) {
                best = k;
                best_distance = d;
            }
        }
        const auto [other, other_turn] = list[best];
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(best));
        ++matched;
        for (int i = 0; i < 3; ++i)
            comparer.compare(triangle[static_cast<std::size_t>((i + turn) % 3)],
                             right[other][static_cast<std::size_t>((i + other_turn) % 3)]);
    }
    unmatched += right.size() - matched;
    return comparer.finish(false, unmatched);
}

}  // namespace meshprep
