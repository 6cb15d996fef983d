#include "sheets/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace report {
namespace {

struct Kind {
    std::string name;
    prep::Severity severity = prep::Severity::info;
    std::uint64_t count = 0;
};

std::string yes(bool value) {
    return value ? "yes" : "no";
}

// 2⁻²⁴ and less is float rounding: shown as it is, with one digit.
std::string small(double value) {
    return value == 0 ? "0" : fmt::format("{:.1e}", value);
}

std::string not_manifold(std::uint64_t edges, std::uint64_t vertices) {
    std::string text = "no";
    if (edges > 0) text += fmt::format(", {} bad edges", with_commas(edges));
    if (vertices > 0) text += fmt::format(", {} bad vertices", with_commas(vertices));
    return text;
}

}  // namespace

bool mirrored_uv(const prep::VertexMesh& mesh, std::size_t t) {
    if (mesh.uvs.empty() || mesh.uvs[0].empty()) return false;
    const std::vector<glm::vec2>& uv = mesh.uvs.front();
    const std::uint32_t* i = &mesh.indices[3 * t];
    const glm::dvec2 a(uv[i[0]]), b = glm::dvec2(uv[i[1]]) - a, c = glm::dvec2(uv[i[2]]) - a;
    // The UV origin is top left: readable text runs clockwise there.
    return b.x * c.y > b.y * c.x;
}

AttributeQuality measure_attributes(const std::vector<prep::VertexMesh>& meshes) {
    constexpr double degrees = 57.29577951308232;
    AttributeQuality q;
    double turns = 0;
    std::uint64_t turn_count = 0;
    for (const prep::VertexMesh& mesh : meshes) {
        q.triangles += mesh.triangle_count();
        if (mesh.triangle_count() == 0) continue;
        q.normals |= !mesh.normals.empty();
        q.tangents |= !mesh.tangents.empty();
        for (const glm::vec3& n : mesh.normals)
            q.normal_length_error =
                std::max(q.normal_length_error, std::abs(glm::length(glm::dvec3(n)) - 1));
        for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
            const glm::dvec3 t(mesh.tangents[v]);
            q.tangent_length_error = std::max(q.tangent_length_error, std::abs(glm::length(t) - 1));
            if (!mesh.normals.empty())
                q.orthogonality_error = std::max(
                    q.orthogonality_error, std::abs(glm::dot(glm::dvec3(mesh.normals[v]), t)));
        }
        for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
            const std::uint32_t* i = &mesh.indices[3 * t];
            q.mirrored_triangles += mirrored_uv(mesh, t);
            if (mesh.normals.empty()) continue;
            const glm::dvec3 a(mesh.positions[i[0]]);
            const glm::dvec3 cross = glm::cross(glm::dvec3(mesh.positions[i[1]]) - a,
                                                glm::dvec3(mesh.positions[i[2]]) - a);
            if (!(glm::length(cross) > 0)) continue;
            for (int k = 0; k < 3; ++k) {
                const glm::dvec3 n(mesh.normals[i[k]]);
                const double turn =
                    std::atan2(glm::length(glm::cross(cross, n)), glm::dot(cross, n)) * degrees;
                if (!std::isfinite(turn)) continue;
                turns += turn;
                ++turn_count;
                q.largest_turn = std::max(q.largest_turn, turn);
                q.against_face += turn > 90;
            }
        }
    }
    if (turn_count > 0) q.mean_turn = turns / static_cast<double>(turn_count);
    return q;
}

std::vector<FigureGroup> make_figures(const prep::PreparedScene& prepared,
                                      const std::vector<prep::MeshSummary>& summaries,
                                      const std::string& called_for) {
    std::vector<FigureGroup> groups;
    prep::MeshSummary sum;
    bool closed = true, manifold = true, oriented = true;
    for (const prep::MeshSummary& s : summaries) {
        sum.vertices += s.vertices;  // the prepared scene's may be shared, or subdivided
        sum.faces += s.faces;
        sum.triangles += s.triangles;
        sum.quads += s.quads;
        sum.polygons += s.polygons;
        sum.components += s.components;
        sum.open_edges += s.open_edges;
        sum.non_manifold_edges += s.non_manifold_edges;
        sum.non_manifold_vertices += s.non_manifold_vertices;
        closed &= s.closed;
        manifold &= s.manifold;
        oriented &= s.oriented;
    }
    FigureGroup mesh{"Mesh", {}};
    if (summaries.size() > 1) mesh.figures.push_back({"meshes", with_commas(summaries.size())});
    mesh.figures.push_back({"faces", with_commas(sum.faces)});
    mesh.figures.push_back({"triangles, quads, polygons",
                            fmt::format("{}, {}, {}", with_commas(sum.triangles),
                                        with_commas(sum.quads), with_commas(sum.polygons))});
    mesh.figures.push_back({"components", with_commas(sum.components)});
    mesh.figures.push_back(
        {"closed", closed ? "yes" : fmt::format("no, {} open edges", with_commas(sum.open_edges))});
    mesh.figures.push_back(
        {"manifold",
         manifold ? "yes" : not_manifold(sum.non_manifold_edges, sum.non_manifold_vertices),
         !manifold});
    mesh.figures.push_back({"consistent orientation", yes(oriented), !oriented});
    std::set<std::uint32_t> materials;  // of these meshes; the file may have more
    for (const prep::VertexMesh& m : prepared.meshes)
        for (const prep::VertexMesh::Range& range : m.ranges)
            if (range.material != prep::no_index) materials.insert(range.material);
    mesh.figures.push_back({"materials", with_commas(materials.size())});
    groups.push_back(std::move(mesh));

    std::uint64_t vertices = 0, triangles = 0;
    prep::SplitCounts splits;
    for (const prep::VertexMesh& m : prepared.meshes) {
        vertices += m.vertex_count();
        triangles += m.triangle_count();
        prep::count_splits(m, splits);
    }
    FigureGroup split{"Vertices", {}};
    split.figures.push_back({"in the file", with_commas(sum.vertices)});
    split.figures.push_back({"prepared", with_commas(vertices)});
    split.figures.push_back({"triangles", with_commas(triangles)});
    const std::pair<const char*, std::uint64_t> reasons[] = {
        {"split at hard edges", splits.hard_edge},
        {"split at smoothing groups", splits.smoothing_group},
        {"split by authored normals", splits.authored_normal},
        {"split at UV seams", splits.uv_seam},
        {"split at mirrored UVs", splits.mirrored_uv},
        {"split by tangents", splits.tangent},
        {"split by colours", splits.color},
        {"split at materials", splits.material}};
    for (const auto& [name, count] : reasons)
        if (count > 0) split.figures.push_back({name, with_commas(count)});
    groups.push_back(std::move(split));

    const AttributeQuality q = measure_attributes(prepared.meshes);
    FigureGroup quality{"Normals and tangents", {}};
    if (q.normals) {
        quality.figures.push_back(
            {"normal length off 1 by", small(q.normal_length_error), q.normal_length_error > 1e-5});
        quality.figures.push_back(
            {"turn against the face",
             fmt::format("mean {:.1f}°, max {:.1f}°", q.mean_turn, q.largest_turn)});
        quality.figures.push_back(
            {"corners lit from behind", with_commas(q.against_face), q.against_face > 0});
    } else {
        quality.figures.push_back({"normals", "none"});
    }
    if (q.tangents) {
        quality.figures.push_back({"tangent length off 1 by", small(q.tangent_length_error),
                                   q.tangent_length_error > 1e-5});
        quality.figures.push_back({"normal · tangent at most", small(q.orthogonality_error),
                                   q.orthogonality_error > 1e-5});
        quality.figures.push_back(
            {"mirrored triangles",
             fmt::format("{} of {}", with_commas(q.mirrored_triangles), with_commas(q.triangles))});
    }
    quality.figures.push_back({"tangents called for", called_for});
    groups.push_back(std::move(quality));
    return groups;
}

FigureGroup findings_group(const std::vector<prep::Finding>& findings, std::size_t most) {
    FigureGroup group{"Findings", {}};
    // One line a kind: a page may cover several meshes.
    std::vector<Kind> kinds;
    for (const prep::Finding& f : findings) {
        const auto same = std::find_if(kinds.begin(), kinds.end(), [&f](const Kind& kind) {
            return kind.name == f.kind && kind.severity == f.severity;
        });
        if (same != kinds.end())
            same->count += f.count;
        else
            kinds.push_back({f.kind, f.severity, f.count});
    }
    std::stable_sort(kinds.begin(), kinds.end(),
                     [](const Kind& a, const Kind& b) { return a.severity > b.severity; });
    for (const Kind& kind : kinds) {
        if (group.figures.size() == most) {
            group.figures.push_back({"and more", with_commas(kinds.size() - most)});
            break;
        }
        group.figures.push_back(
            {kind.name, with_commas(kind.count), kind.severity != prep::Severity::info});
    }
    if (group.figures.empty()) group.figures.push_back({"nothing odd", ""});
    return group;
}

}  // namespace report
