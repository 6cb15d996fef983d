#include "image/openimageio/completeness.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <vector>

namespace prep::detail {
namespace {

// Bytes one after the other, fetched in blocks.
class Cursor {
  public:
    explicit Cursor(const ByteSource& file) : file_(file), block_(1 << 16) {}
    // The next byte; −1 at the end or where it cannot be read.
    int next() {
        if (at_ >= file_.size) return -1;
        if (at_ < begin_ || at_ >= end_) {
            const auto count = std::min<std::uint64_t>(block_.size(), file_.size - at_);
            if (!file_.read(at_, std::span(block_).first(std::size_t(count)))) return -1;
            begin_ = at_;
            end_ = at_ + count;
        }
        return std::to_integer<int>(block_[std::size_t(at_++ - begin_)]);
    }
    void skip(std::uint64_t count) { at_ += std::min(count, file_.size - at_); }

  private:
    const ByteSource& file_;
    std::vector<std::byte> block_;
    std::uint64_t at_ = 0, begin_ = 0, end_ = 0;
};

constexpr int start_of_image = 0xd8, end_of_image = 0xd9, start_of_scan = 0xda;

bool stands_alone(int marker) {
    return marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8);
}

std::string missing_of_jpeg(const ByteSource& file) {
    const std::string cut = "the file ends before the picture does";
    Cursor bytes(file);
    bytes.skip(2);
    bool in_scan = false;
    for (;;) {
        int byte = bytes.next();
        if (in_scan)
            while (byte >= 0 && byte != 0xff) byte = bytes.next();
        if (byte < 0) return cut;
        if (byte != 0xff) return {};  // not a marker where one must be: for the decoder to say
        while (byte == 0xff) byte = bytes.next();  // fill bytes
        if (byte < 0) return cut;
        if (byte == end_of_image) return {};
        if ((in_scan && byte == 0) || stands_alone(byte)) continue;
        const int high = bytes.next(), low = bytes.next();
        if (low < 0) return cut;
        if (high * 256 + low < 2) return {};
        bytes.skip(std::uint64_t(high * 256 + low - 2));
        // Tables may stand between scans; their bytes are skipped by their length as well.
        in_scan |= byte == start_of_scan;
    }
}

// Fields of a TIFF directory, in either byte order and either width.
class Tiff {
  public:
    // `all`: every value counts, not only what leads to the pixels.
    Tiff(const ByteSource& file, bool all) : file_(file), all_(all) {}

    std::string missing() {
        std::array<std::byte, 8> head{};
        if (file_.size < head.size() || !file_.read(0, head))
            return all_ ? cut("its beginning") : std::string();
        big_endian_ = head[0] == std::byte('M');
        const auto magic = number(2, 2);
        big_ = magic == 43;
        if (magic != 42 && !big_) return {};
        const auto directory = number(big_ ? 8 : 4, big_ ? 8 : 4);
        if (!directory) return cut("its directory");
        const auto fields = number(*directory, big_ ? 8 : 2);
        if (!fields) return cut("its directory");
        const std::uint64_t entry = big_ ? 20 : 12;
        if (*fields > file_.size / entry) return cut("its directory");
        for (std::uint64_t i = 0; i < *fields; ++i)
            if (!note(*directory + (big_ ? 8 : 2) + i * entry)) return cut("its directory");
        if (all_ && (offsets_.count == 0 || counts_.count == 0)) return cut("its directory");
        return strips();
    }

  private:
    struct Field {
        std::uint64_t type = 0, count = 0, at = 0;  // `at`: where the values stand
    };

    static std::string cut(const std::string& what) {
        return what + " lies beyond the end of the file";
    }

    std::optional<std::uint64_t> number(std::uint64_t at, std::uint64_t width) const {
        std::array<std::byte, 8> raw{};
        if (width > file_.size || at > file_.size - width) return std::nullopt;
        if (!file_.read(at, std::span(raw).first(std::size_t(width)))) return std::nullopt;
        std::uint64_t value = 0;
        for (std::uint64_t i = 0; i < width; ++i)
            value = value << 8 | std::to_integer<std::uint64_t>(
                                     raw[std::size_t(big_endian_ ? i : width - 1 - i)]);
        return value;
    }

    // Of a value of any type; 0 where there is no such type.
    static std::uint64_t bytes_of(std::uint64_t type) {
        constexpr std::uint8_t bytes[] = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
        return type < std::size(bytes) ? bytes[type] : 0;
    }

    static std::uint64_t width_of(std::uint64_t type) {
        switch (type) {
            case 1:
                return 1;
            case 3:
                return 2;
            case 4:
            case 13:
                return 4;
            case 16:
            case 18:
                return 8;
            default:
                return 0;  // not one that counts or places
        }
    }

    bool note(std::uint64_t at) {
        const auto tag = number(at, 2), type = number(at + 2, 2);
        const auto count = number(at + 4, big_ ? 8 : 4);
        const std::uint64_t inside = big_ ? 8 : 4, values = at + 4 + inside;
        if (!tag || !type || !count) return false;
        if (const std::uint64_t each = bytes_of(*type);
            all_ && each > 0 && *count > inside / each) {
            const auto first = number(values, inside);
            if (!first || *first > file_.size || *count > (file_.size - *first) / each)
                return false;
        }
        Field field{*type, *count, values};
        const std::uint64_t width = width_of(*type);
        if (width == 0) return true;
        if (*count > inside / width) {
            const auto elsewhere = number(values, inside);
            if (!elsewhere) return false;
            field.at = *elsewhere;
        }
        switch (*tag) {
            case 256:
                columns_ = field;
                break;
            case 257:
                rows_ = field;
                break;
            case 258:
                bits_ = field;
                break;
            case 259:
                compression_ = field;
                break;
            case 273:
            case 324:
                offsets_ = field;
                break;
            case 277:
                samples_ = field;
                break;
            case 278:
                rows_per_strip_ = field;
                break;
            case 279:
            case 325:
                counts_ = field;
                break;
            case 284:
                planes_ = field;
                break;
            default:
                break;
        }
        tiled_ |= *tag == 324;
        return true;
    }

    std::optional<std::uint64_t> value(const Field& field, std::uint64_t index) const {
        if (index >= field.count) return std::nullopt;
        const std::uint64_t width = width_of(field.type);
        return number(field.at + index * width, width);
    }

    // Writers exist that give the last strip of an uncompressed picture the count of a full one.
    std::uint64_t most(std::uint64_t strip) const {
        constexpr std::uint64_t any = ~std::uint64_t(0);
        if (tiled_ || value(compression_, 0).value_or(1) != 1 || value(planes_, 0).value_or(1) != 1)
            return any;
        const std::uint64_t rows = value(rows_, 0).value_or(0);
        const std::uint64_t each = std::min(value(rows_per_strip_, 0).value_or(rows), rows);
        const std::uint64_t bits = value(columns_, 0).value_or(0) *
                                   std::min<std::uint64_t>(value(samples_, 0).value_or(1), 65536) *
                                   std::min<std::uint64_t>(value(bits_, 0).value_or(1), 64);
        if (rows == 0 || rows > 1u << 31 || strip * each >= rows) return any;
        return std::min(each, rows - strip * each) * ((bits + 7) / 8);
    }

    std::string strips() const {
        // Each has its place in the file's own bytes, so their number is bounded by them.
        const std::uint64_t count = std::min(offsets_.count, counts_.count);
        for (std::uint64_t i = 0; i < count; ++i) {
            const auto offset = value(offsets_, i), bytes = value(counts_, i);
            const std::string name = (tiled_ ? "tile " : "strip ") + std::to_string(i + 1) +
                                     " of " + std::to_string(count);
            if (!offset || !bytes) return cut("the list of its strips or tiles");
            // The directory is there first, with nothing in it yet.
            if (all_ && (*offset == 0 || *bytes == 0)) return cut(name);
            const std::uint64_t need = std::min(*bytes, most(i));
            if (need > 0 && (*offset > file_.size || need > file_.size - *offset)) return cut(name);
        }
        return {};
    }

    const ByteSource& file_;
    const bool all_;
    bool big_endian_ = false, big_ = false, tiled_ = false;
    Field columns_, rows_, bits_, compression_, samples_, rows_per_strip_, planes_, offsets_,
        counts_;
};

}  // namespace

std::string missing_part(const ByteSource& file) {
    std::array<std::byte, 4> head{};
    if (file.size < head.size() || !file.read(0, head)) return {};
    const auto is = [&](std::size_t at, int value) { return head[at] == std::byte(value); };
    if (is(0, 0xff) && is(1, start_of_image) && is(2, 0xff)) return missing_of_jpeg(file);
    if ((is(0, 'I') && is(1, 'I') && is(3, 0) && (is(2, 42) || is(2, 43))) ||
        (is(0, 'M') && is(1, 'M') && is(2, 0) && (is(3, 42) || is(3, 43))))
        return Tiff(file, false).missing();
    return {};
}

std::string missing_part_of_written_tiff(const ByteSource& file) {
    return Tiff(file, true).missing();
}

}  // namespace prep::detail
