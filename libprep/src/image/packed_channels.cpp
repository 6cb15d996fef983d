#include "image/packed_channels.h"

#include <algorithm>
#include <map>
#include <optional>

namespace prep::detail {
namespace {

// Grey pictures have their value in every channel of colour; those without alpha are opaque.
float texel(const Image& image, std::uint32_t x, std::uint32_t y, std::uint32_t channel) {
    const float* at = image.at(x, y);
    const bool grey = image.channels < 3;
    const bool alpha = image.channels == 2 || image.channels == 4;
    if (channel == PackedChannel::opacity) return alpha ? at[image.channels - 1] : at[0];
    if (channel == 3) return alpha ? at[image.channels - 1] : 1.0f;
    return grey ? at[0] : at[channel];
}

}  // namespace

Result<Image> pack_channels(const ImageRef& ref) {
    if (ref.channels.size() > 4)
        return Error{ErrorCode::invalid, "a picture has at most 4 channels", ref.name};
    std::map<const ImageRef*, std::optional<Image>> sources;
    std::optional<Error> first_error;
    Image out;
    out.channels = std::uint32_t(ref.channels.size());
    bool any = false;
    for (const PackedChannel& channel : ref.channels) {
        if (!channel.source || sources.contains(channel.source.get())) continue;
        auto loaded = load_image(*channel.source);
        std::optional<Image>& image = sources[channel.source.get()];
        if (!loaded) {
            if (!first_error) first_error = std::move(loaded).error();
            continue;
        }
        if (loaded->pixels.empty() || loaded->channels == 0) continue;
        image = *std::move(loaded);
        any = true;
        // Of the largest: to take each side from another would make much of two thin ones.
        if (std::uint64_t(image->width) * image->height > std::uint64_t(out.width) * out.height) {
            out.width = image->width;
            out.height = image->height;
        }
        out.srgb |= image->srgb;
        out.floating |= image->floating;
    }
    if (!any)
        return first_error ? std::move(*first_error)
                           : Error{ErrorCode::io, "no channel has a picture", ref.name};
    out.pixels.resize(std::size_t(out.width) * out.height * out.channels);
    for (std::uint32_t c = 0; c < out.channels; ++c) {
        const PackedChannel& channel = ref.channels[c];
        const auto known = sources.find(channel.source.get());
        const Image* source = known != sources.end() && known->second ? &*known->second : nullptr;
        float* to = out.pixels.data() + c;
        for (std::uint32_t y = 0; y < out.height; ++y)
            for (std::uint32_t x = 0; x < out.width; ++x, to += out.channels) {
                if (!source) {
                    *to = channel.value;
                    continue;
                }
                const float value = texel(
                    *source, std::uint32_t(std::uint64_t(x) * source->width / out.width),
                    std::uint32_t(std::uint64_t(y) * source->height / out.height), channel.channel);
                *to = channel.inverted ? 1 - value : value;
            }
    }
    return out;
}

Image single_channel(const Image& image, std::uint32_t channel) {
    Image out;
    out.width = image.width;
    out.height = image.height;
    out.channels = 1;
    out.floating = image.floating;
    out.pixels.reserve(std::size_t(out.width) * out.height);
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x)
            out.pixels.push_back(texel(image, x, y, channel));
    return out;
}

}  // namespace prep::detail
