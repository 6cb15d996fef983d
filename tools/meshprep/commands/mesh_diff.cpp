#include "meshprep/commands/mesh_diff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "base/step_count.h"
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

// The triangle's UVs in the order of its key. −0 becomes 0.
using Uvs = std::array<float, 6>;
Uvs uvs_of(const Triangle& t, int turn) {
    Uvs uvs;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::vec2 uv = t[(i + std::size_t(turn)) % 3].uv + 0.0f;
        uvs[2 * i] = uv.x;
        uvs[2 * i + 1] = uv.y;
    }
    return uvs;
}

bool is_finite(const Uvs& uvs) {
    return std::all_of(uvs.begin(), uvs.end(), [](float x) { return std::isfinite(x); });
}

// Squared; no less than any of its terms, rounding included.
double uv_distance(const Uvs& a, const Uvs& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); k += 2) {
        const glm::dvec2 d(a[k] - b[k], a[k + 1] - b[k + 1]);
        sum += glm::dot(d, d);
    }
    return sum;
}

struct CoincidentMember {
    Uvs uvs;
    std::uint32_t triangle;
    int turn;
};

constexpr std::size_t no_member = std::size_t(-1);

// The members of finite UVs, equal ones together, from which the nearest is taken.
class UvRuns {
  public:
    explicit UvRuns(const std::vector<CoincidentMember>& members)
        : taken_(members.size()), run_of_(members.size(), no_member) {
        axis_ = most_varied(members);
        const auto before = [this](const Uvs& a, const Uvs& b) { return is_before(a, b); };
        std::map<Uvs, std::vector<std::size_t>, decltype(before)> by_uvs(before);
        for (std::size_t m = 0; m < members.size(); ++m)
            if (is_finite(members[m].uvs)) by_uvs[members[m].uvs].push_back(m);
        for (auto& [uvs, list] : by_uvs) {
            const std::size_t at = runs_.size();
            for (const std::size_t m : list) run_of_[m] = at;
            runs_.push_back({uvs, std::move(list), 0, at - 1, at + 1});
        }
    }

    bool is_taken(std::size_t member) const { return taken_[member]; }
    // The first of its run that is left.
    void take(std::size_t member) {
        taken_[member] = true;
        if (run_of_[member] != no_member) ++runs_[run_of_[member]].taken;
    }

    // None where nothing is left, or nothing at a finite distance.
    std::size_t nearest(const Uvs& uvs) {
        const auto from =
            std::lower_bound(runs_.begin(), runs_.end(), uvs,
                             [this](const Run& r, const Uvs& u) { return is_before(r.uvs, u); });
        const auto start = std::size_t(from - runs_.begin());
        std::size_t best = no_member, steps = 1;
        double best_distance = std::numeric_limits<double>::infinity();
        // Whether to go on to those that are farther along the axis.
        const auto look_at = [&](std::size_t run) {
            ++steps;
            const double along = runs_[run].uvs[axis_] - uvs[axis_];
            if (along * along > best_distance) return false;
            const double d = uv_distance(runs_[run].uvs, uvs);
            if (d < best_distance ||
                (d == best_distance && best != no_member && first(run) < first(best))) {
                best = run;
                best_distance = d;
            }
            return true;
        };
        // One on either side in turn: what is near is found before what is far. Equal ones come
        // first, and nothing else is as near.
        std::size_t up = open_from<&Run::after>(start);
        std::size_t down = open_from<&Run::before>(start - 1);
        while (best_distance > 0 && (up < runs_.size() || down < runs_.size())) {
            if (up < runs_.size()) up = look_at(up) ? open_from<&Run::after>(up + 1) : runs_.size();
            if (best_distance > 0 && down < runs_.size())
                down = look_at(down) ? open_from<&Run::before>(down - 1) : runs_.size();
        }
        prep::detail::count_steps(steps);
        return best == no_member ? no_member : first(best);
    }

  private:
    struct Run {
        Uvs uvs;
        std::vector<std::size_t> members;  // in order
        std::size_t taken = 0;
        std::size_t before = 0, after = 0;  // where to go on if all are taken
    };

    // The one of their six values that has the most different ones.
    static std::size_t most_varied(const std::vector<CoincidentMember>& members) {
        std::size_t axis = 0, most = 0;
        std::vector<float> values;
        for (std::size_t k = 0; k < std::tuple_size_v<Uvs>; ++k) {
            values.clear();
            for (const CoincidentMember& m : members)
                if (is_finite(m.uvs)) values.push_back(m.uvs[k]);
            std::sort(values.begin(), values.end());
            const auto different =
                std::size_t(std::unique(values.begin(), values.end()) - values.begin());
            if (different > most) axis = k;
            most = std::max(most, different);
        }
        return axis;
    }

    bool is_before(const Uvs& a, const Uvs& b) const {
        return a[axis_] != b[axis_] ? a[axis_] < b[axis_] : a < b;
    }

    std::size_t first(std::size_t run) const { return runs_[run].members[runs_[run].taken]; }

    // The next run from `at` on, on one side, of which something is left; none of them where there
    // is none. The way there is shortened for the next time.
    template <std::size_t Run::*next>
    std::size_t open_from(std::size_t at) {
        std::size_t end = at;
        while (end < runs_.size() && runs_[end].taken == runs_[end].members.size())
            end = runs_[end].*next;
        while (at != end) at = std::exchange(runs_[at].*next, end);
        return end;
    }

    std::vector<bool> taken_;          // by member
    std::vector<std::size_t> run_of_;  // by member; none: not finite
    std::size_t axis_ = 0;             // of UVs, along which runs are sorted
    std::vector<Run> runs_;
};

// Triangles of the second file at one place, of which each is taken once: the one with the nearest
// UVs, the first of equally near ones. Those that are not finite are farther than all others.
// Taking one looks at all UVs that are no farther than the nearest by the value that varies most.
class Coincident {
  public:
    void add(std::uint32_t triangle, int turn, const Triangle& t) {
        members_.push_back({uvs_of(t, turn), triangle, turn});
    }

    // None where all are taken.
    const CoincidentMember* take(const Uvs& uvs) {
        if (members_.size() == 1) return first_++ == 0 ? &members_[0] : nullptr;
        if (!runs_) runs_ = std::make_unique<UvRuns>(members_);
        std::size_t member = is_finite(uvs) ? runs_->nearest(uvs) : no_member;
        if (member == no_member) {
            while (first_ < members_.size() && runs_->is_taken(first_)) ++first_;
            if (first_ == members_.size()) return nullptr;
            member = first_;
        }
        runs_->take(member);
        return &members_[member];
    }

  private:
    std::vector<CoincidentMember> members_;
    std::size_t first_ = 0;  // all before are taken
    std::unique_ptr<UvRuns> runs_;
};

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
    std::map<Key, Coincident> by_key;
    for (std::uint32_t t = 0; t < right.size(); ++t) {
        const auto [key, turn] = key_of(right[t]);
        by_key[key].add(t, turn, right[t]);
    }
    std::uint64_t unmatched = 0, matched = 0;
    for (const Triangle& triangle : left) {
        const auto [key, turn] = key_of(triangle);
        const auto found = by_key.find(key);
        const CoincidentMember* const partner =
            found == by_key.end() ? nullptr : found->second.take(uvs_of(triangle, turn));
        if (partner == nullptr) {
            ++unmatched;
            continue;
        }
        ++matched;
        for (int i = 0; i < 3; ++i)
            comparer.compare(
                triangle[static_cast<std::size_t>((i + turn) % 3)],
                right[partner->triangle][static_cast<std::size_t>((i + partner->turn) % 3)]);
    }
    unmatched += right.size() - matched;
    return comparer.finish(false, unmatched);
}

}  // namespace meshprep
