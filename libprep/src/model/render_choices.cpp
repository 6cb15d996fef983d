#include "prep/render_choices.h"

#include <charconv>
#include <type_traits>

#include "base/srgb.h"

namespace prep {

RenderChoices with_wishes(RenderChoices choices, const RenderWishes& wishes) {
    const auto copy = [&](auto member) { choices.*member = wishes.choices.*member; };
    for_each_render_choice([&](std::string_view key, auto member, const auto& values, const char*) {
        if (!wishes.has(key)) return;
        if constexpr (std::is_same_v<std::decay_t<decltype(values)>, Pixels>) {
            copy(member.first);
            copy(member.second);
        } else {
            copy(member);
        }
    });
    return choices;
}

std::optional<glm::vec3> color_from_hex(std::string_view text) {
    if (text.size() != 7 || text[0] != '#') return {};
    glm::vec3 color{0.0f};
    for (int c = 0; c < 3; ++c) {
        const char* const digits = text.data() + 1 + 2 * c;
        unsigned level = 0;
        const auto [end, problem] = std::from_chars(digits, digits + 2, level, 16);
        if (problem != std::errc() || end != digits + 2) return {};
        color[c] = static_cast<float>(detail::srgb_to_linear(level / 255.0));
    }
    return color;
}

}  // namespace prep
