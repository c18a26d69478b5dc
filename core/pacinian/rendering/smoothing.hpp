// The slew-rate limiter's kernel: align and fade, in passes that the compiler vectorises. Gains may be NaN or infinite.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/views.hpp"

namespace pacinian::rendering {

constexpr f4 SHORT = 1.0f - 4.76837158203125e-7f;  // 1 - 2^-21: factor on gains, so that rounding cannot enlarge them
constexpr f4 HUGE_GAIN = 1e30f;
constexpr f4 FORGETS = 16.0f;  // decay time of `loudest` over its rise time, so that vibration counts at its peak

inline bool follow(View<const c8, 2> gains, f4 step, i8 span, f4 growth, bool align, i8 phases, bool settled, View<f4, 1> loudest,
                   View<c8, 1> last, View<c8, 2> out) {
    const Index N = last.size(), K = out.shape[0];
    require(gains.shape[0] > 0 && gains.shape[1] == N && out.shape[1] == N && loudest.size() == 1, "follow: the shapes differ");
    bool reached = settled;
    const f4* before = reinterpret_cast<const f4*>(last.data);
    for (Index k = 0; k < K; ++k) {
        const f4* __restrict g = reinterpret_cast<const f4*>(gains.row(std::min(k, gains.shape[0] - 1)));
        f4* __restrict o = reinterpret_cast<f4*>(out.row(k));
        const f4* __restrict b = before;
        f4 ur = 1.0f, ui = 0.0f;  // the rotation that brings g closest to the previous row
        if (align) {
            f4 re = 0.0f, im = 0.0f;  // inner product of g and the previous row
            for (Index i = 0; i < N; ++i) {
                re += g[2 * i] * b[2 * i] + g[2 * i + 1] * b[2 * i + 1];
                im += g[2 * i] * b[2 * i + 1] - g[2 * i + 1] * b[2 * i];
            }
            const f4 size = std::max(std::abs(re), std::abs(im));
            if (1e-30f < size && size < HUGE_GAIN) {
                re /= size;
                im /= size;
                const f4 length = 1.0f / std::sqrt(re * re + im * im);
                ur = re * length;
                ui = im * length;
                if (phases > 0) {
                    const double circle = 6.283185307179586, levels = static_cast<double>(phases);
                    const double turn = circle * std::nearbyint(levels * std::atan2(ui, ur) / circle) / levels;
                    ur = static_cast<f4>(std::cos(turn));
                    ui = static_cast<f4>(std::sin(turn));
                }
            }
        }
        f4 most = 1.0f;  // largest fraction of the way to g
        if (step < HUGE_GAIN) {
            f4 far = 0.0f, here = 0.0f, there = 0.0f;  // squared magnitudes
            for (Index i = 0; i < N; ++i) {
                const f4 dr = g[2 * i] * ur - g[2 * i + 1] * ui - b[2 * i], di = g[2 * i] * ui + g[2 * i + 1] * ur - b[2 * i + 1];
                const f4 distance = dr * dr + di * di;
                const f4 now = b[2 * i] * b[2 * i] + b[2 * i + 1] * b[2 * i + 1];
                const f4 then = g[2 * i] * g[2 * i] + g[2 * i + 1] * g[2 * i + 1];
                far = distance > far ? distance : far;
                here = now > here ? now : here;
                there = then > there ? then : there;
            }
            here = std::sqrt(here);
            there = growth * std::sqrt(there);
            const f4 size = there > here ? there : here;
            if (reached) loudest[0] *= std::max(1.0f - step / FORGETS, 0.0f);
            loudest[0] = size > loudest[0] ? size : loudest[0];
            far = std::sqrt(far);
            most = far > step * loudest[0] ? step * loudest[0] / far : 1.0f;
        }
        const f4 even = 1.0f / static_cast<f4>(std::max<i8>(span - k, 1));
        reached = most >= 1.0f && even >= 1.0f;
        const f4 part = reached ? SHORT : SHORT * std::min(most, even), rest = reached ? 0.0f : SHORT - part;
        for (Index i = 0; i < N; ++i) {
            const f4 re = part * (g[2 * i] * ur - g[2 * i + 1] * ui) + rest * b[2 * i];
            const f4 im = part * (g[2 * i] * ui + g[2 * i + 1] * ur) + rest * b[2 * i + 1];
            o[2 * i] = std::abs(re) < HUGE_GAIN ? re : 0.0f;
            o[2 * i + 1] = std::abs(im) < HUGE_GAIN ? im : 0.0f;
        }
        before = o;
    }
    const c8* end = reinterpret_cast<const c8*>(before);
    if (end != last.data) std::copy(end, end + N, last.data);
    return reached;
}

inline void define_smooth(nb::module_& m) {
    kernel(m, "follow", &follow,
           "Write rows, (K, N), that go from `last`, (N,), towards `gains`, (K, N) or (1, N) for all rows.\n\n"
           "step: largest movement of a gain from row to row, over `loudest`. span: least number of rows for the whole way.\n"
           "growth: factor by which the gains will still grow while they fade in. align: whether to turn the gains towards `last`: by\n"
           "whole levels of phase if `phases` is their number, by any angle if it is 0. settled: whether `last` had reached its gains.\n"
           "loudest: largest recent gain, (1,), which decays while the gains are reached. `last` becomes the last row. A number that\n"
           "is not finite becomes 0. Returns whether the last row has reached its gains.",
           "gains", "step", "span", "growth", "align", "phases", "settled", "loudest", "last", "out");
}

}  // namespace pacinian::rendering
