#include "formats/assimp/texts/dxf_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>

#include "base/srgb.h"

namespace prep::detail {
namespace {

constexpr std::string_view blanks = " \t";

// A file is groups of two lines: a code, and a value.
class DxfGroups {
  public:
    explicit DxfGroups(std::string_view text) : text_(text) {}

    bool next() {
        if (at_ >= text_.size()) return false;
        code_ = line();
        value_ = line();
        return true;
    }
    std::string_view code() const { return code_; }
    std::string_view value() const { return value_; }  // a part of the text
    std::optional<double> number() const {
        double out = 0;
        if (std::from_chars(value_.data(), value_.data() + value_.size(), out).ec != std::errc())
            return std::nullopt;
        return out;
    }

  private:
    std::string_view line() {
        // Lines end in LF, CR LF or CR.
        const std::size_t begin = std::min(at_, text_.size());
        const std::size_t end = std::min(text_.find_first_of("\r\n", begin), text_.size());
        std::string_view out = text_.substr(begin, end - begin);
        at_ = end + (text_.substr(end, 2) == "\r\n" ? 2 : 1);
        out.remove_prefix(std::min(out.find_first_not_of(blanks), out.size()));
        return out.substr(0, out.find_last_not_of(blanks) + 1);
    }

    std::string_view text_, code_, value_;
    std::size_t at_ = 0;
};

class MisreadOfDxf {
  public:
    std::vector<std::string> sentences(std::string_view dxf) {
        DxfGroups groups(dxf);
        while (groups.next()) {
            if (groups.code() == "0")
                begin(groups.value());
            else
                group(groups);
        }
        end_insert();
        std::vector<std::string> out;
        if (misplaced_ > 0)
            out.push_back(
                "Assimp turns, mirrors and repeats no references to blocks (INSERT), and scales "
                "their places with them: " +
                std::to_string(misplaced_) + (misplaced_ == 1 ? " is" : " are") + " misplaced");
        if (nested_ > 0)
            out.push_back("Assimp reads no references to blocks (INSERT) within blocks: " +
                          std::to_string(nested_));
        if (!unread_.empty()) {
            std::string names;
            for (const auto& [name, count] : unread_)
                names += (names.empty() ? "" : ", ") + std::to_string(count) + ' ' + name;
            out.push_back("entities that Assimp does not read: " + names +
                          (has_more_kinds_ ? " and others" : ""));
        }
        if (other_colors_)
            out.emplace_back("Assimp knows no colours of numbers above 9, and no true colours");
        return out;
    }

  private:
    void begin(std::string_view name) {
        end_insert();
        entity_ = name;
        const bool holds_entities = section_ == "ENTITIES" || section_ == "BLOCKS";
        if (name == "INSERT" && holds_entities) {
            is_insert_ = true;
            nested_ += section_ == "BLOCKS";
        }
        static constexpr std::array<std::string_view, 11> read = {
            "3DFACE", "LINE",   "POLYLINE", "VERTEX", "SEQEND", "INSERT",
            "BLOCK",  "ENDBLK", "SECTION",  "ENDSEC", "EOF"};
        constexpr std::size_t most_kinds = 12, longest = 32;
        if (!holds_entities || name.empty() ||
            std::find(read.begin(), read.end(), name) != read.end())
            return;
        const std::string kind(name.substr(0, longest));
        if (unread_.size() < most_kinds || unread_.contains(kind))
            ++unread_[kind];
        else
            has_more_kinds_ = true;
    }

    void group(const DxfGroups& g) {
        if (entity_ == "SECTION" && g.code() == "2") section_ = g.value();
        const bool of_entity = section_ == "ENTITIES" || section_ == "BLOCKS";
        other_colors_ |= of_entity && g.code() == "420";
        if (g.code() == "62" && of_entity)
            if (const auto color = g.number()) other_colors_ |= *color >= 10 && *color < 256;
        if (!is_insert_) return;
        const bool scale = g.code() == "41" || g.code() == "42" || g.code() == "43";
        const bool count = g.code() == "70" || g.code() == "71";
        const bool across = g.code() == "210" || g.code() == "220";
        if (const auto number = g.number())
            is_misplaced_ |= (scale && *number != 1) || (g.code() == "50" && *number != 0) ||
                             (count && *number > 1) || (across && *number != 0) ||
                             (g.code() == "230" && *number != 1);
    }

    void end_insert() {
        misplaced_ += is_insert_ && is_misplaced_;
        is_insert_ = is_misplaced_ = false;
    }

    std::string_view section_, entity_;
    bool is_insert_ = false, is_misplaced_ = false, other_colors_ = false, has_more_kinds_ = false;
    std::uint64_t misplaced_ = 0, nested_ = 0;
    std::map<std::string, std::uint64_t> unread_;
};

// By name: group 62 of the table LAYER; negative where a layer is off.
std::map<std::string_view, int> colors_of_layers(std::string_view dxf) {
    std::map<std::string_view, int> out;
    DxfGroups groups(dxf);
    bool is_layer = false;
    std::string_view name;
    while (groups.next()) {
        if (groups.code() == "0") {
            is_layer = groups.value() == "LAYER";
            name = {};
            if (groups.value() == "ENDTAB" && !out.empty()) break;
        }
        if (!is_layer) continue;
        if (groups.code() == "2") name = groups.value();
        if (groups.code() == "62" && !name.empty())
            if (const auto color = groups.number(); color && std::abs(*color) < 256)
                out.emplace(name, std::abs(int(*color)));
    }
    return out;
}

}  // namespace

std::optional<std::string> with_positive_corners(std::string_view dxf) {
    std::optional<std::string> out;
    DxfGroups groups(dxf);
    bool is_vertex = false;
    while (groups.next()) {
        if (groups.code() == "0") is_vertex = groups.value() == "VERTEX";
        const std::string_view code = groups.code(), value = groups.value();
        const bool is_corner = code == "71" || code == "72" || code == "73" || code == "74";
        if (!is_vertex || !is_corner || !value.starts_with('-')) continue;
        if (!out) out = std::string(dxf);
        (*out)[static_cast<std::size_t>(value.data() - dxf.data())] = ' ';
    }
    return out;
}

std::vector<std::string> misread_of_dxf(std::string_view dxf) {
    return MisreadOfDxf().sentences(dxf);
}

void settle_dxf_colors(std::string_view dxf, Scene& scene) {
    struct Pair {
        glm::vec3 assimp, autocad;
    };
    const auto grey = [](int byte) { return glm::vec3(float(srgb_to_linear(byte / 255.0))); };
    const std::array<Pair, 8> pairs = {{{{0, 1, 0}, {1, 1, 0}},
                                        {{0, 0, 1}, {0, 1, 0}},
                                        {{0.3f, 1, 0.3f}, {0, 1, 1}},
                                        {{0.3f, 0.3f, 1}, {0, 0, 1}},
                                        {{1, 0.3f, 0.3f}, {1, 0, 1}},
                                        {{1, 0, 1}, {1, 1, 1}},
                                        {{1, 0.6f, 0}, grey(128)},
                                        {{0.6f, 0.3f, 0}, grey(192)}}};
    const auto settle = [&](glm::vec4& color) {
        const auto* const pair = std::find_if(pairs.begin(), pairs.end(), [&](const Pair& p) {
            return p.assimp == glm::vec3(color);
        });
        color = glm::vec4(pair != pairs.end() ? pair->autocad : glm::vec3(color), 1);
    };
    const std::map<std::string_view, int> layers = colors_of_layers(dxf);
    for (Mesh& mesh : scene.meshes) {
        // What Assimp has where an entity gives none; a mesh has its layer's name.
        const glm::vec3 unsaid(0.6f);
        const auto layer_of = layers.find(mesh.name);
        const int number = layer_of != layers.end() ? layer_of->second : 0;
        const auto own = [&](glm::vec4& color) {
            if (glm::vec3(color) != unsaid || number < 1 || number > 9)
                settle(color);
            else
                color = glm::vec4(
                    number == 1 ? glm::vec3(1, 0, 0) : pairs[std::size_t(number - 2)].autocad, 1);
        };
        for (CornerLayer<glm::vec4>& layer : mesh.colors)
            std::for_each(layer.values.begin(), layer.values.end(), own);
        std::for_each(mesh.vertex_colors.begin(), mesh.vertex_colors.end(), own);
    }
}

}  // namespace prep::detail
