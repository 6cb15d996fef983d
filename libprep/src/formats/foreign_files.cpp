#include "formats/foreign_files.h"

#include "formats/reader_backend.h"
#include "libraries/companion_library.h"
#include "libraries/macro_text.h"

// With Assimp and OpenMesh the loader has 46,000 addresses to fill in that it does not have without
// them, a quarter of what it takes to start the command, which has a process of its own read these
// files.

namespace prep::detail {
namespace {

const Result<const ReaderBackend*>& readers() {
    static const Result<const ReaderBackend*> opened =
        open_companion<ReaderBackend>({"libprep_readers.so", MESHPREP_TEXT(MESHPREP_READER_BACKEND),
                                       "the library with Assimp and OpenMesh"});
    return opened;
}

}  // namespace

Result<void> open_foreign_readers() {
    const auto& library = readers();
    return library ? Result<void>() : Result<void>(library.error());
}

Result<Scene> load_om(std::span<const std::byte> bytes, const std::filesystem::path& path) {
    const auto& library = readers();
    return library ? (*library)->om(bytes, path) : Result<Scene>(library.error());
}

Result<Scene> load_with_assimp(const std::filesystem::path& path, const LoadOptions& options) {
    const auto& library = readers();
    return library ? (*library)->with_assimp(path, options) : Result<Scene>(library.error());
}

Result<bool> assimp_reads(const std::string& extension) {
    if (extension.size() < 2) return false;
    const auto& library = readers();
    return library ? Result<bool>((*library)->assimp_knows(extension))
                   : Result<bool>(library.error());
}

}  // namespace prep::detail
