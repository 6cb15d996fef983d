// Loading any supported mesh file.
//
// Formats in: OBJ+MTL, PLY, STL, OFF, OM, glTF 2.0/GLB, JSON scenes (scene_json.h), and what Assimp
// reads for other endings. A loader says what the file says: no welding, no repair, no
// triangulation. Coordinates are parsed in double; set_positions() (mesh.h) decides about `origin`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "prep/enum_names.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace prep {

// What becomes of files in which nothing could be seen: all their materials have opacity 0, as
// MeshLab's "Tr 1" says of opaque ones.
enum class Transparency : std::uint8_t { file, automatic };
constexpr auto names_of(Transparency) {
    return std::to_array<EnumName<Transparency>>(
        {{"file", Transparency::file}, {"auto", Transparency::automatic}});
}

struct ReaderProcessOptions {
    // meshprep-reader. Empty: what the environment variable MESHPREP_READER names, else what stands
    // beside this program, or where meshprep was installed.
    std::filesystem::path program;
    // For each file: seconds of processor time, and four times as many by the clock. 0: no limit.
    double seconds = 120;
    // Bytes that the process may have in all, its libraries included, some 0.2 GB. 0: no limit.
    std::uint64_t memory = std::uint64_t(8) << 30;
};

// A process of its own for the readers of other libraries (Assimp, OpenMesh). A file that makes
// them crash, hang or ask for all memory ends that process: the caller gets an Error that names the
// file, the reader and the signal or the limit, and goes on with the next file.
//
// One process serves many files; it is started with the first that needs it, and again after a file
// that it could not read. Files of our own formats start none. Threads may share a ReaderProcess:
// each file that is read meanwhile has a process of its own. All of them end with it, or with the
// calling process, however that ends. It holds faults, not attackers: the reader has the rights of
// the caller.
class ReaderProcess {
  public:
    explicit ReaderProcess(ReaderProcessOptions options = {});
    ~ReaderProcess();
    ReaderProcess(const ReaderProcess&) = delete;
    ReaderProcess& operator=(const ReaderProcess&) = delete;

    // Processes started so far.
    std::size_t started() const;

    struct State;
    State& state() { return *state_; }  // for load_scene()

  private:
    std::unique_ptr<State> state_;
};

struct LoadOptions {
    int threads = 0;  // 0: all cores; the result does not depend on it
    // glTF extensions that a file may require though nothing is known of them, or though preparing
    // may break what they say; "all": any. Those that hide vertex data stay errors.
    std::vector<std::string> allowed_extensions = {};
    // Where the readers of other libraries run; null: here, where a damaged file can end the
    // program. The result is the same.
    std::shared_ptr<ReaderProcess> reader_process = nullptr;
    // What such a reader printed for a file, its last 64 KiB, before load_scene() returns; without
    // it, that is dropped. Only with `reader_process`: here, readers print where they like.
    std::function<void(const std::filesystem::path& file, std::string_view text)> reader_log = {};
    // Where pictures are sought that are not beside the model (docs/materials.md), in this order.
    std::vector<std::filesystem::path> texture_directories = {};
    // automatic: such files are made opaque, with a warning; others keep what they say.
    Transparency transparency = Transparency::automatic;
};

// By ending, with a look at the first bytes where the ending is unknown.
// Errors: io, syntax (place = file:line or file#/json/path), invalid (values that contradict each
// other, and what is not the format of its ending), unsupported, limit.
Result<Scene> load_scene(const std::filesystem::path& path, const LoadOptions& options = {});

// For what needs something to convert or to draw: an error (invalid) where the scene has no faces,
// lines or points, or none of finite coordinates, that says what it has instead. Text that is no
// mesh at all can be read as OBJ without an error of its own.
Result<void> require_geometry(const Scene& scene);

}  // namespace prep
