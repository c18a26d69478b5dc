// Dense kernels for the small systems of K equations, in double precision.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/math.hpp"

namespace pacinian::lagrange {

constexpr f8 LOST = 1e-14;  // pivot, relative to the largest diagonal element, below which it counts as rounding error

inline f8 scale_for_single(f8 size, f8 relative, f8 mu, i8 N) {
    const f8 root = std::sqrt(mu / relative);
    return std::min(std::max(size, std::sqrt(mu)), 1e3 * static_cast<f8>(N) * root) / size;
}

// Factor the lower triangle of A, (K, K) or more, in place: A = L S L^T, S = +1 then -1.
//
// The first `positive` pivots should be positive, the others negative. A pivot that has the wrong sign, or is only rounding
// error, is replaced by one so large that its unknown stays 0. Returns the number of such pivots.
inline Index factor(View<f8, 2> A, Index K, Index positive) {
    require(0 <= positive && positive <= K && K <= A.shape[0] && K <= A.shape[1], "factor: the shapes differ");
    Index lost = 0;
    f8 largest = 0.0;
    for (Index i = 0; i < K; ++i) largest = std::max(largest, std::abs(A(i, i)));
    for (Index i = 0; i < K; ++i) {
        f8* row = A.row(i);
        for (Index j = 0; j < i; ++j) {
            const f8* other = A.row(j);
            f8 total = 0.0;
            for (Index k = 0; k < std::min(j, positive); ++k) total += row[k] * other[k];
            for (Index k = positive; k < j; ++k) total -= row[k] * other[k];
            row[j] = (row[j] - total) / (j < positive ? other[j] : -other[j]);
        }
        f8 total = 0.0;
        for (Index k = 0; k < std::min(i, positive); ++k) total += row[k] * row[k];
        for (Index k = positive; k < i; ++k) total -= row[k] * row[k];
        f8 pivot = i < positive ? row[i] - total : total - row[i];
        if (!(pivot > LOST * largest)) {
            ++lost;
            pivot = 1e30 * std::max(largest, 1e-270);
        }
        row[i] = std::sqrt(pivot);
    }
    return lost;
}

// Solve L S L^T x = b in place.
inline void substitute(View<const f8, 2> L, Index K, Index positive, f8* b) {
    for (Index i = 0; i < K; ++i) {
        const f8* row = L.row(i);
        f8 total = 0.0;
        for (Index k = 0; k < i; ++k) total += row[k] * b[k];
        b[i] = (b[i] - total) / row[i];
    }
    for (Index i = positive; i < K; ++i) b[i] = -b[i];
    for (Index i = K - 1; i >= 0; --i) {
        const f8* row = L.row(i);
        b[i] /= row[i];
        for (Index k = 0; k < i; ++k) b[k] -= row[k] * b[i];
    }
}

inline void substitute_in(View<const f8, 2> L, i8 K, i8 positive, View<f8, 1> b) {
    require(K <= L.shape[0] && K <= L.shape[1] && K <= b.size(), "substitute: the shapes differ");
    substitute(L, K, positive, b.data);
}

// Write scale Re(conj(u_i) G_ij u_j), for the equations of the given samples, to the lower triangle of A.
inline void rotate_gram(View<const c16, 2> G, const i8* sample, Index K, View<const f4, 2> u, f8 scale, View<f8, 2> A) {
    const f4 *re = u.row(0), *im = u.row(1);
    for (Index i = 0; i < K; ++i) {
        const c16* row = G.row(sample[i]);
        const f8 ur = re[i], ui = im[i];
        for (Index j = 0; j <= i; ++j) {
            const c16 z = row[sample[j]];
            const f8 vr = re[j], vi = im[j];
            A(i, j) = scale * (z.real() * (ur * vr + ui * vi) - z.imag() * (ur * vi - ui * vr));
        }
    }
}

inline void rotate_gram_in(View<const c16, 2> G, View<const i8, 1> sample, View<const f4, 2> u, f8 scale, View<f8, 2> A) {
    const Index K = sample.size();
    require(u.shape[0] == 2 && u.shape[1] >= K && A.shape[0] >= K && A.shape[1] >= K, "rotate_gram: the shapes differ");
    rotate_gram(G, sample.data, K, u, scale, A);
}

inline void define_small(nb::module_& m) {
    kernel(m, "scale_for_single", &scale_for_single,
           "Return the factor that scales targets of norm `size` [Pa per unit limit] into the range of single precision.\n\n"
           "Up to the lower bound, 2 sqrt(mu), nothing reaches its limit: ||g|| <= ||p|| / (2 sqrt(mu)). Beyond the upper one\n"
           "the answer hardly changes. relative: mu over trace(G) / M.",
           "size", "relative", "mu", "N");
    kernel(m, "factor", &factor,
           "Factor the lower triangle of A, (K, K) or more, in place: A = L S L^T, S = +1 then -1.\n\n"
           "The first `positive` pivots are to be positive, the others negative. One of the wrong sign, or that is rounding,\n"
           "becomes so large that its unknown is left at 0. Returns how many did.",
           "A", "K", "positive");
    kernel(m, "rotate_gram", &rotate_gram_in,
           "Write the lower triangle of scale Re(conj(u_i) G_ij u_j) for equations of the given samples, (K,), to A.\n\n"
           "G: (M, M). u: (2, K). A: (K, K) or more.",
           "G", "sample", "u", "scale", "A");
    kernel(m, "substitute", &substitute_in, "Solve L S L^T x = b in place.", "L", "K", "positive", "b");
}

}  // namespace pacinian::lagrange
