// The files that Assimp reads for a model: itself, and those that it names.
#pragma once

#include <assimp/DefaultIOSystem.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace prep::detail {

// Names that are relative are sought in the model's folder alone, wherever the program was started:
// Assimp would look in the current directory first. The model itself has to be asked for by its
// absolute path.
class ModelFiles {
  public:
    explicit ModelFiles(const std::filesystem::path& model);

    const std::filesystem::path& model() const { return model_; }
    // A handler for an importer, which deletes it; it writes down here what is asked for.
    Assimp::IOSystem* make_handler();

    // Those beside the model that were read, in the order of their first reading, from where the
    // model's own path begins.
    std::vector<std::filesystem::path> read() const;
    // The names of models and skeletons that were sought and found nowhere.
    std::vector<std::string> missing() const;
    // Those of material scripts, where none of them was found: one is sought by several names.
    std::vector<std::string> missing_scripts() const;

  private:
    class Handler;
    std::filesystem::path model_, named_;  // absolute, and as it was given
    std::vector<std::filesystem::path> read_;
    std::set<std::string> found_, sought_;  // whole paths
};

}  // namespace prep::detail
