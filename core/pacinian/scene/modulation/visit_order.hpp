// The order in which a focus visits points: through them all, or around them.
#pragma once
#include <algorithm>

#include "pacinian/native/math.hpp"

namespace pacinian::scene {

constexpr f8 TIE = 1.0 - 1e-6;  // of squared distances: what is as near up to rounding comes in order

inline void visit_through(View<const f8, 2> q, View<i8, 1> order) {
    const Index M = q.shape[0];
    require(q.shape[1] == 3 && order.size() == M, "visit_through: the shapes differ");
    std::vector<char> left(M, 1);
    Index i = 0;
    for (Index m = 0; m < M; ++m) {
        order[m] = i;
        left[i] = 0;
        Index best = -1;
        f8 least = 0.0;
        for (Index j = 0; j < M; ++j) {
            if (!left[j]) continue;
            const f8 d = square(q(j, 0) - q(i, 0)) + square(q(j, 1) - q(i, 1)) + square(q(j, 2) - q(i, 2));
            if (best < 0 || d < TIE * least) {
                best = j;
                least = d;
            }
        }
        i = best;
    }
}

inline Index visit_around(View<const f8, 2> q, View<const i8, 1> order, View<i8, 1> corners) {
    const Index M = q.shape[0];
    require(q.shape[1] == 2 && order.size() == M && corners.size() >= 2 * M + 1, "visit_around: the shapes differ");
    Index count = 0, least = 2;
    for (Index m = 0; m < 2 * M - 1; ++m) {
        if (m == M) least = count + 1;
        const Index i = order[m < M ? m : 2 * M - 2 - m];
        while (count >= least) {
            const Index a = corners[count - 2], b = corners[count - 1];
            const f8 x = q(b, 0) - q(a, 0), y = q(b, 1) - q(a, 1);
            if (x * (q(i, 1) - q(a, 1)) - y * (q(i, 0) - q(a, 0)) > 0.0) break;  // a turn to the left
            --count;
        }
        corners[count++] = i;
    }
    return std::max<Index>(count - 1, 1);
}

inline void define_tour(nb::module_& m) {
    kernel(m, "visit_through", &visit_through,
           "Write the order of points q, (M, 3) [m], to `order`, (M,): from the first on, always the nearest that is left.", "q", "order");
    kernel(m, "visit_around", &visit_around,
           "Write which points q, (M, 2) [m], are corners of their hull, anticlockwise; of points on a line, its ends.\n\n"
           "order: of the points by x, then y, (M,). corners: room for 2 M + 1. Andrew's monotone chain: the lower side, then the\n"
           "upper. Returns how many.",
           "q", "order", "corners");
}

}  // namespace pacinian::scene
