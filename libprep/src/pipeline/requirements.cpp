#include "prep/requirements.h"

#include <algorithm>

namespace prep {
namespace {

std::string quoted(const std::string& name, std::size_t index, const char* what) {
    return name.empty() ? std::string(what) + " " + std::to_string(index)
                        : std::string(what) + " '" + name + "'";
}

// The materials that the mesh's faces use, ascending; a mesh without any uses the default material.
struct UsedMaterials {
    std::vector<std::uint32_t> indices;
    bool uses_default = false;
};

UsedMaterials used_materials(const Mesh& mesh, std::size_t material_count) {
    UsedMaterials used;
    std::vector<bool> seen(material_count, false);
    if (mesh.face_materials.empty()) used.uses_default = true;
    for (const std::uint32_t m : mesh.face_materials) {
        if (m < material_count)
            seen[m] = true;
        else
            used.uses_default = true;
    }
    for (std::uint32_t m = 0; m < material_count; ++m)
        if (seen[m]) used.indices.push_back(m);
    // Behind the mesh's own, which decide first.
    for (const std::uint32_t m : mesh.variant_materials)
        if (m < material_count && !seen[m]) used.indices.push_back(m);
    return used;
}

bool has_uv_set(const Mesh& mesh, std::uint32_t set) {
    return set < mesh.uvs.size() && !mesh.uvs[set].empty();
}

Need need_normals(const Scene& scene, const Mesh& mesh, const UsedMaterials& used,
                  Request::Level level) {
    if (mesh.face_count() == 0) return {false, "no faces: points and lines carry no normals"};
    if (level == Request::Level::never) return {false, "switched off by the request"};
    if (level == Request::Level::always) return {true, "asked for by the request"};
    if (used.uses_default) return {true, "faces without a material are lit by the default one"};
    for (const std::uint32_t m : used.indices) {
        if (!scene.materials[m].unlit)
            return {true, quoted(scene.materials[m].name, m, "material") + " is lit"};
    }
    return {false, "every material used is unlit"};
}

Need need_uvs(const Scene& scene, const Mesh& mesh, const UsedMaterials& used) {
    if (mesh.face_count() == 0) return {false, "no faces to be textured"};
    for (const std::uint32_t m : used.indices) {
        for (const MaterialMap& map : material_maps) {
            const TextureRef& ref = scene.materials[m].*map.ref;
            if (!ref) continue;
            const std::string text =
                quoted(scene.materials[m].name, m, "material") + " has a " + map.name + " map";
            if (has_uv_set(mesh, ref.uv_set)) return {true, text};
        }
    }
    return {false, "no material in use samples a texture on this mesh"};
}

struct TangentCall {
    std::string reason;      // empty: nothing calls for tangents
    std::string missing_uv;  // what would, had the mesh its UVs
    std::uint32_t uv_set = 0;
};

// The first map in the tangent frame whose UV set exists decides which set the tangents follow.
TangentCall tangent_call(const Scene& scene, const Mesh& mesh, const UsedMaterials& used) {
    TangentCall call;
    const auto ask = [&](std::uint32_t m, const std::string& what, std::uint32_t uv_set) {
        const std::string material = quoted(scene.materials[m].name, m, "material");
        if (has_uv_set(mesh, uv_set)) {
            call.reason = material + " has " + what;
            call.uv_set = uv_set;
        } else if (call.missing_uv.empty()) {
            call.missing_uv = material + " has " + what + ", but UV set " + std::to_string(uv_set) +
                              " is missing";
        }
        return !call.reason.empty();
    };
    for (const std::uint32_t m : used.indices) {
        const Material& material = scene.materials[m];
        for (const MaterialMap& map : material_maps) {
            if (!calls_for_tangents(material, map)) continue;
            const std::string what = map.kind == MapKind::normal
                                         ? "a tangent-space normal map"
                                         : "a map in the tangent frame: " + std::string(map.name);
            if (ask(m, what, (material.*map.ref).uv_set)) return call;
        }
        if (material.anisotropy != 0 && !material.unlit && ask(m, "anisotropy", 0)) return call;
    }
    return call;
}

}  // namespace

std::vector<MeshRequirements> requirements(const Scene& scene, const Request& request) {
    std::vector<MeshRequirements> result;
    result.reserve(scene.meshes.size());
    for (const Mesh& mesh : scene.meshes) {
        const UsedMaterials used = used_materials(mesh, scene.materials.size());
        MeshRequirements r;
        r.normals = need_normals(scene, mesh, used, request.normals);
        r.uvs = need_uvs(scene, mesh, used);

        const TangentCall call = tangent_call(scene, mesh, used);
        r.tangent_uv_set = call.uv_set;
        if (mesh.face_count() == 0) {
            r.tangents = {false, "no faces: points and lines carry no tangents"};
        } else if (request.tangents == Request::Level::never) {
            r.tangents = {false, "switched off by the request"};
        } else if (!call.reason.empty()) {
            r.tangents = {true, call.reason};
        } else if (request.tangents == Request::Level::always) {
            if (has_uv_set(mesh, 0))
                r.tangents = {true, "asked for by the request"};
            else
                r.tangents = {false, "asked for by the request, but the mesh has no UVs"};
        } else if (!call.missing_uv.empty()) {
            r.tangents = {false, call.missing_uv};
        } else {
            r.tangents = {false, "no material in use has a tangent-space normal map"};
        }
        r.tangents.asked = r.tangents.needed && request.tangents == Request::Level::always;
        // A tangent frame is built about the normal.
        if (r.tangents.needed && !r.normals.needed) {
            if (request.normals == Request::Level::never && mesh.normals.empty())
                r.tangents = {false, "tangents need normals, which are switched off"};
            else
                r.normals = {true, "tangents need normals"};
        }
        result.push_back(std::move(r));
    }
    return result;
}

}  // namespace prep
