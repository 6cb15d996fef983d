#include "meshprep/files/manifest.h"

#include <algorithm>
#include <string_view>

#include "meshprep/files/json_depth.h"
#include "meshprep/files/sha256.h"
#include "prep/files.h"
#include "prep/version.h"

namespace meshprep {
namespace {

using Json = nlohmann::ordered_json;
using prep::Error;
using prep::ErrorCode;
using prep::Result;

constexpr int format_version = 1;
constexpr int deepest_manifest = 64;  // values of findings are the ninth at most

Json to_json(const std::vector<HashedFile>& files) {
    Json list = Json::array();
    for (const HashedFile& file : files)
        list.push_back(
            {{"path", file.path}, {"sha256", file.sha256 ? Json(*file.sha256) : Json(nullptr)}});
    return list;
}

Json to_json(const Settings& settings) {
    Json json = Json::object();
    for (const auto& [name, values] : settings) json[name] = values;
    return json;
}

std::string text_of(const Json& json, const char* key) {
    const auto it = json.find(key);
    return it != json.end() && it->is_string() ? it->get<std::string>() : std::string();
}

std::vector<HashedFile> files_of(const Json& json, const char* key) {
    std::vector<HashedFile> files;
    const auto list = json.find(key);
    if (list == json.end() || !list->is_array()) return files;
    for (const Json& file : *list) {
        if (!file.is_object()) continue;
        const std::string hash = text_of(file, "sha256");
        files.push_back({text_of(file, "path"), hash.empty() ? std::nullopt : std::optional(hash)});
    }
    return files;
}

std::vector<std::string> texts_of(const Json& json, const char* key) {
    std::vector<std::string> texts;
    const auto list = json.find(key);
    if (list == json.end() || !list->is_array()) return texts;
    for (const Json& text : *list)
        if (text.is_string()) texts.push_back(text.get<std::string>());
    return texts;
}

bool is_there(const std::string& path) {
    std::error_code ec;
    return std::filesystem::exists(path, ec);
}

bool as_it_was(const HashedFile& file) {
    return file.sha256 && hashed(file.path).sha256 == file.sha256;
}

// Null where it is none.
Json manifest_of(const std::vector<std::byte>& bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (is_nested_deeper(text, deepest_manifest)) return {};
    Json json = Json::parse(text.begin(), text.end(), nullptr, false);
    if (!json.is_object() || !json.contains("manifest") || !json.contains("files")) return {};
    return json;
}

}  // namespace

HashedFile hashed(const std::filesystem::path& path) {
    const Result<std::string> hash = sha256_of_file(path);
    return {path.string(), hash ? std::optional(*hash) : std::nullopt};
}

bool Manifest::is_one(const std::filesystem::path& path) {
    const Result<std::vector<std::byte>> bytes = prep::read_file(path);
    return bytes && !manifest_of(*bytes).is_null();
}

Result<void> Manifest::read(const std::filesystem::path& path) {
    std::error_code ec;
    if (!std::filesystem::exists(path, ec)) return {};
    const Result<std::vector<std::byte>> bytes = prep::read_file(path);
    if (!bytes) return bytes.error();
    const Json json = manifest_of(*bytes);
    if (json.is_null())
        return Error{ErrorCode::syntax,
                     "this is no manifest of meshprep, or a damaged one; remove it or name another",
                     path.string()};
    // Another version or other settings may make other files of the same inputs.
    const auto settings = json.find("settings");
    if (json["manifest"] != format_version || text_of(json, "version") != prep::version() ||
        settings == json.end() || *settings != to_json(settings_) || !json["files"].is_array())
        return {};
    for (const Json& file : json["files"]) {
        if (!file.is_object() || text_of(file, "status") != "ok") continue;
        ManifestEntry entry;
        entry.job.input = text_of(file, "input");
        entry.job.output = text_of(file, "output");
        entry.sources = files_of(file, "sources");
        entry.absent = texts_of(file, "absent");
        entry.outputs = files_of(file, "outputs");
        const auto complete = file.find("complete"), said = file.find("said");
        entry.complete = complete != file.end() && *complete == true;
        if (said != file.end()) entry.said = *said;
        set(std::move(entry));
    }
    return {};
}

std::optional<ManifestEntry> Manifest::finished(const Job& job) const {
    const auto found = entries_.find({job.input.string(), job.output.string()});
    if (found == entries_.end()) return std::nullopt;
    const ManifestEntry& entry = found->second;
    const bool good = !entry.job.error && entry.complete && !entry.sources.empty() &&
                      !entry.outputs.empty() &&
                      std::all_of(entry.sources.begin(), entry.sources.end(), as_it_was) &&
                      std::all_of(entry.outputs.begin(), entry.outputs.end(), as_it_was) &&
                      std::none_of(entry.absent.begin(), entry.absent.end(), is_there);
    return good ? std::optional(entry) : std::nullopt;
}

bool Manifest::has_done(const Job& job) const {
    const auto found = entries_.find({job.input.string(), job.output.string()});
    return found != entries_.end() && !found->second.job.error && found->second.complete;
}

void Manifest::set(ManifestEntry entry) {
    Key key{entry.job.input.string(), entry.job.output.string()};
    const auto [place, fresh] = entries_.insert_or_assign(key, std::move(entry));
    if (fresh) order_.push_back(std::move(key));
}

Result<void> Manifest::write(const std::filesystem::path& path) const {
    const std::filesystem::path own = identity_of(path);
    for (const auto& [key, entry] : entries_)
        for (const HashedFile& output : entry.outputs)
            if (identity_of(output.path) == own)
                return Error{ErrorCode::invalid,
                             "the manifest would be written over this output of " + key.first +
                                 "; give it another name",
                             path.string()};
    Json json;
    json["manifest"] = format_version;
    json["version"] = std::string(prep::version());
    json["settings"] = to_json(settings_);
    json["files"] = Json::array();
    std::vector<Key> sorted = order_;
    std::sort(sorted.begin(), sorted.end());
    for (const Key& key : sorted) {
        const ManifestEntry& entry = entries_.at(key);
        Json file;
        file["input"] = entry.job.input.string();
        file["output"] = entry.job.output.string();
        file["status"] = entry.job.error ? "failed" : "ok";
        if (entry.job.error)
            file["error"] = {{"code", std::string(prep::to_string(entry.job.error->code))},
                             {"text", entry.job.error->text},
                             {"place", entry.job.error->place}};
        file["sources"] = to_json(entry.sources);
        if (!entry.absent.empty()) file["absent"] = entry.absent;
        file["outputs"] = to_json(entry.outputs);
        file["complete"] = entry.complete;
        file["said"] = entry.said;
        json["files"].push_back(std::move(file));
    }
    const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
    return prep::write_file(path, std::as_bytes(std::span<const char>(text)));
}

}  // namespace meshprep
