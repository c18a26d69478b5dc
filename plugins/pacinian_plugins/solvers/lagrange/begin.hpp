// Where Newton steps begin: targets in units of the limit, and the multipliers of the problem without it. NaN is a free phase.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/solving/unbounded.hpp"
#include "pacinian_plugins/solvers/lagrange/dense_kernels.hpp"

namespace pacinian::lagrange {

inline i8 begin(View<const c16, 2> G, View<const f8, 1> t, View<const f8, 1> phi, View<const f8, 1> start, i8 steps, f8 mu, f8 relative,
                f8 unit, i8 N, View<c16, 1> p, View<bool, 1> free, View<c16, 1> y, View<c16, 2> L, View<f8, 1> found) {
    const Index M = p.size();
    require(y.size() == M && L.shape[0] >= M && L.shape[1] >= M && found.size() >= 1, "begin: the shapes differ");
    const f8 norm = solving::choose(G, t, phi, start, steps, p, free), share = within(norm / unit, relative, mu, N);
    found[0] = share;
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
    return M;
}

inline void define_begin(nb::module_& m) {
    kernel(m, "begin", &begin,
           "Write targets p [Pa per unit limit], with phases chosen as by `choose`, and y = mu (G + mu I)^-1 p.\n\n"
           "G: (M, M); for few samples it is quicker to solve here than by LAPACK. t, phi, start: (M,). L: room, (M, M).\n"
           "found: by how much the targets are scaled, as by `within`.",
           "G", "t", "phi", "start", "steps", "mu", "relative", "unit", "N", "p", "free", "y", "L", "found");
}

}  // namespace pacinian::lagrange
