#include "formats/assimp/threemf/model_review.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "formats/assimp/texts/utf16.h"
#include "formats/assimp/texts/xml_tags.h"
#include "prep/files.h"
#include "text/name_list.h"

namespace prep::detail {
namespace {

using Id = std::int64_t;
constexpr Id no_id = -1;

constexpr std::string_view production_extension =
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
constexpr std::array<std::string_view, 4> supported_extensions = {
    "http://schemas.microsoft.com/3dmanufacturing/core/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07", production_extension};

// Resource identifiers are positive numbers below 2³¹.
Id id_of(const std::optional<std::string>& text) {
    Id id = no_id;
    if (text) std::from_chars(text->data(), text->data() + text->size(), id);
    return id;
}

bool same_part(std::string_view a, std::string_view b) {
    const auto bare = [](std::string_view name) {
        return name.substr(std::min(name.find_first_not_of('/'), name.size()));
    };
    return bare(a) == bare(b);
}

// A file of nonsense must not fill the terminal.
std::string shown(const std::string& text) {
    constexpr std::size_t longest = 200;
    return text.size() > longest ? text.substr(0, longest) + "…" : text;
}

// Objects of which a vertex has another UV in another triangle: Assimp keeps one for each vertex,
// that of the last triangle. Nothing is kept of files without texture coordinates.
class UvSeams {
  public:
    void group(const XmlTags& tag) { uvs_ = &groups_[id_of(tag.attribute("id"))]; }
    void uv(const XmlTags& tag) {
        if (uvs_ == nullptr) return;
        Uv made{};
        for (const auto& [name, value] : tag.attributes())
            if (name == "u" || name == "v")
                std::from_chars(value.data(), value.data() + value.size(), made[name == "v"]);
        uvs_->push_back(made);
    }
    void object(const XmlTags& tag, Id id) {
        if (groups_.empty()) return;
        object_ = id;
        corners_.clear();
        group_ = id_of(tag.attribute("pid"));
        index_ = id_of(tag.attribute("pindex"));
    }
    void triangle(const XmlTags& tag) {
        if (groups_.empty()) return;
        Id group = group_;
        std::array<Id, 3> vertices{no_id, no_id, no_id}, indices = vertices;
        for (const auto& [name, value] : tag.attributes()) {
            if (name == "pid") group = id_of(value);
            if (name.size() != 2 || name[1] < '1' || name[1] > '3') continue;
            if (name[0] == 'v') vertices[std::size_t(name[1] - '1')] = id_of(value);
            if (name[0] == 'p') indices[std::size_t(name[1] - '1')] = id_of(value);
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const Id first = indices[0] == no_id ? index_ : indices[0];
            const std::optional<Uv> made = find(group, indices[k] == no_id ? first : indices[k]);
            if (!made) continue;
            const auto [it, added] = corners_.emplace(vertices[k], *made);
            if (!added && it->second != *made) with_seams_.add(std::to_string(object_));
        }
    }
    const NameList& objects() const { return with_seams_; }

  private:
    using Uv = std::array<double, 2>;

    std::optional<Uv> find(Id group, Id index) const {
        const auto found = groups_.find(group);
        if (found == groups_.end() || index < 0 || std::size_t(index) >= found->second.size())
            return std::nullopt;
        return found->second[std::size_t(index)];
    }

    std::map<Id, std::vector<Uv>> groups_;
    std::vector<Uv>* uvs_ = nullptr;  // of the group that the tags are in
    Id object_ = no_id, group_ = no_id, index_ = no_id;
    std::unordered_map<Id, Uv> corners_;  // by vertex of the object
    NameList with_seams_;
};

class ModelReview {
  public:
    ModelReview(std::string_view xml, const std::string& part, const std::string& place)
        : tags_(xml), part_(part), place_(place) {}

    Result<std::vector<std::string>> run() {
        bool model = false;
        while (tags_.next()) {
            const std::string_view name = tags_.name();
            if (!model && name == "model" && !tags_.is_end()) {
                model = true;
                if (auto done = requirements(); !done) return std::move(done).error();
            } else if (name == "object") {
                object();
            } else if (tags_.is_end()) {
                continue;
            } else if (name == "mesh" || name == "components") {
                has_shape_ = true;
            } else if (name == "item" || name == "component") {
                reference(name == "item");
            } else if (name == "triangle") {
                seams_.triangle(tags_);
            } else if (local_name(name) == "tex2coord") {
                seams_.uv(tags_);
            } else if (local_name(name) == "texture2dgroup") {
                seams_.group(tags_);
            } else if (local_name(name) == "texture2d") {
                texture();
            }
        }
        leave_object();
        return conclusion();
    }

  private:
    // An item (its object is none) or a component of an object: what it names.
    struct Reference {
        Id object = no_id, of = no_id;
        bool is_item = false, is_elsewhere = false;
    };

    Error refused(std::string text) const {
        return {ErrorCode::unsupported, std::move(text),
                place_ + (part_.starts_with('/') ? "" : "/") + part_};
    }

    // Of the model's own element: prefixes and the extensions that it requires by them.
    Result<void> requirements() {
        std::map<std::string, std::string> namespaces;
        std::string required;
        for (auto& [name, value] : tags_.attributes()) {
            if (name.starts_with("xmlns:")) namespaces.emplace(name.substr(6), value);
            if (name == "requiredextensions") required = std::move(value);
        }
        for (std::size_t at = required.find_first_not_of(xml_blanks); at != std::string::npos;
             at = required.find_first_not_of(xml_blanks, at)) {
            const std::size_t end =
                std::min(required.find_first_of(xml_blanks, at), required.size());
            const std::string prefix = required.substr(at, end - at);
            at = end;
            const auto found = namespaces.find(prefix);
            if (found == namespaces.end())
                return refused("it requires the extension '" + shown(prefix) +
                               "', a prefix that it does not declare");
            const std::string& extension = found->second;
            if (std::find(supported_extensions.begin(), supported_extensions.end(), extension) ==
                supported_extensions.end())
                return refused("it requires the extension " + shown(extension) +
                               ", which is not read: export it without; materials, production and "
                               "triangle sets are");
            production_required_ |= extension == production_extension;
        }
        return {};
    }

    void object() {
        leave_object();
        if (tags_.is_end()) return;
        object_ = id_of(tags_.attribute("id"));
        has_shape_ = false;
        objects_.insert(object_);
        seams_.object(tags_, object_);
        in_object_ = true;
        if (tags_.is_empty()) leave_object();
    }

    void leave_object() {
        if (in_object_ && !has_shape_) shapeless_.add(std::to_string(object_));
        in_object_ = false;
        object_ = no_id;
    }

    void reference(bool is_item) {
        Reference made{no_id, object_, is_item, false};
        for (const auto& [name, value] : tags_.attributes()) {
            if (name == "objectid") made.object = id_of(value);
            if (name != "path" && local_name(name) == "path" && !same_part(value, part_)) {
                made.is_elsewhere = true;
                if (first_elsewhere_.empty()) first_elsewhere_ = value;
                other_parts_.add(value);
            }
        }
        references_.push_back(made);
    }

    void texture() {
        const std::string path = tags_.attribute("path").value_or("");
        for (const char* const style : {"tilestyleu", "tilestylev"})
            if (tags_.attribute(style).value_or("wrap") != "wrap") tiled_.add(path);
    }

    static std::string words(const Reference& reference) {
        const std::string named = reference.object == no_id
                                      ? " without an object"
                                      : ' ' + std::to_string(reference.object);
        if (reference.is_item) return "item" + named;
        return "component" + named + " of object " + std::to_string(reference.of);
    }

    Result<std::vector<std::string>> conclusion() const {
        if (production_required_ && !other_parts_.empty())
            return refused(
                "objects of other parts of the package are not read: " + shown(first_elsewhere_) +
                "; save it with all objects in one model part");
        NameList missing, stand_ins;
        for (const Reference& reference : references_) {
            const bool is_here = objects_.contains(reference.object);
            if (!reference.is_elsewhere && !is_here) missing.add(words(reference));
            if (reference.is_elsewhere && is_here) stand_ins.add(words(reference));
        }
        std::vector<std::string> out;
        const auto say = [&](const char* what, const NameList& names) {
            if (!names.empty()) out.push_back(what + names.text());
        };
        say("what names an object that the file does not have is missing: ", missing);
        say("objects of other parts of the package are not read and missing: ", other_parts_);
        say("in the place of objects of other parts stand those of the same number here: ",
            stand_ins);
        say("objects without a mesh or components that are read are empty: ", shapeless_);
        say("vertices have one UV each, which is wrong at the seams of objects: ",
            seams_.objects());
        say("textures repeat, whatever the file says of their tiles: ", tiled_);
        return out;
    }

    XmlTags tags_;
    const std::string& part_;
    const std::string& place_;
    Id object_ = no_id;  // the one that the tags are in
    bool in_object_ = false, has_shape_ = false, production_required_ = false;
    std::set<Id> objects_;
    std::vector<Reference> references_;
    std::string first_elsewhere_;
    NameList other_parts_, shapeless_, tiled_;
    UvSeams seams_;
};

// Of a part; UTF-16 becomes UTF-8.
Result<std::string> text_of(const PackageParts& parts, std::string_view name) {
    const auto bytes = parts.unpack(name);
    if (!bytes) return bytes.error();
    if (auto converted = utf8_of_utf16(*bytes)) return *std::move(converted);
    return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

constexpr std::string_view model_relationship =
    "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";

// The model's name as the package's relationships have it.
Result<std::string> model_part(const PackageParts& parts, const std::string& place) {
    auto relationships = text_of(parts, "/_rels/.rels");
    if (!relationships) return std::move(relationships).error();
    XmlTags tags(*relationships);
    while (tags.next())
        if (tags.name() == "Relationship" &&
            tags.attribute("Type").value_or("") == model_relationship)
            return tags.attribute("Target").value_or("");
    return Error{ErrorCode::invalid, "the package names no model", place + "/_rels/.rels"};
}

}  // namespace

Result<std::vector<std::string>> review_model(std::string_view xml, const std::string& part,
                                              const std::string& place) {
    return ModelReview(xml, part, place).run();
}

Result<PackageReview> review_package(const std::filesystem::path& path) {
    PackageReview review;
    auto bytes = read_file(path);
    if (!bytes) return std::move(bytes).error();
    auto parts = PackageParts::of(*std::move(bytes), path.string());
    if (!parts) {
        review.warnings.push_back("what is lost of the package is not known: " +
                                  parts.error().text);
        return review;
    }
    review.parts = *std::move(parts);
    const auto part = model_part(review.parts, path.string());
    if (!part) return part.error();
    const auto xml = text_of(review.parts, *part);
    if (!xml) return xml.error();
    auto warnings = review_model(*xml, *part, path.string());
    if (!warnings) return std::move(warnings).error();
    review.warnings = *std::move(warnings);
    return review;
}

}  // namespace prep::detail
