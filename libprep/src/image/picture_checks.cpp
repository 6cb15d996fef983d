#include "image/picture_checks.h"

namespace prep {
namespace {

Result<void> check_size(std::uint32_t width, std::uint32_t height, std::size_t channels,
                        const std::string& place) {
    if (width == 0 || height == 0 || channels == 0)
        return Error{ErrorCode::invalid, "the image to write is empty", place};
    if (width > max_image_extent || height > max_image_extent)
        return Error{ErrorCode::limit,
                     "the image to write is larger than " + std::to_string(max_image_extent) +
                         " pixels in one direction",
                     place};
    return {};
}

}  // namespace

Result<void> detail::check_picture(const Image& image, const std::string& place) {
    if (auto sized = check_size(image.width, image.height, image.channels, place); !sized)
        return sized;
    if (image.channels > 4)
        return Error{ErrorCode::invalid,
                     "the image to write has " + std::to_string(image.channels) +
                         " channels; 1 to 4 can be written",
                     place};
    const std::size_t count = std::size_t(image.width) * image.height * image.channels;
    if (image.pixels.size() != count)
        return Error{ErrorCode::invalid,
                     "the image to write has " + std::to_string(image.pixels.size()) +
                         " values where its size asks for " + std::to_string(count),
                     place};
    return {};
}

Result<void> detail::check_picture(const ImageLayout& layout, const std::string& place) {
    if (auto sized = check_size(layout.width, layout.height, layout.channels.size(), place); !sized)
        return sized;
    if (!layout.integer.empty() &&
        (layout.type != PixelType::f32 || layout.integer.size() != layout.channels.size()))
        return Error{ErrorCode::invalid,
                     "integer channels stand beside 32-bit floats, one mark per channel", place};
    return {};
}

}  // namespace prep
