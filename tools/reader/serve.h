// The reader's side of a process of its own (prep::ReaderProcess): one request after the other,
// each within its limits.
#pragma once

#include <filesystem>
#include <string>

#include "prep/image.h"
#include "prep/load.h"

namespace reader {

// Reads the file as one of the format of that name.
using Load = prep::Result<prep::Scene> (*)(const std::string& format,
                                           const std::filesystem::path& path,
                                           const prep::LoadOptions& options);

// Decodes the file as a picture of any format.
using LoadPicture = prep::Result<prep::Image> (*)(const std::filesystem::path& path,
                                                  prep::ImageChannels channels);

// Until the caller is gone; ends the process then, in the middle of a file as well.
[[noreturn]] void serve(Load load, LoadPicture load_picture);

}  // namespace reader
