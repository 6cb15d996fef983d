#include "judge/corner_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "judge/material_looks.h"

namespace judge {
namespace {

using prep::no_index;

constexpr std::size_t most_findings = 8;

// A float's last two bits of a number, which rounding moves.
double rounding_of(double a, double b) {
    return std::ldexp(std::max(std::abs(a), std::abs(b)), -22);
}

// 0 where both are the same or rounded from it; infinite where one alone is no number.
template <int N>
double largest_difference(const glm::vec<N, double>& a, const glm::vec<N, double>& b) {
    double largest = 0;
    for (int k = 0; k < N; ++k) {
        if (a[k] == b[k] || (std::isnan(a[k]) && std::isnan(b[k]))) continue;
        const double d = std::abs(a[k] - b[k]);
        if (!std::isfinite(d)) return INFINITY;
        if (d > rounding_of(a[k], b[k])) largest = std::max(largest, d);
    }
    return largest;
}

struct Joint {
    glm::dvec3 place{0.0};  // in the world
    glm::dmat4 pose{1.0};   // from the mesh's own numbers to the world
};

std::vector<std::vector<Joint>> joints_of(const prep::Scene& scene) {
    const std::vector<glm::dmat4> worlds = prep::world_transforms(scene);
    std::vector<std::vector<Joint>> skins;
    for (const prep::Skin& skin : scene.skins) {
        auto& list = skins.emplace_back();
        for (std::size_t j = 0; j < skin.joints.size(); ++j) {
            Joint& joint = list.emplace_back();
            if (skin.joints[j] < worlds.size()) joint.pose = worlds[skin.joints[j]];
            joint.place = glm::dvec3(joint.pose[3]);
            if (j < skin.inverse_bind.size())
                joint.pose = joint.pose * glm::dmat4(skin.inverse_bind[j]);
        }
    }
    return skins;
}

// Of the joints on a corner. In the pose that a file stands in all joints often pose a corner
// alike, whatever their weights; where they stand tells those apart.
struct Pull {
    glm::dvec3 middle{0.0}, posed{0.0};  // weighted, in the world
    double weight = 0;                   // the sum
    double terms = 0;                    // what is added up, by size
};

class CornerMeasures {
  public:
    CornerMeasures(const WorldFaces& a, const WorldFaces& b, MaterialLooks& looks,
                   std::vector<Measured>& measured)
        : a_(a),
          b_(b),
          measured_(measured),
          looks_(looks),
          joints_a_(joints_of(*a.scene)),
          joints_b_(joints_of(*b.scene)) {
        scale_ = a.diagonal() > 0 ? a.diagonal() : 1;
        for (Measured& m : measured_) lists_.emplace_back(m);
    }

    void run(const Matching& matching, bool whole, std::vector<std::string>& notes) {
        for (const FacePair& pair : matching.pairs) {
            const WorldFace &fa = a_.faces[pair.a], &fb = b_.faces[pair.b];
            for (std::uint32_t i = 0; i < fa.count; ++i)
                corner(fa, fb, i, partner_of(pair, i, fa.count));
            material(fa, fb);
        }
        if (whole) scene_losses();
        finish(notes);
    }

  private:
    enum Cause : std::size_t { moved, uvs, normals, causes };

    Measured& of(std::optional<double> Limits::*limit) { return measured_of(measured_, limit); }

    bool beyond(std::optional<double> Limits::*limit, const WorldFace& face, std::uint32_t i,
                double value, std::string text = {}) {
        Measured& m = of(limit);
        ++m.compared;
        if (std::isnan(value)) value = INFINITY;  // nothing is known, and no limit holds that
        m.value = std::max(m.value, value);
        // A count's limit is for the sum; here it is one corner's value.
        if (!m.limit || !(value > *m.limit)) return false;
        ++m.beyond;
        Finding found = finding_at(a_, face, value);
        found.corner = a_.corner_in_face(face, i);
        found.text = std::move(text);
        lists_[std::size_t(&m - measured_.data())].add(found);
        return true;
    }

    // By mesh of the first file and what it is: the first place, and the number of corners.
    using Lists =
        std::map<std::pair<std::uint32_t, std::string>, std::pair<Finding, std::uint64_t>>;

    void lost(const WorldFace& face, std::uint32_t i, const std::string& what) {
        count(lost_, face, i, what);
    }
    void added(const WorldFace& face, std::uint32_t i, const std::string& what) {
        count(added_, face, i, what);
    }
    void count(Lists& lists, const WorldFace& face, std::uint32_t i, const std::string& what) {
        const auto key = std::pair(a_.mesh_index(face), what);
        auto [place, fresh] = lists.try_emplace(key);
        if (fresh) {
            place->second.first = finding_at(a_, face, 0);
            place->second.first.corner = a_.corner_in_face(face, i);
        }
        ++place->second.second;
    }

    // Counts, where the row follows from others, which.
    void follow(std::optional<double> Limits::*limit, bool by_moved, bool by_uvs, bool by_normals) {
        auto& counts = following_[std::size_t(&of(limit) - measured_.data())];
        if (by_moved)
            ++counts[moved];
        else if (by_uvs)
            ++counts[uvs];
        else if (by_normals)
            ++counts[normals];
    }

    void corner(const WorldFace& fa, const WorldFace& fb, std::uint32_t i, std::uint32_t k) {
        const double way = glm::distance(a_.points[fa.first + i], b_.points[fb.first + k]);
        const double rounding = std::max(fa.rounding, fb.rounding);
        const bool is_moved = beyond(&Limits::positions, fa, i, way <= rounding ? 0 : way / scale_);

        const prep::Mesh &ma = a_.mesh_of(fa), &mb = b_.mesh_of(fb);
        bool uv_differs = false;
        for (std::size_t s = 0; s < std::max(ma.uvs.size(), mb.uvs.size()); ++s) {
            const auto u = a_.uv(fa, i, s), v = b_.uv(fb, k, s);
            if (u && !v) lost(fa, i, "UV set " + std::to_string(s));
            if (v && !u) added(fa, i, "UV set " + std::to_string(s));
            if (u && v)
                uv_differs |= beyond(&Limits::uvs, fa, i, largest_difference(*u, *v),
                                     s > 0 ? "UV set " + std::to_string(s) : std::string());
        }
        for (std::size_t s = 0; s < std::max(ma.colors.size(), mb.colors.size()); ++s) {
            const auto u = a_.color(fa, i, s), v = b_.color(fb, k, s);
            if (u && !v) lost(fa, i, "colours " + std::to_string(s));
            if (v && !u) added(fa, i, "colours " + std::to_string(s));
            if (u && v) beyond(&Limits::colors, fa, i, largest_difference(*u, *v));
        }
        bool normal_differs = false;
        const auto na = a_.normal(fa, i), nb = b_.normal(fb, k);
        if (na && !nb) lost(fa, i, "normals");
        if (nb && !na) added(fa, i, "normals");
        if (na && nb) {
            normal_differs = beyond(&Limits::normals, fa, i, degrees_apart(*na, *nb));
            if (normal_differs) follow(&Limits::normals, is_moved, false, false);
        }
        const auto ta = a_.tangent(fa, i), tb = b_.tangent(fb, k);
        if (ta && !tb) lost(fa, i, "tangents");
        if (tb && !ta) added(fa, i, "tangents");
        if (ta && tb) {
            if (beyond(&Limits::tangents, fa, i, degrees_apart(glm::dvec3(*ta), glm::dvec3(*tb))))
                follow(&Limits::tangents, is_moved, uv_differs, normal_differs);
            Measured& signs = of(&Limits::tangent_signs);
            ++signs.compared;
            if (ta->w != tb->w) {
                ++signs.beyond;
                signs.value += 1;
                Finding found = finding_at(a_, fa, 1);
                found.corner = a_.corner_in_face(fa, i);
                lists_[std::size_t(&signs - measured_.data())].add(found);
                follow(&Limits::tangent_signs, is_moved, uv_differs, normal_differs);
            }
        }
        skin(fa, fb, ma, mb, i, k);
        morphs(fa, fb, ma, mb, i, k);
    }

    std::optional<Pull> pull(const WorldFaces& faces, const WorldFace& face, const prep::Mesh& mesh,
                             std::uint32_t i, const std::vector<std::vector<Joint>>& joints) {
        const std::uint32_t node = faces.instances[face.instance].node;
        if (mesh.skin_influences.empty() || node == no_index) return {};
        const std::uint32_t skin = faces.scene->nodes[node].skin;
        if (skin >= joints.size()) return {};
        const std::uint32_t corner = faces.corners[face.first + i];
        const std::uint32_t vertex = mesh.corner_file_vertex(corner);
        const glm::dvec4 place(
            glm::dvec3(mesh.positions[mesh.corner_vertices[corner]]) + mesh.origin, 1);
        Pull out;
        for (const prep::SkinInfluences& set : mesh.skin_influences) {
            if (vertex >= set.joints.size() || vertex >= set.weights.size()) continue;
            for (int j = 0; j < 4; ++j) {
                const double w = double(set.weights[vertex][j]);
                const std::size_t joint = set.joints[vertex][j];
                if (w == 0 || joint >= joints[skin].size()) continue;
                const Joint& by = joints[skin][joint];
                const glm::dvec3 posed(by.pose * place);
                out.middle += w * by.place;
                out.posed += w * posed;
                out.weight += w;
                out.terms += std::abs(w) * (glm::length(by.place) + glm::length(posed));
            }
        }
        return out;
    }

    void skin(const WorldFace& fa, const WorldFace& fb, const prep::Mesh& ma, const prep::Mesh& mb,
              std::uint32_t i, std::uint32_t k) {
        const auto pa = pull(a_, fa, ma, i, joints_a_), pb = pull(b_, fb, mb, k, joints_b_);
        if (pa && !pb) lost(fa, i, "skin");
        if (pb && !pa) added(fa, i, "skin");
        if (!pa || !pb) return;
        double way =
            std::max(glm::distance(pa->middle, pb->middle), glm::distance(pa->posed, pb->posed));
        if (way <= 4 * rounding_of(pa->terms, pb->terms)) way = 0;
        // How much is posed at all: as a part of it, like ways of the diagonal.
        double weight = std::abs(pa->weight - pb->weight);
        if (weight <= 4 * rounding_of(pa->weight, pb->weight)) weight = 0;
        beyond(&Limits::skins, fa, i, std::max(way / scale_, weight));
    }

    void morphs(const WorldFace& fa, const WorldFace& fb, const prep::Mesh& ma,
                const prep::Mesh& mb, std::uint32_t i, std::uint32_t k) {
        for (std::size_t t = ma.morph_targets.size(); t < mb.morph_targets.size(); ++t)
            added(fa, i, "morph target " + std::to_string(t));
        if (ma.morph_targets.empty()) return;
        const std::uint32_t va = ma.corner_file_vertex(a_.corners[fa.first + i]);
        const std::uint32_t vb = mb.corner_file_vertex(b_.corners[fb.first + k]);
        const glm::dmat3 la(a_.instances[fa.instance].world), lb(b_.instances[fb.instance].world);
        for (std::size_t t = 0; t < ma.morph_targets.size(); ++t) {
            if (t >= mb.morph_targets.size()) {
                lost(fa, i, "morph target " + std::to_string(t));
                continue;
            }
            const glm::dvec3 da = la * delta_at(ma.morph_targets[t], va),
                             db = lb * delta_at(mb.morph_targets[t], vb);
            // And by the weight at rest, as skins' weights are.
            const double weight =
                std::abs(double(ma.morph_targets[t].weight) - double(mb.morph_targets[t].weight));
            const double d = std::max(largest_difference(da, db) / scale_, weight);
            beyond(&Limits::morphs, fa, i, d,
                   d > 0 ? "morph target " + std::to_string(t) : std::string());
        }
    }

    void material(const WorldFace& fa, const WorldFace& fb) {
        Measured& m = of(&Limits::materials);
        ++m.compared;
        if (looks_.differences(fa.material, fb.material).empty()) return;
        ++m.beyond;
        m.value += 1;
        auto [place, fresh] = materials_.try_emplace(
            std::tuple(a_.mesh_index(fa), fa.material, fb.material), finding_at(a_, fa, 0));
        place->second.value += 1;
    }

    static std::string name_of_material(const prep::Scene& scene, std::uint32_t index) {
        if (index >= scene.materials.size()) return "no material";
        const std::string& name = scene.materials[index].name;
        return name.empty() ? "material " + std::to_string(index) : "'" + name + "'";
    }

    void scene_losses() {
        const prep::Scene &a = *a_.scene, &b = *b_.scene;
        const auto count = [&](std::size_t of_a, std::size_t of_b, const char* one,
                               const char* several) {
            if (of_a == of_b) return;
            const std::size_t number = of_a > of_b ? of_a - of_b : of_b - of_a;
            (of_a > of_b ? scene_lost_ : scene_added_)
                .push_back(fmt::format("{} {}", number, number == 1 ? one : several));
        };
        count(a.animations.size(), b.animations.size(), "animation", "animations");
        count(a.lights.size(), b.lights.size(), "light", "lights");
        count(a.cameras.size(), b.cameras.size(), "camera", "cameras");
    }

    void tell(Measured& m, const Lists& lists, const std::vector<std::string>& of_scene,
              std::size_t meshes) {
        FindingList& list = lists_[std::size_t(&m - measured_.data())];
        for (const auto& [key, place] : lists) {
            Finding found = place.first;
            found.value = double(place.second);
            found.text = key.second + ": " + fmt::format("{} corners", place.second);
            list.add(found);
        }
        for (const std::string& text : of_scene) {
            Finding found;
            found.value = 1;
            found.text = text;
            list.add(found);
        }
        m.compared = meshes;
        m.beyond = lists.size() + of_scene.size();
        m.value = double(m.beyond);
    }

    void finish(std::vector<std::string>& notes) {
        tell(of(&Limits::lost), lost_, scene_lost_, a_.scene->meshes.size());
        tell(of(&Limits::added), added_, scene_added_, b_.scene->meshes.size());
        Measured& looks = of(&Limits::materials);
        FindingList& looks_list = lists_[std::size_t(&looks - measured_.data())];
        // What is not told gets no text: a look is held against all of the first file's.
        std::vector<decltype(materials_)::const_iterator> told;
        for (auto place = materials_.begin(); place != materials_.end(); ++place)
            told.push_back(place);
        std::stable_sort(told.begin(), told.end(), [](const auto& x, const auto& y) {
            return x->second.value > y->second.value;
        });
        if (told.size() > most_findings) told.resize(most_findings);
        for (const auto& row : told) {
            const auto& [key, place] = *row;
            const auto [mesh, ma, mb] = key;
            Finding found = place;
            const std::uint32_t twin = looks_.twin_in_a(mb);
            std::string text =
                fmt::format("{} faces: {} is {} now", std::uint64_t(place.value),
                            name_of_material(*a_.scene, ma), name_of_material(*b_.scene, mb));
            if (twin != no_index && twin != ma && ma < a_.scene->materials.size())
                text += ", swapped for the look of " + name_of_material(*a_.scene, twin);
            const auto& list = looks_.differences(ma, mb);
            for (std::size_t n = 0; n < std::min<std::size_t>(list.size(), 3); ++n)
                text += (n == 0 ? ": " : "; ") + list[n];
            if (list.size() > 3) text += fmt::format("; and {} more", list.size() - 3);
            found.text = std::move(text);
            looks_list.add(found);
        }
        for (std::size_t m = 0; m < measured_.size(); ++m) {
            lists_[m].finish();
            const auto found = following_.find(m);
            if (found == following_.end()) continue;
            const auto& counts = found->second;
            if (counts[moved] + counts[uvs] + counts[normals] < measured_[m].beyond) continue;
            const std::size_t most =
                std::size_t(std::max_element(counts.begin(), counts.end()) - counts.begin());
            measured_[m].follows = most == moved ? "positions" : most == uvs ? "uvs" : "normals";
        }
        for (const std::string& warning : looks_.warnings()) notes.push_back(warning);
    }

    const WorldFaces &a_, &b_;
    std::vector<Measured>& measured_;
    std::vector<FindingList> lists_;
    MaterialLooks& looks_;
    std::vector<std::vector<Joint>> joints_a_, joints_b_;
    double scale_ = 1;
    Lists lost_, added_;
    std::vector<std::string> scene_lost_, scene_added_;
    std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, Finding> materials_;
    std::map<std::size_t, std::array<std::uint64_t, causes>> following_;
};

}  // namespace

void FindingList::add(const Finding& finding) {
    to_.findings.push_back(finding);
    if (to_.findings.size() > 512) finish();
}

void FindingList::finish() {
    std::stable_sort(to_.findings.begin(), to_.findings.end(),
                     [](const Finding& x, const Finding& y) { return x.value > y.value; });
    if (to_.findings.size() > most_findings) to_.findings.resize(most_findings);
}

Measured& measured_of(std::vector<Measured>& measured, std::optional<double> Limits::*limit) {
    return *std::find_if(measured.begin(), measured.end(),
                         [&](const Measured& m) { return m.row->limit == limit; });
}

Finding finding_at(const WorldFaces& faces, const WorldFace& face, double value) {
    Finding found;
    found.value = value;
    found.mesh = faces.mesh_index(face);
    found.node = faces.instances[face.instance].node;
    found.face = face.face;
    return found;
}

void measure_corners(const WorldFaces& a, const WorldFaces& b, const Matching& matching, bool whole,
                     MaterialLooks& looks, std::vector<Measured>& measured,
                     std::vector<std::string>& notes) {
    CornerMeasures(a, b, looks, measured).run(matching, whole, notes);
}

}  // namespace judge
