// For tests of readers and writers: a folder that goes away again, files as strings, scenes written
// as they are, and meshes compared by bits.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "prep/prepare.h"

namespace test {

class TempDir {
  public:
    TempDir();
    ~TempDir();
    TempDir(const TempDir&) = delete;
    TempDir& operator=(const TempDir&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }
    std::vector<std::string> names() const;  // what is in it, sorted

  private:
    std::filesystem::path path_;
};

std::string file_text(const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, std::string_view text);

// A reader's result for a file of this text; fails the test where the scene breaks a promise of
// prep/mesh.h.
prep::Result<prep::Scene> parsed(prep::Result<prep::Scene> (*parse)(std::span<const std::byte>,
                                                                    const std::string&),
                                 const std::string& text, const std::string& name);
std::string error_of(const prep::Result<prep::Scene>& result);  // in words, or "no error"

// Split into vertices with nothing computed: what a writer gets when nothing was asked for.
prep::PreparedScene untouched(prep::Scene scene);

// What differs between the two, face by face and corner by corner, in world coordinates and by
// bits: sizes of faces, positions, normals, first UV set, first colours. Empty where nothing does.
std::string corner_difference(const prep::Mesh& a, const prep::Mesh& b);
// The same for every list of the mesh but its name, indices included.
std::string exact_difference(const prep::Mesh& a, const prep::Mesh& b);

}  // namespace test
