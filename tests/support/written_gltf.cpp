#include "written_gltf.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "mesh_files.h"

namespace test {
namespace {

using Json = GltfFile::Json;

std::size_t bytes_of_type(int component) {
    switch (component) {
        case 5120:
        case 5121:
            return 1;
        case 5122:
        case 5123:
            return 2;
        case 5125:
        case 5126:
            return 4;
        default:
            throw std::runtime_error("no component type: " + std::to_string(component));
    }
}

struct Shape {
    std::size_t columns, rows;
};

Shape shape_of(const std::string& type) {
    if (type == "SCALAR") return {1, 1};
    if (type == "VEC2") return {1, 2};
    if (type == "VEC3") return {1, 3};
    if (type == "VEC4") return {1, 4};
    if (type == "MAT2") return {2, 2};
    if (type == "MAT3") return {3, 3};
    if (type == "MAT4") return {4, 4};
    throw std::runtime_error("no type: " + type);
}

template <class T>
T raw(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof(T));
    return value;
}

// Section 3.6.2.4 and 3.11 of the specification: the decoding of normalised integers.
double number_at(const char* at, int component, bool normalized) {
    switch (component) {
        case 5120:
            return normalized ? std::max(raw<std::int8_t>(at) / 127.0, -1.0) : raw<std::int8_t>(at);
        case 5121:
            return raw<std::uint8_t>(at) / (normalized ? 255.0 : 1.0);
        case 5122:
            return normalized ? std::max(raw<std::int16_t>(at) / 32767.0, -1.0)
                              : raw<std::int16_t>(at);
        case 5123:
            return raw<std::uint16_t>(at) / (normalized ? 65535.0 : 1.0);
        case 5125:
            return raw<std::uint32_t>(at);
        default:
            return double(raw<float>(at));
    }
}

std::string from_base64(const std::string& text) {
    std::string out;
    unsigned bits = 0;
    int have = 0;
    for (const char c : text) {
        unsigned digit = 0;
        if (c >= 'A' && c <= 'Z')
            digit = unsigned(c - 'A');
        else if (c >= 'a' && c <= 'z')
            digit = unsigned(c - 'a') + 26;
        else if (c >= '0' && c <= '9')
            digit = unsigned(c - '0') + 52;
        else if (c == '+')
            digit = 62;
        else if (c == '/')
            digit = 63;
        else
            break;
        bits = bits << 6 | digit;
        have += 6;
        if (have < 8) continue;
        have -= 8;
        out += char(bits >> have & 255);
    }
    return out;
}

std::string decoded_uri(const std::string& uri, const std::filesystem::path& folder) {
    if (uri.starts_with("data:")) return from_base64(uri.substr(uri.find(',') + 1));
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%') {
            name += uri[i];
        } else {
            name += char(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
            i += 2;
        }
    }
    if (!std::filesystem::exists(folder / name)) throw std::runtime_error("no file " + name);
    return file_text(folder / name);
}

[[noreturn]] void broken(const std::string& what) {
    throw std::runtime_error("GLB: " + what);
}

}  // namespace

std::vector<double> GltfValues::at(std::size_t i) const {
    return {values.begin() + std::ptrdiff_t(i * width),
            values.begin() + std::ptrdiff_t((i + 1) * width)};
}

GltfFile::GltfFile(const std::filesystem::path& path) {
    const std::string bytes = file_text(path);
    std::string text = bytes, chunk;
    bool has_chunk = false;
    if (bytes.starts_with("glTF")) {
        if (bytes.size() < 20 || bytes.size() % 4 != 0) broken("size");
        if (raw<std::uint32_t>(&bytes[4]) != 2) broken("version");
        if (raw<std::uint32_t>(&bytes[8]) != bytes.size()) broken("length");
        for (std::size_t at = 12, number = 0; at < bytes.size(); ++number) {
            if (at + 8 > bytes.size()) broken("chunk header");
            const std::size_t length = raw<std::uint32_t>(&bytes[at]);
            const std::string kind = bytes.substr(at + 4, 4);
            if (length % 4 != 0 || at + 8 + length > bytes.size()) broken("chunk length");
            if (number == 0 && kind != "JSON") broken("first chunk");
            if (number == 1 && kind != std::string("BIN\0", 4)) broken("second chunk");
            (number == 0 ? text : chunk) = bytes.substr(at + 8, length);
            has_chunk |= number == 1;
            at += 8 + length;
        }
        if (text.find('\0') != std::string::npos) broken("JSON is padded with blanks");
    }
    json = Json::parse(text);
    if (!json.contains("buffers")) return;
    for (const Json& buffer : json["buffers"]) {
        const std::size_t length = buffer.at("byteLength");
        std::string data;
        if (buffer.contains("uri"))
            data = decoded_uri(buffer["uri"], path.parent_path());
        else if (has_chunk && buffers.empty())
            data = chunk;
        else if (buffer.contains(
                     Json::json_pointer("/extensions/EXT_meshopt_compression/fallback")))
            data.assign(length, '\0');  // nothing is read from it
        else
            throw std::runtime_error("a buffer of no file");
        // The chunk may be up to three bytes longer.
        if (data.size() < length || data.size() > length + 3)
            throw std::runtime_error("a buffer's length is not its file's");
        buffers.push_back(data.substr(0, length));
    }
}

std::string GltfFile::view_bytes(std::size_t view) const {
    const Json& v = json.at("bufferViews").at(view);
    const std::string& buffer = buffers.at(v.at("buffer").get<std::size_t>());
    const std::size_t offset = v.value("byteOffset", std::size_t(0));
    const std::size_t length = v.at("byteLength");
    if (offset + length > buffer.size()) throw std::runtime_error("a view beyond its buffer");
    return buffer.substr(offset, length);
}

GltfValues GltfFile::accessor(std::size_t index) const {
    return decoded(index, json.at("accessors").at(index).value("normalized", false));
}

GltfValues GltfFile::decoded(std::size_t index, bool normalized) const {
    const Json& a = json.at("accessors").at(index);
    GltfValues out;
    out.type = a.at("type");
    out.component_type = a.at("componentType");
    const std::size_t count = a.at("count"), size = bytes_of_type(out.component_type);
    const Shape shape = shape_of(out.type);
    out.width = shape.columns * shape.rows;
    out.values.assign(count * out.width, 0.0);
    // Columns of matrices start at multiples of four bytes.
    const std::size_t column =
        shape.columns == 1 ? shape.rows * size : (shape.rows * size + 3) / 4 * 4;
    const std::size_t element = (shape.columns - 1) * column + shape.rows * size;
    const auto read = [&](const std::string& bytes, std::size_t at, std::size_t element_index) {
        if (at + element > bytes.size()) throw std::runtime_error("an element beyond its view");
        for (std::size_t c = 0; c < shape.columns; ++c)
            for (std::size_t r = 0; r < shape.rows; ++r)
                out.values[element_index * out.width + c * shape.rows + r] =
                    number_at(&bytes[at + c * column + r * size], out.component_type, normalized);
    };
    if (a.contains("bufferView")) {
        const std::size_t view = a["bufferView"];
        const std::string bytes = view_bytes(view);
        const std::size_t stride =
            json["bufferViews"][view].value("byteStride", shape.columns * column);
        for (std::size_t i = 0; i < count; ++i)
            read(bytes, a.value("byteOffset", std::size_t(0)) + i * stride, i);
    }
    if (a.contains("sparse")) {
        const Json &places = a["sparse"]["indices"], &values = a["sparse"]["values"];
        const std::string place_bytes = view_bytes(places.at("bufferView")),
                          value_bytes = view_bytes(values.at("bufferView"));
        const int type = places.at("componentType");
        for (std::size_t i = 0; i < a["sparse"]["count"].get<std::size_t>(); ++i) {
            const std::size_t at =
                places.value("byteOffset", std::size_t(0)) + i * bytes_of_type(type);
            read(value_bytes,
                 values.value("byteOffset", std::size_t(0)) + i * shape.columns * column,
                 std::size_t(number_at(place_bytes.substr(at).c_str(), type, false)));
        }
    }
    return out;
}

const Json& GltfFile::primitive(std::size_t mesh, std::size_t primitive) const {
    return json.at("meshes").at(mesh).at("primitives").at(primitive);
}

GltfValues GltfFile::attribute(std::size_t mesh, std::size_t p, const std::string& name) const {
    return accessor(primitive(mesh, p).at("attributes").at(name));
}

GltfValues GltfFile::target(std::size_t mesh, std::size_t p, std::size_t t,
                            const std::string& name) const {
    return accessor(primitive(mesh, p).at("targets").at(t).at(name));
}

std::vector<std::size_t> GltfFile::indices(std::size_t mesh, std::size_t p) const {
    std::vector<std::size_t> out;
    const Json& in = primitive(mesh, p);
    if (in.contains("indices")) {
        for (const double i : accessor(in["indices"]).values) out.push_back(std::size_t(i));
    } else {
        const Json& position =
            json.at("accessors").at(in.at("attributes").at("POSITION").get<std::size_t>());
        for (std::size_t i = 0; i < position.at("count").get<std::size_t>(); ++i) out.push_back(i);
    }
    return out;
}

std::vector<std::size_t> GltfFile::triangles(std::size_t mesh, std::size_t p) const {
    const int mode = primitive(mesh, p).value("mode", 4);
    const std::vector<std::size_t> in = indices(mesh, p);
    std::vector<std::size_t> out;
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        out.insert(out.end(), {in[a], in[b], in[c]});
    };
    for (std::size_t i = 0; i + 2 < in.size(); ++i) {  // section 3.7.2.1
        if (mode == 4 && i % 3 == 0) add(i, i + 1, i + 2);
        if (mode == 5) add(i, i + 1 + i % 2, i + 2 - i % 2);
        if (mode == 6) add(i + 1, i + 2, 0);
    }
    return out;
}

std::string GltfFile::accessor_fault(std::size_t index) const {
    const std::string name = "accessor " + std::to_string(index);
    const Json& a = json["accessors"][index];
    const GltfValues all = accessor(index);
    if (all.count() == 0) return name + " is empty";
    if (a.contains("bufferView")) {
        const Json& view = json["bufferViews"].at(a["bufferView"].get<std::size_t>());
        const std::size_t size = bytes_of_type(all.component_type),
                          offset = a.value("byteOffset", std::size_t(0));
        if (offset % size != 0 || (view.value("byteOffset", std::size_t(0)) + offset) % size != 0)
            return name + " is not aligned";
        if (view.contains("byteStride")) {
            const std::size_t stride = view["byteStride"];
            if (stride % 4 != 0 || stride < 4 || stride > 252) return name + ": stride";
        }
    }
    for (const bool least : {true, false}) {
        const char* key = least ? "min" : "max";
        if (!a.contains(key)) continue;
        if (a[key].size() != all.width) return name + ": size of " + key;
        // Bounds are those of the stored numbers.
        const GltfValues stored = decoded(index, false);
        for (std::size_t k = 0; k < all.width; ++k) {
            double bound = stored.values[k];
            for (std::size_t i = 0; i < stored.count(); ++i) {
                const double x = stored.values[i * stored.width + k];
                bound = least ? std::min(bound, x) : std::max(bound, x);
            }
            if (bound != double(a[key][k].get<float>()))
                return name + ": " + key + " is " + a[key].dump() + ", the values' " +
                       std::to_string(bound);
        }
    }
    return {};
}

std::string GltfFile::primitive_fault(const Json& p) const {
    const Json& attributes = p.at("attributes");
    if (!attributes.contains("POSITION")) return {};
    const auto count_of = [&](const Json& index) {
        return json["accessors"].at(index.get<std::size_t>()).at("count").get<std::size_t>();
    };
    const std::size_t vertices = count_of(attributes["POSITION"]);
    const auto same_count = [&](const Json& list) {
        for (const auto& item : list.items())
            if (count_of(item.value()) != vertices) return item.key() + " has another count";
        return std::string();
    };
    std::string fault = same_count(attributes);
    for (const auto& item : attributes.items()) {  // vertices start at multiples of four bytes
        const Json& a = json["accessors"][item.value().get<std::size_t>()];
        if (!a.contains("bufferView")) continue;
        const Shape shape = shape_of(a["type"]);
        std::size_t column = shape.rows * bytes_of_type(a["componentType"]);
        if (shape.columns > 1) column = (column + 3) / 4 * 4;
        const std::size_t tight = shape.columns * column;
        const Json& view = json["bufferViews"].at(a["bufferView"].get<std::size_t>());
        if (view.value("byteStride", tight) % 4 != 0) fault = item.key() + " is not aligned";
    }
    if (!json["accessors"][attributes["POSITION"].get<std::size_t>()].contains("min") ||
        !json["accessors"][attributes["POSITION"].get<std::size_t>()].contains("max"))
        fault = "POSITION without bounds";
    if (p.contains("targets"))
        for (const Json& target : p["targets"]) {
            if (fault.empty()) fault = same_count(target);
            if (target.contains("POSITION") &&
                !json["accessors"][target["POSITION"].get<std::size_t>()].contains("min"))
                fault = "a target's POSITION without bounds";
        }
    if (p.contains("indices")) {
        const GltfValues used = accessor(p["indices"]);
        const double restart = used.component_type == 5121   ? 255.0
                               : used.component_type == 5123 ? 65535.0
                                                             : 4294967295.0;
        for (const double i : used.values)
            if (i >= double(vertices) || i == restart)
                fault = "index " + std::to_string(i) + " of " + std::to_string(vertices);
    }
    if (p.contains("material") &&
        p["material"].get<std::size_t>() >= json.value("materials", Json::array()).size())
        fault = "there is no material " + p["material"].dump();
    return fault;
}

std::string GltfFile::fault() const {
    try {
        if (json.at("asset").at("version") != "2.0") return "version";
        for (std::size_t v = 0; json.contains("bufferViews") && v < json["bufferViews"].size(); ++v)
            view_bytes(v);
        for (std::size_t i = 0; json.contains("accessors") && i < json["accessors"].size(); ++i)
            if (std::string f = accessor_fault(i); !f.empty()) return f;
        for (std::size_t m = 0; json.contains("meshes") && m < json["meshes"].size(); ++m)
            for (std::size_t p = 0; p < json["meshes"][m]["primitives"].size(); ++p)
                if (std::string f = primitive_fault(primitive(m, p)); !f.empty())
                    return "mesh " + std::to_string(m) + ", primitive " + std::to_string(p) + ": " +
                           f;
        for (const auto& item : json.items())
            if (item.value().is_array() && item.value().empty()) return item.key() + " is empty";
    } catch (const std::exception& e) {
        return e.what();
    }
    return {};
}

namespace {

class Comparison {
  public:
    Comparison(const GltfFile& before, const GltfFile& after,
               const std::vector<std::string>& ignored)
        : a_(before), b_(after), ignored_(ignored) {}

    std::string run() {
        for (std::size_t m = 0; m < size(a_.json, "meshes"); ++m)
            for (std::size_t p = 0; p < a_.json["meshes"][m]["primitives"].size(); ++p) {
                where_ = "mesh " + std::to_string(m) + ", primitive " + std::to_string(p) + ": ";
                primitive(m, p);
            }
        const auto accessors = [&](const char* list, const char* inner,
                                   const std::vector<std::string>& keys) {
            for (std::size_t i = 0; i < size(a_.json, list); ++i) {
                where_ = std::string(list) + " " + std::to_string(i) + ": ";
                const Json &x = a_.json[list][i], &y = b_.json.at(list).at(i);
                if (!inner) {
                    for (const std::string& key : keys) same_accessor(x, y, key);
                    continue;
                }
                for (std::size_t k = 0; k < x.at(inner).size(); ++k)
                    for (const std::string& key : keys)
                        same_accessor(x[inner][k], y.at(inner).at(k), key);
            }
        };
        accessors("skins", nullptr, {"inverseBindMatrices"});
        accessors("animations", "samplers", {"input", "output"});
        const auto instances = "/extensions/EXT_mesh_gpu_instancing/attributes"_json_pointer;
        for (std::size_t i = 0; i < size(a_.json, "nodes"); ++i) {
            where_ = "node " + std::to_string(i) + ": ";
            const Json x = a_.json["nodes"][i].value(instances, Json::object());
            for (const auto& item : x.items())
                same_accessor(x, b_.json.at("nodes").at(i).at(instances), item.key());
        }
        where_.clear();
        for (std::size_t i = 0; i < size(a_.json, "images"); ++i)
            if (a_.json["images"][i].contains("bufferView") &&
                a_.view_bytes(a_.json["images"][i]["bufferView"]) !=
                    b_.view_bytes(b_.json.at("images").at(i).at("bufferView")))
                say("bytes of image " + std::to_string(i));
        const Json x = plain(a_.json), y = plain(b_.json);
        if (x != y) say("members: " + Json::diff(x, y).dump());
        return said_;
    }

  private:
    static std::size_t size(const Json& json, const char* list) {
        return json.contains(list) ? json[list].size() : 0;
    }
    void say(const std::string& what) {
        if (said_.empty()) said_ = where_ + what;
    }
    bool ignored(const std::string& name) const {
        return std::find(ignored_.begin(), ignored_.end(), name) != ignored_.end();
    }
    void same_accessor(const Json& x, const Json& y, const std::string& key) {
        if (x.contains(key) && a_.accessor(x[key]) != b_.accessor(y.at(key))) say(key);
    }

    void primitive(std::size_t m, std::size_t p) {
        const Json& x = a_.primitive(m, p);
        const Json& y = b_.primitive(m, p);
        const bool faces = x.value("mode", 4) >= 4;
        std::vector<std::size_t> at = faces ? a_.triangles(m, p) : a_.indices(m, p);
        std::vector<std::size_t> to = faces ? b_.triangles(m, p) : b_.indices(m, p);
        if (at.size() != to.size()) return say("number of corners");
        lists(x.at("attributes"), y.at("attributes"), at, to, "");
        const std::size_t targets = size(x, "targets");
        if (targets != size(y, "targets")) return say("number of targets");
        for (std::size_t t = 0; t < targets; ++t)
            lists(x["targets"][t], y["targets"][t], at, to, "target " + std::to_string(t) + " ");
    }

    void lists(const Json& x, const Json& y, const std::vector<std::size_t>& at,
               const std::vector<std::size_t>& to, const std::string& of) {
        for (const auto& item : y.items())
            if (!x.contains(item.key()) && !ignored(item.key())) say("new: " + of + item.key());
        for (const auto& item : x.items()) {
            if (ignored(item.key())) continue;
            if (!y.contains(item.key())) {
                say("lost: " + of + item.key());
                continue;
            }
            const GltfValues before = a_.accessor(item.value()), after = b_.accessor(y[item.key()]);
            if (before.type != after.type || before.component_type != after.component_type)
                say("type of " + of + item.key());
            for (std::size_t c = 0; c < at.size(); ++c)
                if (before.at(at[c]) != after.at(to[c]))
                    return say(of + item.key() + " of corner " + std::to_string(c) + ": " +
                               Json(before.at(at[c])).dump() + " became " +
                               Json(after.at(to[c])).dump());
        }
    }

    // The document without its data: no references to accessors and views, nor what they are.
    static Json plain(Json json) {
        for (const char* key : {"accessors", "bufferViews", "buffers"}) json.erase(key);
        json["asset"].erase("generator");
        const auto each = [](Json& object, const char* key, const auto& body) {
            if (object.contains(key))
                for (Json& item : object[key]) body(item);
        };
        each(json, "meshes", [&](Json& mesh) {
            each(mesh, "primitives", [&](Json& p) {
                p.erase("attributes");
                p.erase("indices");
                if (p.value("mode", 4) >= 4) p.erase("mode");
                each(p, "targets", [](Json& target) { target = Json::object(); });
            });
        });
        each(json, "skins", [](Json& skin) { skin.erase("inverseBindMatrices"); });
        each(json, "animations", [&](Json& animation) {
            each(animation, "samplers", [](Json& sampler) {
                sampler.erase("input");
                sampler.erase("output");
            });
        });
        each(json, "images", [](Json& image) { image.erase("bufferView"); });
        each(json, "nodes", [](Json& node) {
            if (node.contains("extensions") &&
                node["extensions"].contains("EXT_mesh_gpu_instancing"))
                node["extensions"]["EXT_mesh_gpu_instancing"].erase("attributes");
        });
        return json;
    }

    const GltfFile &a_, &b_;
    const std::vector<std::string>& ignored_;
    std::string where_, said_;
};

}  // namespace

std::string gltf_difference(const GltfFile& before, const GltfFile& after,
                            const std::vector<std::string>& ignored) {
    return Comparison(before, after, ignored).run();
}

}  // namespace test
