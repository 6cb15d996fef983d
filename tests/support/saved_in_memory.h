// save_glb() beside save_scene(): one encoding, with and without a file.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mesh_files.h"
#include "prep/save.h"

namespace test {

// The file that was written and what it notes, once more without a file.
inline void expect_same_in_memory(const prep::PreparedScene& prepared,
                                  const prep::SaveOptions& options,
                                  const std::filesystem::path& file,
                                  const std::vector<std::string>& notes) {
    const auto glb = prep::save_glb(prepared, options);
    ASSERT_TRUE(glb) << prep::to_string(glb.error());
    const std::string text = file_text(file);
    const auto bytes = std::as_bytes(std::span(text));
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), glb->bytes.begin(), glb->bytes.end()));
    EXPECT_EQ(glb->notes, notes);
}

}  // namespace test
