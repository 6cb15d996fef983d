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

// By material the first and the last mesh with faces of it.
struct Users {
    Index first = no_index, last = no_index;
};
std::vector<Users> users_of(const Scene& scene) {
    std::vector<Users> users(scene.materials.size());
    for (Index i = 0; i < scene.meshes.size(); ++i)
        for (const Index m : scene.meshes[i].face_materials) {
            if (m >= users.size()) continue;
            if (users[m].first == no_index) users[m].first = i;
            users[m].last = i;
        }
    return users;
}

// Why a material can have none; empty: it can.
std::string_view why_not(const Material& own) {
    if (own.unlit) return "is unlit";
    if (own.normal_map)
        return "has a normal map of its own, which is kept: take it away to have the surface's";
    if (own.bump_map)
        return "has a bump map of its own, which is kept: take it away to have the surface's";
    return {};
}

// The most that are unfinished at once.
std::uint64_t most_unfinished(const Scene& scene) {
    const std::vector<Users> users = users_of(scene);
    std::vector<std::int64_t> changes(scene.meshes.size() + 1, 0);
    for (Index m = 0; m < users.size(); ++m) {
        if (users[m].first == users[m].last || !why_not(scene.materials[m]).empty()) continue;
        ++changes[users[m].first];
        --changes[users[m].last + 1];
    }
    std::int64_t now = 0, most = 0;
    for (const std::int64_t change : changes) most = std::max(most, now += change);
    return std::uint64_t(most) + 1;  // and one of a single mesh
}

}  // namespace

Result<void> check_residual_options(const PrepareOptions& options, const Scene& scene) {
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
    const std::uint64_t count = most_unfinished(scene);
    const std::uint64_t bytes =
        std::uint64_t(residual.size) * residual.size *
        (count * ResidualPicture::bytes + ResidualPicture::bytes_at_the_end);
    if (bytes > max_residual_bytes)
        return Error{
            ErrorCode::limit,
            fmt::format("residual normal maps of {} texels a side, {} at once, take {:.3g} "
                        "GB, more than {:.3g}: ask for smaller ones",
                        residual.size, count, double(bytes) / 1e9,
                        double(max_residual_bytes) / 1e9),
            ""};
    return {};
}

ResidualMaps::ResidualMaps(const Scene& scene, const ResidualMapOptions& options, int threads)
    : options_(options), threads_(threads) {
    for (const Users& users : users_of(scene)) last_user_.push_back(users.last);
    for (const MeshRequirements& need : requirements(scene, {})) {
        tangents_of_.emplace_back();
        if (need.tangents.needed) tangents_of_.back() = need.tangent_uv_set;
    }
}

ResidualMaps::OfMesh ResidualMaps::choose(Scene& scene, Index index,
                                          const TessellateOptions& displaced,
                                          const Report& report) const {
    OfMesh of;
    Mesh& mesh = scene.meshes[index];
    const std::optional<Index> tangents_of = tangents_of_[index];
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
            if (const std::string_view why = why_not(own); !why.empty()) {
                left_out(faces, fmt::format("{} {}", quoted(own, m), why));
                continue;
            }
        }
        const Index tangent_set = !of.materials.empty() ? of.uv_set : tangents_of.value_or(set);
        if (set != tangent_set) {
            left_out(faces, fmt::format("tangents follow UV set {}, its heights are in set {}",
                                        tangent_set, set));
            continue;
        }
        const auto known = made_.find(m);
        if (known != made_.end() && known->second.report.uv_set != set) {
            left_out(faces,
                     fmt::format("{} has its map in UV set {} of another mesh",
                                 quoted(scene.materials[m], m), known->second.report.uv_set));
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
        const auto [at, fresh] = made_.try_emplace(m);
        Made& made = at->second;
        if (fresh) {
            made.picture.emplace(options_.size);
            made.report = {
                .material = m, .size = options_.size, .bits = options_.bits, .uv_set = of.uv_set};
            made.mesh = index;
        }
        if (const auto why = made.picture->add(baked, m, threads_)) {
            if (fresh) made_.erase(at);
            std::uint64_t triangles = 0;
            for (const VertexMesh::Range& range : mesh.ranges)
                if (range.material == m) triangles += range.triangle_count;
            report("no-residual-map", triangles,
                   fmt::format("triangles of {} get no residual normal map: their UVs are no "
                               "charts of one picture, {}",
                               quoted(scene.materials[m], m), *why));
            continue;
        }
        baked_.emplace(m, index);
        // Of one mesh's own: so that they do not pile up.
        if (m < last_user_.size() && last_user_[m] != index) continue;
        if (auto encoded = encode(made); !encoded) return encoded;
    }
    return {};
}

Result<void> ResidualMaps::encode(Made& made) const {
    made.picture->count(made.report);
    auto png = encode_png((std::move(*made.picture)).image(),
                          options_.bits == 8 ? PixelType::u8 : PixelType::u16);
    made.picture.reset();
    if (!png) return std::move(png).error();
    made.png = *std::move(png);
    return {};
}

// A material lights all who use it: what was not baked would have another mesh's normals, and has
// no tangents. None: all were.
std::optional<std::string> ResidualMaps::unbaked_user(const PreparedScene& prepared,
                                                      Index material) const {
    for (Index i = 0; i < prepared.meshes.size(); ++i) {
        const Mesh& mesh = prepared.scene.meshes[i];
        const std::string name =
            mesh.name.empty() ? fmt::format("mesh {}", i) : fmt::format("mesh '{}'", mesh.name);
        bool has = false, has_others = false;
        for (const VertexMesh::Range& range : prepared.meshes[i].ranges) {
            if (range.triangle_count == 0) continue;
            (range.material == material ? has : has_others) = true;
        }
        const bool baked = baked_.contains({material, i});
        if (has && !baked) return name;
        const bool variant = std::binary_search(mesh.variant_materials.begin(),
                                                mesh.variant_materials.end(), material);
        if (variant && (!baked || has_others)) return "a variant of " + name;
    }
    return std::nullopt;
}

Result<void> ResidualMaps::finish(PreparedScene& prepared) {
    Scene& scene = prepared.scene;
    for (auto& [m, made] : made_) {
        Material& material = scene.materials[m];
        Finding finding;
        finding.severity = Severity::warning;
        finding.mesh = made.mesh;
        finding.place_kind = PlaceKind::face;
        if (const auto user = unbaked_user(prepared, m)) {
            finding.kind = "no-residual-map";
            for (const VertexMesh& mesh : prepared.meshes)
                for (const VertexMesh::Range& range : mesh.ranges)
                    if (range.material == m) finding.count += range.triangle_count;
            finding.text = fmt::format(
                "triangles of {} get no residual normal map: {} uses it as well, and is not part "
                "of the map; give that a material of its own",
                quoted(material, m), *user);
            prepared.findings.push_back(std::move(finding));
            continue;
        }
        if (made.picture)
            if (auto encoded = encode(made); !encoded) return encoded;
        made.report.image = Index(scene.images.size());
        ImageRef image;
        image.name = (material.name.empty() ? fmt::format("material {}", m) : material.name) +
                     " residual normals";
        image.bytes = std::move(made.png);
        image.mime_type = "image/png";
        Texture texture;
        texture.image = made.report.image;
        material.normal_map = {.texture = Index(scene.textures.size()),
                               .uv_set = made.report.uv_set};
        material.normal_map_space = NormalMapSpace::tangent;
        material.normal_map_flip_green = false;
        scene.images.push_back(std::move(image));
        scene.textures.push_back(texture);
        if (made.report.overlapping > 0) {
            finding.kind = "residual-overlap";
            finding.count = made.report.overlapping;
            finding.text = fmt::format(
                "texels of the residual normal map of {} are wanted by triangles that lie over "
                "each other in UV set {}: the first has them",
                quoted(material, m), made.report.uv_set);
            prepared.findings.push_back(std::move(finding));
        }
        prepared.residual_maps.push_back(made.report);
    }
    return {};
}

}  // namespace prep::detail
