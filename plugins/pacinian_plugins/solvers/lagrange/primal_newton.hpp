// Newton steps on the gains, towards the nearest pressures within the gain limit.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "pacinian/native/math.hpp"
#include "pacinian_plugins/solvers/lagrange/newton_step.hpp"
#include "pacinian_plugins/solvers/lagrange/workspace.hpp"

namespace pacinian::lagrange {

constexpr f8 DAMPED = 1e-3, MOST = 1e3;  // damping at the start, and at which the search gives up, in units of the mean |x|
constexpr f4 SHORTEST = 1e-3f;           // least length of a step, relative to a full step
constexpr f8 NONE_YET = std::numeric_limits<f8>::max();

// Return 1/2 ||p - made||^2 for pressures made, (2, M), where free phases are those made.
//
// Writes the phasors u along which each pressure is measured and the residual y, both (2, M), and the weight of the pressure
// across u, (M,): 1 where its phase is fixed, (|p| - t) / |p| where it is free.
inline f8 misfit(View<const c16, 1> p, View<const bool, 1> free, View<const f8, 2> made, View<f4, 2> u, View<f4, 2> y, f8* bend) {
    f8 cost = 0.0;
    for (Index m = 0; m < p.size(); ++m) {
        const c16 q(made(0, m), made(1, m));
        const f8 t = std::sqrt(power(p[m])), a = std::sqrt(power(q));
        c16 v = t > 0.0 ? p[m] / t : c16(1.0), rest = p[m] - q;
        bend[m] = 1.0;
        if (free[m]) {
            if (a > 0.0) v = q / a;
            bend[m] = (a - t) / std::max(a, 1e-3 * t);
            rest = (t - a) * v;
        }
        u(0, m) = static_cast<f4>(v.real());
        u(1, m) = static_cast<f4>(v.imag());
        y(0, m) = static_cast<f4>(rest.real());
        y(1, m) = static_cast<f4>(rest.imag());
        cost += power(rest);
    }
    return cost / 2.0;
}

// Write h + length d, (2, N), clipped to the limit; return the sum of its squares.
inline f8 shortened(View<const f4, 2> h, View<const f4, 2> d, f4 length, View<f4, 2> made) {
    const Index N = d.shape[1];
    const f4 *__restrict hr = h.row(0), *__restrict hi = h.row(1), *__restrict dr = d.row(0), *__restrict di = d.row(1);
    f4 *__restrict nr = made.row(0), *__restrict ni = made.row(1);
    f8 total = 0.0;
    for (Index n = 0; n < N; ++n) {
        const f4 re = hr[n] + length * dr[n], im = hi[n] + length * di[n];
        const f4 squared = re * re + im * im, shorter = 1.0f / std::sqrt(std::max(squared, 1.0f));
        nr[n] = re * shorter;
        ni[n] = im * shorter;
        total += std::min(squared, 1.0f);
    }
    return total;
}

inline i8 solve_primal(View<const c8, 2> B, f8 mu, i8 steps, f8 enough, f8 finished, Workspace& w) {
    w.check(B);
    const View<f4, 3> tile = w.tile.view;
    const Index M = w.M, N = w.N, rows = tile.shape[1];
    const View<c16, 1> p = w.p.view;
    const View<bool, 1> free = w.free.view, held = w.limited();
    const View<f4, 2> h = w.h.view;
    const View<f8, 2> made = w.made.view;
    std::vector<f4> planes(6 * rows, 0.0f);
    const View<f4, 2> u{planes.data(), {2, rows}}, y{planes.data() + 2 * rows, {2, rows}}, spare{planes.data() + 4 * rows, {2, rows}};
    std::vector<f8> room(3 * M, 0.0);
    f8* bend = room.data();
    const View<f8, 2> q{bend + M, {2, M}};
    const View<f4, 2> x{w.steps(0), {2, N}}, d{w.steps(2), {2, N}}, next{w.steps(4), {2, N}};
    f4* D = w.steps(6);
    f8 size = 0.0, total = 0.0;
    for (Index m = 0; m < M; ++m) size += power(p[m]);
    for (Index n = 0; n < N; ++n) total += h(0, n) * h(0, n) + h(1, n) * h(1, n);
    f8 cost = misfit(p, free, made, u, y, bend), best = cost + mu / 2.0 * total;
    f8 damping = w.damping > 0.0 ? w.damping : DAMPED;
    i8 idle = w.idle;
    i8 taken = 0;
    while (2.0 * cost > enough * enough * size && idle < 2 && damping <= MOST) {
        if (taken == steps) {
            taken = -taken;
            break;
        }
        ++taken;
        solving::adjoint_planar(B, y, x, tile);
        project_gradient(h, static_cast<f4>(mu), damping, x, held, D);
        newton_step(B, u, bend, h, held, D, x, d, q, w.system(), tile, w.columns(), spare);
        f4 length = 1.0f;
        f8 now = NONE_YET;
        while (!(now < best) && length > SHORTEST) {
            total = shortened(h, d, length, next);
            solving::apply_planar(B, next, q, tile);
            cost = misfit(p, free, q, u, y, bend);
            now = cost + mu / 2.0 * total;
            length *= 0.5f;
        }
        if (!(now < best)) {
            cost = misfit(p, free, made, u, y, bend);
            damping *= 10.0;
            continue;
        }
        idle = best - now < finished * best ? idle + 1 : 0;
        damping *= length < 0.5f ? 3.0 : 0.25;
        best = now;
        std::copy(next.data, next.data + 2 * N, h.data);
        std::copy(q.data, q.data + 2 * M, made.data);
    }
    w.error = std::sqrt(2.0 * cost / size);
    w.damping = damping;
    w.idle = idle;
    return taken;
}

inline void define_primal(nb::module_& m) {
    kernel(m, "solve_primal", &solve_primal,
           "Lower 1/2 ||p - B h||^2 + mu/2 ||h||^2 over |h_n| <= 1 by Newton steps from the gains h.\n\n"
           "enough: ||p - made|| / ||p|| to stop at. finished: two steps that lower the cost by a smaller share are the last.\n"
           "workspace: has the targets p, the gains h, and made, B h of these gains; the kernel writes h, made and error.\n"
           "Returns the number of steps, negative if more may help.",
           "B", "mu", "steps", "enough", "finished", "workspace");
}

}  // namespace pacinian::lagrange
