// The binary part of a glTF file, in pieces: what is in memory in the file's form already is
// written from where it is.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "base/shared_bytes.h"

namespace prep::detail {

class BinaryParts {
  public:
    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }

    // Copies them.
    void append(std::span<const std::byte> bytes) {
        if (bytes.size() >= large) {
            take(SharedBytes(std::vector(bytes.begin(), bytes.end())));
            return;
        }
        if (pieces_.empty() || !pieces_.back().large.empty()) pieces_.emplace_back();
        std::vector<std::byte>& own = pieces_.back().small;
        own.insert(own.end(), bytes.begin(), bytes.end());
        size_ += bytes.size();
    }
    // Large ones stay where they are; what SharedBytes::lent() are must outlive this object.
    void take(SharedBytes bytes) {
        if (bytes.size() < large) return append(bytes);
        size_ += bytes.size();
        pieces_.push_back({{}, std::move(bytes)});
    }
    // Zeros up to a multiple of four.
    void pad() {
        constexpr std::byte zeros[3] = {};
        append({zeros, (4 - size_ % 4) % 4});
    }

    // In order; they refer to this object.
    std::vector<std::span<const std::byte>> parts() const {
        std::vector<std::span<const std::byte>> all;
        for (const Piece& piece : pieces_)
            all.push_back(piece.large.empty() ? std::span<const std::byte>(piece.small)
                                              : std::span<const std::byte>(piece.large));
        return all;
    }
    std::vector<std::byte> joined() const {
        std::vector<std::byte> all;
        all.reserve(size_);
        for (const auto& part : parts()) all.insert(all.end(), part.begin(), part.end());
        return all;
    }

  private:
    static constexpr std::size_t large = 1 << 16;
    // One of both.
    struct Piece {
        std::vector<std::byte> small;  // several, one after the other
        SharedBytes large;
    };
    std::vector<Piece> pieces_;
    std::size_t size_ = 0;
};

}  // namespace prep::detail
