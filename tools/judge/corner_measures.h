// What matched faces carry, corner by corner.
#pragma once

#include "judge/judgement.h"
#include "judge/matching.h"

namespace judge {

// Measured::row and ::limit are set; each takes what is more than its limit, the largest first.
class FindingList {
  public:
    explicit FindingList(Measured& to) : to_(to) {}
    void add(const Finding& finding);
    void finish();  // sorts; no more than 8 are kept

  private:
    Measured& to_;
};

// Fills positions, lost, added, uvs, colors, normals, tangents, tangent_signs, skins, morphs and
// materials of `measured` (by limit_rows), and says what follows from what. `whole`: all meshes are
// compared, and what belongs to none is, too.
void measure_corners(const WorldFaces& a, const WorldFaces& b, const Matching& matching, bool whole,
                     MaterialLooks& looks, std::vector<Measured>& measured,
                     std::vector<std::string>& notes);

Measured& measured_of(std::vector<Measured>& measured, std::optional<double> Limits::*limit);

// Of the first file's face.
Finding finding_at(const WorldFaces& faces, const WorldFace& face, double value);

}  // namespace judge
