// The tags of an XML text one after the other, without a tree of them: 3MF has one for each vertex
// and triangle. Comments, declarations and texts are passed over. What is no XML ends it: whoever
// reads the text in earnest says so.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace prep::detail {

inline constexpr std::string_view xml_blanks = " \t\r\n";

class XmlTags {
  public:
    explicit XmlTags(std::string_view xml) : xml_(xml) {}

    // To the next start or end tag; false behind the last.
    bool next();

    std::string_view name() const { return name_; }  // with its prefix
    bool is_end() const { return is_end_; }          // </name>
    bool is_empty() const { return is_empty_; }      // <name/>
    // Of the text: the tag's "<", and what is behind its ">".
    std::size_t begin() const { return begin_; }
    std::size_t end() const { return at_; }

    // Of this tag, in its order, names with their prefixes; references in values are resolved.
    std::vector<std::pair<std::string, std::string>> attributes() const;
    std::optional<std::string> attribute(std::string_view name) const;

  private:
    bool skip_past(std::string_view end);

    std::string_view xml_;
    std::string_view name_, inside_;  // inside_: between the name and the tag's end
    std::size_t begin_ = 0, at_ = 0;
    bool is_end_ = false, is_empty_ = false;
};

// Whether an element of that name is in the text.
bool has_element(std::string_view xml, std::string_view name);

// "a" of "p:a" and of "a".
inline std::string_view local_name(std::string_view name) {
    return name.substr(name.rfind(':') + 1);
}

}  // namespace prep::detail
