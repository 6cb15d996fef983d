// Where the grid of quantised positions is undone: in nodes and skins.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "formats/gltf/appended_data.h"
#include "formats/gltf/document.h"

namespace prep::detail {

// A stored position p is at origin + step · p.
struct PositionGrid {
    glm::dvec3 origin{0.0};
    double step = 1;
    bool neutral() const { return origin == glm::dvec3(0.0) && step == 1; }
};

// The grids of a document's meshes. Who has which mesh, skin and animation is looked up once, so
// that all meshes together cost what the document is long. The document lives as long, and nothing
// else changes its nodes, skins and animations.
class GridNodes {
  public:
    // `document` holds the data that `json`, which is changed, speaks of.
    GridNodes(const GltfDocument& document, Json& json, AppendedData& appended);

    // Why a mesh cannot get a grid; empty: it can. Instances are placed between node and mesh,
    // some materials have lengths in the mesh's own unit, and extensions that are not known here
    // may speak of the nodes that have meshes.
    std::string no_place_for_grid(std::size_t mesh) const;

    // Whether floats hold the matrices of the mesh's skins after the grid's: finite, and not so
    // small that they vanish. Errors: those of GltfDocument::raw_accessor.
    Result<bool> matrices_hold(std::size_t mesh, const PositionGrid& grid) const;

    // Every node of the mesh hands it to a new child, with its weights and its skin, which gets
    // matrices for this grid: itself, or a copy where other meshes have it; animations of weights
    // follow. At most once a mesh. Errors: those of GltfDocument::raw_accessor.
    Result<void> place_grid(std::size_t mesh, const PositionGrid& grid);

  private:
    struct Channel {
        std::size_t animation = 0, channel = 0;
    };

    void find_weight_channels();
    // How many of the mesh's nodes have which skin.
    std::map<std::size_t, std::size_t> skins_of(std::size_t mesh) const;
    Result<std::size_t> placed_skin(std::size_t skin, std::size_t users, const PositionGrid& grid);
    void move_weight_channels(std::size_t from, std::size_t to);

    const GltfDocument& document_;
    Json& json_;
    AppendedData& appended_;
    std::string unknown_extension_;
    std::vector<std::vector<std::size_t>> nodes_of_mesh_;
    std::vector<std::size_t> users_of_skin_;                 // nodes, before any got a child
    std::vector<std::vector<Channel>> channels_of_weights_;  // by node
};

}  // namespace prep::detail
