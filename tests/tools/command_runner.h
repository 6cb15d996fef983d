// Runs the built command as a process of its own, and small files for it to work on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "temporary_files.h"

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
// The same command inside this process: no start, no loading of libraries. For tests that run it
// many times and care for what it says and writes, not for the process.
Ran run_here(const std::vector<std::string>& arguments);

// What the process finds around it, where that matters.
struct Circumstances {
    std::vector<std::pair<std::string, std::string>> environment = {};  // beside what there is
    std::optional<unsigned> user = {};  // runs as this one, which takes the superuser to ask for
    std::optional<std::filesystem::path> out = {};  // standard output; empty: it is closed
    std::filesystem::path in = "/dev/null";         // standard input
    std::vector<int> ignored_signals = {};
    std::uint64_t largest_file = 0, memory = 0;  // limits in bytes; 0: none
};
Ran run_command(const std::vector<std::string>& arguments, const Circumstances& circumstances);

// Whoever runs the tests, and an ordinary user where that is the superuser, who may do anything.
std::vector<std::optional<unsigned>> users();

// A glTF file as text, its numbers in it: one mesh after the other, each of one primitive, under a
// node of its own. Written anew from the specification, so that it depends on no writer.
class GltfText {
  public:
    struct Primitive {
        std::string name;
        std::vector<float> positions;  // three a vertex
        std::vector<float> normals, uvs, tangents;
        std::vector<std::uint32_t> indices;
        std::string more;  // further members of the primitive: "\"material\":0"
        std::string node;  // further members of its node: "\"translation\":[1,0,0]"
    };
    void add(const Primitive& primitive);
    std::size_t add_scalars(const std::vector<float>& values);  // the number of their accessor
    // `more`: further members of the document.
    std::string text(const std::string& more = "") const;

  private:
    std::size_t accessor(const void* bytes, std::size_t size, std::size_t count, int type,
                         const std::string& kind, const std::string& more);
    std::string buffers_, views_, accessors_, meshes_, nodes_, roots_;
    std::size_t count_ = 0, accessor_count_ = 0;
};

// Bytes as base64 (RFC 4648).
std::string base64_of(const std::string& bytes);
// Text as it stands in a JSON string.
std::string json_quoted(const std::string& text);

// OBJ text: a unit cube of quads; the same with a UV square on every face; a UV sphere.
std::string cube_obj();
std::string textured_cube_obj();
std::string sphere_obj(int segments, int rings);

}  // namespace test
