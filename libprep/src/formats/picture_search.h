// Where the pictures are that a file names: one search for all readers.
//
// Files carry the paths of the machine they were written on: absolute ones, with drives,
// backslashes and other capitals. A name is tried, in this order,
//   1. as it stands: an absolute path that exists, or a path relative to the model ("../"
//   included);
//   2. with '\' for '/', its percent-encoding undone, in any capitals;
//   3. its last parts (32 at most), longest first and never through "..", in the model's directory,
//   in that one's picture folders (picture_folders), in the same folders beside it
//   ("source/model.fbx" with "textures/"), and in the directories that the user names.
// In 3 nothing is found outside of these directories. Between names that differ in capitals alone
// the exact one is taken, else the first in the order of bytes.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace prep {
struct Scene;
}

namespace prep::detail {

inline constexpr std::array<std::string_view, 8> picture_folders = {
    "textures", "texture", "tex", "maps", "images", "image", "img", "pictures"};

class PictureSearch {
  public:
    // `directory`: the model's. Nothing is read before the first picture that is not at its place.
    explicit PictureSearch(std::filesystem::path directory,
                           std::vector<std::filesystem::path> texture_directories = {});

    std::optional<std::filesystem::path> locate(const std::string& name);

    // The same; where there is no such file, the path that it would have beside the model, and the
    // name is kept for warnings().
    std::filesystem::path find(const std::string& name);

    // One sentence with all that find() missed and where it was sought; none where nothing was.
    std::vector<std::string> warnings() const;

    // Where files that were found elsewhere were looked for before: what appears there takes their
    // place. Of other capitals only the name's own.
    const std::set<std::filesystem::path>& passed_over() const { return passed_over_; }

    // Gives the scene both.
    void tell(Scene& scene) const;

  private:
    std::optional<std::filesystem::path> search(const std::string& name);
    void pass_over_tried();
    bool is_file(const std::filesystem::path& path);
    std::optional<std::filesystem::path> in_any_case(const std::filesystem::path& base,
                                                     const std::vector<std::string>& parts);
    // What a directory has of this name, in any capitals: in the order of bytes.
    const std::vector<std::string>& entries(const std::filesystem::path& directory,
                                            const std::string& name);
    std::vector<std::filesystem::path> sought_directories() const;

    std::filesystem::path directory_;
    std::vector<std::filesystem::path> extra_;
    std::vector<std::string> missing_;
    std::set<std::string> is_missing_;
    using Listing = std::map<std::string, std::vector<std::string>>;  // by name in small letters
    std::map<std::string, Listing> listings_;                         // by directory
    std::map<std::string, std::optional<std::filesystem::path>> known_;
    std::vector<std::string> tried_;  // in the search at hand, and no files
    std::set<std::filesystem::path> passed_over_;
    std::size_t passed_over_bytes_ = 0;
};

}  // namespace prep::detail
