// The numbers beside the pictures of a validation sheet.
#pragma once

#include <vector>

#include "prep/check.h"
#include "prep/prepared_scene.h"
#include "sheets/sheet.h"

namespace report {

// How good the prepared attributes are, measured on the vertices that a renderer reads.
struct AttributeQuality {
    bool normals = false, tangents = false;
    double normal_length_error = 0;   // largest | |n| − 1 |
    double mean_turn = 0;             // degrees between a corner's normal and its triangle's, mean
    double largest_turn = 0;          // … and the largest
    std::uint64_t against_face = 0;   // corners whose normal is more than 90° off
    double tangent_length_error = 0;  // largest | |t| − 1 |
    double orthogonality_error = 0;   // largest |n · t|
    std::uint64_t mirrored_triangles = 0, triangles = 0;
};
// Whether the texture appears mirrored on triangle `t`, by the area of its first UV set.
bool mirrored_uv(const prep::VertexMesh& mesh, std::size_t t);
AttributeQuality measure_attributes(const std::vector<prep::VertexMesh>& meshes);

// Groups "Mesh", "Vertices", "Normals and tangents", "Time"; `summaries` and `prepared` cover the
// same meshes. `called_for`: why tangents are (not) needed by the materials.
std::vector<FigureGroup> make_figures(const prep::PreparedScene& prepared,
                                      const std::vector<prep::MeshSummary>& summaries,
                                      const std::string& called_for);

FigureGroup findings_group(const std::vector<prep::Finding>& findings, std::size_t most);

}  // namespace report
