// One mesh on its way through the stages: run() in prepare.cpp is their order, normals_stage.cpp,
// tangents_stage.cpp and morph_targets.cpp are what they decide.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/stage_log.h"
#include "prep/prepare.h"
#include "prep/topology.h"

namespace prep::detail {

struct NormalReview;
struct TangentReview;

class MeshPreparation {
  public:
    MeshPreparation(const PrepareOptions& options, PreparedScene& out, StageLog& log,
                    std::uint32_t index)
        : options_(options),
          out_(out),
          log_(log),
          index_(index),
          mesh_(out.scene.meshes[index]),
          need_(out.requirements[index]) {}

    Result<void> run();

  private:
    void share_vertices();
    Result<void> repair_mesh();
    Result<void> prepare_normals();
    Result<void> prepare_tangents();
    Result<void> split_mesh();
    // What was computed for the mesh its morph targets need as well: the file's deltas, if it has
    // any, belong to normals and tangents that are gone.
    Result<void> prepare_morph_targets();

    Result<CornerNormals> compute_normals(const std::string& reason);
    void skip_normals(const std::string& reason);
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
                     std::vector<std::uint32_t> places, std::string text);

    const PrepareOptions& options_;
    PreparedScene& out_;
    StageLog& log_;
    std::uint32_t index_;
    Mesh& mesh_;
    const MeshRequirements& need_;

    struct Geometry {  // computed once, when the first stage asks
        std::optional<FaceNormals> faces;
        std::optional<Topology> topology;
        std::optional<HardEdges> hard;
        bool shared = false;  // equal positions share a vertex already
    } geometry_;
    bool normals_made_ = false, tangents_made_ = false;  // all of the mesh
    std::vector<bool> normal_replaced_;  // per corner; empty: none of the file's own
};

}  // namespace prep::detail
