#include "meshprep/files/sheet_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "meshprep/files/file_list.h"

namespace meshprep {
namespace {

// Letters, digits, dot, dash and underscore survive in file names; the rest becomes a dash.
std::string file_word(const std::string& text) {
    std::string word;
    for (const char c : text) {
        const bool good = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                          (c >= 'A' && c <= 'Z') || c == '.' || c == '_';
        if (good)
            word += c;
        else if (!word.empty() && word.back() != '-')
            word += '-';
    }
    while (!word.empty() && (word.back() == '-' || word.back() == '.')) word.pop_back();
    return word;
}

// A name that a file can have with an ending: of longer ones the rest is a hash.
std::string short_enough(const std::string& name) {
    constexpr std::size_t most = 255 - 5;  // ".html"
    if (name.size() <= most) return name;
    std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    std::size_t kept = most - 17;
    while (kept > 0 && (static_cast<unsigned char>(name[kept]) & 0xc0) == 0x80) --kept;  // UTF-8
    return fmt::format("{}-{:016x}", name.substr(0, kept), hash);
}

}  // namespace

std::vector<std::string> page_stems(const std::vector<std::filesystem::path>& inputs) {
    std::vector<std::string> stems;
    std::set<std::string> taken;
    for (const std::filesystem::path& input : inputs) {
        const std::filesystem::path named = is_standard_stream(input) ? "stdin" : input;
        std::string stem = named.stem().string();
        if (!taken.insert(stem).second) stem = named.filename().string();
        if (stem != named.stem().string() && !taken.insert(stem).second) stem.clear();
        stems.push_back(short_enough(stem));
    }
    return stems;
}

std::string sheet_stem(const std::string& stem, std::uint32_t number, const std::string& name) {
    const std::string numbered = fmt::format("{}-{}", stem, number);
    std::string word = file_word(name);
    if (!word.empty()) word.insert(0, "-");
    return short_enough((numbered + word).substr(0, std::max<std::size_t>(60, numbered.size())));
}

}  // namespace meshprep
