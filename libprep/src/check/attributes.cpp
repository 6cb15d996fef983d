#include <algorithm>
#include <cmath>

#include "base/finite.h"
#include "check/check_parts.h"
#include "exact/difference_of_products.h"
#include "normals/authored_normals.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Storing a tangent frame in signed bytes rounds by up to 1/254 a component; twice that is not an
// error of the tangents.
constexpr double orthogonal_tolerance = 0.01;
// One step of a float at 2048 is 2⁻¹², one texel of a 4096² map.
constexpr float largest_uv = 2048.0f;

void check_normals(CheckContext& context) {
    if (context.mesh.normals.empty()) return;
    const NormalReview review = review_normals(context.view, &context.faces);
    const auto add = [&](const char* kind, Severity severity, unsigned bit, const char* text) {
        Places places;
        for (Index c = 0; c < review.faults.size(); ++c)
            if (review.faults[c] & bit) places.add(c);
        context.add(kind, severity, PlaceKind::corner, std::move(places), text);
    };
    add("missing-normal", Severity::info, normal_missing,
        "the corner has no normal though others have");
    add("zero-normal", Severity::warning, normal_zero, "the authored normal has length zero");
    add("non-finite-normal", Severity::warning, normal_non_finite,
        "the authored normal is NaN or infinite");
    add("non-unit-normal", Severity::warning, normal_non_unit,
        "the authored normal's length is off by more than 0.00674");
    add("flipped-normal", Severity::warning, normal_flipped,
        "the authored normal points against its face");
}

void check_tangents(CheckContext& context) {
    const CornerLayer<glm::vec4>& layer = context.mesh.tangents;
    if (layer.empty()) return;
    const CornerLayer<glm::vec3>& normals = context.mesh.normals;
    Places missing, zero, bad, length_off, leaning, sign;
    for (Index c = 0; c < layer.indices.size(); ++c) {
        if (layer.indices[c] == no_index) {
            missing.add(c);
            continue;
        }
        const glm::dvec4 t(layer.values[layer.indices[c]]);
        if (!is_finite(t)) {
            bad.add(c);
            continue;
        }
        if (std::abs(t.w) != 1) sign.add(c);
        const double length = glm::length(glm::dvec3(t));
        if (length == 0) {
            zero.add(c);
            continue;
        }
        if (std::abs(length - 1) > unit_tolerance) length_off.add(c);
        if (normals.empty() || normals.indices[c] == no_index) continue;
        const glm::dvec3 n(normals.values[normals.indices[c]]);
        const double along = glm::dot(n, glm::dvec3(t));
        if (std::abs(along) > orthogonal_tolerance * length * glm::length(n)) leaning.add(c);
    }
    context.add("missing-tangent", Severity::info, PlaceKind::corner, std::move(missing),
                "the corner has no tangent though others have");
    context.add("zero-tangent", Severity::warning, PlaceKind::corner, std::move(zero),
                "the authored tangent has length zero");
    context.add("non-finite-tangent", Severity::warning, PlaceKind::corner, std::move(bad),
                "the authored tangent is NaN or infinite");
    context.add("non-unit-tangent", Severity::warning, PlaceKind::corner, std::move(length_off),
                "the authored tangent's length is off by more than 0.00674");
    context.add("non-orthogonal-tangent", Severity::warning, PlaceKind::corner, std::move(leaning),
                "the authored tangent is not orthogonal to its normal");
    context.add("tangent-sign", Severity::warning, PlaceKind::corner, std::move(sign),
                "the authored tangent's sign is not 1 or -1");
}

struct UvFaults {
    std::vector<bool> missing, bad, huge;    // per corner
    std::vector<bool> degenerate, mirrored;  // per face
};

// Twice the signed area, by the shoelace sum about the first corner.
double uv_area(const CornerLayer<glm::vec2>& layer, Index begin, Index end) {
    const auto at = [&](Index c) { return glm::dvec2(layer.values[layer.indices[c]]); };
    const glm::dvec2 first = at(begin);
    double sum = 0;
    glm::dvec2 previous = at(begin + 1) - first;
    for (Index c = begin + 2; c < end; ++c) {
        const glm::dvec2 edge = at(c) - first;
        sum += difference_of_products(previous.x, edge.y, previous.y, edge.x);
        previous = edge;
    }
    return sum;
}

void check_uv_set(const CheckContext& context, const CornerLayer<glm::vec2>& layer,
                  UvFaults& faults) {
    const Mesh& mesh = context.mesh;
    for (Index f = 0; f < mesh.face_count(); ++f) {
        const Index begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        bool usable = true;
        for (Index c = begin; c < end; ++c) {
            if (layer.indices[c] == no_index) {
                faults.missing[c] = true;
                usable = false;
                continue;
            }
            const glm::vec2& uv = layer.values[layer.indices[c]];
            if (!is_finite(uv)) {
                faults.bad[c] = true;
                usable = false;
            } else if (std::abs(uv.x) > largest_uv || std::abs(uv.y) > largest_uv) {
                faults.huge[c] = true;
            }
        }
        if (!usable) continue;
        const double area = uv_area(layer, begin, end);
        // v points down, so that a picture seen the right way round has negative area.
        if (area > 0) faults.mirrored[f] = true;
        if (area == 0 && context.faces.states[f] == FaceState::regular) faults.degenerate[f] = true;
    }
}

Places places_of(const std::vector<bool>& faulty) {
    Places places;
    for (Index i = 0; i < faulty.size(); ++i)
        if (faulty[i]) places.add(i);
    return places;
}

void check_uvs(CheckContext& context) {
    const std::size_t corners = context.mesh.corner_count(), faces = context.mesh.face_count();
    UvFaults faults;
    for (auto* per_corner : {&faults.missing, &faults.bad, &faults.huge})
        per_corner->assign(corners, false);
    for (auto* per_face : {&faults.degenerate, &faults.mirrored}) per_face->assign(faces, false);
    for (const auto& layer : context.mesh.uvs)
        if (!layer.empty()) check_uv_set(context, layer, faults);
    context.add("missing-uv", Severity::info, PlaceKind::corner, places_of(faults.missing),
                "the corner has no UV though others have");
    context.add("non-finite-uv", Severity::warning, PlaceKind::corner, places_of(faults.bad),
                "the UV is NaN or infinite");
    context.add("degenerate-uv", Severity::warning, PlaceKind::face, places_of(faults.degenerate),
                "the face's UVs have no area: no tangent follows from them");
    context.add("huge-uv", Severity::warning, PlaceKind::corner, places_of(faults.huge),
                "so far from zero that a step of a float is a texel of a 4096 x 4096 map");
    Places mirrored = places_of(faults.mirrored);
    context.summary.mirrored_uv_faces = mirrored.count;
    context.add("mirrored-uv", Severity::info, PlaceKind::face, std::move(mirrored),
                "the texture appears mirrored on the face");
}

// Which UV sets a material's maps sample.
std::vector<std::uint32_t> sampled_sets(const Material& material) {
    std::vector<std::uint32_t> sets;
    for (const MaterialMap& map : material_maps)
        if (const TextureRef& ref = material.*map.ref) sets.push_back(ref.uv_set);
    std::sort(sets.begin(), sets.end());
    sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
    return sets;
}

}  // namespace

void check_attributes(CheckContext& context) {
    check_normals(context);
    check_tangents(context);
    check_uvs(context);
}

void check_materials(const Scene& scene, std::uint32_t mesh_index, std::vector<Finding>& findings) {
    const Mesh& mesh = scene.meshes[mesh_index];
    if (mesh.face_materials.empty()) return;
    // Layers that exist but have gaps are check_uvs' finding; here it is whole sets.
    std::vector<bool> lacking(scene.materials.size(), false);
    for (std::size_t m = 0; m < scene.materials.size(); ++m)
        for (const std::uint32_t set : sampled_sets(scene.materials[m]))
            if (set >= mesh.uvs.size() || mesh.uvs[set].empty()) lacking[m] = true;
    Places missing, unknown;
    for (Index f = 0; f < mesh.face_count(); ++f) {
        const std::uint32_t m = mesh.face_materials[f];
        if (m == no_index) continue;
        if (m >= scene.materials.size())
            unknown.add(f);
        else if (lacking[m])
            for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c) missing.add(c);
    }
    const auto add = [&](const char* kind, Severity severity, PlaceKind place, Places places,
                         const char* text) {
        if (places.count == 0) return;
        findings.push_back(
            {kind, severity, mesh_index, places.count, place, std::move(places.first), text});
    };
    add("missing-uv", Severity::warning, PlaceKind::corner, std::move(missing),
        "the material samples a texture, but the mesh has no UV set for it");
    add("unknown-material", Severity::error, PlaceKind::face, std::move(unknown),
        "the face's material is not in the scene");
}

}  // namespace prep::detail
