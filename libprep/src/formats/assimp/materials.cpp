// Materials of Assimp's scenes, with their textures and pictures (docs/materials.md).
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "base/srgb.h"
#include "formats/assimp/import.h"
#include "formats/assimp/material_properties.h"
#include "formats/picture_search.h"
#include "image/packed_refs.h"
#include "text/lower_case.h"
#include "text/name_list.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Physically based materials of FBX. Assimp hands their properties through as "$raw.", with the
// exporting program's own words. Null: that program has no such property.
struct PhysicalWords {
    const char* prefix = nullptr;
    const char* base = nullptr;
    const char* weight = nullptr;
    const char* metallic = nullptr;
    const char* roughness = nullptr;
    const char* glossiness = nullptr;
    const char* emission = nullptr;
    const char* emission_weight = nullptr;
    const char* coat = nullptr;
    const char* coat_roughness = nullptr;
    const char* sheen = nullptr;
    const char* sheen_weight = nullptr;
    const char* anisotropy = nullptr;
    const char* refraction = nullptr;
    const char* opacity = nullptr;
    const char* base_map = nullptr;
    const char* metallic_map = nullptr;
    const char* roughness_map = nullptr;
    const char* glossiness_map = nullptr;
    const char* normal_map = nullptr;
    const char* occlusion_map = nullptr;
    const char* emission_map = nullptr;
    const char* opacity_map = nullptr;
    const char* normal_strength = nullptr;
};
constexpr PhysicalWords physical_words[] = {
    // 3ds Max's PBR Material (Metal/Rough)
    {.prefix = "$raw.3dsMax|main|",
     .base = "basecolor",
     .metallic = "metalness",
     .roughness = "roughness",
     .glossiness = "glossiness",
     .emission = "emit_color",
     .base_map = "base_color_map",
     .metallic_map = "metalness_map",
     .roughness_map = "roughness_map",
     .glossiness_map = "glossiness_map",
     .normal_map = "norm_map",
     .occlusion_map = "ao_map",
     .emission_map = "emit_color_map",
     .opacity_map = "opacity_map",
     .normal_strength = "bump_map_amt"},
    // 3ds Max's Physical Material
    {.prefix = "$raw.3dsMax|Parameters|",
     .base = "base_color",
     .weight = "base_weight",
     .metallic = "metalness",
     .roughness = "roughness",
     .emission = "emit_color",
     .emission_weight = "emission",
     .coat = "coating",
     .coat_roughness = "coat_roughness",
     .anisotropy = "anisotropy",
     .refraction = "trans_ior",
     .base_map = "base_color_map",
     .metallic_map = "metalness_map",
     .roughness_map = "roughness_map",
     .normal_map = "bump_map",
     .emission_map = "emit_color_map",
     .opacity_map = "cutout_map",
     .normal_strength = "bump_map_amt"},
    // Maya's Standard Surface and Arnold's (aiStandardSurface)
    {.prefix = "$raw.Maya|",
     .base = "baseColor",
     .weight = "base",
     .metallic = "metalness",
     .roughness = "specularRoughness",
     .emission = "emissionColor",
     .emission_weight = "emission",
     .coat = "coat",
     .coat_roughness = "coatRoughness",
     .sheen = "sheenColor",
     .sheen_weight = "sheen",
     .anisotropy = "specularAnisotropy",
     .refraction = "specularIOR",
     .base_map = "baseColor",
     .metallic_map = "metalness",
     .roughness_map = "specularRoughness",
     .normal_map = "normalCamera",
     .emission_map = "emissionColor",
     .opacity_map = "opacity"},
    // Maya's Stingray PBS
    {.prefix = "$raw.Maya|",
     .base = "base_color",
     .metallic = "metallic",
     .roughness = "roughness",
     .emission = "emissive",
     .emission_weight = "emissive_intensity",
     .base_map = "TEX_color_map",
     .metallic_map = "TEX_metallic_map",
     .roughness_map = "TEX_roughness_map",
     .normal_map = "TEX_normal_map",
     .occlusion_map = "TEX_ao_map",
     .emission_map = "TEX_emissive_map"},
};

class MaterialReader {
  public:
    MaterialReader(AssimpImport& import, const LoadOptions& options)
        : import_(import),
          from_(import.from),
          pictures_(import.path.parent_path(), options.texture_directories),
          scene_(import.scene),
          has_colors_with_alpha_(lower_case(import.path.extension().string()) == ".x") {}

    void run() {
        for (unsigned m = 0; m < from_.mNumMaterials; ++m) material(*from_.mMaterials[m]);
        pictures_.tell(scene_);
        import_.warn_not_kept(not_kept_, "material property", "material properties");
        import_.warn(unplaced_, "map", "maps",
                     "with a rotated or non-finite UV transform: without it");
        CountedNames unused;
        for (unsigned t = 0; t < from_.mNumTextures; ++t)
            if (!embedded_.contains(from_.mTextures[t]))
                unused.add(std::string_view(from_.mTextures[t]->mFilename.data,
                                            from_.mTextures[t]->mFilename.length));
        import_.warn_not_kept(unused, "embedded picture that no map names",
                              "embedded pictures that no map names");
        if (!not_in_package_.empty())
            scene_.warnings.push_back("pictures that the package does not have, or not whole: " +
                                      not_in_package_.text());
        if (!raw_texels_.empty())
            scene_.warnings.push_back("embedded pictures of raw texels were not taken: " +
                                      raw_texels_.text());
    }

  private:
    // --- values ---------------------------------------------------------------------------------

    static float unit(float value) { return std::clamp(value, 0.0f, 1.0f); }

    void material(const aiMaterial& from) {
        const MaterialProperties in(from);
        Material out;
        out.name = in.text(AI_MATKEY_NAME).value_or("");
        if (const auto c = in.color(AI_MATKEY_COLOR_DIFFUSE))
            out.diffuse = glm::vec4(is_encoded(out.name) ? decoded(*c) : *c, out.diffuse.a);
        // Textures of 3MF have no colour beside them: Assimp writes black.
        if (import_.package != nullptr && in.map(aiTextureType_DIFFUSE))
            out.diffuse = glm::vec4(1, 1, 1, out.diffuse.a);
        out.emissive = in.color(AI_MATKEY_COLOR_EMISSIVE).value_or(glm::vec3(0.0f));
        highlight(in, out);
        auto opacity_number = in.number(AI_MATKEY_OPACITY);
        // That of DirectX' face colours, for which Assimp has no word of its own.
        if (!opacity_number && has_colors_with_alpha_)
            opacity_number = in.alpha(AI_MATKEY_COLOR_DIFFUSE);
        if (opacity_number) {
            out.diffuse.a = unit(*opacity_number);
            if (out.diffuse.a < 1) out.alpha_mode = AlphaMode::blend;
        }
        out.double_sided = in.integer(AI_MATKEY_TWOSIDED).value_or(0) != 0;
        out.diffuse_map = first_map(in, {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR});
        out.specular_map = first_map(in, {aiTextureType_SPECULAR});
        out.emissive_map = first_map(in, {aiTextureType_EMISSIVE, aiTextureType_EMISSION_COLOR});
        out.normal_map = first_map(in, {aiTextureType_NORMALS, aiTextureType_NORMAL_CAMERA});
        out.bump_map = first_map(in, {aiTextureType_HEIGHT});
        out.displacement_map = first_map(in, {aiTextureType_DISPLACEMENT});
        out.occlusion_map = first_map(in, {aiTextureType_AMBIENT_OCCLUSION});
        TextureRef opacity = first_map(in, {aiTextureType_OPACITY});
        const PhysicalWords* words = words_of(in);
        if (words)
            physical(in, *words, opacity, out);
        else
            shared_physical(in, out);
        // Of a map that is named something is meant to be seen.
        if (is_there(out.diffuse_map) && glm::vec3(out.diffuse) == glm::vec3(0.0f))
            out.diffuse = glm::vec4(1, 1, 1, out.diffuse.a);
        if (is_there(out.emissive_map) && out.emissive == glm::vec3(0.0f))
            out.emissive = glm::vec3(1.0f);
        opacity_map(opacity, out);
        in.count_unread(not_kept_);
        scene_.materials.push_back(std::move(out));
    }

    // The base materials of 3MF, which Assimp calls so ("id10_Red"), unlike the one that it makes
    // where a file has none: display colours are encoded in sRGB there (3MF core specification).
    bool is_encoded(const std::string& name) const {
        return import_.package != nullptr && name.starts_with("id");
    }
    static glm::vec3 decoded(glm::vec3 color) {
        for (int k = 0; k < 3; ++k) color[k] = float(srgb_to_linear(double(color[k])));
        return color;
    }

    // The specular colour and its multiplier, the exponent, and what stands for them where the file
    // says nothing. A shading model without highlights is taken at its word.
    static void highlight(const MaterialProperties& in, Material& out) {
        const auto exponent = in.number(AI_MATKEY_SHININESS);
        if (exponent && *exponent >= 0) out.shininess = std::min(*exponent, 1e6f);
        const int model = in.integer(AI_MATKEY_SHADING_MODEL).value_or(aiShadingMode_Phong);
        const bool matte = model == aiShadingMode_Gouraud || model == aiShadingMode_OrenNayar ||
                           model == aiShadingMode_Minnaert;
        const auto specular = in.color(AI_MATKEY_COLOR_SPECULAR);
        const float strength = in.number(AI_MATKEY_SHININESS_STRENGTH).value_or(1.0f);
        const bool unfit = exponent && *exponent == 0 && specular && *specular != glm::vec3(0.0f);
        if (unfit) out.shininess = Material{}.shininess;
        if (matte)
            out.specular = glm::vec3(0.0f);
        else if (specular && !unfit)
            out.specular = glm::clamp(*specular * strength, 0.0f, 1e6f);
        else
            out.specular = usual_specular(out.shininess);
    }

    // --- physically based -----------------------------------------------------------------------

    static std::optional<float> raw_number(const MaterialProperties& in, const PhysicalWords& words,
                                           const char* word) {
        return word ? in.number((std::string(words.prefix) + word).c_str()) : std::nullopt;
    }
    static std::optional<glm::vec3> raw_color(const MaterialProperties& in,
                                              const PhysicalWords& words, const char* word) {
        return word ? in.color((std::string(words.prefix) + word).c_str()) : std::nullopt;
    }

    // Those of which the material has a base colour and a roughness or a glossiness.
    static const PhysicalWords* words_of(const MaterialProperties& in) {
        for (const PhysicalWords& words : physical_words)
            if (raw_color(in, words, words.base) &&
                (raw_number(in, words, words.roughness) || raw_number(in, words, words.glossiness)))
                return &words;
        return nullptr;
    }

    void physical(const MaterialProperties& in, const PhysicalWords& words, TextureRef& opacity,
                  Material& out) {
        const auto scaled = [&](const char* color_word, const char* weight_word) {
            const auto c = raw_color(in, words, color_word);
            return c ? *c * raw_number(in, words, weight_word).value_or(1.0f) : glm::vec3(0.0f);
        };
        const auto share = [&](const char* word, float otherwise) {
            return unit(raw_number(in, words, word).value_or(otherwise));
        };
        out.metallic_roughness = true;
        out.diffuse =
            glm::vec4(glm::clamp(scaled(words.base, words.weight), 0.0f, 1.0f), out.diffuse.a);
        out.metallic = share(words.metallic, 0);
        // 3ds Max: 1 where the material speaks of glossiness.
        const bool glossy = in.number("$raw.3dsMax|main|useGlossiness").value_or(2.0f) == 1 &&
                            raw_number(in, words, words.glossiness);
        out.roughness = glossy ? 1 - share(words.glossiness, 0) : share(words.roughness, 0.5f);
        if (in.number("$raw.3dsMax|Parameters|roughness_inv").value_or(0.0f) != 0)
            out.roughness = 1 - out.roughness;
        out.emissive = glm::max(scaled(words.emission, words.emission_weight), 0.0f);
        out.clearcoat = share(words.coat, 0);
        out.clearcoat_roughness = share(words.coat_roughness, 0);
        out.sheen = scaled(words.sheen, words.sheen_weight);
        out.anisotropy = share(words.anisotropy, 0);
        if (const auto index = raw_number(in, words, words.refraction); index && *index > 1) {
            const float q = (*index - 1) / (*index + 1);
            out.reflectance = glm::vec3(q * q);
        }
        const auto take = [&](const char* word, TextureRef& to) {
            if (const TextureRef ref = raw_map(in, words, word)) to = ref;
        };
        take(words.base_map, out.diffuse_map);
        take(words.normal_map, out.normal_map);
        take(words.occlusion_map, out.occlusion_map);
        take(words.emission_map, out.emissive_map);
        take(words.opacity_map, opacity);
        if (out.normal_map)
            out.normal_map.strength = raw_number(in, words, words.normal_strength).value_or(1.0f);
        out.normal_map_flip_green =
            in.number("$raw.3dsMax|settings|normal_flip_green").value_or(0.0f) != 0;
        TextureRef metallic = first_map(in, {aiTextureType_METALNESS});
        TextureRef roughness = first_map(in, {aiTextureType_DIFFUSE_ROUGHNESS});
        take(words.metallic_map, metallic);
        take(glossy ? words.glossiness_map : words.roughness_map, roughness);
        packed_map(metallic, roughness, glossy, out);
        // What these programs do with a picture: it stands for the value, not beside it. Where it
        // is not there, the value is all there is.
        if (is_there(out.diffuse_map)) out.diffuse = glm::vec4(1, 1, 1, out.diffuse.a);
        if (is_there(out.emissive_map)) out.emissive = glm::vec3(1.0f);
        if (is_there(metallic)) out.metallic = 1;
        if (is_there(roughness)) out.roughness = 1;
        out.specular_map = {};
    }

    // Assimp's own keys, which importers of physically based formats fill.
    void shared_physical(const MaterialProperties& in, Material& out) {
        const auto metallic = in.number(AI_MATKEY_METALLIC_FACTOR);
        const TextureRef metallic_map = first_map(in, {aiTextureType_METALNESS});
        if (!metallic && !metallic_map) return;  // Assimp makes roughness of any exponent
        out.metallic_roughness = true;
        if (const auto base = in.color(AI_MATKEY_BASE_COLOR))
            out.diffuse = glm::vec4(*base, out.diffuse.a);
        const TextureRef roughness_map = first_map(in, {aiTextureType_DIFFUSE_ROUGHNESS});
        out.metallic = unit(metallic.value_or(is_there(metallic_map) ? 1.0f : 0.0f));
        out.roughness = unit(in.number(AI_MATKEY_ROUGHNESS_FACTOR).value_or(0.5f));
        if (is_there(roughness_map) && out.roughness == 0) out.roughness = 1;
        packed_map(metallic_map, roughness_map, false, out);
        out.specular_map = {};
    }

    // --- maps -----------------------------------------------------------------------------------

    std::shared_ptr<const ImageRef> source(const TextureRef& ref) const {
        if (!ref) return nullptr;
        return std::make_shared<const ImageRef>(scene_.images[scene_.textures[ref.texture].image]);
    }

    bool is_there(const TextureRef& ref) const {
        if (!ref) return false;
        const ImageRef& image = scene_.images[scene_.textures[ref.texture].image];
        std::error_code ec;
        return !image.bytes.empty() || std::filesystem::is_regular_file(image.path, ec);
    }

    // glTF has one picture for both. The same file for both is such a picture already.
    void packed_map(const TextureRef& metallic, const TextureRef& roughness, bool glossiness,
                    Material& out) {
        if (!metallic && !roughness) return;
        TextureRef& ref = out.metallic_roughness_map;
        ref = roughness ? roughness : metallic;
        if (metallic && roughness && !glossiness && metallic.texture == roughness.texture) return;
        append_packed(ref, {glossiness, metallic.texture, roughness.texture}, [&] {
            return packed_metallic_roughness(source(metallic), source(roughness), glossiness);
        });
    }

    void opacity_map(const TextureRef& opacity, Material& out) {
        if (!is_there(opacity)) return;
        out.alpha_mode = AlphaMode::blend;
        if (out.diffuse_map && out.diffuse_map.texture == opacity.texture) return;
        const TextureRef base = out.diffuse_map;
        if (!out.diffuse_map) out.diffuse_map = opacity;
        append_packed(out.diffuse_map, {2, base.texture, opacity.texture},
                      [&] { return packed_with_opacity(source(base), source(opacity)); });
    }

    // What is made of the same pictures is made once.
    using PackedKey = std::array<Index, 3>;
    template <class Make>
    void append_packed(TextureRef& ref, const PackedKey& key, const Make& make) {
        const auto [it, added] = packed_.emplace(key, Index(scene_.textures.size()));
        if (added) {
            Texture texture = scene_.textures[ref.texture];
            texture.image = Index(scene_.images.size());
            scene_.images.push_back(make());
            scene_.textures.push_back(texture);
        }
        ref.texture = it->second;
    }

    // The first of several kinds that mean the same; more of them that name the same picture say
    // nothing new.
    TextureRef first_map(const MaterialProperties& in, std::initializer_list<aiTextureType> types) {
        std::optional<MaterialProperties::Map> found;
        for (const aiTextureType type : types) {
            if (found && !in.names_picture(type, found->file)) continue;
            const auto map = in.map(type);
            if (!found) found = map;
        }
        return found ? texture(*found) : TextureRef{};
    }

    TextureRef raw_map(const MaterialProperties& in, const PhysicalWords& words, const char* word) {
        if (!word) return {};
        const std::string key = std::string(words.prefix) + word;
        // Assimp gives them the type "unknown".
        const auto file = in.text((key + "|file").c_str(), aiTextureType_UNKNOWN, 0);
        if (!file) return {};
        MaterialProperties::Map map;
        map.file = *file;
        map.uv = unsigned(std::max(
            in.integer((key + "|uvwsrc").c_str(), aiTextureType_UNKNOWN, 0).value_or(0), 0));
        map.transform = in.uv_transform((key + "|uvtrafo").c_str(), aiTextureType_UNKNOWN, 0);
        return texture(map);
    }

    TextureRef texture(const MaterialProperties::Map& map) {
        TextureRef ref;
        const Index image = image_of(map.file);
        if (image == no_index) return ref;
        Texture texture;
        const auto wrap = [](aiTextureMapMode m) {
            return m == aiTextureMapMode_Mirror  ? Wrap::mirror
                   : m == aiTextureMapMode_Clamp ? Wrap::clamp
                   : m == aiTextureMapMode_Decal ? Wrap::border
                                                 : Wrap::repeat;
        };
        texture.wrap_u = wrap(map.mode[0]);
        texture.wrap_v = wrap(map.mode[1]);
        texture.image = image;
        ref.uv_set = map.uv;
        const aiUVTransform* const transform = map.transform ? &*map.transform : nullptr;
        if (transform && transform->mRotation == 0 && std::isfinite(transform->mScaling.x) &&
            std::isfinite(transform->mScaling.y) && std::isfinite(transform->mTranslation.x) &&
            std::isfinite(transform->mTranslation.y)) {
            // v runs upwards there: 1 − v' = s · (1 − v) + t.
            ref.scale = {transform->mScaling.x, transform->mScaling.y};
            ref.offset = {transform->mTranslation.x, float(1 - double(transform->mScaling.y) -
                                                           double(transform->mTranslation.y))};
        } else {
            unplaced_ += transform != nullptr;
        }
        for (ref.texture = 0; ref.texture < scene_.textures.size(); ++ref.texture) {
            const Texture& t = scene_.textures[ref.texture];
            if (t.image == image && t.wrap_u == texture.wrap_u && t.wrap_v == texture.wrap_v)
                return ref;
        }
        scene_.textures.push_back(texture);
        return ref;
    }

    Index image_of(const std::string& file) {
        // MD5 names none so, and Assimp what MD2 has not.
        if (file.empty() || file == "$texture_dummy.bmp") return no_index;
        const auto [it, added] = images_.emplace(file, Index(scene_.images.size()));
        if (!added) return it->second;
        ImageRef image;
        image.name = file;
        if (import_.package != nullptr && file.starts_with('*')) {
            image.name = file.substr(1);
            auto part = import_.package->unpack(image.name);
            if (!part) {
                not_in_package_.add(image.name);
                return it->second = no_index;
            }
            image.bytes = *std::move(part);
        } else if (const aiTexture* embedded = from_.GetEmbeddedTexture(file.c_str())) {
            embedded_.insert(embedded);
            // Height 0: a whole compressed file; else raw texels.
            if (embedded->mHeight != 0) {
                raw_texels_.add(image.name);
                return it->second = no_index;
            }
            const auto* bytes = reinterpret_cast<const std::byte*>(embedded->pcData);
            image.bytes.assign(bytes, bytes + embedded->mWidth);
        } else {
            image.path = pictures_.find(image.name);
        }
        scene_.images.push_back(std::move(image));
        return it->second;
    }

    AssimpImport& import_;
    const aiScene& from_;
    PictureSearch pictures_;
    Scene& scene_;
    bool has_colors_with_alpha_;
    std::map<std::string, Index> images_;
    std::map<PackedKey, Index> packed_;
    NameList raw_texels_, not_in_package_;
    CountedNames not_kept_;
    std::set<const aiTexture*> embedded_;  // those that maps name
    std::uint64_t unplaced_ = 0;
};

}  // namespace

void import_materials(AssimpImport& import, const LoadOptions& options) {
    MaterialReader(import, options).run();
}

// Assimp leaves out sets that a file numbers and has not, and keeps the numbers in the materials.
// A mesh, or a part of one that was joined, has one material there.
void settle_uv_sets(AssimpImport& import) {
    Scene& scene = import.scene;
    std::vector<std::size_t> sets(scene.materials.size(), 0);
    const auto has = [&](Index material, std::size_t count) {
        if (material < sets.size()) sets[material] = std::max(sets[material], count);
    };
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        const Mesh& mesh = scene.meshes[m];
        if (m < import.parts.size() && !import.parts[m].empty())
            for (const MeshPart& part : import.parts[m])
                has(part.material, std::size_t(std::popcount(part.uv_sets)));
        else if (!mesh.face_materials.empty())
            has(mesh.face_materials[0], mesh.uvs.size());
    }
    std::uint64_t moved = 0;
    for (std::size_t m = 0; m < sets.size(); ++m)
        for (const MaterialMap& map : material_maps)
            if (TextureRef& ref = scene.materials[m].*map.ref;
                ref && ref.uv_set > 0 && sets[m] == 1) {
                ref.uv_set = 0;
                ++moved;
            }
    import.warn(moved, "map", "maps",
                "of a UV set that the mesh has under another number: its only one is taken");
}

}  // namespace prep::detail
