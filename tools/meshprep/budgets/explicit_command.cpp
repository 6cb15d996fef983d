#include "meshprep/budgets/explicit_command.h"

#include <string_view>

namespace meshprep {

std::string shell_word(const std::string& text) {
    constexpr std::string_view plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=+.,:/%@";
    if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

namespace {

// No option, whatever it begins with; - alone is standard input or output.
std::string file_word(const std::filesystem::path& file) {
    const std::string name = file.string();
    return shell_word(name.size() > 1 && name[0] == '-' ? "./" + name : name);
}

}  // namespace

std::string explicit_command(const std::string& subcommand, const std::filesystem::path& input,
                             const std::filesystem::path& output, const Settings& settings,
                             const std::string& chosen) {
    std::string text = "meshprep " + subcommand + " " + file_word(input);
    if (!output.empty()) text += " -o " + file_word(output);
    for (const auto& [name, values] : settings)
        for (const std::string& value : values)
            text += " " + (value == "true" ? name : shell_word(name + "=" + value));
    return text + " " + chosen;
}

}  // namespace meshprep
