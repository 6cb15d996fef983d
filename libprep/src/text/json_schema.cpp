#include "text/json_schema.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <memory>
#include <set>

namespace prep::detail::schema {
namespace {

std::string shortest(double value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string range_text(double least, double greatest) {
    if (greatest >= 1e30 && least <= -1e30) return "a finite number";
    if (greatest >= 1e30) return "a number from " + shortest(least) + " up";
    return "a number from " + shortest(least) + " to " + shortest(greatest);
}

}  // namespace

std::string describe(const Json& value) {
    switch (value.type()) {
        case Json::value_t::null:
            return "null";
        case Json::value_t::object:
            return "an object";
        case Json::value_t::array:
            return "an array of " + std::to_string(value.size());
        case Json::value_t::string: {
            const std::string& text = value.get_ref<const std::string&>();
            return "the string '" + (text.size() > 40 ? text.substr(0, 37) + "..." : text) + "'";
        }
        default:
            return value.dump();
    }
}

Problem wrong_type(const Json& value, const std::string& pointer, const std::string& expected) {
    return {pointer, "expected " + expected + ", found " + describe(value)};
}

Outcome read_number(const Json& value, const std::string& pointer, double least, double greatest,
                    double& out) {
    if (!value.is_number()) return wrong_type(value, pointer, range_text(least, greatest));
    const double read = value.get<double>();
    // Where range_text() does not name the limit.
    if (std::isfinite(read) && greatest >= 1e30 &&
        (read > greatest || (read < least && least <= -1e30)))
        return Problem{pointer, "expected a number of at most " + shortest(greatest) +
                                    " in size, found " + value.dump() + ", which is too large"};
    if (!(read >= least && read <= greatest) || !std::isfinite(read))
        return Problem{pointer,
                       "expected " + range_text(least, greatest) + ", found " + value.dump()};
    out = read;
    return {};
}

Outcome read_numbers(const Json& value, const std::string& pointer, std::size_t count, double least,
                     double greatest, double* out) {
    if (!value.is_array() || value.size() != count)
        return wrong_type(value, pointer, "an array of " + std::to_string(count) + " numbers");
    for (std::size_t i = 0; i < count; ++i)
        if (Outcome problem =
                read_number(value[i], pointer + "/" + std::to_string(i), least, greatest, out[i]))
            return problem;
    return {};
}

Outcome read_text(const Json& value, const std::string& pointer, std::string& out) {
    if (!value.is_string()) return wrong_type(value, pointer, "a string");
    out = value.get<std::string>();
    if (out.empty()) return Problem{pointer, "expected a string, found an empty one"};
    return {};
}

Outcome read_choice(const Json& value, const std::string& pointer,
                    const std::vector<std::string>& names, std::size_t& out) {
    std::string expected = "one of ";
    for (std::size_t i = 0; i < names.size(); ++i) expected += (i == 0 ? "" : ", ") + names[i];
    if (!value.is_string()) return wrong_type(value, pointer, expected);
    const std::string found = value.get<std::string>();
    const auto at = std::find(names.begin(), names.end(), found);
    if (at == names.end()) {
        const std::string near = nearest_name(found, names);
        return Problem{pointer, "expected " + expected + ", found '" + found + "'" +
                                    (near.empty() ? "" : "; did you mean '" + near + "'?")};
    }
    out = static_cast<std::size_t>(at - names.begin());
    return {};
}

namespace {

// Thrown by the watcher below, caught in parse(): the parser has no other way to be stopped.
struct Stop {
    std::string text;
};

// Sees what cannot be told from the finished value: repeated keys, and depth before it is reached.
class Watcher {
  public:
    bool operator()(int depth, Json::parse_event_t event, Json& value) {
        constexpr int deepest = 64;
        switch (event) {
            case Json::parse_event_t::object_start:
                keys_.emplace_back();
                [[fallthrough]];
            case Json::parse_event_t::array_start:
                if (depth >= deepest) throw Stop{"nested deeper than 64 levels"};
                break;
            case Json::parse_event_t::object_end:
                keys_.pop_back();
                break;
            case Json::parse_event_t::key: {
                const std::string& name = value.get_ref<const std::string&>();
                if (!keys_.back().insert(name).second)
                    throw Stop{"the key '" + name +
                               "' is given twice in one object; keep one of them"};
                break;
            }
            default:
                break;
        }
        return true;
    }

  private:
    std::vector<std::set<std::string>> keys_;
};

// The library's message without its own code and position, which we give in our way:
// "[json.exception.parse_error.101] parse error at line 1, column 3: syntax error while …".
std::string plain_message(const std::string& message) {
    // "[what kind] where: what", or without a place.
    std::size_t begin = message.find(": ");
    if (begin == std::string::npos && message.starts_with('[')) begin = message.find("] ");
    return begin == std::string::npos ? message : message.substr(begin + 2);
}

// Counts what the parser has consumed, so that complaints of our own have a position too.
struct Counter {
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;
    const char* at;
    const char* begin;
    std::size_t* furthest;
    const char& operator*() const { return *at; }
    Counter& operator++() {
        ++at;
        *furthest = std::max(*furthest, static_cast<std::size_t>(at - begin));
        return *this;
    }
    Counter operator++(int) {
        Counter old = *this;
        ++*this;
        return old;
    }
    bool operator==(const Counter& other) const { return at == other.at; }
    bool operator!=(const Counter& other) const { return at != other.at; }
};

}  // namespace

std::optional<ParseProblem> parse(std::string_view text, Json& out) {
    std::size_t furthest = 0;
    const char* const begin = text.data();
    const Counter first{begin, begin, &furthest};
    const Counter last{begin + text.size(), begin, &furthest};
    std::string complaint;
    std::size_t position = 0;
    auto watcher = std::make_shared<Watcher>();
    try {
        out =
            Json::parse(first, last, [watcher](int depth, Json::parse_event_t event, Json& value) {
                return (*watcher)(depth, event, value);
            });
        // To the parser a NUL is the end; no JSON text has one.
        position = text.find('\0');
        if (position == std::string_view::npos) return {};
        complaint = "a NUL byte";
        ++position;
    } catch (const Stop& stop) {
        complaint = stop.text;
        position = furthest;
    } catch (const Json::parse_error& error) {
        complaint = plain_message(error.what());
        position = error.byte;
    } catch (const Json::exception& error) {
        complaint = plain_message(error.what());
        position = furthest;
    }
    ParseProblem problem{1, 1, complaint};
    for (std::size_t i = 0; i + 1 < position && i < text.size(); ++i) {
        if (text[i] == '\n') {
            ++problem.line;
            problem.column = 1;
        } else {
            ++problem.column;
        }
    }
    return problem;
}

}  // namespace prep::detail::schema
