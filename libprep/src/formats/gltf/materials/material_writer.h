// Materials, textures, samplers and images for a glTF document.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "formats/gltf/buffer.h"
#include "prep/prepared_scene.h"
#include "text/name_list.h"

namespace prep::detail {

class MaterialWriter {
  public:
    // All must outlive it. Remarks go to `notes`, names of extensions in use to `extensions`.
    MaterialWriter(const PreparedScene& prepared, GltfBuffer& buffer,
                   std::vector<std::string>& notes, std::set<std::string>& extensions)
        : prepared_(prepared),
          scene_(prepared.scene),
          buffer_(buffer),
          notes_(notes),
          extensions_(extensions) {}

    // First. A map may only read UV sets that the primitive has. Where one lacks some, it gets a
    // variant of its material without those maps; the first variant stands at the material's own
    // place where no primitive needs the whole.
    void choose_variants();
    // Index in the file of what the mesh's faces of this material get.
    std::uint32_t variant_for(const VertexMesh& mesh, std::uint32_t material) const;
    void write();
    // The textures that write() could not read.
    void note_unread();

  private:
    // What is stored of a picture: itself, with its green turned over (normal maps whose green
    // points down), or heights, with 16 bits where they need them.
    enum class Pixels : std::uint8_t { kept, green_turned, heights };
    struct Variant {
        std::uint32_t material;
        std::uint64_t uv_sets;  // bits; maps that read others are left out
    };

    Json material(const Variant& variant);
    void set_texture(Json& owner, const char* slot, const TextureRef& ref,
                     Pixels pixels = Pixels::kept);
    std::uint32_t texture_index(std::uint32_t texture, Pixels pixels);
    std::uint32_t image_index(std::uint32_t image, Pixels pixels);
    std::vector<std::byte> converted(const ImageRef& ref, Pixels pixels);
    void normal_map(const Material& m, Json& out);
    void occlusion(const Material& m, Json& out);
    void emission(const Material& m, Json& out);
    void reflectance(const Material& m, const glm::vec3& reflected, Json& out);
    void displacement(const Material& m, Json& out);
    void note(const std::string& text);

    const PreparedScene& prepared_;
    const Scene& scene_;
    GltfBuffer& buffer_;
    std::vector<std::string>& notes_;
    std::set<std::string>& extensions_;
    std::size_t limited_ = 0;        // highlights
    NameList unread_;                // textures
    std::vector<Variant> variants_;  // by index in the output
    std::map<std::pair<std::uint32_t, std::uint64_t>, std::uint32_t> variant_index_;
    std::map<std::pair<std::uint32_t, Pixels>, std::uint32_t> texture_map_, image_map_;
};

}  // namespace prep::detail
