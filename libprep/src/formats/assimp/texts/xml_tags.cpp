#include "formats/assimp/texts/xml_tags.h"

#include <algorithm>
#include <array>

namespace prep::detail {
namespace {

void trim_front(std::string_view& text) {
    text.remove_prefix(std::min(text.find_first_not_of(xml_blanks), text.size()));
}

// The references that XML defines itself; those by number stay, which names here never need.
std::string resolved(std::string_view value) {
    static constexpr std::array<std::pair<std::string_view, char>, 5> references = {
        {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
    std::string out;
    while (!value.empty()) {
        const auto* const found =
            std::find_if(references.begin(), references.end(),
                         [&](const auto& reference) { return value.starts_with(reference.first); });
        out += found == references.end() ? value[0] : found->second;
        value.remove_prefix(found == references.end() ? 1 : found->first.size());
    }
    return out;
}

}  // namespace

bool XmlTags::skip_past(std::string_view end) {
    const std::size_t found = xml_.find(end, at_);
    at_ = found == std::string_view::npos ? xml_.size() : found + end.size();
    return found != std::string_view::npos;
}

bool XmlTags::next() {
    while ((at_ = std::min(xml_.find('<', at_), xml_.size())) < xml_.size()) {
        const std::string_view rest = xml_.substr(at_);
        if (rest.starts_with("<!--")) {
            at_ += 4;
            if (!skip_past("-->")) return false;
        } else if (rest.starts_with("<![CDATA[")) {
            if (!skip_past("]]>")) return false;
        } else if (rest.starts_with("<?")) {
            if (!skip_past("?>")) return false;
        } else if (rest.starts_with("<!")) {
            if (!skip_past(">")) return false;
        } else {
            begin_ = at_;
            is_end_ = rest.starts_with("</");
            const std::size_t begin = at_ + (is_end_ ? 2 : 1);
            std::size_t end = begin;
            for (char quote = 0; end < xml_.size() && (quote != 0 || xml_[end] != '>'); ++end) {
                const char c = xml_[end];
                if (quote != 0)
                    quote = c == quote ? char(0) : quote;
                else if (c == '"' || c == '\'')
                    quote = c;
            }
            if (end == xml_.size()) return false;
            at_ = end + 1;
            inside_ = xml_.substr(begin, end - begin);
            is_empty_ = inside_.ends_with('/');
            if (is_empty_) inside_.remove_suffix(1);
            name_ = inside_.substr(0, inside_.find_first_of(xml_blanks));
            inside_.remove_prefix(name_.size());
            return true;
        }
    }
    return false;
}

std::vector<std::pair<std::string, std::string>> XmlTags::attributes() const {
    std::vector<std::pair<std::string, std::string>> out;
    std::string_view rest = inside_;
    for (;;) {
        trim_front(rest);
        const std::size_t equals = rest.find('=');
        if (equals == std::string_view::npos) return out;
        std::string_view name = rest.substr(0, equals);
        name = name.substr(0, name.find_first_of(xml_blanks));
        rest.remove_prefix(equals + 1);
        trim_front(rest);
        if (rest.empty() || (rest[0] != '"' && rest[0] != '\'')) return out;
        const std::size_t end = rest.find(rest[0], 1);
        if (end == std::string_view::npos) return out;
        out.emplace_back(std::string(name), resolved(rest.substr(1, end - 1)));
        rest.remove_prefix(end + 1);
    }
}

std::optional<std::string> XmlTags::attribute(std::string_view name) const {
    for (auto& [own, value] : attributes())
        if (own == name) return std::move(value);
    return std::nullopt;
}

bool has_element(std::string_view xml, std::string_view name) {
    XmlTags tags(xml);
    while (tags.next())
        if (!tags.is_end() && tags.name() == name) return true;
    return false;
}

}  // namespace prep::detail
