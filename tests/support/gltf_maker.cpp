#include "gltf_maker.h"

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
