#include "contained/picture_bytes.h"

#include "contained/bytes.h"

namespace prep::detail {

template <class List, Is<Image> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.width, t.height, t.channels, t.pixels, t.srgb, t.integer_channels,
                   t.integers, t.floating, t.channel_names, t.integer_bits);
}

namespace {

bool keeps_promises(const Image& image, ImageChannels channels) {
    const bool all = channels == ImageChannels::all;
    const std::uint32_t most_channels = all ? 32 : 4;  // as integer_channels has bits
    if (image.integer_bits != 0 && image.integer_bits != 8 && image.integer_bits != 16)
        return false;
    if (!all && !image.channel_names.empty()) return false;
    if (image.channels < 32 && image.integer_channels >> image.channels != 0) return false;
    if (image.width == 0 || image.height == 0 || image.width > max_image_extent ||
        image.height > max_image_extent || image.channels == 0 || image.channels > most_channels)
        return false;
    const std::uint64_t values = std::uint64_t(image.width) * image.height * image.channels;
    return image.pixels.size() == values &&
           (image.integers.empty() ? image.integer_channels == 0
                                   : image.integers.size() == values) &&
           (image.channel_names.empty() || image.channel_names.size() == image.channels);
}

}  // namespace

std::vector<std::byte> picture_bytes(const Image& image) {
    ByteWriter writer;
    writer(image);
    return writer.take();
}

Result<Image> picture_of_bytes(std::span<const std::byte> bytes, ImageChannels channels) {
    ByteReader reader(bytes);
    Image image;
    reader(image);
    if (!reader.good() || !reader.at_end() || !keeps_promises(image, channels))
        return Error{ErrorCode::invalid, "the bytes are no picture", ""};
    return image;
}

}  // namespace prep::detail
