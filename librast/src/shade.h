// Shading: what one visible point of a triangle looks like.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "lighting.h"
#include "rast/render.h"
#include "setup.h"
#include "texture.h"

namespace rast {

// A mesh in its place, transformed. Positions are relative to the eye, in world axes: float is then
// precise where it matters, however far the scene is from its origin.
struct Instance {
    std::uint32_t node = 0;
    const prep::VertexMesh* mesh = nullptr;
    float handedness = 1;              // −1: the transform mirrors
    glm::mat3 normal_matrix{1.0f};     // cofactors, of order one
    std::vector<ScreenVertex> screen;  // one per vertex
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec4> tangents;
    std::vector<LightSum> lit, lit_behind;  // Gouraud; on the front side, on the back
    std::vector<std::uint32_t> range_of;    // per triangle: its range
};

struct Textures {
    std::vector<std::unique_ptr<MipTexture>> by_index;  // null: not used or not readable
};

class Shader {
  public:
    Shader(const prep::PreparedScene& scene, const RenderPlan& plan, const Textures& textures);

    // Fills Instance::lit and, where back faces can be seen, lit_behind: for Gouraud shading.
    void light_vertices(Instance& instance, bool two_sided) const;

    // Linear colour and alpha at a pixel centre; alpha below zero means cut away by the mask.
    glm::vec4 shade(const Instance& instance, const SetupTriangle& triangle, std::int32_t x,
                    std::int32_t y) const;

    // Whether the alpha mask lets the pixel stand; to be asked before depth is written.
    bool covered(const Instance& instance, const SetupTriangle& triangle, std::int32_t x,
                 std::int32_t y) const;
    bool masked(const Instance& instance, const SetupTriangle& triangle) const;

  private:
    struct Point;
    const prep::Material& material_of(const Instance& instance, const SetupTriangle& t) const;
    glm::vec4 sample(const prep::TextureRef& ref, const Point& point,
                     const glm::vec4& otherwise) const;
    glm::vec3 normal_at(const Point& point) const;
    glm::vec3 mapped_normal(const Point& point, const glm::vec3& geometric,
                            const glm::vec3& interpolated) const;

    const prep::PreparedScene& scene_;
    const RenderPlan& plan_;
    const Textures& textures_;
    std::vector<ShadingLight> lights_;
    prep::Material default_material_;
    bool perspective_;
    glm::vec3 backward_;  // orthographic: towards the eye
};

}  // namespace rast
