#include "meshprep/output/console.h"

#include <fmt/format.h>

#include <algorithm>

namespace meshprep {
namespace {

// Names in files may hold what a terminal obeys, control characters of ASCII and of Latin-1, and
// ends of lines, which would forge lines of ours.
std::string harmless(std::string_view text, std::string_view instead = "?") {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = [&](std::size_t at) {
            return at < text.size() ? static_cast<unsigned char>(text[at]) : 0;
        };
        if (byte(i) == 0xc2 && byte(i + 1) >= 0x80 && byte(i + 1) < 0xa0) {
            out += instead;
            ++i;
        } else if ((byte(i) < 0x20 && byte(i) != '\t') || byte(i) == 0x7f) {
            out += instead;
        } else {
            out += text[i];
        }
    }
    return out;
}

}  // namespace

void Console::clear_progress() {
    if (progress_shown_) err_ << "\r\033[K";
    progress_shown_ = false;
}

void Console::result(const CommonOptions& common, const std::string& line) {
    if (common.json || common.json_lines || common.quiet) return;
    const std::lock_guard lock(mutex_);
    clear_progress();
    *words_ << harmless(line) << '\n';
}

void Console::table(const CommonOptions& common, const std::vector<std::vector<std::string>>& rows,
                    const std::vector<bool>& right) {
    for (const std::string& line : align_table(rows, right)) result(common, line);
}

void Console::json(const std::string& text) {
    const std::lock_guard lock(mutex_);
    out_ << text << '\n';
}

void Console::json_line(const std::string& text) {
    const std::lock_guard lock(mutex_);
    out_ << text << '\n' << std::flush;
}

void Console::bytes(std::string_view bytes) {
    const std::lock_guard lock(mutex_);
    out_.write(bytes.data(), std::streamsize(bytes.size()));
}

void Console::warning(const CommonOptions& common, const std::string& text) {
    if (common.quiet) return;
    const std::lock_guard lock(mutex_);
    clear_progress();
    err_ << "meshprep: warning: " << harmless(text) << '\n';
}

void Console::error(const std::string& text) {
    const std::lock_guard lock(mutex_);
    clear_progress();
    err_ << "meshprep: error: " << harmless(text) << '\n';
}

void Console::error(const prep::Error& e) {
    error(prep::to_string(e));
}

void Console::note(const std::string& subject, std::string_view lines) {
    const std::lock_guard lock(mutex_);
    if (progress_shown_) err_ << "\r\033[K";
    progress_shown_ = false;
    while (!lines.empty()) {
        const std::string_view whole = lines.substr(0, lines.find('\n'));
        lines.remove_prefix(std::min(lines.size(), whole.size() + 1));
        const std::string line = harmless(whole, "");
        if (!line.empty()) err_ << "meshprep: note: " << harmless(subject) << ": " << line << '\n';
    }
}

void Console::progress(const CommonOptions& common, const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (!terminal_ || common.quiet || (text.empty() && !progress_shown_)) return;
    err_ << "\r\033[K" << harmless(text) << std::flush;
    progress_shown_ = !text.empty();
}

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::string duration(double ms) {
    if (ms < 10) return fmt::format("{:.1f} ms", ms);
    if (ms < 1000) return fmt::format("{:.0f} ms", ms);
    return fmt::format("{:.1f} s", ms / 1000);
}

std::string byte_size(std::uint64_t bytes) {
    const double b = static_cast<double>(bytes);
    if (bytes < 1000) return fmt::format("{} B", bytes);
    if (b < 1e6) return fmt::format("{:.1f} kB", b / 1e3);
    if (b < 1e9) return fmt::format("{:.1f} MB", b / 1e6);
    return fmt::format("{:.1f} GB", b / 1e9);
}

std::size_t display_width(const std::string& utf8) {
    return static_cast<std::size_t>(
        std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::vector<std::string> align_table(const std::vector<std::vector<std::string>>& rows,
                                     const std::vector<bool>& right) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()), 0);
        for (std::size_t i = 0; i < row.size(); ++i)
            widths[i] = std::max(widths[i], display_width(row[i]));
    }
    std::vector<std::string> lines;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string pad(widths[i] - display_width(row[i]), ' ');
            const bool to_right = i < right.size() && right[i];
            line += "  ";
            line += to_right ? pad + row[i] : row[i] + pad;
        }
        line.erase(line.find_last_not_of(' ') + 1);
        lines.push_back(std::move(line));
    }
    return lines;
}

}  // namespace meshprep
