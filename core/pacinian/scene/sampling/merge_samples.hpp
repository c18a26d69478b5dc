// Merge samples of different sources that the array cannot resolve.
#pragma once
#include <algorithm>

#include "pacinian/native/math.hpp"

namespace pacinian::scene {

inline Index merge(View<const f8, 2> points, View<const f8, 1> P, View<const f8, 1> area, View<const i8, 1> source,
                   View<const i8, 1> group, View<const f8, 1> radius, View<f8, 1> pressed, View<f8, 1> stands, View<bool, 1> kept) {
    const Index M = points.shape[0];
    require(points.shape[1] == 3 && P.size() == M && area.size() == M && source.size() == M && group.size() == M, "merge: no samples");
    require(radius.size() == M && pressed.size() == M && stands.size() == M && kept.size() == M, "merge: the shapes differ");
    Index gone = 0;
    for (Index i = 0; i < M; ++i) {
        pressed[i] = P[i];
        stands[i] = area[i];
        kept[i] = true;
    }
    for (Index j = 1; j < M; ++j) {
        for (Index i = 0; i < j; ++i) {
            if (!kept[i] || source[i] == source[j] || group[i] != group[j]) continue;
            const f8 squared =
                square(points(i, 0) - points(j, 0)) + square(points(i, 1) - points(j, 1)) + square(points(i, 2) - points(j, 2));
            if (squared >= square(std::min(radius[i], radius[j]))) continue;
            const f8 force = pressed[i] * stands[i] + P[j] * area[j];
            stands[i] += area[j];
            pressed[i] = force / stands[i];
            kept[j] = false;
            ++gone;
            break;
        }
    }
    return gone;
}

inline void define_broad(nb::module_& m) {
    kernel(m, "merge", &merge,
           "Merge samples of different sources and one group, nearer than both their `radius` [m], into the first of them.\n\n"
           "points: (M, 3) [m], in order of importance. P: (M,) [Pa]. area: (M,) [m^2]. source, group: (M,). Writes pressures,\n"
           "areas (a sample that takes another has both areas and the sum of the forces), and which are kept; returns how many\n"
           "are not.",
           "points", "P", "area", "source", "group", "radius", "pressed", "stands", "kept");
}

}  // namespace pacinian::scene
