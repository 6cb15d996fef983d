#include "image/packed_refs.h"

namespace prep::detail {
namespace {

PackedChannel from(std::shared_ptr<const ImageRef> source, std::uint32_t channel) {
    PackedChannel packed;
    packed.source = std::move(source);
    packed.channel = channel;
    return packed;
}

std::string name_of(const std::shared_ptr<const ImageRef>& image) {
    return image ? image->name : std::string();
}

std::string joined(const std::string& a, const std::string& b) {
    return a.empty() || b.empty() ? a + b : a + " + " + b;
}

}  // namespace

ImageRef packed_metallic_roughness(std::shared_ptr<const ImageRef> metallic,
                                   std::shared_ptr<const ImageRef> roughness, bool glossiness) {
    ImageRef image;
    image.name = joined(name_of(roughness), name_of(metallic));
    PackedChannel green = from(std::move(roughness), 0);
    green.inverted = glossiness && green.source;
    image.channels = {from(nullptr, 0), std::move(green), from(std::move(metallic), 0)};
    return image;
}

ImageRef packed_with_opacity(std::shared_ptr<const ImageRef> color,
                             std::shared_ptr<const ImageRef> opacity) {
    ImageRef image;
    image.name = joined(name_of(color), name_of(opacity));
    for (std::uint32_t c = 0; c < 3; ++c) image.channels.push_back(from(color, c));
    image.channels.push_back(from(std::move(opacity), PackedChannel::opacity));
    return image;
}

}  // namespace prep::detail
