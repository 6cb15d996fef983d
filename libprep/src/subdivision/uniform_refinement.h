// What the channels of a mesh that is subdivided as a whole have in common: which faces are kept,
// how their points are numbered, and the loops over roots that write points and corners.
#pragma once

#include <memory>

#include "limit_surface/channel_surface.h"
#include "limit_surface/face_varying.h"
#include "subdivision/grid_numbering.h"

namespace prep::detail {

// What a face of so many corners becomes, and the corners of each.
struct FacePieces {
    std::uint64_t faces, size;
    std::uint64_t corners() const { return faces * size; }
};
FacePieces pieces_of(std::uint64_t size, int level, bool triangles);

class UniformRefinement {
  public:
    const Mesh& mesh;
    const SubdivideOptions& options;
    const SurfaceCage& positions;
    const RefinedCage& refined;  // of the positions
    std::vector<std::uint64_t>
        first_faces;                   // per root of the positions' tree: its first output face
    std::vector<std::uint32_t> roots;  // those that are kept
    std::uint64_t face_count = 0, corner_count = 0;

    UniformRefinement(const Mesh& m, const SubdivideOptions& o, const SurfaceCage& cage,
                      const RefinedCage& r, const PatchTree& tree);

    bool triangles() const { return positions.corners_per_face() == 3; }
    // The topology of a channel with these vertices at the faces' corners; edges by their ends.
    NumberedTopology topology(std::span<const std::uint32_t> corner_vertices,
                              std::uint32_t vertex_count) const;
    GridNumbering numbering(const NumberedTopology& topology) const {
        return GridNumbering(topology, refined.has_surface, options.level, triangles());
    }

    // One block's memory.
    struct Scratch {
        std::vector<double> value, du, dv;
        std::vector<std::uint32_t> ids;
        std::vector<std::uint8_t> own;
    };
    // The root's points into scratch; ids and own of `numbering`.
    void evaluate(const PatchRoot& root, std::uint32_t index, const GridNumbering& numbering,
                  const SurfacePieces& pieces, PatchEvaluator& evaluator, const GridTables& tables,
                  bool derivatives, Scratch& scratch) const;
    // The output corners' ids of a root, out of scratch.ids.
    void write_corners(const PatchRoot& root, std::uint32_t index, const GridNumbering& numbering,
                       std::span<const std::uint32_t> ids,
                       std::vector<std::uint32_t>& corners) const;
    static void write_triangles(std::uint32_t n, std::span<const std::uint32_t> ids,
                                std::uint32_t* out);
    // The same at level 0, for all faces.
    void write_cage_corners(const GridNumbering& numbering,
                            std::span<const std::uint32_t> corner_vertices,
                            std::vector<std::uint32_t>& corners) const;
    // Refines a channel: out[id · width …] in float. Not with derivatives. Whether its seams are
    // approximate (RefinedCage).
    Result<bool> refine_channel(const SurfaceCage& cage, std::span<const double> numbers,
                                std::uint32_t width, std::vector<float>& out,
                                std::vector<std::uint32_t>& corners) const;
    std::uint32_t face_size(std::uint32_t face) const { return positions.face_size(face); }
};

}  // namespace prep::detail
