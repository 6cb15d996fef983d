#include "formats/gltf/morph_targets.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>

#include "formats/gltf/gltf.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

const Json* targets_of(const GltfDocument& document, std::size_t mesh, std::size_t primitive) {
    const Json& entry = document.json["meshes"][mesh]["primitives"][primitive];
    const auto targets = entry.find("targets");
    return targets == entry.end() ? nullptr : &*targets;
}

// Vertices, or corners, by primitive: looked up once for all attributes, however many primitives.
// in_file: which vertices of the file they are; empty: each is itself.
class ByPrimitive {
  public:
    ByPrimitive(const std::vector<GltfPrimitive>& primitives, std::size_t count,
                std::span<const Index> in_file)
        : starts_(primitives.size() + 1, 0), in_file_(in_file) {
        // Primitives' vertices follow one another; those without any would hide others.
        std::vector<Index> firsts, numbers;
        for (std::size_t p = 0; p < primitives.size(); ++p) {
            if (primitives[p].vertex_count == 0) continue;
            firsts.push_back(primitives[p].first_vertex);
            numbers.push_back(Index(p));
        }
        const auto primitive_of = [&](Index vertex) {
            const auto behind = std::upper_bound(firsts.begin(), firsts.end(), vertex);
            if (behind == firsts.begin()) return no_index;
            const Index p = numbers[std::size_t(behind - firsts.begin()) - 1];
            return vertex - primitives[p].first_vertex < primitives[p].vertex_count ? p : no_index;
        };
        std::vector<Index> owners(count);
        for (Index i = 0; i < count; ++i) {
            owners[i] = primitive_of(in_file_of(i));
            if (owners[i] != no_index) ++starts_[owners[i] + std::size_t(1)];
        }
        for (std::size_t p = 0; p < primitives.size(); ++p) starts_[p + 1] += starts_[p];
        items_.resize(starts_.back());
        std::vector<std::size_t> cursors(starts_.begin(), starts_.end() - 1);
        for (Index i = 0; i < count; ++i)
            if (owners[i] != no_index) items_[cursors[owners[i]]++] = i;
    }
    std::span<const Index> of(std::size_t primitive) const {
        return {items_.data() + starts_[primitive], starts_[primitive + 1] - starts_[primitive]};
    }
    Index in_file_of(Index i) const { return in_file_.empty() ? i : in_file_[i]; }

  private:
    std::vector<std::size_t> starts_;
    std::span<const Index> in_file_;
    std::vector<Index> items_;
};

// Adds a target's vectors to those of a primitive's vertices or corners.
Result<void> add(const GltfDocument& document, const Json& target, const char* semantic,
                 const std::vector<GltfPrimitive>& primitives, std::size_t p,
                 const ByPrimitive& items, std::vector<glm::vec3>& to) {
    const GltfPrimitive& primitive = primitives[p];
    const auto accessor = target[semantic].get<std::size_t>();
    auto raw = primitive.elements.empty() ? document.raw_accessor(accessor)
                                          : document.raw_elements(accessor, primitive.elements);
    if (!raw) return std::move(raw).error();
    const std::vector<float> values = to_floats(*raw);
    for (const Index i : items.of(p)) {
        const float* delta = &values[3 * std::size_t(items.in_file_of(i) - primitive.first_vertex)];
        to[i] += glm::vec3(delta[0], delta[1], delta[2]);
    }
    return {};
}

glm::vec3 unit_or_same(const glm::vec3& n) {
    const double length = glm::length(glm::dvec3(n));
    return length > 0 && std::isfinite(length) ? glm::vec3(glm::dvec3(n) / length) : n;
}

}  // namespace

std::size_t morph_target_count(const GltfDocument& document, std::size_t mesh_index) {
    std::size_t most = 0;
    for (std::size_t p = 0; p < document.primitives[mesh_index].size(); ++p)
        if (const Json* targets = targets_of(document, mesh_index, p))
            most = std::max(most, targets->size());
    return most;
}

Result<MorphShape> morph_shape(const GltfDocument& document, std::size_t mesh_index,
                               const Mesh& mesh, std::size_t target) {
    MorphShape shape;
    shape.positions = mesh.positions;
    const std::vector<GltfPrimitive>& primitives = document.primitives[mesh_index];
    const ByPrimitive vertices(primitives, mesh.vertex_count(), mesh.file_vertices);
    // What welding made one vertex turns as its corners did.
    const bool by_corner = !mesh.corner_file_vertices.empty();
    std::optional<ByPrimitive> corners;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
        const Json* targets = targets_of(document, mesh_index, p);
        if (!targets || target >= targets->size()) continue;
        const Json& entry = (*targets)[target];
        if (entry.contains("POSITION")) {
            shape.moves = true;
            if (auto done =
                    add(document, entry, "POSITION", primitives, p, vertices, shape.positions);
                !done)
                return std::move(done).error();
        }
        if (entry.contains("NORMAL")) {
            if (by_corner && !corners)
                corners.emplace(primitives, mesh.corner_count(), mesh.corner_file_vertices);
            shape.normal_deltas.resize(by_corner ? mesh.corner_count() : mesh.vertex_count(),
                                       glm::vec3(0.0f));
            if (auto done = add(document, entry, "NORMAL", primitives, p,
                                by_corner ? *corners : vertices, shape.normal_deltas);
                !done)
                return std::move(done).error();
        }
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

}  // namespace prep::detail

namespace prep {

std::size_t morph_target_count(const Scene& scene) {
    std::size_t count = 0;
    if (scene.document)
        for (std::size_t m = 0; m < scene.document->primitives.size(); ++m)
            count += detail::morph_target_count(*scene.document, m);
    return count;
}

}  // namespace prep
