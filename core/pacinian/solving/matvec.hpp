// Products with B and B^H in single precision, tile by tile, so that B is read once, without BLAS and its threads.
//
// Common arguments: B [Pa], (M, N). Complex vectors are two planes, real and imaginary parts, (2, ...).
// tile: workspace for one tile of B, (2, M rounded up to 4, TILE). Sums within a tile are single, across tiles double.
#pragma once
#include <algorithm>
#include <vector>

#include "pacinian/native/views.hpp"

namespace pacinian::solving {

constexpr Index TILE = 256;  // columns per tile: 16 rows fit the first-level cache, 256 rows the second-level cache

// Copy columns first..first + count of B to `tile`, with separate real and imaginary parts.
inline void load(View<const c8, 2> B, Index first, Index count, View<f4, 3> tile) {
    for (Index m = 0; m < B.shape[0]; ++m) {
        const f4* __restrict row = reinterpret_cast<const f4*>(B.row(m) + first);
        f4 *__restrict re = tile.row(0, m), *__restrict im = tile.row(1, m);
        for (Index n = 0; n < count; ++n) {
            re[n] = row[2 * n];
            im[n] = row[2 * n + 1];
        }
    }
}

// The tiles of B, each copied to the workspace `tile` when it is read: for one pass.
struct Loaded {
    View<const c8, 2> B;
    View<f4, 3> tile;

    View<const f4, 3> at(Index first, Index count) const {
        load(B, first, count, tile);
        return tile;
    }
};

// The tiles of B, all copied before: for many passes. data: (N / TILE rounded up, 2, rows, TILE).
struct Copied {
    const f4* data;
    Index rows;

    View<const f4, 3> at(Index first, Index) const {
        View<const f4, 3> tile;
        tile.data = data + first / TILE * 2 * rows * TILE;
        tile.shape[0] = 2, tile.shape[1] = rows, tile.shape[2] = TILE;
        return tile;
    }
};

// Copy all tiles of B to `room`, which grows as needed.
inline Copied copy_tiles(View<const c8, 2> B, std::vector<f4>& room) {
    const Index N = B.shape[1], rows = (B.shape[0] + 3) / 4 * 4, size = 2 * rows * TILE;
    room.resize((N + TILE - 1) / TILE * size);
    for (Index first = 0, at = 0; first < N; first += TILE, at += size) {
        const View<f4, 3> tile{room.data() + at, {2, rows, TILE}};
        load(B, first, std::min(TILE, N - first), tile);
        for (Index m = B.shape[0]; m < rows; ++m)
            for (Index part = 0; part < 2; ++part) std::fill(tile.row(part, m), tile.row(part, m) + TILE, 0.0f);
    }
    return {room.data(), rows};
}

// Write x = B^H y for one tile. Rows of `tile` and of y beyond M must be 0.
inline void backward(View<const f4, 3> tile, Index count, View<const f4, 2> y, f4* __restrict xr, f4* __restrict xi) {
    std::fill(xr, xr + count, 0.0f);
    std::fill(xi, xi + count, 0.0f);
    const f4 *yr = y.row(0), *yi = y.row(1);
    for (Index m = 0; m < tile.shape[1]; m += 4) {
        const f4 *__restrict a0 = tile.row(0, m), *__restrict a1 = tile.row(0, m + 1);
        const f4 *__restrict a2 = tile.row(0, m + 2), *__restrict a3 = tile.row(0, m + 3);
        const f4 *__restrict b0 = tile.row(1, m), *__restrict b1 = tile.row(1, m + 1);
        const f4 *__restrict b2 = tile.row(1, m + 2), *__restrict b3 = tile.row(1, m + 3);
        const f4 r0 = yr[m], r1 = yr[m + 1], r2 = yr[m + 2], r3 = yr[m + 3];
        const f4 i0 = yi[m], i1 = yi[m + 1], i2 = yi[m + 2], i3 = yi[m + 3];
        for (Index n = 0; n < count; ++n) {
            xr[n] += (a0[n] * r0 + b0[n] * i0) + (a1[n] * r1 + b1[n] * i1) + (a2[n] * r2 + b2[n] * i2) + (a3[n] * r3 + b3[n] * i3);
            xi[n] += (a0[n] * i0 - b0[n] * r0) + (a1[n] * i1 - b1[n] * r1) + (a2[n] * i2 - b2[n] * r2) + (a3[n] * i3 - b3[n] * r3);
        }
    }
}

// Add B h for one tile to p.
inline void forward(View<const f4, 3> tile, Index count, const f4* __restrict hr, const f4* __restrict hi, View<f8, 2> p) {
    for (Index m = 0; m < p.shape[1]; ++m) {
        const f4 *__restrict a = tile.row(0, m), *__restrict b = tile.row(1, m);
        f4 re = 0.0f, im = 0.0f;
        for (Index n = 0; n < count; ++n) {
            re += a[n] * hr[n] - b[n] * hi[n];
            im += a[n] * hi[n] + b[n] * hr[n];
        }
        p(0, m) += re;
        p(1, m) += im;
    }
}

// Check that `tile` can hold columns of M rows.
inline void require_tile(View<const f4, 3> tile, Index M) {
    require(tile.shape[0] == 2 && tile.shape[1] >= M && tile.shape[1] % 4 == 0 && tile.shape[2] == TILE, "no tile for B");
}

inline void adjoint_planar(View<const c8, 2> B, View<const f4, 2> y, View<f4, 2> x, View<f4, 3> tile) {
    const Index N = B.shape[1];
    require_tile(tile, B.shape[0]);
    require(y.shape[0] == 2 && y.shape[1] >= tile.shape[1] && x.shape[0] == 2 && x.shape[1] >= N, "adjoint_planar: the shapes differ");
    for (Index first = 0; first < N; first += TILE) {
        const Index count = std::min(TILE, N - first);
        load(B, first, count, tile);
        backward(tile, count, y, x.row(0) + first, x.row(1) + first);
    }
}

inline void apply_planar(View<const c8, 2> B, View<const f4, 2> g, View<f8, 2> p, View<f4, 3> tile) {
    const Index N = B.shape[1];
    require_tile(tile, B.shape[0]);
    require(g.shape[0] >= 2 && g.shape[1] >= N && p.shape[0] == 2 && p.shape[1] <= tile.shape[1], "apply_planar: the shapes differ");
    std::fill(p.data, p.data + p.size(), 0.0);
    for (Index first = 0; first < N; first += TILE) {
        const Index count = std::min(TILE, N - first);
        load(B, first, count, tile);
        forward(tile, count, g.row(0) + first, g.row(1) + first, p);
    }
}

inline void apply(View<const c8, 2> B, View<const c8, 1> g, View<c16, 1> p) {
    const Index M = B.shape[0], N = B.shape[1];
    require(g.size() == N && p.size() == M, "apply: the shapes differ");
    alignas(64) f4 gr[TILE], gi[TILE];
    std::fill(p.data, p.data + M, c16(0.0));
    for (Index first = 0; first < N; first += TILE) {
        const Index count = std::min(TILE, N - first);
        for (Index n = 0; n < count; ++n) {
            gr[n] = g[first + n].real();
            gi[n] = g[first + n].imag();
        }
        for (Index m = 0; m < M; ++m) {
            const f4* __restrict row = reinterpret_cast<const f4*>(B.row(m) + first);
            f4 re = 0.0f, im = 0.0f;
            for (Index n = 0; n < count; ++n) {
                re += row[2 * n] * gr[n] - row[2 * n + 1] * gi[n];
                im += row[2 * n] * gi[n] + row[2 * n + 1] * gr[n];
            }
            p[m] += c16(re, im);
        }
    }
}

inline void adjoint(View<const c8, 2> B, View<const c16, 1> y, View<c8, 1> x) {
    const Index M = B.shape[0], N = B.shape[1];
    require(y.size() == M && x.size() == N, "adjoint: the shapes differ");
    alignas(64) f4 re[TILE], im[TILE];
    for (Index first = 0; first < N; first += TILE) {
        const Index count = std::min(TILE, N - first);
        std::fill(re, re + count, 0.0f);
        std::fill(im, im + count, 0.0f);
        for (Index m = 0; m < M; ++m) {
            const f4* __restrict row = reinterpret_cast<const f4*>(B.row(m) + first);
            const f4 yr = static_cast<f4>(y[m].real()), yi = static_cast<f4>(y[m].imag());
            for (Index n = 0; n < count; ++n) {
                re[n] += row[2 * n] * yr + row[2 * n + 1] * yi;
                im[n] += row[2 * n] * yi - row[2 * n + 1] * yr;
            }
        }
        for (Index n = 0; n < count; ++n) x[first + n] = c8(re[n], im[n]);
    }
}

inline void define_passes(nb::module_& m) {
    m.attr("TILE") = TILE;
    kernel(m, "adjoint_planar", &adjoint_planar, "Write x = B^H y, (2, N).", "B", "y", "x", "tile");
    kernel(m, "apply_planar", &apply_planar, "Write p = B g, (2, M), for gains (2 or more, N).", "B", "g", "p", "tile");
    kernel(m, "apply", &apply, "Write p = B g, (M,), for gains (N,).", "B", "g", "p");
    kernel(m, "adjoint", &adjoint, "Write x = B^H y, (N,), for y of shape (M,).", "B", "y", "x");
}

}  // namespace pacinian::solving
