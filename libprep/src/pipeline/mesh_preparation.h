// One mesh on its way through the stages: run() in prepare.cpp is their order,
// subdivision_stage.cpp, tessellation_stage.cpp, normals_stage.cpp, tangents_stage.cpp and
// morph_targets.cpp are what they decide.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/displacement_maps.h"
#include "pipeline/residual_maps.h"
#include "pipeline/stage_log.h"
#include "prep/prepare.h"
#include "prep/subdivide.h"
#include "prep/topology.h"
#include "surface/vertex_corners.h"

namespace prep::detail {

struct NormalReview;
struct TangentReview;

// A node with a mesh, and what takes the node's space to the world's.
struct MeshInstance {
    std::uint32_t node = 0;
    glm::dmat4 transform{1.0};
};
// By mesh; in order of nodes.
std::vector<std::vector<MeshInstance>> instances_of(const Scene& scene);

class MeshPreparation {
  public:
    MeshPreparation(const PrepareOptions& options, PreparedScene& out, StageLog& log,
                    DisplacementMaps& maps, ResidualMaps* residuals, std::uint32_t index,
                    std::span<const MeshInstance> instances)
        : options_(options),
          out_(out),
          log_(log),
          maps_(maps),
          residuals_(residuals),
          index_(index),
          instances_(instances),
          mesh_(out.scene.meshes[index]),
          need_(out.requirements[index]) {}

    Result<void> run();

  private:
    void share_vertices();
    Result<void> repair_mesh();
    bool is_welded() const;
    // Cage, then surface: from here on the mesh is the refined one, its normals the limit's.
    Result<void> subdivide_mesh();
    // The same, as fine as an error asks, and displaced.
    Result<void> tessellate_mesh();
    bool is_not_tessellated();
    Result<TessellateOptions> tessellate_options() const;
    void report_not_tessellated();
    // What the residual normal maps will need, and the tangents that they call for.
    void choose_residuals(const TessellateOptions& options);
    ResidualMaps::Report residual_report();
    Result<void> bake_residuals();
    Result<void> weld_cage(const std::string& reason);
    void move_cage_to_its_origin();
    Result<void> make_cage();
    void take_surface(Mesh&& surface);
    void report_left_out(std::uint64_t holes, std::uint64_t uv_sets, std::uint64_t color_sets);
    void report_heights(const DisplacementMaps::OfMesh& maps);
    void report_certificate(const TessellationCertificate& certificate,
                            const TessellateOptions& options);
    Result<void> crease_hard_edges();
    Result<void> morph_limit_normals(const SubdivideOptions& options, const SubdividedMesh& rest);
    Result<void> prepare_normals();
    Result<void> prepare_tangents();
    void drop_unread();
    Result<void> split_mesh();
    // What was computed for the mesh its morph targets need as well: the file's deltas, if it has
    // any, belong to normals and tangents that are gone.
    Result<void> prepare_morph_targets();
    void optimize_mesh();

    Result<CornerNormals> compute_normals(const std::string& reason);
    void skip_normals(const std::string& reason);
    // What topology, face normals and hard edges read and wrote; `walked`: the last made normals.
    void count_moved(const MeshView& view, std::span<const std::uint32_t> welded,
                     const HardEdges& hard, const CornerNormals* walked);
    bool keeps_lengths() const;
    void make_normals_unit();
    void report_review(const NormalReview& review);
    void report_fallbacks(const CornerNormals& computed);

    Result<void> keep_tangents(const MeshView& view, const std::string& reason);
    void drop_tangents();
    TangentReview review_of(const MeshView& view, const CornerTangents* computed) const;
    Result<void> replace_tangents(const MeshView& view, const std::string& reason,
                                  unsigned replace);
    void report_review(const TangentReview& review, unsigned replaced);

    Result<MorphDeltas> morph_deltas(const MorphTarget& target);

    void add_finding(std::string kind, Severity severity, std::uint64_t count,
                     std::vector<std::uint32_t> places, std::string text,
                     PlaceKind place_kind = PlaceKind::corner);

    const PrepareOptions& options_;
    PreparedScene& out_;
    StageLog& log_;
    DisplacementMaps& maps_;
    ResidualMaps* residuals_;  // null: none are asked for
    std::uint32_t index_;
    std::span<const MeshInstance> instances_;  // read for errors in pixels alone
    Mesh& mesh_;
    CornerLayer<glm::vec2> mixed_uvs_;  // that tangents follow, where they are not one set
    const MeshRequirements& need_;

    struct Geometry {  // computed once, when the first stage asks
        std::optional<FaceNormals> faces;
        std::optional<Topology> topology;     // where `around` did not do
        std::optional<VertexCorners> around;  // the mesh's own vertices'
        std::optional<HardEdges> hard;
        bool shared = false;  // equal positions share a vertex already
    } geometry_;
    struct Baking {
        ResidualMaps::OfMesh of;
        Mesh cage;
        TessellateOptions options;
        std::vector<TrianglePlace> places;
    };
    std::optional<Baking> baking_;
    bool normals_made_ = false, tangents_made_ = false;  // all of the mesh
    // Of a surface that was subdivided or cut: nothing computes others.
    bool limit_normals_ = false;
    SplitReason normals_apart_ = SplitReason::authored_normal;  // where no hard edge is known
    std::vector<CornerLayer<glm::vec3>> limit_morph_normals_;   // by target
    std::vector<bool> normal_replaced_;  // per corner; empty: none of the file's own
};

// Of materials, where they are prepared for one picture: the maps that it does not read.
void drop_unread_maps(PreparedScene& out, const PrepareOptions& options, StageLog& log);

}  // namespace prep::detail
