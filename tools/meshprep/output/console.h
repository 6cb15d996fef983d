// Where a subcommand says things: results to `out`, messages to `err`, progress to `err` when that
// is a terminal. Streams, so that tests can listen. For any threads.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "meshprep/options/common_options.h"
#include "prep/result.h"
#include "sheets/sheet.h"

namespace meshprep {

class Console {
  public:
    Console(std::ostream& out, std::ostream& err, bool err_is_terminal)
        : out_(out), err_(err), terminal_(err_is_terminal) {}

    // A line of results in words; silent with --json or --quiet.
    void result(const CommonOptions& common, const std::string& line);
    // The same for a table's lines, by align_table().
    void table(const CommonOptions& common, const std::vector<std::vector<std::string>>& rows,
               const std::vector<bool>& right);
    // The JSON document, or a line of --json-lines, which leaves at once; only with either.
    void json(const std::string& text);
    void json_line(const std::string& text);
    // Results in words go to `err` from now on: a mesh is written to `out`.
    void keep_output_for_bytes() { words_ = &err_; }
    void bytes(std::string_view bytes);
    // "meshprep: warning: …" and "meshprep: error: …"; the latter also with --quiet.
    void warning(const CommonOptions& common, const std::string& text);
    void error(const std::string& text);
    void error(const prep::Error& error);
    // "meshprep: note: SUBJECT: …", once for each line of the text, without its control characters.
    void note(const std::string& subject, std::string_view lines);
    // Overwrites the terminal's last line; empty clears it. Silent elsewhere.
    void progress(const CommonOptions& common, const std::string& text);

  private:
    void clear_progress();

    std::mutex mutex_;
    std::ostream& out_;
    std::ostream& err_;
    std::ostream* words_ = &out_;
    bool terminal_;
    bool progress_shown_ = false;
};

using report::count_of;
using report::with_commas;
using Clock = std::chrono::steady_clock;
double milliseconds_since(Clock::time_point start);
// "0.4 ms", "12 ms", "3.4 s".
std::string duration(double milliseconds);
// "12 B", "3.4 MB".
std::string byte_size(std::uint64_t bytes);

// Columns padded to their widest cell; numbers to the right where `right` says so. Two spaces
// between columns and in front.
std::vector<std::string> align_table(const std::vector<std::vector<std::string>>& rows,
                                     const std::vector<bool>& right);

// Characters as a terminal counts them: code points.
std::size_t display_width(const std::string& utf8);

}  // namespace meshprep
