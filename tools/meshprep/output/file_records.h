// What a subcommand that takes several files says of each in JSON: one document with --json, a line
// for each file with --json-lines.
#pragma once

#include "meshprep/output/console.h"
#include "meshprep/output/report_json.h"

namespace meshprep {

class FileRecords {
  public:
    FileRecords(const char* command, const CommonOptions& common, Console& console)
        : command_(command), common_(common), console_(console) {}

    bool wanted() const { return common_.json || common_.json_lines; }
    void add(Json file);
    // The end: the document with its summary, or the last line.
    void finish(Json summary);
    // The end where nothing was done; says the error in words, too, and gives `code` back.
    int fail(const prep::Error& error, int code);

  private:
    Json line(const char* record) const;

    const char* command_;
    const CommonOptions& common_;
    Console& console_;
    Json files_ = Json::array();
};

}  // namespace meshprep
