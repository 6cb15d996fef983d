#include "meshprep/budgets/cost_cache.h"

#include <cstdlib>
#include <span>
#include <string_view>
#include <system_error>

#include "meshprep/files/json_depth.h"
#include "prep/files.h"

namespace meshprep {
namespace {

namespace fs = std::filesystem;

constexpr int cache_layout = 1;
constexpr std::size_t most_entries = 16;
constexpr std::uintmax_t most_cache_bytes = std::uintmax_t(1) << 20;
constexpr int most_depth = 8;  // entries' costs are the fifth

// Names of processors are free text: JSON holds UTF-8 only.
std::string printable_ascii(std::string text) {
    for (char& c : text)
        if (c < ' ' || c > '~') c = '?';
    return text;
}

Json entry_of(const CostKey& key, const Json& costs) {
    return {{"kind", key.kind},       {"version", key.version},
            {"build", key.build},     {"processor", printable_ascii(key.processor)},
            {"threads", key.threads}, {"costs", costs}};
}

bool is_of(const Json& entry, const CostKey& key) {
    if (!entry.is_object()) return false;
    const auto same = [&](const char* name, const Json& value) {
        const auto it = entry.find(name);
        return it != entry.end() && *it == value;
    };
    return same("kind", key.kind) && same("version", key.version) && same("build", key.build) &&
           same("processor", printable_ascii(key.processor)) && same("threads", key.threads);
}

// None where it is not of this layout.
Json entries_in(const fs::path& file) {
    std::error_code failed;
    const std::uintmax_t size = fs::file_size(file, failed);
    if (failed || size > most_cache_bytes) return Json::array();
    const auto bytes = prep::read_file(file);
    if (!bytes) return Json::array();
    const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    if (is_nested_deeper(text, most_depth)) return Json::array();
    const Json json = Json::parse(text.begin(), text.end(), nullptr, false);
    if (!json.is_object() || json.value("layout", Json()) != cache_layout) return Json::array();
    const auto entries = json.find("entries");
    return entries != json.end() && entries->is_array() ? *entries : Json::array();
}

}  // namespace

std::optional<fs::path> cost_cache_file() {
    const auto absolute = [](const char* variable) -> std::optional<fs::path> {
        const char* const value = std::getenv(variable);
        if (value == nullptr || !fs::path(value).is_absolute()) return std::nullopt;
        return fs::path(value);
    };
    // The XDG Base Directory Specification: relative paths are no paths.
    auto directory = absolute("XDG_CACHE_HOME");
    if (!directory) {
        directory = absolute("HOME");
        if (!directory) return std::nullopt;
        *directory /= ".cache";
    }
    return *directory / "meshprep" / "costs.json";
}

std::optional<Json> cached_costs(const fs::path& file, const CostKey& key) {
    for (const Json& entry : entries_in(file))
        if (is_of(entry, key) && entry.contains("costs")) return entry["costs"];
    return std::nullopt;
}

prep::Result<void> keep_costs(const fs::path& file, const CostKey& key, const Json& costs) {
    std::error_code failed;
    // A pipe would be waited for, a device written into.
    const fs::file_status status = fs::status(file, failed);
    if (fs::exists(status) && !fs::is_regular_file(status))
        return prep::Error{prep::ErrorCode::io, "this is no regular file", file.string()};
    Json kept = Json::array();
    for (Json& entry : entries_in(file))
        if (!is_of(entry, key)) kept.push_back(std::move(entry));
    while (kept.size() >= most_entries) kept.erase(kept.begin());
    kept.push_back(entry_of(key, costs));
    fs::create_directories(file.parent_path(), failed);
    if (failed) return prep::Error{prep::ErrorCode::io, failed.message(), file.string()};
    const std::string text = Json{{"layout", cache_layout}, {"entries", kept}}.dump(1) + "\n";
    return prep::write_file(file, std::as_bytes(std::span<const char>(text.data(), text.size())));
}

}  // namespace meshprep
