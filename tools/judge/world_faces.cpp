#include "judge/world_faces.h"

#include <algorithm>
#include <cmath>

#include "prep/triangulate.h"

namespace judge {
namespace {

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool is_wanted(const prep::Mesh& mesh, const std::vector<std::string>& names) {
    return names.empty() || std::find(names.begin(), names.end(), mesh.name) != names.end();
}

std::vector<Instance> instances_of(const prep::Scene& scene, Unshown unshown,
                                   const std::vector<std::string>& meshes) {
    const auto wanted = [&](std::uint32_t m) { return is_wanted(scene.meshes[m], meshes); };
    std::vector<Instance> out;
    std::vector<bool> used(scene.meshes.size());
    const std::vector<glm::dmat4> worlds = prep::world_transforms(scene);
    for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
        const std::uint32_t m = scene.nodes[n].mesh;
        if (m == prep::no_index) continue;
        used[m] = true;
        if (!wanted(m)) continue;
        Instance instance;
        instance.mesh = m;
        instance.node = n;
        instance.world = worlds[n];
        const glm::dmat3 linear(worlds[n]);
        instance.mirrored = prep::mirrors(linear);
        instance.normals = prep::normal_matrix(linear);
        out.push_back(instance);
    }
    for (std::uint32_t m = 0; unshown == Unshown::as_it_is && m < scene.meshes.size(); ++m)
        if (!used[m] && wanted(m)) out.emplace_back().mesh = m;
    return out;
}

template <class T>
const T* value_at(const prep::CornerLayer<T>& layer, std::uint32_t corner) {
    if (layer.empty() || layer.indices[corner] == prep::no_index) return nullptr;
    return &layer.values[layer.indices[corner]];
}

}  // namespace

ShownMeshes shown_meshes(const prep::Scene& scene, const std::vector<std::string>& meshes) {
    std::vector<bool> shown(scene.meshes.size(), false);
    for (const prep::Node& node : scene.nodes)
        if (node.mesh != prep::no_index) shown[node.mesh] = true;
    ShownMeshes count;
    for (std::size_t m = 0; m < shown.size(); ++m)
        if (is_wanted(scene.meshes[m], meshes)) ++(shown[m] ? count.shown : count.unshown);
    return count;
}

WorldFaces::WorldFaces(const prep::Scene& of, Pieces pieces, Unshown unshown,
                       const std::vector<std::string>& meshes, int threads)
    : scene(&of), instances(instances_of(of, unshown, meshes)) {
    bool any = false;
    const auto add = [&](std::uint32_t i, std::uint32_t face, const std::uint32_t* list,
                         std::uint32_t count) {
        const prep::Mesh& mesh = scene->meshes[instances[i].mesh];
        WorldFace f;
        f.instance = i;
        f.face = face;
        f.first = std::uint32_t(points.size());
        if (!mesh.face_materials.empty()) f.material = mesh.face_materials[face];
        glm::dvec3 least(INFINITY), most(-INFINITY);
        bool placed = true;
        const glm::dmat4& world = instances[i].world;
        double terms = 0;  // the largest sum of what a coordinate is added up from
        for (std::uint32_t k = 0; k < count; ++k) {
            // As they are seen: a mirrored face runs the other way round.
            const std::uint32_t corner = list[instances[i].mirrored ? count - 1 - k : k];
            const glm::dvec3 local =
                glm::dvec3(mesh.positions[mesh.corner_vertices[corner]]) + mesh.origin;
            const glm::dvec3 p(world * glm::dvec4(local, 1));
            for (int r = 0; r < 3; ++r)
                terms = std::max(terms,
                                 std::abs(world[0][r] * local.x) + std::abs(world[1][r] * local.y) +
                                     std::abs(world[2][r] * local.z) + std::abs(world[3][r]));
            placed = placed && finite(p);
            points.push_back(p);
            corners.push_back(corner);
            least = glm::min(least, p);
            most = glm::max(most, p);
        }
        if (placed) {
            f.count = count;
            f.rounding = std::ldexp(terms, -22);
            rounding = std::max(rounding, f.rounding);
            f.middle = least * 0.5 + most * 0.5;
            low = any ? glm::min(low, least) : least;
            high = any ? glm::max(high, most) : most;
            any = true;
        } else {
            points.resize(f.first);
            corners.resize(f.first);
            ++unplaced;
        }
        faces.push_back(f);
    };
    for (std::uint32_t i = 0; i < instances.size(); ++i) {
        const prep::Mesh& mesh = scene->meshes[instances[i].mesh];
        instances[i].first_face = std::uint32_t(faces.size());
        if (pieces == Pieces::triangles) {
            const prep::Triangulation t = prep::triangulate(prep::MeshView(mesh), threads);
            for (std::size_t k = 0; k < t.triangle_faces.size(); ++k)
                add(i, t.triangle_faces[k], &t.corners[3 * k], 3);
            continue;
        }
        std::vector<std::uint32_t> list;
        for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
            list.clear();
            for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
                list.push_back(c);
            add(i, f, list.data(), std::uint32_t(list.size()));
        }
    }
}

void WorldFaces::limit_rounding(double most) {
    for (WorldFace& f : faces) f.rounding = std::min(f.rounding, most);
    rounding = std::min(rounding, most);
}

std::uint32_t WorldFaces::corner_in_face(const WorldFace& face, std::uint32_t corner) const {
    return corners[face.first + corner] - mesh_of(face).face_offsets[face.face];
}

std::optional<glm::dvec3> WorldFaces::normal(const WorldFace& face, std::uint32_t corner) const {
    const auto* value = value_at(mesh_of(face).normals, corners[face.first + corner]);
    if (value == nullptr) return {};
    const glm::dvec3 normal = instances[face.instance].normals * glm::dvec3(*value);
    // Where a flat transform leaves no direction, the mesh's own, as in files without nodes.
    return normal == glm::dvec3(0.0) ? glm::dvec3(*value) : normal;
}

std::optional<glm::dvec4> WorldFaces::tangent(const WorldFace& face, std::uint32_t corner) const {
    const auto* value = value_at(mesh_of(face).tangents, corners[face.first + corner]);
    if (value == nullptr) return {};
    const Instance& instance = instances[face.instance];
    const glm::dvec3 along = glm::dmat3(instance.world) * glm::dvec3(*value);
    const double sign = value->w < 0 ? -1 : value->w > 0 ? 1 : 0;  // 0: not a number as well
    return glm::dvec4(along, instance.mirrored ? 0 - sign : sign);
}

std::optional<glm::dvec2> WorldFaces::uv(const WorldFace& face, std::uint32_t corner,
                                         std::size_t set) const {
    const prep::Mesh& mesh = mesh_of(face);
    if (set >= mesh.uvs.size()) return {};
    const auto* value = value_at(mesh.uvs[set], corners[face.first + corner]);
    if (value == nullptr) return {};
    return glm::dvec2(*value);
}

std::optional<glm::dvec4> WorldFaces::color(const WorldFace& face, std::uint32_t corner,
                                            std::size_t set) const {
    const prep::Mesh& mesh = mesh_of(face);
    if (set >= mesh.colors.size()) return {};
    const auto* value = value_at(mesh.colors[set], corners[face.first + corner]);
    if (value == nullptr) return {};
    return glm::dvec4(*value);
}

glm::dvec3 delta_at(const prep::MorphTarget& target, std::uint32_t vertex) {
    for (const prep::VertexDeltas& run : target.positions)
        if (run.values && vertex >= run.first_vertex &&
            vertex - run.first_vertex < run.values->size())
            return glm::dvec3((*run.values)[vertex - run.first_vertex]);
    return glm::dvec3(0.0);
}

double degrees_apart(const glm::dvec3& a, const glm::dvec3& b) {
    // Each first by its largest component, so that no square under- or overflows.
    const auto unit = [](const glm::dvec3& v) {
        const double m = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        return finite(v) && m > 0 ? glm::normalize(v / m) : glm::dvec3(0.0);
    };
    const glm::dvec3 u = unit(a), v = unit(b);
    const bool none_a = u == glm::dvec3(0.0), none_b = v == glm::dvec3(0.0);
    if (none_a || none_b) return none_a && none_b ? 0 : 180;
    constexpr double degrees = 57.29577951308232;
    return 2 * std::atan2(glm::length(u - v), glm::length(u + v)) * degrees;
}

}  // namespace judge
