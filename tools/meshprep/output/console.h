// Where a subcommand says things: results to `out`, messages to `err`, progress to `err` when that
// is a terminal. Streams, so that tests can listen.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "meshprep/options/common_options.h"
#include "prep/result.h"

namespace meshprep {

class Console {
  public:
    Console(std::ostream& out, std::ostream& err, bool err_is_terminal)
        : out_(out), err_(err), terminal_(err_is_terminal) {}

    // A line of results in words; silent with --json or --quiet.
    void result(const CommonOptions& common, const std::string& line);
    // The JSON document; only with --json.
    void json(const std::string& text);
    // "meshprep: warning: …" and "meshprep: error: …"; the latter also with --quiet.
    void warning(const CommonOptions& common, const std::string& text);
    void error(const std::string& text);
    void error(const prep::Error& error);
    // Overwrites the terminal's last line; empty clears it. Silent elsewhere.
    void progress(const CommonOptions& common, const std::string& text);

  private:
    std::ostream& out_;
    std::ostream& err_;
    bool terminal_;
    bool progress_shown_ = false;
};

// "12,345".
std::string with_commas(std::uint64_t value);
// "1 face", "2 faces": `plural` only where it is not an added s.
std::string count_of(std::uint64_t value, const std::string& singular,
                     const std::string& plural = {});
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
