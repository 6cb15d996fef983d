#include "contained/pictures.h"

#include <array>
#include <cstdlib>
#include <fstream>
#include <map>

#include "base/own_directory.h"
#include "contained/reader_process.h"
#include "image/image_library.h"
#include "image/packed_channels.h"
#include "image/picture_kind.h"
#include "prep/files.h"
#include "prep/formats.h"
#include "prep/image.h"

namespace prep {
namespace {

namespace fs = std::filesystem;
using namespace detail;

using Sources = std::map<const ImageRef*, std::shared_ptr<const ImageRef>>;

void set_options(ImageRef& image, const std::shared_ptr<const ImageOptions>& options,
                 Sources& known) {
    image.options = options;
    for (PackedChannel& channel : image.channels) {
        if (!channel.source) continue;
        std::shared_ptr<const ImageRef>& same = known[channel.source.get()];
        if (!same) {
            auto copy = std::make_shared<ImageRef>(*channel.source);
            set_options(*copy, options, known);
            same = std::move(copy);
        }
        channel.source = same;
    }
}

// With every `from` in it as `to`.
std::string renamed(std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

}  // namespace

void detail::contain_pictures(Scene& scene, const LoadOptions& options) {
    if (!options.reader_process) return;
    auto of_pictures = std::make_shared<ImageOptions>();
    of_pictures->reader_process = options.reader_process;
    Sources known;
    for (ImageRef& image : scene.images) set_options(image, of_pictures, known);
}

Result<Image> load_image(const fs::path& path, ImageChannels channels) {
    return load_picture(path, channels);
}

Result<Image> load_image(const fs::path& path, const ImageOptions& options) {
    if (!options.reader_process) return load_picture(path, options.channels);
    std::error_code ec;
    if (!fs::is_regular_file(path, ec)) return load_picture(path, options.channels);  // its error
    std::array<std::byte, picture_head> head{};
    std::ifstream in(path, std::ios::binary);
    in.read(reinterpret_cast<char*>(head.data()), std::streamsize(head.size()));
    const std::span<const std::byte> there(head.data(), std::size_t(in.gcount()));
    const std::string_view tried = tried_picture(there, lower_ending(path));
    if (!tried.empty()) {
        auto image = load_picture(path, options.channels, tried);
        // A name alone says little: the file may be of another format.
        if (image || !picture_kind(there).empty()) return image;
    }
    return load_picture_contained(path, options);
}

Result<Image> decode_image(std::span<const std::byte> bytes, const std::string& name,
                           const ImageOptions& options) {
    const std::string ending = lower_ending(name);
    const std::string_view kind = picture_kind(bytes);
    if (!options.reader_process || bytes.empty() || is_ktx2(bytes) ||
        (kind.empty() && ending.empty()))
        return decode_picture(bytes, name);
    if (const std::string_view tried = tried_picture(bytes, ending); !tried.empty()) {
        auto image = decode_picture(bytes, name, tried);
        if (image || !kind.empty()) return image;
    }
    // Several decoders take files alone, and the reader's process writes none.
    const OwnDirectory directory;
    if (directory.path().empty()) return no_own_directory(name);
    const fs::path file =
        directory.path() / ("picture" + (kind.empty() ? ending : "." + std::string(kind)));
    if (auto written = write_file(file, bytes); !written) return written.error();
    ImageOptions under_its_name = options;
    if (options.reader_log)
        under_its_name.reader_log = [&](const fs::path&, std::string_view text) {
            options.reader_log(name, renamed(std::string(text), file.string(), name));
        };
    auto image = load_picture_contained(file, under_its_name);
    if (!image) {
        image.error().place = renamed(image.error().place, file.string(), name);
        image.error().text = renamed(image.error().text, file.string(), name);
    }
    return image;
}

Result<Image> load_image(const ImageRef& ref) {
    const ImageOptions options = ref.options ? *ref.options : ImageOptions{};
    if (!ref.bytes.empty()) {
        std::string name = ref.name;
        if (fs::path(name).extension().empty() && ref.mime_type.size() > 6 &&
            ref.mime_type.starts_with("image/"))
            name.append(".").append(ref.mime_type, 6);
        return decode_image(ref.bytes, name, options);
    }
    if (!ref.channels.empty()) return pack_channels(ref);
    if (!ref.path.empty()) return load_image(ref.path, options);
    return Error{ErrorCode::io, "the image has neither a file nor embedded bytes", ref.name};
}

}  // namespace prep
