#include "meshprep/files/file_sizes.h"

#include <set>

#include "prep/files.h"

namespace meshprep {

std::uint64_t bytes_of(const std::filesystem::path& file) {
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(file, failed);
    return failed ? 0 : bytes;
}

std::uint64_t bytes_of(const std::filesystem::path& file, const prep::Scene& scene) {
    std::set<std::filesystem::path> files(scene.libraries.begin(), scene.libraries.end());
    files.insert(file);
    for (const prep::ImageRef& image : scene.images)
        for (std::filesystem::path& picture : prep::files_of(image))
            files.insert(std::move(picture));
    std::uint64_t bytes = 0;
    for (const std::filesystem::path& one : files) bytes += bytes_of(one);
    return bytes;
}

}  // namespace meshprep
