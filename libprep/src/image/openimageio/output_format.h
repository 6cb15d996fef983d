// The writer that a picture's name asks for.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "prep/result.h"

namespace prep::detail {

// By the ending of `path`, one that check_writable_image() has let pass; it is given back in lower
// case. Errors: unsupported (an OpenImageIO without that writer).
Result<std::unique_ptr<OIIO::ImageOutput>> output_for(const std::filesystem::path& path,
                                                      std::string& ending);

// Whether files of the ending hold pictures of that shape. Some writers only find out with the
// first row, and that of WebP (OpenImageIO 2.4) leaves its memory in ruins then. Errors:
// unsupported (the channels), limit (the size).
Result<void> check_shape(const std::string& ending, std::uint32_t width, std::uint32_t height,
                         std::size_t channels, const std::string& place);

// Whether it can be given a file of ours, or memory, in place of a name. That of TIFF says so and
// gets it wrong (OpenImageIO 2.4).
bool takes_proxies(const OIIO::ImageOutput& output, const std::string& ending);

// Whether all of a TIFF file has arrived that its writer has closed: it checks each strip that it
// writes, but not what it writes last. `place` is for the message. Errors: io.
Result<void> check_written(const std::filesystem::path& file, const std::string& place);

// Formats that note when a file was written get one date for all: the same picture, the same bytes.
void set_options(OIIO::ImageSpec& spec, const std::string& ending);

}  // namespace prep::detail
