// The stages in their order, mesh by mesh.
#include "prep/prepare.h"

#include "pipeline/mesh_preparation.h"
#include "prep/split_vertices.h"
#include "surface/share_vertices.h"

namespace prep {

void count_splits(const VertexMesh& mesh, SplitCounts& counts) {
    for (const SplitReasons bits : mesh.split_reasons) {
        if (!bits) continue;
        for (const SplitCountName& row : split_count_names)
            counts.*row.count += (bits & unsigned(row.reason)) != 0;
    }
}

namespace detail {

Result<void> MeshPreparation::run() {
    share_vertices();
    if (auto done = repair_mesh(); !done) return done;
    out_.welded[index_] = is_welded();
    if (auto done = options_.tessellate ? tessellate_mesh() : subdivide_mesh(); !done) return done;
    if (auto done = prepare_normals(); !done) return done;
    make_normals_unit();
    out_.normals_made[index_] = normals_made_;
    if (auto done = prepare_tangents(); !done) return done;
    if (auto done = split_mesh(); !done) return done;
    if (auto done = bake_residuals(); !done) return done;
    return prepare_morph_targets();
}

// What is written back in place keeps its vertices, and so does what else is told by vertex.
void MeshPreparation::share_vertices() {
    const bool by_vertex = mesh_.tied_to_file || !mesh_.morph_targets.empty() ||
                           !mesh_.skin_influences.empty() || !mesh_.vertex_attributes.empty();
    if (options_.weld == WeldMode::none || by_vertex || !is_soup(mesh_)) return;
    geometry_.shared = log_.run(
        "weld", "every corner has a vertex of its own: those at one point are shared", [&] {
            share_equal_vertices(mesh_, options_.threads);
            return true;
        });
}

Result<void> MeshPreparation::repair_mesh() {
    if (!options_.repair.any()) return {};
    auto log = log_.run("repair", "asked for",
                        [&] { return repair(mesh_, options_.repair, index_, options_.threads); });
    if (!log) return std::move(log).error();
    out_.repairs.insert(out_.repairs.end(), log->begin(), log->end());
    return {};
}

Result<void> MeshPreparation::split_mesh() {
    auto split_mesh = log_.run("split", "vertices carry one set of attributes each", [&] {
        // Parts that are written back have vertices of their own; everywhere else they are names.
        return split(mesh_, geometry_.hard ? &*geometry_.hard : nullptr,
                     {.parts_apart = mesh_.tied_to_file, .threads = options_.threads});
    });
    if (!split_mesh) return std::move(split_mesh).error();
    out_.meshes[index_] = *std::move(split_mesh);
    count_splits(out_.meshes[index_], out_.splits);
    return {};
}

void MeshPreparation::add_finding(std::string kind, Severity severity, std::uint64_t count,
                                  std::vector<std::uint32_t> places, std::string text,
                                  PlaceKind place_kind) {
    if (count == 0) return;
    Finding finding;
    finding.kind = std::move(kind);
    finding.severity = severity;
    finding.mesh = index_;
    finding.count = count;
    finding.place_kind = place_kind;
    finding.places = std::move(places);
    finding.text = std::move(text);
    out_.findings.push_back(std::move(finding));
}

}  // namespace detail

Result<PreparedScene> prepare(Scene scene, const PrepareOptions& options) {
    PreparedScene out;
    out.scene = std::move(scene);
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    out.requirements = requirements(out.scene, options.request);
    const double milliseconds =
        std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    out.meshes.resize(out.scene.meshes.size());
    out.morphs.resize(out.scene.meshes.size());
    out.welded.resize(out.scene.meshes.size());
    out.subdivided.resize(out.scene.meshes.size());
    out.tessellated.resize(out.scene.meshes.size());
    if ((options.subdivide || options.tessellate) && options.keep_cages)
        out.cages.resize(out.scene.meshes.size());
    out.normals_made.resize(out.scene.meshes.size());

    detail::StageLog log;
    detail::DisplacementMaps maps(options.displacement, options.threads);
    std::optional<detail::ResidualMaps> residuals;
    if (options.tessellate && options.displacement.residual) {
        if (auto checked = detail::check_residual_options(options, out.scene); !checked)
            return std::move(checked).error();
        residuals.emplace(out.scene, *options.displacement.residual, options.threads);
    }
    const bool in_pixels = options.tessellate && options.tessellation.pixel_error;
    const auto instances =
        in_pixels ? detail::instances_of(out.scene)
                  : std::vector<std::vector<detail::MeshInstance>>(out.scene.meshes.size());
    for (std::uint32_t m = 0; m < out.scene.meshes.size(); ++m) {
        detail::ResidualMaps* const baked = residuals ? &*residuals : nullptr;
        auto done = detail::MeshPreparation(options, out, log, maps, baked, m, instances[m]).run();
        if (!done) {
            Error error = std::move(done).error();
            if (error.place.empty()) error.place = "mesh '" + out.scene.meshes[m].name + "'";
            return error;
        }
    }
    // What displaced a mesh is in its positions now: nobody shall displace it again.
    if (options.tessellate && options.displacement.from_materials) maps.forget(out);
    if (residuals) {
        auto put = log.run("residual maps", "residual normal maps were asked for",
                           [&] { return residuals->finish(out); });
        if (!put) return std::move(put).error();
    }
    out.stages = log.reports();
    out.stages.insert(
        out.stages.begin(),
        {"requirements", true, "decides what the stages below are needed for", milliseconds, 0});
    return out;
}

}  // namespace prep
