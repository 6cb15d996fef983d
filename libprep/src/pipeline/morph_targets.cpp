#include "pipeline/morph_targets.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_set>

#include "base/finite.h"
#include "model/vertex_deltas.h"
#include "pipeline/array_bytes.h"
#include "pipeline/mesh_preparation.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

glm::vec3 unit_or_same(const glm::vec3& n) {
    const double length = glm::length(glm::dvec3(n));
    return length > 0 && std::isfinite(length) ? glm::vec3(glm::dvec3(n) / length) : n;
}

// By vertex of the split mesh, at the first of its corners. Zero where either is not finite.
template <class T>
std::vector<glm::vec3> differences(const VertexMesh& mesh, const CornerLayer<T>& of,
                                   const CornerLayer<T>& from) {
    std::vector<glm::vec3> result(mesh.vertex_count(), glm::vec3(0.0f));
    for (std::size_t v = 0; v < result.size(); ++v) {
        const Index corner = mesh.source_corners[v];
        if (corner == no_index || of.indices[corner] == no_index ||
            from.indices[corner] == no_index)
            continue;
        const glm::vec3 difference =
            glm::vec3(of.values[of.indices[corner]]) - glm::vec3(from.values[from.indices[corner]]);
        if (is_finite(difference)) result[v] = difference;
    }
    return result;
}

// Of all targets; what several share counts once.
std::uint64_t bytes_of_targets(const Mesh& mesh) {
    std::unordered_set<const void*> seen;
    std::uint64_t bytes = 0;
    for (const MorphTarget& target : mesh.morph_targets)
        for (const auto* runs : {&target.positions, &target.normals, &target.tangents})
            for (const VertexDeltas& run : *runs)
                if (run.values && seen.insert(run.values.get()).second)
                    bytes += array_bytes(*run.values);
    return bytes;
}

}  // namespace

MorphShape morph_shape(const Mesh& mesh, const MorphTarget& target) {
    MorphShape shape;
    shape.positions = mesh.positions;
    shape.moves = !target.positions.empty();
    if (shape.moves)
        for (Index v = 0; v < mesh.vertex_count(); ++v)
            if (const glm::vec3* d = delta_of(target.positions, mesh.file_vertex(v)))
                shape.positions[v] += *d;
    if (target.normals.empty()) return shape;
    // What welding made one vertex turns as its corners did.
    const bool by_corner = !mesh.corner_file_vertices.empty();
    shape.normal_deltas.resize(by_corner ? mesh.corner_count() : mesh.vertex_count(),
                               glm::vec3(0.0f));
    for (Index i = 0; i < shape.normal_deltas.size(); ++i) {
        const Index in_file = by_corner ? mesh.corner_file_vertices[i] : mesh.file_vertex(i);
        if (const glm::vec3* d = delta_of(target.normals, in_file)) shape.normal_deltas[i] += *d;
    }
    return shape;
}

CornerLayer<glm::vec3> morphed_normals(const Mesh& mesh, const std::vector<glm::vec3>& deltas) {
    CornerLayer<glm::vec3> result;
    result.indices = mesh.normals.indices;
    const bool by_corner = !mesh.corner_file_vertices.empty();
    const auto delta = [&](std::size_t c) -> const glm::vec3& {
        return deltas[by_corner ? c : mesh.corner_vertices[c]];
    };
    // Normals that are turned alike wherever they are used, as files have them, keep their numbers;
    // else corners get their own.
    std::vector<Index> first_corners(mesh.normals.values.size(), no_index);
    bool own = true;
    for (std::size_t c = 0; c < result.indices.size(); ++c) {
        const Index n = result.indices[c];
        if (n == no_index) continue;
        if (first_corners[n] == no_index) first_corners[n] = Index(c);
        own &= std::memcmp(&delta(first_corners[n]), &delta(c), sizeof(glm::vec3)) == 0;
    }
    if (own) {
        result.values = mesh.normals.values;
        for (std::size_t n = 0; n < first_corners.size(); ++n)
            if (first_corners[n] != no_index)
                result.values[n] = unit_or_same(result.values[n] + delta(first_corners[n]));
        return result;
    }
    result.values.reserve(result.indices.size());
    for (std::size_t c = 0; c < result.indices.size(); ++c) {
        Index& n = result.indices[c];
        if (n == no_index) continue;
        result.values.push_back(unit_or_same(mesh.normals.values[n] + delta(c)));
        n = Index(result.values.size() - 1);
    }
    return result;
}

Result<void> MeshPreparation::prepare_morph_targets() {
    if (!normals_made_ && !tangents_made_) return {};
    // Targets that share their data cost a file next to nothing, and each of them a mesh here;
    // those with data of their own stay far below this.
    const std::size_t targets = mesh_.morph_targets.size();
    const std::uint64_t vectors = std::uint64_t(targets) * mesh_.corner_count();
    const std::uint64_t bytes = std::max(out_.scene.source_bytes, bytes_of_targets(mesh_));
    if (vectors > (std::uint64_t(1) << 26) + 16 * bytes)
        return Error{ErrorCode::limit,
                     std::to_string(targets) + " morph targets of " +
                         std::to_string(mesh_.corner_count()) + " corners from " +
                         std::to_string(bytes) +
                         " bytes; leave normals and tangents as they are, or split the mesh",
                     ""};
    for (const MorphTarget& target : mesh_.morph_targets) {
        auto deltas = log_.run("morph targets", "the mesh's normals or tangents are new",
                               [&] { return morph_deltas(target); });
        if (!deltas) return std::move(deltas).error();
        out_.morphs[index_].push_back(*std::move(deltas));
    }
    return {};
}

Result<MorphDeltas> MeshPreparation::morph_deltas(const MorphTarget& target) {
    const MorphShape shape = morph_shape(mesh_, target);
    MorphDeltas deltas;
    if (!shape.moves && shape.normal_deltas.empty()) return deltas;
    MeshView view(mesh_, need_.tangent_uv_set);
    if (!mixed_uvs_.empty()) view.uv = mixed_uvs_;
    view.positions = shape.positions;
    CornerLayer<glm::vec3> normals;
    if (limit_normals_) {
        const std::size_t number = out_.morphs[index_].size();
        normals = limit_morph_normals_[number];
        deltas.normals = differences(out_.meshes[index_], normals, mesh_.normals);
    } else if (normals_made_) {
        NormalOptions options = options_.normal;
        options.threads = options_.threads;
        auto computed = corner_normals(view, *geometry_.topology,
                                       face_normals(view, options.precision, options.threads),
                                       *geometry_.hard, options);
        if (!computed) return std::move(computed).error();
        normals = std::move(computed->normals);
        deltas.normals = differences(out_.meshes[index_], normals, mesh_.normals);
    } else if (!shape.normal_deltas.empty()) {
        normals = morphed_normals(mesh_, shape.normal_deltas);
    } else {
        normals = mesh_.normals;
    }
    if (!tangents_made_) return deltas;
    view.normals = {normals.values, normals.indices};
    TangentOptions options = options_.tangent;
    options.threads = options_.threads;
    auto tangents = corner_tangents(TangentInput(view), options);
    if (!tangents) return std::move(tangents).error();
    deltas.tangents = differences(out_.meshes[index_], tangents->tangents, mesh_.tangents);
    return deltas;
}

}  // namespace prep::detail
