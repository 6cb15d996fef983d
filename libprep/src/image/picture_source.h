// The bytes of a picture, one after the other: of memory, or of a file as they are needed.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "image/picture_kind.h"

namespace prep::detail {

class PictureSource {
  public:
    explicit PictureSource(std::span<const std::byte> bytes) : rest_(bytes), size_(bytes.size()) {
        head_size_ = std::min(bytes.size(), head_.size());
        std::copy_n(bytes.begin(), head_size_, head_.begin());
    }
    // Nothing where it is no file or cannot be read.
    static std::optional<PictureSource> open(const std::filesystem::path& path);

    std::uint64_t size() const { return size_; }
    // The first bytes, wherever it stands.
    std::span<const std::byte> head() const { return std::span(head_).first(head_size_); }
    // As many as there are, `count` at most.
    std::size_t read(void* to, std::size_t count) noexcept;

  private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    PictureSource() = default;

    std::unique_ptr<std::FILE, Close> file_;  // or
    std::span<const std::byte> rest_;         // without one
    std::uint64_t size_ = 0;
    std::array<std::byte, picture_head> head_{};
    std::size_t head_size_ = 0;
};

}  // namespace prep::detail
