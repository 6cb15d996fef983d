#include "cost/measure/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace cost {
namespace {

constexpr double pi = std::numbers::pi;
using Plane = std::vector<double>;
using Colour = std::array<double, 3>;

// Linear Rec. 709 to XYZ, as fractions of the primaries' chromaticities (IEC 61966-2-1).
constexpr double to_xyz[3][3] = {
    {10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0},
    {2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0},
    {1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0}};

Colour xyz_of(const Colour& rgb) {
    Colour out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) out[i] += to_xyz[i][j] * rgb[j];
    return out;
}

// By Cramer's rule.
Colour rgb_of(const Colour& xyz) {
    const auto& m = to_xyz;
    const auto det = [](const double a[3][3]) {
        return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
               a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
               a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    };
    const double whole = det(m);
    Colour out{};
    for (std::size_t c = 0; c < 3; ++c) {
        double a[3][3];
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) a[i][j] = j == c ? xyz[i] : m[i][j];
        out[c] = det(a) / whole;
    }
    return out;
}

const Colour& white() {
    static const Colour w = xyz_of({1, 1, 1});
    return w;
}

double decoded(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

// Sec. 3.1: the linear opponent space YCxCz.
Colour opponent(const Colour& xyz) {
    const double x = xyz[0] / white()[0], y = xyz[1] / white()[1], z = xyz[2] / white()[2];
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}
Colour from_opponent(const Colour& c) {
    const double y = (c[0] + 16) / 116;
    const double x = c[1] / 500 + y, z = y - c[2] / 200;
    return {x * white()[0], y * white()[1], z * white()[2]};
}

// CIELAB, its chroma scaled by lightness (Hunt's effect, eq. 3).
Colour hunt_lab(const Colour& xyz) {
    const auto f = [](double t) {
        constexpr double d = 6.0 / 29.0;
        return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0 / 29.0;
    };
    const double x = f(xyz[0] / white()[0]), y = f(xyz[1] / white()[1]), z = f(xyz[2] / white()[2]);
    const double l = 116 * y - 16;
    return {l, 0.01 * l * 500 * (x - y), 0.01 * l * 200 * (y - z)};
}
double hyab(const Colour& a, const Colour& b) {  // eq. 4
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

struct Grid {
    std::int64_t width, height;
};

// One line filter after the other; beyond the picture its border pixels go on.
Plane filtered(const Plane& in, const Grid& g, const Plane& along_x, const Plane& along_y) {
    const auto pass = [&](const Plane& from, const Plane& kernel, bool x_axis) {
        const std::int64_t r = std::int64_t(kernel.size() / 2);
        Plane to(from.size());
        for (std::int64_t y = 0; y < g.height; ++y) {
            for (std::int64_t x = 0; x < g.width; ++x) {
                double sum = 0;
                for (std::int64_t k = -r; k <= r; ++k) {
                    const std::int64_t u =
                        x_axis ? std::clamp<std::int64_t>(x + k, 0, g.width - 1) : x;
                    const std::int64_t v =
                        x_axis ? y : std::clamp<std::int64_t>(y + k, 0, g.height - 1);
                    sum += kernel[std::size_t(k + r)] * from[std::size_t(v * g.width + u)];
                }
                to[std::size_t(y * g.width + x)] = sum;
            }
        }
        return to;
    };
    return pass(pass(in, along_x, true), along_y, false);
}

// Sec. 3.1, eq. 1 and table 1: contrast sensitivity as a sum of Gaussians a·√(π/b)·exp(−π²x²/b),
// x in degrees.
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr Sensitivity sensitivities[3] = {
    {1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};

Plane sensitivity_filtered(const Plane& in, const Grid& g, const Sensitivity& s, double ppd) {
    const std::int64_t r =
        std::int64_t(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * ppd));  // the widest, eq. 2
    const auto line = [&](double b) {
        Plane k;
        for (std::int64_t i = -r; i <= r; ++i) {
            const double x = double(i) / ppd;
            k.push_back(std::exp(-pi * pi * x * x / b));
        }
        return k;
    };
    const Plane k1 = line(s.b1), k2 = line(s.b2);
    const auto total = [](const Plane& k) {
        double sum = 0;
        for (const double v : k) sum += v;
        return sum * sum;
    };
    const double w1 = s.a1 * std::sqrt(pi / s.b1), w2 = s.a2 * std::sqrt(pi / s.b2);
    const double whole = w1 * total(k1) + w2 * total(k2);
    Plane out = filtered(in, g, k1, k1);
    for (double& v : out) v *= w1 / whole;
    if (w2 > 0) {
        const Plane second = filtered(in, g, k2, k2);
        for (std::size_t i = 0; i < out.size(); ++i) out[i] += w2 / whole * second[i];
    }
    return out;
}

// Sec. 3.3: first (edges) or second (points) derivatives of a Gaussian as wide as the eye's feature
// detectors, positive and negative weights adding up to 1 and −1; their length.
Plane features(const Plane& luminance, const Grid& g, double ppd, bool points) {
    const double sigma = 0.5 * 0.082 * ppd;
    const std::int64_t r = std::int64_t(std::ceil(3 * sigma));
    Plane smooth, slope;
    double whole = 0, positive = 0, negative = 0;
    for (std::int64_t i = -r; i <= r; ++i) {
        const double x = double(i), e = std::exp(-x * x / (2 * sigma * sigma));
        smooth.push_back(e);
        whole += e;
        slope.push_back(points ? (x * x / (sigma * sigma) - 1) * e : -x * e);
        (slope.back() > 0 ? positive : negative) += std::abs(slope.back());
    }
    for (double& v : smooth) v /= whole;
    for (double& v : slope) v /= v > 0 ? positive : negative;
    const Plane x = filtered(luminance, g, slope, smooth),
                y = filtered(luminance, g, smooth, slope);
    Plane out(x.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::hypot(x[i], y[i]);
    return out;
}

struct Seen {
    std::vector<Colour> colours;
    Plane edges, points;
};

Seen seen(const Pixels& picture, double ppd) {
    const Grid g{picture.width, picture.height};
    const std::size_t n = std::size_t(picture.width) * picture.height;
    std::array<Plane, 3> planes;
    for (std::size_t i = 0; i < n; ++i) {
        const double* const p = &picture.values[3 * i];
        const Colour c = opponent(xyz_of({decoded(p[0]), decoded(p[1]), decoded(p[2])}));
        for (std::size_t k = 0; k < 3; ++k) planes[k].push_back(c[k]);
    }
    Plane luminance = planes[0];
    for (double& y : luminance) y = (y + 16) / 116;
    Seen s;
    s.edges = features(luminance, g, ppd, false);
    s.points = features(luminance, g, ppd, true);
    for (std::size_t k = 0; k < 3; ++k)
        planes[k] = sensitivity_filtered(planes[k], g, sensitivities[k], ppd);
    for (std::size_t i = 0; i < n; ++i) {
        Colour rgb = rgb_of(from_opponent({planes[0][i], planes[1][i], planes[2][i]}));
        for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
        s.colours.push_back(hunt_lab(xyz_of(rgb)));
    }
    return s;
}

}  // namespace

Flip flip(const Pixels& reference, const Pixels& test, double ppd) {
    const Seen a = seen(reference, ppd), b = seen(test, ppd);
    // Sec. 3.2, eq. 5: the largest difference there is maps to 1, pc of it to pt.
    constexpr double qc = 0.7, pc = 0.4, pt = 0.95, qf = 0.5;
    const double most =
        std::pow(hyab(hunt_lab(xyz_of({0, 1, 0})), hunt_lab(xyz_of({0, 0, 1}))), qc);
    const double knee = pc * most;
    Flip out;
    double sum = 0;
    for (std::size_t i = 0; i < a.colours.size(); ++i) {
        const double d = std::pow(hyab(a.colours[i], b.colours[i]), qc);
        const double colour = d < knee ? pt / knee * d : pt + (d - knee) / (most - knee) * (1 - pt);
        const double feature = std::pow(
            std::max(std::abs(a.edges[i] - b.edges[i]), std::abs(a.points[i] - b.points[i])) /
                std::numbers::sqrt2,
            qf);                                         // eq. 6
        const double e = std::pow(colour, 1 - feature);  // eq. 7
        out.errors.push_back(e);
        out.largest = std::max(out.largest, e);
        sum += e;
    }
    if (!out.errors.empty()) out.mean = sum / double(out.errors.size());
    return out;
}

Pixels srgb_encoded(const Pixels& linear) {
    Pixels out = linear;
    for (double& v : out.values) {
        const double x = std::clamp(v, 0.0, 1.0);
        v = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    }
    return out;
}

}  // namespace cost
