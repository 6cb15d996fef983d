#include "meshprep/output/version_text.h"

#include <fmt/format.h>

#include <CLI/Version.hpp>

#include "prep/version.h"

namespace meshprep {

std::string version_text() {
    std::vector<prep::Dependency> all = prep::dependencies();
    all.push_back(
        {"CLI11",
         fmt::format("{}.{}.{}", CLI11_VERSION_MAJOR, CLI11_VERSION_MINOR, CLI11_VERSION_PATCH),
         "BSD-3-Clause"});
    all.push_back(
        {"{fmt}",
         fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100),
         "MIT with an exception for binaries"});
    std::string text = fmt::format("meshprep {}\nApache-2.0. Built on:\n", prep::version());
    for (const prep::Dependency& d : all)
        text += fmt::format("  {:<14} {:<10} {}\n", d.name, d.version, d.licence);
    text += "Each keeps its own licence; the file NOTICE tells more.";
    return text;
}

}  // namespace meshprep
