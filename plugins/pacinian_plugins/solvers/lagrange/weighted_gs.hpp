// Weighted Gerchberg-Saxton steps at full drive. They find phases and multipliers from which to restart.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/math.hpp"
#include "pacinian_plugins/solvers/lagrange/fused_passes.hpp"
#include "pacinian_plugins/solvers/lagrange/workspace.hpp"

namespace pacinian::lagrange {

constexpr f8 ROOT = 0.5;   // exponent of target / made by which a multiplier grows: with 1, two samples oscillate
constexpr f8 AHEAD = 1.5;  // over-relaxation of the step to the phases made: 1 takes twice as many steps
constexpr f8 CLOSE = 1e-4;

inline i8 equalise(View<const c8, 2> B, i8 steps, Workspace& w) {
    w.check(B);
    const Index M = w.M;
    const View<c16, 1> p = w.p.view, y = w.y.view;
    const View<f8, 2> made = w.made.view;
    const View<f4, 3> tile = w.tile.view;
    std::vector<f4> planes(2 * tile.shape[1], 0.0f);
    const View<f4, 2> ys{planes.data(), {2, tile.shape[1]}};
    std::vector<f8> a(M);
    for (i8 taken = 0;; ++taken) {
        f8 largest = 0.0;
        for (Index m = 0; m < M; ++m) largest = std::max(largest, power(y[m]));
        largest = std::sqrt(largest);
        for (Index m = 0; m < M; ++m) {
            y[m] = std::sqrt(power(y[m])) > 1e-6 * largest ? y[m] / largest : 1e-6 / std::sqrt(power(p[m])) * p[m];
            ys(0, m) = static_cast<f4>(y[m].real());
            ys(1, m) = static_cast<f4>(y[m].imag());
        }
        evaluate(B, ys, 0.0f, w.h.view, made, tile);
        f8 top = 0.0, below = 0.0, all_made = 0.0;
        for (Index m = 0; m < M; ++m) {
            a[m] = std::sqrt(square(made(0, m)) + square(made(1, m)));
            top += a[m] * std::sqrt(power(p[m]));
            below += power(p[m]);
            all_made += a[m] * a[m];
        }
        w.multiple = top / below;
        if (!(top > 0.0) || all_made * below / (top * top) - 1.0 < CLOSE * CLOSE) return taken;
        if (taken == steps) return -steps;
        const f8 level = std::sqrt(all_made / below);
        for (Index m = 0; m < M; ++m) {
            if (!(a[m] > 0.0)) continue;
            const f8 ratio = std::pow(std::min(std::max(level * std::sqrt(power(p[m])) / a[m], 0.1), 10.0), ROOT);
            const f8 turn = std::arg(c16(made(0, m), made(1, m)) * std::conj(y[m])) * AHEAD;
            y[m] *= ratio * c16(std::cos(turn), std::sin(turn));
        }
    }
}

inline void define_equalise(nb::module_& m) {
    kernel(m, "equalise", &equalise,
           "Make |B h| proportional to |p| with every |h_n| = 1, from the multipliers y, by weighted Gerchberg-Saxton steps.\n\n"
           "All targets are above 0 and their phases free (Di Leonardo et al., Opt. Express 15, 2007, here over-relaxed).\n"
           "workspace: has p and y; the kernel writes y, h, made and multiple.\n"
           "Returns the number of steps, negative if more may help.",
           "B", "steps", "workspace");
}

}  // namespace pacinian::lagrange
