// Runs the built command as a process of its own, and small files for it to work on.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace test {

struct Ran {
    int exit_code = -1;  // 128 + signal where one ended it
    std::string out, err;
    // Parses `out`; null where it is no JSON.
    nlohmann::json json() const { return nlohmann::json::parse(out, nullptr, false); }
};

// The built command, and where it stands.
Ran run_command(const std::vector<std::string>& arguments);
std::filesystem::path command_path();
Ran run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments);

// A new empty directory, removed with all it holds at the end.
class TemporaryDirectory {
  public:
    TemporaryDirectory();
    ~TemporaryDirectory();
    TemporaryDirectory(const TemporaryDirectory&) = delete;
    TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }
    std::vector<std::string> names() const;  // what lies in it, sorted

  private:
    std::filesystem::path path_;
};

void write_text(const std::filesystem::path& path, const std::string& text);
std::string read_text(const std::filesystem::path& path);

// OBJ text: a unit cube of quads; the same with a UV square on every face; a UV sphere.
std::string cube_obj();
std::string textured_cube_obj();
std::string sphere_obj(int segments, int rings);

}  // namespace test
