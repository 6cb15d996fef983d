#include "sheets/surfaces/cage_panels.h"

#include <array>

#include "sheets/overlay.h"
#include "sheets/surfaces/cage_lines.h"

namespace report {
namespace {

using prep::Result;

enum EdgeKind : std::uint8_t { smooth, semi_sharp, sharp };
using Counts = std::array<std::uint64_t, 3>;

constexpr Color colors[] = {rgb(0x1f2937), rgb(0xd97706), rgb(0xdc2626)};
constexpr Color extraordinary_color = rgb(0x7c3aed);

EdgeKind kind_of(const CageLine& line) {
    return line.sharpness >= 10 ? sharp : line.sharpness > 0 ? semi_sharp : smooth;
}

// Lines of every instance, the sharp ones over the others; how many of each kind there are in the
// meshes, however often each is placed.
template <class LinesOf>
Result<Counts> draw_lines(const CagePanelInput& input, Overlay& overlay, const LinesOf& lines_of) {
    const prep::PreparedScene& scene = input.scene;
    Counts counts{};
    std::vector<std::vector<CageLine>> lines(scene.cages.size());
    for (std::size_t m = 0; m < lines.size(); ++m) {
        if (scene.cages[m].face_count() == 0) continue;
        Result<std::vector<CageLine>> found = lines_of(scene.cages[m]);
        if (!found) return found.error();
        lines[m] = *std::move(found);
        for (const CageLine& line : lines[m]) ++counts[kind_of(line)];
    }
    for (const EdgeKind kind : {smooth, semi_sharp, sharp})
        for (std::size_t n = 0; n < scene.scene.nodes.size(); ++n) {
            const std::uint32_t m = scene.scene.nodes[n].mesh;
            if (m >= lines.size()) continue;
            for (const CageLine& line : lines[m]) {
                if (kind_of(line) != kind) continue;
                for (std::size_t k = 1; k < line.points.size(); ++k)
                    overlay.segment(glm::dvec3(input.world[n] * glm::dvec4(line.points[k - 1], 1)),
                                    glm::dvec3(input.world[n] * glm::dvec4(line.points[k], 1)),
                                    colors[kind], (kind == smooth ? 1.2 : 2.0) * input.scale);
            }
        }
    return counts;
}

std::uint64_t draw_extraordinary(const CagePanelInput& input, Overlay& overlay) {
    const prep::PreparedScene& scene = input.scene;
    const bool loop = input.prepare.subdivision.scheme == prep::SubdivisionScheme::loop;
    std::uint64_t count = 0;
    for (std::size_t m = 0; m < scene.cages.size(); ++m) {
        const prep::Mesh& cage = scene.cages[m];
        if (cage.face_count() == 0) continue;
        const auto found = extraordinary_vertices(
            cage, prep::build_topology(prep::MeshView(cage), {}, input.threads), loop);
        count += found.size();
        for (std::size_t n = 0; n < scene.scene.nodes.size(); ++n) {
            if (scene.scene.nodes[n].mesh != m) continue;
            for (const std::uint32_t v : found) {
                const glm::dvec3 p = glm::dvec3(
                    input.world[n] * glm::dvec4(glm::dvec3(cage.positions[v]) + cage.origin, 1));
                overlay.segment(p, p, extraordinary_color, 6 * input.scale);
            }
        }
    }
    return count;
}

std::vector<LegendItem> legend_of(const Counts& counts) {
    std::vector<LegendItem> legend;
    if (counts[semi_sharp] > 0) legend.push_back({colors[semi_sharp], "semi-sharp"});
    if (counts[sharp] > 0) legend.push_back({colors[sharp], "infinitely sharp"});
    return legend;
}

Result<std::vector<CageLine>> polygon_edges(const prep::Mesh& cage) {
    return cage_edges(cage);
}

std::string faces_and_edges(const prep::PreparedScene& scene, const Counts& counts) {
    std::uint64_t faces = 0;
    for (const prep::Mesh& cage : scene.cages) faces += cage.face_count();
    return count_of(faces, "face") + ", " + count_of(counts[0] + counts[1] + counts[2], "edge");
}

}  // namespace

Result<Panel> polygons_panel(const CagePanelInput& input) {
    Overlay overlay(input.shot);
    const auto counts = draw_lines(input, overlay, polygon_edges);
    if (!counts) return counts.error();
    Panel panel;
    panel.id = "polygons";
    panel.title = "Polygons";
    panel.caption = faces_and_edges(input.scene, *counts) + " before they were moved";
    panel.alt = "the edges of its polygons where they were before they were moved";
    panel.legend = legend_of(*counts);
    panel.picture = overlay.image();
    return panel;
}

Result<Panel> cage_panel(const CagePanelInput& input) {
    Overlay overlay(input.shot);
    const auto counts = draw_lines(input, overlay, polygon_edges);
    if (!counts) return counts.error();
    const std::uint64_t extraordinary = draw_extraordinary(input, overlay);
    Panel panel;
    panel.id = "cage";
    panel.title = "Cage";
    panel.caption = faces_and_edges(input.scene, *counts) + " around the surface; " +
                    count_of(extraordinary, "extraordinary vertex", "extraordinary vertices");
    panel.alt = "the cage's edges around its limit surface";
    panel.legend = legend_of(*counts);
    if (extraordinary > 0) panel.legend.push_back({extraordinary_color, "extraordinary"});
    panel.picture = overlay.image();
    return panel;
}

Result<Panel> limit_panel(const CagePanelInput& input) {
    Overlay overlay(input.shot);
    const auto counts = draw_lines(input, overlay, [&](const prep::Mesh& cage) {
        return limit_edges(cage, input.prepare.subdivision);
    });
    if (!counts) return counts.error();
    Panel panel;
    panel.id = "limit-wireframe";
    panel.title = "Limit wireframe";
    panel.caption = count_of((*counts)[0] + (*counts)[1] + (*counts)[2], "edge") +
                    " of the cage as curves on its limit surface";
    panel.alt = "the cage's edges as curves on the limit surface";
    panel.legend = legend_of(*counts);
    panel.picture = overlay.image();
    return panel;
}

prep::PreparedScene with_cages(const prep::PreparedScene& scene) {
    prep::PreparedScene out;
    out.scene.nodes = scene.scene.nodes;
    out.scene.meshes.resize(scene.meshes.size());
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const bool refined = m < scene.cages.size() && scene.cages[m].face_count() > 0;
        prep::VertexMesh& mesh = out.meshes.emplace_back();
        mesh.positions = refined ? scene.cages[m].positions : scene.meshes[m].positions;
        if (!refined) {
            mesh.indices = scene.meshes[m].indices;
            mesh.lines = scene.meshes[m].lines;
            mesh.points = scene.meshes[m].points;
        }
        mesh.origin = refined ? scene.cages[m].origin : scene.meshes[m].origin;
    }
    return out;
}

}  // namespace report
