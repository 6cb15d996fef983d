#include "sheets/surfaces/tessellation_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "prep/check.h"

namespace report {
namespace {

using prep::VertexMesh;

const glm::vec4 pale(0.85f, 0.85f, 0.85f, 1), blue(0.03f, 0.16f, 0.60f, 1),
    red(0.62f, 0.04f, 0.02f, 1);

template <class T>
void by_corner(std::vector<T>& values, const std::vector<std::uint32_t>& indices) {
    if (values.empty()) return;
    std::vector<T> apart;
    apart.reserve(indices.size());
    for (const std::uint32_t v : indices) apart.push_back(values[v]);
    values = std::move(apart);
}

// What a picture is drawn from; the rest is not read any more.
void separate_triangles(VertexMesh& mesh) {
    by_corner(mesh.positions, mesh.indices);
    by_corner(mesh.normals, mesh.indices);
    mesh.tangents.clear();
    mesh.uvs.clear();
    mesh.lines.clear();
    mesh.points.clear();
    for (std::uint32_t i = 0; i < mesh.indices.size(); ++i) mesh.indices[i] = i;
}

const std::vector<float>* errors_of(const prep::PreparedScene& scene, std::size_t m) {
    if (m >= scene.tessellation_errors.size() || scene.tessellation_errors[m].empty())
        return nullptr;
    return &scene.tessellation_errors[m];
}

// The length at which a mesh is blue, and whether it was asked for.
std::pair<double, bool> scale_of(const prep::PreparedScene& scene, std::size_t m,
                                 const std::vector<float>& errors) {
    if (m < scene.tessellated.size() && scene.tessellated[m] && scene.tessellated[m]->asked)
        return {*scene.tessellated[m]->asked, true};
    double largest = 0;
    for (const float error : errors)
        if (std::isfinite(error)) largest = std::max(largest, double(error));
    return {largest, false};
}

std::string length_text(double length) {
    return std::isfinite(length) ? fmt::format("{:.3g}", length) : "no bound";
}

}  // namespace

ErrorColors color_by_errors(prep::PreparedScene& scene) {
    ErrorColors found;
    found.asked = true;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        VertexMesh& mesh = scene.meshes[m];
        separate_triangles(mesh);
        mesh.colors.assign(1, std::vector<glm::vec4>(mesh.positions.size(), pale));
        const std::vector<float>* const errors = errors_of(scene, m);
        if (!errors) continue;
        const auto [full, asked] = scale_of(scene, m, *errors);
        found.asked = found.asked && asked;
        for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
            const auto error = double((*errors)[mesh.triangle_faces[t]]);
            const bool missed = error > full;
            ++found.triangles;
            found.missed += missed;
            const double part = full > 0 ? std::min(error / full, 1.0) : 0.0;
            const glm::vec4 color = missed ? red : glm::mix(pale, blue, float(part));
            for (std::size_t k = 0; k < 3; ++k) mesh.colors[0][3 * t + k] = color;
        }
    }
    return found;
}

FigureGroup tessellation_group(const prep::PreparedScene& scene, int threads) {
    FigureGroup group{"Tessellation", {}};
    prep::TessellationCertificate most;
    std::uint64_t meshes = 0;
    for (std::size_t m = 0; m < scene.meshes.size() && m < scene.tessellated.size(); ++m) {
        if (!scene.tessellated[m]) continue;
        const prep::TessellationCertificate& c = *scene.tessellated[m];
        const auto raise = [](auto& to, const auto& by) { to = std::max(to, by); };
        if (meshes++ == 0) {
            most = c;
            continue;
        }
        raise(most.asked, c.asked);  // none is less than any
        raise(most.proved, c.proved);
        raise(most.measured, c.measured);
        raise(most.largest_shared_gap, c.largest_shared_gap);
        raise(most.asked_pixels, c.asked_pixels);
        raise(most.proved_pixels, c.proved_pixels);
        raise(most.deepest, c.deepest);
        most.samples += c.samples;
        most.triangles += c.triangles;
        most.unresolved += c.unresolved;
        most.over_budget += c.over_budget;
    }
    if (meshes == 0) return group;
    const auto add = [&](std::string name, std::string value, bool attention = false) {
        group.figures.push_back({std::move(name), std::move(value), attention});
    };
    add("triangles", with_commas(most.triangles));
    if (most.asked) add("error asked", length_text(*most.asked));
    add("error proved", length_text(most.proved), most.asked && most.proved > *most.asked);
    if (most.samples > 0)
        add(fmt::format("measured, {} points", with_commas(most.samples)),
            length_text(most.measured), most.measured > most.proved);
    add("of it shared at seams", length_text(most.largest_shared_gap));
    if (most.asked_pixels) add("pixels asked", length_text(*most.asked_pixels));
    if (most.proved_pixels)
        add("pixels proved", length_text(*most.proved_pixels),
            most.asked_pixels && *most.proved_pixels > *most.asked_pixels);
    if (meshes == 1 && most.worst_face != prep::no_index)
        add("largest at cage face", with_commas(most.worst_face));
    add("halvings at most", fmt::format("{}", most.deepest));
    if (most.over_budget > 0) add("left by the maximum", with_commas(most.over_budget), true);
    if (most.unresolved > 0) add("finer than floats", with_commas(most.unresolved), true);
    std::uint64_t open = 0, bad = 0;
    for (const prep::MeshSummary& s : prep::check(scene.scene, {threads}).meshes) {
        open += s.open_edges;
        bad += s.non_manifold_edges;
    }
    add("open edges, of three or more", fmt::format("{}, {}", with_commas(open), with_commas(bad)));
    return group;
}

}  // namespace report
