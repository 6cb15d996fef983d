// Finds the npm packages that judge our outputs (scripts/npm-tools fetches them). Tests that use
// one skip, saying so, when it is absent.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace test {

// The folder of an npm package, such as "gltf-validator": in build/npm-tools/node_modules under the
// project's root, or in the folder that the environment variable MESHPREP_NPM_TOOLS names.
// None where the package or node itself is missing.
std::optional<std::filesystem::path> npm_package(const std::string& name);

}  // namespace test

#define MESHPREP_REQUIRE_NPM(variable, package)                    \
    const auto variable##_found = ::test::npm_package(package);    \
    if (!variable##_found)                                         \
        GTEST_SKIP() << "node or its package " << package          \
                     << " is not present (run scripts/npm-tools)"; \
    const std::filesystem::path variable = *variable##_found
