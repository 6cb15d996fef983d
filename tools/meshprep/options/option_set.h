// The options of a subcommand. What reads the command line (CLI11) stays behind this header.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "prep/enum_names.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace meshprep {

// Ends the parse with a usage error about `option`.
[[noreturn]] void usage_error(const std::string& option, const std::string& text);

// An option that was added, for what few have.
class Option {
  public:
    explicit Option(CLI::Option* option) : option_(option) {}
    Option required() const;
    Option needs(const Option& other) const;
    Option excludes(const Option& other) const;
    Option when_given(std::function<void()> act) const;
    // Its value in words, the last one; empty where the line has none.
    std::string given() const;

  private:
    CLI::Option* option_;
};

// The options that were given, by their longest names, with their values in words.
using Settings = std::map<std::string, std::vector<std::string>>;

// Names without dashes are arguments by their order. `type` is the help's word for the value.
class OptionSet {
  public:
    explicit OptionSet(CLI::App& app) : app_(app) {}

    void group(const std::string& name) { group_ = name; }  // in help, of what follows
    Option added(const std::string& name) const;            // before
    void examples(const std::string& text);
    // Fills `to` once the command line was read, but for the options named in `without`, those of
    // the group "Common" and arguments by their order.
    void keep_settings(Settings& to, std::vector<std::string> without);

    Option flag(const std::string& name, bool& to, const std::string& help, bool value = true);
    Option path(const std::string& name, std::filesystem::path& to, const std::string& type,
                const std::string& help);
    Option paths(const std::string& name, std::vector<std::filesystem::path>& to,
                 const std::string& type, const std::string& help);
    Option texts(const std::string& name, std::vector<std::string>& to, const std::string& type,
                 const std::string& help);

    // Numbers from `least` to `most`; NaN is none of them.
    Option number(const std::string& name, int& to, int least, int most, const std::string& type,
                  const std::string& help);
    Option number(const std::string& name, std::uint32_t& to, int least, int most,
                  const std::string& type, const std::string& help);
    Option number(const std::string& name, float& to, double least, double most,
                  const std::string& type, const std::string& help);
    Option number(const std::string& name, std::optional<float>& to, double least, double most,
                  const std::string& type, const std::string& help);
    Option not_negative(const std::string& name, std::optional<double>& to, const std::string& type,
                        const std::string& help);
    Option one_of(const std::string& name, int& to, const std::vector<int>& offered,
                  const std::string& type, const std::string& help);

    // A value that `parse` reads; it ends in usage_error() where it cannot.
    Option value(const std::string& name, const std::string& type,
                 std::function<void(const std::string&)> parse, const std::string& help);

    // The same for an option that may be repeated: each value in its turn.
    Option values(const std::string& name, const std::string& type,
                  std::function<void(const std::string&)> parse, const std::string& help);

    // One of some words; anything else is a usage error that lists them.
    Option word(const std::string& name, const std::vector<std::string>& words,
                std::function<void(const std::string&)> store, const std::string& help);
    // One of an enum's names.
    template <class E>
    Option named(const std::string& name, E& to, const std::string& help) {
        std::vector<std::string> words;
        for (const auto& entry : names_of(E{})) words.emplace_back(entry.name);
        return word(
            name, words, [&to](const std::string& text) { to = prep::enum_named<E>(text).value(); },
            help);
    }

  private:
    template <class Number>
    CLI::Option* add_number(const std::string& name, Number& to, const std::string& type,
                            const std::string& help);
    CLI::Option* grouped(CLI::Option* option) const;

    CLI::App& app_;
    std::string group_;
};

}  // namespace meshprep
