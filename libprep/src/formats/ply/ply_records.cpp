#include "formats/ply/ply_records.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <type_traits>

namespace prep::detail {
namespace {

template <class T, bool big>
T value_at(const std::byte* at) {
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), at, sizeof raw);
    if constexpr (big) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

// The value at `at` and then one each `stride` bytes.
template <class T, bool big, class Out>
void read_column(const std::byte* at, std::size_t stride, std::size_t count, Out* values) {
    for (std::size_t i = 0; i < count; ++i, at += stride) values[i] = Out(value_at<T, big>(at));
}

template <bool big, class Out>
void read_column(PlyType type, const std::byte* at, std::size_t stride, std::size_t count,
                 Out* values) {
    switch (type) {
        case PlyType::i8:
            return read_column<std::int8_t, big>(at, stride, count, values);
        case PlyType::u8:
            return read_column<std::uint8_t, big>(at, stride, count, values);
        case PlyType::i16:
            return read_column<std::int16_t, big>(at, stride, count, values);
        case PlyType::u16:
            return read_column<std::uint16_t, big>(at, stride, count, values);
        case PlyType::i32:
            return read_column<std::int32_t, big>(at, stride, count, values);
        case PlyType::u32:
            return read_column<std::uint32_t, big>(at, stride, count, values);
        case PlyType::f32:
            if constexpr (std::is_floating_point_v<Out>)
                return read_column<float, big>(at, stride, count, values);
            break;
        case PlyType::f64:
            if constexpr (std::is_floating_point_v<Out>)
                return read_column<double, big>(at, stride, count, values);
            break;
    }
}

}  // namespace

std::optional<PlyRecords> PlyRecords::of(const PlyElement& element, PlyEncoding encoding,
                                         std::span<const std::byte> bytes) {
    if (encoding == PlyEncoding::ascii || element.count == 0) return std::nullopt;
    PlyRecords out;
    out.big_ = encoding == PlyEncoding::big;
    out.count_ = element.count;
    for (const PlyProperty& p : element.properties) {
        Field field{p.type, p.count_type, p.list, out.stride_, out.stride_, 1};
        if (p.list) {
            field.at += size_of(p.count_type);
            if (field.at > bytes.size()) return std::nullopt;
            std::int64_t length = 0;
            const std::byte* const at = bytes.data() + field.count_at;
            out.big_ ? read_column<true>(p.count_type, at, 0, 1, &length)
                     : read_column<false>(p.count_type, at, 0, 1, &length);
            if (length < 0) return std::nullopt;
            field.length = std::uint64_t(length);
        }
        if (field.at > bytes.size() || field.length > (bytes.size() - field.at) / size_of(p.type))
            return std::nullopt;
        out.stride_ = field.at + field.length * size_of(p.type);
        out.fields_.push_back(field);
    }
    if (out.stride_ == 0 || element.count > bytes.size() / out.stride_) return std::nullopt;
    out.bytes_ = bytes.first(out.size());
    return out;
}

bool PlyRecords::alike(std::size_t begin, std::size_t end) const {
    constexpr std::size_t block = 256;
    std::array<std::int64_t, block> lengths;
    for (const Field& field : fields_) {
        if (!field.list) continue;
        const Field count{field.count_type, {}, false, field.count_at, field.count_at, 1};
        for (std::size_t i = begin; i < end; i += block) {
            const std::size_t n = std::min(block, end - i);
            read_as(count, 0, i, i + n, lengths.data());
            for (std::size_t k = 0; k < n; ++k)
                if (lengths[k] != std::int64_t(field.length)) return false;
        }
    }
    return true;
}

template <class Out>
void PlyRecords::read_as(const Field& field, std::uint64_t k, std::size_t begin, std::size_t end,
                         Out* values) const {
    const std::byte* const at =
        bytes_.data() + begin * stride_ + field.at + k * size_of(field.type);
    big_ ? read_column<true>(field.type, at, stride_, end - begin, values)
         : read_column<false>(field.type, at, stride_, end - begin, values);
}

void PlyRecords::read(std::size_t property, std::uint64_t k, std::size_t begin, std::size_t end,
                      double* values) const {
    read_as(fields_[property], k, begin, end, values);
}

void PlyRecords::read(std::size_t property, std::uint64_t k, std::size_t begin, std::size_t end,
                      std::int64_t* values) const {
    read_as(fields_[property], k, begin, end, values);
}

}  // namespace prep::detail
