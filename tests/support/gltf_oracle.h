// What other programs say of glTF files: what @gltf-transform/core reads in them, by
// tests/tools/decode_gltf.mjs, and the complaints of the format's validator, by validate_gltf.mjs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace test {

// One file. `json` is as decode_gltf.mjs describes it at its head; {"error": …} where the program
// cannot read the file.
struct DecodedGltf {
    nlohmann::json json;
    std::string data;  // the long lists

    // The numbers of an ARRAY, element after element; none for null.
    std::vector<double> numbers(const nlohmann::json& array) const;
};

// All files in one run of node (about 0.2 s to start). `folder` takes the scratch files.
// None, with a failure of the test, where the script itself fails.
std::optional<std::vector<DecodedGltf>> decode_gltf(const std::filesystem::path& node_modules,
                                                    const std::vector<std::filesystem::path>& files,
                                                    const std::filesystem::path& folder);

// Whether the format's validator (its package in `validator`) finds no error in files: `list` is as
// validate_gltf.mjs reads it, and goes to `list_file`. Complaints go to standard output.
bool validates(const std::filesystem::path& validator, const nlohmann::json& list,
               const std::filesystem::path& list_file);

// FNV-1a of 32 bits: the "hash" of an image.
std::uint32_t fnv1a(std::span<const std::byte> bytes);

}  // namespace test

// The folder that decode_gltf() wants; skips the test where a package is missing.
#define MESHPREP_REQUIRE_GLTF_TRANSFORM(variable)                              \
    MESHPREP_REQUIRE_NPM(variable##_core, "@gltf-transform/core");             \
    MESHPREP_REQUIRE_NPM(variable##_extensions, "@gltf-transform/extensions"); \
    MESHPREP_REQUIRE_NPM(variable##_meshopt, "meshoptimizer");                 \
    MESHPREP_REQUIRE_NPM(variable##_draco, "draco3dgltf");                     \
    const std::filesystem::path variable = variable##_core.parent_path().parent_path()
