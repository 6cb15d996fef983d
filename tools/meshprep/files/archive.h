// Unpacking .gz and .zip files (RFC 1952; PKWARE's APPNOTE 6.3.3: stored and deflated entries).
//
// What unpacks to more than 64 MiB and to more than 200 times the packed size is refused, and so is
// what unpacks to more than 16 GiB: an archive that fills the disk is no mesh.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "prep/result.h"

namespace meshprep {

struct ArchiveLimits {
    std::uint64_t always = std::uint64_t(64) << 20;  // bytes that any archive may unpack to
    std::uint64_t ratio = 200;                       // beyond them, times the packed size
    std::uint64_t most = std::uint64_t(16) << 30;
    std::uint64_t of(std::uint64_t packed) const;
};

// The file's first bytes are those of a packed one.
bool is_gzip(std::span<const std::byte> head);
bool is_zip(std::span<const std::byte> head);

// Unpacks one file, or several members in a row, to `to`, which must not be there. Returns how many
// bytes follow that are no member, zeros aside. Errors: io, syntax (cut short, damaged), limit.
prep::Result<std::uint64_t> unpack_gzip(const std::filesystem::path& archive,
                                        const std::filesystem::path& to,
                                        const ArchiveLimits& limits = {});

// Unpacks all files of `archive` below `directory`; returns their names in it, in the archive's
// order. Names that lead out of the directory, links and encrypted entries are errors; what macOS
// adds (__MACOSX/) is left out. Errors: io, syntax, invalid, unsupported, limit.
prep::Result<std::vector<std::string>> unpack_zip(const std::filesystem::path& archive,
                                                  const std::filesystem::path& directory,
                                                  const ArchiveLimits& limits = {});

}  // namespace meshprep
