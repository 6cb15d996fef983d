#include "judge/matching.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <unordered_map>

namespace judge {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();
// Faces looked at in one round, so that dense meshes that differ altogether end, too.
constexpr std::uint64_t most_looks = 50'000'000;

std::uint64_t mixed(std::uint64_t h, std::uint64_t v) {
    h ^= v + 0x9e3779b97f4a7c15u + (h << 6) + (h >> 2);
    return h * 0xff51afd7ed558ccdu;
}

std::uint64_t bits_of(double value) {
    const double v = value + 0.0;  // −0 is 0
    std::uint64_t bits;
    std::memcpy(&bits, &v, sizeof bits);
    return bits;
}

// A cell of a grid of this size; without one, the very place.
std::uint64_t cell_of(const glm::dvec3& p, double size, const glm::ivec3& step = glm::ivec3(0)) {
    std::uint64_t h = 0;
    for (int k = 0; k < 3; ++k) {
        if (size > 0) {
            h = mixed(h, std::uint64_t(std::int64_t(std::floor(p[k] / size)) + step[k]));
        } else {
            h = mixed(h, bits_of(p[k]));
        }
    }
    return h;
}

class Matcher {
  public:
    Matcher(const WorldFaces& a, const WorldFaces& b, MaterialLooks& looks)
        : a_(a), b_(b), looks_(looks) {
        for (std::uint32_t f = 0; f < a.faces.size(); ++f)
            if (a.faces[f].count > 0) out_.left_a.push_back(f);
        for (std::uint32_t f = 0; f < b.faces.size(); ++f)
            if (b.faces[f].count > 0) out_.left_b.push_back(f);
    }

    Matching run() {
        const double rounding = std::max(a_.rounding, b_.rounding);
        const double farthest = std::max(a_.diagonal(), b_.diagonal()) / 20;
        // Where many are in one place, those that are alike in all would be looked at again and
        // again.
        take_twins(true);
        take_twins(false);
        out_.complete = round(0, false);
        out_.complete &= round(rounding, false);
        // Before neighbours could take their place.
        out_.complete &= round(rounding, true);
        for (double radius = 8 * rounding; radius < farthest && radius > 0 && out_.complete;
             radius *= 8)
            out_.complete = round(radius, false);
        std::sort(out_.pairs.begin(), out_.pairs.end(),
                  [](const FacePair& x, const FacePair& y) { return x.a < y.a; });
        return std::move(out_);
    }

  private:
    struct Candidate {
        bool turned_away = true;
        double moved = none;
        std::optional<double> alike = {};  // how unlike; only where something had to be decided
        FacePair pair = {};
    };

    using Buckets = std::unordered_map<std::uint64_t, std::vector<std::uint32_t>>;

    // Whatever corner the face begins at; of the places of its corners and, for twins, what they
    // carry and perhaps the mesh's name.
    std::uint64_t key_of(const WorldFaces& of, const WorldFace& face, bool carried,
                         bool named) const {
        std::uint64_t sum = face.count;
        const prep::Mesh& mesh = of.mesh_of(face);
        for (std::uint32_t i = 0; i < face.count; ++i) {
            std::uint64_t h = cell_of(of.points[face.first + i], 0);
            const auto add = [&](const auto& value) {
                h = mixed(h, value.has_value());
                if (value)
                    for (int k = 0; k < value->length(); ++k) h = mixed(h, bits_of((*value)[k]));
            };
            if (carried) {
                add(of.normal(face, i));
                add(of.tangent(face, i));
                for (std::size_t s = 0; s < mesh.uvs.size(); ++s) add(of.uv(face, i, s));
                for (std::size_t s = 0; s < mesh.colors.size(); ++s) add(of.color(face, i, s));
            }
            sum += h;
        }
        return named ? mixed(sum, std::hash<std::string>()(mesh.name)) : sum;
    }

    // Pairs of faces between which there is no difference, in their order.
    void take_twins(bool named) {
        Buckets buckets;
        // Backwards, so that the first is the last of its list.
        for (auto f = out_.left_b.rbegin(); f != out_.left_b.rend(); ++f)
            buckets[key_of(b_, b_.faces[*f], true, named)].push_back(*f);
        std::vector<bool> taken(b_.faces.size());
        std::vector<std::uint32_t> left;
        std::uint64_t looks = 0;
        for (const std::uint32_t f : out_.left_a) {
            const auto bucket = buckets.find(key_of(a_, a_.faces[f], true, named));
            std::optional<FacePair> pair;
            for (std::size_t n = 0; bucket != buckets.end() && n < bucket->second.size() && !pair;
                 ++n) {
                if (++looks > most_looks) break;
                const auto at = bucket->second.end() - 1 - std::ptrdiff_t(n);
                pair = twin_of(f, *at);
                if (!pair) continue;
                taken[*at] = true;
                bucket->second.erase(at);
            }
            if (pair)
                out_.pairs.push_back(*pair);
            else
                left.push_back(f);
        }
        keep_left(std::move(left), taken);
    }

    std::optional<FacePair> twin_of(std::uint32_t fa, std::uint32_t fb) const {
        const WorldFace &a = a_.faces[fa], &b = b_.faces[fb];
        if (a.count != b.count) return {};
        for (std::uint32_t turn = 0; turn < a.count; ++turn) {
            const FacePair pair{fa, fb, turn, false, 0};
            bool same = true;
            for (std::uint32_t i = 0; i < a.count && same; ++i)
                same = a_.points[a.first + i] == b_.points[b.first + partner_of(pair, i, a.count)];
            if (same && difference(a, b, pair) == 0) return pair;
        }
        return {};
    }

    void keep_left(std::vector<std::uint32_t> left, const std::vector<bool>& taken) {
        out_.left_a = std::move(left);
        out_.left_b.erase(std::remove_if(out_.left_b.begin(), out_.left_b.end(),
                                         [&](std::uint32_t f) { return taken[f]; }),
                          out_.left_b.end());
    }

    // False where it had to end early.
    bool round(double radius, bool reversed) {
        if (out_.left_a.empty() || out_.left_b.empty()) return true;
        const double size = 2 * radius;
        Buckets grid;
        for (const std::uint32_t f : out_.left_b) {
            const WorldFace& face = b_.faces[f];
            grid[size > 0 ? cell_of(face.middle, size) : key_of(b_, face, false, false)].push_back(
                f);
        }
        std::vector<bool> taken(b_.faces.size());
        std::vector<std::uint32_t> left;
        std::uint64_t looks = 0;
        for (const std::uint32_t f : out_.left_a) {
            Candidate best;
            std::vector<std::uint32_t>* home = nullptr;
            const glm::dvec3 middle = a_.faces[f].middle;
            // The cells that a ball of this radius reaches: two along each axis.
            for (int cell = 0; cell < (size > 0 ? 8 : 1) && looks < most_looks; ++cell) {
                glm::ivec3 step(0);
                for (int k = 0; k < 3 && size > 0; ++k) {
                    const double at = middle[k] / size;
                    if ((cell >> k & 1) != 0) step[k] = at - std::floor(at) < 0.5 ? -1 : 1;
                }
                const auto bucket = grid.find(size > 0 ? cell_of(middle, size, step)
                                                       : key_of(a_, a_.faces[f], false, false));
                if (bucket == grid.end()) continue;
                for (const std::uint32_t g : bucket->second) {
                    if (++looks > most_looks) break;
                    consider(f, g, radius, reversed, best);
                    if (best.moved < none && best.pair.b == g) home = &bucket->second;
                }
            }
            if (home == nullptr) {
                left.push_back(f);
                continue;
            }
            // Taken out, so that it is not looked at again; the order decides nothing.
            auto& own = *std::find(home->begin(), home->end(), best.pair.b);
            own = home->back();
            home->pop_back();
            taken[best.pair.b] = true;
            out_.pairs.push_back(best.pair);
        }
        keep_left(std::move(left), taken);
        return looks < most_looks;
    }

    void consider(std::uint32_t fa, std::uint32_t fb, double radius, bool reversed,
                  Candidate& best) const {
        const WorldFace &a = a_.faces[fa], &b = b_.faces[fb];
        if (a.count != b.count) return;
        const double rounding = std::max(a.rounding, b.rounding);
        for (std::uint32_t turn = 0; turn < a.count; ++turn) {
            FacePair pair{fa, fb, turn, reversed, 0};
            for (std::uint32_t i = 0; i < a.count && pair.moved <= radius; ++i)
                pair.moved = std::max(
                    pair.moved, glm::distance(a_.points[a.first + i],
                                              b_.points[b.first + partner_of(pair, i, a.count)]));
            if (!(pair.moved <= radius)) continue;
            // What rounding moves is in one place.
            const double moved = pair.moved <= rounding ? 0 : pair.moved;
            // Of two faces back to back, rounding decides which is nearer: not the other's.
            const bool away = !reversed && turned_away(a, b, pair);
            const auto key = std::pair(away, moved),
                       best_key = std::pair(best.turned_away, best.moved);
            if (key > best_key) continue;
            if (key < best_key) {
                best = {away, moved, {}, pair};
                continue;
            }
            // Two in one place, or one that can be turned: what they carry decides, then the order.
            if (!best.alike) {
                const WorldFace& other = b_.faces[best.pair.b];
                best.alike = difference(a, other, best.pair) + strangeness(a, other);
            }
            const double alike = difference(a, b, pair) + strangeness(a, b);
            if (alike < *best.alike ||
                (alike == *best.alike &&
                 (fb < best.pair.b || (fb == best.pair.b && turn < best.pair.turn))))
                best = {away, moved, alike, pair};
        }
    }

    // Whether normals point the other way at more corners than not.
    bool turned_away(const WorldFace& a, const WorldFace& b, const FacePair& pair) const {
        int balance = 0;
        for (std::uint32_t i = 0; i < a.count; ++i) {
            const auto na = a_.normal(a, i), nb = b_.normal(b, partner_of(pair, i, a.count));
            if (na && nb) balance += glm::dot(*na, *nb) < 0 ? 1 : -1;
        }
        return balance > 0;
    }

    // How unlike what two faces carry is, and how they look.
    double difference(const WorldFace& a, const WorldFace& b, const FacePair& pair) const {
        double sum = 0;
        const auto add = [&](double d) { sum += std::isfinite(d) ? d : 1e3; };
        const auto apart = [&](const auto& u, const auto& v) {
            if (u.has_value() != v.has_value()) add(1e3);
            if (!u || !v) return;
            for (int k = 0; k < u->length(); ++k)
                if ((*u)[k] != (*v)[k] && !(std::isnan((*u)[k]) && std::isnan((*v)[k])))
                    add(std::abs((*u)[k] - (*v)[k]));
        };
        const prep::Mesh &ma = a_.mesh_of(a), &mb = b_.mesh_of(b);
        const std::size_t targets = std::min(ma.morph_targets.size(), mb.morph_targets.size());
        for (std::uint32_t i = 0; i < a.count; ++i) {
            const std::uint32_t k = partner_of(pair, i, a.count);
            const auto na = a_.normal(a, i), nb = b_.normal(b, k);
            if (na && nb) add(degrees_apart(*na, *nb));
            const auto ta = a_.tangent(a, i), tb = b_.tangent(b, k);
            if (ta && tb) add(degrees_apart(*ta, *tb) + (ta->w != tb->w ? 1.0 : 0.0));
            if (na.has_value() != nb.has_value() || ta.has_value() != tb.has_value()) add(1e3);
            for (std::size_t s = 0; s < std::max(ma.uvs.size(), mb.uvs.size()); ++s)
                apart(a_.uv(a, i, s), b_.uv(b, k, s));
            for (std::size_t s = 0; s < std::max(ma.colors.size(), mb.colors.size()); ++s)
                apart(a_.color(a, i, s), b_.color(b, k, s));
            for (std::size_t t = 0; t < targets; ++t)
                apart(std::optional(delta_at(ma.morph_targets[t],
                                             ma.corner_file_vertex(a_.corners[a.first + i]))),
                      std::optional(delta_at(mb.morph_targets[t],
                                             mb.corner_file_vertex(b_.corners[b.first + k]))));
        }
        if (!looks_.differences(a.material, b.material).empty()) add(1);
        return sum;
    }

    // Names and places in lists only decide between equals.
    double strangeness(const WorldFace& a, const WorldFace& b) const {
        double sum = 0;
        const auto material = [](const WorldFaces& of, const WorldFace& f) {
            return f.material < of.scene->materials.size() ? of.scene->materials[f.material].name
                                                           : std::string();
        };
        if (material(a_, a) != material(b_, b)) sum += 1e-6;
        if (a_.mesh_of(a).name != b_.mesh_of(b).name) sum += 1e-7;
        if (a_.mesh_index(a) != b_.mesh_index(b)) sum += 1e-8;
        if (a.face != b.face) sum += 1e-9;
        return sum;
    }

    const WorldFaces &a_, &b_;
    MaterialLooks& looks_;
    Matching out_;
};

}  // namespace

std::uint32_t partner_of(const FacePair& pair, std::uint32_t corner, std::uint32_t count) {
    return pair.reversed ? (pair.turn + count - corner) % count : (corner + pair.turn) % count;
}

Matching match_faces(const WorldFaces& a, const WorldFaces& b, MaterialLooks& looks) {
    return Matcher(a, b, looks).run();
}

}  // namespace judge
