#include "meshprep/files/archive.h"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "prep/files.h"

namespace meshprep {
namespace {

namespace fs = std::filesystem;
using prep::Error;
using prep::ErrorCode;
using prep::Result;
using Bytes = std::span<const std::byte>;

std::string mebibytes(std::uint64_t bytes) {
    return std::to_string(bytes >> 20) + " MiB";
}

Error too_large(std::uint64_t most, const std::string& place) {
    return {ErrorCode::limit,
            "it unpacks to more than " + mebibytes(most) +
                ", which is more than meshes do (200 times the packed size); unpack it yourself if "
                "you trust it",
            place};
}

// A new file that is written from start to end.
class NewFile {
  public:
    ~NewFile() {
        if (fd_ >= 0) ::close(fd_);
    }
    Result<void> open(const fs::path& path) {
        path_ = path;
        fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
        return fd_ >= 0 ? Result<void>() : failure();
    }
    Result<void> write(Bytes bytes) {
        while (!bytes.empty()) {
            const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) return failure();
            bytes = bytes.subspan(std::size_t(n));
        }
        return {};
    }
    // File systems of networks may say only now that something was not written.
    Result<void> close() {
        return ::close(std::exchange(fd_, -1)) == 0 ? Result<void>() : failure();
    }

  private:
    Result<void> failure() const {
        return Error{
            ErrorCode::io,
            std::string("cannot unpack to here: ") + std::strerror(errno) + "; TMPDIR says where",
            path_.string()};
    }
    fs::path path_;
    int fd_ = -1;
};

// A stream being inflated: deflate's own bytes or gzip's.
class Inflater {
  public:
    explicit Inflater(int window_bits) { good_ = ::inflateInit2(&stream_, window_bits) == Z_OK; }
    ~Inflater() { ::inflateEnd(&stream_); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    enum class End { complete, damaged, cut_short, too_large };
    // One stream from the start of `in`, of which the bytes read are dropped; `put` gets at most
    // `most` bytes and is counted in `count`.
    template <class Put>
    Result<End> run(Bytes& in, std::uint64_t most, std::uint64_t& count, const Put& put) {
        if (!good_ || ::inflateReset(&stream_) != Z_OK) return End::damaged;
        for (;;) {
            const auto piece =
                std::min<std::size_t>(in.size(), std::numeric_limits<uInt>::max() / 2);
            stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(in.data()));
            stream_.avail_in = uInt(piece);
            stream_.next_out = reinterpret_cast<Bytef*>(buffer_.data());
            stream_.avail_out = uInt(buffer_.size());
            const int state = ::inflate(&stream_, Z_NO_FLUSH);
            in = in.subspan(piece - stream_.avail_in);
            const std::size_t got = buffer_.size() - stream_.avail_out;
            if (got > most - count) return End::too_large;
            count += got;
            if (Result<void> done = put(Bytes(buffer_.data(), got)); !done) return done.error();
            if (state == Z_STREAM_END) return End::complete;
            if (state == Z_BUF_ERROR || (state == Z_OK && in.empty() && got == 0))
                return End::cut_short;
            if (state != Z_OK) return End::damaged;
        }
    }

  private:
    z_stream stream_{};
    bool good_ = false;
    std::vector<std::byte> buffer_ = std::vector<std::byte>(std::size_t(256) << 10);
};

std::uint32_t u16(Bytes b, std::size_t at) {
    return std::to_integer<std::uint32_t>(b[at]) | std::to_integer<std::uint32_t>(b[at + 1]) << 8;
}
std::uint32_t u32(Bytes b, std::size_t at) {
    return u16(b, at) | u16(b, at + 2) << 16;
}

// An entry of the central directory.
struct Entry {
    std::string name;
    std::uint32_t flags = 0, method = 0, crc = 0, packed = 0, size = 0, mode = 0, header = 0;
};

class Zip {
  public:
    Zip(Bytes bytes, std::string place) : bytes_(bytes), place_(std::move(place)) {}

    Result<std::vector<Entry>> entries() const {
        const std::optional<std::size_t> end = find_end();
        if (!end)
            return error(ErrorCode::syntax,
                         "this is no zip file, or its end is missing: it may be cut short");
        const std::uint32_t count = u16(bytes_, *end + 10), size = u32(bytes_, *end + 12);
        const std::uint32_t start = u32(bytes_, *end + 16);
        if (count == 0xffff || size == 0xffffffff || start == 0xffffffff)
            return error(ErrorCode::unsupported,
                         "it is a ZIP64 archive, which is not read; unpack it first");
        if (u16(bytes_, *end + 4) != 0 || u16(bytes_, *end + 8) != count)
            return error(ErrorCode::unsupported,
                         "it is one part of several; join them or unpack them first");
        if (std::uint64_t(start) + size > *end) return damaged();
        std::vector<Entry> list;
        std::size_t at = start;
        for (std::uint32_t n = 0; n < count; ++n) {
            if (at + 46 > *end || u32(bytes_, at) != 0x02014b50) return damaged();
            Entry e;
            e.flags = u16(bytes_, at + 8);
            e.method = u16(bytes_, at + 10);
            e.crc = u32(bytes_, at + 16);
            e.packed = u32(bytes_, at + 20);
            e.size = u32(bytes_, at + 24);
            e.mode = u16(bytes_, at + 4) >> 8 == 3 ? u32(bytes_, at + 38) >> 16 : 0;
            e.header = u32(bytes_, at + 42);
            const std::size_t name = u16(bytes_, at + 28);
            const std::size_t next = at + 46 + name + u16(bytes_, at + 30) + u16(bytes_, at + 32);
            if (next > *end) return damaged();
            e.name.assign(reinterpret_cast<const char*>(bytes_.data()) + at + 46, name);
            std::replace(e.name.begin(), e.name.end(), '\\', '/');
            list.push_back(std::move(e));
            at = next;
        }
        return list;
    }

    // Why an entry is not unpacked.
    std::optional<Error> refusal(const Entry& e) const {
        const auto refuse = [&](ErrorCode code, const std::string& why) {
            return Error{code, why, place_ + "/" + e.name};
        };
        if (e.name.empty() || e.name.find('\0') != std::string::npos)
            return refuse(ErrorCode::invalid,
                          "an entry has no usable name; the archive is damaged");
        const fs::path path = e.name;
        const bool drive = e.name.size() > 1 && e.name[1] == ':';
        if (path.is_absolute() || drive)
            return refuse(
                ErrorCode::invalid,
                "an entry has an absolute name and would be written outside; do not trust "
                "this archive");
        for (const fs::path& part : path)
            if (part == "..")
                return refuse(
                    ErrorCode::invalid,
                    "an entry's name leads out of the archive with '..'; do not trust this "
                    "archive");
        if ((e.mode & 0170000) == 0120000)
            return refuse(ErrorCode::invalid,
                          "an entry is a link, which is not followed; unpack it yourself if you "
                          "trust it");
        if (e.flags & 1)
            return refuse(ErrorCode::unsupported, "an entry is encrypted; unpack it first");
        if (e.method != 0 && e.method != 8)
            return refuse(
                ErrorCode::unsupported,
                "an entry is packed by method " + std::to_string(e.method) +
                    ", and only stored (0) and deflated (8) ones are read; unpack it first");
        return std::nullopt;
    }

    Result<void> unpack(const Entry& e, const fs::path& to) const {
        if (std::size_t(e.header) + 30 > bytes_.size() || u32(bytes_, e.header) != 0x04034b50)
            return damaged(e);
        const std::size_t start =
            std::size_t(e.header) + 30 + u16(bytes_, e.header + 26) + u16(bytes_, e.header + 28);
        if (start + e.packed > bytes_.size()) return damaged(e);
        Bytes in = bytes_.subspan(start, e.packed);
        NewFile file;
        if (Result<void> opened = file.open(to); !opened) return opened;
        uLong crc = ::crc32(0, nullptr, 0);
        std::uint64_t count = 0;
        const auto put = [&](Bytes piece) {
            crc = ::crc32_z(crc, reinterpret_cast<const Bytef*>(piece.data()), piece.size());
            return file.write(piece);
        };
        if (e.method == 0) {
            if (Result<void> done = put(in); !done) return done;
            count = in.size();
        } else {
            Inflater inflater(-MAX_WBITS);
            const Result<Inflater::End> end = inflater.run(in, e.size, count, put);
            if (!end) return end.error();
            if (*end != Inflater::End::complete) return damaged(e);
        }
        if (count != e.size || crc != e.crc) return damaged(e);
        return file.close();
    }

  private:
    // The last record, which a comment may follow.
    std::optional<std::size_t> find_end() const {
        constexpr std::size_t length = 22, longest_comment = 0xffff;
        if (bytes_.size() < length) return std::nullopt;
        const std::size_t last = bytes_.size() - length;
        const std::size_t first = last > longest_comment ? last - longest_comment : 0;
        for (std::size_t at = last + 1; at-- > first;)
            if (u32(bytes_, at) == 0x06054b50 &&
                at + length + u16(bytes_, at + 20) <= bytes_.size())
                return at;
        return std::nullopt;
    }
    Error error(ErrorCode code, const std::string& text) const { return {code, text, place_}; }
    Error damaged() const {
        return error(ErrorCode::syntax, "its list of entries is damaged; fetch it again");
    }
    Error damaged(const Entry& e) const {
        return {ErrorCode::syntax, "this entry is damaged or cut short; fetch the archive again",
                place_ + "/" + e.name};
    }

    Bytes bytes_;
    std::string place_;
};

bool wanted(const Entry& e) {
    // What macOS adds to archives: its folder, and "._NAME" beside each NAME.
    return !e.name.ends_with('/') && !e.name.starts_with("__MACOSX/") &&
           !fs::path(e.name).filename().string().starts_with("._");
}

}  // namespace

std::uint64_t ArchiveLimits::of(std::uint64_t packed) const {
    const std::uint64_t scaled = packed > most / ratio ? most : packed * ratio;
    return std::min(most, std::max(always, scaled));
}

bool is_gzip(Bytes head) {
    return head.size() > 2 && u16(head, 0) == 0x8b1f && head[2] == std::byte{8};
}

bool is_zip(Bytes head) {
    return head.size() > 3 && (u32(head, 0) == 0x04034b50 || u32(head, 0) == 0x06054b50);
}

Result<std::uint64_t> unpack_gzip(const fs::path& archive, const fs::path& to,
                                  const ArchiveLimits& limits) {
    const Result<std::vector<std::byte>> bytes = prep::read_file(archive);
    if (!bytes) return bytes.error();
    Bytes in = *bytes;
    if (!is_gzip(in))
        return Error{ErrorCode::syntax, "this is no gzip file, whatever its ending says",
                     archive.string()};
    const std::uint64_t most = limits.of(in.size());
    NewFile file;
    if (Result<void> opened = file.open(to); !opened) return opened.error();
    std::uint64_t count = 0;
    Inflater inflater(16 + MAX_WBITS);
    // Members stand in a row, and some may be empty; zeros that pad the last one are nothing.
    while (is_gzip(in)) {
        const Result<Inflater::End> end =
            inflater.run(in, most, count, [&](Bytes piece) { return file.write(piece); });
        if (!end) return end.error();
        if (*end == Inflater::End::too_large) return too_large(most, archive.string());
        if (*end == Inflater::End::cut_short)
            return Error{ErrorCode::syntax, "the gzip file is cut short; fetch it again",
                         archive.string()};
        if (*end == Inflater::End::damaged)
            return Error{ErrorCode::syntax, "the gzip file is damaged; fetch it again",
                         archive.string()};
    }
    if (Result<void> closed = file.close(); !closed) return closed.error();
    const bool padding =
        std::all_of(in.begin(), in.end(), [](std::byte b) { return b == std::byte{0}; });
    return padding ? 0 : std::uint64_t(in.size());
}

Result<std::vector<std::string>> unpack_zip(const fs::path& archive, const fs::path& directory,
                                            const ArchiveLimits& limits) {
    const Result<std::vector<std::byte>> bytes = prep::read_file(archive);
    if (!bytes) return bytes.error();
    const Zip zip(*bytes, archive.string());
    const Result<std::vector<Entry>> entries = zip.entries();
    if (!entries) return entries.error();
    std::uint64_t total = 0;
    for (const Entry& e : *entries) {
        if (std::optional<Error> refused = zip.refusal(e)) return *std::move(refused);
        total += wanted(e) ? e.size : 0;
    }
    if (const std::uint64_t most = limits.of(bytes->size()); total > most)
        return too_large(most, archive.string());
    std::vector<std::string> names;
    for (const Entry& e : *entries) {
        if (!wanted(e)) continue;
        const fs::path to = directory / e.name;
        std::error_code ec;
        fs::create_directories(to.parent_path(), ec);
        if (ec)
            return Error{ErrorCode::io, "cannot make a directory for this entry: " + ec.message(),
                         archive.string() + "/" + e.name};
        if (fs::exists(to, ec))
            return Error{ErrorCode::invalid,
                         "two entries have this name; unpack it yourself to choose one",
                         archive.string() + "/" + e.name};
        if (Result<void> done = zip.unpack(e, to); !done) return done.error();
        names.push_back(e.name);
    }
    return names;
}

}  // namespace meshprep
