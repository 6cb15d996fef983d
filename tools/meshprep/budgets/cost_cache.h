// Measured costs that outlast a run: one file in the user's cache directory.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "meshprep/output/report_json.h"
#include "prep/result.h"

namespace meshprep {

// What costs are of: those of another version, build, processor or number of threads are others.
struct CostKey {
    std::string kind;  // "sampling"
    std::string version, build, processor;
    int threads = 0;
};

// $XDG_CACHE_HOME/meshprep/costs.json, or ~/.cache/meshprep/costs.json. None: neither variable
// holds an absolute path, and nothing is kept.
std::optional<std::filesystem::path> cost_cache_file();

// What was kept; none where there is no file, it is of another layout, too large, nested too deeply
// or damaged, or has no such key. What the value holds is for the caller to check.
std::optional<Json> cached_costs(const std::filesystem::path& file, const CostKey& key);

// Beside the 15 others kept last. The file appears complete or not at all; of two processes that
// write at once, one's is lost, and measured again when it is missed. Errors: io, also where
// something other than a regular file is in its place.
prep::Result<void> keep_costs(const std::filesystem::path& file, const CostKey& key,
                              const Json& costs);

}  // namespace meshprep
