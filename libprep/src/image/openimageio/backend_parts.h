// What image reading and image writing share.
#pragma once

#include <exception>
#include <filesystem>
#include <new>
#include <span>
#include <string>
#include <string_view>

#include "prep/image.h"
#include "prep/result.h"

namespace prep::detail {

// As ImageBackend has them.
Result<Image> read_picture_file(const std::filesystem::path& path, ImageChannels channels,
                                std::string_view format);
Result<Image> read_picture_bytes(std::span<const std::byte> bytes, const std::string& name,
                                 std::string_view format);

// Runs body(), which returns a Result. Whatever OpenImageIO throws becomes an Error; only running
// out of memory goes on.
template <class Body>
auto guarded(ErrorCode code, const std::string& place, const Body& body) -> decltype(body()) {
    try {
        return body();
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        return Error{code, std::string("the image library failed: ") + e.what(), place};
    }
}

}  // namespace prep::detail
