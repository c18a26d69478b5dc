// The kernel of `resolution`: the distribution of directions from points to an array's transducers.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/math.hpp"

namespace pacinian::acoustics {

inline void spread(View<const f8, 2> q, View<const f8, 2> n, View<const f8, 2> r, View<const c8, 2> B, bool uniform, View<f8, 2> mean,
                   View<f8, 3> covariance) {
    const Index M = q.shape[0], N = r.shape[0];
    require(q.shape[1] == 3 && n.shape[0] == M && n.shape[1] == 3 && r.shape[1] == 3, "spread: not of space");
    require(B.shape[0] == M && B.shape[1] == N && mean.shape[0] == M && mean.shape[1] == 3, "spread: the shapes differ");
    require(covariance.shape[0] == M && covariance.shape[1] == 3 && covariance.shape[2] == 3, "spread: the shapes differ");
    for (Index m = 0; m < M; ++m) {
        const f8 x = q(m, 0), y = q(m, 1), z = q(m, 2), nx = n(m, 0), ny = n(m, 1), nz = n(m, 2);
        const f8 free = nx == 0.0 && ny == 0.0 && nz == 0.0 ? 1.0 : 0.0;
        const f8* __restrict at = r.data;
        const f4* __restrict row = reinterpret_cast<const f4*>(B.row(m));
        f8 s = 0, sx = 0, sy = 0, sz = 0, xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
        for (Index i = 0; i < N; ++i) {
            f8 dx = at[3 * i] - x, dy = at[3 * i + 1] - y, dz = at[3 * i + 2] - z;
            const f8 inverse = 1.0 / std::sqrt(dx * dx + dy * dy + dz * dz + 1e-30);
            dx *= inverse, dy *= inverse, dz *= inverse;
            const f8 cosine = std::max(dx * nx + dy * ny + dz * nz, 0.0) + free;
            const f8 re = row[2 * i], im = row[2 * i + 1];
            const f8 squared = (re * re + im * im) * cosine * cosine, w = uniform ? std::sqrt(squared) : squared;
            s += w;
            sx += w * dx, sy += w * dy, sz += w * dz;
            xx += w * dx * dx, yy += w * dy * dy, zz += w * dz * dz;
            xy += w * dx * dy, yz += w * dy * dz, zx += w * dz * dx;
        }
        s = 1.0 / std::max(s, 1e-30);
        const f8 a = sx * s, b = sy * s, c = sz * s;
        mean(m, 0) = a, mean(m, 1) = b, mean(m, 2) = c;
        covariance(m, 0, 0) = xx * s - a * a;
        covariance(m, 1, 1) = yy * s - b * b;
        covariance(m, 2, 2) = zz * s - c * c;
        covariance(m, 0, 1) = covariance(m, 1, 0) = xy * s - a * b;
        covariance(m, 1, 2) = covariance(m, 2, 1) = yz * s - b * c;
        covariance(m, 2, 0) = covariance(m, 0, 2) = zx * s - c * a;
    }
}

inline void define_directions(nb::module_& m) {
    kernel(m, "spread", &spread,
           "Write the mean, (M, 3), and the covariance, (M, 3, 3), of the unit vectors from points to transducers.\n\n"
           "q: points, (M, 3) [m]. n: normals there, zero where sound counts from every side, (M, 3). r: transducers, (N, 3) [m].\n"
           "B: (M, N). uniform: whether the weights are |B| times the cosine of the incidence; else that squared.",
           "q", "n", "r", "B", "uniform", "mean", "covariance");
}

}  // namespace pacinian::acoustics
