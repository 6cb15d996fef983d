// What the image library of this project (image/openimageio, loaded when a picture first needs it:
// image.cpp) offers to libprep. Both sides come from one build.
#pragma once

#include <memory>

#include "prep/image.h"

namespace prep::detail {

// A file that takes rows. Destroyed unclosed, it leaves the file as it is.
class RowWriter {
  public:
    virtual ~RowWriter() = default;
    // `values` are floats, or 32 bits of either kind where the layout has integer channels.
    virtual Result<void> write(const void* values, std::uint32_t rows) = 0;
    virtual Result<void> close() = 0;
};

struct ImageBackend {
    // With the decoder of `format` alone, an ending without its dot; empty: with any that can.
    Result<Image> (*load)(const std::filesystem::path&, ImageChannels, std::string_view format);
    // Embedded pictures: the same; without a format by their first bytes, else by the ending of
    // their name.
    Result<Image> (*decode)(std::span<const std::byte>, const std::string&,
                            std::string_view format);
    // What is written was checked (picture_checks.h).
    Result<std::vector<std::byte>> (*encode)(const std::filesystem::path&, const Image&, PixelType);
    // `path` names the format and stands in messages; `file` is written.
    Result<std::unique_ptr<RowWriter>> (*open_rows)(const std::filesystem::path& path,
                                                    const std::filesystem::path& file,
                                                    const ImageLayout&);
};

}  // namespace prep::detail
