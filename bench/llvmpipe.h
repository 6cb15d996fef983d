// The peer: Mesa's llvmpipe through OSMesa, drawing one mesh with Blinn-Phong light.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "prep/image.h"
#include "prep/mesh.h"

namespace bench {

// What both sides draw: one directional light and ambient light, linear colours.
struct Surface {
    glm::vec3 ambient{0.0f};  // light times reflectance
    glm::vec3 diffuse{0.0f}, specular{0.0f};
    float shininess = 1;
    glm::vec3 to_light{0.0f}, light{0.0f};  // unit, world axes; linear colour
    glm::vec3 eye{0.0f};                    // world
    glm::mat4 to_clip{1.0f};                // world to OpenGL's clip space, depth −1…1
    bool mapped = false;                    // diffuse and normal map, trilinear
};

class Llvmpipe {
  public:
    // `width` × `height` pixels, RGBA of 8 bits with a 32-bit depth buffer, in memory of the
    // driver's. Null with a message where OSMesa gives no context of OpenGL 3.3.
    static std::unique_ptr<Llvmpipe> make(std::uint32_t width, std::uint32_t height,
                                          std::string& message);
    virtual ~Llvmpipe() = default;

    // Vertex, index and texture memory, mip levels and programs: nothing of it is timed.
    virtual void upload(const prep::VertexMesh& mesh, const prep::Image& diffuse,
                        const prep::Image& normals) = 0;
    // Clears and draws; returns when the last pixel is written.
    virtual void draw(const Surface& surface) = 0;
    // Four bytes a pixel, top row first.
    virtual std::vector<std::uint8_t> pixels() const = 0;
    virtual std::string version() const = 0;
};

}  // namespace bench
