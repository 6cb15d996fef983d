#include "meshprep/output/file_records.h"

namespace meshprep {

// "record" says which kind a line is, after the command and its version.
Json FileRecords::line(const char* record) const {
    Json json = json_head(command_);
    json["record"] = record;
    return json;
}

void FileRecords::add(Json file) {
    if (common_.json_lines) {
        Json json = line("file");
        json.update(file);
        console_.json_line(json_line(json));
    } else if (common_.json) {
        files_.push_back(std::move(file));
    }
}

void FileRecords::finish(Json summary) {
    if (common_.json_lines) {
        Json json = line("summary");
        json["summary"] = std::move(summary);
        console_.json_line(json_line(json));
    } else if (common_.json) {
        Json document = json_head(command_);
        document["files"] = std::move(files_);
        document["summary"] = std::move(summary);
        console_.json(json_text(document));
    }
}

int FileRecords::fail(const prep::Error& error, int code) {
    console_.error(error);
    if (common_.json_lines) {
        Json json = line("summary");
        json["error"] = to_json(error);
        console_.json_line(json_line(json));
    } else if (common_.json) {
        Json document = json_head(command_);
        document["error"] = to_json(error);
        console_.json(json_text(document));
    }
    return code;
}

}  // namespace meshprep
