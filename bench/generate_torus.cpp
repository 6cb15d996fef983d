// generate_torus TRIANGLES OUT.obj: writes the bumpy torus (torus.h) as OBJ with UVs, the same
// bytes every time. Up to 16 million triangles.
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string>

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

}  // namespace

int main(int argc, char** argv) {
    const unsigned long long triangles = argc == 3 ? std::strtoull(argv[1], nullptr, 10) : 0;
    if (triangles < 18 || triangles > 16'000'000) {
        std::fprintf(stderr, "usage: generate_torus TRIANGLES OUT.obj   (18 to 16000000)\n");
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
    if (file) good = std::fclose(file) == 0 && good;
    if (!good) {
        std::fprintf(stderr, "generate_torus: cannot write %s\n", argv[2]);
        return 1;
    }
    std::printf("%zu triangles, %zu vertices, %zu UVs\n", mesh.face_count(), mesh.vertex_count(),
                mesh.uvs[0].values.size());
}
