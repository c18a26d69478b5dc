// The Newton step on the gains.
//
// A gain below its limit can move in both directions, a gain held at its limit only along its phase. The step d solves
// (D + W^T S W) d = v. W, (2M, .), is the derivative of the pressures with respect to d, along the phasors u and across
// them. S holds their signed weights. D is the damping plus, for held gains, the outward pull x conj(h). v is the gradient.
// W has few rows, so by Woodbury's identity d = D^-1 (v - W^T (S^-1 + W D^-1 W^T)^-1 W D^-1 v).
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian_plugins/solvers/lagrange/dense_kernels.hpp"
#include "pacinian_plugins/solvers/lagrange/fused_passes.hpp"

namespace pacinian::lagrange {

constexpr f4 AT_LIMIT = 1.0f - 1e-6f;

// Turn x = B^H y, (2, N), into the gradient v along the free directions; write which gains are held, and D, (N,).
//
// damping: in units of the mean |x|.
inline void project_gradient(View<const f4, 2> h, f4 mu, f8 damping, View<f4, 2> x, View<bool, 1> held, f4* __restrict D) {
    const Index N = x.shape[1];
    f4 *__restrict xr = x.row(0), *__restrict xi = x.row(1);
    const f4 *__restrict hr = h.row(0), *__restrict hi = h.row(1);
    f8 mean = 0.0;
    for (Index n = 0; n < N; ++n) mean += std::sqrt(xr[n] * xr[n] + xi[n] * xi[n]);
    const f4 floor = static_cast<f4>(damping * mean / static_cast<f8>(N) + 1e-30);
    for (Index n = 0; n < N; ++n) {
        f4 re = xr[n] - mu * hr[n], im = xi[n] - mu * hi[n];
        const f4 outward = re * hr[n] + im * hi[n];
        const bool at_limit = hr[n] * hr[n] + hi[n] * hi[n] >= AT_LIMIT * AT_LIMIT && outward > 0.0f;
        held[n] = at_limit;
        D[n] = (at_limit ? outward : mu) + floor;
        if (at_limit) {
            const f4 along = im * hr[n] - re * hi[n];
            re = -along * hi[n];
            im = along * hr[n];
        }
        xr[n] = re;
        xi[n] = im;
    }
}

// Order the 2M equations (along u: m, across u: M + m) by the sign of their weight, and write the square roots of the weights;
// return how many are positive.
inline Index ordered(const f8* bend, Index M, i8* order, f8* share) {
    Index count = 0, negative = 2 * M;
    for (Index k = 0; k < 2 * M; ++k) {
        const f8 weight = k < M ? 1.0 : bend[k - M];
        const Index place = weight >= 0.0 ? count++ : --negative;
        order[place] = k;
        share[place] = std::sqrt(std::abs(weight));
    }
    return count;
}

struct Phasor {
    f4 re, im;
};

// Return the phasor along which an equation measures, times its share.
inline Phasor phasor(View<const f4, 2> u, Index equation, Index M, f8 share) {
    const Index m = equation % M;
    const f4 s = static_cast<f4>(share);
    if (equation < M) return {u(0, m) * s, u(1, m) * s};
    return {-u(1, m) * s, u(0, m) * s};
}

// Write W D^-1 W^T, (2M, 2M), to the lower triangle of A.
//
// V: workspace, (2M rounded up to 4, 2 TILE), for one direction of each transducer, then the other of the free ones.
inline void coupling(View<const c8, 2> B, View<const f4, 2> u, const f8* share, const i8* order, View<const f4, 2> h,
                     View<const bool, 1> held, const f4* D, View<f8, 2> A, View<f4, 3> tile, View<f4, 2> V) {
    const Index M = B.shape[0], N = B.shape[1], K = 2 * M;
    require_room(V, A, K);
    for (Index i = 0; i < K; ++i) std::fill(A.row(i), A.row(i) + K, 0.0);
    alignas(64) f4 cr[TILE], ci[TILE];
    i4 which[TILE];
    for (Index first = 0; first < N; first += TILE) {
        const Index count = std::min(TILE, N - first);
        solving::load(B, first, count, tile);
        Index free = 0;
        for (Index n = 0; n < count; ++n) {
            const f4 weight = 1.0f / std::sqrt(D[first + n]);
            if (held[first + n]) {
                cr[n] = -h(1, first + n) * weight;
                ci[n] = h(0, first + n) * weight;
            } else {
                cr[n] = weight;
                ci[n] = 0.0f;
                which[free++] = static_cast<i4>(n);
            }
        }
        for (Index k = 0; k < K; ++k) {
            const Phasor v = phasor(u, order[k], M, share[k]);
            f4* __restrict row = V.row(k);
            const f4 *__restrict a = tile.row(0, order[k] % M), *__restrict b = tile.row(1, order[k] % M);
            for (Index n = 0; n < count; ++n) row[n] = a[n] * (v.re * cr[n] + v.im * ci[n]) + b[n] * (v.im * cr[n] - v.re * ci[n]);
            for (Index f = 0; f < free; ++f) {
                const Index n = which[f];
                row[count + f] = cr[n] * (a[n] * v.im - b[n] * v.re);
            }
        }
        gramian(V, K, count + free, 1.0f, A);
    }
}

// Write the step d, (2, N), for the gradient v, (2, N).
//
// bend: weight of the pressures across u, (M,). p: workspace, (2, M). A, tile, V, y: workspace, as in `coupling` and
// fused_passes.hpp.
inline void newton_step(View<const c8, 2> B, View<const f4, 2> u, const f8* bend, View<const f4, 2> h, View<const bool, 1> held, const f4* D,
                        View<const f4, 2> v, View<f4, 2> d, View<f8, 2> p, View<f8, 2> A, View<f4, 3> tile, View<f4, 2> V, View<f4, 2> y) {
    const Index M = B.shape[0], N = B.shape[1], K = 2 * M;
    std::vector<i8> order(K);
    std::vector<f8> room(2 * K);
    f8 *share = room.data(), *q = share + K;
    const Index positive = ordered(bend, M, order.data(), share);
    coupling(B, u, share, order.data(), h, held, D, A, tile, V);
    for (Index k = 0; k < K; ++k) A(k, k) += k < positive ? 1.0 : -1.0;
    factor(A, K, positive);
    f4 *__restrict dr = d.row(0), *__restrict di = d.row(1);
    const f4 *__restrict vr = v.row(0), *__restrict vi = v.row(1), *__restrict hr = h.row(0), *__restrict hi = h.row(1);
    for (Index n = 0; n < N; ++n) {
        dr[n] = vr[n] / D[n];
        di[n] = vi[n] / D[n];
    }
    solving::apply_planar(B, d, p, tile);
    for (Index k = 0; k < K; ++k) {
        const Phasor w = phasor(u, order[k], M, share[k]);
        q[k] = w.re * p(0, order[k] % M) + w.im * p(1, order[k] % M);
    }
    substitute(A, K, positive, q);
    std::fill(y.data, y.data + y.size(), 0.0f);
    for (Index k = 0; k < K; ++k) {
        const Phasor w = phasor(u, order[k], M, share[k] * q[k]);
        y(0, order[k] % M) += w.re;
        y(1, order[k] % M) += w.im;
    }
    solving::adjoint_planar(B, y, d, tile);
    for (Index n = 0; n < N; ++n) {
        f4 re = dr[n], im = di[n];
        if (held[n]) {
            const f4 along = im * hr[n] - re * hi[n];
            re = -along * hi[n];
            im = along * hr[n];
        }
        dr[n] = (vr[n] - re) / D[n];
        di[n] = (vi[n] - im) / D[n];
    }
}

inline void project_gradient_in(View<const f4, 2> h, f4 mu, f8 damping, View<f4, 2> x, View<bool, 1> held, View<f4, 1> D) {
    const Index N = x.shape[1];
    require(x.shape[0] == 2 && h.shape[0] >= 2 && h.shape[1] == N && held.size() == N && D.size() == N, "project_gradient: the shapes differ");
    project_gradient(h, mu, damping, x, held, D.data);
}

inline void newton_step_in(View<const c8, 2> B, View<const f4, 2> u, View<const f8, 1> bend, View<const f4, 2> h, View<const bool, 1> held,
                    View<const f4, 1> D, View<const f4, 2> v, View<f4, 2> d, View<f8, 2> p, View<f8, 2> A, View<f4, 3> tile,
                    View<f4, 2> V, View<f4, 2> y) {
    const Index M = B.shape[0], N = B.shape[1];
    require(bend.size() == M && u.shape[1] >= M && h.shape[1] == N && held.size() == N && D.size() == N, "newton_step: the shapes differ");
    require(v.shape[1] == N && d.shape[1] == N && y.shape[0] == 2 && y.shape[1] >= M, "newton_step: the shapes differ");
    newton_step(B, u, bend.data, h, held, D.data, v, d, p, A, tile, V, y);
}

inline void define_newton_step(nb::module_& m) {
    kernel(m, "project_gradient", &project_gradient_in,
           "Turn x = B^H y, (2, N), into the gradient v along what can move; write what is held, and D, (N,).\n\n"
           "h: gains, (2 or more, N). damping: in units of the mean |x|.",
           "h", "mu", "damping", "x", "held", "D");
    kernel(m, "newton_step", &newton_step_in,
           "Write the step d, (2, N), for the gradient v, (2, N).\n\n"
           "u: phasors, (2, M). bend: weight of the pressures across u, (M,). h, held, D: as of `project_gradient`. Workspace:\n"
           "p, (2, M); A, (2M + 4, 2M + 4); tile, as in fused_passes.hpp; V, (2M rounded up to 4, 2 TILE); y, (2, M or more).",
           "B", "u", "bend", "h", "held", "D", "v", "d", "p", "A", "tile", "V", "y");
}

}  // namespace pacinian::lagrange
