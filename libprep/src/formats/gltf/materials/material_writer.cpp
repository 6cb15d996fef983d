#include "formats/gltf/materials/material_writer.h"

#include <algorithm>
#include <limits>

#include "base/read_open_file.h"
#include "formats/gltf/materials/material_extensions.h"
#include "formats/gltf/values/uv_set_bits.h"
#include "formats/turned_green.h"
#include "prep/image.h"
#include "text/note_once.h"
#include "text/utf8.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// The maps that glTF has a place for, and whether this material's is written there.
struct WrittenMap {
    TextureRef Material::*map;
    bool (*is_written)(const Material& m);
};
constexpr bool always(const Material&) {
    return true;
}
constexpr WrittenMap written_maps[] = {
    {&Material::diffuse_map, always},
    {&Material::occlusion_map, always},
    {&Material::emissive_map, always},
    {&Material::displacement_map, always},
    {&Material::normal_map,
     [](const Material& m) { return m.normal_map_space == NormalMapSpace::tangent; }},
    {&Material::specular_map, [](const Material& m) { return !m.unlit; }},
    {&Material::metallic_roughness_map, [](const Material& m) { return m.metallic_roughness; }},
};

std::uint64_t uv_sets_read(const Material& m) {
    std::uint64_t sets = 0;
    for (const WrittenMap& written : written_maps)
        if (const TextureRef& ref = m.*written.map; ref && written.is_written(m))
            sets |= uv_set_bit(ref.uv_set);
    return sets;
}

bool is_beyond_unit(const Image& image) {
    return std::any_of(image.pixels.begin(), image.pixels.end(),
                       [](float value) { return !(value >= 0 && value <= 1); });
}

std::string mime_of(const std::vector<std::byte>& bytes) {
    const auto starts = [&](std::initializer_list<unsigned char> magic) {
        return bytes.size() >= magic.size() &&
               std::equal(magic.begin(), magic.end(), bytes.begin(),
                          [](unsigned char a, std::byte b) { return std::byte(a) == b; });
    };
    if (starts({0x89, 'P', 'N', 'G'})) return "image/png";
    if (starts({0xff, 0xd8, 0xff})) return "image/jpeg";
    return {};
}

Json sampler_of(const Texture& t) {
    const auto wrap = [](Wrap w) {
        return w == Wrap::repeat ? 10497 : w == Wrap::mirror ? 33648 : 33071;
    };
    Json sampler{{"magFilter", t.mag == Filter::nearest ? 9728 : 9729}};
    const bool nearest = t.min == Filter::nearest;
    sampler["minFilter"] = t.mip == MipFilter::none      ? (nearest ? 9728 : 9729)
                           : t.mip == MipFilter::nearest ? (nearest ? 9984 : 9985)
                                                         : (nearest ? 9986 : 9987);
    sampler["wrapS"] = wrap(t.wrap_u);
    sampler["wrapT"] = wrap(t.wrap_v);
    return sampler;
}

// What our own reader takes back exactly.
Json blinn_phong(const Material& m) {
    Json exact;
    exact["ambient"] = array3(m.ambient);
    exact["diffuse"] = {m.diffuse.r, m.diffuse.g, m.diffuse.b, m.diffuse.a};
    exact["specular"] = array3(m.specular);
    exact["shininess"] = m.shininess;
    return exact;
}

}  // namespace

void MaterialWriter::note(const std::string& text) {
    note_once(notes_, text);
}

void MaterialWriter::choose_variants() {
    const std::uint64_t whole = std::numeric_limits<std::uint64_t>::max();
    std::vector<std::set<std::uint64_t>> sets(scene_.materials.size());
    for (const VertexMesh& mesh : prepared_.meshes)
        for (const VertexMesh::Range& range : mesh.ranges) {
            if (range.material >= scene_.materials.size()) continue;
            const std::uint64_t there = uv_set_bits(mesh);
            const bool enough = (uv_sets_read(scene_.materials[range.material]) & ~there) == 0;
            sets[range.material].insert(enough ? whole : there);
        }
    std::uint64_t count = 0;
    for (Index m = 0; m < sets.size(); ++m) variants_.push_back({m, whole});
    for (Index m = 0; m < sets.size(); ++m) {
        bool own_place = !sets[m].contains(whole);
        for (const std::uint64_t n : sets[m]) {
            if (n == whole) continue;
            ++count;
            if (own_place)
                variants_[m].uv_sets = n;
            else
                variants_.push_back({m, n});
            variant_index_[{m, n}] = own_place ? m : Index(variants_.size() - 1);
            own_place = false;
        }
    }
    if (count > 0)
        notes_.push_back("maps were left out where faces have no UVs for them (" +
                         std::to_string(count) + (count == 1 ? " material)" : " materials)"));
}

std::uint32_t MaterialWriter::variant_for(const VertexMesh& mesh, std::uint32_t material) const {
    const auto variant = variant_index_.find({material, uv_set_bits(mesh)});
    return variant == variant_index_.end() ? material : variant->second;
}

void MaterialWriter::write() {
    for (const Variant& variant : variants_) buffer_.push("materials", material(variant));
    if (limited_ > 0)
        notes_.push_back(
            std::to_string(limited_) +
            (limited_ == 1 ? " highlight reflects" : " highlights reflect") +
            " more than the diffuse colour leaves over: limited for other programs, exact in "
            "extras");
}

void MaterialWriter::note_unread() {
    if (!unread_.empty())
        notes_.push_back("textures that cannot be read: " + unread_.text() +
                         ": their materials go without");
}

Json MaterialWriter::material(const Variant& variant) {
    Material m = scene_.materials[variant.material];
    for (const WrittenMap& written : written_maps)
        if (TextureRef& ref = m.*written.map; (variant.uv_sets & uv_set_bit(ref.uv_set)) == 0)
            ref = {};
    const auto unit = [](float x) { return std::clamp(x, 0.0f, 1.0f); };
    Json out, pbr;
    if (!m.name.empty()) out["name"] = as_utf8(m.name);
    pbr["baseColorFactor"] = {unit(m.diffuse.r), unit(m.diffuse.g), unit(m.diffuse.b),
                              unit(m.diffuse.a)};
    pbr["metallicFactor"] = m.metallic_roughness ? unit(m.metallic) : 0.0f;
    const GltfHighlight highlight = gltf_highlight(m);
    limited_ += highlight.limited && !m.unlit;
    pbr["roughnessFactor"] = highlight.roughness;
    set_texture(pbr, "baseColorTexture", m.diffuse_map);
    if (m.metallic_roughness)
        set_texture(pbr, "metallicRoughnessTexture", m.metallic_roughness_map);
    out["pbrMetallicRoughness"] = std::move(pbr);
    normal_map(m, out);
    if (m.bump_map) note("glTF has no bump maps: left out");
    if (m.displacement_map) displacement(m, out);
    occlusion(m, out);
    emission(m, out);
    if (m.alpha_mode != AlphaMode::opaque) {
        out["alphaMode"] = m.alpha_mode == AlphaMode::mask ? "MASK" : "BLEND";
        if (m.alpha_mode == AlphaMode::mask) out["alphaCutoff"] = m.alpha_cutoff;
    }
    if (m.double_sided) out["doubleSided"] = true;
    if (m.unlit) {
        extensions_.insert("KHR_materials_unlit");
        out["extensions"]["KHR_materials_unlit"] = Json::object();
    } else {
        reflectance(m, highlight.reflectance, out);
        write_layers(m, out, extensions_);
    }
    if (!m.metallic_roughness) out["extras"]["blinnPhong"] = blinn_phong(m);
    return out;
}

void MaterialWriter::set_texture(Json& owner, const char* slot, const TextureRef& ref,
                                 Pixels pixels) {
    if (!ref) return;
    const Index texture = texture_index(ref.texture, pixels);
    if (texture == no_index) return;
    Json info{{"index", texture}};
    if (ref.uv_set) info["texCoord"] = ref.uv_set;
    if (ref.offset != glm::vec2(0.0f) || ref.scale != glm::vec2(1.0f) || ref.rotation != 0) {
        extensions_.insert("KHR_texture_transform");
        Json transform;
        transform["offset"] = {ref.offset.x, ref.offset.y};
        transform["rotation"] = ref.rotation;
        transform["scale"] = {ref.scale.x, ref.scale.y};
        info["extensions"]["KHR_texture_transform"] = std::move(transform);
    }
    owner[slot] = std::move(info);
}

std::uint32_t MaterialWriter::texture_index(std::uint32_t texture, Pixels pixels) {
    if (texture >= scene_.textures.size()) return no_index;
    const auto known = texture_map_.find({texture, pixels});
    if (known != texture_map_.end()) return known->second;
    const Texture& t = scene_.textures[texture];
    Index result = no_index;
    const Index image = image_index(t.image, pixels);
    if (image != no_index) {
        if (t.wrap_u == Wrap::border || t.wrap_v == Wrap::border)
            note("glTF has no borders around textures: they are clamped to their edges instead");
        const std::size_t s = buffer_.push("samplers", sampler_of(t));
        result = Index(buffer_.push("textures", Json{{"sampler", s}, {"source", image}}));
    }
    texture_map_.emplace(std::pair(texture, pixels), result);
    return result;
}

std::uint32_t MaterialWriter::image_index(std::uint32_t image, Pixels pixels) {
    if (image >= scene_.images.size()) return no_index;
    const auto known = image_map_.find({image, pixels});
    if (known != image_map_.end()) return known->second;
    const ImageRef& ref = scene_.images[image];
    std::vector<std::byte> bytes = ref.bytes;
    if (bytes.empty() && ref.channels.empty()) {
        auto file = read_regular_file(ref.path);
        if (file) bytes = *std::move(file);
    }
    std::string mime = mime_of(bytes);
    if (mime.empty() || pixels == Pixels::green_turned) {  // glTF holds PNG and JPEG only
        mime.clear();
        std::vector<std::byte> png = converted(ref, pixels);
        if (!png.empty()) {
            bytes = std::move(png);
            mime = "image/png";
        }
    }
    Index result = no_index;
    if (mime.empty()) {
        unread_.add(ref.name.empty() ? std::to_string(image) : ref.name);
    } else {
        const std::size_t view = buffer_.add_view(bytes, 0);
        Json out{{"bufferView", view}, {"mimeType", mime}};
        if (!ref.name.empty()) out["name"] = as_utf8(ref.name);
        result = Index(buffer_.push("images", std::move(out)));
    }
    image_map_.emplace(std::pair(image, pixels), result);
    return result;
}

// As PNG; nothing where it cannot be read.
std::vector<std::byte> MaterialWriter::converted(const ImageRef& ref, Pixels pixels) {
    auto decoded = load_image(ref);
    if (!decoded) {
        if (decoded.error().code != ErrorCode::io)
            note("texture '" + ref.name + "': " + decoded.error().text);
        return {};
    }
    const bool turned = pixels == Pixels::green_turned, heights = pixels == Pixels::heights;
    if (heights && is_beyond_unit(*decoded))
        note("texture '" + ref.name + "' has heights beyond 0 to 1, where PNG ends: cut off");
    if (heights && decoded->floating)
        note("texture '" + ref.name + "': heights were rounded to 16 bits");
    // Heights keep what PNG can hold. Floats get 16 bits whatever they are: the nearest code of 8
    // to a mid-level is far.
    const bool wide = heights && (decoded->floating || !is_eight_bit(*decoded));
    const auto png = turned ? turned_green_png(*std::move(decoded))
                            : encode_png(*decoded, wide ? PixelType::u16 : PixelType::u8);
    if (!png) return {};
    note("texture '" + ref.name + "' was " +
         (ref.channels.empty() ? "converted to PNG" : "put together as PNG") +
         (turned ? ", its green turned over" : ""));
    return *std::move(png);
}

void MaterialWriter::normal_map(const Material& m, Json& out) {
    if (!m.normal_map) return;
    if (m.normal_map_space != NormalMapSpace::tangent) {
        note("glTF has no object-space normal maps: left out");
        return;
    }
    set_texture(out, "normalTexture", m.normal_map,
                m.normal_map_flip_green ? Pixels::green_turned : Pixels::kept);
    if (out.contains("normalTexture") && m.normal_map.strength != 1)
        out["normalTexture"]["scale"] = m.normal_map.strength;
}

void MaterialWriter::occlusion(const Material& m, Json& out) {
    set_texture(out, "occlusionTexture", m.occlusion_map);
    if (out.contains("occlusionTexture") && m.occlusion_map.strength != 1)
        out["occlusionTexture"]["strength"] = std::clamp(m.occlusion_map.strength, 0.0f, 1.0f);
}

void MaterialWriter::emission(const Material& m, Json& out) {
    set_texture(out, "emissiveTexture", m.emissive_map);
    if (m.emissive == glm::vec3(0.0f)) return;
    const float largest = std::max({m.emissive.r, m.emissive.g, m.emissive.b});
    const float scale = largest > 1 ? largest : 1;
    out["emissiveFactor"] = array3(glm::max(m.emissive / scale, glm::vec3(0.0f)));
    if (scale > 1) {
        extensions_.insert("KHR_materials_emissive_strength");
        out["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = scale;
    }
}

// A dielectric reflects 4 % of light that falls in straight: the factor scales that.
void MaterialWriter::reflectance(const Material& m, const glm::vec3& reflected, Json& out) {
    const bool usual = reflected == glm::vec3(0.04f) && m.metallic_roughness;
    if (usual && !m.specular_map) return;
    Json specular = Json::object();
    if (!usual) specular["specularColorFactor"] = array3(reflected / 0.04f);
    set_texture(specular, "specularColorTexture", m.specular_map);
    if (specular.empty()) return;
    extensions_.insert("KHR_materials_specular");
    out["extensions"]["KHR_materials_specular"] = std::move(specular);
}

// glTF has no place for displacement (KhronosGroup/glTF#948): our own reader finds it in extras.
void MaterialWriter::displacement(const Material& m, Json& out) {
    Json kept = Json::object();
    set_texture(kept, "texture", m.displacement_map, Pixels::heights);
    if (kept.empty()) return;
    kept["scale"] = m.displacement_scale * m.displacement_map.strength;
    kept["midlevel"] = m.displacement_midlevel;
    kept["kind"] = name_of(m.displacement_kind);
    out["extras"]["displacement"] = std::move(kept);
    note("glTF has no displacement maps: kept in the materials' extras");
}

}  // namespace prep::detail
