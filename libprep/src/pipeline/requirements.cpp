#include "prep/requirements.h"

#include <algorithm>
#include <map>
#include <set>

namespace prep {
namespace {

using Code = ReasonCode;

// What one mesh's calls come to, by the request.
class MeshNeeds {
  public:
    MeshNeeds(const Scene& scene, const Mesh& mesh, const Request& request)
        : scene_(scene),
          mesh_(mesh),
          request_(request),
          contents_(contents_of(mesh, scene.materials.size())),
          calls_(calls_for(scene, contents_, request.consumer)) {}

    MeshRequirements run() {
        MeshRequirements r;
        r.normals = normals();
        r.uvs = uvs();
        r.tangents = tangents(r);
        r.tangents.asked = r.tangents.needed && request_.tangents == Request::Level::always;
        // A tangent frame is built about the normal.
        if (r.tangents.needed && !r.normals.needed) {
            if (request_.normals == Request::Level::never && mesh_.normals.empty())
                r.tangents = no(Code::tangents_without_normals);
            else
                r.normals = yes(Code::tangents_need_normals);
        }
        for (const Call& call : calls_)
            if (call.reads.tangents && !call.why.drawn_as.empty())
                r.drawn_in_frame.push_back(call.material);
        r.provided = reads_of(calls_);
        r.provided.normals = r.normals.needed || (r.provided.normals && contents_.normals);
        // Those of the file that nobody shall touch stay with the picture that reads them.
        const bool untouched =
            request_.tangents == Request::Level::never && !mesh_.tangents.empty();
        r.provided.tangents = r.tangents.needed || (r.provided.tangents && untouched);
        // Tangents that are asked for stay with the UVs that they follow.
        if (r.tangents.asked) r.provided |= {false, false, false, {r.tangent_uv_set}};
        // Points and lines are in no picture: who prepares them has another reader in mind.
        const bool loose = !mesh_.points.empty() || !mesh_.line_vertices.empty();
        if (request_.consumer.exact && contents_.faces && !loose) return r;
        // What the file brings stays, for whoever reads it.
        r.provided |=
            {contents_.normals, !mesh_.tangents.empty(), contents_.colors, contents_.uv_sets};
        return r;
    }

  private:
    Need with(bool needed, const Reason& why) const {
        return {needed, sentence(why, scene_), false, why};
    }
    Need yes(Code code) const { return with(true, reason(code)); }
    Need no(Code code) const { return with(false, reason(code)); }

    bool is_drawn_unlit(std::uint32_t material) const {
        const std::vector<const Material*> drawn = drawn_as(scene_, material, request_.consumer);
        return std::all_of(drawn.begin(), drawn.end(), [](const Material* m) { return m->unlit; });
    }

    template <class Test>
    const Call* first(const Test& test) const {
        const auto found = std::find_if(calls_.begin(), calls_.end(), test);
        return found == calls_.end() ? nullptr : &*found;
    }

    Need normals() const {
        if (!contents_.faces) return no(Code::no_faces_normals);
        if (request_.normals == Request::Level::never) return no(Code::request_off);
        if (request_.normals == Request::Level::always) return yes(Code::request_on);
        const Call* const call = first([&](const Call& c) {
            // What is not lit shows the normals that there are.
            return c.feature == Feature::lighting ||
                   (c.feature == Feature::normal_buffer && !c.unlit);
        });
        if (call != nullptr) return with(true, call->why);
        const Consumer& c = request_.consumer;
        const bool unlit = (!contents_.default_material || is_drawn_unlit(no_index)) &&
                           std::all_of(contents_.materials.begin(), contents_.materials.end(),
                                       [&](std::uint32_t m) { return is_drawn_unlit(m); });
        return no(unlit                        ? Code::all_unlit
                  : !c.colors                  ? Code::no_colors_kept
                  : c.shading == Shading::flat ? Code::flat_shading
                                               : Code::no_directed_light);
    }

    Need uvs() const {
        if (!contents_.faces) return no(Code::no_faces_uvs);
        const Call* const call = first(
            [](const Call& c) { return c.feature == Feature::texture_map && !c.missing_uvs; });
        if (call != nullptr) return with(true, call->why);
        return no(Code::no_map);
    }

    // The first map in the tangent frame whose UV set exists decides which set the tangents follow;
    // those of a material that has none of that set, its own first one.
    Need tangents(MeshRequirements& r) const {
        const auto in_frame = [](const Call& c) {
            return c.feature == Feature::tangent_map || c.feature == Feature::anisotropy;
        };
        const auto decides = [&](const Call& c) { return in_frame(c) && !c.missing_uvs; };
        const Call* const call = first(decides);
        if (call != nullptr) r.tangent_uv_set = call->uv_set;
        std::set<std::uint32_t> decided;
        for (const Call& c : calls_)
            if (decides(c) && decided.insert(c.material).second && c.uv_set != r.tangent_uv_set)
                r.other_tangent_uv_sets.push_back({c.material, c.uv_set});
        if (!contents_.faces) return no(Code::no_faces_tangents);
        if (request_.tangents == Request::Level::never) return no(Code::request_off);
        if (call != nullptr) return with(true, call->why);
        const bool has_uvs = !contents_.uv_sets.empty() && contents_.uv_sets.front() == 0;
        if (request_.tangents == Request::Level::always)
            return has_uvs ? yes(Code::request_on) : no(Code::request_on_without_uvs);
        if (const Call* const missing = first(in_frame)) return with(false, missing->why);
        return no(Code::no_tangent_map);
    }

    const Scene& scene_;
    const Mesh& mesh_;
    const Request& request_;
    MeshContents contents_;
    std::vector<Call> calls_;
};

}  // namespace

std::uint32_t MeshRequirements::tangent_uv_set_of(std::uint32_t material) const {
    for (const MaterialUvSet& other : other_tangent_uv_sets)
        if (other.material == material) return other.uv_set;
    return tangent_uv_set;
}

CornerLayer<glm::vec2> mixed_tangent_uvs(const Mesh& mesh, const MeshRequirements& need) {
    CornerLayer<glm::vec2> mixed;
    if (need.other_tangent_uv_sets.empty() || mesh.face_materials.empty()) return mixed;
    std::map<std::uint32_t, std::uint32_t> sets;
    for (const MaterialUvSet& other : need.other_tangent_uv_sets)
        sets.emplace(other.material, other.uv_set);
    std::vector<std::uint32_t> bases;
    for (const CornerLayer<glm::vec2>& set : mesh.uvs) {
        bases.push_back(std::uint32_t(mixed.values.size()));
        mixed.values.insert(mixed.values.end(), set.values.begin(), set.values.end());
    }
    mixed.indices.assign(mesh.corner_count(), no_index);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto other = sets.find(mesh.face_materials[f]);
        const std::uint32_t set = other == sets.end() ? need.tangent_uv_set : other->second;
        if (set >= mesh.uvs.size() || mesh.uvs[set].empty()) continue;
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            if (const std::uint32_t index = mesh.uvs[set].indices[c]; index != no_index)
                mixed.indices[c] = bases[set] + index;
    }
    return mixed;
}

std::vector<MeshRequirements> requirements(const Scene& scene, const Request& request) {
    std::vector<MeshRequirements> result;
    result.reserve(scene.meshes.size());
    for (const Mesh& mesh : scene.meshes) result.push_back(MeshNeeds(scene, mesh, request).run());
    return result;
}

}  // namespace prep
