// The stages in their order, mesh by mesh.
#include "prep/prepare.h"

#include <algorithm>

#include "pipeline/array_bytes.h"
#include "pipeline/mesh_preparation.h"
#include "surface/share_vertices.h"
#include "surface/soup.h"
#include "vertices/split_vertices.h"

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
    drop_unread();
    if (auto done = split_mesh(); !done) return done;
    if (auto done = bake_residuals(); !done) return done;
    if (auto done = prepare_morph_targets(); !done) return done;
    optimize_mesh();
    return {};
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
        return split_vertices(mesh_, geometry_.hard ? &*geometry_.hard : nullptr,
                              geometry_.around ? &*geometry_.around : nullptr,
                              {.parts_apart = mesh_.tied_to_file, .threads = options_.threads},
                              normal_replaced_.empty() ? nullptr : &normal_replaced_,
                              normals_apart_);
    });
    if (!split_mesh) return std::move(split_mesh).error();
    out_.meshes[index_] = *std::move(split_mesh);
    log_.count_moved("split", array_bytes(mesh_) + array_bytes(out_.meshes[index_]));
    count_splits(out_.meshes[index_], out_.splits);
    return {};
}

// Last, so that nothing before it depends on the order.
void MeshPreparation::optimize_mesh() {
    VertexMesh& mesh = out_.meshes[index_];
    if (!options_.optimize || mesh.triangle_count() == 0) return;
    const std::vector<Material>& materials = out_.scene.materials;
    const auto blends = [&](std::uint32_t m) {
        return m < materials.size() && materials[m].alpha_mode == AlphaMode::blend;
    };
    const bool variant_blends =
        std::any_of(mesh_.variant_materials.begin(), mesh_.variant_materials.end(), blends);
    const RetainedFile* const file = mesh_.tied_to_file ? out_.scene.retained_file.get() : nullptr;
    const Reordered done = log_.run("optimize", "asked for", [&] {
        return optimize_order(mesh, [&](const VertexMesh::Range& range) {
            const bool seen = variant_blends || blends(range.material);
            const KeptOrder visible = seen ? KeptOrder::triangles : KeptOrder::none;
            return file ? std::max(visible, file->kept_order(index_, range.part)) : visible;
        });
    });
    out_.orders[index_] = done.change;
    log_.count_moved("optimize", 2 * array_bytes(mesh));
    for (MorphDeltas& deltas : out_.morphs[index_]) {
        take_in_order(deltas.normals, done.old_vertices);
        take_in_order(deltas.tangents, done.old_vertices);
    }
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

namespace {

// Nothing that the file brings is dropped, whoever it is prepared for.
void keep_all(PreparedScene& out) {
    for (std::size_t m = 0; m < out.scene.meshes.size(); ++m) {
        const Mesh& mesh = out.scene.meshes[m];
        const MeshContents contents = contents_of(mesh, 0);
        out.requirements[m].provided |=
            {contents.normals, !mesh.tangents.empty(), contents.colors, contents.uv_sets};
    }
}

}  // namespace

Result<PreparedScene> prepare(Scene scene, const PrepareOptions& options) {
    PreparedScene out;
    out.scene = std::move(scene);
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    const detail::ProcessMemory before = detail::process_memory();
    out.requirements = requirements(out.scene, options.request);
    // Residual maps are yet to be baked against what there is.
    if (options.tessellate && options.displacement.residual) keep_all(out);
    const double milliseconds =
        std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    const detail::ProcessMemory after = detail::process_memory();
    out.meshes.resize(out.scene.meshes.size());
    out.morphs.resize(out.scene.meshes.size());
    out.welded.resize(out.scene.meshes.size());
    out.subdivided.resize(out.scene.meshes.size());
    out.tessellated.resize(out.scene.meshes.size());
    if ((options.subdivide || options.tessellate) && options.keep_cages)
        out.cages.resize(out.scene.meshes.size());
    if (options.tessellate && options.keep_cages)
        out.tessellation_errors.resize(out.scene.meshes.size());
    out.normals_made.resize(out.scene.meshes.size());
    out.orders.resize(out.scene.meshes.size());

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
    if (!residuals) detail::drop_unread_maps(out, options, log);
    // What displaced a mesh is in its positions now: nobody shall displace it again.
    if (options.tessellate && options.displacement.from_materials) maps.forget(out);
    if (residuals) {
        auto put = log.run("residual maps", "residual normal maps were asked for",
                           [&] { return residuals->finish(out); });
        if (!put) return std::move(put).error();
    }
    out.stages = log.reports();
    out.stages.insert(out.stages.begin(),
                      {"requirements", true, "decides what the stages below are needed for",
                       milliseconds, 0, after.page_faults - before.page_faults, after.peak_bytes});
    return out;
}

}  // namespace prep
