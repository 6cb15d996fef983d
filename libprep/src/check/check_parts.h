// The parts of check(): each looks at one side of a mesh and adds its findings.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "prep/check.h"
#include "prep/face_normals.h"
#include "prep/topology.h"

namespace prep::detail {

// Counts places of one kind and keeps the first ones; places must come ascending.
struct Places {
    std::uint64_t count = 0;
    std::vector<std::uint32_t> first;
    void add(std::uint32_t place) {
        if (count++ < Finding::max_places) first.push_back(place);
    }
};

struct CheckContext {
    const Mesh& mesh;
    MeshView view;
    Topology topology;  // welded exactly
    FaceNormals faces;
    int threads = 0;
    std::uint32_t mesh_index = 0;
    MeshSummary summary;
    std::vector<Finding> findings;

    void add(std::string kind, Severity severity, PlaceKind place_kind, Places places,
             std::string text) {
        if (places.count == 0) return;
        findings.push_back({std::move(kind), severity, mesh_index, places.count, place_kind,
                            std::move(places.first), std::move(text)});
    }
    std::uint32_t point_of(std::uint32_t corner) const {
        return topology.welded[mesh.corner_vertices[corner]];
    }
};

void check_vertices(CheckContext& context);
void check_faces(CheckContext& context);
void check_adjacency(CheckContext& context);
void check_attributes(CheckContext& context);

// Corners of faces whose material samples a UV set that is not there; faces of unknown materials.
void check_materials(const Scene& scene, std::uint32_t mesh_index, std::vector<Finding>& findings);

}  // namespace prep::detail
