// Cages for tests of subdivision: small ones of our own for every rule, and the shared corpus.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "prep/subdivide.h"
#include "simd_levels.h"
#include "subdivision_oracle.h"

namespace test {

struct Cage {
    std::string name;
    prep::Mesh mesh;
    prep::SubdivideOptions options;  // scheme, boundary rule, creasing, smooth triangles
};

// Smooth, creased (fractional, infinite, darts, crossings, Chaikin's averages), sharp vertices,
// borders under all three rules, n-gons, holes, valences 2 to 64, non-manifold edges and vertices.
std::vector<Cage> own_cages();

// same(first, other): for what one thread makes, and 2, 3 and 8 and each instruction set.
template <class Same>
void expect_same_of_any_threads(const prep::Mesh& mesh, prep::SubdivideOptions options,
                                const Same& same) {
    options.threads = 1;
    const auto first = prep::subdivide(mesh, options);
    ASSERT_TRUE(first) << first.error().text;
    const auto again = [&] {
        const auto other = prep::subdivide(mesh, options);
        ASSERT_TRUE(other) << other.error().text;
        same(first->mesh, other->mesh);
    };
    for (const int threads : {2, 3, 8}) {
        options.threads = threads;
        again();
    }
    options.threads = 2;
    for (const prep::SimdLevel simd : test::every_level()) {
        options.simd = simd;
        again();
    }
}
Cage pole(prep::SubdivisionScheme scheme, std::uint32_t valence);
// A random closed or open surface with random creases and sharp vertices.
Cage random_cage(std::mt19937_64& random);

// Every file of ../shared/corpus/subdiv, by its name's scheme; the tags' rules.
std::vector<std::string> corpus_cage_names(const std::filesystem::path& shared);
Cage corpus_cage(const std::filesystem::path& shared, const std::string& name);

SubdivisionRules rules_of(const Cage& cage);

// Odd multiples of 2^-9, `near` of them within 2^-6 (by the parameters) of an extraordinary vertex,
// the end of a crease, a sharp vertex, a face's middle or a semi-sharp edge.
inline constexpr int location_levels = 9;
std::vector<SubdivisionOracle::Location> random_locations(const Cage& cage,
                                                          const SubdivisionOracle& oracle,
                                                          std::size_t count, std::size_t near,
                                                          std::mt19937_64& random);
// The same place in libprep's words; `scale` is by how much its derivatives differ: those of an
// n-gon's quads are by half.
prep::SurfaceLocation surface_location(const SubdivisionOracle& oracle,
                                       const SubdivisionOracle::Location& at, int levels);
double parameter_scale(const SubdivisionOracle& oracle, std::uint32_t face);

double angle_degrees(const glm::dvec3& a, const glm::dvec3& b);

}  // namespace test
