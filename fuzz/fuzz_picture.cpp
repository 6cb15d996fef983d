#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>

#include "image/jpeg/jpeg_file.h"
#include "image/picture_kind.h"
#include "image/png/png_file.h"

namespace {

std::optional<prep::Image> read(std::span<const std::byte> bytes) {
    prep::detail::PictureSource source(bytes);
    if (!prep::detail::is_jpeg(bytes)) {
        auto image = prep::detail::read_png(source, prep::ImageChannels::all, "fuzz.png");
        return image ? std::optional(*std::move(image)) : std::nullopt;
    }
    auto image = prep::detail::read_jpeg(source, prep::ImageChannels::all, "fuzz.jpg");
    return image ? *std::move(image) : std::nullopt;
}

}  // namespace

// PNG and JPEG: whatever is read is a picture, and comes back as PNG.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto image = read(std::as_bytes(std::span(data, size)));
    if (!image) return 0;
    if (image->pixels.size() != std::size_t(image->width) * image->height * image->channels ||
        image->channel_names.size() != image->channels)
        std::abort();
    if (image->pixels.size() > 1 << 16) return 0;
    const auto type = image->integer_bits == 16 ? prep::PixelType::u16 : prep::PixelType::u8;
    const auto bytes = prep::encode_png(*image, type);
    if (!bytes) std::abort();
    const auto again = read(*bytes);
    if (!again || again->pixels != image->pixels) std::abort();
    return 0;
}
