// Products with A, (R, N), in single or double precision with sums in double precision; and projections onto discs.
//
// A quantity h in a disc of radius `limit` costs weight |h|^2 / 2 and gains Re(x^* h). Its optimum is h(x) = x / weight if that
// lies in the disc, else limit x / |x|. This holds for gains and for sound pressures. Limits may be infinite.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <nanobind/stl/pair.h>

#include "pacinian/native/math.hpp"

namespace pacinian::lagrange {

constexpr f8 DENSE = 0.7;     // share of the columns above which taking all of them is faster than selecting some
constexpr f8 ALIGNED = 0.03;  // slope along x, relative to the slope across it, below which it is treated as 0

template <typename T>
void adjoint(View<const std::complex<T>, 2> A, View<const c16, 1> y, View<c16, 1> x) {
    const Index R = A.shape[0], N = A.shape[1];
    require(y.size() == R && x.size() == N, "adjoint: the shapes differ");
    f8* __restrict to = reinterpret_cast<f8*>(x.data);
    std::fill(to, to + 2 * N, 0.0);
    for (Index m = 0; m < R; ++m) {
        const T* __restrict row = reinterpret_cast<const T*>(A.row(m));
        const f8 c = y[m].real(), d = y[m].imag();
        if (c == 0.0 && d == 0.0) continue;
        for (Index n = 0; n < N; ++n) {
            const f8 a = row[2 * n], b = row[2 * n + 1];
            to[2 * n] += a * c + b * d;
            to[2 * n + 1] += a * d - b * c;
        }
    }
}

template <typename T>
void forward(View<const std::complex<T>, 2> A, View<const c16, 1> h, View<c16, 1> made) {
    const Index R = A.shape[0], N = A.shape[1];
    require(h.size() == N && made.size() == R, "forward: the shapes differ");
    const f8* __restrict g = reinterpret_cast<const f8*>(h.data);
    for (Index m = 0; m < R; ++m) {
        const T* __restrict row = reinterpret_cast<const T*>(A.row(m));
        f8 re = 0.0, im = 0.0;
        for (Index n = 0; n < N; ++n) {
            const f8 a = row[2 * n], b = row[2 * n + 1];
            re += a * g[2 * n] - b * g[2 * n + 1];
            im += a * g[2 * n + 1] + b * g[2 * n];
        }
        made[m] = c16(re, im);
    }
}

template <typename T, typename Real>
Index columns(View<const std::complex<T>, 2> A, View<const c16, 1> x, View<const f8, 1> slope, bool across, View<Real, 1> out) {
    const Index R = A.shape[0], N = A.shape[1];
    require(x.size() == N && slope.size() == N && out.size() >= 2 * R * N, "columns: the shapes differ");
    std::vector<Index> chosen(N);
    std::vector<Real> u(N), v(N);
    Index count = 0;
    for (const bool everything : {false, true}) {
        count = 0;
        for (Index n = 0; n < N; ++n) {
            if (!(slope[n] > 0.0 || everything)) continue;
            const f8 r = std::sqrt(power(x[n])), s = std::sqrt(slope[n]);
            const f8 a = r > 0.0 ? s * x[n].real() / r : s, b = r > 0.0 ? s * x[n].imag() / r : 0.0;
            chosen[count] = n;
            u[count] = static_cast<Real>(across ? -b : a);
            v[count++] = static_cast<Real>(across ? a : b);
        }
        if (static_cast<f8>(count) <= DENSE * static_cast<f8>(N)) break;
    }
    for (Index m = 0; m < R; ++m) {
        const T* __restrict row = reinterpret_cast<const T*>(A.row(m));
        Real *__restrict re = out.data + m * count, *__restrict im = out.data + (R + m) * count;
        if (count == N) {
            for (Index n = 0; n < N; ++n) {
                const Real a = row[2 * n], b = row[2 * n + 1];
                re[n] = a * u[n] - b * v[n];
                im[n] = a * v[n] + b * u[n];
            }
        } else {
            for (Index n = 0; n < count; ++n) {
                const Real a = row[2 * chosen[n]], b = row[2 * chosen[n] + 1];
                re[n] = a * u[n] - b * v[n];
                im[n] = a * v[n] + b * u[n];
            }
        }
    }
    return count;
}

inline f8 clip(View<const c16, 1> x, View<const f8, 1> weight, f8 extra, View<const f8, 1> limit, View<c16, 1> h) {
    require(weight.size() == x.size() && limit.size() == x.size() && h.size() == x.size(), "clip: the shapes differ");
    f8 cost = 0.0;
    for (Index n = 0; n < x.size(); ++n) {
        const f8 w = weight[n] + extra, q = limit[n], r = std::sqrt(power(x[n]));
        if (r <= w * q) {
            h[n] = x[n] / w;
            cost += r * r / (2.0 * w);
        } else {
            h[n] = x[n] * (q / r);
            cost += q * (r - w * q / 2.0);
        }
    }
    return cost;
}

inline f8 lift(View<const c16, 1> x, View<const f8, 1> weight, View<const f8, 1> limit, f8 most) {
    require(weight.size() == x.size() && limit.size() == x.size(), "lift: the shapes differ");
    f8 low = 0.0, high = 0.0, nu = 0.0;
    for (Index n = 0; n < x.size(); ++n) high += power(x[n]);
    high = std::sqrt(high / most);
    for (int turn = 0; turn < 100; ++turn) {
        f8 total = 0.0, slope = 0.0;
        for (Index n = 0; n < x.size(); ++n) {
            const f8 w = weight[n] + nu, q = limit[n], size = power(x[n]);
            if (size <= w * w * q * q) {
                total += size / (w * w);
                slope += size / (w * w * w);
            } else {
                total += q * q;
            }
        }
        if (total <= most * (1.0 + 1e-13)) {
            high = nu;
            if (nu == 0.0 || total >= most * (1.0 - 1e-13)) break;
        } else {
            low = nu;
        }
        if (slope > 0.0) nu += total / slope * (std::sqrt(total / most) - 1.0);
        if (slope == 0.0 || !(low < nu && nu < high)) nu = (low + high) / 2.0;
        if (high - low <= 1e-15 * high) break;
    }
    return high;
}

inline Index slopes(View<const c16, 1> x, View<const c16, 1> g, View<const f8, 1> weight, f8 extra, View<const f8, 1> limit,
                    View<f8, 1> radial, View<f8, 1> tangential) {
    const Index N = x.size();
    require(g.size() == N && weight.size() == N && limit.size() == N && radial.size() == N && tangential.size() == N,
            "slopes: the shapes differ");
    Index held = 0;
    for (Index n = 0; n < N; ++n) {
        const f8 w = weight[n] + extra, q = limit[n], r = std::sqrt(power(x[n]));
        if (r <= w * q) {
            radial[n] = tangential[n] = 1.0 / w;
            continue;
        }
        ++held;
        const f8 along = q > 0.0 ? (g[n].real() * x[n].real() + g[n].imag() * x[n].imag()) / (q * r) : 1.0;
        const f8 rest = 1.0 - std::min(std::max(along, 0.0), 1.0);
        tangential[n] = q / r;
        radial[n] = rest > ALIGNED ? rest * q / r : 0.0;
    }
    return held;
}

inline void expect(View<const c16, 1> x, View<const c16, 1> dx, View<const c16, 1> h, View<const f8, 1> radial,
                   View<const f8, 1> tangential, View<const f8, 1> limit, f8 shrink, View<c16, 1> g) {
    const Index N = x.size();
    require(dx.size() == N && h.size() == N && radial.size() == N && tangential.size() == N && limit.size() == N && g.size() == N,
            "expect: the shapes differ");
    for (Index n = 0; n < N; ++n) {
        const f8 r = std::sqrt(power(x[n]));
        const c16 v = r > 0.0 ? x[n] / r : c16(1.0), turned = std::conj(v) * dx[n];
        c16 next = h[n] + v * c16(radial[n] * turned.real(), tangential[n] * turned.imag());
        if (radial[n] == tangential[n]) next -= shrink * h[n];
        const f8 size = std::sqrt(power(next));
        g[n] = size > limit[n] ? next * (limit[n] / size) : next;
    }
}

inline std::pair<f8, f8> measure_excess(View<const c16, 1> p, View<const c16, 1> made, View<const f8, 1> limit,
                                        View<const f8, 1> slack, f8 s, View<c16, 1> r) {
    const Index M = p.size();
    require(made.size() == M && limit.size() == M && slack.size() == M && r.size() == M, "measure_excess: the shapes differ");
    f8 excess = 0.0, total = 0.0;
    for (Index m = 0; m < M; ++m) {
        r[m] = s * p[m] - made[m];
        const f8 size = power(r[m]);
        if (limit[m] == std::numeric_limits<f8>::infinity()) {
            total += size;
        } else {
            const f8 allowed = limit[m] + (limit[m] > 0.0 ? slack[m] : s * slack[m]);
            excess = std::max(excess, std::sqrt(size) - allowed);
        }
    }
    return {excess, total};
}

// The next two kernels write to a column-major matrix of LAPACK: S, (2R, 2R), is passed as its transpose.
inline void real(View<const c16, 2> G, f8 scale, View<f8, 2> S) {
    const Index R = G.shape[0];
    require(G.shape[1] == R && S.shape[0] == 2 * R && S.shape[1] == 2 * R, "real: the shapes differ");
    for (Index i = 0; i < R; ++i) {
        for (Index j = 0; j < R; ++j) {
            const f8 a = scale * G(i, j).real(), b = scale * G(i, j).imag();
            S(j, i) = S(R + j, R + i) = a;
            S(R + j, i) = -b;
            S(j, R + i) = b;
        }
    }
}

inline void add_blocks(View<const c16, 1> y, View<const f8, 1> radial, View<const f8, 1> tangential, f8 ridge, View<f8, 2> S) {
    const Index R = y.size();
    require(radial.size() == R && tangential.size() == R && S.shape[0] == 2 * R && S.shape[1] == 2 * R, "add_blocks: the shapes differ");
    for (Index m = 0; m < R; ++m) {
        const f8 size = std::sqrt(power(y[m])), a = size > 0.0 ? y[m].real() / size : 1.0, b = size > 0.0 ? y[m].imag() / size : 0.0;
        const f8 r = radial[m], t = tangential[m];
        S(m, m) += r * a * a + t * b * b + ridge;
        S(R + m, m) += (r - t) * a * b;
        S(R + m, R + m) += r * b * b + t * a * a + ridge;
    }
}

inline void define_convex(nb::module_& m) {
    const char* back = "Write x = A^H y, (N,), for A, (R, N), and y, (R,).";
    kernel(m, "adjoint", &adjoint<float>, back, "A", "y", "x");
    kernel(m, "adjoint", &adjoint<double>, back, "A", "y", "x");
    const char* forth = "Write made = A h, (R,), for A, (R, N), and h, (N,).";
    kernel(m, "forward", &forward<float>, forth, "A", "h", "made");
    kernel(m, "forward", &forward<double>, forth, "A", "h", "made");
    const char* picked =
        "Write the columns of A, (R, N), turned along x_n (or across it), times sqrt(slope_n); return how many.\n\n"
        "out: workspace for (2R, N), flat; written as (2R, count), real parts above imaginary parts. Columns of slope 0 are left out,\n"
        "or where they are few, written as 0.";
    kernel(m, "columns", &columns<float, float>, picked, "A", "x", "slope", "across", "out");
    kernel(m, "columns", &columns<float, double>, picked, "A", "x", "slope", "across", "out");
    kernel(m, "columns", &columns<double, double>, picked, "A", "x", "slope", "across", "out");
    kernel(m, "clip", &clip, "Write h(x) for weights `weight` + `extra`; return the sum of max Re(x^* h) - weight |h|^2 / 2. All (N,).", "x",
           "weight", "extra", "limit", "h");
    kernel(m, "lift", &lift,
           "The least nu >= 0 that keeps ||h(x)||^2 <= power when added to the weights.\n\n"
           "Newton steps on 1 / ||h||, which is linear in nu while nothing is held, inside a bracket.",
           "x", "weight", "limit", "power");
    kernel(m, "slopes", &slopes,
           "Write how fast h follows x along it and across it; return how many are held at their limit. All (N,).\n\n"
           "Those held do not follow along x, strictly. But where the last step expected h to be, at g, says how far that can be\n"
           "trusted: their slope along x fades out as g comes to lie along x (Chan, Golub and Mulet 1999; Hintermueller and\n"
           "Stadler 2006). This keeps steps from overshooting.",
           "x", "g", "weight", "extra", "limit", "radial", "tangential");
    kernel(m, "expect", &expect, "Write g, what h is expected to be after a step dx; those not held shrink by a share besides. All (N,).", "x",
           "dx", "h", "radial", "tangential", "limit", "shrink", "g");
    kernel(m, "measure_excess", &measure_excess,
           "Write r = s p - made, (M,); return the largest excess over a limit, and the sum of squares of the samples without one.\n\n"
           "Exact ones, of limit 0, may be s times as inexact.",
           "p", "made", "limit", "slack", "s", "r");
    kernel(m, "real", &real, "Write scale G, (R, R), as a real matrix, (2R, 2R), transposed.", "G", "scale", "S");
    kernel(m, "add_blocks", &add_blocks,
           "Add one 2 x 2 matrix for each y, (R,), to S, (2R, 2R), transposed: slopes along and across it, and `ridge`.", "y", "radial",
           "tangential", "ridge", "S");
}

}  // namespace pacinian::lagrange
