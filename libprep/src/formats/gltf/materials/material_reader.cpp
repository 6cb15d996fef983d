#include "formats/gltf/materials/material_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "formats/gltf/gltf.h"
#include "formats/picture_search.h"
#include "prep/files.h"
#include "text/percent_encoding.h"

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
    Result<void> images() {
        const Json* list = *top_array(d_, "images");
        PictureSearch pictures(d_.directory, d_.texture_directories);
        const std::size_t views = (*top_array(d_, "bufferViews"))->size();
        std::set<std::string> files;
        // Each has bytes of its own; what the file has once may be named ten thousand times.
        std::uint64_t left = decoded_limit(d_.input_bytes);
        for (std::size_t i = 0; i < list->size(); ++i) {
            const Json& in = (*list)[i];
            const std::string pointer = "/images/" + std::to_string(i);
            ImageRef out;
            out.name = name_of(in);
            if (in.contains("mimeType")) {
                if (!in["mimeType"].is_string())
                    return d_.bad(pointer + "/mimeType", "expected a string");
                out.mime_type = in["mimeType"].get<std::string>();
            }
            const auto view = index_member(d_, in, "bufferView", pointer, views);
            if (!view) return view.error();
            if (in.contains("uri")) {
                if (!in["uri"].is_string()) return d_.bad(pointer + "/uri", "expected a string");
                const std::string uri = in["uri"].get<std::string>();
                auto bytes = resolve_uri(d_, uri, pointer + "/uri");
                std::string file = file_of_uri(d_, uri);
                if (bytes && !file.empty()) out.read_from = d_.directory / percent_decoded(uri);
                // Elsewhere than it says, or by a path of another machine.
                bool listed = false;
                if (!bytes && !d_.directory.empty() && bytes.error().code != ErrorCode::syntax) {
                    if (const auto path = pictures.locate(uri)) {
                        bytes = read_file(*path);
                        if (bytes) out.read_from = *path;
                        std::error_code ignored;
                        file = std::filesystem::weakly_canonical(*path, ignored).string();
                    } else if (bytes.error().code == ErrorCode::io) {
                        pictures.find(uri);
                        listed = true;
                    }
                }
                // A picture that is missing costs its texture, not the mesh.
                if (bytes)
                    out.bytes = *std::move(bytes);
                else if (!listed)
                    scene_.warnings.push_back(to_string(bytes.error()));
                // What stands in the JSON itself is there as often as it is written.
                if (file.empty() || files.insert(file).second) left += out.bytes.size();
                if (out.name.empty() && !uri.starts_with("data:")) out.name = uri;
            } else if (in.contains("bufferView")) {
                const auto bytes = d_.view(*view);
                if (!bytes) return bytes.error();
                if (bytes->size() > left) return too_many(pointer);
                out.bytes.assign(bytes->begin(), bytes->end());
            }
            if (out.bytes.size() > left) return too_many(pointer);
            left -= out.bytes.size();
            scene_.images.push_back(std::move(out));
        }
        pictures.tell(scene_);
        return {};
    }

    Error too_many(const std::string& pointer) const {
        return d_.bad(pointer,
                      "pictures name the same data so often that they would fill " +
                          std::to_string(decoded_limit(d_.input_bytes) >> 20) + " MiB",
                      ErrorCode::limit);
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
            // Where the file has a picture of a common kind as well, that is the one drawn.
            for (const char* name : {"EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds",
                                     "KHR_texture_basisu"}) {
                const Json* const other = extension_of(in, name);
                if (!other) continue;
                const auto image = index_member(
                    d_, *other, "source", pointer + "/extensions/" + std::string(name), images);
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
                return d_.bad(pointer + "/" + key, "expected 10497, 33071 or 33648");
            return {};
        };
        if (auto done = wrap("wrapS", out.wrap_u); !done) return done;
        if (auto done = wrap("wrapT", out.wrap_v); !done) return done;
        const auto mag = whole_member(d_, in, "magFilter", pointer, 9728, 9729, 9729);
        if (!mag) return mag.error();
        out.mag = *mag == 9728 ? Filter::nearest : Filter::linear;
        const auto min = whole_member(d_, in, "minFilter", pointer, 9728, 9987, 9987);
        if (!min) return min.error();
        static constexpr struct {
            std::uint64_t code;
            Filter min;
            MipFilter mip;
        } filters[] = {
            {9728, Filter::nearest, MipFilter::none},    {9729, Filter::linear, MipFilter::none},
            {9984, Filter::nearest, MipFilter::nearest}, {9985, Filter::linear, MipFilter::nearest},
            {9986, Filter::nearest, MipFilter::linear},  {9987, Filter::linear, MipFilter::linear}};
        const auto filter = std::find_if(std::begin(filters), std::end(filters),
                                         [&](const auto& f) { return f.code == *min; });
        if (filter == std::end(filters))
            return d_.bad(pointer + "/minFilter", "no filter has this number");
        out.min = filter->min;
        out.mip = filter->mip;
        return {};
    }

    Result<void> numbers(const Json& object, const char* key, const std::string& pointer,
                         std::size_t count, float* out) const {
        return read_numbers(d_, object, key, pointer, std::span(out, count));
    }

    Result<void> texture(const Json& owner, const char* key, const std::string& pointer,
                         TextureRef& out, const char* strength = nullptr) const {
        const auto it = owner.find(key);
        if (it == owner.end()) return {};
        const std::string place = pointer + "/" + key;
        if (!it->is_object()) return d_.bad(place, "expected an object");
        const auto index = index_member(d_, *it, "index", place, scene_.textures.size());
        if (!index) return index.error();
        if (*index == no_index) return d_.bad(place + "/index", "the member is missing");
        const auto uv = whole_member(d_, *it, "texCoord", place, 0, 99, 0);
        if (!uv) return uv.error();
        out.texture = *index;
        out.uv_set = Index(*uv);
        if (strength)
            if (auto done = numbers(*it, strength, place, 1, &out.strength); !done) return done;
        if (const Json* transform = extension_of(*it, "KHR_texture_transform")) {
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
            if (!pbr->is_object()) return d_.bad(at, "expected an object");
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
                return d_.bad(pointer + "/alphaMode", "expected OPAQUE, MASK or BLEND");
        }
        if (auto r = numbers(in, "alphaCutoff", pointer, 1, &out.alpha_cutoff); !r) return r;
        if (const auto it = in.find("doubleSided"); it != in.end()) {
            if (!it->is_boolean())
                return d_.bad(pointer + "/doubleSided", "expected true or false");
            out.double_sided = it->get<bool>();
        }
        if (auto done = material_extensions(in, pointer, out); !done) return done;
        scene_.materials.push_back(std::move(out));
        return {};
    }

    Result<void> material_extensions(const Json& in, const std::string& pointer, Material& out) {
        const std::string base = pointer + "/extensions/";
        out.unlit = extension_of(in, "KHR_materials_unlit") != nullptr;
        if (const Json* e = extension_of(in, "KHR_materials_emissive_strength")) {
            float strength = 1;
            if (auto r = numbers(*e, "emissiveStrength", base + "KHR_materials_emissive_strength",
                                 1, &strength);
                !r)
                return r;
            out.emissive *= strength;
        }
        if (const Json* e = extension_of(in, "KHR_materials_pbrSpecularGlossiness")) {
            const std::string at = base + "KHR_materials_pbrSpecularGlossiness";
            float glossiness = 1;
            glm::vec3 specular(1.0f);  // F0
            out.metallic_roughness = true;
            out.metallic = 0;
            out.metallic_roughness_map = {};
            out.diffuse = glm::vec4(1.0f);
            out.diffuse_map = {};
            if (auto r = numbers(*e, "diffuseFactor", at, 4, &out.diffuse.x); !r) return r;
            if (auto r = numbers(*e, "specularFactor", at, 3, &specular.x); !r) return r;
            if (auto r = numbers(*e, "glossinessFactor", at, 1, &glossiness); !r) return r;
            if (auto r = texture(*e, "diffuseTexture", at, out.diffuse_map); !r) return r;
            if (auto r = texture(*e, "specularGlossinessTexture", at, out.specular_map); !r)
                return r;
            out.roughness = 1 - glossiness;
            out.reflectance = glm::clamp(specular, 0.0f, 1.0f);
            // What is not reflected is scattered. Where a map says how much is reflected, mostly
            // by a factor of 1, all of it is: no material here has a map of what is left.
            const float most = std::max({out.reflectance.r, out.reflectance.g, out.reflectance.b});
            if (!out.specular_map && !out.unlit)
                for (int k = 0; k < 3; ++k) out.diffuse[k] *= 1 - most;
            if (out.specular_map)
                scene_.warnings.push_back(pointer +
                                          ": the glossiness of specularGlossinessTexture (its "
                                          "alpha) is not drawn, glossinessFactor alone is");
        }
        if (auto done = tangent_extensions(in, pointer, out); !done) return done;
        if (auto done = reflectance(in, pointer, out); !done) return done;
        if (auto done = layers(in, pointer, out); !done) return done;
        if (auto done = displacement(in, pointer, out); !done) return done;
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
        }
        return {};
    }

    // Extras are anyone's: what is not as we write it is somebody else's, and told.
    Result<void> displacement(const Json& in, const std::string& pointer, Material& out) {
        const auto extras = in.find("extras");
        if (extras == in.end() || !extras->is_object()) return {};
        const auto kept = extras->find("displacement");
        if (kept == extras->end()) return {};
        const std::string at = pointer + "/extras/displacement";
        Material read;
        const auto parse = [&]() -> Result<void> {
            if (!kept->is_object()) return d_.bad(at, "expected an object");
            // The number of a texture is its whole.
            Json info = *kept;
            const auto number = info.find("texture");
            if (number == info.end()) return d_.bad(at + "/texture", "the member is missing");
            if (number->is_number()) *number = Json{{"index", *number}};
            if (auto r = texture(info, "texture", at, read.displacement_map); !r) return r;
            if (auto r = numbers(*kept, "scale", at, 1, &read.displacement_scale); !r) return r;
            if (auto r = numbers(*kept, "midlevel", at, 1, &read.displacement_midlevel); !r)
                return r;
            const auto kind = kept->find("kind");
            if (kind == kept->end()) return {};
            if (!kind->is_string()) return d_.bad(at + "/kind", "expected a string");
            const auto named = enum_named<DisplacementKind>(kind->get<std::string>());
            if (!named) return d_.bad(at + "/kind", named.error().text);
            read.displacement_kind = *named;
            return {};
        };
        if (const auto done = parse(); !done) {
            scene_.warnings.push_back(to_string(done.error()) + "; this displacement was left out");
            return {};
        }
        out.displacement_map = read.displacement_map;
        out.displacement_scale = read.displacement_scale;
        out.displacement_midlevel = read.displacement_midlevel;
        out.displacement_kind = read.displacement_kind;
        return {};
    }

    // What a dielectric reflects: KHR_materials_ior and KHR_materials_specular.
    Result<void> reflectance(const Json& in, const std::string& pointer, Material& out) {
        if (extension_of(in, "KHR_materials_pbrSpecularGlossiness")) return {};  // has its own
        const std::string base = pointer + "/extensions/";
        if (const Json* e = extension_of(in, "KHR_materials_ior")) {
            float index = 1.5f;
            if (auto r = numbers(*e, "ior", base + "KHR_materials_ior", 1, &index); !r) return r;
            // 0 stands for no limit: then all of it is reflected.
            const float q = index > 0 ? (index - 1) / (index + 1) : 1.0f;
            if (index != 1.5f && std::isfinite(q)) out.reflectance = glm::vec3(q * q);
        }
        const Json* e = extension_of(in, "KHR_materials_specular");
        if (!e) return {};
        const std::string at = base + "KHR_materials_specular";
        float strength = 1;
        glm::vec3 color(1.0f);
        if (auto r = numbers(*e, "specularFactor", at, 1, &strength); !r) return r;
        if (auto r = numbers(*e, "specularColorFactor", at, 3, &color.x); !r) return r;
        if (strength != 1 || color != glm::vec3(1.0f))
            out.reflectance = glm::clamp(out.reflectance * color, 0.0f, 1.0f) * strength;
        return texture(*e, "specularColorTexture", at, out.specular_map);
    }

    // Carried to files that hold them; nothing here draws them.
    Result<void> layers(const Json& in, const std::string& pointer, Material& out) {
        const std::string base = pointer + "/extensions/";
        if (const Json* e = extension_of(in, "KHR_materials_clearcoat")) {
            const std::string at = base + "KHR_materials_clearcoat";
            if (auto r = numbers(*e, "clearcoatFactor", at, 1, &out.clearcoat); !r) return r;
            if (auto r = numbers(*e, "clearcoatRoughnessFactor", at, 1, &out.clearcoat_roughness);
                !r)
                return r;
        }
        if (const Json* e = extension_of(in, "KHR_materials_sheen")) {
            const std::string at = base + "KHR_materials_sheen";
            if (auto r = numbers(*e, "sheenColorFactor", at, 3, &out.sheen.x); !r) return r;
            if (auto r = numbers(*e, "sheenRoughnessFactor", at, 1, &out.sheen_roughness); !r)
                return r;
        }
        if (const Json* e = extension_of(in, "KHR_materials_anisotropy"))
            return numbers(*e, "anisotropyRotation", base + "KHR_materials_anisotropy", 1,
                           &out.anisotropy_rotation);
        return {};
    }

    // Whatever extension has a normal map (clearcoat, detail maps of vendors): the file's
    // first says which UVs tangents follow.
    Result<void> tangent_extensions(const Json& in, const std::string& pointer, Material& out) {
        const auto all = in.find("extensions");
        if (all == in.end() || !all->is_object()) return {};
        for (const auto& item : all->items()) {
            if (!item.value().is_object()) continue;
            const std::string at = pointer + "/extensions/" + item.key();
            for (const auto& member : item.value().items()) {
                const std::string& key = member.key();
                if (!(key.ends_with("NormalTexture") || key == "normalTexture") ||
                    out.layer_normal_map)
                    continue;
                if (auto r = texture(item.value(), key.c_str(), at, out.layer_normal_map, "scale");
                    !r)
                    return r;
            }
        }
        if (const Json* e = extension_of(in, "KHR_materials_anisotropy")) {
            const std::string at = pointer + "/extensions/KHR_materials_anisotropy";
            if (auto r = numbers(*e, "anisotropyStrength", at, 1, &out.anisotropy); !r) return r;
            if (auto r = texture(*e, "anisotropyTexture", at, out.anisotropy_map); !r) return r;
            if (out.anisotropy == 0) out.anisotropy_map = {};
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

namespace prep {
namespace {

struct UndrawnNumber {
    const char *extension, *member;
    int part;          // of a list; -1: it is a number itself, or a texture that is there or not
    double otherwise;  // what the extension has where it does not say
};

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr UndrawnNumber undrawn[] = {
    {"KHR_materials_transmission", "transmissionFactor", -1, 0},
    {"KHR_materials_transmission", "transmissionTexture", -1, 0},
    {"KHR_materials_volume", "thicknessFactor", -1, 0},
    {"KHR_materials_volume", "thicknessTexture", -1, 0},
    {"KHR_materials_volume", "attenuationDistance", -1, infinite},
    {"KHR_materials_volume", "attenuationColor", 0, 1},
    {"KHR_materials_volume", "attenuationColor", 1, 1},
    {"KHR_materials_volume", "attenuationColor", 2, 1},
    {"KHR_materials_iridescence", "iridescenceFactor", -1, 0},
    {"KHR_materials_iridescence", "iridescenceTexture", -1, 0},
    {"KHR_materials_iridescence", "iridescenceIor", -1, 1.3},
    {"KHR_materials_iridescence", "iridescenceThicknessMinimum", -1, 100},
    {"KHR_materials_iridescence", "iridescenceThicknessMaximum", -1, 400},
    {"KHR_materials_iridescence", "iridescenceThicknessTexture", -1, 0},
    {"KHR_materials_dispersion", "dispersion", -1, 0},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionFactor", -1, 0},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionTexture", -1, 0},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionColorFactor", 0, 1},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionColorFactor", 1, 1},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionColorFactor", 2, 1},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionColorTexture", -1, 0},
};

double undrawn_number(const detail::Json& extensions, const UndrawnNumber& number) {
    const auto extension = extensions.find(number.extension);
    if (extension == extensions.end() || !extension->is_object()) return number.otherwise;
    const auto member = extension->find(number.member);
    if (member == extension->end()) return number.otherwise;
    if (member->is_object()) return 1;
    if (number.part < 0) return member->is_number() ? member->get<double>() : number.otherwise;
    const auto part = std::size_t(number.part);
    return member->is_array() && part < member->size() && (*member)[part].is_number()
               ? (*member)[part].get<double>()
               : number.otherwise;
}

}  // namespace

std::vector<std::pair<std::string_view, double>> undrawn_numbers(const Scene& scene,
                                                                 std::uint32_t material) {
    static const detail::Json none = detail::Json::object();
    const GltfDocument* const document = detail::gltf_document(scene);
    const detail::Json* extensions = &none;
    if (document && document->json.contains("materials") &&
        material < document->json["materials"].size()) {
        const detail::Json& of = document->json["materials"][material];
        if (const auto list = of.find("extensions"); list != of.end() && list->is_object())
            extensions = &*list;
    }
    std::vector<std::pair<std::string_view, double>> numbers;
    for (const UndrawnNumber& number : undrawn)
        numbers.emplace_back(number.member, undrawn_number(*extensions, number));
    return numbers;
}

std::set<std::string> extensions_beyond_materials(const Scene& scene) {
    static const std::set<std::string> held{"KHR_materials_anisotropy",
                                            "KHR_materials_clearcoat",
                                            "KHR_materials_emissive_strength",
                                            "KHR_materials_ior",
                                            "KHR_materials_pbrSpecularGlossiness",
                                            "KHR_materials_sheen",
                                            "KHR_materials_specular",
                                            "KHR_materials_unlit"};
    // Of these the numbers alone are.
    static const std::set<std::string> without_maps{
        "KHR_materials_anisotropy", "KHR_materials_clearcoat", "KHR_materials_sheen",
        "KHR_materials_specular"};
    const auto has_map = [](const detail::Json& extension) {
        for (const auto& member : extension.items())
            if (member.key().ends_with("Texture")) return true;
        return false;
    };
    std::set<std::string> names;
    const GltfDocument* const document = detail::gltf_document(scene);
    if (!document || !document->json.contains("materials")) return names;
    for (const detail::Json& material : document->json["materials"]) {
        const auto list = material.find("extensions");
        if (list == material.end() || !list->is_object()) continue;
        for (const auto& item : list->items()) {
            if (!held.contains(item.key()))
                names.insert(item.key());
            else if (without_maps.contains(item.key()) && has_map(item.value()))
                names.insert("maps of " + item.key());
        }
    }
    return names;
}

}  // namespace prep
