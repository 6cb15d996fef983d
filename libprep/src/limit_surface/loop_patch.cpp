#include "limit_surface/loop_patch.h"

#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace prep::detail {
namespace {

using Row = std::array<double, 12>;

// Refined control points by level and place, as sums of the 12. Far ones are zero: they have no
// part in what is asked for.
class Lattice {
  public:
    const Row& at(int level, int x, int y) {
        auto& known = levels_[level];
        if (const auto found = known.find({x, y}); found != known.end()) return found->second;
        Row row{};
        if (level == 0) {
            for (std::size_t k = 0; k < 12; ++k)
                if (loop_controls[k].x == x && loop_controls[k].y == y) row[k] = 1;
        } else if (x % 2 == 0 && y % 2 == 0) {
            add(row, 0.625, level - 1, x / 2, y / 2);
            for (const LatticePoint& step : loop_steps)
                add(row, 0.0625, level - 1, x / 2 + step.x, y / 2 + step.y);
        } else {
            // Between p and q = p + direction; the far corners of its triangles are p + the
            // directions before and after.
            const int direction = x % 2 == 0 ? 1 : y % 2 == 0 ? 0 : 2;
            const LatticePoint& along = loop_steps[direction];
            const int px = (x - along.x) / 2, py = (y - along.y) / 2;
            add(row, 0.375, level - 1, px, py);
            add(row, 0.375, level - 1, px + along.x, py + along.y);
            for (const int side : {(direction + 1) % 6, (direction + 5) % 6})
                add(row, 0.125, level - 1, px + loop_steps[side].x, py + loop_steps[side].y);
        }
        return known.emplace(std::pair(x, y), row).first->second;
    }
    Row limit(int level, int x, int y) {
        Row row{};
        add(row, loop_limit_own, level, x, y);
        for (const LatticePoint& step : loop_steps)
            add(row, 1 / loop_limit_parts, level, x + step.x, y + step.y);
        return row;
    }

  private:
    void add(Row& row, double weight, int level, int x, int y) {
        const Row other = at(level, x, y);
        for (std::size_t k = 0; k < 12; ++k) row[k] += weight * other[k];
    }
    std::map<int, std::map<std::pair<int, int>, Row>> levels_;
};

constexpr int monomials[15][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1},
                                  {1, 2}, {0, 3}, {4, 0}, {3, 1}, {2, 2}, {1, 3}, {0, 4}};

// coefficients[m][k]: of monomial m in the weight of control point k. All are multiples of 1/24.
std::array<Row, 15> polynomials() {
    Lattice lattice;
    std::array<std::array<double, 15>, 15> matrix{};
    std::array<Row, 15> right{};
    std::size_t r = 0;
    for (int j = 0; j <= 4; ++j)
        for (int i = 0; i + j <= 4; ++i, ++r) {
            for (std::size_t m = 0; m < 15; ++m)
                matrix[r][m] =
                    std::pow(i / 4.0, monomials[m][0]) * std::pow(j / 4.0, monomials[m][1]);
            right[r] = lattice.limit(2, i, j);
        }
    for (std::size_t c = 0; c < 15; ++c) {
        std::size_t pivot = c;
        for (std::size_t k = c + 1; k < 15; ++k)
            if (std::abs(matrix[k][c]) > std::abs(matrix[pivot][c])) pivot = k;
        std::swap(matrix[c], matrix[pivot]);
        std::swap(right[c], right[pivot]);
        for (std::size_t k = 0; k < 15; ++k) {
            if (k == c || matrix[k][c] == 0) continue;
            const double factor = matrix[k][c] / matrix[c][c];
            for (std::size_t m = c; m < 15; ++m) matrix[k][m] -= factor * matrix[c][m];
            for (std::size_t m = 0; m < 12; ++m) right[k][m] -= factor * right[c][m];
        }
    }
    for (std::size_t c = 0; c < 15; ++c)
        for (double& weight : right[c]) weight = std::round(weight / matrix[c][c] * 24) / 24;
    return right;
}

const std::array<Row, 15>& coefficients_of_monomials() {
    static const std::array<Row, 15> coefficients = polynomials();
    return coefficients;
}

// n (n − 1) … of `count` factors.
double falling(int n, int count) {
    double product = 1;
    for (int k = 0; k < count; ++k) product *= n - k;
    return product;
}

}  // namespace

LoopWeights loop_weights(double u, double v) {
    const std::array<Row, 15>& coefficients = coefficients_of_monomials();
    double pu[5] = {1, u, u * u, u * u * u, u * u * u * u},
           pv[5] = {1, v, v * v, v * v * v, v * v * v * v};
    LoopWeights weights{};
    for (std::size_t m = 0; m < 15; ++m) {
        const int a = monomials[m][0], b = monomials[m][1];
        const double value = pu[a] * pv[b];
        const double du = a > 0 ? a * pu[a - 1] * pv[b] : 0, dv = b > 0 ? b * pu[a] * pv[b - 1] : 0;
        for (std::size_t k = 0; k < 12; ++k) {
            weights.value[k] += coefficients[m][k] * value;
            weights.du[k] += coefficients[m][k] * du;
            weights.dv[k] += coefficients[m][k] * dv;
        }
    }
    return weights;
}

LoopSecondWeights loop_second_weights(double u, double v) {
    const std::array<Row, 15>& coefficients = coefficients_of_monomials();
    const double pu[5] = {1, u, u * u, u * u * u, u * u * u * u},
                 pv[5] = {1, v, v * v, v * v * v, v * v * v * v};
    LoopSecondWeights weights{};
    const auto power = [](const double* p, int n) { return n < 0 ? 0.0 : p[n]; };
    for (std::size_t m = 0; m < 15; ++m) {
        const int a = monomials[m][0], b = monomials[m][1];
        const double uu = falling(a, 2) * power(pu, a - 2) * pv[b];
        const double uv = a * b * power(pu, a - 1) * power(pv, b - 1);
        const double vv = falling(b, 2) * pu[a] * power(pv, b - 2);
        for (std::size_t k = 0; k < 12; ++k) {
            weights.uu[k] += coefficients[m][k] * uu;
            weights.uv[k] += coefficients[m][k] * uv;
            weights.vv[k] += coefficients[m][k] * vv;
        }
    }
    return weights;
}

// The polar form of uᵃ vᵇ, of degree 4, at i times (1,0), j times (0,1) and (0,0) otherwise: the
// ways to take a of the i and b of the j, of all to take a and b of the 4.
const std::array<Row, 15>& loop_bezier_weights() {
    static const std::array<Row, 15> weights = [] {
        std::array<Row, 15> rows{};
        std::size_t r = 0;
        for (int j = 0; j <= 4; ++j)
            for (int i = 0; i + j <= 4; ++i, ++r)
                for (std::size_t m = 0; m < 15; ++m) {
                    const int a = monomials[m][0], b = monomials[m][1];
                    const double polar = falling(i, a) * falling(j, b) / falling(4, a + b);
                    for (std::size_t k = 0; k < 12; ++k)
                        rows[r][k] += polar * coefficients_of_monomials()[m][k];
                }
        return rows;
    }();
    return weights;
}

LoopTable LoopTable::make(std::uint32_t n) {
    LoopTable table;
    table.n = n;
    Lattice lattice;
    int level = 0;
    while ((1U << level) < n) ++level;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i + j <= n; ++i) {
            table.weights.push_back(loop_weights(double(i) / n, double(j) / n));
            const Row& row = lattice.at(level, int(i), int(j));
            table.control.insert(table.control.end(), row.begin(), row.end());
        }
    return table;
}

}  // namespace prep::detail
