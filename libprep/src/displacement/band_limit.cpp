#include "displacement/band_limit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "displacement/height_data.h"

namespace prep::detail {
namespace {

// Both kernels are minimax: among sums of (1 − (r/R)²)^m, m = 2 and up, the ones of the smallest
// largest error over pass and stop bands, by linear programming over their transforms
// (J_{m+1}(κ)/κ^{m+1} in the plane, J_{m+½}(κ)/κ^{m+½} on the line, κ = 2πfR).
constexpr double radius = 4;  // in spacings
constexpr std::array<double, 5> radial_kernel{2.33165, -14.166963, 34.833039, -42.595069,
                                              20.597343};
constexpr double axis_radius = 5;  // in texels of the coarser level
constexpr std::array<double, 7> axis_kernel{-1.254419,  0.691344,    45.127711, -206.815387,
                                            410.556259, -393.704705, 146.399197};

// y² Σ a_m y^m.
template <std::size_t N>
double kernel(const std::array<double, N>& a, double y) {
    double sum = 0;
    for (std::size_t m = N; m-- > 0;) sum = sum * y + a[m];
    return sum * y * y;
}
// Which texels make one of `coarse` texels out of `fine`, with weights that sum to 1.
struct Resampling {
    struct Texel {
        std::int64_t first = 0;
        std::vector<double> weights;
    };
    std::vector<Texel> texels;
    Resampling(std::int64_t fine, std::int64_t coarse) : texels(std::size_t(coarse)) {
        const double ratio = double(fine) / double(coarse);
        for (std::int64_t i = 0; i < coarse; ++i) {
            Texel& texel = texels[std::size_t(i)];
            if (fine == coarse) {
                texel = {i, {1.0}};
                continue;
            }
            const double centre = (double(i) + 0.5) * ratio - 0.5, reach = axis_radius * ratio;
            texel.first = std::int64_t(std::ceil(centre - reach));
            const auto last = std::int64_t(std::floor(centre + reach));
            double sum = 0;
            for (std::int64_t j = texel.first; j <= last; ++j) {
                const double d = (double(j) - centre) / reach;
                texel.weights.push_back(kernel(axis_kernel, 1 - d * d));
                sum += texel.weights.back();
            }
            for (double& w : texel.weights) w /= sum;
        }
    }
};

std::vector<float> along_x(const float* fine, const HeightAxis& axis, std::int64_t height,
                           const Resampling& to, int threads) {
    const std::size_t width = to.texels.size(), from = std::size_t(axis.size);
    std::vector<float> out(width * std::size_t(height));
    parallel_blocks(std::size_t(height), 16, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                const Resampling::Texel& texel = to.texels[x];
                const auto count = std::int64_t(texel.weights.size());
                const float* const row = fine + y * from;
                double sum = 0;
                if (texel.first >= 0 && texel.first + count <= axis.size)
                    for (std::int64_t k = 0; k < count; ++k)
                        sum += texel.weights[std::size_t(k)] * double(row[texel.first + k]);
                else
                    for (std::int64_t k = 0; k < count; ++k)
                        sum += texel.weights[std::size_t(k)] *
                               double(row[axis.texel(texel.first + k)]);
                out[y * width + x] = float(sum);
            }
    });
    return out;
}

std::vector<float> along_y(const std::vector<float>& fine, const HeightAxis& axis,
                           std::size_t width, const Resampling& to, int threads) {
    const std::size_t height = to.texels.size();
    std::vector<float> out(width * height);
    parallel_blocks(height, 16, threads, [&](std::size_t begin, std::size_t end) {
        std::vector<double> sums(width);
        for (std::size_t y = begin; y < end; ++y) {
            const Resampling::Texel& texel = to.texels[y];
            std::fill(sums.begin(), sums.end(), 0.0);
            for (std::size_t k = 0; k < texel.weights.size(); ++k) {
                const float* const row =
                    &fine[std::size_t(axis.texel(texel.first + std::int64_t(k))) * width];
                const double weight = texel.weights[k];
                for (std::size_t x = 0; x < width; ++x) sums[x] += weight * double(row[x]);
            }
            for (std::size_t x = 0; x < width; ++x) out[y * width + x] = float(sums[x]);
        }
    });
    return out;
}

// Texels of a level, or `parts` for each, read between texels, where a level has too few along one
// side: n from i on of row j.
class LevelRows {
  public:
    LevelRows(const HeightMapData& map, const float* raw, std::int64_t width, std::int64_t height,
              const glm::i64vec2& parts)
        : raw_(raw), x_{width, map.x.wrap}, y_{height, map.y.wrap}, parts_(parts) {}

    void read(std::int64_t i, std::int64_t j, std::size_t n, double* out, double* other) const {
        if (parts_.y == 1) return read_row(i, y_.texel(j), n, out);
        const Place place = between(j, parts_.y);
        read_row(i, y_.texel(place.texel), n, out);
        read_row(i, y_.texel(place.texel + 1), n, other);
        for (std::size_t k = 0; k < n; ++k) out[k] += place.part * (other[k] - out[k]);
    }

  private:
    struct Place {
        std::int64_t texel;
        double part;
    };
    static Place between(std::int64_t i, std::int64_t parts) {
        const double at = (double(i) + 0.5) / double(parts) - 0.5, texel = std::floor(at);
        return {std::int64_t(texel), at - texel};
    }
    void read_row(std::int64_t i, std::int64_t j, std::size_t n, double* out) const {
        const float* const row = raw_ + j * x_.size;
        if (parts_.x == 1 && i >= 0 && i + std::int64_t(n) <= x_.size) {
            for (std::size_t k = 0; k < n; ++k) out[k] = double(row[i + std::int64_t(k)]);
            return;
        }
        for (std::size_t k = 0; k < n; ++k, ++i) {
            if (parts_.x == 1) {
                out[k] = double(row[x_.texel(i)]);
                continue;
            }
            const Place place = between(i, parts_.x);
            const double first = double(row[x_.texel(place.texel)]);
            out[k] = first + place.part * (double(row[x_.texel(place.texel + 1)]) - first);
        }
    }

    const float* raw_;
    HeightAxis x_, y_;
    glm::i64vec2 parts_;
};

// The kernel as an ellipse in the map's own UVs: |inverse · d| = spacing · r.
struct Footprint {
    glm::dmat2 matrix{1.0}, inverse{1.0};
};

// A placement that stretches more than this is taken for the larger scale along both axes: the
// ellipse would be arbitrarily long.
constexpr double most_stretch = 4;

bool footprint_of(const glm::dmat2& m, Footprint& out) {
    const double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    const double squares =
        m[0][0] * m[0][0] + m[0][1] * m[0][1] + m[1][0] * m[1][0] + m[1][1] * m[1][1];
    if (!(std::abs(det) > 0) || !std::isfinite(squares)) return false;
    // σ² of larger and smaller: half the squares ± what their difference is.
    const double spread = std::sqrt(std::max(0.0, 0.25 * squares * squares - det * det));
    const double larger = std::sqrt(0.5 * squares + spread), smaller = std::abs(det) / larger;
    out.matrix = larger > most_stretch * smaller ? glm::dmat2(larger) : m;
    out.inverse = glm::inverse(out.matrix);
    return true;
}

// In UVs that are scaled.
Footprint scaled(const Footprint& of, const glm::dvec2& scale) {
    const glm::dmat2 by(scale.x, 0, 0, scale.y);
    return {by * of.matrix, of.inverse * glm::inverse(by)};
}

constexpr double a_texel = 1 - 1e-9;  // a spacing of just one comes with roundings

double filtered_at(const HeightMapData& map, const BandLimits& bands, const glm::dvec2& at,
                   double spacing, const Footprint& footprint, const glm::dvec2& spacings) {
    // The coarsest level with at least a texel a spacing along both sides.
    std::int64_t width = map.x.size, height = map.y.size;
    const float* raw = map.raw.data();
    for (const BandLimits::Level& level : bands.levels) {
        const auto enough = [](double s, std::int64_t size, std::int64_t all) {
            return size == all || s * double(size) >= a_texel;
        };
        if (!enough(spacings.x, level.width, map.x.size) ||
            !enough(spacings.y, level.height, map.y.size))
            break;
        width = level.width;
        height = level.height;
        raw = level.raw.data();
    }
    const auto parts_of = [](double s, std::int64_t size) {
        std::int64_t parts = 1;
        while (size > 1 && parts < 4096 && s * double(size * parts) < a_texel) parts *= 2;
        return parts;
    };
    const glm::i64vec2 parts(parts_of(spacings.x, width), parts_of(spacings.y, height));
    const LevelRows rows(map, raw, width, height, parts);
    const glm::dvec2 texels(double(width * parts.x), double(height * parts.y));

    const glm::dvec2 point =
        (at + 0.5) / glm::dvec2(double(map.x.size), double(map.y.size)) * texels - 0.5;
    // d in texels to the unit disk, and how far the disk reaches in texels.
    const glm::dmat2 to_disk =
        footprint.inverse * glm::dmat2(1 / texels.x, 0, 0, 1 / texels.y) * (1 / (spacing * radius));
    const auto reach = [&](int axis) {
        const glm::dmat2& m = footprint.matrix;
        const double row = std::sqrt(m[0][axis] * m[0][axis] + m[1][axis] * m[1][axis]);
        return radius * spacing * row * texels[axis];
    };
    const double reach_x = reach(0), reach_y = reach(1);
    // An axis of one texel is constant.
    const bool flat_x = map.x.size == 1, flat_y = map.y.size == 1;
    const auto i0 = std::int64_t(std::ceil(flat_x ? 0 : point.x - reach_x));
    const auto i1 = std::int64_t(std::floor(flat_x ? 0 : point.x + reach_x));
    const auto j0 = std::int64_t(std::ceil(flat_y ? 0 : point.y - reach_y));
    const auto j1 = std::int64_t(std::floor(flat_y ? 0 : point.y + reach_y));
    const auto n = std::size_t(i1 - i0 + 1);
    constexpr std::size_t usual = 64;
    std::array<double, 2 * usual> on_stack;
    std::vector<double> on_heap;
    if (n > usual) on_heap.resize(2 * n);
    double* const row = n > usual ? on_heap.data() : on_stack.data();

    const glm::dvec2 a = to_disk[0], b = to_disk[1];
    // About one of the texels: what is level comes out with its own bits.
    double about = 0;
    rows.read(i0, j0, 1, &about, row);
    double weight = 0, sum = 0;
    for (std::int64_t j = j0; j <= j1; ++j) {
        rows.read(i0, j, n, row, row + n);
        const glm::dvec2 across = b * (flat_y ? 0.0 : double(j) - point.y);
        for (std::size_t k = 0; k < n; ++k) {
            const glm::dvec2 d =
                a * (flat_x ? 0.0 : double(i0 + std::int64_t(k)) - point.x) + across;
            const double y = 1 - (d.x * d.x + d.y * d.y);
            if (y <= 0) continue;
            const double w = kernel(radial_kernel, y);
            weight += w;
            sum += w * (row[k] - about);
        }
    }
    return about + sum / weight;
}

// Spacings that samples along the map's own axes would need for the same frequencies, by its UVs.
glm::dvec2 along_axes(const Footprint& footprint, double spacing) {
    const auto along = [&](int axis) {
        const glm::dvec2 column = footprint.inverse[axis];
        return spacing / std::sqrt(column.x * column.x + column.y * column.y);
    };
    return {along(0), along(1)};
}

}  // namespace

BandLimits make_band_limits(const HeightMapData& map, int threads) {
    BandLimits bands;
    HeightAxis x = map.x, y = map.y;
    while (x.size > 1 || y.size > 1) {
        const std::int64_t width = x.size >= 2 * y.size || y.size < 2 * x.size
                                       ? std::max<std::int64_t>(1, x.size / 2)
                                       : x.size;
        const std::int64_t height = y.size >= 2 * x.size || x.size < 2 * y.size
                                        ? std::max<std::int64_t>(1, y.size / 2)
                                        : y.size;
        const float* const fine =
            bands.levels.empty() ? map.raw.data() : bands.levels.back().raw.data();
        const std::vector<float> narrow =
            along_x(fine, x, y.size, Resampling(x.size, width), threads);
        bands.levels.push_back(
            {width, height,
             along_y(narrow, y, std::size_t(width), Resampling(y.size, height), threads)});
        x.size = width;
        y.size = height;
    }
    return bands;
}

glm::dvec2 texels_between(const HeightMapData& map, double spacing) {
    Footprint footprint;
    if (!footprint_of(map.matrix, footprint))
        return glm::dvec2(std::numeric_limits<double>::infinity());
    return along_axes(footprint, spacing) * glm::dvec2(double(map.x.size), double(map.y.size));
}

double band_limited(const HeightMapData& map, const BandLimits& bands, const glm::dvec2& point,
                    double spacing, const glm::dvec2& scale) {
    Footprint footprint;
    if (!footprint_of(map.matrix, footprint)) return raw_value_at(map, point);
    footprint = scaled(footprint, scale);
    const glm::dvec2 spacings = along_axes(footprint, spacing);
    // Nothing of a map that repeats is left by then.
    if (!(spacings.x < 2) && !(spacings.y < 2) && !bands.levels.empty())
        return double(bands.levels.back().raw[0]);
    return filtered_at(map, bands, point, spacing, footprint, spacings);
}

}  // namespace prep::detail
