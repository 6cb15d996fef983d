// meshprep-reader: the process in which meshprep, or a program that asks for it, has the readers of
// other libraries run. Not for people: it talks to its caller alone.
#include <sys/socket.h>

#include <algorithm>
#include <cstdio>

#include "contained/messages.h"
#include "formats/foreign_files.h"
#include "formats/registry.h"
#include "reader/serve.h"

namespace {

prep::Result<prep::Scene> load(const std::string& name, const std::filesystem::path& path,
                               const prep::LoadOptions& options) {
    const auto& formats = prep::detail::formats();
    const auto found = std::find_if(formats.begin(), formats.end(), [&](const auto& format) {
        return format.file.name == name && format.foreign_reader;
    });
    if (found == formats.end())
        return prep::Error{prep::ErrorCode::unsupported,
                           "'" + name + "' is not read by another library", path.string()};
    return found->load(path, options);
}

}  // namespace

int main() {
    int kind = 0;
    socklen_t size = sizeof kind;
    if (::getsockopt(prep::detail::reader_socket, SOL_SOCKET, SO_TYPE, &kind, &size) != 0) {
        std::fputs("meshprep-reader reads files for meshprep, which starts it: run meshprep\n",
                   stderr);
        return 2;
    }
    // Before a file's limits hold. Where it cannot be loaded, each file is told so.
    (void)prep::detail::open_foreign_readers();
    reader::serve(load, [](const std::filesystem::path& path, prep::ImageChannels channels) {
        return prep::load_image(path, channels);
    });
}
