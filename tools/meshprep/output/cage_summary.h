// What a mesh is as a cage of a subdivision surface.
#pragma once

#include <cstdint>
#include <string>

#include "meshprep/output/report_json.h"
#include "prep/mesh.h"

namespace meshprep {

struct CageSummary {
    // Vertices where the surface is not a regular spline: inside, not of four faces (triangle
    // meshes, Loop's: six); at borders, not of two (three), but for corners of one.
    std::uint64_t extraordinary_vertices = 0;
    std::uint64_t semi_sharp_edges = 0, infinitely_sharp_edges = 0;  // tagged
    std::uint64_t sharp_vertices = 0, crease_ends = 0;               // tagged; darts
    std::uint64_t hole_faces = 0;
    // Edges of three and more faces, or of two that run the same way; vertices around which the
    // faces are not one fan. Both are sharp to the rules.
    std::uint64_t non_manifold_edges = 0, non_manifold_vertices = 0;
    bool triangles = false;  // all faces: judged as Loop's
    bool tagged() const {
        return semi_sharp_edges + infinitely_sharp_edges + sharp_vertices + hole_faces > 0;
    }
};
CageSummary summarise_cage(const prep::Mesh& mesh, int threads);

std::string cage_text(const CageSummary& cage);
Json to_json(const CageSummary& cage);

}  // namespace meshprep
