// The binary part of a glTF file, in pieces: what is in memory in the file's form already is
// written from where it is.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace prep::detail {

class BinaryParts {
  public:
    BinaryParts() = default;
    explicit BinaryParts(std::vector<std::byte> bytes) { take(std::move(bytes)); }

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }

    void append(std::span<const std::byte> bytes) {
        constexpr std::size_t large = 1 << 16;
        if (bytes.size() >= large) {
            take({bytes.begin(), bytes.end()});
            return;
        }
        if (pieces_.empty() || pieces_.back().closed) pieces_.emplace_back();
        std::vector<std::byte>& own = pieces_.back().own;
        own.insert(own.end(), bytes.begin(), bytes.end());
        size_ += bytes.size();
    }
    void take(std::vector<std::byte> bytes) {
        size_ += bytes.size();
        pieces_.push_back({std::move(bytes), {}, true});
    }
    // The bytes stay where they are, and must outlive this object.
    void lend(std::span<const std::byte> bytes) {
        size_ += bytes.size();
        pieces_.push_back({{}, bytes, true});
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
            all.push_back(piece.lent.empty() ? piece.own : piece.lent);
        return all;
    }
    std::vector<std::byte> joined() const {
        std::vector<std::byte> all;
        all.reserve(size_);
        for (const auto& part : parts()) all.insert(all.end(), part.begin(), part.end());
        return all;
    }

  private:
    struct Piece {
        std::vector<std::byte> own;
        std::span<const std::byte> lent;
        bool closed = false;  // nothing is added to it
    };
    std::vector<Piece> pieces_;
    std::size_t size_ = 0;
};

}  // namespace prep::detail
