// Whether a picture's file is all there, where its decoder would not say: libjpeg fills what is
// missing with grey, and OpenImageIO 2.4 leaves strips that libtiff cannot read as they were.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace prep::detail {

// A file's bytes, wherever they are.
struct ByteSource {
    std::uint64_t size = 0;
    // Fills the span from this offset on; it lies within `size`. False: they cannot be read.
    std::function<bool(std::uint64_t offset, std::span<std::byte> out)> read;
};

// Why the picture is cut short; empty where it is not, where its format is neither JPEG nor TIFF,
// or where it is broken in a way that its decoder reports.
//
// JPEG (ITU-T T.81, B.1 and B.2): marker segments are walked by their lengths, so that what a
// thumbnail holds does not count; in entropy-coded data FF is followed by 00 or a restart marker,
// so FF D9 ends the picture and nothing else. TIFF 6.0 and BigTIFF: the first picture's strips or
// tiles must lie within the file. Cost: JPEG O(bytes), TIFF O(strips), in little memory.
std::string missing_part(const ByteSource& file);

// The same for a TIFF file that has just been written, to the last value of its directory: libtiff
// writes the end of it when it is closed, and does not say that it could not.
std::string missing_part_of_written_tiff(const ByteSource& file);

}  // namespace prep::detail
