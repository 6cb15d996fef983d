// prepare() as a whole on small meshes made of the input's bytes: hostile values, any topology.
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "prep/prepare.h"

namespace {

class Bytes {
  public:
    Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
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
float coordinate(Bytes& in) {
    static constexpr float usual[] = {0.0f, 1.0f, -1.0f, 0.5f, 2.0f, 1e-30f, 1e30f, -0.0f};
    const std::uint32_t choice = in.below(10);
    return choice < 8 ? usual[choice] : in.take<float>();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes in(data, size);
    prep::Scene scene;
    scene.meshes.resize(1);
    prep::Mesh& mesh = scene.meshes[0];
    const std::uint32_t vertices = 1 + in.below(12), choices = in.take<std::uint8_t>();
    for (std::uint32_t v = 0; v < vertices; ++v) {
        const float x = coordinate(in), y = coordinate(in);
        mesh.positions.push_back({x, y, coordinate(in)});
    }
    const bool uvs = choices & 1, normals = choices & 2, groups = choices & 4;
    const bool tangents = choices >= 72;
    if (uvs) mesh.uvs.resize(1);
    while (!in.empty() && mesh.face_count() < 64) {
        const std::uint32_t corners = 3 + in.below(6);
        for (std::uint32_t k = 0; k < corners; ++k) {
            const std::uint32_t corner = std::uint32_t(mesh.corner_count());
            mesh.corner_vertices.push_back(in.below(vertices));
            if (uvs) {
                const float u = coordinate(in);
                mesh.uvs[0].values.push_back({u, coordinate(in)});
                mesh.uvs[0].indices.push_back(in.below(16) == 0 ? prep::no_index : corner);
            }
            if (normals) {
                const float x = coordinate(in), y = coordinate(in);
                mesh.normals.values.push_back({x, y, coordinate(in)});
                mesh.normals.indices.push_back(in.below(16) == 0 ? prep::no_index : corner);
            }
            if (tangents) {
                const float x = coordinate(in), y = coordinate(in), z = coordinate(in);
                mesh.tangents.values.push_back({x, y, z, coordinate(in)});
                mesh.tangents.indices.push_back(in.below(16) == 0 ? prep::no_index : corner);
            }
        }
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_count()));
        if (groups) mesh.face_smoothing.push_back(in.below(4));
    }
    prep::PrepareOptions options;
    options.threads = 1;
    options.request.tangents = prep::Request::Level::always;
    options.normals = prep::Authored(choices / 8 % 3);
    options.weld = prep::WeldMode(choices / 24 % 3);
    options.tangents = prep::Authored(choices / 72 % 3);
    const auto result = prep::prepare(std::move(scene), options);
    if (!result) return 0;
    // What prepare() promises: unit normals (where it made or mended them) and finite tangents.
    const prep::VertexMesh& out = result->meshes[0];
    for (const glm::vec3& n : out.normals) {
        const double length = glm::length(glm::dvec3(n));
        if (!(length > 0.999 && length < 1.001)) __builtin_trap();
    }
    for (const glm::vec4& t : out.tangents) {
        const double length = glm::length(glm::dvec3(glm::vec3(t)));
        if (!(length > 0.999 && length < 1.001) || (t.w != 1 && t.w != -1)) __builtin_trap();
    }
    return 0;
}
