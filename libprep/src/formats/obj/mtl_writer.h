// Materials as a library of Wavefront's MTL, and what OBJ files say of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "base/atomic_files.h"
#include "formats/obj/statement_names.h"
#include "prep/scene.h"

namespace prep::detail {

// As it is named from where the output stands.
std::string path_from(const std::filesystem::path& output, const std::filesystem::path& file);

class MtlWriter {
  public:
    // Of the scene's materials, for the OBJ file `obj`. What is lost goes into `notes`, each loss
    // once; pictures that are not files yet into `files`. All of them outlive it.
    MtlWriter(const Scene& scene, const std::filesystem::path& obj, FileSet& files,
              std::vector<std::string>& notes);

    // Each material has a name of its own, no_index too: a file has no way back to none.
    const std::string& name(std::uint32_t material) const {
        return material < names_.size() ? names_[material] : no_material_;
    }
    // That of the material's faces: the one that its colour's map reads, or the first map that it
    // has; no_index: it has none. An OBJ file has one for each corner.
    std::uint32_t uv_set(std::uint32_t material) const {
        return material < uv_sets_.size() ? uv_sets_[material] : no_index;
    }

    // Of the library, beside the OBJ file.
    std::string library_name() const { return stem_ + ".mtl"; }

    // Errors: those of `files`.
    Result<std::string> text();

  private:
    void note(const std::string& text);
    void name_materials();
    bool names_no_material() const;
    void material(const Material& in, const std::string& name, std::uint32_t set, std::string& mtl);
    void find_height_scales();
    double height_scale(const Material& of);
    void displacement(const Material& in, std::string& mtl);
    void physical_statements(const Material& in, std::string& mtl);
    void grey_map(std::string& mtl, const char* word, const TextureRef& ref, std::uint32_t channel,
                  const char* what);
    bool make(const std::string& file, const ImageRef& image, const char* what,
              const std::function<Result<std::vector<std::byte>>(Image)>& png);
    void opacity_map(const TextureRef& ref, std::string& mtl);
    const ImageRef* image_of(const TextureRef& ref);
    std::string file_name(const ImageRef& image) const;
    void map(std::string& mtl, const std::string& word, const TextureRef& ref);
    bool shows_nothing(const glm::vec3& color, const TextureRef& ref) const;
    bool is_written(const Material& in, MapKind kind) const;
    void map_on(const glm::vec3& color, std::string& mtl, const char* word, const TextureRef& ref);
    void normal_map(const Material& in, std::string& mtl);
    void map_line(std::string& mtl, const std::string& word, const TextureRef& ref,
                  const std::string& file);
    std::string image_file(std::uint32_t image);
    std::string embedded_file(const ImageRef& ref, std::uint32_t image);
    const Scene& scene_;
    const std::filesystem::path& path_;
    const std::string stem_;  // of the files beside the OBJ file
    FileSet& files_;
    std::vector<std::string>& notes_;
    std::vector<std::string> names_;
    std::string no_material_ = "default";
    std::vector<std::uint32_t> uv_sets_;  // by material
    // Of the nodes that have a material's faces: 0 where none has.
    struct HeightScale {
        double first = 0;
        bool differs = false;
    };
    std::vector<HeightScale> height_scales_;  // by material, once they are asked for
    std::uint32_t uv_set_ = 0;                // of the material being written
    std::optional<Error> failure_;
    std::unordered_map<std::uint32_t, std::string> written_;  // pictures, by image
    std::unordered_set<std::string> made_files_;
};

}  // namespace prep::detail
