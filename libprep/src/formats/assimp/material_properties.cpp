#include "formats/assimp/material_properties.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

namespace prep::detail {
namespace {

std::string_view text_of(const aiString& s) {
    return {s.data, s.length};
}

// The numbers of a property, whatever their type; none where it is text or of unknown bytes.
std::vector<double> numbers_of(const aiMaterialProperty& property) {
    std::vector<double> numbers;
    const auto take = [&](auto kind) {
        for (std::size_t at = 0; at + sizeof kind <= property.mDataLength; at += sizeof kind) {
            std::memcpy(&kind, property.mData + at, sizeof kind);
            numbers.push_back(double(kind));
        }
    };
    if (property.mType == aiPTI_Float) take(float());
    if (property.mType == aiPTI_Double) take(double());
    if (property.mType == aiPTI_Integer) take(int());
    return numbers;
}

// Assimp hands FBX's words for these through beside keys of its own.
constexpr std::array echoes = {"Ambient",           "AmbientColor",
                               "AmbientFactor",     "Bump",
                               "BumpFactor",        "Diffuse",
                               "DiffuseColor",      "DiffuseFactor",
                               "DisplacementColor", "DisplacementFactor",
                               "Emissive",          "EmissiveColor",
                               "EmissiveFactor",    "MultiLayer",
                               "NormalMap",         "Opacity",
                               "ReflectionColor",   "ReflectionFactor",
                               "Reflectivity",      "ShadingModel",
                               "Shininess",         "ShininessExponent",
                               "Specular",          "SpecularColor",
                               "SpecularFactor",    "TransparencyFactor",
                               "TransparentColor"};
// By which programs know a kind of material again.
constexpr std::array kinds = {"ClassIDa", "ClassIDb", "SuperClassID", "TypeId"};

constexpr std::string_view raw_prefix = "$raw.";

bool is_echo(std::string_view key) {
    if (!key.starts_with(raw_prefix)) return false;
    const std::string_view word = key.substr(raw_prefix.size());
    const auto same = [&](const char* known) { return word.substr(0, word.find('|')) == known; };
    const auto ends = [&](const char* known) { return word.ends_with(known); };
    return std::any_of(echoes.begin(), echoes.end(), same) ||
           std::any_of(kinds.begin(), kinds.end(), ends);
}

// "$raw.3dsMax|settings|ao_affects_diffuse" without its program: lists of names hold short ones.
std::string_view short_name(std::string_view key) {
    constexpr std::size_t longest = 32;
    if (!key.starts_with(raw_prefix) || key.size() <= longest) return key;
    const std::size_t program = key.find('|');
    return key.substr(program == key.npos ? raw_prefix.size() : program + 1);
}

bool all_of(const std::vector<double>& numbers, double value) {
    return std::all_of(numbers.begin(), numbers.end(), [&](double x) { return x == value; });
}

// What a map's own keys are where they change nothing.
bool is_usual_map_setting(std::string_view key, const std::vector<double>& numbers) {
    if (key == _AI_MATKEY_TEXBLEND_BASE) return all_of(numbers, 1);
    if (key.ends_with("uvtrafo")) return numbers == std::vector<double>{0, 0, 1, 1, 0};
    return all_of(numbers, 0);  // multiplied, by UVs, without flags
}

}  // namespace

MaterialProperties::MaterialProperties(const aiMaterial& material)
    : material_(material), read_(material.mNumProperties, false) {}

const aiMaterialProperty* MaterialProperties::find(const char* key, unsigned type,
                                                   unsigned index) const {
    for (unsigned p = 0; p < material_.mNumProperties; ++p) {
        const aiMaterialProperty* const property = material_.mProperties[p];
        if (!property || property->mSemantic != type || property->mIndex != index ||
            text_of(property->mKey) != key)
            continue;
        read_[p] = true;
        return property;
    }
    return nullptr;
}

std::optional<float> MaterialProperties::number(const char* key, unsigned type,
                                                unsigned index) const {
    float value = 0;
    if (!find(key, type, index) || material_.Get(key, type, index, value) != AI_SUCCESS ||
        !std::isfinite(value))
        return std::nullopt;
    return value;
}

std::optional<glm::vec3> MaterialProperties::color(const char* key, unsigned type,
                                                   unsigned index) const {
    aiColor3D c;
    if (!find(key, type, index) || material_.Get(key, type, index, c) != AI_SUCCESS)
        return std::nullopt;
    if (!std::isfinite(c.r) || !std::isfinite(c.g) || !std::isfinite(c.b)) return std::nullopt;
    return glm::vec3(c.r, c.g, c.b);
}

std::optional<float> MaterialProperties::alpha(const char* key, unsigned type,
                                               unsigned index) const {
    float values[4];
    unsigned count = 4;
    if (!find(key, type, index) || material_.Get(key, type, index, values, &count) != AI_SUCCESS ||
        count < 4 || !std::isfinite(values[3]))
        return std::nullopt;
    return values[3];
}

std::optional<int> MaterialProperties::integer(const char* key, unsigned type,
                                               unsigned index) const {
    int value = 0;
    if (!find(key, type, index) || material_.Get(key, type, index, value) != AI_SUCCESS)
        return std::nullopt;
    return value;
}

std::optional<std::string> MaterialProperties::text(const char* key, unsigned type,
                                                    unsigned index) const {
    aiString value;
    if (!find(key, type, index) || material_.Get(key, type, index, value) != AI_SUCCESS)
        return std::nullopt;
    return std::string(text_of(value));
}

std::optional<aiUVTransform> MaterialProperties::uv_transform(const char* key, unsigned type,
                                                              unsigned index) const {
    aiUVTransform value;
    if (!find(key, type, index) || material_.Get(key, type, index, value) != AI_SUCCESS)
        return std::nullopt;
    return value;
}

std::optional<MaterialProperties::Map> MaterialProperties::map(aiTextureType type) const {
    auto file = text(AI_MATKEY_TEXTURE(type, 0));
    if (!file) return std::nullopt;
    Map map;
    map.file = *std::move(file);
    map.uv = unsigned(integer(AI_MATKEY_UVWSRC(type, 0)).value_or(0));
    map.mode[0] = aiTextureMapMode(integer(AI_MATKEY_MAPPINGMODE_U(type, 0)).value_or(0));
    map.mode[1] = aiTextureMapMode(integer(AI_MATKEY_MAPPINGMODE_V(type, 0)).value_or(0));
    map.transform = uv_transform(AI_MATKEY_UVTRANSFORM(type, 0));
    return map;
}

bool MaterialProperties::names_picture(aiTextureType type, const std::string& file) const {
    aiString named;
    return material_.Get(AI_MATKEY_TEXTURE(type, 0), named) == AI_SUCCESS && text_of(named) == file;
}

const aiMaterialProperty* MaterialProperties::peek(const char* key) const {
    for (unsigned p = 0; p < material_.mNumProperties; ++p)
        if (material_.mProperties[p] && text_of(material_.mProperties[p]->mKey) == key)
            return material_.mProperties[p];
    return nullptr;
}

bool MaterialProperties::says_nothing(const aiMaterialProperty& property) const {
    const std::string_view key = text_of(property.mKey);
    if (property.mType == aiPTI_String) {
        aiString value;
        return material_.Get(property.mKey.C_Str(), property.mSemantic, property.mIndex, value) ==
                   AI_SUCCESS &&
               value.length == 0;
    }
    std::vector<double> numbers = numbers_of(property);
    if (numbers.empty()) return false;
    if (key.starts_with("$tex.") || key.ends_with("|uvtrafo") || key.ends_with("|uvwsrc"))
        return is_usual_map_setting(key, numbers);
    // Four numbers are three and an alpha, which says nothing of black.
    if (numbers.size() == 4) numbers.pop_back();
    if (key == "$mat.refracti" || key == "$mat.bumpscaling" || key == "$mat.displacementscaling")
        return all_of(numbers, 1);
    if (all_of(numbers, 0)) return true;
    // What Assimp has for Collada files that say nothing.
    if (key == "$clr.ambient" && all_of(numbers, double(0.1f))) return true;
    const auto is_zero = [&](const char* other) {
        const aiMaterialProperty* const there = peek(other);
        std::vector<double> values = there ? numbers_of(*there) : std::vector<double>();
        if (values.size() == 4) values.pop_back();
        return there && all_of(values, 0);
    };
    // A colour times its factor; the opacity, which is read, has the mean of the transparent one.
    if (key == "$clr.reflective") return is_zero("$mat.reflectivity");
    if (key == "$mat.reflectivity") return is_zero("$clr.reflective");
    if (key == "$clr.transparent")
        return is_zero("$mat.transparencyfactor") || all_of(numbers, numbers[0]);
    if (key == "$mat.transparencyfactor") return peek("$mat.opacity") != nullptr;
    if (key == "$mat.roughnessFactor") return peek("$mat.shininess") != nullptr;
    return false;
}

void MaterialProperties::count_unread(CountedNames& names) const {
    // Textures that are not read are one thing each, whatever they say of themselves.
    const auto is_read_map = [&](const aiMaterialProperty& setting) {
        for (unsigned p = 0; p < material_.mNumProperties; ++p) {
            const aiMaterialProperty* const file = material_.mProperties[p];
            if (file && read_[p] && file->mSemantic == setting.mSemantic &&
                file->mIndex == setting.mIndex && text_of(file->mKey) == _AI_MATKEY_TEXTURE_BASE)
                return true;
        }
        return false;
    };
    const auto is_read_raw_map = [&](std::string_view key) {
        const std::string file = std::string(key.substr(0, key.rfind('|'))) + "|file";
        for (unsigned p = 0; p < material_.mNumProperties; ++p)
            if (read_[p] && text_of(material_.mProperties[p]->mKey) == file) return true;
        return false;
    };
    for (unsigned p = 0; p < material_.mNumProperties; ++p) {
        const aiMaterialProperty* const property = material_.mProperties[p];
        if (!property || read_[p]) continue;
        const std::string_view key = text_of(property->mKey);
        if (is_echo(key) || says_nothing(*property)) continue;
        if (key == _AI_MATKEY_TEXTURE_BASE) {
            const auto type = aiTextureType(property->mSemantic);
            std::string name = "map " + std::string(aiTextureTypeToString(type));
            if (property->mIndex > 0) name += " " + std::to_string(property->mIndex + 1);
            names.add(name);
            continue;
        }
        if (key.starts_with("$tex.") && !is_read_map(*property)) continue;
        if (key.starts_with(raw_prefix) &&
            (key.ends_with("|uvtrafo") || key.ends_with("|uvwsrc")) && !is_read_raw_map(key))
            continue;
        names.add(short_name(key));
    }
}

}  // namespace prep::detail
