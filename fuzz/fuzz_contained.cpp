// What a reader's process sends, which may be anything: whole messages with any bytes.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "contained/messages.h"
#include "contained/picture_bytes.h"
#include "contained/scene_bytes.h"
#include "invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    const auto scene = prep::detail::scene_of_bytes(bytes);
    if (scene && !test::broken_promise(*scene).empty()) std::abort();
    if (scene && prep::detail::scene_bytes(*scene).size() != size) std::abort();
    const auto picture = prep::detail::picture_of_bytes(bytes, prep::ImageChannels::all);
    if (picture &&
        picture->pixels.size() != std::size_t(picture->width) * picture->height * picture->channels)
        std::abort();
    if (picture && prep::detail::picture_bytes(*picture).size() != size) std::abort();
    prep::detail::PictureRequest picture_request;
    static_cast<void>(prep::detail::request_of_bytes(bytes, picture_request));
    prep::detail::ReadRequest request;
    prep::Error error;
    static_cast<void>(prep::detail::request_of_bytes(bytes, request));
    static_cast<void>(prep::detail::error_of_bytes(bytes, error));
    return 0;
}
