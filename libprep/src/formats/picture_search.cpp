#include "formats/picture_search.h"

#include <algorithm>
#include <cctype>

#include "prep/scene.h"
#include "text/lower_case.h"
#include "text/percent_encoding.h"

namespace prep::detail {
namespace {

namespace fs = std::filesystem;

// Without "..", where that names the same file: behind a link to a directory it does not.
fs::path plain(const fs::path& path) {
    std::error_code ec;
    fs::path shorter = path.lexically_normal();
    return fs::is_regular_file(shorter, ec) ? shorter : path;
}

// Of a name's own folders, in step 3.
constexpr std::size_t most_parts = 32;
// Bytes of places that a search remembers.
constexpr std::size_t most_passed_over = std::size_t(16) << 20;

fs::path joined(fs::path base, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) base /= part;
    return base;
}

// With '/' between its parts, without the blanks and quotes around it, "file://" and the drive.
std::string portable(std::string name) {
    const auto around = [](char c) { return c == ' ' || c == '\t' || c == '"' || c == '\r'; };
    while (!name.empty() && around(name.back())) name.pop_back();
    while (!name.empty() && around(name.front())) name.erase(0, 1);
    std::replace(name.begin(), name.end(), '\\', '/');
    if (lower_case(name.substr(0, 7)) == "file://") name.erase(0, 7);
    const std::size_t drive = name.starts_with('/') ? 1 : 0;
    if (name.size() > drive + 1 && name[drive + 1] == ':' &&
        std::isalpha(static_cast<unsigned char>(name[drive])))
        name = name.substr(drive + 2);
    return name;
}

// Its parts but "." and whatever ".." takes back or would climb out with.
std::vector<std::string> inner_parts(const std::string& name) {
    std::vector<std::string> parts;
    std::size_t begin = 0;
    while (begin <= name.size()) {
        const std::size_t end = std::min(name.find('/', begin), name.size());
        std::string part = name.substr(begin, end - begin);
        if (part == "..") {
            if (!parts.empty()) parts.pop_back();
        } else if (!part.empty() && part != ".") {
            parts.push_back(std::move(part));
        }
        begin = end + 1;
    }
    return parts;
}

}  // namespace

PictureSearch::PictureSearch(fs::path directory, std::vector<fs::path> texture_directories)
    : directory_(std::move(directory)), extra_(std::move(texture_directories)) {}

const std::vector<std::string>& PictureSearch::entries(const fs::path& directory,
                                                       const std::string& name) {
    static const std::vector<std::string> none;
    const auto [it, added] = listings_.try_emplace(directory.string());
    Listing& listing = it->second;
    if (added) {
        std::error_code ec;
        fs::directory_iterator at(directory.empty() ? fs::path(".") : directory, ec), end;
        for (; !ec && at != end; at.increment(ec)) {
            std::string entry = at->path().filename().string();
            listing[lower_case(entry)].push_back(std::move(entry));
        }
        for (auto& [lower, spellings] : listing) std::sort(spellings.begin(), spellings.end());
    }
    const auto found = listing.find(lower_case(name));
    return found == listing.end() ? none : found->second;
}

bool PictureSearch::is_file(const fs::path& path) {
    std::error_code ec;
    if (fs::is_regular_file(path, ec)) return true;
    tried_.push_back(path.string());
    return false;
}

// What is there all the same (a directory; a way back out of a directory that is not there) hides
// nothing by appearing.
void PictureSearch::pass_over_tried() {
    for (const std::string& text : tried_) {
        const fs::path path = fs::path(text).lexically_normal();
        std::error_code ec;
        if (fs::exists(path, ec)) continue;
        if (passed_over_bytes_ > most_passed_over) return;
        if (passed_over_.insert(path).second) passed_over_bytes_ += text.size();
    }
}

std::optional<fs::path> PictureSearch::in_any_case(const fs::path& base,
                                                   const std::vector<std::string>& parts) {
    if (parts.empty()) return std::nullopt;
    if (const fs::path exact = joined(base, parts); is_file(exact)) return plain(exact);
    fs::path path = base;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const auto fits = [&](const fs::path& candidate) {
            std::error_code ec;
            return p + 1 == parts.size() ? fs::is_regular_file(candidate, ec)
                                         : fs::is_directory(candidate, ec);
        };
        fs::path next = path / parts[p];
        if (!fits(next)) {
            const std::vector<std::string>& all = entries(path, parts[p]);
            const auto entry = std::find_if(all.begin(), all.end(),
                                            [&](const std::string& e) { return fits(path / e); });
            if (entry == all.end()) return std::nullopt;
            next = path / *entry;
        }
        path = std::move(next);
    }
    return plain(path);
}

std::vector<fs::path> PictureSearch::sought_directories() const {
    std::vector<fs::path> list{directory_};
    for (const std::string_view folder : picture_folders) list.push_back(directory_ / folder);
    for (const std::string_view folder : picture_folders)
        list.push_back(directory_ / ".." / folder);
    list.insert(list.end(), extra_.begin(), extra_.end());
    return list;
}

std::optional<fs::path> PictureSearch::search(const std::string& name) {
    // operator/ takes an absolute path for itself.
    if (is_file(directory_ / name)) return plain(directory_ / name);
    std::vector<std::string> spellings{portable(name)};
    if (std::string decoded = percent_decoded(spellings[0]); decoded != spellings[0])
        spellings.push_back(std::move(decoded));
    for (const std::string& spelling : spellings)
        if (!spelling.empty() && is_file(directory_ / spelling))
            return plain(directory_ / spelling);
    for (const std::string& spelling : spellings) {
        // "../maps/A.png" where "../Maps/a.png" is: the way up is written, not guessed.
        std::vector<std::string> parts = inner_parts(spelling);
        std::string_view rest = spelling;
        fs::path base = directory_;
        while (rest.starts_with("../") || rest.starts_with("./")) {
            if (rest.starts_with("../")) base /= "..";
            rest.remove_prefix(rest.find('/') + 1);
        }
        if (base != directory_)
            if (auto path = in_any_case(base, inner_parts(std::string(rest)))) return path;
        if (parts.size() > most_parts)
            parts.erase(parts.begin(), parts.end() - std::ptrdiff_t(most_parts));
        for (; !parts.empty(); parts.erase(parts.begin()))
            for (const fs::path& place : sought_directories()) {
                std::error_code ec;
                fs::path there = place;
                // The folders themselves may be in capitals: "Textures".
                if (!fs::is_directory(there.empty() ? fs::path(".") : there, ec)) {
                    tried_.push_back(joined(place, parts).string());
                    const auto& all = entries(place.parent_path(), place.filename().string());
                    if (all.empty()) continue;
                    there = place.parent_path() / all.front();
                }
                if (auto path = in_any_case(there, parts)) return path;
            }
    }
    return std::nullopt;
}

std::optional<fs::path> PictureSearch::locate(const std::string& name) {
    constexpr std::size_t longest = 4096;  // no system has longer paths
    if (name.empty() || name.size() > longest || name.find('\0') != std::string::npos)
        return std::nullopt;
    const auto known = known_.find(name);
    if (known != known_.end()) return known->second;
    std::optional<fs::path> found = search(name);
    if (found) pass_over_tried();
    tried_.clear();
    return known_.emplace(name, std::move(found)).first->second;
}

fs::path PictureSearch::find(const std::string& name) {
    if (auto path = locate(name)) return *std::move(path);
    if (is_missing_.insert(name).second) missing_.push_back(name);
    return (directory_ / portable(name)).lexically_normal();
}

std::vector<std::string> PictureSearch::warnings() const {
    if (missing_.empty()) return {};
    // Whole names, as far as a line of a terminal or two can take them.
    constexpr std::size_t most = 12, longest = 120;
    std::string names;
    for (std::size_t i = 0; i < std::min(most, missing_.size()); ++i) {
        std::string name = missing_[i].substr(0, longest);
        if (missing_[i].size() > longest) name += "...";
        std::replace_if(
            name.begin(), name.end(),
            [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }, '?');
        names += (names.empty() ? "" : ", ") + name;
    }
    if (missing_.size() > most) names += " and " + std::to_string(missing_.size() - most) + " more";
    std::string folders;
    for (const std::string_view folder : picture_folders)
        folders += (folders.empty() ? "" : ", ") + std::string(folder);
    const std::string own = directory_.empty() ? "." : directory_.string();
    std::string text =
        (missing_.size() == 1 ? "a picture was not found: "
                              : std::to_string(missing_.size()) + " pictures were not found: ") +
        names + "; sought in '" + own + "', its folders " + folders + " and those beside it";
    for (const fs::path& directory : extra_) text += ", '" + directory.string() + "'";
    return {text + (extra_.empty() ? "; --texture-dir names more places" : "")};
}

void PictureSearch::tell(Scene& scene) const {
    for (std::string& warning : warnings()) scene.warnings.push_back(std::move(warning));
    // Where there were too many to remember, none of them is known to be still missing.
    scene.library_missing |= passed_over_bytes_ > most_passed_over;
    scene.passed_over.insert(scene.passed_over.end(), passed_over_.begin(), passed_over_.end());
}

}  // namespace prep::detail
