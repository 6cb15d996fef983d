#include "prep/prepare.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "formats/gltf/morph_targets.h"
#include "normals/authored_normals.h"
#include "prep/split_vertices.h"
#include "prep/topology.h"
#include "surface/share_vertices.h"
#include "tangents/authored_tangents.h"

namespace prep {
namespace {

using Clock = std::chrono::steady_clock;
using detail::NormalReview;
using detail::TangentReview;

// Collects, over all meshes, whether a stage ran, the first reason given for running or skipping
// it, and its time.
class StageLog {
  public:
    void skipped(const std::string& stage, const std::string& reason) {
        Entry& e = entry(stage);
        ++e.skipped;
        if (e.skip_reason.empty()) e.skip_reason = reason;
    }
    template <class Work>
    auto run(const std::string& stage, const std::string& reason, const Work& work) {
        const Clock::time_point start = Clock::now();
        auto result = work();
        Entry& e = entry(stage);
        ++e.run;
        e.milliseconds += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
        if (e.run_reason.empty()) e.run_reason = reason;
        return result;
    }
    void count_exact(const std::string& stage, std::uint64_t count) { entry(stage).exact += count; }
    std::vector<StageReport> reports() const {
        std::vector<StageReport> result;
        for (const Entry& e : entries_) {
            StageReport r{e.stage, e.run > 0, e.run > 0 ? e.run_reason : e.skip_reason,
                          e.milliseconds, e.exact};
            if (e.run > 0 && e.skipped > 0)
                r.reason = std::to_string(e.run) + " of " + std::to_string(e.run + e.skipped) +
                           " meshes: " + r.reason + "; others: " + e.skip_reason;
            result.push_back(std::move(r));
        }
        return result;
    }

  private:
    struct Entry {
        std::string stage, run_reason, skip_reason;
        std::size_t run = 0, skipped = 0;
        double milliseconds = 0;
        std::uint64_t exact = 0;
    };
    Entry& entry(const std::string& stage) {
        for (Entry& e : entries_)
            if (e.stage == stage) return e;
        entries_.push_back({stage, {}, {}});
        return entries_.back();
    }
    std::vector<Entry> entries_;
};

// Formats that index by vertex repeat a point for every seam: adjacency then needs the weld. A file
// that indexes attributes apart from positions says itself which points are one.
bool indexed_by_vertex(const Mesh& mesh) {
    const auto follows = [&](const std::vector<std::uint32_t>& indices) {
        return !indices.empty() &&
               std::equal(indices.begin(), indices.end(), mesh.corner_vertices.begin());
    };
    if (follows(mesh.normals.indices) || follows(mesh.tangents.indices)) return true;
    for (const auto& uv : mesh.uvs)
        if (follows(uv.indices)) return true;
    return detail::is_soup(mesh);
}

// glTF has one index per corner, whatever attributes it carries or lacks, and two primitives never
// share a vertex. They are the parts that have no names, also in a scene of several files.
bool has_gltf_primitives(const Mesh& mesh) {
    return !mesh.parts.empty() && std::all_of(mesh.parts.begin(), mesh.parts.end(),
                                              [](const std::string& p) { return p.empty(); });
}

class Preparer {
  public:
    Preparer(const PrepareOptions& options, PreparedScene& out) : options_(options), out_(out) {}

    Result<void> prepare_mesh(std::uint32_t index) {
        Mesh& mesh = out_.scene.meshes[index];
        const MeshRequirements& need = out_.requirements[index];
        geometry_ = {};
        normals_made_ = tangents_made_ = false;
        normal_replaced_.clear();
        // What is rewritten in place keeps its vertices: skins and morph targets count on them.
        if (options_.weld != WeldMode::none && !out_.scene.document && detail::is_soup(mesh)) {
            geometry_.shared = log_.run(
                "weld", "every corner has a vertex of its own: those at one point are shared", [&] {
                    detail::share_equal_vertices(mesh, options_.threads);
                    return true;
                });
        }
        if (auto done = repair_mesh(index, mesh); !done) return std::move(done).error();
        if (auto done = prepare_normals(index, mesh, need); !done) return std::move(done).error();
        if (auto done = prepare_tangents(index, mesh, need); !done) return std::move(done).error();
        const GltfDocument* const document = out_.scene.document.get();
        auto split_mesh = log_.run("split", "vertices carry one set of attributes each", [&] {
            // The parts of a glTF are its primitives, each with vertices of its own to be written
            // back; everywhere else they are names.
            return split(
                mesh, geometry_.hard ? &*geometry_.hard : nullptr,
                {.parts_apart = document != nullptr,
                 .file_vertices_apart = document && detail::has_more_than_layers(*document, index),
                 .threads = options_.threads});
        });
        if (!split_mesh) return std::move(split_mesh).error();
        out_.meshes[index] = *std::move(split_mesh);
        count_splits(out_.meshes[index]);
        return prepare_morphs(index, mesh, need);
    }

    std::vector<StageReport> reports() const { return log_.reports(); }

  private:
    Result<void> repair_mesh(std::uint32_t index, Mesh& mesh) {
        if (!options_.repair.any()) return {};
        auto log = log_.run("repair", "asked for",
                            [&] { return repair(mesh, options_.repair, index, options_.threads); });
        if (!log) return std::move(log).error();
        out_.repairs.insert(out_.repairs.end(), log->begin(), log->end());
        return {};
    }

    struct Geometry {  // computed once per mesh, when the first stage asks
        std::optional<FaceNormals> faces;
        std::optional<Topology> topology;
        std::optional<HardEdges> hard;
        bool shared = false;  // equal positions share a vertex already
    };

    void add_finding(std::uint32_t mesh, std::string kind, Severity severity, std::uint64_t count,
                     std::vector<std::uint32_t> places, std::string text) {
        if (count == 0) return;
        Finding finding;
        finding.kind = std::move(kind);
        finding.severity = severity;
        finding.mesh = mesh;
        finding.count = count;
        finding.place_kind = PlaceKind::corner;
        finding.places = std::move(places);
        finding.text = std::move(text);
        out_.findings.push_back(std::move(finding));
    }

    static std::vector<std::uint32_t> first_corners(const NormalReview& review, unsigned faults) {
        std::vector<std::uint32_t> places;
        for (std::uint32_t c = 0; c < review.faults.size(); ++c) {
            if (!(review.faults[c] & faults)) continue;
            places.push_back(c);
            if (places.size() == Finding::max_places) break;
        }
        return places;
    }

    Result<CornerNormals> compute_normals(const Mesh& mesh, const std::string& reason) {
        const MeshView view(mesh);
        const bool weld =
            !geometry_.shared && (options_.weld == WeldMode::exact ||
                                  (options_.weld == WeldMode::automatic &&
                                   (has_gltf_primitives(mesh) || indexed_by_vertex(mesh))));
        std::vector<std::uint32_t> welded;
        if (weld) {
            welded =
                log_.run("weld", "vertices are repeated at seams: equal positions are one point",
                         [&] { return weld_exact(view.positions, options_.threads); });
        } else if (!geometry_.shared) {
            const bool attributes =
                !mesh.normals.empty() || !mesh.tangents.empty() || !mesh.uvs.empty();
            log_.skipped("weld", options_.weld == WeldMode::none ? "switched off"
                                 : attributes
                                     ? "the file indexes positions apart from attributes"
                                     : "the file's faces share vertices, and nothing repeats them");
        }
        geometry_.topology = log_.run(
            "topology", reason, [&] { return build_topology(view, welded, options_.threads); });
        if (!geometry_.faces) {
            geometry_.faces = log_.run("face normals", reason, [&] {
                return face_normals(view, options_.normal.precision, options_.threads);
            });
        }
        HardEdgeOptions hard_options = options_.hard_edges;
        hard_options.threads = options_.threads;
        auto hard = log_.run("hard edges", reason, [&] {
            return hard_edges(view, *geometry_.topology, *geometry_.faces, hard_options);
        });
        if (!hard) return std::move(hard).error();
        log_.count_exact("face normals", geometry_.faces->exact_faces);
        log_.count_exact("hard edges", hard->exact_decisions);
        geometry_.hard = *std::move(hard);
        NormalOptions normal_options = options_.normal;
        normal_options.threads = options_.threads;
        auto normals = log_.run("normals", reason, [&] {
            return corner_normals(view, *geometry_.topology, *geometry_.faces, *geometry_.hard,
                                  normal_options);
        });
        if (normals) log_.count_exact("normals", normals->exact_sums);
        return normals;
    }

    void skip_normals(const std::string& reason) {
        if (!geometry_.shared) log_.skipped("weld", reason);
        for (const char* stage : {"topology", "face normals", "hard edges", "normals"})
            log_.skipped(stage, reason);
    }

    Result<void> prepare_normals(std::uint32_t index, Mesh& mesh, const MeshRequirements& need) {
        if (!need.normals.needed) {
            skip_normals(need.normals.reason);
            return {};
        }
        NormalReview review;
        unsigned replace = 0xff;
        std::string reason = need.normals.reason;
        if (options_.normals != Authored::replace && !mesh.normals.empty()) {
            const MeshView view(mesh);
            if (options_.normals == Authored::repair) {
                geometry_.faces =
                    log_.run("face normals", "authored normals are held against them", [&] {
                        return face_normals(view, options_.normal.precision, options_.threads);
                    });
            }
            review = detail::review_normals(view, geometry_.faces ? &*geometry_.faces : nullptr);
            report_review(index, review);
            replace = detail::normal_missing | detail::normal_non_finite | detail::normal_zero;
            if (options_.normals == Authored::repair)
                replace |= detail::normal_non_unit | detail::normal_flipped;
            bool any = false;
            for (const std::uint8_t f : review.faults) any |= (f & replace) != 0;
            if (!any) {
                skip_normals("the file's own normals are kept");
                if (!review.perfect())
                    mesh.normals = detail::merge_normals(mesh.normals, review, replace, nullptr);
                return {};
            }
            reason = "some authored normals are missing or bad";
        }
        auto computed = compute_normals(mesh, reason);
        if (!computed) return std::move(computed).error();
        report_fallbacks(index, *computed);
        if (review.faults.empty()) {
            mesh.normals = std::move(computed->normals);
            normals_made_ = true;
        } else {
            mesh.normals = detail::merge_normals(mesh.normals, review, replace, &computed->normals);
            for (const std::uint8_t faults : review.faults)
                normal_replaced_.push_back((faults & replace) != 0);
            geometry_.hard.reset();  // most normals are the file's: it says where they differ
        }
        return {};
    }

    void report_review(std::uint32_t index, const NormalReview& review) {
        const bool repair = options_.normals == Authored::repair;
        add_finding(index, "missing-normal", Severity::info, review.missing,
                    first_corners(review, detail::normal_missing),
                    "corners without a normal got a computed one");
        add_finding(index, "non-finite-normal", Severity::warning, review.non_finite,
                    first_corners(review, detail::normal_non_finite),
                    "authored normals that are not finite were replaced");
        add_finding(index, "zero-normal", Severity::warning, review.zero,
                    first_corners(review, detail::normal_zero),
                    "authored normals of length zero were replaced");
        add_finding(index, "non-unit-normal", Severity::warning, review.non_unit,
                    first_corners(review, detail::normal_non_unit),
                    repair ? "authored normals that are not unit were replaced"
                           : "authored normals that are not unit were rescaled");
        add_finding(index, "flipped-normal", Severity::warning, review.flipped,
                    first_corners(review, detail::normal_flipped),
                    "authored normals against their face were replaced");
    }

    void report_fallbacks(std::uint32_t index, const CornerNormals& computed) {
        std::vector<std::uint32_t> vanished, undefined;
        std::uint64_t vanished_count = 0, undefined_count = 0;
        for (const auto& fallback : computed.fallbacks) {
            const bool none = fallback.kind == NormalFallback::none_defined;
            ++(none ? undefined_count : vanished_count);
            auto& places = none ? undefined : vanished;
            if (places.size() < Finding::max_places) places.push_back(fallback.corner);
        }
        add_finding(index, "vanishing-normal", Severity::warning, vanished_count, vanished,
                    "the face normals around a corner cancel: it took the largest face's");
        add_finding(index, "undefined-normal", Severity::warning, undefined_count, undefined,
                    "no face around a corner has a normal: it got (0, 0, 1)");
    }

    // A tangent belongs to its normal: where that is not the file's any more, it is computed anew.
    // A normal that was only rescaled is the file's.
    Result<void> prepare_tangents(std::uint32_t index, Mesh& mesh, const MeshRequirements& need) {
        const MeshView view(mesh, need.tangent_uv_set);
        const std::string& reason = need.tangents.reason;
        if (need.tangents.needed) {
            if (mesh.tangents.empty() || options_.tangents == Authored::replace)
                return replace_tangents(index, mesh, view, reason, everywhere);
            if (options_.tangents == Authored::repair)
                return replace_tangents(index, mesh, view,
                                        "authored tangents are held against them", 0xff);
            if (normals_made_)
                return replace_tangents(
                    index, mesh, view,
                    "the normals changed, so the file's own tangents no longer fit", everywhere);
            return keep_tangents(index, mesh, view, "the file's own tangents are kept");
        }
        const bool untouched =
            options_.request.tangents == Request::Level::never && normal_replaced_.empty();
        if (!mesh.tangents.empty() && !normals_made_ && !untouched)
            return keep_tangents(index, mesh, view, reason);
        log_.skipped("tangents", reason);
        if (normals_made_) drop_tangents(index, mesh);
        return {};
    }

    // But for those that are no frame any more.
    Result<void> keep_tangents(std::uint32_t index, Mesh& mesh, const MeshView& view,
                               const std::string& reason) {
        constexpr unsigned bad = detail::tangent_unusable | detail::tangent_stale;
        const TangentReview review = review_of(view, mesh, nullptr);
        // Without UVs there is no direction to compute.
        const bool lost = view.uv.indices.empty() && review.any(detail::tangent_stale);
        if (!lost && review.any(bad))
            return replace_tangents(index, mesh, view,
                                    "some authored tangents are missing, unusable or of normals "
                                    "that were replaced",
                                    bad);
        log_.skipped("tangents", reason);
        if (lost) {
            drop_tangents(index, mesh);
            return {};
        }
        report_review(index, review, bad);
        if (review.any(detail::tangent_non_unit))
            mesh.tangents = detail::merge_tangents(mesh.tangents, review, bad, nullptr);
        return {};
    }

    void drop_tangents(std::uint32_t index, Mesh& mesh) {
        if (mesh.tangents.empty()) return;
        add_finding(index, "stale-tangent", Severity::info, mesh.corner_count(), {},
                    "authored tangents were dropped: the normals they belong to changed");
        mesh.tangents = {};
    }

    TangentReview review_of(const MeshView& view, const Mesh& mesh,
                            const CornerTangents* computed) const {
        TangentReview review = detail::review_tangents(view, mesh.tangents, computed);
        review.mark_stale(normal_replaced_);
        return review;
    }

    // Everywhere, or where the file's own have one of these faults.
    static constexpr unsigned everywhere = 0;
    Result<void> replace_tangents(std::uint32_t index, Mesh& mesh, const MeshView& view,
                                  const std::string& reason, unsigned replace) {
        TangentOptions tangent_options = options_.tangent;
        tangent_options.threads = options_.threads;
        // Authored tangents may come without UVs or normals: any frame then stands in for bad ones.
        TangentInput input(view);
        std::vector<std::uint32_t> none;
        if (input.uv.indices.empty() || input.normals.indices.empty())
            none.assign(view.corner_count(), no_index);
        if (input.uv.indices.empty()) input.uv = {{}, none};
        if (input.normals.indices.empty()) input.normals = {{}, none};
        auto tangents =
            log_.run("tangents", reason, [&] { return corner_tangents(input, tangent_options); });
        if (!tangents) return std::move(tangents).error();
        TangentReview review;
        const bool surgical = replace != everywhere;
        if (surgical) {
            const bool repair = options_.tangents == Authored::repair;
            review = review_of(view, mesh, repair ? &*tangents : nullptr);
            report_review(index, review, replace);
        }
        std::uint64_t fallbacks = 0;
        std::vector<std::uint32_t> places;
        for (const auto& fallback : tangents->fallbacks) {
            if (surgical && !(review.faults[fallback.corner] & replace)) continue;
            ++fallbacks;
            if (places.size() < Finding::max_places) places.push_back(fallback.corner);
        }
        add_finding(index, "tangent-fallback", Severity::info, fallbacks, std::move(places),
                    "MikkTSpace defines no tangent at these corners: they got an orthonormal one");
        mesh.tangents =
            surgical ? detail::merge_tangents(mesh.tangents, review, replace, &tangents->tangents)
                     : std::move(tangents->tangents);
        tangents_made_ = !surgical;
        return {};
    }

    // What was computed for the mesh its morph targets need as well: the file's deltas, if it has
    // any, belong to normals and tangents that are gone.
    Result<void> prepare_morphs(std::uint32_t index, const Mesh& mesh,
                                const MeshRequirements& need) {
        const GltfDocument* document = out_.scene.document.get();
        if (!document || (!normals_made_ && !tangents_made_)) return {};
        const std::size_t targets = detail::morph_target_count(*document, index);
        // Targets that share their data cost a file next to nothing, and each of them a mesh here;
        // those with data of their own stay far below this.
        const std::uint64_t vectors = std::uint64_t(targets) * mesh.corner_count();
        if (vectors > (std::uint64_t(1) << 26) + 16 * document->input_bytes)
            return Error{ErrorCode::limit,
                         std::to_string(targets) + " morph targets of " +
                             std::to_string(mesh.corner_count()) + " corners in a file of " +
                             std::to_string(document->input_bytes) +
                             " bytes; leave normals and tangents as they are, or split the mesh",
                         ""};
        for (std::size_t t = 0; t < targets; ++t) {
            auto deltas = log_.run("morph targets", "the mesh's normals or tangents are new",
                                   [&] { return morph_deltas(*document, index, mesh, need, t); });
            if (!deltas) return std::move(deltas).error();
            out_.morphs[index].push_back(*std::move(deltas));
        }
        return {};
    }

    Result<MorphDeltas> morph_deltas(const GltfDocument& document, std::uint32_t index,
                                     const Mesh& mesh, const MeshRequirements& need,
                                     std::size_t target) {
        auto shape = detail::morph_shape(document, index, mesh, target);
        if (!shape) return std::move(shape).error();
        MorphDeltas deltas;
        if (!shape->moves && shape->normal_deltas.empty()) return deltas;
        MeshView view(mesh, need.tangent_uv_set);
        view.positions = shape->positions;
        CornerLayer<glm::vec3> normals;
        if (normals_made_) {
            NormalOptions options = options_.normal;
            options.threads = options_.threads;
            auto computed = corner_normals(view, *geometry_.topology,
                                           face_normals(view, options.precision, options.threads),
                                           *geometry_.hard, options);
            if (!computed) return std::move(computed).error();
            normals = std::move(computed->normals);
            deltas.normals = differences(index, normals, mesh.normals);
        } else if (!shape->normal_deltas.empty()) {
            normals = detail::morphed_normals(mesh, shape->normal_deltas);
        } else {
            normals = mesh.normals;
        }
        if (!tangents_made_) return deltas;
        view.normals = {normals.values, normals.indices};
        TangentOptions options = options_.tangent;
        options.threads = options_.threads;
        auto tangents = corner_tangents(TangentInput(view), options);
        if (!tangents) return std::move(tangents).error();
        deltas.tangents = differences(index, tangents->tangents, mesh.tangents);
        return deltas;
    }

    // By vertex of the split mesh, at the first of its corners. Zero where either is not finite.
    template <class T>
    std::vector<glm::vec3> differences(std::uint32_t index, const CornerLayer<T>& of,
                                       const CornerLayer<T>& from) const {
        const VertexMesh& mesh = out_.meshes[index];
        std::vector<glm::vec3> result(mesh.vertex_count(), glm::vec3(0.0f));
        for (std::size_t v = 0; v < result.size(); ++v) {
            const std::uint32_t corner = mesh.source_corners[v];
            if (corner == no_index || of.indices[corner] == no_index ||
                from.indices[corner] == no_index)
                continue;
            const glm::vec3 difference = glm::vec3(of.values[of.indices[corner]]) -
                                         glm::vec3(from.values[from.indices[corner]]);
            if (std::isfinite(difference.x) && std::isfinite(difference.y) &&
                std::isfinite(difference.z))
                result[v] = difference;
        }
        return result;
    }

    void report_review(std::uint32_t index, const TangentReview& review, unsigned replaced) {
        struct Kind {
            const char *name, *what, *kept;
        };
        static constexpr Kind kinds[detail::tangent_fault_kinds] = {
            {"missing-tangent", "corners without a tangent got a computed one", ""},
            {"non-finite-tangent", "authored tangents that are not finite were replaced", ""},
            {"zero-tangent", "authored tangents of length zero were replaced", ""},
            {"tangent-sign", "authored tangents whose w is no sign were replaced", ""},
            {"non-unit-tangent", "authored tangents that are not unit were replaced",
             "authored tangents that are not unit were rescaled, their w made 1 or -1"},
            {"non-orthogonal-tangent",
             "authored tangents out of their normal's plane were replaced",
             "authored tangents are out of their normal's plane: kept, repairing replaces them"},
            {"tangent-against-uvs", "authored tangents that contradict the UVs were replaced", ""},
            {"stale-tangent", "authored tangents whose normals were replaced were replaced too",
             ""},
        };
        for (unsigned k = 0; k < detail::tangent_fault_kinds; ++k) {
            const char* const text = (replaced >> k & 1u) ? kinds[k].what : kinds[k].kept;
            if (review.counts[k] == 0 || *text == 0) continue;
            std::vector<std::uint32_t> places;
            for (std::uint32_t c = 0; c < review.faults.size(); ++c) {
                if (!(review.faults[c] >> k & 1u)) continue;
                places.push_back(c);
                if (places.size() == Finding::max_places) break;
            }
            add_finding(index, kinds[k].name, k == 0 ? Severity::info : Severity::warning,
                        review.counts[k], std::move(places), text);
        }
    }

    void count_splits(const VertexMesh& mesh) {
        SplitCounts& n = out_.splits;
        for (const SplitReasons bits : mesh.split_reasons) {
            if (!bits) continue;
            const auto has = [&](SplitReason r) { return (bits & unsigned(r)) != 0 ? 1u : 0u; };
            n.hard_edge += has(SplitReason::hard_edge);
            n.smoothing_group += has(SplitReason::smoothing_group);
            n.authored_normal += has(SplitReason::authored_normal);
            n.uv_seam += has(SplitReason::uv_seam);
            n.mirrored_uv += has(SplitReason::mirrored_uv);
            n.tangent += has(SplitReason::tangent);
            n.color += has(SplitReason::color);
            n.material += has(SplitReason::material);
        }
    }

    const PrepareOptions& options_;
    PreparedScene& out_;
    StageLog log_;
    Geometry geometry_;
    bool normals_made_ = false, tangents_made_ = false;  // all of the mesh at hand
    std::vector<bool> normal_replaced_;  // per corner; empty: none of the file's own
};

}  // namespace

Result<PreparedScene> prepare(Scene scene, const PrepareOptions& options) {
    PreparedScene out;
    out.scene = std::move(scene);
    const Clock::time_point start = Clock::now();
    out.requirements = requirements(out.scene, options.request);
    const double milliseconds =
        std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    out.meshes.resize(out.scene.meshes.size());
    out.morphs.resize(out.scene.meshes.size());

    Preparer preparer(options, out);
    for (std::uint32_t m = 0; m < out.scene.meshes.size(); ++m) {
        if (auto done = preparer.prepare_mesh(m); !done) {
            Error error = std::move(done).error();
            if (error.place.empty()) error.place = "mesh '" + out.scene.meshes[m].name + "'";
            return error;
        }
    }
    out.stages = preparer.reports();
    out.stages.insert(
        out.stages.begin(),
        {"requirements", true, "decides what the stages below are needed for", milliseconds, 0});
    return out;
}

}  // namespace prep
