// Greedy search: gives one transducer after the other the phase with the least error.
#pragma once
#include <cmath>
#include <limits>

#include "pacinian/native/views.hpp"

namespace pacinian::greedy {

inline i8 choose(View<const f4, 3> B, View<const f4, 1> t, View<const i8, 1> order, View<const f4, 2> E, View<f4, 2> h, View<f4, 2> p) {
    const Index M = t.size(), L = E.shape[1];
    require(B.shape[1] == 2 && B.shape[2] == M && E.shape[0] == 2 && h.shape[0] == 2 && h.shape[1] == B.shape[0], "choose: the shapes differ");
    require(p.shape[0] == 2 && p.shape[1] == M, "choose: the shapes differ");
    f4 *__restrict pr = p.row(0), *__restrict pi = p.row(1);
    const f4* __restrict asked = t.data;
    i8 changed = 0;
    for (Index k = 0; k < order.size(); ++k) {
        const Index n = order[k];
        const f4 *__restrict br = B.row(n, 0), *__restrict bi = B.row(n, 1);
        const f4 hr = h(0, n), hi = h(1, n);
        f4 size = 0.0f;
        for (Index m = 0; m < M; ++m) {
            pr[m] -= br[m] * hr - bi[m] * hi;
            pi[m] -= br[m] * hi + bi[m] * hr;
            size += br[m] * br[m] + bi[m] * bi[m];
        }
        if (size == 0.0f) continue;  // the transducer reaches no point
        f4 least = std::numeric_limits<f4>::max();
        Index best = 0;
        for (Index l = 0; l < L; ++l) {
            const f4 er = E(0, l), ei = E(1, l);
            f4 cost = 0.0f;
            for (Index m = 0; m < M; ++m) {
                const f4 re = pr[m] + br[m] * er - bi[m] * ei, im = pi[m] + br[m] * ei + bi[m] * er;
                const f4 miss = std::sqrt(re * re + im * im) - asked[m];
                cost += miss * miss;
            }
            if (cost < least) {
                least = cost;
                best = l;
            }
        }
        const f4 er = E(0, best), ei = E(1, best);
        changed += er != hr || ei != hi;
        h(0, n) = er;
        h(1, n) = ei;
        for (Index m = 0; m < M; ++m) {
            pr[m] += br[m] * er - bi[m] * ei;
            pi[m] += br[m] * ei + bi[m] * er;
        }
    }
    return changed;
}

inline void define(nb::module_& m) {
    kernel(m, "choose", &choose,
           "Give each transducer of `order` the best of E, keeping p = B h; return how many have changed.\n\n"
           "The best has the least sum_m (|p_m + B_mn E_l| - t_m)^2, p being what the others make; the first of equals.\n"
           "B: (N, 2, M), E: (2, L), h: (2, N), p: (2, M): real and imaginary parts. t: (M,).",
           "B", "t", "order", "E", "h", "p");
}

}  // namespace pacinian::greedy
