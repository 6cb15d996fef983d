// The subcommands, each defined in a file of its own.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "meshprep/options/shared_options.h"
#include "meshprep/output/console.h"

namespace meshprep {

struct Subcommand {
    std::string name, summary;
    std::function<void(OptionSet&)> define;
    std::function<void()> check;       // what single options cannot see; ends in a usage error
    std::function<int(Console&)> run;  // does the work, says its results, returns the exit code
};

// In the order of help and of the README's table.
std::vector<Subcommand> subcommands();

// A subcommand whose options are read into a struct of its own.
template <class Options>
Subcommand subcommand(std::string name, std::string summary, void (*define)(OptionSet&, Options&),
                      int (*run)(const Options&, Console&),
                      void (*check)(const Options&) = nullptr) {
    const auto options = std::make_shared<Options>();
    return {std::move(name), std::move(summary), [=](OptionSet& set) { define(set, *options); },
            [=] {
                if (check != nullptr) check(*options);
            },
            [=](Console& console) { return run(*options, console); }};
}

}  // namespace meshprep
