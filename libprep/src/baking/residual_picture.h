// A residual normal map in the making (prep/displacement/residual.h): triangles of one material,
// of one mesh after the other.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "prep/displacement/residual.h"
#include "prep/image.h"
#include "prep/mesh.h"
#include "tessellation/displaced_surface.h"
#include "tessellation/tessellation.h"

namespace prep::detail {

// The triangles of a mesh as it is written, and where each of its source faces lies in the surface.
struct BakedMesh {
    const DisplacedSurface& surface;
    const VertexMesh& mesh;                 // with normals, tangents and the UV set
    std::span<const TrianglePlace> places;  // by VertexMesh::triangle_faces
    std::uint32_t uv_set = 0;
};

class ResidualPicture {
  public:
    // What a texel takes: until image(), and besides while image() is made and written.
    static constexpr std::uint64_t bytes = 15, bytes_at_the_end = 40;

    explicit ResidualPicture(std::uint32_t size);

    // Adds the mesh's triangles of this material. Says why not, where their UVs are not charts of
    // one picture: too many tiles; then nothing is added. O(texels covered + triangles).
    std::optional<std::string> add(const BakedMesh& baked, std::uint32_t material, int threads);

    // Sets what the report tells of texels and angles.
    void count(ResidualMap& report) const;
    // Three channels in 0…1, 0.5 for zero; texels outside charts filled. Nothing is left of this.
    Image image() &&;

  private:
    struct Band;
    struct Triangle;
    // The samples of this band that are the triangle's and were no other's; whether there are any.
    bool claim(const Triangle& triangle, Band& band);
    // The surface's normals there, into the sums.
    void bake(const BakedMesh& baked, const Triangle& triangle, Band& band);

    std::uint32_t size_;
    std::vector<glm::vec3> sums_;       // of normals in the triangles' frames
    std::vector<std::uint16_t> owned_;  // a bit for each sample of a texel
    std::vector<std::uint8_t> flags_;
    double degrees_ = 0, largest_degrees_ = 0;
    std::uint64_t samples_ = 0;
};

}  // namespace prep::detail
