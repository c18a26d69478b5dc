// Newton steps on the multipliers towards the target sizes of the pressures (the target values, where phases are fixed), and
// the bound that they prove.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian_plugins/solvers/lagrange/dense_kernels.hpp"
#include "pacinian_plugins/solvers/lagrange/fused_passes.hpp"
#include "pacinian_plugins/solvers/lagrange/workspace.hpp"

namespace pacinian::lagrange {

constexpr f8 FEW = 0.4;      // share of transducers at their limit up to which they are subtracted from the Gram matrix
constexpr f8 STALLED = 0.7;  // share of the last error; steps have stalled after two in a row that leave more

// Write the phasor u, (2, K), the sample and the residual F of each equation; return K. error: ||targets - made|| [Pa],
// where free phases are those made.
inline Index equations(View<const c16, 1> p, View<const bool, 1> free, View<const f8, 2> made, View<const c16, 1> y, View<f4, 2> u,
                       i8* sample, f8* F, f8& error) {
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
    error = std::sqrt(miss);
    return K;
}

inline i8 take_dual_steps(View<const c8, 2> B, View<const c16, 2> G, f8 mu, i8 steps, f8 enough, Workspace& w) {
    w.check(B);
    const Index M = w.M, N = w.N, most = w.K;
    require(G.shape[0] == M && G.shape[1] == M, "solve_dual: the shapes differ");
    const View<c16, 1> p = w.p.view, y = w.y.view;
    const View<f4, 2> h = w.h.view;
    const View<f8, 2> A = w.system();
    const View<f4, 3> tile = w.tile.view;
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
        w.cost = evaluate(B, ys, least, h, w.made.view, tile);
        const Index K = equations(p, w.free.view, w.made.view, y, u, sample.data(), F.data(), w.error);
        f8 lacking = 0.0;
        for (Index k = 0; k < K; ++k) lacking += F[k] * F[k];
        w.error /= size;
        lacking = std::sqrt(lacking) / size;
        if (lacking <= enough) return step;
        if (step > 0 || w.stalled < 0)  // the first step of a later call was already counted
            w.stalled = lacking > STALLED * w.residual ? std::max<i8>(w.stalled, 0) + 1 : 0;
        if (w.stalled > 1 || step >= steps) return -step - 1;
        w.residual = lacking;
        Index held = 0;
        for (Index n = 0; n < N; ++n) held += h(2, n) > least ? 1 : 0;
        const bool few = static_cast<f8>(held) <= FEW * static_cast<f8>(N);
        if (few) rotate_gram(G, sample.data(), K, u, 1.0 / mu, A);
        else
            for (Index i = 0; i < K; ++i) std::fill(A.row(i), A.row(i) + K, 0.0);
        curvature(B, sample.data(), K, u, h, least, few, A, w.columns(), w.indices());
        for (Index k = 0; k < K; ++k) A(k, k) += 1.0;
        factor(A, K, K);
        substitute(A, K, K, F.data());
        for (Index k = 0; k < K; ++k) y[sample[k]] += c16(u(0, k), u(1, k)) * F[k];
    }
}

inline void certify(f8 mu, Workspace& w) {
    const View<c16, 1> p = w.p.view, y = w.y.view;
    const View<f4, 2> h = w.h.view;
    const View<f8, 2> made = w.made.view;
    f8 value = -w.cost, miss = 0.0, total = 0.0;
    Index held = 0;
    for (Index m = 0; m < p.size(); ++m) {
        const c16 q(made(0, m), made(1, m));
        const f8 a = std::sqrt(power(q));
        const c16 t = w.free.view[m] && a > 0.0 ? std::sqrt(power(p[m])) / a * q : p[m];
        value += y[m].real() * t.real() + y[m].imag() * t.imag() - 0.5 * power(y[m]);
        miss += power(t - q);
    }
    for (Index n = 0; n < h.shape[1]; ++n) {
        const f8 squared = square(static_cast<f8>(h(0, n))) + square(static_cast<f8>(h(1, n)));
        total += squared;
        held += squared > square(1.0 - 1e-5) ? 1 : 0;
    }
    w.bound = value;
    w.objective = 0.5 * (miss + mu * total);
    w.held = held;
}

inline void write_gains(View<const f4, 2> h, f8 unit, View<c8, 1> out) {
    require(h.shape[0] >= 2 && h.shape[1] == out.size(), "write_gains: the shapes differ");
    for (Index n = 0; n < out.size(); ++n) out[n] = c8(static_cast<f4>(unit * h(0, n)), static_cast<f4>(unit * h(1, n)));
}

inline i8 solve_dual(View<const c8, 2> B, View<const c16, 2> G, f8 mu, i8 steps, f8 enough, Workspace& w, f8 unit, View<c8, 1> out) {
    const i8 taken = take_dual_steps(B, G, mu, steps, enough, w);
    certify(mu, w);
    write_gains(w.h.view, unit, out);
    return taken;
}

inline void define_dual(nb::module_& m) {
    kernel(m, "solve_dual", &solve_dual,
           "Solve Re(conj(u_k) (B h(B^H y) + y)) = t_k by Newton steps on the multipliers y, then `certify` and `write_gains`.\n\n"
           "One equation per sample where its phase is `free`, along the phasor of the pressure made, two where it is fixed.\n"
           "G: B B^H, (M, M). mu: [Pa^2]. steps: at most. enough: ||F|| / ||p|| to stop at. workspace: has the targets p and the\n"
           "multipliers y to start from; the kernel writes y, h, made, error, cost and stalled. unit, out: as of `write_gains`.\n"
           "Returns the number of steps, negative if they came to nothing.",
           "B", "G", "mu", "steps", "enough", "workspace", "unit", "out");
    kernel(m, "certify", &certify,
           "Write `bound`, D(y), `objective`, 1/2 ||p - made||^2 + mu/2 ||h||^2 for the phases made, and `held`.\n\n"
           "workspace: with p, free, y, h, made, and cost at y.",
           "mu", "workspace");
    kernel(m, "write_gains", &write_gains, "Write the gains, (N,), of those in units of the limit, h, (2 or more, N).", "h", "unit", "out");
}

}  // namespace pacinian::lagrange
