#include "meshprep/output/count_rows.h"

#include "meshprep/output/console.h"

namespace meshprep {

void add_count_rows(std::vector<std::vector<std::string>>& rows, const Counts& before,
                    const Counts& after, const std::vector<std::string>& skip) {
    const auto wanted = [&skip](const std::string& name) {
        for (const std::string& s : skip)
            if (s == name) return false;
        return true;
    };
    const auto cell = [](const std::uint64_t* value) {
        return value ? with_commas(*value) : std::string("–");
    };
    for (const auto& [name, value] : before.figures) {
        const std::uint64_t* to = after.find(name);
        if (!wanted(name) || (value == 0 && (!to || *to == 0))) continue;
        rows.push_back({name, with_commas(value), cell(to)});
    }
    for (const auto& [name, value] : after.figures)
        if (wanted(name) && value > 0 && !before.find(name))
            rows.push_back({name, before.figures.empty() ? "" : "–", with_commas(value)});
}

}  // namespace meshprep
