#include "formats/gltf/compression/quantize.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <tuple>

#include "base/finite.h"
#include "formats/gltf/appended_data.h"
#include "formats/gltf/compression/quantized_nodes.h"
#include "formats/gltf/values/bounds.h"

namespace prep::detail {
namespace {

constexpr const char* extension_name = "KHR_mesh_quantization";
enum Row : std::uint8_t { positions, normals, tangents, uvs };

// A component type's name in a file, and the number that stands for 1 where it is normalised.
struct StoredType {
    int component_type = 5126;
    bool normalized = false;
    double one = 1;
};

// 180 where only one of the two is a direction.
double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 none(0);
    if ((a == none) != (b == none)) return 180;
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * (180 / 3.14159265358979324);
}

glm::dvec3 vector_at(const std::vector<float>& values, std::size_t i, std::size_t width) {
    return {values[i * width], values[i * width + 1], values[i * width + 2]};
}

// One that could not be drawn is written as it came: its accessors say what the Draco data hold.
bool stays_in_draco(const Json& primitive) {
    const auto extensions = primitive.find("extensions");
    return extensions != primitive.end() && extensions->contains("KHR_draco_mesh_compression");
}

class Quantizer {
  public:
    Quantizer(Json& json, PackedBuffer packed, const Quantization& bits, QuantizationReport& report,
              std::vector<std::string>& notes)
        : json_(json), bits_(bits), report_(report), notes_(notes) {
        document_.buffers.push_back(SharedBytes(packed.bytes.joined()));
    }

    Result<PackedBuffer> run() {
        report_ = {};
        for (std::size_t r = 0; r < std::size(quantization_rows); ++r)
            report_.rows[r].bits = bits_.*quantization_rows[r].bits;
        // Made first: a new key moves its siblings, and references to them are held below.
        for (const char* list : {"accessors", "bufferViews"})
            if (!json_.contains(list)) json_[list] = Json::array();
        document_.json = json_;
        if (json_.contains("meshes"))
            for (std::size_t m = 0; m < json_["meshes"].size(); ++m)
                if (auto done = mesh(m); !done) return std::move(done).error();
        for (QuantizationError& row : report_.rows)
            if (row.values > 0) row.mean /= double(row.values);
        declare();
        auto packed = pack_buffer(document_, json_, appended_, notes_);
        if (packed) remove_empty_lists(json_);
        return packed;
    }

  private:
    void declare() {
        if (!declared_) return;
        for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
            Json& names = json_[list];
            if (!names.is_array()) names = Json::array();
            if (std::find(names.begin(), names.end(), Json(extension_name)) == names.end())
                names.push_back(extension_name);
        }
    }

    void count(Row row, double error) {
        QuantizationError& to = report_.rows[row];
        ++to.values;
        to.largest = std::max(to.largest, error);
        to.mean += error;
    }

    void keep(Row row, std::size_t values, const std::string& why) {
        report_.rows[row].kept += values;
        const std::string remark = std::string(quantization_rows[row].name) + " " + why +
                                   " stay floats: they are not quantised";
        std::vector<std::string>& known = report_.remarks;
        if (std::find(known.begin(), known.end(), remark) == known.end()) known.push_back(remark);
    }

    Result<void> mesh(std::size_t m) {
        for (Json& primitive : json_["meshes"][m]["primitives"]) {
            if (stays_in_draco(primitive)) continue;
            for (auto& item : primitive["attributes"].items()) {
                Result<void> done;
                if (item.key() == "NORMAL" && bits_.normals != 0)
                    done = attribute(normals, item.value(), 3);
                else if (item.key() == "TANGENT" && bits_.tangents != 0)
                    done = attribute(tangents, item.value(), 4);
                else if (item.key().starts_with("TEXCOORD_") && bits_.uvs != 0)
                    done = attribute(uvs, item.value(), 2);
                if (!done) return done;
            }
        }
        return bits_.positions != 0 ? place(m) : Result<void>();
    }

    // --- directions and UVs --------------------------------------------------------------

    Result<void> attribute(Row row, Json& index, int width) {
        const auto accessor = index.get<std::size_t>();
        const auto known = made_.find({row, accessor});
        if (known != made_.end()) {
            index = known->second;
            return {};
        }
        const auto raw = document_.raw_accessor(accessor);
        if (!raw) return raw.error();
        if (raw->width != width) return {};
        const std::vector<float> floats = to_floats(*raw);
        std::vector<double> values(floats.begin(), floats.end());
        const int bits = bits_.*quantization_rows[row].bits;
        const StoredType type =
            row == uvs ? StoredType{bits <= 8 ? 5121 : 5123, true, bits <= 8 ? 255.0 : 65535.0}
                       : StoredType{bits <= 8 ? 5120 : 5122, true, bits <= 8 ? 127.0 : 32767.0};
        const double steps = row == uvs ? std::exp2(bits) - 1 : std::exp2(bits - 1) - 1;
        const auto code = [&](double v) {
            return std::int32_t(std::round(std::round(v * steps) * type.one / steps));
        };
        const bool fits =
            row == uvs ? std::all_of(floats.begin(), floats.end(),
                                     [](float v) { return v >= 0.0f && v <= 1.0f; })
                       : make_directions(values, std::size_t(width), 1 / steps, [&](double v) {
                             return float(code(v) / type.one) == float(v);
                         });
        if (!fits) {
            keep(row, raw->count, row == uvs ? "outside 0 … 1" : "that are not finite");
            return {};
        }
        std::vector<std::int32_t> stored(values.size());
        std::transform(values.begin(), values.end(), stored.begin(), code);
        measure(row, floats, stored, type.one, std::size_t(width));
        // Whole numbers of 16 or 8 bits from 0 to 1 are glTF's own for UVs.
        declared_ |= row != uvs;
        index = made_[{row, accessor}] = add(type, width, stored, false);
        return {};
    }

    // Lengths say nothing, and short vectors would keep few bits: unit ones, but for those that
    // were rounded in such steps before, which keep their codes. False where a value is not finite,
    // or a tangent's sign is beyond 1.
    template <class HasCode>
    static bool make_directions(std::vector<double>& values, std::size_t width, double step,
                                HasCode has_code) {
        for (std::size_t i = 0; i < values.size(); i += width) {
            const glm::dvec3 v(values[i], values[i + 1], values[i + 2]);
            const double length = glm::length(v);
            if (!std::isfinite(length) || (width == 4 && !(std::abs(values[i + 3]) <= 1)))
                return false;
            if (std::abs(length - 1) <= step && has_code(v.x) && has_code(v.y) && has_code(v.z))
                continue;
            for (std::size_t k = 0; length > 0 && k < 3; ++k) values[i + k] /= length;
        }
        return true;
    }

    void measure(Row row, const std::vector<float>& values, const std::vector<std::int32_t>& stored,
                 double one, std::size_t width) {
        for (std::size_t i = 0; i * width < values.size(); ++i) {
            if (row == uvs) {
                double error = 0;
                for (std::size_t k = i * width; k < (i + 1) * width; ++k)
                    error = std::max(error, std::abs(stored[k] / one - double(values[k])));
                count(row, error);
                continue;
            }
            const glm::dvec3 to(stored[i * width], stored[i * width + 1], stored[i * width + 2]);
            count(row, degrees_between(vector_at(values, i, width), to));
        }
    }

    // --- positions -----------------------------------------------------------------------

    struct Box {
        glm::dvec3 low{std::numeric_limits<double>::infinity()};
        glm::dvec3 high{-std::numeric_limits<double>::infinity()};
        bool finite = true;
        std::size_t values = 0;
    };

    Result<Box> box_of(std::size_t m) {
        Box box;
        for (const Json& primitive : json_["meshes"][m]["primitives"]) {
            const auto position = primitive["attributes"].find("POSITION");
            if (position == primitive["attributes"].end()) continue;
            const auto part = box_of_positions(position->get<std::size_t>());
            if (!part) return part.error();
            box.finite &= part->finite;
            box.low = glm::min(box.low, part->low);
            box.high = glm::max(box.high, part->high);
            box.values += part->values;
        }
        return box;
    }

    Result<Box> box_of_positions(std::size_t accessor) {
        if (const auto known = boxes_.find(accessor); known != boxes_.end()) return known->second;
        const auto raw = document_.raw_accessor(accessor);
        if (!raw) return raw.error();
        Box box;
        const std::vector<float> values = to_floats(*raw);
        for (std::size_t i = 0; i < raw->count; ++i) {
            const glm::dvec3 p = vector_at(values, i, 3);
            box.finite &= is_finite(p);
            box.low = glm::min(box.low, p);
            box.high = glm::max(box.high, p);
        }
        box.values = raw->count;
        return boxes_[accessor] = box;
    }

    Result<void> place(std::size_t m) {
        const auto box = box_of(m);
        if (!box) return box.error();
        if (box->values == 0) return {};
        std::string why = nodes_.no_place_for_grid(m);
        for (const Json& primitive : json_["meshes"][m]["primitives"])
            if (stays_in_draco(primitive) && primitive["attributes"].contains("POSITION"))
                why = "with primitives that are written as they came";
        if (!box->finite) why = "that are not finite";
        const glm::dvec3 size = box->high - box->low;
        double extent = std::max({size.x, size.y, size.z}), diagonal = glm::length(size);
        double steps = std::exp2(bits_.positions) - 1;
        if (extent == 0) {  // all in one place: what moves them away says how large the mesh is
            const auto moved = farthest_move(m);
            if (!moved) return moved.error();
            extent = diagonal = *moved;
            steps = std::min(steps, 32767.0);
        }
        // A float, as most programs keep it, and not too small for the last step.
        float step = extent > 0 ? float(extent / steps) : 1.0f;
        if (double(step) * steps < extent)
            step = std::nextafter(step, std::numeric_limits<float>::infinity());
        if (!std::isnormal(step)) why = "of a size that floats hardly hold";
        const PositionGrid grid{box->low, double(step)};
        if (why.empty()) {
            const auto kept = why_not_on_grid(m, grid);
            if (!kept) return kept.error();
            why = *kept;
        }
        if (!why.empty()) {
            keep(positions, box->values, "of meshes " + why);
            return {};
        }
        for (Json& primitive : json_["meshes"][m]["primitives"])
            if (auto done = on_grid(primitive, grid, diagonal); !done) return done;
        return nodes_.place_grid(m, grid);
    }

    // The largest that a target moves anything along an axis. What is not finite is not looked at.
    Result<double> farthest_move(std::size_t m) {
        double farthest = 0;
        for (const Json& primitive : json_["meshes"][m]["primitives"]) {
            if (!primitive.contains("targets")) continue;
            for (const Json& target : primitive["targets"]) {
                const auto moves = target.find("POSITION");
                if (moves == target.end()) continue;
                const auto raw = document_.raw_accessor(moves->get<std::size_t>());
                if (!raw) return raw.error();
                for (const float v : to_floats(*raw))
                    if (std::isfinite(v)) farthest = std::max(farthest, std::abs(double(v)));
            }
        }
        return farthest;
    }

    // What floats cannot hold in steps of the grid: how far targets move, matrices of skins. Empty
    // where they can.
    Result<std::string> why_not_on_grid(std::size_t m, const PositionGrid& grid) {
        for (const Json& primitive : json_["meshes"][m]["primitives"]) {
            if (!primitive.contains("targets")) continue;
            for (const Json& target : primitive["targets"]) {
                const auto moves = target.find("POSITION");
                if (moves == target.end()) continue;
                const auto raw = document_.raw_accessor(moves->get<std::size_t>());
                if (!raw) return raw.error();
                for (const float v : to_floats(*raw))
                    if (!std::isfinite(float(double(v) / grid.step)))
                        return std::string("whose targets move too far for their size");
            }
        }
        const auto held = nodes_.matrices_hold(m, grid);
        if (!held) return held.error();
        return std::string(*held ? "" : "whose skins' matrices hardly hold their size");
    }

    Result<void> on_grid(Json& primitive, const PositionGrid& grid, double diagonal) {
        Json& attributes = primitive["attributes"];
        if (attributes.contains("POSITION"))
            if (auto done = points(attributes["POSITION"], grid, diagonal); !done) return done;
        if (!primitive.contains("targets")) return {};
        for (Json& target : primitive["targets"])
            if (target.contains("POSITION"))
                if (auto done = deltas(target["POSITION"], grid, diagonal); !done) return done;
        return {};
    }

    Result<void> points(Json& index, const PositionGrid& grid, double diagonal) {
        const Key key{false,         index.get<std::size_t>(),
                      grid.origin.x, grid.origin.y,
                      grid.origin.z, grid.step};
        if (const auto known = placed_.find(key); known != placed_.end()) {
            index = known->second;
            return {};
        }
        const auto raw = document_.raw_accessor(index.get<std::size_t>());
        if (!raw) return raw.error();
        const std::vector<float> values = to_floats(*raw);
        std::vector<std::int32_t> stored;
        stored.reserve(values.size());
        for (std::size_t i = 0; i < raw->count; ++i) {
            const glm::dvec3 p = vector_at(values, i, 3);
            const glm::dvec3 q = glm::round((p - grid.origin) / grid.step);
            for (int k = 0; k < 3; ++k) stored.push_back(std::int32_t(q[k]));
            const double error = glm::length(grid.origin + grid.step * q - p);
            count(positions, diagonal > 0 ? error / diagonal : 0);
        }
        const bool narrow = bits_.positions <= 8;
        declared_ = true;
        index = placed_[key] = add({narrow ? 5121 : 5123, false, 1}, 3, stored, true);
        return {};
    }

    // What a target moves, in steps: whole ones where they fit into 16 bits.
    Result<void> deltas(Json& index, const PositionGrid& grid, double diagonal) {
        const Key key{true, index.get<std::size_t>(), 0, 0, 0, grid.step};
        if (const auto known = placed_.find(key); known != placed_.end()) {
            index = known->second;
            return {};
        }
        const auto raw = document_.raw_accessor(index.get<std::size_t>());
        if (!raw) return raw.error();
        const std::vector<float> values = to_floats(*raw);
        std::vector<std::int32_t> stored;
        std::vector<glm::vec3> exact;
        bool fits = true;
        for (std::size_t i = 0; i < raw->count; ++i) {
            const glm::dvec3 d = vector_at(values, i, 3) / grid.step;
            const glm::dvec3 q = glm::round(d);
            exact.emplace_back(d);
            fits &= glm::all(glm::lessThanEqual(glm::abs(q), glm::dvec3(32767)));
            for (int k = 0; fits && k < 3; ++k) stored.push_back(std::int32_t(q[k]));
        }
        std::size_t made = 0;
        if (fits) {
            for (std::size_t i = 0; i < raw->count; ++i) {
                const glm::dvec3 q(stored[3 * i], stored[3 * i + 1], stored[3 * i + 2]);
                const double error = glm::length(grid.step * q - vector_at(values, i, 3));
                count(positions, diagonal > 0 ? error / diagonal : 0);
            }
            made = add({5122, false, 1}, 3, stored, true);
        } else {
            keep(positions, raw->count, "of morph targets that move by more than 32,767 steps");
            made = appended_.add_floats(exact);
            RawAccessor bounded;
            bounded.width = 3;
            bounded.count = raw->count;
            bounded.bytes = SharedBytes::lent(std::as_bytes(std::span(exact)));
            set_bounds(bounded, json_["accessors"][made]);
        }
        index = placed_[key] = made;
        return {};
    }

    // --- accessors -----------------------------------------------------------------------

    // Elements begin at multiples of four bytes, as glTF asks of vertices.
    std::size_t add(const StoredType& type, int width, const std::vector<std::int32_t>& values,
                    bool bounded) {
        RawAccessor raw;
        raw.component_type = type.component_type;
        raw.width = width;
        raw.count = values.size() / std::size_t(width);
        const std::size_t one = component_size(type.component_type);
        const std::size_t size = one * std::size_t(width), stride = (size + 3) / 4 * 4;
        std::vector<std::byte> bytes(raw.count * stride);
        std::vector<std::byte> packed(raw.count * size);
        for (std::size_t i = 0; i < values.size(); ++i) {
            const auto value = std::uint32_t(values[i]);
            const std::byte parts[2] = {std::byte(value), std::byte(value >> 8)};
            const std::size_t element = i / std::size_t(width), k = i % std::size_t(width);
            std::memcpy(&bytes[element * stride + k * one], parts, one);
            std::memcpy(&packed[i * one], parts, one);
        }
        raw.bytes = std::move(packed);
        Json accessor{{"bufferView",
                       appended_.add_view(std::move(bytes), 34962, stride == size ? 0 : stride)},
                      {"componentType", type.component_type},
                      {"count", raw.count},
                      {"type", width == 2   ? "VEC2"
                               : width == 3 ? "VEC3"
                                            : "VEC4"}};
        if (type.normalized) accessor["normalized"] = true;
        if (bounded) set_bounds(raw, accessor);
        return appended_.add_accessor(std::move(accessor));
    }

    Json& json_;
    GltfDocument document_;
    const Quantization& bits_;
    QuantizationReport& report_;
    std::vector<std::string>& notes_;
    bool declared_ = false;
    // Accessors that several primitives share are made once.
    std::map<std::pair<Row, std::size_t>, std::size_t> made_;
    std::map<std::size_t, Box> boxes_;
    using Key = std::tuple<bool, std::size_t, double, double, double, double>;
    std::map<Key, std::size_t> placed_;
    AppendedData appended_{json_};
    GridNodes nodes_{document_, json_, appended_};
};

}  // namespace

Result<PackedBuffer> quantize_gltf(Json& json, PackedBuffer packed, const Quantization& bits,
                                   QuantizationReport& report, std::vector<std::string>& notes) {
    try {
        return Quantizer(json, std::move(packed), bits, report, notes).run();
    } catch (const Json::exception& e) {  // members of a type that no reader here asks for
        return Error{ErrorCode::invalid, std::string("the glTF document: ") + e.what(), {}};
    }
}

}  // namespace prep::detail
