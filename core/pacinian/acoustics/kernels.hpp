// The propagation kernels: equations (3) to (7) fused, in single precision, without temporaries.
//
// A wave is evaluated on tiles of transducers that fit the first-level cache, in passes that the compiler vectorises:
// distance, amplitude, phase. Phase is kept in turns, so that range reduction is a single rounding. The error of a
// phase is that of a float32 distance: 6e-8 k r [rad] RMS, and at most 5 times that.
// Tests compare the kernels with `propagation.matrix`, in double precision.
//
// Common arguments: r, n: positions [m] and normals of the transducers, relative to their centre, (3, N).
// law: (k / 2 pi [1/m], power, beta [1/m], P0 [Pa m]). table: one entry for directions behind, then the directivity at
// the middle of equal steps of cos(theta) from 0 to 1; of length 1 for an omnidirectional transducer.
#pragma once
#include <algorithm>

#include "pacinian/acoustics/directions.hpp"
#include "pacinian/acoustics/skin_facing.hpp"
#include "pacinian/native/math.hpp"

namespace pacinian::acoustics {

constexpr Index TILE = 256;
constexpr f4 NEAREST = 1e-30f;   // smallest r^2, so that 1 / r is finite on a transducer [m^2]
constexpr f4 TOUCHING = 1e-12f;  // square of TOUCHING_DISTANCE in propagation.py [m^2]

struct Tile {
    alignas(64) f4 real[TILE], imag[TILE], inverse[TILE];
    alignas(64) i4 place[TILE];
};

// Write the sound pressure at (x, y, z) per gain of the transducers first..first + count to tile.real and tile.imag, and
// the inverse distance [1/m] to tile.inverse. Returns the number of transducers that the point lies on.
inline f4 wave(f4 x, f4 y, f4 z, View<const f4, 2> r, View<const f4, 2> n, Index first, Index count, const f4* law,
               View<const f4, 1> table, Tile& tile) {
    const f4 turns = law[0], exponent = law[1], beta = law[2], P0 = law[3];
    const f4 *__restrict rx = r.row(0) + first, *__restrict ry = r.row(1) + first, *__restrict rz = r.row(2) + first;
    f4 *__restrict real = tile.real, *__restrict imag = tile.imag, *__restrict inverse = tile.inverse;
    f4 touching = 0.0f;
    for (Index i = 0; i < count; ++i) {
        const f4 dx = x - rx[i], dy = y - ry[i], dz = z - rz[i];
        const f4 squared = dx * dx + dy * dy + dz * dz;
        touching += squared < TOUCHING ? 1.0f : 0.0f;
        inverse[i] = 1.0f / std::sqrt(squared + NEAREST);
        // The distance [m], with one Newton step, because the inverse may be an estimate.
        const f4 distance = squared * inverse[i];
        real[i] = distance + 0.5f * inverse[i] * (squared - distance * distance);
    }
    // Write the amplitude to imag; the two usual laws need no power function.
    if (exponent == 1.0f) {
        for (Index i = 0; i < count; ++i) imag[i] = P0 * inverse[i];
    } else if (exponent == 0.0f) {
        for (Index i = 0; i < count; ++i) imag[i] = P0;
    } else {
        for (Index i = 0; i < count; ++i) imag[i] = P0 * std::pow(inverse[i], exponent);
    }
    if (beta > 0.0f) {
        for (Index i = 0; i < count; ++i) {  // exp(t) = exp(t / 64)^64, |t| <= 32
            const f4 whole = -beta * real[i];
            const f4 t = (whole > -32.0f ? whole : -32.0f) * (1.0f / 64.0f);
            f4 e = 1.0f + t * (1.0f + t * (0.5f + t * (f4(1.0 / 6) + t * (f4(1.0 / 24) + t * f4(1.0 / 120)))));
            e *= e;
            e *= e;
            e *= e;
            e *= e;
            e *= e;
            imag[i] *= whole > -32.0f ? e * e : 0.0f;
        }
    }
    if (table.size() > 1) {
        const f4 *__restrict nx = n.row(0) + first, *__restrict ny = n.row(1) + first, *__restrict nz = n.row(2) + first;
        i4* __restrict place = tile.place;
        const i4 last = static_cast<i4>(table.size() - 1);
        const f4 steps = static_cast<f4>(last);
        for (Index i = 0; i < count; ++i) {
            const f4 cosine = ((x - rx[i]) * nx[i] + (y - ry[i]) * ny[i] + (z - rz[i]) * nz[i]) * inverse[i];
            const f4 front = cosine > 0.0f ? cosine : 0.0f;  // NaN counts as behind
            place[i] = static_cast<i4>(std::ceil(front * steps));
        }
        for (Index i = 0; i < count; ++i) imag[i] *= table[std::min(place[i], last)];
    }
    for (Index i = 0; i < count; ++i) {
        f4 t = real[i] * turns;
        t -= std::nearbyint(t);  // -1/2..1/2 turns; below, sin and cos of half the angle, pi t
        const f4 u = t * t;
        const f4 s = t * (3.14159258f + u * (-5.16770687f + u * (2.55003119f + u * (-0.59804419f + u * 0.07721839f))));
        const f4 c = 1.0f + u * (-4.93480214f + u * (4.05870916f + u * (-1.335212f + u * (0.23493731f + u * -0.02439632f))));
        const f4 a = imag[i];
        real[i] = a * (c * c - s * s);
        imag[i] = -2.0f * a * (s * c);
    }
    return touching;
}

inline f4 matrix(View<const f4, 2> q, View<const f4, 2> r, View<const f4, 2> n, View<const f4, 1> law,
                 View<const f4, 1> table, View<const i8, 1> rows, View<c8, 2> out, View<f4, 1> touches) {
    const Index N = r.shape[1];
    f4 all = 0.0f;
    Tile tile;
    for (Index m = 0; m < q.shape[0]; ++m) {
        f4 touching = 0.0f;
        for (Index first = 0; first < N; first += TILE) {
            const Index count = std::min(TILE, N - first);
            touching += wave(q(m, 0), q(m, 1), q(m, 2), r, n, first, count, law.data, table, tile);
            f4* __restrict row = reinterpret_cast<f4*>(out.row(rows[m]) + first);
            for (Index i = 0; i < count; ++i) {
                row[2 * i] = tile.real[i];
                row[2 * i + 1] = tile.imag[i];
            }
        }
        touches[m] = touching;
        all += touching;
    }
    return all;
}

inline void field(View<const f4, 2> q, View<const f4, 2> r, View<const f4, 2> n, View<const f4, 1> law,
                  View<const f4, 1> table, View<const f4, 2> g, View<c8, 1> out, View<f4, 1> touches) {
    const Index N = r.shape[1];
    Tile tile;
    for (Index m = 0; m < q.shape[0]; ++m) {
        f4 touching = 0.0f;
        f8 re = 0.0, im = 0.0;
        for (Index first = 0; first < N; first += TILE) {
            const Index count = std::min(TILE, N - first);
            touching += wave(q(m, 0), q(m, 1), q(m, 2), r, n, first, count, law.data, table, tile);
            const f4 *__restrict a = g.row(0) + first, *__restrict b = g.row(1) + first;
            f4 sum_re = 0.0f, sum_im = 0.0f;
            for (Index i = 0; i < count; ++i) {
                sum_re += tile.real[i] * a[i] - tile.imag[i] * b[i];
                sum_im += tile.real[i] * b[i] + tile.imag[i] * a[i];
            }
            re += sum_re;
            im += sum_im;
        }
        out[m] = c8(static_cast<f4>(re), static_cast<f4>(im));
        touches[m] = touching;
    }
}

inline void define(nb::module_& m) {
    kernel(m, "matrix", &matrix,
           "Write rows of B [Pa], (N,) each, for points q [m], (K, 3), to the rows of `out`, (M, N).\n\n"
           "touches: how many transducers each point lies on, (K,). Returns their sum.",
           "q", "r", "n", "law", "table", "rows", "out", "touches");
    kernel(m, "field", &field,
           "Write p = B g [Pa], (M,), without building B. g: real and imaginary parts, (2, N).",
           "q", "r", "n", "law", "table", "g", "out", "touches");
    kernel(m, "weigh", &weigh,
           "Multiply rows of B, `out`, (M, N), by the weights of samples at `points`, (K, 3) [m], for rows (K,).\n\n"
           "normals: (M, 3). capsules: (C, 8). edge: [m]. origin: of r, the transducers' positions (3, N) [m]. boxes: around\n"
           "equal tiles of them, (tiles, 6).",
           "points", "normals", "capsules", "edge", "origin", "r", "boxes", "rows", "out");
    define_directions(m);
}

}  // namespace pacinian::acoustics
