#include "meshprep/options/option_set.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "meshprep/options/values.h"
#include "text/suggestions.h"

namespace meshprep {
namespace {

// Unlike CLI::Range it lets no NaN through.
CLI::Validator number_from_to(double least, double most) {
    return CLI::Validator(
        [least, most](std::string& text) -> std::string {
            const std::vector<double> numbers = parse_numbers(text, ',');
            if (numbers.size() == 1 && numbers[0] >= least && numbers[0] <= most) return {};
            std::ostringstream message;
            message << "'" << text << "' is not a number from " << least << " to " << most;
            return message.str();
        },
        "");
}

// The same for whole numbers.
CLI::Validator whole_number_from_to(int least, int most) {
    return CLI::Validator(
        [least, most](std::string& text) -> std::string {
            const std::vector<double> numbers = parse_numbers(text, ',');
            if (numbers.size() == 1 && numbers[0] == std::floor(numbers[0]) &&
                numbers[0] >= least && numbers[0] <= most) {
                text = std::to_string(static_cast<long long>(numbers[0]));  // "1e2" is one, too
                return {};
            }
            return "'" + text + "' is not a whole number from " + std::to_string(least) + " to " +
                   std::to_string(most);
        },
        "");
}

// What a shell makes of a variable that is not set: no file, no name and no list.
CLI::Validator not_empty() {
    return CLI::Validator(
        [](std::string& text) -> std::string { return text.empty() ? "the value is empty" : ""; },
        "");
}

CLI::Validator not_negative_number() {
    return CLI::Validator(
        [](std::string& text) -> std::string {
            const std::vector<double> numbers = parse_numbers(text, ',');
            if (numbers.size() == 1 && numbers[0] >= 0) return {};
            return "'" + text + "' is not a number of 0 or more";
        },
        "");
}

CLI::Validator one_of_numbers(const std::vector<int>& offered) {
    return CLI::Validator(
        [offered](std::string& text) -> std::string {
            std::string list;
            for (const int number : offered) {
                if (text == std::to_string(number)) return {};
                list += (list.empty() ? "" : ", ") + std::to_string(number);
            }
            return "'" + text + "' is not one of " + list;
        },
        "");
}

}  // namespace

void usage_error(const std::string& option, const std::string& text) {
    throw CLI::ValidationError(option, text);
}

Option Option::required() const {
    option_->required();
    return *this;
}

Option Option::needs(const Option& other) const {
    option_->needs(other.option_);
    return *this;
}

Option Option::excludes(const Option& other) const {
    option_->excludes(other.option_);
    return *this;
}

Option Option::when_given(std::function<void()> act) const {
    option_->each([act = std::move(act)](const std::string&) { act(); });
    return *this;
}

std::string Option::given() const {
    const std::vector<std::string>& values = option_->results();
    return values.empty() ? std::string() : values.back();
}

Option OptionSet::added(const std::string& name) const {
    return Option(app_.get_option(name));
}

CLI::Option* OptionSet::grouped(CLI::Option* option) const {
    if (!group_.empty()) option->group(group_);
    return option;
}

void OptionSet::examples(const std::string& text) {
    app_.footer("Examples:\n" + text);
}

void OptionSet::keep_settings(Settings& to, std::vector<std::string> without) {
    app_.final_callback([&app = app_, &to, without = std::move(without)] {
        for (const CLI::Option* const option : app.get_options()) {
            if (option->count() == 0 || option->get_positional() || option->get_group() == "Common")
                continue;
            const std::string name = option->get_name();
            if (std::find(without.begin(), without.end(), name) == without.end())
                to[name] = option->results();
        }
    });
}

Option OptionSet::flag(const std::string& name, bool& to, const std::string& help, bool value) {
    return Option(grouped(value ? app_.add_flag(name, to, help)
                                : app_.add_flag_callback(
                                      name, [&to] { to = false; }, help)));
}

Option OptionSet::path(const std::string& name, std::filesystem::path& to, const std::string& type,
                       const std::string& help) {
    return Option(grouped(app_.add_option(name, to, help)->type_name(type)->check(not_empty())));
}

Option OptionSet::paths(const std::string& name, std::vector<std::filesystem::path>& to,
                        const std::string& type, const std::string& help) {
    return Option(grouped(app_.add_option(name, to, help)->type_name(type)->check(not_empty())));
}

// CLI11 takes "[a,b]" for a list where an option may have several values at once.
Option OptionSet::texts(const std::string& name, std::vector<std::string>& to,
                        const std::string& type, const std::string& help) {
    return Option(grouped(app_.add_option(name, to, help)
                              ->type_name(type)
                              ->expected(1)
                              ->allow_extra_args(false)
                              ->take_all()
                              ->check(not_empty())));
}

template <class Number>
CLI::Option* OptionSet::add_number(const std::string& name, Number& to, const std::string& type,
                                   const std::string& help) {
    return grouped(app_.add_option(name, to, help)->type_name(type));
}

Option OptionSet::number(const std::string& name, int& to, int least, int most,
                         const std::string& type, const std::string& help) {
    return Option(add_number(name, to, type, help)->check(whole_number_from_to(least, most)));
}

Option OptionSet::number(const std::string& name, std::uint32_t& to, int least, int most,
                         const std::string& type, const std::string& help) {
    return Option(add_number(name, to, type, help)->check(whole_number_from_to(least, most)));
}

Option OptionSet::number(const std::string& name, float& to, double least, double most,
                         const std::string& type, const std::string& help) {
    return Option(add_number(name, to, type, help)->check(number_from_to(least, most)));
}

Option OptionSet::number(const std::string& name, std::optional<float>& to, double least,
                         double most, const std::string& type, const std::string& help) {
    return Option(add_number(name, to, type, help)->check(number_from_to(least, most)));
}

Option OptionSet::not_negative(const std::string& name, std::optional<double>& to,
                               const std::string& type, const std::string& help) {
    return Option(add_number(name, to, type, help)->check(not_negative_number()));
}

Option OptionSet::one_of(const std::string& name, int& to, const std::vector<int>& offered,
                         const std::string& type, const std::string& help) {
    return Option(add_number(name, to, type, help)->check(one_of_numbers(offered)));
}

Option OptionSet::value(const std::string& name, const std::string& type,
                        std::function<void(const std::string&)> parse, const std::string& help) {
    return Option(grouped(app_.add_option_function<std::string>(name, std::move(parse), help)
                              ->type_name(type)
                              ->check(not_empty())));
}

Option OptionSet::values(const std::string& name, const std::string& type,
                         std::function<void(const std::string&)> parse, const std::string& help) {
    const auto each = [parse = std::move(parse)](const std::vector<std::string>& texts) {
        for (const std::string& text : texts) parse(text);
    };
    return Option(grouped(app_.add_option_function<std::vector<std::string>>(name, each, help)
                              ->type_name(type)
                              ->expected(1)
                              ->allow_extra_args(false)
                              ->take_all()
                              ->check(not_empty())));
}

Option OptionSet::word(const std::string& name, const std::vector<std::string>& words,
                       std::function<void(const std::string&)> store, const std::string& help) {
    std::string list;
    for (const std::string& word : words) list += (list.empty() ? "" : "|") + word;
    const auto check = [words, list](std::string& text) -> std::string {
        if (std::find(words.begin(), words.end(), text) != words.end()) return {};
        const std::string near = prep::detail::nearest_name(text, words);
        return "'" + text + "' is not one of " + list +
               (near.empty() ? "" : "; did you mean '" + near + "'?");
    };
    return Option(grouped(app_.add_option_function<std::string>(name, std::move(store), help)
                              ->check(CLI::Validator(check, ""))
                              ->type_name(list)));
}

}  // namespace meshprep
