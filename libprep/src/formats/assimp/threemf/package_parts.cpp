#include "formats/assimp/threemf/package_parts.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "text/lower_case.h"

namespace prep::detail {
namespace {

using Bytes = std::span<const std::byte>;

// Whoever asks has looked whether they are there.
std::uint64_t number(Bytes bytes, std::size_t at, std::size_t width) {
    std::uint64_t value = 0;
    for (std::size_t i = width; i-- > 0;)
        value = value << 8 | std::to_integer<std::uint64_t>(bytes[at + i]);
    return value;
}

struct Directory {
    std::uint64_t start = 0, size = 0;
};

// What the record at the end says, which a comment of up to 65,535 bytes may follow.
std::optional<Directory> find_directory(Bytes bytes) {
    constexpr std::size_t record = 22, longest_comment = 65535, locator = 20, record64 = 56;
    if (bytes.size() < record) return std::nullopt;
    const std::size_t last = bytes.size() - record;
    for (std::size_t back = 0; back <= std::min(last, longest_comment); ++back) {
        const std::size_t at = last - back;
        if (number(bytes, at, 4) != 0x06054b50) continue;
        Directory found{number(bytes, at + 16, 4), number(bytes, at + 12, 4)};
        if (at >= locator && number(bytes, at - locator, 4) == 0x07064b50) {
            const std::uint64_t at64 = number(bytes, at - locator + 8, 8);
            if (at64 > at - locator || at - locator - at64 < record64 ||
                number(bytes, at64, 4) != 0x06064b50)
                return std::nullopt;
            found = {number(bytes, at64 + 48, 8), number(bytes, at64 + 40, 8)};
        }
        if (found.start > at || found.size > at - found.start) return std::nullopt;
        return found;
    }
    return std::nullopt;
}

std::string key_of(std::string_view name) {
    std::string key = lower_case(name);
    std::replace(key.begin(), key.end(), '\\', '/');
    key.erase(0, std::min(key.find_first_not_of('/'), key.size()));
    return key;
}

// ZIP64's extra field has in this order what is too large for its own place.
bool take_zip64(Bytes extra, std::initializer_list<std::uint64_t*> fields) {
    while (extra.size() >= 4) {
        const std::size_t size = number(extra, 2, 2);
        if (size > extra.size() - 4) return false;
        if (number(extra, 0, 2) == 1) {
            std::size_t at = 4;
            for (std::uint64_t* const field : fields) {
                if (*field != 0xffffffff) continue;
                if (at + 8 > 4 + size) return false;
                *field = number(extra, at, 8);
                at += 8;
            }
            return true;
        }
        extra = extra.subspan(4 + size);
    }
    return true;
}

// Into `to`, which has the size that the archive tells. False: the stream is damaged or has
// another.
bool inflate_all(Bytes packed, std::vector<std::byte>& to) {
    z_stream stream{};
    if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) return false;
    std::byte none{};
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(packed.data()));
    stream.avail_in = uInt(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(to.empty() ? &none : to.data());
    stream.avail_out = uInt(to.size());
    const int state = ::inflate(&stream, Z_FINISH);
    const bool complete = state == Z_STREAM_END && stream.avail_out == 0;
    ::inflateEnd(&stream);
    return complete;
}

}  // namespace

Result<PackageParts> PackageParts::of(std::vector<std::byte> bytes, const std::string& place) {
    PackageParts parts;
    parts.bytes_ = std::move(bytes);
    parts.place_ = place;
    const Bytes all = parts.bytes_;
    const Error damaged{ErrorCode::syntax, "its list of parts is missing or damaged", place};
    const auto directory = find_directory(all);
    if (!directory) return damaged;
    Bytes rest = all.subspan(directory->start, directory->size);
    constexpr std::size_t head = 46;
    while (!rest.empty()) {
        if (rest.size() < head || number(rest, 0, 4) != 0x02014b50) return damaged;
        const std::size_t name = number(rest, 28, 2), extra = number(rest, 30, 2);
        const std::size_t size = head + name + extra + number(rest, 32, 2);
        if (size > rest.size()) return damaged;
        Entry entry;
        entry.flags = std::uint32_t(number(rest, 8, 2));
        entry.method = std::uint32_t(number(rest, 10, 2));
        entry.crc = std::uint32_t(number(rest, 16, 4));
        entry.packed = number(rest, 20, 4);
        entry.size = number(rest, 24, 4);
        entry.header = number(rest, 42, 4);
        if (!take_zip64(rest.subspan(head + name, extra),
                        {&entry.size, &entry.packed, &entry.header}))
            return damaged;
        const auto* const text = reinterpret_cast<const char*>(rest.data()) + head;
        if (!parts.entries_.emplace(key_of({text, name}), entry).second)
            return Error{ErrorCode::syntax, "two of its parts have one name", place};
        rest = rest.subspan(size);
    }
    return parts;
}

bool PackageParts::has(std::string_view name) const {
    return entries_.contains(key_of(name));
}

Result<std::vector<std::byte>> PackageParts::unpack(std::string_view name) const {
    constexpr std::uint64_t always = std::uint64_t(64) << 20, ratio = 200,
                            most = std::numeric_limits<uInt>::max();
    const std::string place = place_ + (name.starts_with('/') ? "" : "/") + std::string(name);
    const auto found = entries_.find(key_of(name));
    if (found == entries_.end())
        return Error{ErrorCode::invalid, "the package has no such part", place};
    const Entry& entry = found->second;
    const Bytes all = bytes_;
    if ((entry.flags & 1) != 0 || (entry.method != 0 && entry.method != 8))
        return Error{ErrorCode::unsupported,
                     "a part is encrypted, or packed in another way than deflated or stored: save "
                     "the file anew",
                     place};
    const Error damaged{ErrorCode::syntax, "a part of the package is damaged", place};
    constexpr std::size_t head = 30;
    if (entry.header > all.size() || all.size() - entry.header < head ||
        number(all, entry.header, 4) != 0x04034b50)
        return damaged;
    const std::uint64_t start =
        entry.header + head + number(all, entry.header + 26, 2) + number(all, entry.header + 28, 2);
    if (start > all.size() || entry.packed > all.size() - start) return damaged;
    if (entry.size > most || entry.packed > most ||
        (entry.size > always && entry.size > ratio * entry.packed))
        return Error{ErrorCode::limit,
                     "a part unpacks to " + std::to_string(entry.size) +
                         " bytes, which is more than meshes do (200 times the packed size, at most "
                         "4 GiB)",
                     place};
    if (unpacked_ + entry.size > std::max(always, ratio * all.size()))
        return Error{ErrorCode::limit,
                     "the package's parts together unpack to more than 200 times its size", place};
    unpacked_ += entry.size;
    const Bytes packed = all.subspan(start, entry.packed);
    std::vector<std::byte> out;
    if (entry.method == 0) {
        if (entry.size != entry.packed) return damaged;
        out.assign(packed.begin(), packed.end());
    } else {
        out.resize(entry.size);
        if (!inflate_all(packed, out)) return damaged;
    }
    if (::crc32_z(::crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(out.data()), out.size()) !=
        entry.crc)
        return damaged;
    return out;
}

}  // namespace prep::detail
