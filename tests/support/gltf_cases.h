// glTF files that use the format's corners: every component type, sparse data, quantization,
// compression, primitive modes, several sets of everything. Values are random, from a fixed seed.
#pragma once

#include <string>
#include <vector>

#include "gltf_maker.h"

namespace test {

struct GltfCase {
    std::string name;  // "sparse", "draco", …
    GltfMaker maker;
};

std::vector<GltfCase> gltf_cases();

}  // namespace test
