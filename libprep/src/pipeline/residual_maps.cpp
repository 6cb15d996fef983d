#include "pipeline/residual_maps.h"

#include <fmt/format.h>

#include <algorithm>

#include "baking/surface_truth.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

bool has_uvs(const Mesh& mesh, std::size_t set) {
    return set < mesh.uvs.size() && !mesh.uvs[set].empty() &&
           std::none_of(mesh.uvs[set].indices.begin(), mesh.uvs[set].indices.end(),
                        [](Index i) { return i == no_index; });
}

// Of all faces with it, by material; faces without one last.
std::map<Index, std::uint64_t> faces_by_material(const Scene& scene, const Mesh& mesh) {
    std::map<Index, std::uint64_t> faces;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const Index m = mesh.face_materials.empty() ? no_index : mesh.face_materials[f];
        ++faces[m < scene.materials.size() ? m : no_index];
    }
    return faces;
}

Index add_material(Scene& scene, Mesh& mesh) {
    const auto made = Index(scene.materials.size());
    Material material;
    material.name = mesh.name.empty() ? "surface" : mesh.name;
    scene.materials.push_back(material);
    mesh.face_materials.resize(mesh.face_count(), no_index);
    for (Index& m : mesh.face_materials)
        if (m >= made) m = made;
    return made;
}

std::string quoted(const Material& material, Index index) {
    return material.name.empty() ? fmt::format("material {}", index)
                                 : fmt::format("material '{}'", material.name);
}

}  // namespace

Result<void> check_residual_options(const PrepareOptions& options) {
    const ResidualMapOptions& residual = *options.displacement.residual;
    const auto wrong = [](std::string text) {
        return Error{ErrorCode::invalid, std::move(text), ""};
    };
    if (residual.size == 0 || residual.size > max_residual_size)
        return wrong(
            fmt::format("a residual normal map has 1 to {} texels a side; {} are asked for",
                        max_residual_size, residual.size));
    if (residual.bits != 8 && residual.bits != 16)
        return wrong(
            fmt::format("a residual normal map has 8 or 16 bits; {} are asked for", residual.bits));
    if (options.request.normals == Request::Level::never ||
        options.request.tangents == Request::Level::never)
        return wrong(
            "a residual normal map is read by normals and tangents, which are switched "
            "off");
    return {};
}

ResidualMaps::OfMesh ResidualMaps::choose(Scene& scene, Mesh& mesh,
                                          const TessellateOptions& displaced,
                                          const Report& report) const {
    OfMesh of;
    const auto& by_material = displaced.material_displacements;
    const auto set_of = [&](Index m) -> std::uint32_t {
        if (displaced.displacements.empty()) return 0;
        const Index k = by_material.empty()      ? 0
                        : m < by_material.size() ? by_material[m]
                                                 : no_index;
        return k == no_index ? 0 : std::uint32_t(displaced.displacements[k].uv_set);
    };
    const auto left_out = [&](std::uint64_t faces, const std::string& why) {
        report("no-residual-map", faces, "faces get no residual normal map: " + why);
    };
    for (const auto& [material, faces] : faces_by_material(scene, mesh)) {
        Index m = material;
        // Displacement by materials moves those alone.
        if (!by_material.empty() && (m >= by_material.size() || by_material[m] == no_index))
            continue;
        const std::uint32_t set = set_of(m);
        if (!has_uvs(mesh, set)) {
            left_out(faces, fmt::format("UV set {} does not cover the mesh", set));
            continue;
        }
        if (m != no_index) {
            const Material& own = scene.materials[m];
            if (own.unlit) {
                left_out(faces, quoted(own, m) + " is unlit");
                continue;
            }
            if (own.normal_map) {
                left_out(faces, quoted(own, m) +
                                    " has a normal map of its own, which is kept: take it away to "
                                    "have the surface's");
                continue;
            }
        }
        if (!of.materials.empty() && set != of.uv_set) {
            left_out(faces, fmt::format("tangents follow UV set {}, its heights are in set {}",
                                        of.uv_set, set));
            continue;
        }
        const auto known = made_.find(m);
        if (known != made_.end() && known->second.uv_set != set) {
            left_out(faces, fmt::format("{} has its map in UV set {} of another mesh",
                                        quoted(scene.materials[m], m), known->second.uv_set));
            continue;
        }
        if (m == no_index) m = add_material(scene, mesh);
        of.uv_set = set;
        of.materials.push_back(m);
    }
    return of;
}

Result<void> ResidualMaps::bake(const Scene& scene, Index index, const Mesh& cage,
                                const TessellateOptions& displaced, const OfMesh& of,
                                const VertexMesh& mesh, std::span<const TrianglePlace> places,
                                const Report& report) {
    auto truth = SurfaceTruth::make(cage, displaced);
    if (!truth) return std::move(truth).error();
    const BakedMesh baked{(*truth)->surface(), mesh, places, of.uv_set};
    for (const Index m : of.materials) {
        const auto [at, fresh] =
            made_.try_emplace(m, Made{ResidualPicture(options_.size), of.uv_set, index});
        if (const auto why = at->second.picture.add(baked, m, threads_)) {
            if (fresh) made_.erase(at);
            std::uint64_t triangles = 0;
            for (const VertexMesh::Range& range : mesh.ranges)
                if (range.material == m) triangles += range.triangle_count;
            report("no-residual-map", triangles,
                   fmt::format("triangles of {} get no residual normal map: their UVs are no "
                               "charts of one picture, {}",
                               quoted(scene.materials[m], m), *why));
        }
    }
    return {};
}

Result<void> ResidualMaps::finish(PreparedScene& prepared) {
    Scene& scene = prepared.scene;
    for (const auto& [m, made] : made_) {
        Material& material = scene.materials[m];
        ResidualMap report{.material = m,
                           .image = Index(scene.images.size()),
                           .size = options_.size,
                           .bits = options_.bits,
                           .uv_set = made.uv_set};
        made.picture.count(report);
        auto png =
            encode_png(made.picture.image(), options_.bits == 8 ? PixelType::u8 : PixelType::u16);
        if (!png) return std::move(png).error();
        ImageRef image;
        image.name = (material.name.empty() ? fmt::format("material {}", m) : material.name) +
                     " residual normals";
        image.bytes = *std::move(png);
        image.mime_type = "image/png";
        Texture texture;
        texture.image = report.image;
        material.normal_map = {.texture = Index(scene.textures.size()), .uv_set = made.uv_set};
        material.normal_map_space = NormalMapSpace::tangent;
        material.normal_map_flip_green = false;
        scene.images.push_back(std::move(image));
        scene.textures.push_back(texture);
        if (report.overlapping > 0) {
            Finding finding;
            finding.kind = "residual-overlap";
            finding.severity = Severity::warning;
            finding.mesh = made.mesh;
            finding.count = report.overlapping;
            finding.place_kind = PlaceKind::face;
            finding.text = fmt::format(
                "texels of the residual normal map of {} are wanted by triangles that lie over "
                "each other in UV set {}: the first has them",
                quoted(material, m), made.uv_set);
            prepared.findings.push_back(std::move(finding));
        }
        prepared.residual_maps.push_back(report);
    }
    return {};
}

}  // namespace prep::detail
