#include "cost/oracles/surfaces.h"

#include <array>
#include <cmath>
#include <numbers>

namespace cost {
namespace {

constexpr Real pi = std::numbers::pi_v<Real>;

Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct Basis {
    std::array<Real, 4> value, slope;
};
Basis cubic_basis(Real t) {
    const Real s = 1 - t;
    return {{s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
             (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6},
            {-s * s / 2, (9 * t * t - 12 * t) / 6, (-9 * t * t + 6 * t + 3) / 6, t * t / 2}};
}

}  // namespace

SurfaceSample torus_at(Real u, Real v, Real major, Real minor) {
    const Real a = 2 * pi * u, b = 2 * pi * v;
    const Vector out(std::cos(a), std::sin(a), 0), up(0, 0, 1);
    SurfaceSample s;
    s.normal = out * std::cos(b) + up * std::sin(b);
    s.position = out * major + s.normal * minor;
    s.du = Vector(-std::sin(a), std::cos(a), 0) * (2 * pi * (major + minor * std::cos(b)));
    return s;
}

Vector torus_normal_near(const Vector& point, Real major) {
    const Real across = std::sqrt(point.x * point.x + point.y * point.y);
    return point - Vector(point.x, point.y, 0) * (major / across);
}

Vector turned_normal(TurnedFace face, Real turn) {
    const Real a = 2 * pi * turn, half = std::sqrt(Real(0.5));
    switch (face) {
        case TurnedFace::bottom:
            return {0, 0, -1};
        case TurnedFace::side:
            return {std::cos(a), std::sin(a), 0};
        case TurnedFace::chamfer:
            return {half * std::cos(a), half * std::sin(a), half};
        case TurnedFace::top:
            break;
    }
    return {0, 0, 1};
}

std::vector<ProfilePoint> turned_profile() {
    return {{1, -1}, {1, 0.75L}, {0.75L, 1}};
}

SplineTorus::SplineTorus(std::vector<Vector> control, int around, int across)
    : control_(std::move(control)), around_(around), across_(across) {
    constexpr int fine = 6;
    for (int i = 0; i < around * fine; ++i) {
        for (int j = 0; j < across * fine; ++j) {
            const Real u = (Real(i) + Real(0.5)) / fine, v = (Real(j) + Real(0.5)) / fine;
            seeds_.push_back({u, v, at(u, v).position});
        }
    }
}

const Vector& SplineTorus::control(int i, int j) const {
    const int a = (i % around_ + around_) % around_, b = (j % across_ + across_) % across_;
    return control_[std::size_t(a * across_ + b)];
}

SplineTorus::Point SplineTorus::at(Real u, Real v) const {
    const Real fu = std::floor(u), fv = std::floor(v);
    const Basis a = cubic_basis(u - fu), b = cubic_basis(v - fv);
    Point p;
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
            const Vector& c = control(int(fu) + i - 1, int(fv) + j - 1);
            const std::size_t x = std::size_t(i), y = std::size_t(j);
            p.position += c * (a.value[x] * b.value[y]);
            p.du += c * (a.slope[x] * b.value[y]);
            p.dv += c * (a.value[x] * b.slope[y]);
        }
    }
    return p;
}

SplineTorus::Nearest SplineTorus::nearest(const Vector& p) const {
    const Seed* best = &seeds_.front();
    Real least = -1;
    for (const Seed& seed : seeds_) {
        const Vector d = seed.position - p;
        const Real distance = dot(d, d);
        if (least < 0 || distance < least) {
            least = distance;
            best = &seed;
        }
    }
    Real u = best->u, v = best->v;
    Point s = at(u, v);
    for (int step = 0; step < 30; ++step) {
        const Vector d = p - s.position;
        const Real a = dot(s.du, s.du), b = dot(s.du, s.dv), c = dot(s.dv, s.dv);
        const Real x = dot(s.du, d), y = dot(s.dv, d), det = a * c - b * b;
        if (!(det > 0)) break;
        const Real nu = u + (c * x - b * y) / det, nv = v + (a * y - b * x) / det;
        const Point next = at(nu, nv);
        const Vector e = p - next.position;
        const Real distance = dot(e, e);
        if (!(distance < least)) break;
        least = distance;
        u = nu;
        v = nv;
        s = next;
    }
    return {std::sqrt(least), cross(s.du, s.dv)};
}

}  // namespace cost
