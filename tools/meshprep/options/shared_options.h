// Pieces of the command line that several subcommands share: options whose values are words,
// numbers and colours.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "meshprep/options/arguments.h"
#include "meshprep/options/enum_names.h"

namespace meshprep {

// An option whose values are words; anything else is a usage error that lists them.
template <class Value>
CLI::Option* add_words(CLI::App* app, const std::string& name, const Words<Value>& words,
                       std::function<void(const Value&)> store, const std::string& help) {
    std::string list;
    for (const auto& word : words) list += (list.empty() ? "" : "|") + word.first;
    const auto check = [words, list](std::string& text) -> std::string {
        for (const auto& word : words)
            if (word.first == text) return {};
        return "'" + text + "' is not one of " + list;
    };
    return app
        ->add_option_function<std::string>(
            name,
            [words, store](const std::string& text) {
                for (const auto& word : words)
                    if (word.first == text) store(word.second);
            },
            help)
        ->check(CLI::Validator(check, ""))
        ->type_name(list);
}

// Ends the parse with a usage error about `option`.
[[noreturn]] void usage_error(const std::string& option, const std::string& text);

// "1,2.5" → numbers; empty when any piece is none, or not finite.
std::vector<double> parse_numbers(const std::string& text, char separator);

// #rrggbb (sRGB), R,G,B or one grey (linear) → linear.
glm::vec3 parse_color(const std::string& option, const std::string& text);

// A number in a range; unlike CLI::Range it lets no NaN through.
CLI::Validator number_from_to(double least, double most);

void add_common_options(CLI::App* app, CommonOptions& common);
void add_preparation_options(CLI::App* app, prep::PrepareOptions& options);

}  // namespace meshprep
