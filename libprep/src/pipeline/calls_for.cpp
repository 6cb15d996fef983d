#include "prep/calls/calls_for.h"

#include <algorithm>

#include "base/uniform.h"

namespace prep {
namespace {

using Code = ReasonCode;

// A material as the table asks about it; the default one where there is none.
struct Asked {
    const Material& material;
    const MaterialMap* map;  // of features of maps
    const MeshContents& mesh;
    const Consumer& consumer;
};

// Whether light is computed from directions: at pixels where there is such a light, at vertices
// whenever it is asked for.
bool is_lit(const Material& material, const Consumer& c) {
    return !material.unlit &&
           (!c.exact || (c.colors && (c.lights || c.shading == Shading::gouraud)));
}

bool reads_map(const Asked& a) {
    return map_is_read(a.material, *a.map, a.consumer);
}

const Material& own_material(const Scene& scene, std::uint32_t material) {
    static const Material plain;
    return material == no_index ? plain : scene.materials[material];
}

enum class Sets : std::uint8_t { none, first, of_map };

// The table: a feature, when it is called for, and what it reads then.
struct FeatureRow {
    Feature feature;
    bool of_maps;  // asked once for each map of the material
    bool (*called)(const Asked&);
    bool normals, tangents, colors;
    Sets uvs;
};

constexpr FeatureRow table[] = {
    {Feature::lighting, false,
     [](const Asked& a) {
         return is_lit(a.material, a.consumer) &&
                !(a.consumer.exact && a.consumer.shading == Shading::flat);
     },
     true, false, false, Sets::none},
    {Feature::normal_buffer, false,
     [](const Asked& a) {
         // Unlit surfaces without normals show those of their faces.
         return a.consumer.exact && a.consumer.normals && a.consumer.shading != Shading::flat &&
                (a.mesh.normals || !a.material.unlit);
     },
     true, false, false, Sets::none},
    {Feature::uv_buffer, false,
     [](const Asked& a) { return a.consumer.exact && a.consumer.uvs && !a.mesh.uv_sets.empty(); },
     false, false, false, Sets::first},
    {Feature::vertex_colors, false,
     [](const Asked& a) {
         return a.mesh.colors && (!a.consumer.exact || a.consumer.colors ||
                                  a.material.alpha_mode == AlphaMode::mask);
     },
     false, false, true, Sets::none},
    {Feature::texture_map, true, reads_map, false, false, false, Sets::of_map},
    {Feature::tangent_map, true,
     [](const Asked& a) { return calls_for_tangents(a.material, *a.map) && reads_map(a); }, true,
     true, false, Sets::of_map},
    {Feature::anisotropy, false,
     [](const Asked& a) {
         return !a.consumer.exact && a.material.anisotropy != 0 && !a.material.unlit;
     },
     true, true, false, Sets::first},
};

Reason why(const FeatureRow& row, std::uint32_t material, const MaterialMap* map, bool missing,
           std::uint32_t set) {
    const auto with_set = [&](Code there, Code not_there, std::string subject) {
        return reason(missing ? not_there : there, std::move(subject), double(set));
    };
    switch (row.feature) {
        case Feature::lighting:
            return reason(material == no_index ? Code::default_material_lit : Code::material_lit,
                          material_subject(material));
        case Feature::normal_buffer:
            return reason(Code::normal_buffer);
        case Feature::uv_buffer:
            return reason(Code::uv_buffer);
        case Feature::vertex_colors:
            return reason(Code::vertex_colors, material_subject(material));
        case Feature::texture_map:
            return with_set(Code::map, Code::map_without_uvs, map_subject(material, *map));
        case Feature::tangent_map:
            return map->kind == MapKind::normal
                       ? with_set(Code::tangent_normal_map, Code::tangent_normal_map_without_uvs,
                                  map_subject(material, *map))
                       : with_set(Code::tangent_map, Code::tangent_map_without_uvs,
                                  map_subject(material, *map));
        case Feature::anisotropy:
            return with_set(Code::anisotropy, Code::anisotropy_without_uvs,
                            material_subject(material));
    }
    return {};
}

class MeshCalls {
  public:
    MeshCalls(const Scene& scene, const MeshContents& mesh, const Consumer& consumer)
        : scene_(scene), mesh_(mesh), consumer_(consumer) {}

    std::vector<Call> list() {
        if (!mesh_.faces) return {};
        if (mesh_.default_material) add(no_index);
        for (const std::uint32_t m : mesh_.materials) add(m);
        if (!consumer_.exact)
            for (const std::uint32_t m : mesh_.variants) add(m);
        return std::move(calls_);
    }

  private:
    void add(std::uint32_t index) {
        for (const Material* const drawn : drawn_as(scene_, index, consumer_)) {
            stands_in_ = drawn != &own_material(scene_, index);
            for (const FeatureRow& row : table) {
                if (!row.of_maps) {
                    if (row.called({*drawn, nullptr, mesh_, consumer_}))
                        add(row, index, *drawn, nullptr, 0);
                    continue;
                }
                for (const MaterialMap& map : material_maps)
                    if (drawn->*map.ref && row.called({*drawn, &map, mesh_, consumer_}))
                        add(row, index, *drawn, &map, (drawn->*map.ref).uv_set);
            }
        }
    }

    void add(const FeatureRow& row, std::uint32_t material, const Material& drawn,
             const MaterialMap* map, std::uint32_t set) {
        Call call;
        call.feature = row.feature;
        call.material = material;
        call.unlit = drawn.unlit;
        call.map = map;
        if (row.uvs != Sets::none) {
            call.uv_set = set;
            call.missing_uvs = !std::binary_search(mesh_.uv_sets.begin(), mesh_.uv_sets.end(), set);
        }
        if (!call.missing_uvs) {
            call.reads = {row.normals, row.tangents, row.colors, {}};
            if (row.uvs != Sets::none) call.reads.uv_sets = {set};
        }
        call.why = why(row, material, map, call.missing_uvs, set);
        if (stands_in_) {
            if (row.feature == Feature::lighting)
                call.why = reason(Code::material_lit, material_subject(material));
            call.why.drawn_as = drawn.name.empty() ? "unnamed" : drawn.name;
        }
        calls_.push_back(std::move(call));
    }

    const Scene& scene_;
    const MeshContents& mesh_;
    const Consumer& consumer_;
    bool stands_in_ = false;  // what is drawn, for the material
    std::vector<Call> calls_;
};

template <class Layers>
std::vector<std::uint32_t> sets_of(const Layers& uvs) {
    std::vector<std::uint32_t> sets;
    for (std::uint32_t k = 0; k < uvs.size(); ++k)
        if (!uvs[k].empty()) sets.push_back(k);
    return sets;
}

}  // namespace

AttributeReads& AttributeReads::operator|=(const AttributeReads& other) {
    normals |= other.normals;
    tangents |= other.tangents;
    colors |= other.colors;
    std::vector<std::uint32_t> both;
    std::set_union(uv_sets.begin(), uv_sets.end(), other.uv_sets.begin(), other.uv_sets.end(),
                   std::back_inserter(both));
    uv_sets = std::move(both);
    return *this;
}

bool AttributeReads::within(const AttributeReads& other) const {
    return normals <= other.normals && tangents <= other.tangents && colors <= other.colors &&
           std::includes(other.uv_sets.begin(), other.uv_sets.end(), uv_sets.begin(),
                         uv_sets.end());
}

std::vector<const Material*> drawn_as(const Scene& scene, std::uint32_t material,
                                      const Consumer& consumer) {
    const Material* const own = &own_material(scene, material);
    const auto [begin, end] = std::equal_range(
        consumer.stand_ins.begin(), consumer.stand_ins.end(), StandIn{material, std::nullopt},
        [](const StandIn& a, const StandIn& b) { return a.material < b.material; });
    std::vector<const Material*> drawn;
    for (auto stand_in = begin; stand_in != end; ++stand_in)
        drawn.push_back(stand_in->drawn ? &*stand_in->drawn : own);
    if (drawn.empty()) drawn = {own};
    return drawn;
}

bool map_is_read(const Material& m, const MaterialMap& map, const Consumer& c) {
    if (!c.exact) return true;
    if (!c.textures) return false;
    switch (map.use) {
        case MapUse::always:
            if (map.kind == MapKind::emissive && m.unlit) return false;
            // Without colours, what is cut out still counts.
            return c.colors || (map.kind == MapKind::diffuse && m.alpha_mode == AlphaMode::mask);
        case MapUse::lit:
            return map.kind == MapKind::occlusion ? c.colors && !m.unlit : is_lit(m, c);
        case MapUse::metallic_roughness:
            return is_lit(m, c) && m.metallic_roughness;
        case MapUse::normals:
            return !m.unlit && c.shading == Shading::normal_mapped && (c.normals || is_lit(m, c));
        case MapUse::not_drawn:
            break;
    }
    return false;
}

MeshContents contents_of(const Mesh& mesh, std::size_t material_count) {
    MeshContents out;
    out.faces = mesh.face_count() > 0;
    out.normals = !mesh.normals.empty();
    out.colors = !mesh.colors.empty();
    out.uv_sets = sets_of(mesh.uvs);
    std::vector<bool> seen(material_count, false);
    out.default_material = mesh.face_materials.empty();
    std::span<const std::uint32_t> named = mesh.face_materials;
    if (!named.empty() && detail::is_uniform(named)) named = named.first(1);
    for (const std::uint32_t m : named) {
        if (m < material_count)
            seen[m] = true;
        else
            out.default_material = true;
    }
    for (std::uint32_t m = 0; m < material_count; ++m)
        if (seen[m]) out.materials.push_back(m);
    for (const std::uint32_t m : mesh.variant_materials)
        if (m < material_count && !seen[m]) out.variants.push_back(m);
    return out;
}

MeshContents contents_of(const VertexMesh& mesh, std::size_t material_count) {
    MeshContents out;
    out.normals = !mesh.normals.empty();
    out.colors = !mesh.colors.empty();
    out.uv_sets = sets_of(mesh.uvs);
    for (const VertexMesh::Range& range : mesh.ranges) {
        if (range.triangle_count == 0) continue;
        out.faces = true;
        if (range.material < material_count)
            out.materials.push_back(range.material);
        else
            out.default_material = true;
    }
    std::sort(out.materials.begin(), out.materials.end());
    out.materials.erase(std::unique(out.materials.begin(), out.materials.end()),
                        out.materials.end());
    return out;
}

std::vector<Call> calls_for(const Scene& scene, const MeshContents& mesh,
                            const Consumer& consumer) {
    return MeshCalls(scene, mesh, consumer).list();
}

std::vector<std::vector<Call>> calls_for(const Scene& scene, const Consumer& consumer) {
    std::vector<std::vector<Call>> out;
    for (const Mesh& mesh : scene.meshes)
        out.push_back(calls_for(scene, contents_of(mesh, scene.materials.size()), consumer));
    return out;
}

AttributeReads reads_of(const std::vector<Call>& calls) {
    AttributeReads all;
    for (const Call& call : calls) all |= call.reads;
    return all;
}

}  // namespace prep
