// Alternating projections between points and transducers (Gerchberg-Saxton).
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/math.hpp"

namespace pacinian::gs {

constexpr Index TILE = 512;       // transducers per tile, so that their gains stay in the first-level cache
constexpr f8 MIN_ABS = 1e-18;    // least |x| whose square does not underflow in single precision

inline f8 iterate(View<const f4, 3> B, View<const f8, 1> t, View<const bool, 1> free, f8 exponent, f8 floor, i8 steps, View<f8, 1> w,
                  View<c16, 1> u, View<f4, 2> h, View<c16, 1> p) {
    const Index M = B.shape[1], N = B.shape[2];
    require(B.shape[0] == 2 && t.size() == M && free.size() == M && w.size() == M && u.size() == M && p.size() == M, "iterate: the shapes differ");
    require(h.shape[0] == 2 && h.shape[1] == N, "iterate: the shapes differ");
    for (i8 taken = 0; taken < steps; ++taken) {
        std::fill(p.data, p.data + M, c16(0.0));
        for (Index first = 0; first < N; first += TILE) {
            const Index count = std::min(TILE, N - first);
            f4 *__restrict re = h.row(0) + first, *__restrict im = h.row(1) + first;
            std::fill(re, re + count, 0.0f);
            std::fill(im, im + count, 0.0f);
            for (Index m = 0; m < M; ++m) {
                const f4 zr = static_cast<f4>(u[m].real() * (w[m] * t[m])), zi = static_cast<f4>(u[m].imag() * (w[m] * t[m]));
                const f4 *__restrict br = B.row(0, m) + first, *__restrict bi = B.row(1, m) + first;
                for (Index n = 0; n < count; ++n) {
                    re[n] += br[n] * zr + bi[n] * zi;
                    im[n] += br[n] * zi - bi[n] * zr;
                }
            }
            const f4 least = static_cast<f4>(floor);
            for (Index n = 0; n < count; ++n) {
                const f4 size = std::max(std::sqrt(re[n] * re[n] + im[n] * im[n]), least);
                re[n] /= size;
                im[n] /= size;
            }
            for (Index m = 0; m < M; ++m) {
                const f4 *__restrict br = B.row(0, m) + first, *__restrict bi = B.row(1, m) + first;
                f4 pr = 0.0f, pi = 0.0f;
                for (Index n = 0; n < count; ++n) {
                    pr += br[n] * re[n] - bi[n] * im[n];
                    pi += br[n] * im[n] + bi[n] * re[n];
                }
                p[m] += c16(pr, pi);
            }
        }
        f8 along = 0.0, total = 0.0, ratios = 0.0;
        Index asked = 0;
        for (Index m = 0; m < M; ++m) {
            const f8 length = std::sqrt(power(p[m]));
            if (!(t[m] > 0.0 && length > 0.0)) continue;
            along += length * t[m];
            total += length * length;
            ratios += length / t[m];
            ++asked;
            if (free[m]) u[m] = p[m] / length;
        }
        if (floor > MIN_ABS && along > 0.0) floor = std::max(floor * total / along, MIN_ABS);
        if (!(exponent > 0.0)) continue;
        f8 largest = 0.0;
        for (Index m = 0; m < M; ++m) {
            const f8 length = std::sqrt(power(p[m]));
            if (t[m] > 0.0 && length > 0.0) w[m] *= std::pow(ratios / static_cast<f8>(asked) * t[m] / length, exponent);
            largest = std::max(largest, w[m]);
        }
        for (Index m = 0; m < M; ++m) w[m] /= largest;
    }
    return floor;
}

inline void define(nb::module_& m) {
    kernel(m, "iterate", &iterate,
           "Back and forth `steps` times; return the floor.\n\n"
           "One step: x = B^H (w t u), h = x / max(|x|, floor), p = B h, then u = p / |p| where `free`, and\n"
           "w <- w (mean of |p| / t : |p| / t)^exponent.\n"
           "B: (2, M, N), h: (2, N), real and imaginary parts. t: (M,), 0 where nothing is asked. w, u, p: (M,).\n"
           "floor: above 1e-18 it is moved so that p comes to the strength of t.",
           "B", "t", "free", "exponent", "floor", "steps", "w", "u", "h", "p");
}

}  // namespace pacinian::gs
