// A material of Assimp as its reader sees it: what is read is remembered, so that what nobody reads
// can be named.
#pragma once

#include <assimp/material.h>

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/assimp/counted_names.h"

namespace prep::detail {

class MaterialProperties {
  public:
    explicit MaterialProperties(const aiMaterial& material);

    // What is not there, of another type or not finite is nothing. The parameters are those of
    // Assimp's AI_MATKEY_ macros.
    std::optional<float> number(const char* key, unsigned type = 0, unsigned index = 0) const;
    std::optional<glm::vec3> color(const char* key, unsigned type = 0, unsigned index = 0) const;
    // The fourth number of a colour.
    std::optional<float> alpha(const char* key, unsigned type = 0, unsigned index = 0) const;
    std::optional<int> integer(const char* key, unsigned type = 0, unsigned index = 0) const;
    std::optional<std::string> text(const char* key, unsigned type = 0, unsigned index = 0) const;
    std::optional<aiUVTransform> uv_transform(const char* key, unsigned type, unsigned index) const;
    // $tex.file, $tex.uvwsrc, … of the first texture of a type.
    struct Map {
        std::string file;
        unsigned uv = 0;
        aiTextureMapMode mode[2] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
        std::optional<aiUVTransform> transform;
    };
    std::optional<Map> map(aiTextureType type) const;
    // Whether the first texture of a type is this file.
    bool names_picture(aiTextureType type, const std::string& file) const;

    // Adds the keys that nobody has asked for. Left out is what changes nothing (black, zero, a
    // factor of 1), and what says again what another key says: FBX's own words beside Assimp's, a
    // roughness that Assimp makes of the exponent.
    void count_unread(CountedNames& names) const;

  private:
    const aiMaterialProperty* find(const char* key, unsigned type, unsigned index) const;
    const aiMaterialProperty* peek(const char* key) const;
    bool says_nothing(const aiMaterialProperty& property) const;

    const aiMaterial& material_;
    mutable std::vector<bool> read_;  // by property
};

}  // namespace prep::detail
