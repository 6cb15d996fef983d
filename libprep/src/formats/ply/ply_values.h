// The values of a PLY file one after the other, from text or from bytes of either order.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "formats/ply/ply_header.h"
#include "text/scan.h"

namespace prep::detail {

class PlyValues {
  public:
    PlyValues(std::span<const std::byte> bytes, PlyEncoding encoding, std::size_t at)
        : bytes_(bytes), encoding_(encoding), at_(at) {}

    bool next(PlyType type, double& value) {
        return encoding_ == PlyEncoding::ascii ? next_text(value) : next_binary(type, value);
    }
    // Where the last value stood: ":line" in text, ", byte N" behind it in binary files.
    std::string place() const {
        if (encoding_ != PlyEncoding::ascii) return ", byte " + std::to_string(at_);
        const auto* data = reinterpret_cast<const char*>(bytes_.data());
        return ":" + std::to_string(1 + std::count(data, data + at_, '\n'));
    }
    std::span<const std::byte> rest() const { return bytes_.subspan(at_); }
    std::size_t left() const { return bytes_.size() - at_; }
    bool skip(std::size_t bytes) {
        if (bytes > left()) return false;
        at_ += bytes;
        return true;
    }

    // One list's length, checked against the bytes that are left.
    bool list_length(const PlyProperty& p, std::uint64_t& length) {
        double value;
        if (!next(p.count_type, value) || !(value >= 0) || value != std::floor(value)) return false;
        const std::size_t each = encoding_ == PlyEncoding::ascii ? 2 : size_of(p.type);
        if (value > double((left() + 1) / each)) return false;
        length = std::uint64_t(value);
        return true;
    }
    bool skip(const PlyProperty& p) {
        double value;
        if (!p.list) return next(p.type, value);
        std::uint64_t length = 0;
        if (!list_length(p, length)) return false;
        if (encoding_ != PlyEncoding::ascii) return skip(length * size_of(p.type));
        for (std::uint64_t k = 0; k < length; ++k)
            if (!next(p.type, value)) return false;
        return true;
    }

    // Text with a line for each element, as the format has it: what a line holds beyond the
    // properties that the header names is passed over. An element may go on in the next line, and
    // lines may follow the last; with fewer lines than elements they are read value by value.
    void expect_lines(double elements) {
        if (encoding_ != PlyEncoding::ascii) return;
        const char* data = reinterpret_cast<const char*>(bytes_.data());
        double lines = 0;
        for (std::size_t at = at_; at < bytes_.size() && lines <= elements;) {
            const void* const end = std::memchr(data + at, '\n', bytes_.size() - at);
            const std::size_t next =
                end ? std::size_t(static_cast<const char*>(end) - data) + 1 : bytes_.size();
            lines += std::any_of(data + at, data + next, [](char c) { return !is_space(c); });
            at = next;
        }
        by_line_ = lines >= elements;
    }
    void end_element() {
        if (!by_line_) return;
        const char* data = reinterpret_cast<const char*>(bytes_.data());
        bool more = false;
        for (; at_ < bytes_.size() && data[at_] != '\n'; ++at_) more |= !is_space(data[at_]);
        long_lines_ += more;
    }
    std::uint64_t long_lines() const { return long_lines_; }
    // Of what follows the last value that was read, but for blanks and line ends around it.
    std::size_t left_over() const {
        const auto* data = reinterpret_cast<const char*>(bytes_.data());
        std::size_t begin = at_, end = bytes_.size();
        while (begin < end && is_space(data[begin])) ++begin;
        while (begin < end && is_space(data[end - 1])) --end;
        return end - begin;
    }

  private:
    static bool is_space(char c) { return is_blank(c) || c == '\n'; }

    bool next_text(double& value) {
        const char* data = reinterpret_cast<const char*>(bytes_.data());
        while (at_ < bytes_.size() && is_space(data[at_])) ++at_;
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && !is_space(data[at_])) ++at_;
        return LineScanner(data + begin, data + at_).number(value);
    }

    bool next_binary(PlyType type, double& value) {
        const std::size_t size = size_of(type);
        if (size > left()) return false;
        std::array<std::byte, 8> raw{};
        std::memcpy(raw.data(), bytes_.data() + at_, size);
        at_ += size;
        if (encoding_ == PlyEncoding::big) std::reverse(raw.begin(), raw.begin() + long(size));
        switch (type) {
            case PlyType::i8:
                value = as<std::int8_t>(raw);
                break;
            case PlyType::u8:
                value = as<std::uint8_t>(raw);
                break;
            case PlyType::i16:
                value = as<std::int16_t>(raw);
                break;
            case PlyType::u16:
                value = as<std::uint16_t>(raw);
                break;
            case PlyType::i32:
                value = as<std::int32_t>(raw);
                break;
            case PlyType::u32:
                value = as<std::uint32_t>(raw);
                break;
            case PlyType::f32:
                value = double(as<float>(raw));
                break;
            case PlyType::f64:
                value = as<double>(raw);
                break;
        }
        return true;
    }

    template <class T>
    static T as(const std::array<std::byte, 8>& raw) {
        T value;
        std::memcpy(&value, raw.data(), sizeof value);
        return value;
    }

    std::span<const std::byte> bytes_;
    PlyEncoding encoding_;
    std::size_t at_;
    bool by_line_ = false;
    std::uint64_t long_lines_ = 0;
};

}  // namespace prep::detail
