#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "prep/tangent_conventions.h"

namespace prep {
namespace {

constexpr std::uint64_t fewest_texels = 64;
// The maps in use that docs/tangents.md lists reach −0.72 to 0.94; those known to point the other
// way at some sizes stay within it.
constexpr double least_correlation = 0.3;
// Of slopes over two texels: one step of 8 bits is 0.008, less is rounding.
constexpr double least_curvature = 0.02;
// Slopes beyond this are mostly filling and seams: they would drown everything else.
constexpr float steepest = 4.0f;

// Three floats a texel, −1 … 1.
struct Normals {
    std::uint32_t width = 0, height = 0;
    std::vector<glm::vec3> texels;
    const glm::vec3& at(std::uint32_t x, std::uint32_t y) const {
        return texels[std::size_t(y) * width + x];
    }
};

Normals read_normals(const Image& map) {
    Normals out{map.width, map.height, {}};
    out.texels.reserve(std::size_t(map.width) * map.height);
    for (std::size_t i = 0; i < std::size_t(map.width) * map.height; ++i) {
        const float* texel = map.pixels.data() + i * map.channels;
        out.texels.emplace_back(2 * texel[0] - 1, 2 * texel[1] - 1, 2 * texel[2] - 1);
    }
    return out;
}

Normals halved(const Normals& in) {
    Normals out{in.width / 2, in.height / 2, {}};
    out.texels.reserve(std::size_t(out.width) * out.height);
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x)
            out.texels.push_back(0.25f * (in.at(2 * x, 2 * y) + in.at(2 * x + 1, 2 * y) +
                                          in.at(2 * x, 2 * y + 1) + in.at(2 * x + 1, 2 * y + 1)));
    return out;
}

bool gentle(const glm::vec3& n) {
    return n.z > 0 && std::abs(n.x) < steepest * n.z && std::abs(n.y) < steepest * n.z;
}

// Of dp/dy and dq/dx over all texels where either is more than rounding; and how many those are.
std::pair<double, std::uint64_t> curl_correlation(const Normals& map) {
    double both = 0, first = 0, second = 0;
    std::uint64_t texels = 0;
    for (std::uint32_t y = 1; y + 1 < map.height; ++y) {
        for (std::uint32_t x = 1; x + 1 < map.width; ++x) {
            const glm::vec3 &above = map.at(x, y - 1), &below = map.at(x, y + 1);
            const glm::vec3 &left = map.at(x - 1, y), &right = map.at(x + 1, y);
            if (!gentle(above) || !gentle(below) || !gentle(left) || !gentle(right)) continue;
            const double p_by_y = double(below.x / below.z) - double(above.x / above.z);
            const double q_by_x = double(left.y / left.z) - double(right.y / right.z);
            if (std::abs(p_by_y) + std::abs(q_by_x) < least_curvature) continue;
            both += p_by_y * q_by_x;
            first += p_by_y * p_by_y;
            second += q_by_x * q_by_x;
            ++texels;
        }
    }
    if (texels < fewest_texels || !(first > 0) || !(second > 0)) return {0, 0};
    return {both / std::sqrt(first * second), texels};
}

}  // namespace

GreenChannel green_channel(const Image& map) {
    GreenChannel out;
    if (map.channels < 3) return out;
    Normals normals = read_normals(map);
    std::size_t counted = 0;
    double sum = 0;
    for (std::size_t s = 0; s < GreenChannel::scales; ++s) {
        const auto [correlation, texels] = curl_correlation(normals);
        out.correlations[s] = correlation;
        out.texels[s] = texels;
        if (texels > 0) {
            sum += correlation;
            ++counted;
        }
        normals = halved(normals);
    }
    if (counted == 0) return out;
    out.correlation = sum / double(counted);
    const auto [low, high] = std::minmax_element(out.correlations.begin(), out.correlations.end());
    if (out.correlation >= least_correlation && *low > -least_correlation)
        out.direction = GreenDirection::up;
    if (out.correlation <= -least_correlation && *high < least_correlation)
        out.direction = GreenDirection::down;
    return out;
}

}  // namespace prep
