// A folder that goes away again, and files as strings.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

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

std::string file_text(const std::filesystem::path& path);  // empty where it cannot be read
void write_text(const std::filesystem::path& path, std::string_view text);

}  // namespace test
