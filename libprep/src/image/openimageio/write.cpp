#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "base/own_directory.h"
#include "image/levels.h"
#include "image/openimageio/backend_parts.h"
#include "image/openimageio/encode_image.h"
#include "image/openimageio/output_format.h"
#include "image/openimageio/pixel_types.h"
#include "prep/files.h"
#include "prep/image.h"

namespace prep {
namespace {

namespace oiio = OIIO;

using detail::quantise;
using detail::type_of;

oiio::ImageSpec spec_of(const Image& image, PixelType type, const std::string& ending) {
    oiio::ImageSpec spec(int(image.width), int(image.height), int(image.channels), type_of(type));
    spec.attribute("oiio:ColorSpace", image.srgb ? "sRGB" : "Linear");
    spec.attribute("oiio:UnassociatedAlpha", 1);
    detail::set_options(spec, ending);
    return spec;
}

std::string ending_of(const std::string& name) {
    return name.substr(name.rfind('.'));
}

Error failed(const std::string& why, const std::string& place) {
    return {ErrorCode::io,
            "the image cannot be written: " + (why.empty() ? std::string("no reason given") : why),
            place};
}

bool write_pixels(oiio::ImageOutput& output, const Image& image, PixelType type) {
    // Integers are rounded here, so that the bytes do not depend on the library's version.
    switch (type) {
        case PixelType::u8:
            return output.write_image(oiio::TypeDesc::UINT8,
                                      quantise<std::uint8_t>(image.pixels).data());
        case PixelType::u16:
            return output.write_image(oiio::TypeDesc::UINT16,
                                      quantise<std::uint16_t>(image.pixels).data());
        case PixelType::f16:
        case PixelType::f32:
            break;
    }
    return output.write_image(oiio::TypeDesc::FLOAT, image.pixels.data());
}

Result<std::vector<std::byte>> encode(const std::string& stand_in, const Image& image,
                                      PixelType type, const std::string& place) {
    std::vector<unsigned char> bytes;
    {
        oiio::Filesystem::IOVecOutput memory(bytes);
        auto output = oiio::ImageOutput::create(stand_in);
        if (!output) return failed(oiio::geterror(), place);
        output->set_ioproxy(&memory);
        if (!output->open(stand_in, spec_of(image, type, ending_of(stand_in))) ||
            !write_pixels(*output, image, type) || !output->close())
            return failed(output->geterror(), place);
    }
    const auto* begin = reinterpret_cast<const std::byte*>(bytes.data());
    return std::vector<std::byte>(begin, begin + bytes.size());
}

Result<std::vector<std::byte>> encode_by_ending(const std::filesystem::path& path,
                                                const Image& image, PixelType type) {
    const std::string place = path.string();
    std::string ending;
    auto made = detail::output_for(path, ending);
    if (!made) return made.error();
    std::unique_ptr<oiio::ImageOutput> output = *std::move(made);
    if (auto checked =
            detail::check_shape(ending, image.width, image.height, image.channels, place);
        !checked)
        return checked.error();
    if (detail::takes_proxies(*output, ending))
        return encode("memory" + ending, image, type, place);
    const detail::OwnDirectory own;
    if (own.path().empty()) return detail::no_own_directory(place);
    const std::filesystem::path temporary = own.path() / ("picture" + ending);
    const bool written = output->open(temporary.string(), spec_of(image, type, ending)) &&
                         write_pixels(*output, image, type) && output->close();
    const Result<void> whole = written ? detail::check_written(temporary, place)
                                       : Result<void>(failed(output->geterror(), place));
    return whole ? read_file(temporary) : Result<std::vector<std::byte>>(whole.error());
}

}  // namespace

namespace detail {

Result<std::vector<std::byte>> encode_image(const std::filesystem::path& path, const Image& image,
                                            PixelType type) {
    return detail::guarded(ErrorCode::io, path.string(),
                           [&] { return encode_by_ending(path, image, type); });
}

}  // namespace detail

}  // namespace prep
