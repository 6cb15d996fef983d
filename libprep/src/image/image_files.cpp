#include <optional>

#include "base/atomic_files.h"
#include "image/image_backend.h"
#include "image/image_library.h"
#include "image/picture_checks.h"
#include "image/png/png_file.h"

namespace prep {

struct ImageFiles::State {
    explicit State(Rules rules)
        : files({.replace = rules.replace, .spare = std::move(rules.spare)}) {}
    struct Open {
        std::string place;
        ImageLayout layout;
        std::uint32_t rows = 0;  // written
        std::unique_ptr<detail::RowWriter> writer;
        bool failed = false;
    };
    detail::FileSet files;
    std::vector<Open> open;

    Result<void> write(std::size_t file, const void* values, std::size_t count, bool words) {
        if (file >= open.size())
            return Error{ErrorCode::invalid, "no file of this number was opened", {}};
        Open& to = open[file];
        const std::size_t row = std::size_t(to.layout.width) * to.layout.channels.size();
        const std::size_t rows = count / row;
        if (count % row != 0 || rows > to.layout.height - to.rows ||
            words != !to.layout.integer.empty())
            return Error{ErrorCode::invalid,
                         "the values are not the next whole rows of this picture", to.place};
        if (rows == 0) return {};
        to.rows += std::uint32_t(rows);
        Result<void> written = to.writer->write(values, std::uint32_t(rows));
        if (written && to.rows == to.layout.height) {
            // Closed at once: a sequence would otherwise hold all its files open.
            written = to.writer->close();
            to.writer.reset();
        }
        to.failed |= !written;
        return written;
    }
};

namespace {

Result<std::unique_ptr<detail::RowWriter>> open_rows(const std::filesystem::path& path,
                                                     const std::filesystem::path& file,
                                                     const ImageLayout& layout) {
    if (detail::is_png_name(path)) return detail::open_png_rows(path, file, layout);
    const auto& images = detail::image_backend();
    return images ? (*images)->open_rows(path, file, layout)
                  : Result<std::unique_ptr<detail::RowWriter>>(images.error());
}

}  // namespace

ImageFiles::ImageFiles() : ImageFiles(Rules{}) {}
ImageFiles::ImageFiles(Rules rules) : state_(std::make_unique<State>(std::move(rules))) {}
ImageFiles::~ImageFiles() = default;

Result<std::size_t> ImageFiles::open(const std::filesystem::path& path, const ImageLayout& layout) {
    const auto stored = stored_type(path, layout.type);
    if (!stored) return stored.error();
    if (auto checked = detail::check_picture(layout, path.string()); !checked)
        return checked.error();
    const auto staged = state_->files.stage(path);
    if (!staged) return staged.error();
    ImageLayout typed = layout;
    typed.type = *stored;
    auto writer = open_rows(path, *staged, typed);
    if (!writer) {
        state_->files.drop_last();
        return writer.error();
    }
    state_->open.push_back({path.string(), std::move(typed), 0, *std::move(writer)});
    return state_->open.size() - 1;
}

Result<void> ImageFiles::write_rows(std::size_t file, std::span<const float> values) {
    return state_->write(file, values.data(), values.size(), false);
}

Result<void> ImageFiles::write_rows(std::size_t file, std::span<const std::uint32_t> words) {
    return state_->write(file, words.data(), words.size(), true);
}

Result<void> ImageFiles::commit() {
    for (const State::Open& file : state_->open) {
        if (file.failed)
            return Error{ErrorCode::io, "a part of the picture could not be written", file.place};
        if (file.rows < file.layout.height)
            return Error{ErrorCode::invalid,
                         "the picture has " + std::to_string(file.layout.height) + " rows, only " +
                             std::to_string(file.rows) + " were given",
                         file.place};
    }
    return state_->files.commit();
}

}  // namespace prep
