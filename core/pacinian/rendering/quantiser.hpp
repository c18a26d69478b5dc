// Kernels that round gains to a device's phase and amplitude levels. They are compiled for gains that may be NaN.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/views.hpp"

namespace pacinian::rendering {

constexpr Index TILE = 256;

// Return the nearest phase level, 0..phases - 1, of re + j im; 0 if the phase is undefined.
inline i4 phase_level(f4 re, f4 im, f4 phases) {
    const f4 a = std::abs(re), b = std::abs(im), low = a < b ? a : b, high = a < b ? b : a;
    const f4 t = low / (high > 1e-30f ? high : 1e-30f), u = t * t;  // arctan(t) / 2 pi on 0..1
    f4 turn = t * (0.15915482f + u * (-0.05304561f + u * (0.0317404f + u * (-0.02210987f
        + u * (0.01528151f + u * (-0.00881427f + u * (0.0034233f + u * -0.00063029f)))))));
    turn = b > a ? 0.25f - turn : turn;
    turn = re < 0.0f ? 0.5f - turn : turn;
    turn = im < 0.0f ? 1.0f - turn : turn;
    f4 level = std::nearbyint(turn * phases);
    level = level < phases ? level : 0.0f;
    return static_cast<i4>(level > 0.0f ? level : 0.0f);
}

inline void quantise(View<const c8, 1> g, i8 phases, i8 top, i8 highest, View<const f4, 1> threshold, View<std::uint16_t, 1> phase,
                     View<std::uint16_t, 1> amplitude) {
    const Index N = g.size();
    require(threshold.size() >= N && phase.size() == N && amplitude.size() == N, "quantise: the shapes differ");
    const f4* __restrict z = reinterpret_cast<const f4*>(g.data);
    const f4* __restrict up = threshold.data;
    std::uint16_t *__restrict turns = phase.data, *__restrict levels = amplitude.data;
    const f4 circle = static_cast<f4>(phases), full = static_cast<f4>(top), most = static_cast<f4>(highest);
    for (Index n = 0; n < N; ++n) {
        const f4 re = z[2 * n], im = z[2 * n + 1];
        turns[n] = static_cast<std::uint16_t>(phase_level(re, im, circle));
        f4 level = std::floor(std::sqrt(re * re + im * im) * full + up[n]);
        level = level < most ? level : most;  // NaN becomes 0 below
        levels[n] = static_cast<std::uint16_t>(static_cast<i4>(re * re + im * im >= 0.0f && level > 0.0f ? level : 0.0f));
    }
}

inline void quantise_by(View<const c8, 1> g, i8 phases, View<const f4, 1> size, View<const f4, 1> slope,
                        View<const std::uint16_t, 1> first, i8 highest, View<const f4, 1> threshold, View<std::uint16_t, 1> phase,
                        View<std::uint16_t, 1> amplitude) {
    const Index N = g.size();
    require(threshold.size() >= N && phase.size() == N && amplitude.size() == N, "quantise_by: the shapes differ");
    require(first.size() > 1 && slope.size() + 1 >= size.size(), "quantise_by: no levels");
    const f4 K = static_cast<f4>(first.size() - 1), circle = static_cast<f4>(phases), most = static_cast<f4>(highest);
    alignas(64) f4 tile[TILE];
    alignas(64) i4 place[TILE];
    for (Index start = 0; start < N; start += TILE) {  // in passes, so that all but the table lookup vectorise
        const Index count = std::min(TILE, N - start);
        const f4 *__restrict z = reinterpret_cast<const f4*>(g.data + start), *__restrict up = threshold.data + start;
        std::uint16_t *__restrict turns = phase.data + start, *__restrict levels = amplitude.data + start;
        for (Index n = 0; n < count; ++n) {
            const f4 re = z[2 * n], im = z[2 * n + 1];
            turns[n] = static_cast<std::uint16_t>(phase_level(re, im, circle));
            f4 a = std::sqrt(re * re + im * im);
            a = a > 0.0f ? a : 0.0f;
            tile[n] = a < 1.0f ? a : 1.0f;
            place[n] = static_cast<i4>(tile[n] * K);
        }
        for (Index n = 0; n < count; ++n) {
            const f4 a = tile[n];
            Index i = first[place[n]];
            while (a >= size[i + 1]) ++i;
            tile[n] = static_cast<f4>(i) + (a - size[i]) * slope[i];
        }
        for (Index n = 0; n < count; ++n) {
            const f4 level = std::floor(tile[n] + up[n]);
            levels[n] = static_cast<std::uint16_t>(static_cast<i4>(level < most ? level : most));
        }
    }
}

inline void dequantise(View<const std::uint16_t, 1> phase, View<const std::uint16_t, 1> amplitude, View<const c8, 1> unit,
                       View<const f4, 1> size, View<c8, 1> out) {
    const Index N = out.size();
    require(phase.size() == N && amplitude.size() == N, "dequantise: the shapes differ");
    for (Index n = 0; n < N; ++n) {
        require(phase[n] < unit.size() && amplitude[n] < size.size(), "dequantise: there is no such level");
        out[n] = size[amplitude[n]] * unit[phase[n]];
    }
}

inline void define_levels(nb::module_& m) {
    kernel(m, "quantise", &quantise,
           "Round gains, (N,), to levels, phase 0..phases - 1 and amplitude 0..top, evenly spaced; none above `highest`.\n\n"
           "threshold: for each, 0..1, from how far below a level its amplitude is rounded up to it: 0.5 rounds to the nearest,\n"
           "0 down. NaN becomes amplitude 0.",
           "g", "phases", "top", "highest", "threshold", "phase", "amplitude");
    kernel(m, "quantise_by", &quantise_by,
           "As `quantise`, for levels whose amplitudes are `size`: ascending from 0 to 1, then infinity.\n\n"
           "slope: levels per amplitude above each level, 0 for the last. first: the level at or below each k / K, (K + 1,), where the\n"
           "search for a level begins; K is a power of 2.",
           "g", "phases", "size", "slope", "first", "highest", "threshold", "phase", "amplitude");
    kernel(m, "dequantise", &dequantise,
           "Write the gains that levels stand for, (N,); unit, size: what each phase and amplitude level is.", "phase", "amplitude",
           "unit", "size", "out");
}

}  // namespace pacinian::rendering
