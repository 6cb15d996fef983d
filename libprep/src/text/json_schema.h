// Reading JSON by tables: one table of fields per kind of object, so that every key's type, range
// and meaning stands in one place, unknown keys are found, and every complaint has its JSON
// pointer.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "text/json_pointer.h"
#include "text/suggestions.h"

namespace prep::detail::schema {

using Json = nlohmann::ordered_json;  // keeps the order of the file, so that results follow it

struct Problem {
    std::string pointer;  // "/nodes/2/mesh"
    std::string text;
};
using Outcome = std::optional<Problem>;  // nothing: all is well

// Reads `value` (at `pointer`) into a member of `out`.
template <class T>
using Reader = std::function<Outcome(const Json& value, const std::string& pointer, T& out)>;

template <class T>
struct Field {
    std::string key;
    Reader<T> read;
    bool required = false;
};

template <class T>
using Table = std::vector<Field<T>>;

// A string that names something, with the place it came from for later complaints.
struct Name {
    std::string text;
    std::string pointer;
};

template <class T>
struct Named {
    Name name;
    T value;
};

std::string describe(const Json& value);  // "the string \"abc\"", "an array of 2", …
Problem wrong_type(const Json& value, const std::string& pointer, const std::string& expected);

Outcome read_number(const Json& value, const std::string& pointer, double least, double greatest,
                    double& out);
Outcome read_numbers(const Json& value, const std::string& pointer, std::size_t count, double least,
                     double greatest, double* out);
Outcome read_text(const Json& value, const std::string& pointer, std::string& out);
Outcome read_choice(const Json& value, const std::string& pointer,
                    const std::vector<std::string>& names, std::size_t& out);

// Every key of `value` must be in the table ("comment" is free everywhere), every required one must
// be there.
template <class T>
Outcome read_object(const Json& value, const std::string& pointer, const Table<T>& table, T& out) {
    if (!value.is_object()) return wrong_type(value, pointer, "an object");
    for (const auto& [key, item] : value.items()) {
        if (key == "comment") continue;
        const Field<T>* found = nullptr;
        for (const Field<T>& field : table)
            if (field.key == key) found = &field;
        const std::string place = pointer + "/" + pointer_key(key);
        if (!found) {
            std::vector<std::string> known;
            for (const Field<T>& field : table) known.push_back(field.key);
            return Problem{place, "unknown key '" + key + "'" + suggestion(key, known)};
        }
        if (Outcome problem = found->read(item, place, out)) return problem;
    }
    for (const Field<T>& field : table)
        if (field.required && !value.contains(field.key))
            return Problem{pointer, "the key '" + field.key + "' is missing; add it"};
    return {};
}

// Field makers. Bounds are inclusive.

template <class T, class Number>
Field<T> number(std::string key, Number T::*member, double least, double greatest) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                double read = 0;
                if (Outcome problem = read_number(value, pointer, least, greatest, read))
                    return problem;
                out.*member = static_cast<Number>(read);
                return {};
            }};
}

template <class T>
Field<T> whole(std::string key, std::uint32_t T::*member, std::uint32_t least,
               std::uint32_t greatest) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                double read = 0;
                if (Outcome problem = read_number(value, pointer, least, greatest, read))
                    return problem;
                const auto rounded = static_cast<std::uint32_t>(read);
                if (static_cast<double>(rounded) != read)
                    return Problem{pointer, "expected a whole number, found " + value.dump()};
                out.*member = rounded;
                return {};
            }};
}

// `Vector` is a GLM vector or an optional of one.
template <class T, class Vector>
Field<T> numbers(std::string key, Vector T::*member, double least, double greatest) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                constexpr auto count = static_cast<std::size_t>(Vector::length());
                double read[4] = {};
                if (Outcome problem = read_numbers(value, pointer, count, least, greatest, read))
                    return problem;
                for (std::size_t i = 0; i < count; ++i)
                    (out.*member)[static_cast<int>(i)] =
                        static_cast<typename Vector::value_type>(read[i]);
                return {};
            }};
}

template <class T>
Field<T> flag(std::string key, bool T::*member) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                if (!value.is_boolean()) return wrong_type(value, pointer, "true or false");
                out.*member = value.template get<bool>();
                return {};
            }};
}

template <class T>
Field<T> text(std::string key, std::string T::*member) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                return read_text(value, pointer, out.*member);
            }};
}

template <class T, class Member>
Field<T> name(std::string key, Member T::*member) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                Name read{{}, pointer};
                if (Outcome problem = read_text(value, pointer, read.text)) return problem;
                out.*member = std::move(read);
                return {};
            }};
}

// One of an enum's names.
template <class E>
Outcome read_named(const Json& value, const std::string& pointer, E& out) {
    std::vector<std::string> names;
    for (const auto& entry : names_of(E{})) names.emplace_back(entry.name);
    std::size_t chosen = 0;
    if (Outcome problem = read_choice(value, pointer, names, chosen)) return problem;
    out = names_of(E{})[chosen].value;
    return {};
}
template <class E>
Outcome read_named(const Json& value, const std::string& pointer, std::optional<E>& out) {
    return read_named(value, pointer, out.emplace());
}

// `Value` is an enum with names or an optional of one.
template <class T, class Value>
Field<T> choice(std::string key, Value T::*member) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                return read_named(value, pointer, out.*member);
            }};
}

template <class T, class Inner>
Field<T> object(std::string key, Inner T::*member, Table<Inner> table) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                return read_object(value, pointer, table, out.*member);
            }};
}

template <class T, class Inner>
Field<T> object(std::string key, std::optional<Inner> T::*member, Table<Inner> table) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                out.*member = Inner{};
                return read_object(value, pointer, table, *(out.*member));
            }};
}

// An object whose keys are names that the file chooses.
template <class T, class Inner>
Field<T> dictionary(std::string key, std::vector<Named<Inner>> T::*member, Table<Inner> table) {
    return {std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
                if (!value.is_object()) return wrong_type(value, pointer, "an object of names");
                for (const auto& [item_key, item] : value.items()) {
                    Named<Inner> entry{{item_key, pointer + "/" + pointer_key(item_key)}, {}};
                    if (Outcome problem = read_object(item, entry.name.pointer, table, entry.value))
                        return problem;
                    (out.*member).push_back(std::move(entry));
                }
                return {};
            }};
}

// An array of objects; each remembers its place.
template <class T, class Inner>
Field<T> list(std::string key, std::vector<Named<Inner>> T::*member, Table<Inner> table) {
    return {
        std::move(key), [=](const Json& value, const std::string& pointer, T& out) -> Outcome {
            if (!value.is_array()) return wrong_type(value, pointer, "an array");
            for (std::size_t i = 0; i < value.size(); ++i) {
                Named<Inner> entry{{{}, pointer + "/" + std::to_string(i)}, {}};
                if (Outcome problem = read_object(value[i], entry.name.pointer, table, entry.value))
                    return problem;
                (out.*member).push_back(std::move(entry));
            }
            return {};
        }};
}

template <class T>
Field<T> required(Field<T> field) {
    field.required = true;
    return field;
}

// Text to JSON. A key that an object repeats is an error, as is anything that is not strict JSON or
// nests deeper than 64 levels; `line` and `column` (from 1) say where.
struct ParseProblem {
    std::size_t line = 0, column = 0;
    std::string text;
};
std::optional<ParseProblem> parse(std::string_view text, Json& out);

}  // namespace prep::detail::schema
