// Corner soups for the tangent tests: faces of three or four corners, nothing shared by index.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "prep/tangents.h"

namespace test {

struct CornerSoup {
    std::vector<glm::vec3> positions, normals;  // one per corner
    std::vector<glm::vec2> uvs;
    std::vector<std::uint32_t> offsets{0}, identity;

    std::size_t corners() const { return positions.size(); }
    void add(const glm::vec3& position, const glm::vec3& normal, const glm::vec2& uv);
    void end_face() { offsets.push_back(std::uint32_t(positions.size())); }
    // Valid as long as the soup is not changed.
    prep::TangentInput input() const;
};

// The formats of ../shared/golden (its README). None where the file is short.
std::optional<CornerSoup> read_mkt(const std::filesystem::path& path);
std::optional<std::vector<glm::vec4>> read_tan(const std::filesystem::path& path,
                                               std::size_t corners);

struct HostileOptions {
    bool quads = false;
    bool minus_zeros = false;
    bool nans = false;
    bool odd_scales = false;
    bool crowded = false;   // dozens of triangles at each vertex
    bool seamless = false;  // each position has one UV
};
// Few distinct positions, normals and UVs, so that much is shared, degenerate, repeated, mirrored
// or non-manifold.
CornerSoup hostile_soup(std::mt19937& random, const HostileOptions& options);

// A bent patch of triangles with what modelled meshes have: UV islands, some mirrored, hard edges,
// pinched vertices, a missing triangle here and there, vertices of three to a dozen triangles.
CornerSoup seamed_surface(std::mt19937& random);

// The soups whose tangents by the C reference are recorded in tests/prep/tangents_reference.txt, a
// line each: name and hash_of() them, or "crash". TangentsNpm holds the record against the package.
struct NamedSoup {
    std::string name;
    CornerSoup soup;
};
std::vector<NamedSoup> recorded_soups();

// Of the bits of all tangents; NaN is one value, whatever its bits.
std::uint64_t hash_of(const std::vector<glm::vec4>& tangents);

// The same corners with shared values: each distinct position, normal and UV (by bits) once, in
// order of appearance.
struct IndexedSoup {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<std::uint32_t> offsets{0}, vertices, normal_indices, uv_indices;

    void end_face() { offsets.push_back(std::uint32_t(vertices.size())); }
    prep::TangentInput input() const;
};
IndexedSoup share_values(const CornerSoup& soup);

// Every corner's tangent, w included.
std::vector<glm::vec4> flattened(const prep::CornerTangents& tangents);

}  // namespace test
