// The factors on the gains that move the field around a point to another place. See field_steering.py.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/math.hpp"
#include "pacinian/native/views.hpp"

namespace pacinian::rendering {

constexpr f4 NEAREST_SQUARED = 1e-12f;  // smallest squared distance from a transducer [m^2]

inline void find_factors(View<const f4, 2> r, f4 turns, f4 exponent, View<const f4, 1> centre, View<const f4, 1> place, f4 most, View<c8, 1> out) {
    const Index N = out.size();
    require(r.shape[0] == 3 && r.shape[1] == N && centre.size() == 3 && place.size() == 3, "find_factors: the shapes differ");
    const f4 *__restrict x = r.row(0), *__restrict y = r.row(1), *__restrict z = r.row(2);
    f4* __restrict o = reinterpret_cast<f4*>(out.data);
    const f4 cx = centre[0], cy = centre[1], cz = centre[2], px = place[0], py = place[1], pz = place[2], least = 1.0f / most;
    for (Index n = 0; n < N; ++n) {
        const f4 ax = cx - x[n], ay = cy - y[n], az = cz - z[n], bx = px - x[n], by = py - y[n], bz = pz - z[n];
        const f4 before = std::sqrt(std::max(ax * ax + ay * ay + az * az, NEAREST_SQUARED));
        const f4 after = std::sqrt(std::max(bx * bx + by * by + bz * bz, NEAREST_SQUARED));
        f4 t = turns * (after - before);
        t -= std::nearbyint(t);  // -1/2..1/2 turns; below, sin and cos of half the angle, pi t
        const f4 u = t * t;
        const f4 s = t * (3.14159258f + u * (-5.16770687f + u * (2.55003119f + u * (-0.59804419f + u * 0.07721839f))));
        const f4 c = 1.0f + u * (-4.93480214f + u * (4.05870916f + u * (-1.335212f + u * (0.23493731f + u * -0.02439632f))));
        const f4 farther = std::min(std::max(after / before, least), most), size = 1.0f + exponent * (farther - 1.0f);
        o[2 * n] = size * (c * c - s * s);
        o[2 * n + 1] = 2.0f * size * (s * c);
    }
}

inline void define_steering(nb::module_& m) {
    kernel(m, "find_factors", &find_factors,
           "Write the factors on the gains that move the field around `centre` to `place`, (3,) [m]: (N,).\n\n"
           "r: positions of the transducers, (3, N) [m], with the same origin. turns: k / 2 pi [1/m]. exponent: of the distance in\n"
           "the amplitude, 0 or 1. most: largest factor on an amplitude, and 1 over the smallest.",
           "r", "turns", "exponent", "centre", "place", "most", "out");
}

}  // namespace pacinian::rendering
