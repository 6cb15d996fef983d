#include "libraries/companion_library.h"

#include <dlfcn.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace prep::detail {
namespace {

// Where a library may stand, in this order.
std::vector<std::string> library_paths(const std::string& file) {
    std::vector<std::string> list;
    std::error_code ec;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", ec);
    if (!ec) {
        // A program may be built around us, as a project of which we are a part.
        if (program.string().starts_with(MESHPREP_PROGRAMS_BUILD "/"))
            list.push_back(MESHPREP_LIBRARIES_BUILD "/" + file);
        // The command is in one directory, the process that reads files for it in another.
        for (const char* libraries :
             {"", MESHPREP_LIBRARIES_FROM_BIN, MESHPREP_LIBRARIES_FROM_LIBEXEC}) {
            const auto path = program.parent_path() / libraries / file;
            std::string text = path.lexically_normal().string();
            if (std::find(list.begin(), list.end(), text) == list.end())
                list.push_back(std::move(text));
        }
    }
    list.push_back(file);  // linked already, or where the system looks
    return list;
}

}  // namespace

Result<void*> companion_symbol(const CompanionLibrary& library) {
    std::string reasons;
    for (const std::string& path : library_paths(library.file)) {
        // Never closed: libraries of this size do not survive it.
        void* const opened = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        const char* problem = opened ? nullptr : ::dlerror();
        if (opened) {
            if (void* const symbol = ::dlsym(opened, library.symbol)) return symbol;
            problem = "is of another build";
        }
        reasons += (reasons.empty() ? "" : "; ") + (opened ? path + " " : std::string()) +
                   (problem ? problem : "unknown");
    }
    return Error{
        ErrorCode::io,
        std::string(library.purpose) + " cannot be loaded (" + reasons + "): install meshprep anew",
        library.file};
}

}  // namespace prep::detail
