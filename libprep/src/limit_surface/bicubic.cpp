#include "limit_surface/bicubic.h"

#include <algorithm>
#include <array>

namespace prep::detail {

BicubicWeights bicubic_weights(double t) {
    const double s = 1 - t;
    return {{s * s * s / 6, ((3 * t - 6) * t * t + 4) / 6, ((3 * s - 6) * s * s + 4) / 6,
             t * t * t / 6},
            {-0.5 * s * s, 0.5 * (3 * t - 4) * t, 0.5 * (4 - 3 * s) * s, 0.5 * t * t},
            {s, 3 * t - 2, 3 * s - 2, t}};
}

namespace {

// One step of a crease point's scheme: the point between `before` and `after`.
double crease_step(double own, double before, double after, double sharpness) {
    const double smooth = 0.75 * own + 0.125 * (before + after);
    const double sharp = std::clamp(sharpness, 0.0, 1.0);
    return sharp * own + (1 - sharp) * smooth;
}

void reverse_rows(std::vector<double>& rows, double sign) {
    std::reverse(rows.begin(), rows.end());
    for (double& weight : rows) weight *= sign;
}

}  // namespace

BicubicWeights crease_weights(double t, float sharpness) {
    // Rows of weights of the four control points over the interval that has t.
    double rows[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    double scale = 1, left = sharpness;
    bool near = true;
    while (near && left > 0) {
        near = t <= 0.5;
        double next[5][4];
        for (int k = 0; k < 4; ++k) {
            next[0][k] = 0.5 * (rows[0][k] + rows[1][k]);
            next[1][k] = crease_step(rows[1][k], rows[0][k], rows[2][k], left);
            next[2][k] = 0.5 * (rows[1][k] + rows[2][k]);
            next[3][k] = crease_step(rows[2][k], rows[1][k], rows[3][k], 0);
            next[4][k] = 0.5 * (rows[2][k] + rows[3][k]);
        }
        for (int r = 0; r < 4; ++r)
            for (int k = 0; k < 4; ++k) rows[r][k] = next[near ? r : r + 1][k];
        t = near ? 2 * t : 2 * t - 1;
        scale *= 2;
        left -= 1;
    }
    const BicubicWeights plain = bicubic_weights(t);
    BicubicWeights weights{};
    for (int k = 0; k < 4; ++k)
        for (int r = 0; r < 4; ++r) {
            weights.value[k] += plain.value[r] * rows[r][k];
            weights.derivative[k] += scale * plain.derivative[r] * rows[r][k];
            weights.second[k] += scale * scale * plain.second[r] * rows[r][k];
        }
    return weights;
}

BicubicWeights reversed(const BicubicWeights& w) {
    return {{w.value[3], w.value[2], w.value[1], w.value[0]},
            {-w.derivative[3], -w.derivative[2], -w.derivative[1], -w.derivative[0]},
            {w.second[3], w.second[2], w.second[1], w.second[0]}};
}

BicubicTable BicubicTable::make(std::uint32_t n) {
    return make_crease(n, 0);
}

BicubicTable BicubicTable::make_crease(std::uint32_t n, float sharpness) {
    BicubicTable table;
    table.n = n;
    for (std::uint32_t i = 0; i <= n; ++i) {
        const BicubicWeights weights = crease_weights(double(i) / n, sharpness);
        table.value.insert(table.value.end(), weights.value, weights.value + 4);
        table.derivative.insert(table.derivative.end(), weights.derivative, weights.derivative + 4);
    }
    // Rows of weights of the control points −1 … m + 1; each step doubles m.
    using Row = std::array<double, 4>;
    std::vector<Row> rows(4, Row{});
    for (std::size_t k = 0; k < 4; ++k) rows[k][k] = 1;
    double left = sharpness;
    for (std::uint32_t m = 1; m < n; m *= 2, left -= 1) {
        std::vector<Row> finer;
        for (std::uint32_t i = 0; i <= 2 * m + 2; ++i) {  // finer point i − 1
            Row row{};
            const std::size_t old = (i + 1) / 2;
            for (std::size_t k = 0; k < 4; ++k)
                row[k] = i % 2 == 0 ? 0.5 * (rows[old][k] + rows[old + 1][k])
                                    : crease_step(rows[old][k], rows[old - 1][k], rows[old + 1][k],
                                                  i == 1 ? left : 0);
            finer.push_back(row);
        }
        rows = std::move(finer);
    }
    for (std::uint32_t i = 0; i <= n; ++i)
        table.control.insert(table.control.end(), rows[i + 1].begin(), rows[i + 1].end());
    return table;
}

BicubicTable BicubicTable::reversed() const {
    BicubicTable table = *this;
    reverse_rows(table.value, 1);
    reverse_rows(table.derivative, -1);
    reverse_rows(table.control, 1);
    return table;
}

namespace {

double sum_of_four(const double* w, const double* p) {
    return ((w[0] * p[0] + w[1] * p[1]) + w[2] * p[2]) + w[3] * p[3];
}

// With the number of numbers known loops over them become vectors; bits are the same.
template <std::uint32_t known_width, bool with_second>
void point_of(std::uint32_t any_width, const double* controls, const BicubicWeights& a,
              const BicubicWeights& b, double* value, double* du, double* dv,
              const SecondDerivatives* second) {
    const std::uint32_t width = known_width == 0 ? any_width : known_width;
    for (std::uint32_t d = 0; d < width; ++d) {
        double row[4], slope[4], turn[4];
        for (std::uint32_t j = 0; j < 4; ++j) {
            const double* p = controls + std::size_t(4 * j) * width + d;
            const double four[4] = {p[0], p[width], p[2 * width], p[3 * width]};
            row[j] = sum_of_four(a.value, four);
            slope[j] = sum_of_four(a.derivative, four);
            if (with_second) turn[j] = sum_of_four(a.second, four);
        }
        value[d] = sum_of_four(b.value, row);
        du[d] = sum_of_four(b.value, slope);
        dv[d] = sum_of_four(b.derivative, row);
        if (!with_second) continue;
        second->uu[d] = sum_of_four(b.value, turn);
        second->uv[d] = sum_of_four(b.derivative, slope);
        second->vv[d] = sum_of_four(b.second, row);
    }
}

}  // namespace

void bicubic_point(std::uint32_t width, const double* controls, const BicubicWeights& a,
                   const BicubicWeights& b, double* value, double* du, double* dv,
                   const SecondDerivatives* second) {
    if (second && width == 3) return point_of<3, true>(3, controls, a, b, value, du, dv, second);
    if (second) return point_of<0, true>(width, controls, a, b, value, du, dv, second);
    if (width == 3) return point_of<3, false>(3, controls, a, b, value, du, dv, second);
    point_of<0, false>(width, controls, a, b, value, du, dv, second);
}

}  // namespace prep::detail
