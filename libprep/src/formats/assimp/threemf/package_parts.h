// The parts of a 3MF package: entries of a zip archive (PKWARE's APPNOTE 6.3.3: stored and deflated
// ones, ZIP64 too), unpacked into memory one at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "prep/result.h"

namespace prep::detail {

class PackageParts {
  public:
    PackageParts() = default;

    // Of a whole file's bytes. Errors: syntax. `place` is where, for errors of unpack() as well.
    static Result<PackageParts> of(std::vector<std::byte> bytes, const std::string& place);

    // Part names ("/3D/3dmodel.model") are the same whatever their capitals (ECMA-376-2, 6.2.2.3),
    // and with or without the first slash.
    bool has(std::string_view name) const;

    // Errors: invalid (there is none of that name), unsupported, syntax (damaged), limit: more than
    // 64 MiB and more than 200 times the packed size, or more than 4 GiB; of all parts together,
    // each counted as often as it is unpacked, more than 64 MiB and 200 times the package.
    Result<std::vector<std::byte>> unpack(std::string_view name) const;

  private:
    struct Entry {
        std::uint32_t flags = 0, method = 0, crc = 0;
        std::uint64_t packed = 0, size = 0, header = 0;
    };

    std::vector<std::byte> bytes_;
    std::string place_;
    mutable std::uint64_t unpacked_ = 0;
    std::map<std::string, Entry> entries_;  // by name without the slash, in small letters
};

}  // namespace prep::detail
