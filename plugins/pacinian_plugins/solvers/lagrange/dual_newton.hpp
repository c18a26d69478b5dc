// Newton steps on the multipliers, towards pressures whose sizes, or values where fixed, are as asked; and their proof.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian_plugins/solvers/lagrange/dense_kernels.hpp"
#include "pacinian_plugins/solvers/lagrange/fused_passes.hpp"

namespace pacinian::lagrange {

constexpr f8 FEW = 0.4;      // share of the transducers at their limit up to which they are taken out of the Gram matrix
constexpr f8 STALLED = 0.7;  // of the last error: less progress than this twice in a row is none

// Each equation's phasor u, (2, K), its sample, and what it lacks, F; returns K. found[0]: ||asked - made|| [Pa], free
// phases being as made.
inline Index equations(View<const c16, 1> p, View<const bool, 1> free, View<const f8, 2> made, View<const c16, 1> y, View<f4, 2> u,
                       i8* sample, f8* F, f8* found) {
    Index K = 0;
    f8 miss = 0.0;
    const auto add = [&](Index m, c16 v, f8 lacking) {
        sample[K] = m;
        u(0, K) = static_cast<f4>(v.real());
        u(1, K) = static_cast<f4>(v.imag());
        F[K++] = lacking;
    };
    for (Index m = 0; m < p.size(); ++m) {
        const c16 q(made(0, m), made(1, m));
        const f8 t = std::sqrt(power(p[m])), a = std::sqrt(power(q));
        c16 v = t > 0.0 ? p[m] / t : c16(1.0);
        if (free[m] && a > 0.0) v = q / a;
        c16 rest = t * v - q;
        miss += power(rest);
        rest -= y[m];
        add(m, v, rest.real() * v.real() + rest.imag() * v.imag());
        if (!free[m]) add(m, c16(-v.imag(), v.real()), rest.imag() * v.real() - rest.real() * v.imag());
    }
    found[0] = std::sqrt(miss);
    return K;
}

inline i8 descend(View<const c8, 2> B, View<const c16, 2> G, View<const c16, 1> p, View<const bool, 1> free, f8 mu, i8 steps, f8 enough,
                  View<c16, 1> y, View<f4, 2> h, View<f8, 2> made, View<f8, 2> A, View<f4, 3> tile, View<f4, 2> V, View<i8, 1> which,
                  View<f8, 1> found) {
    const Index M = B.shape[0], N = B.shape[1], most = A.shape[0];
    require(G.shape[0] == M && G.shape[1] == M && p.size() == M && free.size() == M && y.size() == M, "descend: the shapes differ");
    require(most >= 2 * M && which.size() >= TILE && found.size() >= 5, "descend: no room");
    const f4 least = static_cast<f4>(mu);
    std::vector<f4> us(2 * most, 0.0f), planes(2 * tile.shape[1], 0.0f);
    const View<f4, 2> u{us.data(), {2, most}}, ys{planes.data(), {2, tile.shape[1]}};
    std::vector<i8> sample(most, 0);
    std::vector<f8> F(most, 0.0);
    f8 size = 0.0;
    for (Index m = 0; m < M; ++m) size += power(p[m]);
    size = std::sqrt(size);
    for (i8 step = 0;; ++step) {
        for (Index m = 0; m < M; ++m) {
            ys(0, m) = static_cast<f4>(y[m].real());
            ys(1, m) = static_cast<f4>(y[m].imag());
        }
        found[1] = evaluate(B, ys, least, h, made, tile);
        const Index K = equations(p, free, made, y, u, sample.data(), F.data(), found.data);
        f8 lacking = 0.0;
        for (Index k = 0; k < K; ++k) lacking += F[k] * F[k];
        found[0] /= size;
        lacking = std::sqrt(lacking) / size;
        if (lacking <= enough) return step;
        if (step > 0 || found[4] < 0.0) found[4] = lacking > STALLED * found[3] ? std::max(found[4], 0.0) + 1.0 : 0.0;  // not where the last call ended
        if (found[4] > 1.0 || step >= steps) return -step - 1;
        found[3] = lacking;
        Index held = 0;
        for (Index n = 0; n < N; ++n) held += h(2, n) > least ? 1 : 0;
        found[2] = static_cast<f8>(held);
        const bool few = static_cast<f8>(held) <= FEW * static_cast<f8>(N);
        if (few) turned(G, sample.data(), K, u, 1.0 / mu, A);
        else
            for (Index i = 0; i < K; ++i) std::fill(A.row(i), A.row(i) + K, 0.0);
        curvature(B, sample.data(), K, u, h, least, few, A, V, which.data);
        for (Index k = 0; k < K; ++k) A(k, k) += 1.0;
        factor(A, K, K);
        substitute(A, K, K, F.data());
        for (Index k = 0; k < K; ++k) y[sample[k]] += c16(u(0, k), u(1, k)) * F[k];
    }
}

inline void certify(View<const c16, 1> p, View<const bool, 1> free, f8 mu, View<const c16, 1> y, View<const f4, 2> h,
                    View<const f8, 2> made, f8 cost, View<f8, 1> proof) {
    require(proof.size() >= 8 && free.size() == p.size() && y.size() == p.size() && made.shape[1] >= p.size(), "certify: the shapes differ");
    f8 value = -cost, miss = 0.0, total = 0.0;
    Index held = 0;
    for (Index m = 0; m < p.size(); ++m) {
        const c16 q(made(0, m), made(1, m));
        const f8 a = std::sqrt(power(q));
        const c16 t = free[m] && a > 0.0 ? std::sqrt(power(p[m])) / a * q : p[m];
        value += y[m].real() * t.real() + y[m].imag() * t.imag() - 0.5 * power(y[m]);
        miss += power(t - q);
    }
    for (Index n = 0; n < h.shape[1]; ++n) {
        const f8 squared = square(static_cast<f8>(h(0, n))) + square(static_cast<f8>(h(1, n)));
        total += squared;
        held += squared > square(1.0 - 1e-5) ? 1 : 0;
    }
    proof[5] = value;
    proof[6] = 0.5 * (miss + mu * total);
    proof[7] = static_cast<f8>(held);
}

inline void deliver(View<const f4, 2> h, f8 unit, View<c8, 1> out) {
    require(h.shape[0] >= 2 && h.shape[1] == out.size(), "deliver: the shapes differ");
    for (Index n = 0; n < out.size(); ++n) out[n] = c8(static_cast<f4>(unit * h(0, n)), static_cast<f4>(unit * h(1, n)));
}

inline i8 attempt(View<const c8, 2> B, View<const c16, 2> G, View<const c16, 1> p, View<const bool, 1> free, f8 mu, i8 steps, f8 enough,
                  View<c16, 1> y, View<f4, 2> h, View<f8, 2> made, View<f8, 2> A, View<f4, 3> tile, View<f4, 2> V, View<i8, 1> which,
                  View<f8, 1> found, f8 unit, View<c8, 1> out) {
    const i8 taken = descend(B, G, p, free, mu, steps, enough, y, h, made, A, tile, V, which, found);
    certify(p, free, mu, y, h, made, found[1], found);
    deliver(h, unit, out);
    return taken;
}

inline void define_descend(nb::module_& m) {
    kernel(m, "descend", &descend,
           "Solve Re(conj(u_k) (B h(B^H y) + y)) = t_k by Newton steps on the multipliers y.\n\n"
           "One equation per sample where its phase is `free`, along the phasor of the pressure made, two where it is fixed.\n"
           "G: B B^H, (M, M). p: targets, (M,) [Pa]. y: multipliers to start from, (M,), in place. h, made, tile, V, which: as of\n"
           "`evaluate`, `curvature`. A: room, (2M + 4, 2M + 4). found: ||asked - made|| / ||p||, the sum of c(x_n), the number at\n"
           "their limit; ||F|| / ||p|| and how many steps in a row did little, to go on with.\n"
           "Returns the number of steps, negative if they came to nothing.",
           "B", "G", "p", "free", "mu", "steps", "enough", "y", "h", "made", "A", "tile", "V", "which", "found");
    kernel(m, "certify", &certify,
           "Write D(y), 1/2 ||p - made||^2 + mu/2 ||h||^2 for the phases made, and how many are at their limit.\n\n"
           "proof: they are its elements 5 to 7. cost: the sum of c(x_n) at y. Others as of `descend`.",
           "p", "free", "mu", "y", "h", "made", "cost", "proof");
    kernel(m, "deliver", &deliver, "Write the gains, (N,), of those in units of the limit, h, (2 or more, N).", "h", "unit", "out");
    kernel(m, "attempt", &attempt, "As `descend`, then `certify` and `deliver`.", "B", "G", "p", "free", "mu", "steps", "enough", "y", "h",
           "made", "A", "tile", "V", "which", "found", "unit", "out");
}

}  // namespace pacinian::lagrange
