#include "corner_soup.h"

#include <array>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>

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
    for (int i = 4 + below(8); i > 0; --i) {
        glm::vec3 p(coordinate(), coordinate(), coordinate());
        if (below(4) == 0) p += glm::vec3(1e-3f * float(below(9)), 0.37f, 0.11f);
        positions.push_back(scale * p);
    }
    for (int i = 1 + below(3); i > 0; --i) {
        const glm::vec3 n(coordinate(), coordinate(), coordinate());
        const float length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        normals.push_back(length > 0 && below(5) != 0 ? n / length : n);
    }
    for (int i = 2 + below(6); i > 0; --i)
        uvs.push_back(uv_scale * glm::vec2(coordinate(), coordinate()));
    CornerSoup soup;
    for (int faces = 1 + below(40); faces > 0; --faces) {
        const int corners = options.quads && below(2) ? 4 : 3;
        for (int k = 0; k < corners; ++k) {
            soup.add(positions[std::size_t(below(int(positions.size())))],
                     normals[std::size_t(below(int(normals.size())))],
                     uvs[std::size_t(below(int(uvs.size())))]);
        }
        soup.end_face();
    }
    return soup;
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
