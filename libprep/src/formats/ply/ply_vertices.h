// The element "vertex" of a PLY file: which of its properties are known, and their values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "base/unfilled_vector.h"
#include "formats/ply/ply_colors.h"
#include "formats/ply/ply_header.h"
#include "formats/ply/ply_values.h"

namespace prep {
struct Mesh;
}

namespace prep::detail {

class PlyVertices {
  public:
    // Chooses among the properties; false where x, y or z is missing.
    bool choose(const PlyElement& element);
    bool takes(std::size_t property) const { return slots_[property].has_value(); }

    // All of them from `values`. Says how many were read: less than all where the file ends, or a
    // value is none.
    std::uint64_t read(const PlyElement& element, PlyEncoding encoding, int threads,
                       PlyValues& values);
    // Into mesh.positions, with the origin that belongs there.
    void move_positions(Mesh& mesh);

    bool has_normals = false, has_colors = false, has_uvs = false, has_tangents = false;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec2> uvs;               // v from the top
    std::vector<glm::vec4> colors, tangents;  // colours linear

    std::size_t size() const { return count_; }

  private:
    enum Slot {
        px,
        py,
        pz,
        nx,
        ny,
        nz,
        red,
        green,
        blue,
        alpha,
        tu,
        tv,
        tx,
        ty,
        tz,
        tw,
        slot_count
    };
    using Row = std::array<double, slot_count>;

    static std::optional<Slot> slot_of(const std::string& name);
    void make_room(std::size_t count);
    void set(std::size_t vertex, const Row& row);
    bool read_records(const PlyElement& element, PlyEncoding encoding, int threads,
                      PlyValues& values);

    std::size_t count_ = 0;
    PlyColors colors_;
    std::vector<std::optional<Slot>> slots_;  // by property; of those that are taken
    std::array<bool, slot_count> has_{};
    std::array<PlyType, slot_count> types_{};
    // Binary floats need no double: their origin is zero (set_positions).
    bool positions_are_floats_ = false;
    std::vector<glm::vec3> float_positions_;
    UnfilledVector<glm::dvec3> positions_;
};

}  // namespace prep::detail
