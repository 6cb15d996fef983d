// Small meshes made of a fuzzer's bytes: hostile values, any topology, every layer a mesh can have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "prep/mesh.h"

namespace fuzz {

class Bytes {
  public:
    Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
    // Zeros when there is nothing left.
    template <class T>
    T take() {
        T value{};
        const std::size_t n = size_ < sizeof(T) ? size_ : sizeof(T);
        if (n > 0) std::memcpy(&value, data_, n);  // of no bytes data_ may be null
        data_ += n;
        size_ -= n;
        return value;
    }
    std::uint32_t below(std::uint32_t limit) { return take<std::uint8_t>() % limit; }
    bool empty() const { return size_ == 0; }

  private:
    const std::uint8_t* data_;
    std::size_t size_;
};

// Few distinct values, so that coincidences are common, and now and then any float at all.
inline float coordinate(Bytes& in) {
    static constexpr float usual[] = {0.0f, 1.0f, -1.0f, 0.5f, 2.0f, 1e-30f, 1e30f, -0.0f};
    const std::uint32_t choice = in.below(10);
    return choice < 8 ? usual[choice] : in.take<float>();
}
inline glm::vec2 vector2(Bytes& in) {
    const float x = coordinate(in);
    return {x, coordinate(in)};
}
inline glm::vec3 vector3(Bytes& in) {
    const glm::vec2 xy = vector2(in);
    return {xy, coordinate(in)};
}
inline glm::vec4 vector4(Bytes& in) {
    const glm::vec3 xyz = vector3(in);
    return {xyz, coordinate(in)};
}

inline prep::Mesh hostile_mesh(Bytes& in, bool triangles = false) {
    prep::Mesh mesh;
    const std::uint32_t vertices = 1 + in.below(20), layers = in.take<std::uint8_t>();
    for (std::uint32_t v = 0; v < vertices; ++v) mesh.positions.push_back(vector3(in));
    const bool uvs = layers & 1, normals = layers & 2, tangents = layers & 4, colors = layers & 8,
               groups = layers & 16, materials = layers & 32, marks = layers & 64;
    if (layers & 128) mesh.origin = {in.take<double>(), in.take<float>(), 1e7};
    if (uvs) mesh.uvs.resize(1);
    if (colors) mesh.colors.resize(1);
    if (marks) {
        mesh.hard_marks.emplace_back(in.below(vertices), in.below(vertices));
        for (std::uint32_t k = 1 + in.below(3); k > 0; --k)
            mesh.subdivision.creases.push_back(
                {in.below(vertices), in.below(vertices), float(in.below(11))});
    }
    if (groups && in.below(2) == 1) mesh.smoothing_kind = prep::SmoothingKind::bit_mask;
    while (!in.empty() && mesh.face_count() < 64) {
        const std::uint32_t corners = 3 + in.below(triangles ? 1 : 6);
        for (std::uint32_t k = 0; k < corners; ++k) {
            const std::uint32_t corner = std::uint32_t(mesh.corner_count());
            mesh.corner_vertices.push_back(in.below(vertices));
            const auto give = [&](auto& layer, const auto& value) {
                layer.values.push_back(value);
                layer.indices.push_back(in.below(16) == 0 ? prep::no_index : corner);
            };
            if (uvs) give(mesh.uvs[0], vector2(in));
            if (normals) give(mesh.normals, vector3(in));
            if (tangents) give(mesh.tangents, vector4(in));
            if (colors) give(mesh.colors[0], vector4(in));
        }
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_count()));
        if (groups) mesh.face_smoothing.push_back(in.below(4));
        if (materials) mesh.face_materials.push_back(in.below(2));
    }
    return mesh;
}

}  // namespace fuzz
