// What Assimp 5.2 loses of a 3MF file without a word: it reads one model part of the package,
// passes over items and components that name no object of that part, and asks for no extension.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/assimp/threemf/package_parts.h"
#include "prep/result.h"

namespace prep::detail {

// Sentences for warnings on a model part (XML in UTF-8), `part` its name. Error: unsupported, where
// it requires an extension that is not read. Supported are the core and, with remarks elsewhere on
// what of it is not read, materials; triangle sets, which change no shape; and production, as long
// as all objects are in this part. O(text).
Result<std::vector<std::string>> review_model(std::string_view xml, const std::string& part,
                                              const std::string& place);

struct PackageReview {
    PackageParts parts;  // none where the file is no package that can be looked through
    std::vector<std::string> warnings;
};

// The same of the part that a package's relationships call its model. A file that is no package, or
// whose list of parts is damaged, is Assimp's to refuse, and a warning if it does not. Errors:
// those of review_model(), of the parts that it reads (PackageParts::unpack()), io, and invalid
// where the package names no model.
Result<PackageReview> review_package(const std::filesystem::path& path);

}  // namespace prep::detail
