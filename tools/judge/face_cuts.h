// Faces of more than three corners are cut into triangles, in each file by itself: what that adds
// to how far two matched faces are apart.
#pragma once

#include "judge/matching.h"

namespace judge {

class FaceCuts {
  public:
    // `faces` whole and `cut` into triangles, of one scene and the same meshes; both must outlive
    // it.
    FaceCuts(const WorldFaces& faces, const WorldFaces& cut);

    std::size_t begin(std::uint32_t face) const { return first_[face]; }
    std::size_t end(std::uint32_t face) const { return first_[face + 1]; }
    const WorldFaces& faces() const { return faces_; }
    const WorldFaces& cut() const { return cut_; }

  private:
    const WorldFaces &faces_, &cut_;
    std::vector<std::size_t> first_;  // of each face's triangles in `cut_`
};

// No point of either face's triangles is farther from the other's than the corners moved and this.
// 0 where both are cut alike. Of quads cut along different diagonals their distance: both are fans
// about a point of theirs, with the same rims. Infinite where nothing is known.
double cuts_apart(const FaceCuts& a, const FaceCuts& b, const FacePair& pair);

}  // namespace judge
