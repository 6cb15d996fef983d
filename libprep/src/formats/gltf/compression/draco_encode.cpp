#include "formats/gltf/compression/draco_encode.h"

#include <draco/attributes/attribute_octahedron_transform.h>
#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string_view>
#include <unordered_map>

namespace prep::detail {
namespace {

using Attribute = draco::GeometryAttribute;

// Of the encoder, 0 (smallest) to 10. Files grow by 2 % from 1 to 3 and take half the time; by 8 %
// from 3 to 5.
constexpr int speed = 1;
// In the file's head, behind "DRACO" and the version: what it holds, then how.
constexpr std::size_t method_at = 8;

draco::DataType data_type(int component_type) {
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

// Draco predicts the values of each kind in a way of its own; that of normals, beside positions
// that are whole numbers, is one of octahedral coordinates, which whole numbers are not.
Attribute::Type kind_of(const std::string& semantic, const RawAccessor& raw) {
    if (semantic == "POSITION") return Attribute::POSITION;
    if (semantic == "NORMAL" && raw.component_type == 5126) return Attribute::NORMAL;
    if (semantic.starts_with("TEXCOORD_")) return Attribute::TEX_COORD;
    if (semantic.starts_with("COLOR_")) return Attribute::COLOR;
    return Attribute::GENERIC;
}

std::unique_ptr<draco::Mesh> decoded(const std::byte* bytes, std::size_t size, bool as_stored) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes), size);
    draco::Decoder decoder;
    if (as_stored)
        for (const Attribute::Type type : {Attribute::POSITION, Attribute::NORMAL, Attribute::COLOR,
                                           Attribute::TEX_COORD, Attribute::GENERIC})
            decoder.SetSkipAttributeTransform(type);
    auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
    return mesh.ok() ? std::move(mesh).value() : nullptr;
}

DracoValues values_of(const draco::PointAttribute& attribute) {
    DracoValues out;
    const draco::AttributeTransformData* const data = attribute.GetAttributeTransformData();
    if (!data) return out;
    if (draco::AttributeQuantizationTransform grid;
        data->transform_type() == draco::ATTRIBUTE_QUANTIZATION_TRANSFORM &&
        grid.InitFromAttribute(attribute)) {
        out.form = DracoValues::Form::grid;
        out.bits = grid.quantization_bits();
        out.origin = grid.min_values();
        out.range = grid.range();
    } else if (draco::AttributeOctahedronTransform octahedron;
               data->transform_type() == draco::ATTRIBUTE_OCTAHEDRON_TRANSFORM &&
               octahedron.InitFromAttribute(attribute)) {
        out.form = DracoValues::Form::octahedral;
        out.bits = octahedron.quantization_bits();
    }
    return out;
}

// Whether all values lie in the grid, but for what rounding them to it may add. A grid that a file
// states may be none at all.
bool within(const RawAccessor& raw, const DracoValues& grid) {
    if (!(grid.range > 0) || !std::isfinite(grid.range) || grid.bits < 1 || grid.bits > 30)
        return false;
    const std::vector<float> values = to_floats(raw);
    const std::size_t width = std::size_t(raw.width);
    const double step = double(grid.range) / std::ldexp(1.0, grid.bits);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double from_origin = double(values[i]) - double(grid.origin[i % width]);
        if (!(from_origin >= -step && from_origin <= double(grid.range) + step)) return false;
    }
    return true;
}

// Draco keeps options as text, six decimals of a float: this is all of it, and has no decimal
// point, which other locales write in other ways.
std::string exact_text(float value) {
    int exponent = 0;
    const long mantissa = std::lround(std::ldexp(std::frexp(value, &exponent), 24));
    char text[40];
    std::snprintf(text, sizeof text, "%s0x%lxp%d", mantissa < 0 ? "-" : "", std::labs(mantissa),
                  exponent - 24);
    return text;
}

void set_form(draco::ExpertEncoder& encoder, int id, const RawAccessor& raw,
              const DracoValues& values) {
    if (values.form == DracoValues::Form::exact || raw.component_type != 5126) return;
    draco::Options options;
    options.SetInt("quantization_bits", values.bits);
    if (values.form == DracoValues::Form::grid && values.origin.size() == std::size_t(raw.width) &&
        within(raw, values)) {
        std::string origin;
        for (const float v : values.origin) origin += exact_text(v) + " ";
        options.SetString("quantization_origin", origin);
        options.SetString("quantization_range", exact_text(values.range));
    }
    encoder.options().SetAttributeOptions(id, options);
}

// Edgebreaker leaves out triangles with two corners at one value of POSITION.
bool names_a_vertex_twice(const DracoSource& source) {
    const std::vector<std::uint32_t>& v = source.indices;
    for (std::size_t t = 0; t + 2 < v.size(); t += 3)
        if (v[t] == v[t + 1] || v[t + 1] == v[t + 2] || v[t + 2] == v[t]) return true;
    return false;
}

// For each vertex the number of its value: equal ones have one, but for the corners of triangles
// with two of them in one place, which stay triangles so.
std::vector<std::uint32_t> places_of(const DracoSource& source, const RawAccessor& raw) {
    const std::size_t size = raw.element_size();
    const auto bytes = [&](std::uint32_t v) {
        return std::string_view(reinterpret_cast<const char*>(raw.bytes.data()) + v * size, size);
    };
    std::vector<bool> alone(raw.count, false);
    const std::vector<std::uint32_t>& v = source.indices;
    for (std::size_t t = 0; t + 2 < v.size(); t += 3)
        if (bytes(v[t]) == bytes(v[t + 1]) || bytes(v[t + 1]) == bytes(v[t + 2]) ||
            bytes(v[t + 2]) == bytes(v[t]))
            for (std::size_t k = 0; k < 3; ++k) alone[v[t + k]] = true;
    std::unordered_map<std::string_view, std::uint32_t> known;
    std::vector<std::uint32_t> places(raw.count);
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < raw.count; ++i) {
        if (alone[i]) {
            places[i] = count++;
            continue;
        }
        const auto [at, fresh] = known.emplace(bytes(i), count);
        count += fresh;
        places[i] = at->second;
    }
    return places;
}

// Draco 1.5 takes time by the square of a point's triangles before Edgebreaker.
bool has_vast_pole(const DracoSource& source, const std::vector<std::uint32_t>& places) {
    constexpr std::uint32_t most = 4096;
    std::vector<std::uint32_t> uses(places.size(), 0);
    return std::any_of(source.indices.begin(), source.indices.end(),
                       [&](std::uint32_t v) { return ++uses[places[v]] > most; });
}

// Edgebreaker follows edges between values of POSITION: those of a seam are one.
bool share_values(draco::Mesh& mesh, const DracoSource& source, const std::vector<int>& ids,
                  const std::vector<std::uint32_t>& places) {
    for (std::size_t a = 0; a < ids.size(); ++a) {
        draco::PointAttribute& to = *mesh.attribute(ids[a]);
        const auto& [semantic, raw] = source.attributes[a];
        if (semantic != "POSITION") {
            if (to.DeduplicateValues(to) == draco::AttributeValueIndex::ValueType(-1)) return false;
            continue;
        }
        const std::size_t size = raw.element_size();
        to.SetExplicitMapping(raw.count);
        // Values move down alone: each has a number that is not above its vertex'.
        for (std::uint32_t i = 0; i < raw.count; ++i) {
            to.SetAttributeValue(draco::AttributeValueIndex(places[i]),
                                 raw.bytes.data() + i * size);
            to.SetPointMapEntry(draco::PointIndex(i), draco::AttributeValueIndex(places[i]));
        }
        to.Resize(*std::max_element(places.begin(), places.end()) + 1);
    }
    return true;
}

// `numbers`: places_of() the positions, where the order is not kept.
std::optional<DracoData> encode(const DracoSource& source, const DracoCoding& coding,
                                bool keeps_order, const std::vector<std::uint32_t>& numbers) {
    draco::Mesh mesh;
    const std::size_t points = source.attributes.front().second.count;
    mesh.set_num_points(std::uint32_t(points));
    mesh.SetNumFaces(source.indices.size() / 3);
    for (std::size_t t = 0; t + 2 < source.indices.size(); t += 3)
        mesh.SetFace(
            draco::FaceIndex(std::uint32_t(t / 3)),
            {draco::PointIndex(source.indices[t]), draco::PointIndex(source.indices[t + 1]),
             draco::PointIndex(source.indices[t + 2])});
    DracoData out;
    std::vector<int> ids;
    for (const auto& [semantic, raw] : source.attributes) {
        const std::size_t size = raw.element_size();
        // Whether integers are normalised the accessor says; here they are what is stored.
        Attribute attribute;
        attribute.Init(kind_of(semantic, raw), nullptr, std::uint8_t(raw.width),
                       data_type(raw.component_type), false, std::int64_t(size), 0);
        ids.push_back(mesh.AddAttribute(attribute, true, std::uint32_t(points)));
        draco::PointAttribute& to = *mesh.attribute(ids.back());
        for (std::size_t i = 0; i < points; ++i)
            to.SetAttributeValue(draco::AttributeValueIndex(std::uint32_t(i)),
                                 raw.bytes.data() + i * size);
        out.ids[semantic] = to.unique_id();
    }
    if (!keeps_order && !share_values(mesh, source, ids, numbers)) return std::nullopt;

    draco::ExpertEncoder encoder(mesh);
    encoder.SetSpeedOptions(speed, speed);
    encoder.SetEncodingMethod(keeps_order ? draco::MESH_SEQUENTIAL_ENCODING
                                          : draco::MESH_EDGEBREAKER_ENCODING);
    for (std::size_t a = 0; a < ids.size(); ++a) {
        const auto& [semantic, raw] = source.attributes[a];
        if (const auto form = coding.values.find(semantic); form != coding.values.end())
            set_form(encoder, ids[a], raw, form->second);
    }
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeToBuffer(&buffer).ok()) return std::nullopt;
    const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
    out.bytes.assign(bytes.begin(), bytes.end());

    const std::unique_ptr<draco::Mesh> again = decoded(out.bytes.data(), out.bytes.size(), false);
    if (!again) return std::nullopt;
    out.vertices = again->num_points();
    out.triangles = again->num_faces();
    const draco::PointAttribute* const places = again->GetNamedAttribute(Attribute::POSITION);
    if (out.vertices == 0 || !places || places->num_components() > 4) return std::nullopt;
    out.least.assign(places->num_components(), INFINITY);
    out.most.assign(places->num_components(), -INFINITY);
    for (draco::PointIndex p(0); p < again->num_points(); ++p) {
        float value[4];
        if (!places->ConvertValue<float>(places->mapped_index(p), places->num_components(), value))
            return std::nullopt;
        for (std::size_t k = 0; k < out.least.size(); ++k) {
            out.least[k] = std::min(out.least[k], value[k]);
            out.most[k] = std::max(out.most[k], value[k]);
        }
    }
    for (std::size_t k = 0; k < out.least.size(); ++k)
        if (!std::isfinite(out.least[k]) || !std::isfinite(out.most[k])) return std::nullopt;
    return out;
}

}  // namespace

Result<DracoCoding> draco_coding(const GltfDocument& document, const Json& primitive,
                                 const std::string& pointer) {
    const Json& extension = primitive["extensions"]["KHR_draco_mesh_compression"];
    const auto bytes = document.view(extension["bufferView"].get<std::size_t>());
    if (!bytes) return bytes.error();
    try {
        const std::unique_ptr<draco::Mesh> mesh = decoded(bytes->data(), bytes->size(), true);
        if (!mesh || bytes->size() <= method_at)
            return document.bad(pointer, "Draco: the data cannot be decoded");
        DracoCoding out;
        out.keeps_order =
            std::to_integer<int>((*bytes)[method_at]) == draco::MESH_SEQUENTIAL_ENCODING;
        for (const auto& item : extension["attributes"].items())
            if (const draco::PointAttribute* const attribute =
                    mesh->GetAttributeByUniqueId(item.value().get<std::uint32_t>()))
                out.values[item.key()] = values_of(*attribute);
        return out;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        return document.bad(pointer, std::string("Draco: ") + e.what());
    }
}

std::optional<DracoData> encode_draco(const DracoSource& source, const DracoCoding& coding) {
    if (source.attributes.empty() || source.indices.size() < 3) return std::nullopt;
    try {
        bool keeps_order = coding.keeps_order || names_a_vertex_twice(source);
        std::vector<std::uint32_t> places;
        for (const auto& [semantic, raw] : source.attributes)
            if (semantic == "POSITION" && !keeps_order) places = places_of(source, raw);
        keeps_order |= !places.empty() && has_vast_pole(source, places);
        auto data = encode(source, coding, keeps_order, places);
        // What Edgebreaker cannot follow it leaves out.
        if (!keeps_order && (!data || data->triangles != source.indices.size() / 3)) {
            keeps_order = true;
            data = encode(source, coding, keeps_order, places);
        }
        if (data) data->keeps_order = keeps_order;
        return data;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

}  // namespace prep::detail
