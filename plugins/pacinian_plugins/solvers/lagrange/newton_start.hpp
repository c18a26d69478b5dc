// Start of the Newton steps: targets in units of the gain limit, and the multipliers of the problem without a limit. A phase of
// NaN is free.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/solving/non_finite.hpp"
#include "pacinian_plugins/solvers/lagrange/dense_kernels.hpp"
#include "pacinian_plugins/solvers/lagrange/workspace.hpp"

namespace pacinian::lagrange {

inline f8 start(View<const c16, 2> G, View<const f8, 1> t, View<const f8, 1> phi, View<const f8, 1> first, i8 steps, f8 mu,
                f8 relative, f8 unit, Workspace& w) {
    const Index M = w.M;
    require(M <= MAX_START, "start: too many samples");
    const View<c16, 1> p = w.p.view, y = w.y.view;
    const View<c16, 2> L = w.factor();
    const f8 norm = solving::choose_phases(G, t, phi, first, steps, p, w.free.view), share = scale_for_single(norm / unit, relative, mu, w.N);
    for (Index m = 0; m < M; ++m) {
        p[m] *= share / unit;
        y[m] = mu * p[m];
    }
    for (Index i = 0; i < M; ++i) {
        for (Index j = 0; j < i; ++j) {
            c16 total = G(i, j);
            for (Index k = 0; k < j; ++k) total -= L(i, k) * std::conj(L(j, k));
            L(i, j) = total / L(j, j).real();
        }
        f8 pivot = G(i, i).real() + mu;
        for (Index k = 0; k < i; ++k) pivot -= power(L(i, k));
        L(i, i) = std::sqrt(std::max(pivot, LOST * mu));
        for (Index k = 0; k < i; ++k) y[i] -= L(i, k) * y[k];
        y[i] /= L(i, i).real();
    }
    for (Index i = M - 1; i >= 0; --i) {
        y[i] /= L(i, i).real();
        for (Index k = 0; k < i; ++k) y[k] -= std::conj(L(i, k)) * y[i];
    }
    return share;
}

inline void define_start(nb::module_& m) {
    m.attr("MAX_START") = MAX_START;
    kernel(m, "start", &start,
           "Write targets p [Pa per unit limit], with phases chosen as by `choose_phases`, and y = mu (G + mu I)^-1 p.\n\n"
           "G: (M, M), for at most MAX_START samples, for which this is quicker than LAPACK. t, phi, first: (M,). Returns the\n"
           "factor on the targets, as by `scale_for_single`.",
           "G", "t", "phi", "first", "steps", "mu", "relative", "unit", "workspace");
}

}  // namespace pacinian::lagrange
