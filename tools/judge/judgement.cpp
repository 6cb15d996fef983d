#include "judge/judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "cost/measure/surface_distance.h"
#include "judge/corner_measures.h"
#include "judge/face_cuts.h"
#include "judge/judged_views.h"
#include "judge/matching.h"
#include "judge/material_looks.h"

namespace judge {
namespace {

// Corners under all nodes, so that a small file with many nodes is an error before memory ends.
constexpr std::uint64_t most_corners = std::uint64_t(1) << 28;

// The triangles of a file, and which of them may be farther away than their partners' corners say.
struct Triangles {
    std::vector<cost::Triangle> all, open;
    std::vector<WorldFace> open_faces;
};

Triangles triangles_of(const WorldFaces& faces, const WorldFaces& cut,
                       const std::vector<bool>& open) {
    Triangles out;
    for (const WorldFace& f : cut.faces) {
        if (f.count != 3) continue;
        const glm::dvec3* p = &cut.points[f.first];
        out.all.push_back({p[0], p[1], p[2]});
        if (!open[faces.instances[f.instance].first_face + f.face]) continue;
        out.open.push_back(out.all.back());
        out.open_faces.push_back(f);
    }
    return out;
}

class Judge {
  public:
    Judge(const prep::Scene& a, const prep::Scene& b, const JudgeOptions& options)
        : scene_a_(a),
          scene_b_(b),
          options_(options),
          // What is not drawn is not compared, but where nothing of it is drawn at all.
          unshown_(shown_meshes(a, options.meshes).shown + shown_meshes(b, options.meshes).shown > 0
                       ? Unshown::left_out
                       : Unshown::as_it_is),
          a_(a, Pieces::faces, unshown_, options.meshes, options.threads),
          b_(b, Pieces::faces, unshown_, options.meshes, options.threads) {
        // A file of polygons and one of their triangles are compared by triangles.
        if (a_.faces.size() != b_.faces.size()) {
            a_ = WorldFaces(a, Pieces::triangles, unshown_, options.meshes, options.threads);
            b_ = WorldFaces(b, Pieces::triangles, unshown_, options.meshes, options.threads);
            whole_ = false;
        }
        for (const LimitRow& row : limit_rows) {
            Measured& m = out_.measured.emplace_back();
            m.row = &row;
            m.limit = options.limits.*row.limit;
        }
        out_.diagonal = a_.diagonal();
        scale_ = out_.diagonal > 0 ? out_.diagonal : 1;
        // Far from the origin last bits are large, and what moved by them is seen.
        a_.limit_rounding(std::ldexp(scale_, -20));
        b_.limit_rounding(std::ldexp(scale_, -20));
    }

    prep::Result<Judgement> run() {
        MaterialLooks looks(scene_a_, scene_b_);
        matching_ = match_faces(a_, b_, looks);
        if (!matching_.complete)
            out_.notes.push_back("the search for faces' partners ended early: too many are near");
        note_unshown(scene_a_, "first");
        note_unshown(scene_b_, "second");
        count_faces();
        measure_corners(a_, b_, matching_, options_.meshes.empty(), looks, out_.measured,
                        out_.notes);
        measure_distance();
        if (const prep::Result<void> seen = measure_views(); !seen) return seen.error();
        decide();
        return std::move(out_);
    }

  private:
    Measured& of(std::optional<double> Limits::*limit) { return measured_of(out_.measured, limit); }

    void note_unshown(const prep::Scene& scene, const char* which) {
        if (unshown_ == Unshown::as_it_is) return;
        if (const std::size_t count = shown_meshes(scene, options_.meshes).unshown; count > 0)
            out_.notes.push_back(
                fmt::format("{} of the {} file that its scene does not show {} not compared",
                            count == 1 ? "1 mesh" : fmt::format("{} meshes", count), which,
                            count == 1 ? "was" : "were"));
    }

    // Without area, so that it has no side to turn.
    bool is_flat(std::uint32_t f) const {
        const WorldFace& face = a_.faces[f];
        glm::dvec3 area(0.0);
        double around = 0;
        const glm::dvec3* p = &a_.points[face.first];
        for (std::uint32_t i = 0; i < face.count; ++i) {
            const glm::dvec3 q = p[i] - p[0], r = p[(i + 1) % face.count] - p[0];
            area += glm::cross(q, r);
            around += glm::distance(q, r);
        }
        return glm::length(area) <= face.rounding * around;
    }

    void count_faces() {
        Measured& m = of(&Limits::faces);
        m.compared = a_.faces.size() + b_.faces.size();
        FindingList list(m);
        for (const std::uint32_t f : matching_.left_a) {
            Finding found = finding_at(a_, a_.faces[f], 1);
            found.text = "in the first file alone";
            list.add(found);
        }
        for (const std::uint32_t f : matching_.left_b) {
            Finding found = finding_at(b_, b_.faces[f], 1);
            found.text = "in the second file alone: " + in_second(found);
            found.mesh = found.node = prep::no_index;
            list.add(found);
        }
        std::uint64_t reversed = 0;
        for (const FacePair& pair : matching_.pairs) {
            if (!pair.reversed || is_flat(pair.a)) continue;
            ++reversed;
            Finding found = finding_at(a_, a_.faces[pair.a], 1);
            found.text = "runs the other way round";
            list.add(found);
        }
        list.finish();
        const std::size_t unplaced =
            a_.unplaced > b_.unplaced ? a_.unplaced - b_.unplaced : b_.unplaced - a_.unplaced;
        m.beyond = matching_.left_a.size() + matching_.left_b.size() + reversed + unplaced;
        m.value = double(m.beyond);
        if (a_.unplaced + b_.unplaced > 0)
            out_.notes.push_back(
                fmt::format("faces with a position that is not finite: {} and {}; only their "
                            "number is compared",
                            a_.unplaced, b_.unplaced));
    }

    // Matched triangles are no farther apart than their corners, other faces where they are cut
    // alike or nearly so; the rest, and those that are not near enough by that, are searched.
    void measure_distance() {
        Measured& m = of(&Limits::distance);
        m.compared = a_.faces.size() + b_.faces.size();
        const double enough = m.limit.value_or(0) * scale_;
        std::vector<bool> open_a(a_.faces.size()), open_b(b_.faces.size());
        const bool polygons =
            std::any_of(matching_.pairs.begin(), matching_.pairs.end(),
                        [&](const FacePair& pair) { return a_.faces[pair.a].count > 3; });
        if (polygons) cut();
        bool any = false;
        bound_ = 0;
        for (const FacePair& pair : matching_.pairs) {
            const double rounding = std::max(a_.faces[pair.a].rounding, b_.faces[pair.b].rounding);
            const double cuts = polygons ? cuts_apart(*cuts_a_, *cuts_b_, pair) : 0;
            const double apart =
                (pair.moved <= rounding ? 0 : pair.moved) + (cuts <= rounding ? 0 : cuts);
            if (apart <= enough) {
                bound_ = std::max(bound_, apart);
                continue;
            }
            open_a[pair.a] = open_b[pair.b] = any = true;
        }
        for (const std::uint32_t f : matching_.left_a) open_a[f] = any = true;
        for (const std::uint32_t f : matching_.left_b) open_b[f] = any = true;
        m.proved = true;
        m.value = bound_ / scale_;
        if (!any || !m.limit) {
            if (any) m.value = std::numeric_limits<double>::quiet_NaN();
            return;
        }
        search(m, enough, open_a, open_b);
    }

    void search(Measured& m, double enough, const std::vector<bool>& open_a,
                const std::vector<bool>& open_b) {
        cut();
        const double rounding = std::max(a_.rounding, b_.rounding);
        const Triangles ta = opened(a_, *cut_a_, open_a), tb = opened(b_, *cut_b_, open_b);
        cost::DistanceOptions search;
        search.enough = std::max(enough, rounding);
        search.tolerance = 1e-4 * scale_;
        search.most_pieces = options_.most_pieces;
        const cost::SurfaceDistance there = cost::one_sided_distance(ta.open, tb.all, search),
                                    back = cost::one_sided_distance(tb.open, ta.all, search);
        for (const auto* way : {&there, &back}) {
            const bool first = way == &there;
            if (way->high > rounding) bound_ = std::max(bound_, way->high);
            if (!way->complete)
                out_.notes.push_back(
                    fmt::format("the search for the distance {} ended after {} pieces, at {:.4g} … "
                                "{:.4g} of the diagonal",
                                first ? "from the first file" : "from the second file", way->pieces,
                                way->low / scale_, way->high / scale_));
            if (!(way->high > search.enough)) continue;
            m.beyond += 1;
            m.proved = false;
            const Triangles& of_file = first ? ta : tb;
            if (way->triangle >= of_file.open_faces.size()) continue;
            Finding found = finding_at(first ? *cut_a_ : *cut_b_, of_file.open_faces[way->triangle],
                                       way->low / scale_);
            found.text =
                fmt::format("{} at ({:.6g}, {:.6g}, {:.6g}), at most {:.4g}",
                            first ? "from the first file to the second"
                                  : "from the second file (" + in_second(found) + ") to the first",
                            way->at.x, way->at.y, way->at.z, way->high / scale_);
            if (!first) found.mesh = found.node = prep::no_index;
            m.findings.push_back(found);
        }
        std::stable_sort(m.findings.begin(), m.findings.end(),
                         [](const Finding& x, const Finding& y) { return x.value > y.value; });
        m.value = bound_ / scale_;
        if (m.proved) return;
        m.high = m.value;
        m.value = std::max(there.low, back.low) / scale_;
    }

    // Both scenes' triangles, once.
    void cut() {
        if (cut_a_) return;
        cut_a_.emplace(scene_a_, Pieces::triangles, unshown_, options_.meshes, options_.threads);
        cut_b_.emplace(scene_b_, Pieces::triangles, unshown_, options_.meshes, options_.threads);
        if (!whole_) return;
        cuts_a_.emplace(a_, *cut_a_);
        cuts_b_.emplace(b_, *cut_b_);
    }

    // "its mesh 'wheel', face 7", of a finding that still has the second file's mesh.
    std::string in_second(const Finding& found) const {
        const std::string& name = scene_b_.meshes[found.mesh].name;
        return fmt::format("its mesh {}, face {}",
                           name.empty() ? std::to_string(found.mesh) : "'" + name + "'",
                           found.face);
    }

    Triangles opened(const WorldFaces& faces, const WorldFaces& cut,
                     const std::vector<bool>& open) {
        if (whole_) return triangles_of(faces, cut, open);
        Triangles out;
        for (std::size_t f = 0; f < cut.faces.size(); ++f) {
            if (cut.faces[f].count != 3) continue;
            const glm::dvec3* p = &cut.points[cut.faces[f].first];
            out.all.push_back({p[0], p[1], p[2]});
            if (!open[f]) continue;
            out.open.push_back(out.all.back());
            out.open_faces.push_back(cut.faces[f]);
        }
        return out;
    }

    prep::Result<void> measure_views() {
        Measured &outlines = of(&Limits::silhouettes), &flips = of(&Limits::flip);
        ViewFrame frame;
        frame.centre = a_.low * 0.5 + a_.high * 0.5;
        // So far from the origin that its coordinates are the same numbers it is a dot.
        constexpr double least_share = 0x1p-40;
        const glm::dvec3 farthest = glm::abs(frame.centre);
        frame.radius = std::max(a_.diagonal() / 2,
                                least_share * std::max({farthest.x, farthest.y, farthest.z}));
        if (!(frame.radius > 0)) frame.radius = 1;
        // Where the surfaces are this near to each other, so are their projections.
        const double proved = bound_ / frame.pixel(options_.size);
        const bool proof = of(&Limits::distance).limit && matching_.left_a.empty() &&
                           matching_.left_b.empty() && proved <= outlines.limit.value_or(0);
        outlines.compared = flips.compared = options_.views;
        if (options_.views == 0) {
            outlines.value = flips.value = std::numeric_limits<double>::quiet_NaN();
            outlines.limit.reset();
            flips.limit.reset();
            return {};
        }
        const bool needed = (outlines.limit && !proof) || flips.limit;
        if (!needed && !options_.always_views && !options_.pictures) {
            outlines.value = proved;
            outlines.proved = true;
            if (!proof) outlines.value = std::numeric_limits<double>::quiet_NaN();
            flips.value = std::numeric_limits<double>::quiet_NaN();
            return {};
        }
        prep::Result<std::vector<ViewJudged>> views =
            judged_views(scene_a_, scene_b_, frame, flips.limit.has_value(), options_);
        if (!views) return views.error();
        out_.views = *std::move(views);
        if (out_.views.empty() || !out_.views[0].compared_flip)
            flips.value = std::numeric_limits<double>::quiet_NaN();
        for (std::size_t v = 0; v < out_.views.size(); ++v) {
            const ViewJudged& view = out_.views[v];
            const auto note = [&](Measured& m, double value, const std::string& where) {
                m.value = std::max(m.value, value);
                if (!m.limit || !(value > *m.limit)) return;
                ++m.beyond;
                Finding found;
                found.value = value;
                found.text = fmt::format("view {} of {}{}", v + 1, out_.views.size(), where);
                FindingList(m).add(found);
            };
            note(outlines, view.outline, fmt::format(" at pixel ({}, {})", view.x, view.y));
            if (view.compared_flip) note(flips, view.flip, "");
        }
        FindingList(outlines).finish();
        FindingList(flips).finish();
        return {};
    }

    void decide() {
        for (Measured& m : out_.measured)
            m.within = !m.limit || m.high.value_or(m.value) <= *m.limit;
        const bool moved = !of(&Limits::positions).within, changed = !of(&Limits::faces).within;
        for (Measured& m : out_.measured) {
            const bool of_shape = m.row->limit == &Limits::distance ||
                                  m.row->limit == &Limits::silhouettes ||
                                  m.row->limit == &Limits::flip;
            if (!m.within && of_shape) m.follows = moved ? "positions" : changed ? "faces" : "";
            // Only what is beyond its own limit is a cause.
            const bool caused =
                std::any_of(out_.measured.begin(), out_.measured.end(), [&](const Measured& cause) {
                    return !cause.within && m.follows == cause.row->name;
                });
            if (m.within || !caused) m.follows.clear();
        }
        // A picture that differs shows what else does.
        Measured& flips = of(&Limits::flip);
        if (!flips.within && flips.follows.empty())
            for (const Measured& m : out_.measured)
                if (!m.within && m.row->limit != &Limits::flip && m.follows.empty()) {
                    flips.follows = m.row->name;
                    break;
                }
        assert(out_.within() ==
               std::none_of(out_.measured.begin(), out_.measured.end(),
                            [](const Measured& m) { return !m.within && m.follows.empty(); }));
    }

    const prep::Scene &scene_a_, &scene_b_;
    const JudgeOptions& options_;
    Unshown unshown_;
    WorldFaces a_, b_;
    bool whole_ = true;  // faces, not triangles
    Matching matching_;
    std::optional<WorldFaces> cut_a_, cut_b_;  // triangles
    std::optional<FaceCuts> cuts_a_, cuts_b_;
    Judgement out_;
    double scale_ = 1, bound_ = 0;  // no surface is farther from the other than `bound_`
};

}  // namespace

bool Judgement::within() const {
    return std::all_of(measured.begin(), measured.end(),
                       [](const Measured& m) { return m.within; });
}

prep::Result<Judgement> judge(const prep::Scene& a, const prep::Scene& b,
                              const JudgeOptions& options) {
    for (const std::string& name : options.meshes) {
        const bool there = std::any_of(a.meshes.begin(), a.meshes.end(),
                                       [&](const prep::Mesh& m) { return m.name == name; });
        if (!there)
            return prep::Error{prep::ErrorCode::invalid, "has no mesh named '" + name + "'",
                               a.source.string()};
    }
    for (const prep::Scene* scene : {&a, &b}) {
        std::uint64_t corners = 0;
        for (const prep::Mesh& mesh : scene->meshes) corners += mesh.corner_count();
        for (const prep::Node& node : scene->nodes)
            if (node.mesh < scene->meshes.size())
                corners += scene->meshes[node.mesh].corner_count();
        if (corners > most_corners)
            return prep::Error{prep::ErrorCode::limit,
                               fmt::format("has {} corners under its nodes; {} can be compared",
                                           corners, most_corners),
                               scene->source.string()};
    }
    return Judge(a, b, options).run();
}

}  // namespace judge
