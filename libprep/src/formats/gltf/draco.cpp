#include <draco/compression/decode.h>

#include <cstring>
#include <exception>

#include "formats/gltf/document.h"

namespace prep::detail {
namespace {

template <class T>
bool fill(const draco::Mesh& mesh, const draco::PointAttribute& attribute, int width,
          SharedBytes& to) {
    std::vector<T> value(std::size_t(width) + 1);
    std::vector<std::byte> out(std::size_t(mesh.num_points()) * std::size_t(width) * sizeof(T));
    for (draco::PointIndex p(0); p < mesh.num_points(); ++p) {
        if (!attribute.ConvertValue<T>(attribute.mapped_index(p), int8_t(width), value.data()))
            return false;
        std::memcpy(out.data() + std::size_t(p.value()) * std::size_t(width) * sizeof(T),
                    value.data(), std::size_t(width) * sizeof(T));
    }
    to = std::move(out);
    return true;
}

bool fill(const draco::Mesh& mesh, const draco::PointAttribute& attribute, RawAccessor& raw) {
    // glTF has none, and Draco reads their bytes, which may be any, as truth values.
    if (attribute.data_type() == draco::DT_BOOL) return false;
    switch (raw.component_type) {
        case 5120:
            return fill<std::int8_t>(mesh, attribute, raw.width, raw.bytes);
        case 5121:
            return fill<std::uint8_t>(mesh, attribute, raw.width, raw.bytes);
        case 5122:
            return fill<std::int16_t>(mesh, attribute, raw.width, raw.bytes);
        case 5123:
            return fill<std::uint16_t>(mesh, attribute, raw.width, raw.bytes);
        case 5125:
            return fill<std::uint32_t>(mesh, attribute, raw.width, raw.bytes);
        default:
            return fill<float>(mesh, attribute, raw.width, raw.bytes);
    }
}

Result<std::vector<std::uint32_t>> decode(const GltfDocument& d, const Json& primitive,
                                          const std::string& primitive_pointer,
                                          std::map<std::string, RawAccessor>& out) {
    const Json& extension = primitive["extensions"]["KHR_draco_mesh_compression"];
    const std::string pointer = primitive_pointer + "/extensions/KHR_draco_mesh_compression";
    if (!extension.is_object()) return d.bad(pointer, "expected an object");
    const std::size_t views = d.json.contains("bufferViews") ? d.json["bufferViews"].size() : 0;
    const auto view = index_member(d, extension, "bufferView", pointer, views);
    if (!view) return view.error();
    if (*view == no_index) return d.bad(pointer + "/bufferView", "the member is missing");
    const auto bytes = d.view(*view);
    if (!bytes) return bytes.error();

    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) return d.bad(pointer, std::string("Draco: ") + decoded.status().error_msg());
    const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();

    if (!extension.contains("attributes") || !extension["attributes"].is_object())
        return d.bad(pointer + "/attributes", "expected an object");
    const std::size_t accessors = d.json.contains("accessors") ? d.json["accessors"].size() : 0;
    for (const auto& item : extension["attributes"].items()) {
        const std::string place = pointer + "/attributes/" + item.key();
        if (!item.value().is_number_unsigned()) return d.bad(place, "expected an attribute's id");
        const draco::PointAttribute* attribute =
            mesh->GetAttributeByUniqueId(item.value().get<std::uint32_t>());
        if (!attribute) return d.bad(place, "the compressed mesh has no such attribute");
        if (!primitive["attributes"].contains(item.key())) continue;
        const auto index = index_member(d, primitive["attributes"], item.key().c_str(),
                                        primitive_pointer + "/attributes", accessors);
        if (!index) return index.error();
        const Json& accessor = d.json["accessors"][*index];
        RawAccessor raw;
        raw.component_type = accessor.value("componentType", 5126);
        raw.width = components_of(accessor.value("type", std::string()));
        raw.normalized = accessor.value("normalized", false);
        raw.count = mesh->num_points();
        if (component_size(raw.component_type) == 0 || raw.width == 0 || raw.width > 4)
            return d.bad("/accessors/" + std::to_string(*index), "no type that Draco can fill");
        if (!fill(*mesh, *attribute, raw)) return d.bad(place, "its values cannot be converted");
        out.emplace(item.key(), std::move(raw));
    }
    std::vector<std::uint32_t> indices;
    indices.reserve(std::size_t(mesh->num_faces()) * 3);
    for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f)
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t v = mesh->face(f)[std::size_t(k)].value();
            if (v >= mesh->num_points()) return d.bad(pointer, "a decoded index is out of range");
            indices.push_back(v);
        }
    return indices;
}

}  // namespace

Result<std::vector<std::uint32_t>> decode_draco(const GltfDocument& document, const Json& primitive,
                                                const std::string& pointer,
                                                std::map<std::string, RawAccessor>& out) {
    try {
        return decode(document, primitive, pointer, out);
    } catch (const std::exception& e) {
        return document.bad(pointer, std::string("Draco: ") + e.what());
    }
}

}  // namespace prep::detail
