#include "corner_soup.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>
#include <utility>

namespace test {
namespace {

template <class T>
bool read(std::ifstream& in, T* to, std::size_t count) {
    in.read(reinterpret_cast<char*>(to), std::streamsize(sizeof(T) * count));
    return in.good();
}

template <class T>
void share(const std::vector<T>& from, std::vector<T>& values, std::vector<std::uint32_t>& to) {
    constexpr std::size_t words = sizeof(T) / 4;
    std::map<std::array<std::uint32_t, words>, std::uint32_t> known;
    for (const T& value : from) {
        std::array<std::uint32_t, words> key;
        std::memcpy(key.data(), &value, sizeof value);
        const auto [at, added] = known.emplace(key, std::uint32_t(values.size()));
        if (added) values.push_back(value);
        to.push_back(at->second);
    }
}

}  // namespace

void CornerSoup::add(const glm::vec3& position, const glm::vec3& normal, const glm::vec2& uv) {
    identity.push_back(std::uint32_t(positions.size()));
    positions.push_back(position);
    normals.push_back(normal);
    uvs.push_back(uv);
}

prep::TangentInput CornerSoup::input() const {
    prep::TangentInput in;
    in.positions = positions;
    in.face_offsets = offsets;
    in.corner_vertices = identity;
    in.normals = {normals, identity};
    in.uv = {uvs, identity};
    return in;
}

prep::TangentInput IndexedSoup::input() const {
    prep::TangentInput in;
    in.positions = positions;
    in.face_offsets = offsets;
    in.corner_vertices = vertices;
    in.normals = {normals, normal_indices};
    in.uv = {uvs, uv_indices};
    return in;
}

std::optional<CornerSoup> read_mkt(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    char magic[4];
    std::uint32_t faces = 0, corners = 0;
    if (!read(in, magic, 4) || std::memcmp(magic, "MKT1", 4) != 0 || !read(in, &faces, 1) ||
        !read(in, &corners, 1))
        return std::nullopt;
    std::vector<std::uint8_t> sizes(faces);
    if (!read(in, sizes.data(), faces)) return std::nullopt;
    CornerSoup soup;
    for (const std::uint8_t k : sizes) soup.offsets.push_back(soup.offsets.back() + k);
    soup.positions.resize(corners);
    soup.normals.resize(corners);
    soup.uvs.resize(corners);
    soup.identity.resize(corners);
    std::iota(soup.identity.begin(), soup.identity.end(), 0u);
    if (soup.offsets.back() != corners || !read(in, soup.positions.data(), corners) ||
        !read(in, soup.normals.data(), corners) || !read(in, soup.uvs.data(), corners))
        return std::nullopt;
    return soup;
}

std::optional<std::vector<glm::vec4>> read_tan(const std::filesystem::path& path,
                                               std::size_t corners) {
    std::vector<glm::vec4> tangents(corners);
    std::ifstream in(path, std::ios::binary);
    if (!read(in, tangents.data(), corners)) return std::nullopt;
    return tangents;
}

CornerSoup hostile_soup(std::mt19937& random, const HostileOptions& options) {
    // Braces, not parentheses: numbers are drawn from left to right, whatever the compiler.
    const auto below = [&](int n) { return int(random() % std::uint32_t(n)); };
    const float scale = options.odd_scales ? std::ldexp(1.0f, below(160) - 80) : 1.0f;
    const float uv_scale = options.odd_scales ? std::ldexp(1.0f, below(160) - 80) : 0.25f;
    const auto coordinate = [&] {
        const int x = below(5) - 2;
        if (x == 0 && options.minus_zeros && below(2)) return -0.0f;
        if (options.nans && below(60) == 0) return std::numeric_limits<float>::quiet_NaN();
        return float(x);
    };
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    for (int i = 4 + below(options.crowded ? 2 : 8); i > 0; --i) {
        glm::vec3 p{coordinate(), coordinate(), coordinate()};
        if (below(4) == 0) p += glm::vec3(1e-3f * float(below(9)), 0.37f, 0.11f);
        positions.push_back(scale * p);
    }
    for (int i = options.crowded ? 1 : 1 + below(3); i > 0; --i) {
        const glm::vec3 n{coordinate(), coordinate(), coordinate()};
        const float length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        normals.push_back(length > 0 && below(5) != 0 ? n / length : n);
    }
    for (int i = options.crowded ? 3 : 2 + below(6); i > 0; --i)
        uvs.push_back(uv_scale * glm::vec2{coordinate(), coordinate()});
    const auto any_of = [&](const auto& list) -> const auto& {
        return list[std::size_t(below(int(list.size())))];
    };
    CornerSoup soup;
    for (int faces = options.crowded ? 100 + below(150) : 1 + below(40); faces > 0; --faces) {
        const int corners = options.quads && below(2) ? 4 : 3;
        for (int k = 0; k < corners; ++k) {
            const glm::vec3 &p = any_of(positions), &n = any_of(normals);
            const glm::vec2& t = any_of(uvs);
            soup.add(p, n,
                     options.seamless ? uvs[std::size_t(&p - &positions[0]) % uvs.size()] : t);
        }
        soup.end_face();
    }
    return soup;
}

CornerSoup seamed_surface(std::mt19937& random) {
    const auto below = [&](std::uint32_t n) { return std::uint32_t(random() % n); };
    const std::uint32_t columns = 2 + below(5), rows = 2 + below(5), stride = columns + 1;
    std::vector<glm::vec3> positions, normals;
    for (std::uint32_t y = 0; y <= rows; ++y) {
        for (std::uint32_t x = 0; x <= columns; ++x) {
            // Braces: from left to right, whatever the compiler.
            positions.push_back(glm::vec3{float(x) + 0.04f * float(below(9)),
                                          float(y) + 0.04f * float(below(9)),
                                          0.1f * float(below(8))});
            const glm::vec3 n{0.05f * float(below(9)) - 0.2f, 0.05f * float(below(9)) - 0.2f, 1.0f};
            normals.push_back(n * (1.0f / std::sqrt(n.x * n.x + n.y * n.y + 1.0f)));
        }
    }
    if (below(3) == 0) positions[below(std::uint32_t(positions.size()))] = positions[0];
    if (below(3) == 0)
        positions[positions.size() - 1 - below(stride)] = positions[1 + below(stride)];
    const std::uint32_t island_size = 1 + below(9), hard_every = 1 + below(8);
    const bool shuffled = below(4) == 0, wheel = below(5) == 0;
    struct Triangle {
        std::uint32_t v[3], island;
    };
    std::vector<Triangle> triangles;
    for (std::uint32_t y = 0; y < rows; ++y) {
        for (std::uint32_t x = 0; x < columns; ++x) {
            const std::uint32_t a = y * stride + x, b = a + 1, c = a + stride, d = c + 1;
            const std::uint32_t island = (x / island_size) + 3 * (y / island_size);
            const bool other = below(2) == 0;
            triangles.push_back({{a, b, other ? c : d}, island});
            triangles.push_back({{other ? b : a, d, c}, island + (below(6) == 0)});
        }
    }
    // All around the first vertex, once more.
    for (std::uint32_t k = 1; wheel && k < 11; ++k)
        triangles.push_back({{0, k % stride + stride, (k + 1) % stride + stride}, k / 6});
    for (std::size_t i = triangles.size(); shuffled && i-- > 1;)
        std::swap(triangles[i], triangles[below(std::uint32_t(i + 1))]);
    CornerSoup soup;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (below(12) == 0) continue;
        const auto& [v, island] = triangles[t];
        const bool own_normal = below(8) >= hard_every;
        for (const std::uint32_t i : v) {
            const glm::vec3& p = positions[i];
            glm::vec2 uv(p.x + 0.25f * p.z, p.y);
            if (island % 3 == 1) uv.x = 9 - uv.x;  // mirrored
            if (island % 4 == 2) uv = {uv.y, uv.x};
            if (island % 5 == 4) uv = {0.5f, uv.y};  // says nothing
            soup.add(p, own_normal ? normals[t % normals.size()] : normals[i], uv);
        }
        soup.end_face();
    }
    return soup;
}

std::vector<NamedSoup> recorded_soups() {
    std::vector<NamedSoup> result;
    for (std::uint32_t seed = 0; seed < 1000; ++seed) {
        std::mt19937 random(seed);
        HostileOptions hostile;
        hostile.minus_zeros = seed & 1;
        hostile.nans = seed & 2;
        hostile.odd_scales = seed & 4;
        result.push_back({"hostile-" + std::to_string(seed), hostile_soup(random, hostile)});
    }
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        std::mt19937 random(seed);
        HostileOptions crowded;
        crowded.minus_zeros = seed & 1;
        crowded.crowded = true;
        crowded.seamless = seed & 2;
        result.push_back({"crowd-" + std::to_string(seed), hostile_soup(random, crowded)});
    }
    for (std::uint32_t seed = 0; seed < 400; ++seed) {
        std::mt19937 random(seed);
        result.push_back({"surface-" + std::to_string(seed), seamed_surface(random)});
    }
    return result;
}

std::uint64_t hash_of(const std::vector<glm::vec4>& tangents) {
    std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
    for (const glm::vec4& t : tangents) {
        for (int k = 0; k < 4; ++k) {
            const auto bits = std::isnan(t[k]) ? 0x7fc00000u : std::bit_cast<std::uint32_t>(t[k]);
            for (int shift = 0; shift < 32; shift += 8)
                hash = (hash ^ (bits >> shift & 0xffu)) * 0x100000001b3u;
        }
    }
    return hash;
}

IndexedSoup share_values(const CornerSoup& soup) {
    IndexedSoup result;
    result.offsets = soup.offsets;
    share(soup.positions, result.positions, result.vertices);
    share(soup.normals, result.normals, result.normal_indices);
    share(soup.uvs, result.uvs, result.uv_indices);
    return result;
}

std::vector<glm::vec4> flattened(const prep::CornerTangents& tangents) {
    std::vector<glm::vec4> result;
    result.reserve(tangents.tangents.indices.size());
    for (const std::uint32_t i : tangents.tangents.indices)
        result.push_back(tangents.tangents.values[i]);
    return result;
}

}  // namespace test
