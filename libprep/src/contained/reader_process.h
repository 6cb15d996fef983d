// The caller's side of a reader that runs in a process of its own.
#pragma once

#include <filesystem>

#include "prep/image.h"
#include "prep/load.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace prep::detail {

// Has `path` read as a file of the format of that name (FileFormat::name), by `library`, whose name
// is for messages. Errors: those of the format's reader; unsupported (it crashed), limit (time,
// memory), io (the program meshprep-reader is not there, or is of another build).
// `options.reader_process` is there.
Result<Scene> load_contained(std::string_view format, std::string_view library,
                             const std::filesystem::path& path, const LoadOptions& options);

// Has `path` decoded as a picture, whatever its format. Errors: those of load_image(), else as
// above. `options.reader_process` is there.
Result<Image> load_picture_contained(const std::filesystem::path& path,
                                     const ImageOptions& options);

}  // namespace prep::detail
