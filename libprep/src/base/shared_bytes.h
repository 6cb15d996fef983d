// Bytes that do not change: copies and parts of them are the same bytes, which are there as long as
// any of these. Or lent ones, whose owner must outlive all of them.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace prep::detail {

class SharedBytes {
  public:
    SharedBytes() = default;
    SharedBytes(std::vector<std::byte> bytes) : SharedBytes(of(std::move(bytes))) {}

    // The elements of a container, which is kept.
    template <class Container>
    static SharedBytes of(Container values) {
        auto owner = std::make_shared<const Container>(std::move(values));
        SharedBytes made;
        made.bytes_ = std::as_bytes(std::span(owner->data(), owner->size()));
        made.owner_ = std::move(owner);
        return made;
    }
    static SharedBytes lent(std::span<const std::byte> bytes) {
        SharedBytes made;
        made.bytes_ = bytes;
        return made;
    }

    std::size_t size() const { return bytes_.size(); }
    bool empty() const { return bytes_.empty(); }
    const std::byte* data() const { return bytes_.data(); }
    auto begin() const { return bytes_.begin(); }
    auto end() const { return bytes_.end(); }
    std::byte operator[](std::size_t i) const { return bytes_[i]; }

    // offset + size: at most size().
    SharedBytes part(std::size_t offset, std::size_t size) const {
        SharedBytes made;
        made.bytes_ = bytes_.subspan(offset, size);
        made.owner_ = owner_;
        return made;
    }

  private:
    std::shared_ptr<const void> owner_;  // null: lent, or none
    std::span<const std::byte> bytes_;
};

}  // namespace prep::detail
