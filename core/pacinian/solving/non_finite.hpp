// Kernels that detect numbers that are not finite. They are compiled without the assumption that numbers are finite.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "pacinian/solving/region_groups.hpp"
#include "pacinian/solving/kernels.hpp"

namespace pacinian::solving {

inline f8 choose_phases(View<const c16, 2> G, View<const f8, 1> t, View<const f8, 1> phi, View<const f8, 1> start, i8 steps,
                 View<c16, 1> p, View<bool, 1> free) {
    const Index M = t.size();
    require(phi.size() == M && start.size() == M && p.size() == M && free.size() == M, "choose_phases: the shapes differ");
    f8 size = 0.0;
    bool any_free = false;
    for (Index m = 0; m < M; ++m) {
        const bool open = phi[m] != phi[m];
        free[m] = open && t[m] > 0.0;
        any_free = any_free || free[m];
        const f8 angle = open ? start[m] : phi[m];
        p[m] = c16(t[m] * std::cos(angle), t[m] * std::sin(angle));
        size += t[m] * t[m];
    }
    if (any_free) gerchberg_saxton(G, free, steps, p);
    return std::sqrt(size);
}

inline f8 furthest(View<const f8, 2> q, View<const f8, 1> origin, View<const f8, 1> t) {
    require(q.shape[1] == 3 && origin.size() == 3 && t.size() == q.shape[0], "furthest: the shapes differ");
    f8 most = 0.0;
    bool fine = true;
    for (Index m = 0; m < q.shape[0]; ++m) {
        const f8 x = q(m, 0) - origin[0], y = q(m, 1) - origin[1], z = q(m, 2) - origin[2];
        const f8 square = x * x + y * y + z * z;
        most = std::max(most, square);
        fine = fine && square < std::numeric_limits<f8>::infinity() && (t[m] == 0.0 || (1e-30 <= t[m] && t[m] <= 1e30));
    }
    return fine ? most : std::numeric_limits<f8>::quiet_NaN();
}

inline f8 relative_error(View<const c16, 1> p, View<const f8, 1> t, View<const f8, 1> phi) {
    require(t.size() == p.size() && phi.size() == p.size(), "relative_error: the shapes differ");
    f8 missed = 0.0, size = 0.0;
    for (Index m = 0; m < p.size(); ++m) {
        const f8 re = p[m].real(), im = p[m].imag();
        size += t[m] * t[m];
        if (phi[m] == phi[m]) {
            const f8 a = t[m] * std::cos(phi[m]) - re, b = t[m] * std::sin(phi[m]) - im;
            missed += a * a + b * b;
        } else {
            const f8 rest = t[m] - std::sqrt(re * re + im * im);
            missed += rest * rest;
        }
    }
    return size > 0.0 ? std::sqrt(missed / size) : 0.0;
}

template <typename T>
f8 peak(View<const std::complex<T>, 1> g) {
    f8 largest = 0.0;
    int wrong = 0;
    for (Index n = 0; n < g.size(); ++n) {
        const f8 re = g[n].real(), im = g[n].imag(), square = re * re + im * im;
        wrong |= !(square < std::numeric_limits<f8>::infinity());
        largest = square > largest ? square : largest;
    }
    return wrong ? std::numeric_limits<f8>::quiet_NaN() : largest;
}

inline void define_checked(nb::module_& m) {
    define_groups(m);
    kernel(m, "choose_phases", &choose_phases,
           "Write targets p, (M,), with the phases phi, where NaN by Gerchberg-Saxton steps from `start`.\n\n"
           "G: (M, M). t: amplitudes, (M,). free: where a phase may be any, and counts, (M,). Returns ||t||.",
           "G", "t", "phi", "start", "steps", "p", "free");
    kernel(m, "furthest", &furthest,
           "The largest |q_m - origin|^2, (M, 3); NaN where a number is not finite, or t_m neither 0 nor 1e-30..1e30.",
           "q", "origin", "t");
    kernel(m, "relative_error", &relative_error, "||asked - p|| / ||t||; phases phi, (M,) [rad], are as p has them where NaN.", "p", "t", "phi");
    const char* largest = "The largest |g_n|^2, or NaN where any is not finite.";
    kernel(m, "peak", &peak<float>, largest, "g");
    kernel(m, "peak", &peak<double>, largest, "g");
}

}  // namespace pacinian::solving
