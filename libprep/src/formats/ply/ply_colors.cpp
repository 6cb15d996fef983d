#include "formats/ply/ply_colors.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/srgb.h"

namespace prep::detail {
namespace {

constexpr int red = 0, green = 1, blue = 2, alpha = 3;

std::optional<int> channel_of(const std::string& name) {
    static const std::pair<const char*, int> names[] = {{"red", red},
                                                        {"green", green},
                                                        {"blue", blue},
                                                        {"alpha", alpha},
                                                        {"r", red},
                                                        {"g", green},
                                                        {"b", blue},
                                                        {"a", alpha},
                                                        {"diffuse_red", red},
                                                        {"diffuse_green", green},
                                                        {"diffuse_blue", blue}};
    for (const auto& [text, channel] : names)
        if (name == text) return channel;
    return std::nullopt;
}

double largest_of(PlyType type) {
    switch (type) {
        case PlyType::i8:
            return 127;
        case PlyType::u8:
            return 255;
        case PlyType::i16:
            return 32767;
        case PlyType::u16:
            return 65535;
        case PlyType::i32:
            return 2147483647.0;
        case PlyType::u32:
            return 4294967295.0;
        default:
            return 1;
    }
}

float linear_channel(double x, PlyType type) {
    if (!is_integer(type)) return float(x);
    return float(srgb_to_linear(std::clamp(x / largest_of(type), 0.0, 1.0)));
}

}  // namespace

PlyColors::PlyColors(const PlyElement& element) {
    std::array<bool, 4> has{};
    for (const PlyProperty& p : element.properties) {
        channels_.push_back(p.list ? std::nullopt : channel_of(p.name));
        std::optional<int>& channel = channels_.back();
        if (channel && has[*channel]) channel.reset();
        if (!channel) continue;
        has[*channel] = true;
        types_[*channel] = p.type;
    }
    any_ = has[red] && has[green] && has[blue];
    has_alpha_ = has[alpha];
}

glm::vec4 PlyColors::linear(const Row& row) const {
    return {linear_channel(row[red], types_[red]), linear_channel(row[green], types_[green]),
            linear_channel(row[blue], types_[blue]),
            has_alpha_ ? float(row[alpha] / largest_of(types_[alpha])) : 1.0f};
}

}  // namespace prep::detail
