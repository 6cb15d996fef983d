#include "prep/image.h"

#include <dlfcn.h>

#include <cstring>
#include <latch>
#include <new>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include "image/image_library.h"
#include "image/jpeg/jpeg_file.h"
#include "image/picture_checks.h"
#include "image/picture_kind.h"
#include "image/png/png_file.h"
#include "libraries/companion_library.h"
#include "libraries/macro_text.h"
#include "prep/files.h"
#include "prep/scene.h"

// OpenImageIO brings some 250 libraries along, whose loading takes longer than many a conversion of
// a mesh: the part that uses it is a library of its own, loaded with the first picture that neither
// libpng nor libjpeg sees to, which libprep starts with. (docs/performance.md: what that saves.)

namespace prep {
namespace {

using detail::ImageBackend;
using detail::PictureSource;

// A symbol is looked for in the program, then in what was opened with its library, one after the
// other: with OpenImageIO that is all of its 250. Opened before, by itself, a library has only what
// it needs around it. Half the time of loading. By the paths that OpenImageIO has them at; what is
// not there is opened with the rest.
void open_needs_first() {
    static constexpr const char* needs[] = {
#include "image_needs.inl"
    };
    for (const char* need : needs)
        if (need && !::dlopen(need, RTLD_NOW | RTLD_LOCAL)) (void)::dlerror();
}

// One of those libraries starts threads of its own as it is loaded, and ends the process, or waits
// for ever, where the system refuses one.
bool can_start_threads() {
    constexpr int more_than_it_starts = 8;  // 4 of liblog4cplus
    std::vector<std::thread> threads;
    threads.reserve(more_than_it_starts);
    std::latch ready(1);
    try {
        for (int k = 0; k < more_than_it_starts; ++k) threads.emplace_back([&] { ready.wait(); });
    } catch (const std::system_error&) {  // told by the number
    } catch (const std::bad_alloc&) {     // of a thread's own
    }
    ready.count_down();
    for (std::thread& thread : threads) thread.join();
    return threads.size() == more_than_it_starts;
}

// Nothing where OpenImageIO has to.
Result<std::optional<Image>> read_here(PictureSource& source, ImageChannels channels,
                                       const std::string& place) {
    if (detail::is_jpeg(source.head())) return detail::read_jpeg(source, channels, place);
    if (!detail::is_png(source.head())) return std::optional<Image>();
    auto image = detail::read_png(source, channels, place);
    if (!image) return image.error();
    return std::optional<Image>(*std::move(image));
}

Result<const ImageBackend*> open_backend() {
    if (!can_start_threads())
        return Error{ErrorCode::io,
                     "the library for pictures starts threads, and the system refuses them: allow "
                     "more processes or memory",
                     ""};
    open_needs_first();
    return detail::open_companion<ImageBackend>(
        {"libprep_images.so", MESHPREP_TEXT(MESHPREP_IMAGE_BACKEND), "the library for pictures"});
}

// What was checked.
Result<std::vector<std::byte>> encode(const std::filesystem::path& path, const Image& image,
                                      PixelType type) {
    if (detail::is_png_name(path)) return detail::png_bytes(image, type, path.string());
    const auto& images = detail::image_backend();
    return images ? (*images)->encode(path, image, type)
                  : Result<std::vector<std::byte>>(images.error());
}

}  // namespace

const Result<const ImageBackend*>& detail::image_backend() {
    static const Result<const ImageBackend*> opened = open_backend();
    return opened;
}

Result<void> load_image_library() {
    const auto& images = detail::image_backend();
    return images ? Result<void>() : images.error();
}

Result<Image> detail::load_picture(const std::filesystem::path& path, ImageChannels channels,
                                   std::string_view format) {
    if (auto source = PictureSource::open(path)) {
        auto image = read_here(*source, channels, path.string());
        if (!image) return image.error();
        if (*image) return **std::move(image);
    }
    const auto& images = detail::image_backend();
    return images ? (*images)->load(path, channels, format) : Result<Image>(images.error());
}

Result<Image> detail::decode_picture(std::span<const std::byte> bytes, const std::string& name,
                                     std::string_view format) {
    if (is_ktx2(bytes))
        return Error{ErrorCode::unsupported, "KTX2 pictures (Basis Universal) are not decoded",
                     name};
    PictureSource source(bytes);
    auto image = read_here(source, ImageChannels::color, name);
    if (!image) return image.error();
    if (*image) return **std::move(image);
    const auto& images = detail::image_backend();
    return images ? (*images)->decode(bytes, name, format) : Result<Image>(images.error());
}

Result<void> save_image(const std::filesystem::path& path, const Image& image, PixelType type) {
    const auto stored = stored_type(path, type);
    if (!stored) return stored.error();
    if (auto checked = detail::check_picture(image, path.string()); !checked)
        return checked.error();
    const auto bytes = encode(path, image, *stored);
    if (!bytes) return bytes.error();
    return write_file(path, *bytes);
}

Result<std::vector<std::byte>> encode_png(const Image& image, PixelType type) {
    const std::string place = "memory.png";
    if (auto checked = detail::check_picture(image, place); !checked) return checked.error();
    if (type == PixelType::f16 || type == PixelType::f32)
        return Error{ErrorCode::unsupported, "PNG holds 8 or 16 bits a channel, not floats", place};
    return detail::png_bytes(image, type, place);
}

}  // namespace prep
