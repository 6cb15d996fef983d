#include "json_schema_check.h"

#include <algorithm>

namespace test {
namespace {

using nlohmann::json;

bool is_of_type(const json& value, const std::string& type) {
    if (type == "integer") return value.is_number_integer();
    if (type == "number") return value.is_number();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "array") return value.is_array();
    if (type == "object") return value.is_object();
    return type == "null" && value.is_null();
}

class Check {
  public:
    explicit Check(const json& root) : root_(root) {}

    std::vector<std::string> of(const json& value, const json& schema,
                                const std::string& at) const {
        std::vector<std::string> out;
        const auto complain = [&](const std::string& text) { out.push_back(at + ": " + text); };
        const auto append = [&](std::vector<std::string> more) {
            out.insert(out.end(), more.begin(), more.end());
        };
        for (const auto& [keyword, rule] : schema.items()) {
            if (keyword == "type") {
                bool good = false;
                for (const json& type : rule.is_array() ? rule : json::array({rule}))
                    good |= is_of_type(value, type.get<std::string>());
                if (!good) complain("is " + value.dump() + ", not " + rule.dump());
            } else if (keyword == "const") {
                if (value != rule) complain("is " + value.dump() + ", not " + rule.dump());
            } else if (keyword == "enum") {
                if (std::find(rule.begin(), rule.end(), value) == rule.end())
                    complain("is " + value.dump() + ", none of " + rule.dump());
            } else if (keyword == "required") {
                for (const json& name : rule)
                    if (!value.is_object() || !value.contains(name.get<std::string>()))
                        complain("has no " + name.dump());
            } else if (keyword == "properties") {
                for (const auto& [name, inner] : rule.items())
                    if (value.is_object() && value.contains(name))
                        append(of(value[name], inner, at + "/" + name));
            } else if (keyword == "additionalProperties") {
                if (!value.is_object()) continue;
                for (const auto& [name, inner] : value.items()) {
                    if (schema.contains("properties") && schema["properties"].contains(name))
                        continue;
                    if (rule == false) complain("has " + name + ", which the schema has not");
                    if (rule.is_object()) append(of(inner, rule, at + "/" + name));
                }
            } else if (keyword == "items") {
                if (!value.is_array()) continue;
                for (std::size_t i = 0; i < value.size(); ++i)
                    append(of(value[i], rule, at + "/" + std::to_string(i)));
            } else if (keyword == "minimum" || keyword == "maximum") {
                if (!value.is_number()) continue;
                const double v = value.get<double>(), bound = rule.get<double>();
                if (keyword == "minimum" ? v < bound : v > bound)
                    complain("is " + value.dump() + ", beyond the " + keyword + " " + rule.dump());
            } else if (keyword == "minItems") {
                if (value.is_array() && value.size() < rule.get<std::size_t>())
                    complain("has fewer than " + rule.dump() + " items");
            } else if (keyword == "anyOf") {
                append(nearest(value, rule, at));
            } else if (keyword == "$ref") {
                const json::json_pointer place(rule.get<std::string>().substr(1));
                if (root_.contains(place))
                    append(of(value, root_.at(place), at));
                else
                    complain("the schema has no " + rule.dump());
            } else if (keyword != "$schema" && keyword != "$defs" && keyword != "title" &&
                       keyword != "description") {
                complain("the schema's keyword " + keyword + " is not known here");
            }
        }
        return out;
    }

  private:
    std::vector<std::string> nearest(const json& value, const json& branches,
                                     const std::string& at) const {
        std::vector<std::string> least;
        bool first = true;
        for (const json& branch : branches) {
            std::vector<std::string> here = of(value, branch, at);
            if (first || here.size() < least.size()) least = std::move(here);
            first = false;
        }
        return least;
    }

    const json& root_;
};

}  // namespace

std::vector<std::string> schema_complaints(const json& value, const json& schema) {
    return Check(schema).of(value, schema, "");
}

}  // namespace test
