// Regions: phases of a wave that converges beyond a region's points, and one row of B that represents each group.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/math.hpp"

namespace pacinian::solving {

constexpr f8 SHARED = 0.4;    // radius of the part of the array that a region's wave comes from, relative to the array's
constexpr f8 FARTHEST = 4.0;  // largest d'/d: distance of the focus beyond the region, over the region's distance
constexpr f8 THICK = 64.0;    // smallest distance of the focus beyond the region, in thicknesses of the region
constexpr f8 TINY = 1e-30;    // smallest distance [m] or squared distance [m^2] used as a divisor
constexpr f8 STEEP = 0.9;     // cosine of the angle to the x axis from which a wave is tilted along z instead of x

// Return the smallest eigenvalue of a symmetric matrix (Smith 1961).
inline f8 least_eigenvalue(const f8 (&A)[3][3]) {
    const f8 mean = (A[0][0] + A[1][1] + A[2][2]) / 3.0;
    f8 size = 2.0 * (square(A[0][1]) + square(A[0][2]) + square(A[1][2]));
    for (int i = 0; i < 3; ++i) size += square(A[i][i] - mean);
    size = std::sqrt(size / 6.0);
    if (size <= 1e-12 * mean || size == 0.0) return mean;
    const f8 a = (A[0][0] - mean) / size, b = (A[1][1] - mean) / size, c = (A[2][2] - mean) / size;
    const f8 d = A[0][1] / size, e = A[0][2] / size, f = A[1][2] / size;
    const f8 half = (a * b * c + 2.0 * d * e * f - a * f * f - b * e * e - c * d * d) / 2.0;
    const f8 turn = std::acos(std::min(std::max(half, -1.0), 1.0)) / 3.0;
    return mean + 2.0 * size * std::cos(turn + 2.0 * M_PI / 3.0);
}

inline void converge(View<const f8, 2> q, View<const f8, 1> P, View<const f8, 2> some, View<const f8, 1> centre, f8 k, f8 least,
                     f8 tilt, View<f8, 1> phases) {
    const Index M = q.shape[0], V = some.shape[0];
    require(q.shape[1] == 3 && some.shape[1] == 3 && centre.size() == 3, "converge: not of space");
    require(P.size() == M && phases.size() == M && V > 0, "converge: the shapes differ");
    f8 total = 0.0;
    for (Index m = 0; m < M; ++m) total += P[m];
    const auto weight = [&](Index m) { return total > 0.0 ? P[m] / total : 1.0 / static_cast<f8>(M); };
    f8 middle[3] = {}, A[3][3] = {};
    for (Index m = 0; m < M; ++m)
        for (int i = 0; i < 3; ++i) middle[i] += weight(m) * q(m, i);
    for (Index m = 0; m < M; ++m)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) A[i][j] += weight(m) * (q(m, i) - middle[i]) * (q(m, j) - middle[j]);
    f8 out[3], axis[3], far = 0.0, along = 0.0;
    for (int i = 0; i < 3; ++i) {
        out[i] = middle[i] - centre[i];
        far += square(out[i]);
    }
    far = std::max(std::sqrt(far), TINY);
    for (int i = 0; i < 3; ++i) axis[i] = out[i] / far;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) along += axis[i] * A[i][j] * axis[j];
    const f8 width = std::sqrt(std::max(A[0][0] + A[1][1] + A[2][2] - along, 0.0));
    const f8 thickness = std::sqrt(std::max(least_eigenvalue(A), 0.0));
    // weight the transducers by their power at the middle
    f8 whole = 0.0, first[3] = {}, second = 0.0;
    for (Index v = 0; v < V; ++v) {
        const f8 x = some(v, 0) - middle[0], y = some(v, 1) - middle[1], z = some(v, 2) - middle[2];
        const f8 away = x * x + y * y + z * z, strength = 1.0 / std::max(away, TINY);
        whole += strength;
        second += strength * away;
        first[0] += strength * x, first[1] += strength * y, first[2] += strength * z;
    }
    const f8 aside = square(first[0]) + square(first[1]) + square(first[2]);
    const f8 radius = std::sqrt(std::max(second / whole - aside / (whole * whole), 0.0));
    const f8 shared = SHARED * radius - width;
    f8 ratio = shared > 0.0 ? std::min(std::max(width / shared, least), 1.0) : 1.0;
    ratio = std::min(std::max(ratio, THICK * thickness / far), FARTHEST);
    f8 focus[3];
    for (int i = 0; i < 3; ++i) focus[i] = middle[i] + ratio * out[i];
    focus[std::abs(axis[0]) < STEEP ? 0 : 2] += tilt * radius * ratio;
    for (Index m = 0; m < M; ++m)
        phases[m] = k * std::sqrt(square(q(m, 0) - focus[0]) + square(q(m, 1) - focus[1]) + square(q(m, 2) - focus[2]));
}

template <typename T>
void sum_group_rows(View<const std::complex<T>, 2> B, View<const c16, 1> p, View<const i8, 1> group, View<std::complex<T>, 2> rows) {
    const Index M = B.shape[0], N = B.shape[1];
    require(p.size() == M && group.size() == M && rows.shape[1] == N, "sum_group_rows: the shapes differ");
    std::fill(rows.data, rows.data + rows.size(), std::complex<T>(0));
    for (Index m = 0; m < M; ++m) {
        T* __restrict to = reinterpret_cast<T*>(rows.row(group[m]));
        const T* __restrict row = reinterpret_cast<const T*>(B.row(m));
        const T a = static_cast<T>(p[m].real()), b = static_cast<T>(-p[m].imag());
        for (Index n = 0; n < N; ++n) {
            to[2 * n] += a * row[2 * n] - b * row[2 * n + 1];
            to[2 * n + 1] += a * row[2 * n + 1] + b * row[2 * n];
        }
    }
}

inline void define_regions(nb::module_& m) {
    kernel(m, "converge", &converge,
           "Write the phases [rad] of a region's points, (M,): see `joint_phases`.\n\n"
           "q: (M, 3) [m]. P: radiation pressures, (M,) [Pa]. some: transducers that stand for all, (V, 3) [m], and the centre\n"
           "of all, (3,). k: wavenumber [1/m]. least: d'/d at least. tilt: by how much the point f is moved aside, over the\n"
           "array's radius times d'/d.",
           "q", "P", "some", "centre", "k", "least", "tilt", "phases");
    const char* rows = "Write p_g^H B_g for the samples of each group g, (R, N).\n\nB: (M, N). p, group: of each sample, (M,).";
    kernel(m, "sum_group_rows", &sum_group_rows<float>, rows, "B", "p", "group", "rows");
    kernel(m, "sum_group_rows", &sum_group_rows<double>, rows, "B", "p", "group", "rows");
}

}  // namespace pacinian::solving
