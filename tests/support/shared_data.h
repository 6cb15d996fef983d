// Finds the shared test data (meshes, golden results) beside the project's root. Tests that use it
// skip, saying so, when it is absent.
#pragma once

#include <filesystem>
#include <optional>

namespace test {

// ../shared beside the project's root, or the folder in the environment variable MESHPREP_SHARED.
std::optional<std::filesystem::path> shared_dir();

std::filesystem::path source_dir();

}  // namespace test

#define MESHPREP_REQUIRE_SHARED(variable)                                                     \
    const auto variable##_found = ::test::shared_dir();                                       \
    if (!variable##_found) GTEST_SKIP() << "the shared test data (../shared) is not present"; \
    const std::filesystem::path variable = *variable##_found
