#include <OpenImageIO/imageio.h>

#include <algorithm>

#include "image/levels.h"
#include "image/openimageio/backend_parts.h"
#include "image/openimageio/checked_file.h"
#include "image/openimageio/encode_image.h"
#include "image/openimageio/output_format.h"
#include "image/openimageio/pixel_types.h"

namespace prep::detail {
namespace {

namespace oiio = OIIO;

Error failed(const std::string& why, const std::string& place) {
    return {ErrorCode::io,
            "the image cannot be written: " + (why.empty() ? std::string("no reason given") : why),
            place};
}

class FileRows final : public RowWriter {
  public:
    FileRows(std::unique_ptr<CheckedFile> file, std::unique_ptr<oiio::ImageOutput> output,
             const ImageLayout& layout, std::filesystem::path path, std::string place)
        : file_(std::move(file)),
          output_(std::move(output)),
          layout_(layout),
          path_(std::move(path)),
          place_(std::move(place)) {}

    Result<void> write(const void* values, std::uint32_t rows) override {
        return guarded(ErrorCode::io, place_, [&]() -> Result<void> {
            const bool good = write_scanlines(values, rows);
            row_ += int(rows);
            if (!good) return failed(output_->geterror(), place_);
            return {};
        });
    }

    Result<void> close() override {
        return guarded(ErrorCode::io, place_, [&]() -> Result<void> {
            const bool good = output_->close();
            const std::string problem = file_ ? file_->finish() : std::string();
            if (!problem.empty()) return failed(problem, place_);
            if (!good) return failed(output_->geterror(), place_);
            return file_ ? Result<void>() : check_written(path_, place_);
        });
    }

  private:
    bool write_scanlines(const void* values, std::uint32_t rows) {
        const auto put = [&](oiio::TypeDesc type, const void* data) {
            return output_->write_scanlines(row_, row_ + int(rows), 0, type, data);
        };
        if (!layout_.integer.empty()) return put(oiio::TypeDesc::UNKNOWN, values);  // as stored
        const std::span<const float> floats(
            static_cast<const float*>(values),
            std::size_t(rows) * layout_.width * layout_.channels.size());
        if (layout_.type == PixelType::u8)
            return put(oiio::TypeDesc::UINT8, quantise<std::uint8_t>(floats).data());
        if (layout_.type == PixelType::u16)
            return put(oiio::TypeDesc::UINT16, quantise<std::uint16_t>(floats).data());
        return put(oiio::TypeDesc::FLOAT, floats.data());
    }

    std::unique_ptr<CheckedFile> file_;  // outlives the writer; none where that takes names only
    std::unique_ptr<oiio::ImageOutput> output_;
    ImageLayout layout_;
    std::filesystem::path path_;
    std::string place_;
    int row_ = 0;
};

oiio::ImageSpec spec_of(const ImageLayout& layout, const std::string& ending) {
    oiio::ImageSpec spec(int(layout.width), int(layout.height), int(layout.channels.size()),
                         type_of(layout.type));
    spec.channelnames = layout.channels;
    const auto alpha = std::find(layout.channels.begin(), layout.channels.end(), "A");
    spec.alpha_channel = alpha == layout.channels.end() ? -1 : int(alpha - layout.channels.begin());
    for (const bool integer : layout.integer)
        spec.channelformats.push_back(integer ? oiio::TypeDesc::UINT32 : oiio::TypeDesc::FLOAT);
    spec.attribute("oiio:ColorSpace", layout.srgb ? "sRGB" : "Linear");
    spec.attribute("oiio:UnassociatedAlpha", 1);
    set_options(spec, ending);
    return spec;
}

Result<std::unique_ptr<RowWriter>> open_checked(const std::filesystem::path& path,
                                                const std::filesystem::path& file,
                                                const ImageLayout& layout) {
    const std::string place = path.string();
    std::string ending;
    auto made = output_for(path, ending);
    if (!made) return made.error();
    std::unique_ptr<oiio::ImageOutput> output = *std::move(made);
    if ((layout.channels.size() > 4 && !output->supports("nchannels")) ||
        (!layout.integer.empty() && !output->supports("channelformats")))
        return Error{ErrorCode::unsupported,
                     "files of the ending '" + ending + "' hold no such channels; use .exr", place};
    if (auto shape =
            check_shape(ending, layout.width, layout.height, layout.channels.size(), place);
        !shape)
        return shape.error();
    std::unique_ptr<CheckedFile> checked;
    if (takes_proxies(*output, ending)) {
        checked = std::make_unique<CheckedFile>(file.string());
        output->set_ioproxy(checked.get());
    }
    if (!output->open(file.string(), spec_of(layout, ending))) {
        const std::string why = output->geterror();
        output.reset();  // before the file beneath it
        return failed(why, place);
    }
    return std::unique_ptr<RowWriter>(
        std::make_unique<FileRows>(std::move(checked), std::move(output), layout, file, place));
}

}  // namespace

Result<std::unique_ptr<RowWriter>> open_rows(const std::filesystem::path& path,
                                             const std::filesystem::path& file,
                                             const ImageLayout& layout) {
    const std::string place = path.string();
    return guarded(ErrorCode::io, place, [&] { return open_checked(path, file, layout); });
}

}  // namespace prep::detail
