// The Bézier points of a patch's normals S_u × S_v out of its own, for one patch or as many as a
// vector has lanes: `Vec` has three numbers, or three vectors of them.
// Included once per instruction set, inside its namespace.

// p[4 j + i] of degree 3 × 3, n[6 j + i] of degree 5 × 5.
template <class Vec>
void bicubic_normal_net(const Vec* p, Vec* n) {
    constexpr double two[3] = {1, 2, 1}, three[4] = {1, 3, 3, 1};
    constexpr double five[6] = {1, 0.2, 0.1, 0.1, 0.2, 1};  // one over the binomials
    Vec along[12], across[12];                              // times binomials
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 3; ++i)
            along[3 * j + i] = two[i] * three[j] * (3.0 * (p[4 * j + i + 1] - p[4 * j + i]));
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 4; ++i)
            across[4 * j + i] = two[j] * three[i] * (3.0 * (p[4 * (j + 1) + i] - p[4 * j + i]));
    for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 6; ++i) {
            Vec sum(0.0);
            for (int l = j > 2 ? j - 2 : 0; l <= 3 && l <= j; ++l)
                for (int k = i > 3 ? i - 3 : 0; k <= 2 && k <= i; ++k)
                    sum += cross(along[3 * l + k], across[4 * (j - l) + i - k]);
            n[6 * j + i] = five[i] * five[j] * sum;
        }
}

// Of the derivatives along two axes, of degree 3 over a triangle (quartic_patch.h) and less their
// factor 4, that of degree 6.
template <class Vec>
void quartic_normal_net(const Vec* by_u, const Vec* by_v, Vec* n) {
    // The binomials 3!/(i! j! k!) and 6!/(i! j! k!), row by row.
    constexpr double of_three[10] = {1, 3, 3, 1, 3, 6, 3, 3, 3, 1};
    constexpr double of_six[28] = {1,  6,  15, 20, 15, 6,  1,  6,  30, 60, 60, 30, 6, 15,
                                   60, 90, 60, 15, 20, 60, 60, 20, 15, 30, 15, 6,  6, 1};
    Vec u[10], v[10];
    for (int k = 0; k < 10; ++k) {
        u[k] = of_three[k] * 16.0 * by_u[k];
        v[k] = of_three[k] * by_v[k];
    }
    const auto of_degree_three = [](int i, int j) { return j * (9 - j) / 2 + i; };
    for (int j = 0, point = 0; j <= 6; ++j)
        for (int i = 0; i + j <= 6; ++i, ++point) {
            Vec sum(0.0);
            for (int l = j > 3 ? j - 3 : 0; l <= 3 && l <= j; ++l)
                for (int k = i > 3 ? i - 3 : 0; k + l <= 3 && k <= i; ++k)
                    if ((i - k) + (j - l) <= 3)
                        sum += cross(u[of_degree_three(k, l)], v[of_degree_three(i - k, j - l)]);
            n[point] = sum / of_six[point];
        }
}
