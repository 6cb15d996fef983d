#include "cost/oracles/glb_corners.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace cost {
namespace {

using Json = nlohmann::json;
using Matrix = glm::mat<4, 4, Real>;

std::optional<std::uint32_t> word_at(std::span<const std::byte> file, std::size_t at) {
    if (at > file.size() || file.size() - at < 4) return std::nullopt;
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 4; ++k) word |= std::uint32_t(file[at + k]) << (8 * k);
    return word;
}

struct Chunks {
    Json document;
    std::span<const std::byte> data;
};

std::optional<Chunks> chunks_of(std::span<const std::byte> file) {
    constexpr std::uint32_t magic = 0x46546C67, json = 0x4E4F534A, binary = 0x004E4942;
    if (word_at(file, 0) != magic) return std::nullopt;
    Chunks chunks;
    for (std::size_t at = 12; at < file.size();) {
        const auto length = word_at(file, at), kind = word_at(file, at + 4);
        if (!length || !kind || *length > file.size() - at - 8) return std::nullopt;
        const auto bytes = file.subspan(at + 8, *length);
        if (*kind == json) {
            const char* const text = reinterpret_cast<const char*>(bytes.data());
            chunks.document = Json::parse(text, text + bytes.size(), nullptr, false);
        }
        if (*kind == binary) chunks.data = bytes;
        at += 8 + *length;
    }
    if (!chunks.document.is_object()) return std::nullopt;
    return chunks;
}

std::size_t size_of(int component) {
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
            return 0;
    }
}

// Normalised: 1 is the largest number of the type, and of signed ones nothing is below −1.
Real number_of(const std::byte* at, int component, bool normalized) {
    const auto value = [&](auto number) {
        std::memcpy(&number, at, sizeof number);
        if (!normalized) return Real(number);
        using Number = decltype(number);
        return std::max(Real(number) / Real(std::numeric_limits<Number>::max()), Real(-1));
    };
    switch (component) {
        case 5120:
            return value(std::int8_t());
        case 5121:
            return value(std::uint8_t());
        case 5122:
            return value(std::int16_t());
        case 5123:
            return value(std::uint16_t());
        case 5125:
            return value(std::uint32_t());
        default: {
            float number = 0;
            std::memcpy(&number, at, sizeof number);
            return Real(number);
        }
    }
}

struct Unreadable {};

class GlbReader {
  public:
    explicit GlbReader(const Chunks& chunks) : document_(chunks.document), data_(chunks.data) {}

    GlbCorners read() {
        const Json& scene = document_.at("scenes").at(document_.value("scene", std::size_t(0)));
        for (const Json& node : scene.at("nodes")) visit(node.get<std::size_t>(), Matrix(1), 0);
        return std::move(corners_);
    }

  private:
    // `width` numbers for each element, one after the other.
    std::vector<Real> numbers(std::size_t accessor, std::size_t width) const {
        const Json& a = document_.at("accessors").at(accessor);
        if (a.contains("sparse")) throw Unreadable{};
        const Json& view = document_.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
        if (view.value("buffer", 0) != 0 || view.contains("extensions")) throw Unreadable{};
        const int component = a.at("componentType").get<int>();
        const std::size_t size = size_of(component), count = a.at("count").get<std::size_t>();
        const std::size_t stride = view.value("byteStride", size * width);
        const std::size_t first =
            view.value("byteOffset", std::size_t(0)) + a.value("byteOffset", std::size_t(0));
        if (size == 0 || count > data_.size() || stride > data_.size() || first > data_.size() ||
            (count > 0 && (count - 1) * stride + size * width > data_.size() - first))
            throw Unreadable{};
        std::vector<Real> values;
        values.reserve(count * width);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t k = 0; k < width; ++k)
                values.push_back(number_of(&data_[first + i * stride + k * size], component,
                                           a.value("normalized", false)));
        return values;
    }

    static Matrix transform(const Json& node) {
        Matrix m(1);
        if (const auto matrix = node.find("matrix"); matrix != node.end()) {
            for (int k = 0; k < 16; ++k)
                m[k / 4][k % 4] = Real(matrix->at(std::size_t(k)).get<double>());
            return m;
        }
        const auto three = [&](const char* key, Real otherwise) {
            Vector v(otherwise);
            if (const auto it = node.find(key); it != node.end())
                for (int k = 0; k < 3; ++k) v[k] = Real(it->at(std::size_t(k)).get<double>());
            return v;
        };
        Vector q(0);
        Real w = 1;
        if (const auto it = node.find("rotation"); it != node.end()) {
            for (int k = 0; k < 3; ++k) q[k] = Real(it->at(std::size_t(k)).get<double>());
            w = Real(it->at(3).get<double>());
        }
        const Vector scale = three("scale", 1), moved = three("translation", 0);
        for (int k = 0; k < 3; ++k) {
            Vector e(0);
            e[k] = 1;
            const Vector t = glm::cross(q, e) * Real(2);
            m[k] = glm::vec<4, Real>((e + t * w + glm::cross(q, t)) * scale[k], 0);
        }
        m[3] = glm::vec<4, Real>(moved, 1);
        return m;
    }

    void visit(std::size_t number, const Matrix& parent, std::size_t depth) {
        const Json& nodes = document_.at("nodes");
        const Json& node = nodes.at(number);
        if (depth > nodes.size() || node.contains("skin")) throw Unreadable{};
        const Matrix world = parent * transform(node);
        if (const auto mesh = node.find("mesh"); mesh != node.end()) {
            const Json& of = document_.at("meshes").at(mesh->get<std::size_t>());
            for (const Json& primitive : of.at("primitives")) add(primitive, world);
        }
        if (const auto children = node.find("children"); children != node.end())
            for (const Json& child : *children) visit(child.get<std::size_t>(), world, depth + 1);
    }

    void add(const Json& primitive, const Matrix& world) {
        if (primitive.value("mode", 4) != 4 || primitive.contains("extensions")) throw Unreadable{};
        const Json& attributes = primitive.at("attributes");
        const std::vector<Real> points = numbers(attributes.at("POSITION").get<std::size_t>(), 3);
        std::vector<std::size_t> indices;
        if (const auto named = primitive.find("indices"); named != primitive.end())
            for (const Real i : numbers(named->get<std::size_t>(), 1))
                indices.push_back(std::size_t(i));
        else
            for (std::size_t i = 0; i < points.size() / 3; ++i) indices.push_back(i);
        const auto each = [&](const char* name, std::size_t width, const auto& take) {
            const auto it = attributes.find(name);
            if (it == attributes.end()) return;
            const std::vector<Real> values = numbers(it->get<std::size_t>(), width);
            for (const std::size_t i : indices) {
                if ((i + 1) * width > values.size()) throw Unreadable{};
                take(&values[i * width]);
            }
        };
        const auto vector = [](const Real* v) { return Vector(v[0], v[1], v[2]); };
        const Vector x(world[0]), y(world[1]), z(world[2]);
        each("POSITION", 3, [&](const Real* v) {
            corners_.positions.push_back(Vector(world * glm::vec<4, Real>(vector(v), 1)));
        });
        // Normals are planes: by the inverse's transpose, which is the matrix of cofactors over the
        // determinant; a mirroring node does not turn them round.
        const Real side = glm::dot(x, glm::cross(y, z)) < 0 ? -1 : 1;
        each("NORMAL", 3, [&](const Real* v) {
            corners_.normals.push_back(side * (glm::cross(y, z) * v[0] + glm::cross(z, x) * v[1] +
                                               glm::cross(x, y) * v[2]));
        });
        each("TANGENT", 4, [&](const Real* v) {
            corners_.tangents.push_back(x * v[0] + y * v[1] + z * v[2]);
            corners_.handedness.push_back(v[3]);
        });
        each("TEXCOORD_0", 2, [&](const Real* v) { corners_.uvs.emplace_back(v[0], v[1]); });
    }

    const Json& document_;
    std::span<const std::byte> data_;
    GlbCorners corners_;
};

}  // namespace

std::optional<GlbCorners> corners_of_glb(std::span<const std::byte> file) {
    // Exceptions end here: those of the document's members, and what is not read.
    try {
        const auto chunks = chunks_of(file);
        if (!chunks) return std::nullopt;
        return GlbReader(*chunks).read();
    } catch (const Json::exception&) {
        return std::nullopt;
    } catch (const Unreadable&) {
        return std::nullopt;
    }
}

}  // namespace cost
