#include "image/picture_source.h"

#include <algorithm>
#include <cstring>

namespace prep::detail {

std::optional<PictureSource> PictureSource::open(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
    PictureSource source;
    source.size_ = std::filesystem::file_size(path, error);
    if (error) return std::nullopt;
    source.file_.reset(std::fopen(path.c_str(), "rbe"));
    if (!source.file_) return std::nullopt;
    std::FILE* const file = source.file_.get();
    source.head_size_ = std::fread(source.head_.data(), 1, source.head_.size(), file);
    if (std::fseek(file, 0, SEEK_SET) != 0) return std::nullopt;
    return source;
}

std::size_t PictureSource::read(void* to, std::size_t count) noexcept {
    if (file_) return std::fread(to, 1, count, file_.get());
    const std::size_t there = std::min(count, rest_.size());
    if (there > 0) std::memcpy(to, rest_.data(), there);
    rest_ = rest_.subspan(there);
    return there;
}

}  // namespace prep::detail
