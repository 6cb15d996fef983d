#include "gltf_maker.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <cstring>

namespace test {
namespace {

std::size_t width_of(const std::string& type) {
    if (type == "SCALAR") return 1;
    if (type == "VEC2") return 2;
    if (type == "VEC3") return 3;
    if (type == "MAT3") return 9;
    return type == "MAT4" ? 16 : 4;
}

draco::DataType draco_type(int component_type) {
    switch (component_type) {
        case 5120:
            return draco::DT_INT8;
        case 5121:
            return draco::DT_UINT8;
        case 5122:
            return draco::DT_INT16;
        case 5123:
            return draco::DT_UINT16;
        case 5125:
            return draco::DT_UINT32;
        default:
            return draco::DT_FLOAT32;
    }
}

draco::GeometryAttribute::Type draco_semantic(const std::string& semantic) {
    if (semantic == "POSITION") return draco::GeometryAttribute::POSITION;
    if (semantic == "NORMAL") return draco::GeometryAttribute::NORMAL;
    if (semantic.starts_with("TEXCOORD")) return draco::GeometryAttribute::TEX_COORD;
    if (semantic.starts_with("COLOR")) return draco::GeometryAttribute::COLOR;
    return draco::GeometryAttribute::GENERIC;
}

template <class T>
std::vector<std::byte> as_bytes_of(const std::vector<double>& values) {
    const std::vector<T> typed(values.begin(), values.end());
    const auto bytes = std::as_bytes(std::span(typed));
    return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> as_bytes_of(const std::vector<double>& values, int component_type) {
    switch (component_type) {
        case 5120:
            return as_bytes_of<std::int8_t>(values);
        case 5121:
            return as_bytes_of<std::uint8_t>(values);
        case 5122:
            return as_bytes_of<std::int16_t>(values);
        case 5123:
            return as_bytes_of<std::uint16_t>(values);
        case 5125:
            return as_bytes_of<std::uint32_t>(values);
        default:
            return as_bytes_of<float>(values);
    }
}

void append(std::string& to, std::uint32_t value) {
    char bytes[4];
    std::memcpy(bytes, &value, 4);
    to.append(bytes, 4);
}

}  // namespace

std::size_t GltfMaker::push(const std::string& list, Json value) {
    json[list].push_back(std::move(value));
    return json[list].size() - 1;
}

std::size_t GltfMaker::view(std::span<const std::byte> bytes, std::size_t stride) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    Json view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
    if (stride > 0) view["byteStride"] = stride;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return push("bufferViews", std::move(view));
}

std::size_t GltfMaker::meshopt_view(const std::string& mode, const std::string& filter,
                                    std::size_t count, std::size_t stride,
                                    std::span<const std::byte> bytes) {
    std::vector<unsigned char> out;
    if (mode == "ATTRIBUTES") {
        out.resize(meshopt_encodeVertexBufferBound(count, stride));
        out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), bytes.data(), count, stride));
    } else {
        std::vector<unsigned> indices(count);
        for (std::size_t i = 0; i < count; ++i)
            std::memcpy(&indices[i], &bytes[i * stride], stride);
        const std::size_t vertices = 1 << 20;
        if (mode == "TRIANGLES") {
            out.resize(meshopt_encodeIndexBufferBound(count, vertices));
            out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), count));
        } else {
            out.resize(meshopt_encodeIndexSequenceBound(count, vertices));
            out.resize(meshopt_encodeIndexSequence(out.data(), out.size(), indices.data(), count));
        }
    }
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    Json compressed{{"buffer", 0},
                    {"byteOffset", bytes_.size()},
                    {"byteLength", out.size()},
                    {"byteStride", stride},
                    {"count", count},
                    {"mode", mode}};
    if (!filter.empty()) compressed["filter"] = filter;
    const auto* first = reinterpret_cast<const std::byte*>(out.data());
    bytes_.insert(bytes_.end(), first, first + out.size());
    Json view{{"buffer", 1},
              {"byteOffset", decompressed_},
              {"byteLength", bytes.size()},
              {"extensions", {{"EXT_meshopt_compression", std::move(compressed)}}}};
    if (mode == "ATTRIBUTES") view["byteStride"] = stride;
    decompressed_ += (bytes.size() + 3) / 4 * 4;
    return push("bufferViews", std::move(view));
}

GltfMaker::Json GltfMaker::draco_primitive(const std::vector<DracoAttribute>& attributes) {
    static const char* const types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    const std::size_t corners = attributes[0].corners.size() / std::size_t(attributes[0].width);
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(int(corners / 3));
    std::vector<int> ids;
    for (const DracoAttribute& a : attributes) {
        ids.push_back(builder.AddAttribute(draco_semantic(a.semantic), std::int8_t(a.width),
                                           draco_type(a.component_type)));
        const std::vector<std::byte> bytes = as_bytes_of(a.corners, a.component_type);
        const std::size_t size = bytes.size() / corners;
        for (std::size_t f = 0; f < corners / 3; ++f)
            builder.SetAttributeValuesForFace(ids.back(), draco::FaceIndex(std::uint32_t(f)),
                                              &bytes[3 * f * size], &bytes[(3 * f + 1) * size],
                                              &bytes[(3 * f + 2) * size]);
    }
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    draco::EncoderBuffer buffer;
    if (!mesh || !encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) return {};
    const std::size_t data = view(std::as_bytes(std::span(buffer.data(), buffer.size())));

    Json compressed{{"bufferView", data}}, primitive;
    for (std::size_t a = 0; a < attributes.size(); ++a) {
        const DracoAttribute& in = attributes[a];
        Json accessor{{"componentType", in.component_type},
                      {"count", mesh->num_points()},
                      {"type", types[in.width]}};
        if (in.normalized) accessor["normalized"] = true;
        primitive["attributes"][in.semantic] = push("accessors", std::move(accessor));
        compressed["attributes"][in.semantic] = mesh->attribute(ids[a])->unique_id();
    }
    primitive["indices"] =
        push("accessors", {{"componentType", 5125}, {"count", corners}, {"type", "SCALAR"}});
    primitive["extensions"]["KHR_draco_mesh_compression"] = std::move(compressed);
    if (!json.contains("extensionsRequired")) {
        json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
        json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    }
    return primitive;
}

std::size_t GltfMaker::typed_accessor(std::span<const std::byte> bytes, std::size_t component,
                                      int code, const std::string& type, bool normalized) {
    const std::size_t size = component * width_of(type), count = bytes.size() / size;
    std::size_t in_view = 0;
    if (type.starts_with("VEC") && size % 4 != 0) {
        const std::size_t stride = (size + 3) / 4 * 4;
        std::vector<std::byte> padded(count * stride, std::byte(0xa5));
        for (std::size_t i = 0; i < count; ++i)
            std::memcpy(&padded[i * stride], &bytes[i * size], size);
        in_view = view(padded, stride);
    } else {
        in_view = view(bytes);
    }
    Json accessor{
        {"bufferView", in_view}, {"componentType", code}, {"count", count}, {"type", type}};
    if (normalized) accessor["normalized"] = true;
    return push("accessors", std::move(accessor));
}

std::size_t GltfMaker::root(Json node) {
    const std::size_t index = push("nodes", std::move(node));
    if (!json.contains("scenes")) {
        json["scene"] = 0;
        json["scenes"] = Json::array({{{"nodes", Json::array()}}});
    }
    json["scenes"][0]["nodes"].push_back(index);
    return index;
}

std::size_t GltfMaker::mesh(Json primitives) {
    // One primitive in braces is a list for one compiler and the primitive for another.
    if (primitives.is_object()) {
        Json list = Json::array();
        list.push_back(std::move(primitives));
        primitives = std::move(list);
    }
    const std::size_t index = push("meshes", {{"primitives", std::move(primitives)}});
    root({{"mesh", index}});
    return index;
}

GltfMaker::Json GltfMaker::with_buffers() const {
    Json out = json;
    if (!bytes_.empty() && !out.contains("buffers")) {
        out["buffers"].push_back({{"byteLength", bytes_.size()}});
        if (decompressed_ > 0) {
            Json fallback{{"fallback", true}};
            out["buffers"].push_back(
                {{"byteLength", decompressed_},
                 {"extensions", {{"EXT_meshopt_compression", std::move(fallback)}}}});
            out["extensionsUsed"].push_back("EXT_meshopt_compression");
            out["extensionsRequired"].push_back("EXT_meshopt_compression");
        }
    }
    return out;
}

std::string GltfMaker::glb() const {
    std::string text = with_buffers().dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::size_t padded = (bytes_.size() + 3) / 4 * 4;
    std::string out = "glTF";
    append(out, 2);
    append(out, std::uint32_t(20 + text.size() + (padded > 0 ? 8 + padded : 0)));
    append(out, std::uint32_t(text.size()));
    out += "JSON" + text;
    if (padded == 0) return out;
    append(out, std::uint32_t(padded));
    out.append("BIN\0", 4);
    out.append(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
    out.append(padded - bytes_.size(), '\0');
    return out;
}

std::string GltfMaker::gltf() const {
    Json out = with_buffers();
    if (!bytes_.empty())
        out["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(bytes_);
    return out.dump();
}

prep::Result<prep::Scene> GltfMaker::read() const {
    const std::string bytes = glb();
    return prep::parse_gltf(std::as_bytes(std::span(bytes)));
}

std::string GltfMaker::base64(std::span<const std::byte> bytes) {
    static const char* const digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? std::uint32_t(bytes[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k)
            out += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

}  // namespace test
