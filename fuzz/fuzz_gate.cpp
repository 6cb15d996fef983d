// Gates of `meshprep diff`: whatever the text, an error that says what is wrong, or limits and
// sizes in their bounds.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "meshprep/output/gate_json.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto gate =
        meshprep::gate_from(std::string_view(reinterpret_cast<const char*>(data), size));
    if (!gate) {
        if (gate.error().text.empty()) std::abort();
        return 0;
    }
    const auto holds = [](const std::optional<double>& limit) {
        return !limit || (std::isfinite(*limit) && *limit >= 0);
    };
    for (const judge::LimitRow& row : judge::limit_rows)
        if (!holds(gate->limits.*row.limit)) std::abort();
    if (!holds(gate->rmse) || gate->views > 64 || gate->size < 16 || gate->size > 4096)
        std::abort();
    return 0;
}
