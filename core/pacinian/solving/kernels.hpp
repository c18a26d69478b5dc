// Kernels in the M-dimensional space: the Gram matrix B B^H, Gerchberg-Saxton steps on it, and limits.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/math.hpp"

namespace pacinian::solving {

inline void gram(View<const c8, 2> B, Index start, Index stop, View<f4, 3> scratch, View<c16, 2> out) {
    const Index M = B.shape[0], even = scratch.shape[1], width = scratch.shape[2];
    require(scratch.shape[0] == 2 && even >= M && even % 2 == 0 && out.shape[0] == M && out.shape[1] == M, "gram: the shapes differ");
    require(0 <= start && stop <= B.shape[1], "gram: no such columns");
    std::fill(out.data, out.data + out.size(), c16(0.0));
    std::fill(scratch.data, scratch.data + scratch.size(), 0.0f);
    for (Index first = start; first < stop; first += width) {
        const Index count = std::min(width, stop - first);
        for (Index m = 0; m < M; ++m) {
            const f4* __restrict row = reinterpret_cast<const f4*>(B.row(m) + first);
            f4 *__restrict re = scratch.row(0, m), *__restrict im = scratch.row(1, m);
            for (Index n = 0; n < count; ++n) {
                re[n] = row[2 * n];
                im[n] = row[2 * n + 1];
            }
        }
        for (Index i = 0; i < even; i += 2) {
            const f4 *__restrict a0 = scratch.row(0, i), *__restrict b0 = scratch.row(1, i);
            const f4 *__restrict a1 = scratch.row(0, i + 1), *__restrict b1 = scratch.row(1, i + 1);
            for (Index j = 0; j < i + 2; j += 2) {
                const f4 *__restrict c0 = scratch.row(0, j), *__restrict d0 = scratch.row(1, j);
                const f4 *__restrict c1 = scratch.row(0, j + 1), *__restrict d1 = scratch.row(1, j + 1);
                f4 r00 = 0, i00 = 0, r01 = 0, i01 = 0, r10 = 0, i10 = 0, r11 = 0, i11 = 0;
                for (Index n = 0; n < count; ++n) {
                    r00 += a0[n] * c0[n] + b0[n] * d0[n];
                    i00 += b0[n] * c0[n] - a0[n] * d0[n];
                    r01 += a0[n] * c1[n] + b0[n] * d1[n];
                    i01 += b0[n] * c1[n] - a0[n] * d1[n];
                    r10 += a1[n] * c0[n] + b1[n] * d0[n];
                    i10 += b1[n] * c0[n] - a1[n] * d0[n];
                    r11 += a1[n] * c1[n] + b1[n] * d1[n];
                    i11 += b1[n] * c1[n] - a1[n] * d1[n];
                }
                out(i, j) += c16(r00, i00);
                if (i + 1 < M) out(i + 1, j) += c16(r10, i10);
                if (j + 1 < M) out(i, j + 1) += c16(r01, i01);
                if (i + 1 < M && j + 1 < M) out(i + 1, j + 1) += c16(r11, i11);
            }
        }
    }
    for (Index i = 0; i < M; ++i) {
        out(i, i) = out(i, i).real();
        for (Index j = 0; j < i; ++j) out(j, i) = std::conj(out(i, j));
    }
}

inline void gerchberg_saxton(View<const c16, 2> G, View<const bool, 1> free, i8 steps, View<c16, 1> p) {
    const Index M = p.size();
    require(G.shape[0] == M && G.shape[1] == M && free.size() == M, "gerchberg_saxton: the shapes differ");
    std::vector<f8> room(5 * M);
    f8 *__restrict re = room.data(), *__restrict im = re + M, *__restrict qr = im + M, *__restrict qi = qr + M, *size = qi + M;
    for (Index i = 0; i < M; ++i) {
        re[i] = p[i].real();
        im[i] = p[i].imag();
        size[i] = std::sqrt(power(p[i]));
    }
    for (i8 step = 0; step < steps; ++step) {
        for (Index i = 0; i < M; ++i) {
            const f8* __restrict row = reinterpret_cast<const f8*>(G.row(i));
            f8 a = 0.0, b = 0.0;
            for (Index j = 0; j < M; ++j) {
                a += row[2 * j] * re[j] - row[2 * j + 1] * im[j];
                b += row[2 * j] * im[j] + row[2 * j + 1] * re[j];
            }
            qr[i] = a;
            qi[i] = b;
        }
        for (Index i = 0; i < M; ++i) {
            const f8 length = std::sqrt(qr[i] * qr[i] + qi[i] * qi[i]);
            if (!(free[i] && length > 0.0)) continue;
            re[i] = qr[i] * (size[i] / length);
            im[i] = qi[i] * (size[i] / length);
        }
    }
    for (Index i = 0; i < M; ++i) p[i] = c16(re[i], im[i]);
}

template <typename T>
f8 total_power(View<const std::complex<T>, 1> g) {
    f8 total = 0.0;
    for (Index n = 0; n < g.size(); ++n) {
        const f8 re = g[n].real(), im = g[n].imag();
        total += re * re + im * im;
    }
    return total;
}

template <typename T>
Index count_at_limit(View<const std::complex<T>, 1> g, f8 limit) {
    const T squared = static_cast<T>(std::min(limit * limit, 1e30));
    Index count = 0;
    for (Index n = 0; n < g.size(); ++n) count += power(g[n]) >= squared ? 1 : 0;
    return count;
}

template <typename T>
void powers(View<const std::complex<T>, 2> B, View<f8, 1> out) {
    const Index M = B.shape[0], N = B.shape[1];
    require(out.size() == M, "powers: the shapes differ");
    for (Index m = 0; m < M; ++m) {
        const T* __restrict row = reinterpret_cast<const T*>(B.row(m));
        f8 total = 0.0;
        for (Index first = 0; first < N; first += 64) {
            T part = 0;
            for (Index n = 2 * first; n < 2 * std::min(first + 64, N); ++n) part += row[n] * row[n];
            total += part;
        }
        out[m] = total;
    }
}

template <typename T>
void limit_gains(View<std::complex<T>, 1> g, f8 factor, f8 highest) {
    for (Index n = 0; n < g.size(); ++n) {
        const f8 re = factor * g[n].real(), im = factor * g[n].imag();
        const f8 size = std::sqrt(re * re + im * im), shorter = size > highest ? highest / size : 1.0;
        g[n] = std::complex<T>(static_cast<T>(re * shorter), static_cast<T>(im * shorter));
    }
}

inline void define_kernels(nb::module_& m) {
    kernel(m, "gram", &gram,
           "Write B B^H, (M, M), exactly Hermitian, of the columns start..stop.\n\n"
           "Sums over a tile are single, over tiles double. scratch: (2, M + M % 2, tile). Rows are taken two by two, so that\n"
           "each number loaded is used twice: 2 times as fast as BLAS for M = 16 to 24, and no slower to M = 128.",
           "B", "start", "stop", "scratch", "out");
    kernel(m, "gerchberg_saxton", &gerchberg_saxton,
           "Repeat p <- |p| exp(j arg(G p)) in place where `free`, (M,); a point that nothing reaches stays.",
           "G", "free", "steps", "p");
    const char* power = "||g||^2 of gains (N,), summed in double precision: squares of small gains vanish in single.";
    kernel(m, "power", &total_power<float>, power, "g");
    kernel(m, "power", &total_power<double>, power, "g");
    const char* number = "The number of gains, (N,), with |g_n| >= limit.";
    kernel(m, "count_at_limit", &count_at_limit<float>, number, "g", "limit");
    kernel(m, "count_at_limit", &count_at_limit<double>, number, "g", "limit");
    const char* rows = "Write sum_n |B_mn|^2 of each row, (M,); summed in B's precision for 64 columns at most.";
    kernel(m, "powers", &powers<float>, rows, "B", "out");
    kernel(m, "powers", &powers<double>, rows, "B", "out");
    const char* limit = "Multiply gains (N,) by `factor` in place; then shorten those above `highest` to it.";
    kernel(m, "limit_gains", &limit_gains<float>, limit, "g", "factor", "highest");
    kernel(m, "limit_gains", &limit_gains<double>, limit, "g", "factor", "highest");
}

}  // namespace pacinian::solving
