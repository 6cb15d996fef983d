#include "formats/gltf/materials.h"

#include <cmath>

namespace prep::detail {
namespace {

using Index = std::uint32_t;

class MaterialReader {
  public:
    MaterialReader(const GltfDocument& document, Scene& scene) : d_(document), scene_(scene) {}

    Result<void> run() {
        if (auto done = images(); !done) return done;
        if (auto done = textures(); !done) return done;
        const Json* list = *top_array(d_, "materials");
        for (std::size_t m = 0; m < list->size(); ++m)
            if (auto done = material((*list)[m], "/materials/" + std::to_string(m)); !done)
                return done;
        return {};
    }

  private:
    Error bad(const std::string& pointer, std::string text) const {
        return {ErrorCode::invalid, std::move(text), d_.place(pointer)};
    }
    static std::string name_of(const Json& object) {
        const auto it = object.find("name");
        return it != object.end() && it->is_string() ? it->get<std::string>() : std::string();
    }
    static const Json* extension(const Json& object, const char* name) {
        const auto all = object.find("extensions");
        if (all == object.end() || !all->is_object()) return nullptr;
        const auto it = all->find(name);
        return it != all->end() && it->is_object() ? &*it : nullptr;
    }

    Result<void> images() {
        const Json* list = *top_array(d_, "images");
        const std::size_t views = (*top_array(d_, "bufferViews"))->size();
        for (std::size_t i = 0; i < list->size(); ++i) {
            const Json& in = (*list)[i];
            const std::string pointer = "/images/" + std::to_string(i);
            ImageRef out;
            out.name = name_of(in);
            if (in.contains("mimeType")) {
                if (!in["mimeType"].is_string())
                    return bad(pointer + "/mimeType", "expected a string");
                out.mime_type = in["mimeType"].get<std::string>();
            }
            if (in.contains("uri")) {
                if (!in["uri"].is_string()) return bad(pointer + "/uri", "expected a string");
                const std::string uri = in["uri"].get<std::string>();
                auto bytes = resolve_uri(d_, uri, pointer + "/uri");
                if (bytes) {
                    out.bytes = *std::move(bytes);
                } else {
                    // A picture that is missing costs its texture, not the mesh.
                    scene_.warnings.push_back(to_string(bytes.error()));
                }
                if (out.name.empty() && !uri.starts_with("data:")) out.name = uri;
            } else if (in.contains("bufferView")) {
                const auto view = index_member(d_, in, "bufferView", pointer, views);
                if (!view) return view.error();
                const auto bytes = d_.view(*view);
                if (!bytes) return bytes.error();
                out.bytes.assign(bytes->begin(), bytes->end());
            }
            scene_.images.push_back(std::move(out));
        }
        return {};
    }

    Result<void> textures() {
        const Json* list = *top_array(d_, "textures");
        const Json* samplers = *top_array(d_, "samplers");
        const std::size_t images = (*top_array(d_, "images"))->size();
        for (std::size_t t = 0; t < list->size(); ++t) {
            const Json& in = (*list)[t];
            const std::string pointer = "/textures/" + std::to_string(t);
            Texture out;
            const auto source = index_member(d_, in, "source", pointer, images);
            if (!source) return source.error();
            out.image = *source;
            if (const Json* webp = extension(in, "EXT_texture_webp")) {
                const auto image = index_member(d_, *webp, "source",
                                                pointer + "/extensions/EXT_texture_webp", images);
                if (!image) return image.error();
                if (out.image == no_index) out.image = *image;
            }
            const auto sampler = index_member(d_, in, "sampler", pointer, samplers->size());
            if (!sampler) return sampler.error();
            if (*sampler != no_index)
                if (auto done = read_sampler((*samplers)[*sampler],
                                             "/samplers/" + std::to_string(*sampler), out);
                    !done)
                    return done;
            scene_.textures.push_back(out);
        }
        return {};
    }

    Result<void> read_sampler(const Json& in, const std::string& pointer, Texture& out) const {
        const auto wrap = [&](const char* key, Wrap& to) -> Result<void> {
            const auto code = whole_member(d_, in, key, pointer, 0, 65535, 10497);
            if (!code) return code.error();
            if (*code == 10497)
                to = Wrap::repeat;
            else if (*code == 33071)
                to = Wrap::clamp;
            else if (*code == 33648)
                to = Wrap::mirror;
            else
                return bad(pointer + "/" + key, "expected 10497, 33071 or 33648");
            return {};
        };
        if (auto done = wrap("wrapS", out.wrap_u); !done) return done;
        if (auto done = wrap("wrapT", out.wrap_v); !done) return done;
        const auto mag = whole_member(d_, in, "magFilter", pointer, 9728, 9729, 9729);
        if (!mag) return mag.error();
        out.mag = *mag == 9728 ? Filter::nearest : Filter::linear;
        const auto min = whole_member(d_, in, "minFilter", pointer, 9728, 9987, 9987);
        if (!min) return min.error();
        switch (*min) {
            case 9728:
                out.min = Filter::nearest, out.mip = MipFilter::none;
                break;
            case 9729:
                out.min = Filter::linear, out.mip = MipFilter::none;
                break;
            case 9984:
                out.min = Filter::nearest, out.mip = MipFilter::nearest;
                break;
            case 9985:
                out.min = Filter::linear, out.mip = MipFilter::nearest;
                break;
            case 9986:
                out.min = Filter::nearest, out.mip = MipFilter::linear;
                break;
            case 9987:
                out.min = Filter::linear, out.mip = MipFilter::linear;
                break;
            default:
                return bad(pointer + "/minFilter", "no filter has this number");
        }
        return {};
    }

    Result<void> numbers(const Json& object, const char* key, const std::string& pointer,
                         std::size_t count, float* out) const {
        const auto it = object.find(key);
        if (it == object.end()) return {};
        const std::string place = pointer + "/" + key;
        if (count == 1) {
            if (!it->is_number()) return bad(place, "expected a number");
            *out = it->get<float>();
            return {};
        }
        if (!it->is_array() || it->size() != count)
            return bad(place, "expected " + std::to_string(count) + " numbers");
        for (std::size_t i = 0; i < count; ++i) {
            if (!(*it)[i].is_number())
                return bad(place + "/" + std::to_string(i), "expected a number");
            out[i] = (*it)[i].get<float>();
        }
        return {};
    }

    Result<void> texture(const Json& owner, const char* key, const std::string& pointer,
                         TextureRef& out, const char* strength = nullptr) const {
        const auto it = owner.find(key);
        if (it == owner.end()) return {};
        const std::string place = pointer + "/" + key;
        if (!it->is_object()) return bad(place, "expected an object");
        const auto index = index_member(d_, *it, "index", place, scene_.textures.size());
        if (!index) return index.error();
        if (*index == no_index) return bad(place + "/index", "the member is missing");
        const auto uv = whole_member(d_, *it, "texCoord", place, 0, 99, 0);
        if (!uv) return uv.error();
        out.texture = *index;
        out.uv_set = Index(*uv);
        if (strength)
            if (auto done = numbers(*it, strength, place, 1, &out.strength); !done) return done;
        if (const Json* transform = extension(*it, "KHR_texture_transform")) {
            const std::string at = place + "/extensions/KHR_texture_transform";
            if (auto done = numbers(*transform, "offset", at, 2, &out.offset.x); !done) return done;
            if (auto done = numbers(*transform, "scale", at, 2, &out.scale.x); !done) return done;
            if (auto done = numbers(*transform, "rotation", at, 1, &out.rotation); !done)
                return done;
            const auto set = whole_member(d_, *transform, "texCoord", at, 0, 99, *uv);
            if (!set) return set.error();
            out.uv_set = Index(*set);
        }
        return {};
    }

    Result<void> material(const Json& in, const std::string& pointer) {
        Material out;
        out.name = name_of(in);
        out.metallic_roughness = true;
        out.diffuse = glm::vec4(1.0f);
        const auto pbr = in.find("pbrMetallicRoughness");
        if (pbr != in.end()) {
            const std::string at = pointer + "/pbrMetallicRoughness";
            if (!pbr->is_object()) return bad(at, "expected an object");
            if (auto r = numbers(*pbr, "baseColorFactor", at, 4, &out.diffuse.x); !r) return r;
            if (auto r = numbers(*pbr, "metallicFactor", at, 1, &out.metallic); !r) return r;
            if (auto r = numbers(*pbr, "roughnessFactor", at, 1, &out.roughness); !r) return r;
            if (auto r = texture(*pbr, "baseColorTexture", at, out.diffuse_map); !r) return r;
            if (auto r = texture(*pbr, "metallicRoughnessTexture", at, out.metallic_roughness_map);
                !r)
                return r;
        }
        if (auto r = texture(in, "normalTexture", pointer, out.normal_map, "scale"); !r) return r;
        if (auto r = texture(in, "occlusionTexture", pointer, out.occlusion_map, "strength"); !r)
            return r;
        if (auto r = texture(in, "emissiveTexture", pointer, out.emissive_map); !r) return r;
        if (auto r = numbers(in, "emissiveFactor", pointer, 3, &out.emissive.x); !r) return r;
        if (const auto it = in.find("alphaMode"); it != in.end()) {
            if (*it == "MASK")
                out.alpha_mode = AlphaMode::mask;
            else if (*it == "BLEND")
                out.alpha_mode = AlphaMode::blend;
            else if (*it != "OPAQUE")
                return bad(pointer + "/alphaMode", "expected OPAQUE, MASK or BLEND");
        }
        if (auto r = numbers(in, "alphaCutoff", pointer, 1, &out.alpha_cutoff); !r) return r;
        if (const auto it = in.find("doubleSided"); it != in.end()) {
            if (!it->is_boolean()) return bad(pointer + "/doubleSided", "expected true or false");
            out.double_sided = it->get<bool>();
        }
        if (auto done = material_extensions(in, pointer, out); !done) return done;
        scene_.materials.push_back(std::move(out));
        return {};
    }

    Result<void> material_extensions(const Json& in, const std::string& pointer, Material& out) {
        const std::string base = pointer + "/extensions/";
        out.unlit = extension(in, "KHR_materials_unlit") != nullptr;
        if (const Json* e = extension(in, "KHR_materials_emissive_strength")) {
            float strength = 1;
            if (auto r = numbers(*e, "emissiveStrength", base + "KHR_materials_emissive_strength",
                                 1, &strength);
                !r)
                return r;
            out.emissive *= strength;
        }
        if (const Json* e = extension(in, "KHR_materials_pbrSpecularGlossiness")) {
            const std::string at = base + "KHR_materials_pbrSpecularGlossiness";
            float glossiness = 1;
            out.metallic_roughness = false;
            out.specular = glm::vec3(1.0f);
            out.diffuse = glm::vec4(1.0f);
            out.diffuse_map = {};
            if (auto r = numbers(*e, "diffuseFactor", at, 4, &out.diffuse.x); !r) return r;
            if (auto r = numbers(*e, "specularFactor", at, 3, &out.specular.x); !r) return r;
            if (auto r = numbers(*e, "glossinessFactor", at, 1, &glossiness); !r) return r;
            if (auto r = texture(*e, "diffuseTexture", at, out.diffuse_map); !r) return r;
            if (auto r = texture(*e, "specularGlossinessTexture", at, out.specular_map); !r)
                return r;
            const float roughness = 1 - glossiness, alpha = std::max(roughness * roughness, 0.02f);
            out.shininess = 2 / (alpha * alpha) - 2;
        }
        // Our own files say exactly what the Blinn-Phong material was.
        const auto extras = in.find("extras");
        if (extras != in.end() && extras->is_object() && extras->contains("blinnPhong") &&
            (*extras)["blinnPhong"].is_object()) {
            const Json& exact = (*extras)["blinnPhong"];
            const std::string at = pointer + "/extras/blinnPhong";
            out.metallic_roughness = false;
            if (auto r = numbers(exact, "ambient", at, 3, &out.ambient.x); !r) return r;
            if (auto r = numbers(exact, "diffuse", at, 4, &out.diffuse.x); !r) return r;
            if (auto r = numbers(exact, "specular", at, 3, &out.specular.x); !r) return r;
            if (auto r = numbers(exact, "shininess", at, 1, &out.shininess); !r) return r;
            if (const Json* e = extension(in, "KHR_materials_specular"))
                if (auto r = texture(*e, "specularColorTexture", base + "KHR_materials_specular",
                                     out.specular_map);
                    !r)
                    return r;
        }
        return {};
    }

    const GltfDocument& d_;
    Scene& scene_;
};

}  // namespace

Result<void> read_gltf_materials(const GltfDocument& document, Scene& scene) {
    return MaterialReader(document, scene).run();
}

}  // namespace prep::detail
