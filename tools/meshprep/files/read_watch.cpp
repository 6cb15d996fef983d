#include "meshprep/files/read_watch.h"

#include <tuple>

namespace meshprep {
namespace {

std::optional<struct stat> state_of(const std::filesystem::path& file) {
    struct stat state {};
    if (::stat(file.c_str(), &state) != 0) return std::nullopt;
    return state;
}

auto changes(const struct stat& s) {
    return std::make_tuple(s.st_dev, s.st_ino, s.st_size, s.st_mtim.tv_sec, s.st_mtim.tv_nsec,
                           s.st_ctim.tv_sec, s.st_ctim.tv_nsec);
}

}  // namespace

ReadWatch::ReadWatch(const std::filesystem::path& input) : input_(input), before_(state_of(input)) {
    ::clock_gettime(CLOCK_REALTIME, &begin_);
}

bool ReadWatch::unchanged(const std::filesystem::path& file) const {
    const std::optional<struct stat> now = state_of(file);
    if (!now) return false;
    if (file == input_ && (!before_ || changes(*before_) != changes(*now))) return false;
    // Unlike the time of its bytes, which programs set, this one is the system's.
    const timespec changed = now->st_ctim;
    return std::tie(changed.tv_sec, changed.tv_nsec) <= std::tie(begin_.tv_sec, begin_.tv_nsec);
}

}  // namespace meshprep
