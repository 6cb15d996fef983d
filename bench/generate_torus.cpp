// generate_torus TRIANGLES OUT: writes the bumpy torus (torus.h), the same bytes every time.
// OUT.obj: OBJ with UVs. OUT.raw: little-endian uint32 vertices and triangles, float32 position[3]
// × vertices, float32 normal[3] × vertices, uint32 vertex[3] × triangles, float32 uv[2] × 3 ×
// triangles (v counted from the bottom). OUT.ply: binary PLY of positions and triangles;
// OUT.uv.ply: with texture coordinates, for which vertices on the seams are doubled. OBJ and raw up
// to 16 million triangles, PLY up to 200 million.
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "prep/corner_normals.h"
#include "torus.h"

namespace {

void append(std::string& text, float value) {
    char digits[32];
    const auto end =
        std::to_chars(digits, digits + sizeof digits, double(value), std::chars_format::fixed, 6);
    text.push_back(' ');
    text.append(digits, end.ptr);
}

void append(std::string& text, char before, std::uint32_t value) {
    char digits[16];
    const auto end = std::to_chars(digits, digits + sizeof digits, value);
    text.push_back(before);
    text.append(digits, end.ptr);
}

template <class T>
void append(std::string& text, const std::vector<T>& values) {
    text.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

std::string raw(const prep::Mesh& mesh) {
    const prep::MeshView view(mesh);
    const prep::Topology topology = prep::build_topology(view, {}, 0);
    const prep::FaceNormals faces = prep::face_normals(view, prep::Precision::accurate, 0);
    const auto hard = prep::hard_edges(view, topology, faces, {});
    const auto normals = prep::corner_normals(view, topology, faces, *hard, {});
    std::vector<glm::vec3> vertex_normals(mesh.vertex_count());
    std::vector<glm::vec2> uvs;
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        // Nothing on the torus is hard: one normal a vertex.
        vertex_normals[mesh.corner_vertices[c]] =
            normals->normals.values[normals->normals.indices[c]];
        const glm::vec2 uv = mesh.uvs[0].values[mesh.uvs[0].indices[c]];
        uvs.push_back({uv.x, 1 - uv.y});
    }
    std::string bytes;
    append(bytes, std::vector<std::uint32_t>{std::uint32_t(mesh.vertex_count()),
                                             std::uint32_t(mesh.face_count())});
    append(bytes, mesh.positions);
    append(bytes, vertex_normals);
    append(bytes, mesh.corner_vertices);
    append(bytes, uvs);
    return bytes;
}

void append(std::string& bytes, glm::vec2 value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append(std::string& bytes, const glm::vec3& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// The mesh as OBJ, piece by piece to `write`.
template <class Write>
void obj(const prep::Mesh& mesh, const Write& write) {
    std::string text = "o torus\n";
    const auto flush = [&](std::size_t keep_below) {
        if (text.size() < keep_below) return;
        write(text);
        text.clear();
    };
    constexpr std::size_t block = 1 << 20;
    for (const glm::vec3& p : mesh.positions) {
        text += 'v';
        for (int k = 0; k < 3; ++k) append(text, p[k]);
        text += '\n';
        flush(block);
    }
    for (const glm::vec2& uv : mesh.uvs[0].values) {
        text += "vt";
        append(text, uv.x);
        append(text, 1 - uv.y);  // OBJ counts v from the bottom
        text += '\n';
        flush(block);
    }
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        if (c % 3 == 0) text += 'f';
        append(text, ' ', mesh.corner_vertices[c] + 1);
        append(text, '/', mesh.uvs[0].indices[c] + 1);
        if (c % 3 == 2) text += '\n';
        flush(block);
    }
    flush(0);
}

// The torus as binary PLY, piece by piece to `write`.
template <class Write>
void ply(const bench::TorusSize& size, bool with_uvs, const Write& write) {
    const bench::TorusGrid grid(size);
    const std::uint32_t n = size.rings + with_uvs, m = size.segments + with_uvs;
    const std::uint64_t triangles = std::uint64_t(2) * size.rings * size.segments;
    write("ply\nformat binary_little_endian 1.0\nelement vertex " +
          std::to_string(std::uint64_t(n) * m) +
          "\nproperty float x\nproperty float y\nproperty float z\n" +
          (with_uvs ? "property float s\nproperty float t\n" : "") + "element face " +
          std::to_string(triangles) + "\nproperty list uchar uint vertex_indices\nend_header\n");
    std::string bytes;
    for (std::uint32_t i = 0; i < n; ++i) {
        bytes.clear();
        for (std::uint32_t j = 0; j < m; ++j) {
            append(bytes, grid.position(i % size.rings, j % size.segments));
            if (with_uvs) {
                const glm::vec2 uv = grid.uv(i, j);
                append(bytes, glm::vec2{uv.x, 1 - uv.y});
            }
        }
        write(bytes);
    }
    for (std::uint32_t i = 0; i < size.rings; ++i) {
        bytes.clear();
        for (std::uint32_t j = 0; j < size.segments; ++j)
            for (const auto& corners : bench::TorusGrid::triangles) {
                bytes.push_back(3);
                for (const auto& [ring, segment] : corners) {
                    const std::uint32_t vertex = (i + ring) % n * m + (j + segment) % m;
                    bytes.append(reinterpret_cast<const char*>(&vertex), sizeof vertex);
                }
            }
        write(bytes);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string_view name = argc == 3 ? argv[2] : "";
    const bool as_ply = name.ends_with(".ply");
    const unsigned long long triangles = argc == 3 ? std::strtoull(argv[1], nullptr, 10) : 0;
    if (triangles < 18 || triangles > (as_ply ? 200'000'000 : 16'000'000)) {
        std::fprintf(stderr,
                     "usage: generate_torus TRIANGLES OUT.obj|OUT.raw   (18 to 16000000)\n"
                     "       generate_torus TRIANGLES OUT.ply|OUT.uv.ply   (18 to 200000000)\n");
        return 2;
    }
    const bench::TorusSize size = bench::torus_size(triangles);
    std::FILE* file = std::fopen(argv[2], "wb");
    bool good = file != nullptr;
    const auto write = [&](const std::string& bytes) {
        good = good && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    };
    if (as_ply)
        ply(size, name.ends_with(".uv.ply"), write);
    else if (const prep::Mesh mesh = bench::bumpy_torus(size); name.ends_with(".raw"))
        write(raw(mesh));
    else
        obj(mesh, write);
    if (file) good = std::fclose(file) == 0 && good;
    if (!good) {
        std::fprintf(stderr, "generate_torus: cannot write %s\n", argv[2]);
        return 1;
    }
    std::printf("%llu triangles\n", 2ull * size.rings * size.segments);
}
