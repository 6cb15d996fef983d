#include "formats/assimp/texts/x3d_text.h"

#include <algorithm>
#include <array>
#include <map>

#include "formats/assimp/texts/xml_tags.h"

namespace prep::detail {
namespace {

// What Assimp 5.2 leaves out, with what is in it.
constexpr std::array<std::string_view, 21> unread_elements = {"Anchor",
                                                              "Arc2D",
                                                              "Billboard",
                                                              "CADAssembly",
                                                              "CADFace",
                                                              "CADLayer",
                                                              "CADPart",
                                                              "Collision",
                                                              "HAnimHumanoid",
                                                              "IndexedQuadSet",
                                                              "LOD",
                                                              "NurbsPatchSurface",
                                                              "NurbsSweptSurface",
                                                              "NurbsTrimmedSurface",
                                                              "OrthoViewpoint",
                                                              "ProtoInstance",
                                                              "QuadSet",
                                                              "ScreenGroup",
                                                              "Text",
                                                              "TextureTransform",
                                                              "Viewpoint"};

// Of what a tag says url="…": where the value stands in it, between its quotes, and how long it is.
struct Value {
    std::size_t begin = 0, size = 0;
};
std::optional<Value> url_of(std::string_view tag) {
    for (std::size_t at = 1; (at = tag.find("url", at)) != std::string_view::npos; ++at) {
        if (xml_blanks.find(tag[at - 1]) == std::string_view::npos) continue;
        const std::size_t equals = tag.find_first_not_of(xml_blanks, at + 3);
        if (equals == std::string_view::npos || tag[equals] != '=') continue;
        const std::size_t quote = tag.find_first_not_of(xml_blanks, equals + 1);
        if (quote == std::string_view::npos || (tag[quote] != '"' && tag[quote] != '\'')) continue;
        const std::size_t close = tag.find(tag[quote], quote + 1);
        if (close == std::string_view::npos) return std::nullopt;
        return Value{quote + 1, close - quote - 1};
    }
    return std::nullopt;
}

// The first of a list of quoted names; nothing where none is quoted.
std::optional<std::string_view> first_name(std::string_view list) {
    for (const std::string_view quote : {std::string_view("\""), std::string_view("&quot;")}) {
        const std::size_t begin = list.find(quote);
        if (begin == std::string_view::npos) continue;
        const std::string_view rest = list.substr(begin + quote.size());
        return rest.substr(0, rest.find(quote));
    }
    return std::nullopt;
}

// Statements of one tag.
struct Faults {
    bool lines = false, clockwise = false, colors = false, uvs = false, normals = false,
         solids = false, no_appearance = false;
    std::map<std::string_view, std::size_t> unread;

    void add(const XmlTags& tag) {
        const std::string_view name = tag.name();
        lines |= name == "IndexedLineSet";
        solids |= name == "Cone" || name == "Cylinder";
        std::string positions, uv;
        for (auto& [key, value] : tag.attributes()) {
            clockwise |= key == "ccw" && value == "false";
            colors |= (key == "colorPerVertex" && value == "false") || key == "colorIndex";
            normals |= key == "normalPerVertex" && value == "false";
            if (key == "coordIndex") positions = std::move(value);
            if (key == "texCoordIndex") uv = std::move(value);
        }
        uvs |= !uv.empty() && uv != positions;
        if (std::find(unread_elements.begin(), unread_elements.end(), name) !=
            unread_elements.end())
            ++unread[name];
    }
};

}  // namespace

std::optional<std::string> with_plain_urls(std::string_view xml) {
    std::string out;
    std::size_t done = 0;
    XmlTags tags(xml);
    while (tags.next()) {
        const std::string_view tag = xml.substr(tags.begin(), tags.end() - tags.begin());
        const auto url = url_of(tag);
        if (!url) continue;
        const auto first = first_name(tag.substr(url->begin, url->size));
        if (!first) continue;
        out += xml.substr(done, tags.begin() + url->begin - done);
        for (const char c : *first) out += c == ' ' ? "%20" : std::string(1, c);
        done = tags.begin() + url->begin + url->size;
    }
    if (done == 0) return std::nullopt;
    return out += xml.substr(done);
}

std::vector<std::string> misread_of_x3d(std::string_view xml) {
    Faults faults;
    bool in_shape = false, has_appearance = false;
    std::size_t shapes = 0;
    XmlTags tags(xml);
    while (tags.next()) {
        if (tags.name() == "Shape") {
            if (tags.is_end()) {
                // The first has no other before it.
                faults.no_appearance |= in_shape && !has_appearance && shapes > 1;
                in_shape = false;
            } else if (!tags.is_empty() && !tags.attribute("USE")) {
                in_shape = true;
                has_appearance = false;
                ++shapes;
            }
        }
        has_appearance |= tags.name() == "Appearance";
        if (!tags.is_end()) faults.add(tags);
    }
    // Each was seen with a file that has it and little else.
    std::vector<std::string> out;
    if (faults.lines) out.emplace_back("Assimp reads the lines of IndexedLineSet as faces");
    if (faults.clockwise) out.emplace_back("Assimp does not turn the faces of ccw=\"false\"");
    if (faults.colors)
        out.emplace_back(
            "Assimp gives colours of faces, or by colorIndex, to other corners than the file");
    if (faults.uvs)
        out.emplace_back("Assimp has one UV for each vertex, where texCoordIndex may give several");
    if (faults.normals) out.emplace_back("Assimp gives normals of faces to other faces as well");
    if (faults.solids)
        out.emplace_back("Assimp makes faces without an area of Cone and Cylinder, and turns some");
    if (faults.no_appearance)
        out.emplace_back("Assimp gives a Shape without Appearance that of the one before it");
    if (!faults.unread.empty()) {
        std::string names;
        for (const auto& [name, count] : faults.unread)
            names += (names.empty() ? "" : ", ") + std::to_string(count) + ' ' + std::string(name);
        out.push_back("elements that Assimp leaves out with what they hold: " + names);
    }
    return out;
}

bool has_open_surfaces(std::string_view xml) {
    if (xml.find("solid") == std::string_view::npos) return false;
    XmlTags tags(xml);
    while (tags.next())
        if (!tags.is_end() && tags.attribute("solid") == "false") return true;
    return false;
}

}  // namespace prep::detail
