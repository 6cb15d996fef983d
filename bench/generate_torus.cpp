// generate_torus TRIANGLES OUT: writes the bumpy torus (torus.h), the same bytes every time. Up to
// 16 million triangles. OUT.obj: OBJ with UVs. OUT.raw: little-endian uint32 vertices and
// triangles, float32 position[3] × vertices, float32 normal[3] × vertices, uint32 vertex[3] ×
// triangles, float32 uv[2] × 3 × triangles (v counted from the bottom).
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

}  // namespace

int main(int argc, char** argv) {
    const unsigned long long triangles = argc == 3 ? std::strtoull(argv[1], nullptr, 10) : 0;
    if (triangles < 18 || triangles > 16'000'000) {
        std::fprintf(stderr,
                     "usage: generate_torus TRIANGLES OUT.obj|OUT.raw   (18 to 16000000)\n");
        return 2;
    }
    const prep::Mesh mesh = bench::bumpy_torus(bench::torus_size(triangles));
    std::FILE* file = std::fopen(argv[2], "wb");
    std::string text = "o torus\n";
    bool good = file != nullptr;
    const auto flush = [&](std::size_t keep_below) {
        if (text.size() < keep_below) return;
        good = good && std::fwrite(text.data(), 1, text.size(), file) == text.size();
        text.clear();
    };
    const bool as_raw = std::string_view(argv[2]).ends_with(".raw");
    if (as_raw) {
        text = raw(mesh);
        flush(0);
    }
    constexpr std::size_t block = 1 << 20;
    for (std::size_t v = 0; v < mesh.vertex_count() && !as_raw; ++v) {
        const glm::vec3& p = mesh.positions[v];
        text += 'v';
        for (int k = 0; k < 3; ++k) append(text, p[k]);
        text += '\n';
        flush(block);
    }
    for (std::size_t t = 0; t < mesh.uvs[0].values.size() && !as_raw; ++t) {
        const glm::vec2& uv = mesh.uvs[0].values[t];
        text += "vt";
        append(text, uv.x);
        append(text, 1 - uv.y);  // OBJ counts v from the bottom
        text += '\n';
        flush(block);
    }
    for (std::size_t c = 0; c < mesh.corner_count() && !as_raw; ++c) {
        if (c % 3 == 0) text += 'f';
        append(text, ' ', mesh.corner_vertices[c] + 1);
        append(text, '/', mesh.uvs[0].indices[c] + 1);
        if (c % 3 == 2) text += '\n';
        flush(block);
    }
    flush(0);
    if (file) good = std::fclose(file) == 0 && good;
    if (!good) {
        std::fprintf(stderr, "generate_torus: cannot write %s\n", argv[2]);
        return 1;
    }
    std::printf("%zu triangles, %zu vertices, %zu UVs\n", mesh.face_count(), mesh.vertex_count(),
                mesh.uvs[0].values.size());
}
