#include "gltf_cases.h"

#include <cmath>
#include <limits>
#include <random>

namespace test {
namespace {

using OrderedJson = GltfMaker::Json;

class Values {
  public:
    explicit Values(unsigned seed) : engine_(seed) {}

    // Whole types: the extremes first, then anything. Floats: −1 … 1.
    template <class T>
    std::vector<T> of(std::size_t count) {
        std::vector<T> out(count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t bits = std::uint32_t(engine_());
            if constexpr (std::is_floating_point_v<T>)
                out[i] = T(bits) / 2147483648.0f - 1;
            else
                out[i] = i == 0   ? std::numeric_limits<T>::lowest()
                         : i == 1 ? std::numeric_limits<T>::max()
                                  : T(bits);
        }
        return out;
    }
    std::size_t below(std::size_t bound) { return engine_() % bound; }

  private:
    std::mt19937 engine_;
};

constexpr std::size_t vertices = 12;

OrderedJson with_positions(GltfMaker& maker, Values& values) {
    return {{"POSITION", maker.accessor(values.of<float>(3 * vertices), "VEC3")}};
}

// What KHR_mesh_quantization and the core allow for each attribute.
GltfMaker component_types() {
    GltfMaker maker;
    Values values(1);
    OrderedJson primitives = OrderedJson::array();
    const auto add = [&](const auto& example, bool normalized) {
        using T = std::decay_t<decltype(example)>;
        const auto accessor = [&](const char* type) {
            return maker.accessor(values.of<T>(std::size_t(type[3] - '0') * vertices), type,
                                  normalized);
        };
        OrderedJson attributes{{"POSITION", accessor("VEC3")},
                               {"TEXCOORD_0", accessor("VEC2")},
                               {"TEXCOORD_1", accessor("VEC2")}};
        if (std::is_signed_v<T> && (normalized || std::is_floating_point_v<T>)) {
            attributes["NORMAL"] = accessor("VEC3");
            attributes["TANGENT"] = accessor("VEC4");
        }
        if (std::is_floating_point_v<T> || (normalized && !std::is_signed_v<T>)) {
            attributes["COLOR_0"] = accessor("VEC4");
            attributes["COLOR_1"] = accessor("VEC3");
            attributes["WEIGHTS_0"] = accessor("VEC4");
            attributes["WEIGHTS_1"] = accessor("VEC4");
            attributes["JOINTS_0"] = maker.accessor(values.of<std::uint8_t>(4 * vertices), "VEC4");
            attributes["JOINTS_1"] = maker.accessor(values.of<std::uint16_t>(4 * vertices), "VEC4");
        }
        OrderedJson target{{"POSITION", accessor("VEC3")}};
        if (attributes.contains("NORMAL")) target["NORMAL"] = accessor("VEC3");
        attributes["_CUSTOM"] = accessor("VEC3");
        primitives.push_back({{"attributes", attributes}, {"targets", {target}}});
    };
    add(std::int8_t(), false), add(std::int8_t(), true);
    add(std::uint8_t(), false), add(std::uint8_t(), true);
    add(std::int16_t(), false), add(std::int16_t(), true);
    add(std::uint16_t(), false), add(std::uint16_t(), true);
    add(float(), false);
    maker.mesh(primitives);
    maker.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    maker.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    return maker;
}

GltfMaker sparse() {
    GltfMaker maker;
    Values values(2);
    OrderedJson primitives = OrderedJson::array();
    for (const bool has_base : {false, true}) {
        const auto accessor = [&](const auto& index, const auto& example, const char* type,
                                  bool normalized) {
            using I = std::decay_t<decltype(index)>;
            using T = std::decay_t<decltype(example)>;
            const std::size_t width = std::size_t(type[3] - '0');
            std::vector<I> indices;
            for (std::size_t v = values.below(3); v < vertices; v += 1 + values.below(4))
                indices.push_back(I(v));
            const std::size_t n = indices.size();
            OrderedJson json{{"componentType", gltf_component_type<T>()},
                             {"count", vertices},
                             {"type", type},
                             {"normalized", normalized}};
            if (has_base) json["bufferView"] = maker.view(values.of<T>(width * vertices));
            json["sparse"] = {{"count", n},
                              {"indices",
                               {{"bufferView", maker.view(indices)},
                                {"componentType", gltf_component_type<I>()}}},
                              {"values", {{"bufferView", maker.view(values.of<T>(width * n))}}}};
            return maker.accessor(json);
        };
        OrderedJson attributes{
            {"POSITION", accessor(std::uint8_t(), float(), "VEC3", false)},
            {"TEXCOORD_0", accessor(std::uint16_t(), std::uint16_t(), "VEC2", true)},
            {"TANGENT", accessor(std::uint32_t(), std::int8_t(), "VEC4", true)},
            {"COLOR_0", accessor(std::uint8_t(), std::uint8_t(), "VEC4", true)}};
        OrderedJson target{{"POSITION", accessor(std::uint16_t(), float(), "VEC3", false)}};
        primitives.push_back({{"attributes", attributes}, {"targets", {target}}});
    }
    maker.mesh(primitives);
    return maker;
}

GltfMaker modes() {
    GltfMaker maker;
    Values values(3);
    for (int mode = 0; mode <= 6; ++mode) {
        std::vector<std::uint8_t> bytes;
        std::vector<std::uint16_t> shorts;
        std::vector<std::uint32_t> words;
        for (std::size_t i = 0; i < 12; ++i) {
            bytes.push_back(std::uint8_t(values.below(vertices)));
            shorts.push_back(std::uint16_t(values.below(vertices)));
            words.push_back(std::uint32_t(values.below(vertices)));
        }
        OrderedJson primitives = OrderedJson::array();
        for (int kind = 0; kind < 4; ++kind) {
            OrderedJson primitive{{"attributes", with_positions(maker, values)}, {"mode", mode}};
            if (kind == 1) primitive["indices"] = maker.accessor(bytes, "SCALAR");
            if (kind == 2) primitive["indices"] = maker.accessor(shorts, "SCALAR");
            if (kind == 3) primitive["indices"] = maker.accessor(words, "SCALAR");
            primitive["attributes"]["COLOR_0"] =
                maker.accessor(values.of<float>(3 * vertices), "VEC3");
            primitives.push_back(primitive);
        }
        maker.mesh(primitives);
    }
    return maker;
}

// Every mode and every filter; the filters' input is made as their encoders make it.
GltfMaker meshopt() {
    GltfMaker maker;
    Values values(4);
    const auto attribute = [&](const char* filter, const auto& list, int component,
                               const char* type) {
        const std::size_t width = std::size_t(type[3] - '0');
        const std::size_t stride = width * sizeof(list[0]);
        const std::size_t view = maker.meshopt_view("ATTRIBUTES", filter, list.size() / width,
                                                    stride, std::as_bytes(std::span(list)));
        return maker.accessor({{"bufferView", view},
                               {"componentType", component},
                               {"count", list.size() / width},
                               {"type", type},
                               {"normalized", component != 5126}});
    };
    std::vector<std::int8_t> tangents = values.of<std::int8_t>(4 * vertices);
    std::vector<std::int16_t> more = values.of<std::int16_t>(4 * vertices);
    std::vector<std::int16_t> quaternions = values.of<std::int16_t>(4 * vertices);
    for (std::size_t v = 0; v < vertices; ++v) {
        tangents[4 * v + 2] = 127, tangents[4 * v + 3] = v % 2 ? 127 : -127;
        more[4 * v + 2] = 4095;
        for (std::size_t k = 0; k < 3; ++k) {
            if (k < 2) more[4 * v + k] = std::int16_t(more[4 * v + k] % 4095);
            if (k < 2 && tangents[4 * v + k] == -128) tangents[4 * v + k] = -127;
            quaternions[4 * v + k] = std::int16_t(quaternions[4 * v + k] % 1024);
        }
        quaternions[4 * v + 3] = std::int16_t(2044 | v % 4);
    }
    std::vector<std::uint32_t> exponential = values.of<std::uint32_t>(3 * vertices);
    for (std::uint32_t& e : exponential) e = (e & 0xffffff) | std::uint32_t(values.below(40)) << 24;
    OrderedJson attributes{
        {"POSITION", attribute("EXPONENTIAL", exponential, 5126, "VEC3")},
        {"TANGENT", attribute("OCTAHEDRAL", tangents, 5120, "VEC4")},
        {"_MORE", attribute("OCTAHEDRAL", more, 5122, "VEC4")},
        {"_TURN", attribute("QUATERNION", quaternions, 5122, "VEC4")},
        {"TEXCOORD_0", attribute("NONE", values.of<std::uint16_t>(2 * vertices), 5123, "VEC2")}};
    attributes["NORMAL"] = attribute("", values.of<float>(3 * vertices), 5126, "VEC3");
    OrderedJson primitives = OrderedJson::array();
    for (const char* mode : {"TRIANGLES", "INDICES"})
        for (const bool wide : {false, true}) {
            std::vector<std::uint16_t> shorts(30);
            std::vector<std::uint32_t> words(30);
            for (std::size_t i = 0; i < 30; ++i)
                words[i] = shorts[i] = std::uint16_t(values.below(vertices));
            const auto bytes =
                wide ? std::as_bytes(std::span(words)) : std::as_bytes(std::span(shorts));
            const std::size_t view = maker.meshopt_view(mode, "", 30, wide ? 4 : 2, bytes);
            const std::size_t indices = maker.accessor({{"bufferView", view},
                                                        {"componentType", wide ? 5125 : 5123},
                                                        {"count", 30},
                                                        {"type", "SCALAR"}});
            primitives.push_back({{"attributes", attributes}, {"indices", indices}});
        }
    maker.mesh(primitives);
    maker.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    maker.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    return maker;
}

// A grid of squares; UVs have a seam, so that decoded vertices share positions.
GltfMaker draco() {
    GltfMaker maker;
    Values values(5);
    constexpr int n = 5;
    GltfMaker::DracoAttribute positions{"POSITION", 5126, 3, false, {}},
        uvs{"TEXCOORD_0", 5123, 2, true, {}}, normals{"NORMAL", 5126, 3, false, {}},
        colors{"COLOR_0", 5121, 4, true, {}}, joints{"JOINTS_0", 5123, 4, false, {}},
        weights{"WEIGHTS_0", 5126, 4, false, {}}, custom{"_CUSTOM", 5122, 1, false, {}};
    const std::vector<float> heights = values.of<float>((n + 1) * (n + 1));
    const auto corner = [&](int x, int y, int quad) {
        const std::size_t v = std::size_t((n + 1) * y + x);
        positions.corners.insert(positions.corners.end(), {double(x), double(y), heights[v]});
        uvs.corners.insert(uvs.corners.end(),
                           {double(x * 9000 + quad % n * 100), double(y * 12000)});
        normals.corners.insert(normals.corners.end(), {heights[v], 0.5, double(x) / 8});
        colors.corners.insert(colors.corners.end(), {double(x * 50), double(y * 50), 7, 255});
        joints.corners.insert(joints.corners.end(), {double(v), 40000, 1, 2});
        weights.corners.insert(weights.corners.end(), {0.5, 0.25, 0.125, 0.125});
        custom.corners.push_back(double(x * 1000) - 3000);
    };
    for (int q = 0; q < n * n; ++q) {
        const int x = q % n, y = q / n;
        corner(x, y, q), corner(x + 1, y, q), corner(x + 1, y + 1, q);
        corner(x, y, q), corner(x + 1, y + 1, q), corner(x, y + 1, q);
    }
    maker.mesh({maker.draco_primitive({positions, uvs, normals, colors, joints, weights, custom})});
    return maker;
}

// Materials, textures, lights, cameras, nodes, skins and animations.
GltfMaker everything_else() {
    GltfMaker maker;
    Values values(6);
    OrderedJson attributes = with_positions(maker, values);
    attributes["JOINTS_0"] = maker.accessor(std::vector<std::uint8_t>(4 * vertices, 1), "VEC4");
    attributes["WEIGHTS_0"] = maker.accessor(values.of<std::uint8_t>(4 * vertices), "VEC4", true);
    OrderedJson variant{{"material", 2}, {"variants", {0}}};
    OrderedJson primitive{{"attributes", attributes}, {"material", 1}};
    primitive["extensions"]["KHR_materials_variants"]["mappings"] = OrderedJson::array({variant});
    maker.mesh({primitive, {{"attributes", with_positions(maker, values)}}});
    maker.json["samplers"] = OrderedJson::parse(R"([
        {"wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9984},
        {"wrapS": 33648, "wrapT": 10497, "magFilter": 9729, "minFilter": 9985}, {}])");
    for (int i = 0; i < 3; ++i) {
        const auto bytes = values.of<std::uint8_t>(std::size_t(20 + i));
        maker.push("images", {{"bufferView", maker.view(bytes)}, {"mimeType", "image/png"}});
        maker.push("textures", {{"source", 2 - i}, {"sampler", i}});
    }
    maker.push("textures", {{"source", 1}});
    maker.json["materials"] = OrderedJson::parse(R"([
        {"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.6,
             "roughnessFactor": 0.7, "baseColorTexture": {"index": 1},
             "metallicRoughnessTexture": {"index": 2, "texCoord": 1}},
         "normalTexture": {"index": 3, "texCoord": 2, "scale": 0.25, "extensions": {
             "KHR_texture_transform": {"offset": [0.25, -0.5], "rotation": 0.7, "scale": [3, -4],
                                       "texCoord": 5}}},
         "occlusionTexture": {"index": 0, "texCoord": 3, "strength": 0.75, "extensions": {
             "KHR_texture_transform": {"rotation": -2}}},
         "emissiveTexture": {"index": 1, "texCoord": 4}, "emissiveFactor": [0.5, 0.6, 0.8],
         "alphaMode": "MASK", "alphaCutoff": 0.3125, "doubleSided": true,
         "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3}}},
        {"alphaMode": "BLEND", "extensions": {"KHR_materials_pbrSpecularGlossiness": {
             "diffuseFactor": [0.9, 0.8, 0.7, 0.6], "specularFactor": [0.1, 0.3, 0.5],
             "glossinessFactor": 0.625, "diffuseTexture": {"index": 2},
             "specularGlossinessTexture": {"index": 3, "texCoord": 1}}}},
        {"extensions": {"KHR_materials_unlit": {}}}])");
    maker.json["extensions"] = OrderedJson::parse(R"({
        "KHR_materials_variants": {"variants": [{"name": "other"}]},
        "KHR_lights_punctual": {"lights": [
            {"type": "spot", "color": [0.1, 0.2, 0.3], "intensity": 40, "range": 50,
             "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.75}},
            {"type": "directional", "color": [0.5, 0, 1], "intensity": 0.5},
            {"type": "point", "range": 7}, {"type": "spot", "spot": {}}]}})");
    maker.json["cameras"] = OrderedJson::parse(R"([
        {"type": "perspective",
         "perspective": {"yfov": 0.7, "aspectRatio": 1.5, "znear": 0.25, "zfar": 90}},
        {"type": "perspective", "perspective": {"yfov": 1.1, "znear": 2}},
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 4, "znear": 0, "zfar": 5}}])");
    maker.json["nodes"][0].update(OrderedJson::parse(R"({"skin": 0, "scale": [2, 3, 4],
        "rotation": [0.5, -0.5, 0.5, 0.5], "translation": [7, 8, 9], "children": [1, 2]})"));
    maker.push("nodes", OrderedJson::parse(R"({"camera": 0, "children": [3],
        "matrix": [1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 10, 0, 11, 12, 13, 1],
        "extensions": {"KHR_lights_punctual": {"light": 2}}})"));
    maker.push("nodes", OrderedJson::parse(R"({"camera": 2, "rotation": [0.6, 0, 0, 0.8]})"));
    maker.push("nodes", OrderedJson::parse(R"({"translation": [1, 2, 3],
        "extensions": {"KHR_lights_punctual": {"light": 0}}})"));
    maker.root(OrderedJson::parse(R"({"rotation": [0, 0.28, 0, 0.96], "camera": 1})"));
    maker.push("nodes", {{"mesh", 0}});  // in no scene
    maker.push("skins", {{"joints", {3, 1, 2}},
                         {"inverseBindMatrices", maker.accessor(values.of<float>(48), "MAT4")}});
    const std::size_t times = maker.accessor(std::vector<float>{0, 0.5f, 2}, "SCALAR");
    const std::size_t turns = maker.accessor(values.of<std::int16_t>(12), "VEC4", true);
    const std::size_t moves = maker.accessor(values.of<float>(27), "VEC3");
    maker.push("animations",
               {{"samplers",
                 {{{"input", times}, {"output", turns}, {"interpolation", "STEP"}},
                  {{"input", times}, {"output", moves}, {"interpolation", "CUBICSPLINE"}}}},
                {"channels",
                 {{{"sampler", 0}, {"target", {{"node", 3}, {"path", "rotation"}}}},
                  {{"sampler", 1}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
    maker.json["extensionsUsed"] = {"KHR_materials_variants",
                                    "KHR_lights_punctual",
                                    "KHR_texture_transform",
                                    "KHR_materials_emissive_strength",
                                    "KHR_materials_pbrSpecularGlossiness",
                                    "KHR_materials_unlit"};
    return maker;
}

}  // namespace

std::vector<GltfCase> gltf_cases() {
    return {{"component_types", component_types()},
            {"sparse", sparse()},
            {"modes", modes()},
            {"meshopt", meshopt()},
            {"draco", draco()},
            {"everything_else", everything_else()}};
}

}  // namespace test
