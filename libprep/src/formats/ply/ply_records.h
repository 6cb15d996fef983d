// Elements of a binary PLY file whose records are all laid out as the first one: what they hold is
// read at its place, in any order, on all threads. Nearly all large files are of this kind. Lists
// make others of different length; those are read value by value (ply_values.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "formats/ply/ply_header.h"

namespace prep::detail {

class PlyRecords {
  public:
    // Of the element whose first record `bytes` begin with. Nothing for text, and where the first
    // record's length, taken `count` times, is more than there is.
    static std::optional<PlyRecords> of(const PlyElement& element, PlyEncoding encoding,
                                        std::span<const std::byte> bytes);

    std::size_t size() const { return stride_ * count_; }  // bytes
    // How many values each record has of a property: 1, or the length of the first one's list.
    std::uint64_t length(std::size_t property) const { return fields_[property].length; }

    // Whether the lists of records begin … end - 1 are as long as the first record's. Only then,
    // and with those of all records before them, are they where read() takes them from.
    bool alike(std::size_t begin, std::size_t end) const;

    // The k-th value of a property of records begin … end - 1. As integers: those of integer
    // properties alone.
    void read(std::size_t property, std::uint64_t k, std::size_t begin, std::size_t end,
              double* values) const;
    void read(std::size_t property, std::uint64_t k, std::size_t begin, std::size_t end,
              std::int64_t* values) const;

  private:
    struct Field {
        PlyType type = PlyType::f32, count_type = PlyType::u8;
        bool list = false;
        std::size_t count_at = 0, at = 0;  // in the record
        std::uint64_t length = 1;
    };

    template <class Out>
    void read_as(const Field& field, std::uint64_t k, std::size_t begin, std::size_t end,
                 Out* values) const;

    std::span<const std::byte> bytes_;
    bool big_ = false;
    std::size_t stride_ = 0, count_ = 0;
    std::vector<Field> fields_;
};

}  // namespace prep::detail
