// Fused passes over all transducers: each reads B once, tile by tile, in single precision.
//
// Common arguments: B [Pa], (M, N). y: real and imaginary parts of the multipliers, (2, M). h: real and imaginary part of
// h(x_n), and |x_n|, of each transducer, (3, N), with x = B^H y. p: real and imaginary parts of B h, (2, M). tile, and
// tiles, `Loaded` or `Copied`: as in `pacinian/solving/matvec.hpp`. Sums within a tile have single precision, sums over
// tiles double precision.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/solving/matvec.hpp"

namespace pacinian::lagrange {

using solving::TILE;

// Write h(x), |x| and p for multipliers y, (2, M rounded up to 4); return the sum of c(x_n).
template <typename Tiles>
inline f8 evaluate_tiles(const Tiles& tiles, View<const f4, 2> y, f4 mu, View<f4, 2> h, View<f8, 2> p) {
    const Index N = h.shape[1];
    f8 cost = 0.0;
    std::fill(p.data, p.data + p.size(), 0.0);
    const f4 half = mu > 0.0f ? 0.5f / mu : 0.0f;
    for (Index first = 0; first < N; first += TILE) {
        const Index count = std::min(TILE, N - first);
        const View<const f4, 3> tile = tiles.at(first, count);
        f4 *__restrict hr = h.row(0) + first, *__restrict hi = h.row(1) + first, *__restrict size = h.row(2) + first;
        solving::backward(tile, count, y, hr, hi);
        f4 part = 0.0f;
        for (Index n = 0; n < count; ++n) {
            const f4 r = std::sqrt(hr[n] * hr[n] + hi[n] * hi[n]);
            const f4 shorter = 1.0f / std::max(std::max(r, mu), 1e-30f);
            size[n] = r;
            hr[n] *= shorter;
            hi[n] *= shorter;
            part += r <= mu ? r * r * half : r - 0.5f * mu;
        }
        cost += part;
        solving::forward(tile, count, hr, hi, p);
    }
    return cost;
}

inline f8 evaluate(View<const c8, 2> B, View<const f4, 2> y, f4 mu, View<f4, 2> h, View<f8, 2> p, View<f4, 3> tile) {
    solving::require_tile(tile, B.shape[0]);
    require(y.shape[0] == 2 && y.shape[1] >= tile.shape[1] && h.shape[0] >= 3 && h.shape[1] == B.shape[1], "evaluate: the shapes differ");
    require(p.shape[0] == 2 && p.shape[1] == B.shape[0], "evaluate: the shapes differ");
    return evaluate_tiles(solving::Loaded{B, tile}, y, mu, h, p);
}

// Add sign V V^T, for `count` columns of V, to the lower triangle of A, in blocks of four rows by two.
inline void gramian(View<const f4, 2> V, Index K, Index count, f4 sign, View<f8, 2> A) {
    for (Index i = 0; i < K; i += 4) {
        const f4 *__restrict v0 = V.row(i), *__restrict v1 = V.row(i + 1), *__restrict v2 = V.row(i + 2), *__restrict v3 = V.row(i + 3);
        for (Index j = 0; j < i + 4; j += 2) {
            const f4 *__restrict w0 = V.row(j), *__restrict w1 = V.row(j + 1);
            f4 s00 = 0, s10 = 0, s20 = 0, s30 = 0, s01 = 0, s11 = 0, s21 = 0, s31 = 0;
            for (Index n = 0; n < count; ++n) {
                s00 += v0[n] * w0[n];
                s10 += v1[n] * w0[n];
                s20 += v2[n] * w0[n];
                s30 += v3[n] * w0[n];
                s01 += v0[n] * w1[n];
                s11 += v1[n] * w1[n];
                s21 += v2[n] * w1[n];
                s31 += v3[n] * w1[n];
            }
            A(i, j) += sign * s00;
            A(i + 1, j) += sign * s10;
            A(i + 2, j) += sign * s20;
            A(i + 3, j) += sign * s30;
            A(i, j + 1) += sign * s01;
            A(i + 1, j + 1) += sign * s11;
            A(i + 2, j + 1) += sign * s21;
            A(i + 3, j + 1) += sign * s31;
        }
    }
}

// Require that V and A have room for K equations, rounded up to 4.
inline void require_room(View<const f4, 2> V, View<const f8, 2> A, Index K) {
    const Index rows = (K + 3) / 4 * 4;
    require(V.shape[0] >= rows && V.shape[1] >= 2 * TILE && A.shape[0] >= rows && A.shape[1] >= rows, "the workspace is too small for the equations");
}

// Write the columns of V from `at` on: the change of Re(conj(u_m) p_m) with h_n, along its size or along its phase.
//
// Each column is weighted by the square root of dh/dx, or of 1 / mu minus dh/dx.
inline void directions(View<const c8, 2> B, const i8* sample, Index K, const i8* which, Index count, View<const f4, 2> u,
                       View<const f4, 2> h, f4 mu, bool along, bool lacking, View<f4, 2> V, Index at) {
    alignas(64) f4 tr[TILE], ti[TILE];
    const f4 *hr = h.row(0), *hi = h.row(1), *sizes = h.row(2);
    for (Index k = 0; k < count; ++k) {
        const Index n = which[k];
        const f4 size = std::max(sizes[n], 1e-30f);
        const bool limited = size > mu;
        f4 weight = 1.0f / mu;
        if (lacking) weight = along ? weight : weight - 1.0f / size;
        else if (limited) weight = 1.0f / size;
        const f4 root = std::sqrt(weight);
        const f4 cr = limited ? hr[n] * root : root, ci = limited ? hi[n] * root : 0.0f;  // below the limit, any phase serves
        tr[k] = along ? cr : -ci;
        ti[k] = along ? ci : cr;
    }
    for (Index i = 0; i < K; ++i) {
        f4* __restrict row = V.row(i) + at;
        const f4* __restrict b = reinterpret_cast<const f4*>(B.row(sample[i]));
        const f4 ur = u(0, i), ui = u(1, i);
        for (Index k = 0; k < count; ++k) {
            const f4 re = b[2 * which[k]], im = b[2 * which[k] + 1];
            row[k] = re * (ur * tr[k] + ui * ti[k]) + im * (ui * tr[k] - ur * ti[k]);
        }
    }
}

// Add the derivative of Re(conj(u_i) p_i) with respect to y_j along u_j to the lower triangle of A, (K, K).
//
// dh/dx is 1 / mu in both directions below the limit, and 1 / |x| along the phase at the limit. few: A already holds 1 / mu for all
// transducers; subtract the difference for those at their limit, which is cheap if they are few. sample: of each equation,
// (K,). u: its phasor, (2, K). V: workspace, (K rounded up to 4, 2 TILE). which: workspace, (TILE,).
inline void curvature(View<const c8, 2> B, const i8* sample, Index K, View<const f4, 2> u, View<const f4, 2> h, f4 mu, bool few,
                      View<f8, 2> A, View<f4, 2> V, i8* which) {
    const Index N = B.shape[1];
    const f4* size = h.row(2);
    require_room(V, A, K);
    for (Index first = 0; first < N; first += TILE) {
        const Index last = std::min(first + TILE, N);
        Index limited = 0;
        for (Index n = first; n < last; ++n)
            if (size[n] > mu) which[limited++] = n;
        if (few) {
            if (limited) {
                directions(B, sample, K, which, limited, u, h, mu, true, true, V, 0);
                directions(B, sample, K, which, limited, u, h, mu, false, true, V, limited);
                gramian(V, K, 2 * limited, -1.0f, A);
            }
            continue;
        }
        directions(B, sample, K, which, limited, u, h, mu, false, false, V, 0);
        Index free = 0;
        for (Index n = first; n < last; ++n)
            if (size[n] <= mu) which[free++] = n;
        directions(B, sample, K, which, free, u, h, mu, false, false, V, limited);
        directions(B, sample, K, which, free, u, h, mu, true, false, V, limited + free);
        gramian(V, K, limited + 2 * free, 1.0f, A);
    }
}

inline void curvature_of(View<const c8, 2> B, View<const i8, 1> sample, View<const f4, 2> u, View<const f4, 2> h, f4 mu, bool few,
                         View<f8, 2> A, View<f4, 2> V, View<i8, 1> which) {
    require(u.shape[0] == 2 && u.shape[1] >= sample.size() && h.shape[0] >= 3 && h.shape[1] == B.shape[1], "curvature: the shapes differ");
    require(which.size() >= TILE, "curvature: the workspace is too small");
    curvature(B, sample.data, sample.size(), u, h, mu, few, A, V, which.data);
}

// Write p = B W B^H d, W = dh/dx at the gains h, for d, (2, M rounded up to 4).
template <typename Tiles>
inline void apply_curvature(const Tiles& tiles, View<const f4, 2> d, View<const f4, 2> h, f4 mu, View<f8, 2> p) {
    const Index N = h.shape[1];
    alignas(64) f4 xr[TILE], xi[TILE];
    std::fill(p.data, p.data + p.size(), 0.0);
    for (Index first = 0; first < N; first += TILE) {
        const Index count = std::min(TILE, N - first);
        const View<const f4, 3> tile = tiles.at(first, count);
        solving::backward(tile, count, d, xr, xi);
        const f4 *__restrict hr = h.row(0) + first, *__restrict hi = h.row(1) + first, *__restrict size = h.row(2) + first;
        for (Index n = 0; n < count; ++n) {
            const bool held = size[n] > mu;
            const f4 weight = 1.0f / std::max(size[n], mu), re = xr[n], im = xi[n];
            const f4 along = (im * hr[n] - re * hi[n]) * weight;
            xr[n] = held ? -along * hi[n] : re * weight;
            xi[n] = held ? along * hr[n] : im * weight;
        }
        solving::forward(tile, count, xr, xi, p);
    }
}

inline void define_sweeps(nb::module_& m) {
    kernel(m, "evaluate", &evaluate,
           "Write h(x), |x| and p for multipliers y, (2, rows of `tile`); return the sum of c(x_n).\n\n"
           "B: (M, N) [Pa]. h: (3, N): real and imaginary part of h(x_n), and |x_n|, with x = B^H y. p: B h, (2, M). tile: as in\n"
           "`passes`. h = x / max(|x|, mu); c = |x|^2 / (2 mu) where |x| <= mu, else |x| - mu / 2. mu = 0: all at the limit.",
           "B", "y", "mu", "h", "p", "tile");
    kernel(m, "curvature", &curvature_of,
           "Add to A, (K, K), lower triangle, how Re(conj(u_i) p_i) changes with y_j = u_j.\n\n"
           "Where h is free it is 1 / mu in both directions, at the limit 1 / |x| along its phase. few: subtract instead, from\n"
           "1 / mu for all, what those at their limit lack: cheap while they are few. sample: of each equation, (K,); u: its\n"
           "phasor, (2, K). h: as of `evaluate`. Workspace: V, (K rounded up to 4, 2 TILE); which, (TILE,).",
           "B", "sample", "u", "h", "mu", "few", "A", "V", "which");
}

}  // namespace pacinian::lagrange
