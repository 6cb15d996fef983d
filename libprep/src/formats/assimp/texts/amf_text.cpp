#include "formats/assimp/texts/amf_text.h"

#include <algorithm>
#include <map>
#include <vector>

#include "base/srgb.h"
#include "formats/assimp/texts/xml_tags.h"

namespace prep::detail {
namespace {

// Where in the text something stands: from its first byte to the one behind its last.
struct Span {
    std::size_t begin = 0, end = 0;
    bool empty() const { return begin == end; }
};

struct Volume {
    Span start, end;  // its tags; an empty element has one
    Span own_color;
    std::string color;  // as it is put into triangles; empty: none
    std::string material;
    std::vector<std::size_t> bare;  // behind the tags of its triangles without a colour
};

struct MeshText {
    std::vector<Volume> volumes;
    std::string object_color;
    bool has_vertex_colors = false;
};

class Outline {
  public:
    explicit Outline(std::string_view xml) : xml_(xml), tags_(xml) {}

    // False where elements do not end as they begin.
    bool read() {
        while (tags_.next()) {
            if (!tags_.is_end()) {
                open_.emplace_back(tags_.name());
                begin(open_.size() > 1 ? open_[open_.size() - 2] : std::string_view());
            }
            if (tags_.is_end() || tags_.is_empty()) {
                if (open_.empty() || open_.back() != tags_.name()) return false;
                open_.pop_back();
                end(open_.empty() ? std::string_view() : open_.back());
            }
        }
        return open_.empty();
    }

    const std::vector<MeshText>& meshes() const { return meshes_; }
    std::string color_of_material(const std::string& id) const {
        const auto at = materials_.find(id);
        return at != materials_.end() ? at->second : "";
    }

  private:
    void begin(std::string_view parent) {
        const std::string_view name = tags_.name();
        if (name == "material") material_ = tags_.attribute("id").value_or("");
        if (name == "object") {
            object_color_ = {};
            meshes_before_ = meshes_.size();
        }
        if (name == "mesh") meshes_.push_back({{}, object_color_, false});
        if (name == "color" && parent != "color") {
            color_.begin = tags_.begin();
            numbers_.clear();
        }
        if (parent == "color") behind_number_ = tags_.end();
        if (meshes_.empty()) return;
        if (name == "volume" && parent == "mesh")
            meshes_.back().volumes.push_back({{tags_.begin(), tags_.end()},
                                              {},
                                              {},
                                              {},
                                              tags_.attribute("materialid").value_or(""),
                                              {}});
        if (name == "triangle" && parent == "volume" && !tags_.is_empty()) {
            behind_triangle_ = tags_.end();
            has_color_ = false;
        }
    }

    void end(std::string_view parent) {
        const std::string_view name = tags_.name();
        if (parent == "color" && !tags_.is_empty()) number(name);
        if (name == "color" && parent != "color") end_color(parent);
        if (meshes_.empty() || meshes_.back().volumes.empty()) return;
        Volume& volume = meshes_.back().volumes.back();
        if (name == "triangle" && parent == "volume" && !has_color_ && !tags_.is_empty())
            volume.bare.push_back(behind_triangle_);
        if (name == "volume" && parent == "mesh" && !tags_.is_empty())
            volume.end = {tags_.begin(), tags_.end()};
    }

    // As short as it can be said: it is put into each triangle.
    void number(std::string_view name) {
        constexpr std::size_t longest = 32;
        const std::string_view value = xml_.substr(behind_number_, tags_.begin() - behind_number_);
        if (name.size() != 1 || value.size() > longest || numbers_.size() > 4 * longest) return;
        const std::string tag(name);
        numbers_ += '<' + tag + '>' + std::string(value) + "</" + tag + '>';
    }

    void end_color(std::string_view parent) {
        color_.end = tags_.end();
        const std::string text = numbers_.empty() ? "" : "<color>" + numbers_ + "</color>";
        if (parent == "material") materials_.emplace(material_, text);
        if (parent == "object") {
            object_color_ = text;
            for (std::size_t m = meshes_before_; m < meshes_.size(); ++m)
                meshes_[m].object_color = text;
        }
        if (parent == "triangle") has_color_ = true;
        if (meshes_.empty()) return;
        if (parent == "vertex") meshes_.back().has_vertex_colors = true;
        if (parent == "volume" && !meshes_.back().volumes.empty()) {
            meshes_.back().volumes.back().own_color = color_;
            meshes_.back().volumes.back().color = text;
        }
    }

    std::string_view xml_;
    XmlTags tags_;
    std::vector<std::string_view> open_;
    std::vector<MeshText> meshes_;
    std::map<std::string, std::string> materials_;
    std::string material_, object_color_, numbers_;
    Span color_;
    std::size_t behind_triangle_ = 0, behind_number_ = 0, meshes_before_ = 0;  // of this object
    bool has_color_ = false;
};

float decoded(float encoded) {
    return float(srgb_to_linear(double(encoded)));
}

// What is put in the place of a part of the text.
struct Edit {
    Span old;
    std::string by;
};

void join_volumes(const MeshText& mesh, const Outline& outline, std::vector<Edit>& edits) {
    for (std::size_t k = 0; k < mesh.volumes.size(); ++k) {
        const Volume& v = mesh.volumes[k];
        const bool first = k == 0, last = k + 1 == mesh.volumes.size();
        // Of an empty element, <volume/>, the one tag is both.
        std::string start = first ? "<volume>" : "";
        if (v.end.empty() && last) start += "</volume>";
        edits.push_back({v.start, start});
        if (!v.end.empty()) edits.push_back({v.end, last ? "</volume>" : ""});
        if (!v.own_color.empty()) edits.push_back({v.own_color, ""});
        std::string color = v.color;
        if (color.empty()) color = mesh.object_color;
        if (color.empty()) color = outline.color_of_material(v.material);
        if (color.empty() || mesh.has_vertex_colors) continue;
        for (const std::size_t at : v.bare) edits.push_back({{at, at}, color});
    }
}

}  // namespace

std::optional<std::string> with_one_volume_a_mesh(std::string_view xml) {
    Outline outline(xml);
    if (!outline.read()) return std::nullopt;
    std::vector<Edit> edits;
    for (const MeshText& mesh : outline.meshes())
        if (mesh.volumes.size() > 1) join_volumes(mesh, outline, edits);
    if (edits.empty()) return std::nullopt;
    std::stable_sort(edits.begin(), edits.end(),
                     [](const Edit& a, const Edit& b) { return a.old.begin < b.old.begin; });
    std::string out;
    std::size_t at = 0;
    for (const Edit& edit : edits) {
        if (edit.old.begin < at) return std::nullopt;  // one within another: no AMF
        out += xml.substr(at, edit.old.begin - at);
        out += edit.by;
        at = edit.old.end;
    }
    return out += xml.substr(at);
}

std::vector<std::string> misread_of_amf(std::string_view xml) {
    bool rotations = false, normals = false, curves = false;
    XmlTags tags(xml);
    while (tags.next()) {
        const std::string_view name = tags.name();
        rotations |= name == "rx" || name == "ry" || name == "rz";
        normals |= name == "normal";
        curves |= name == "edge";
    }
    std::vector<std::string> out;
    if (rotations) out.emplace_back("Assimp reads rotations of instances as translations");
    if (normals) out.emplace_back("Assimp reads no normals of AMF files");
    if (curves) out.emplace_back("Assimp reads the curved edges of AMF files as straight ones");
    return out;
}

void settle_amf_colors(Scene& scene) {
    const glm::vec4 unsaid(0.0f);
    for (Mesh& mesh : scene.meshes) {
        std::erase_if(mesh.colors, [&](const CornerLayer<glm::vec4>& layer) {
            return std::all_of(layer.values.begin(), layer.values.end(),
                               [&](const glm::vec4& color) { return color == unsaid; });
        });
        for (CornerLayer<glm::vec4>& layer : mesh.colors)
            for (glm::vec4& color : layer.values) {
                if (color == unsaid) color = glm::vec4(1.0f);
                for (int k = 0; k < 3; ++k) color[k] = decoded(color[k]);
            }
    }
}

}  // namespace prep::detail
