// Kernels for positions that may be infinite or NaN. They are compiled without the assumption of finite numbers.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "pacinian/native/math.hpp"
#include "pacinian/scene/shapes/closest.hpp"

namespace pacinian::scene {

constexpr f8 LATEST = 0.1;  // largest extrapolation time [s], equal to `motion.MAX_EXTRAPOLATION`
constexpr f8 ON = 1e-9;     // a point this near to an edge lies on it [m]

inline Index near(View<const f8, 2> bounds, f8 t, View<const f8, 2> boxes, View<i8, 1> found) {
    require(bounds.shape[1] == 8 && boxes.shape[1] == 6 && found.size() >= bounds.shape[0], "near: the shapes differ");
    Index count = 0;
    for (Index i = 0; i < bounds.shape[0]; ++i) {
        const f8* ball = bounds.row(i);
        const f8 age = std::min(std::max(t - ball[6], 0.0), LATEST), radius = ball[7];
        for (Index b = 0; b < boxes.shape[0]; ++b) {
            f8 away = 0.0;
            for (int k = 0; k < 3; ++k) {
                const f8 x = ball[k] + age * ball[3 + k];
                const f8 outside = std::max(boxes(b, k) - x, x - boxes(b, 3 + k));
                if (outside > 0.0) away += outside * outside;
            }
            if (away <= radius * radius) {
                found[count++] = i;
                break;
            }
        }
    }
    return count;
}

inline Index rough(View<const f8, 2> points, View<const f8, 1> low, View<const f8, 1> high, f8 size, View<const f8, 3> gap, f8 least,
                   f8 most, View<f8, 1> d, View<i8, 1> near) {
    require(points.shape[1] == 3 && low.size() == 3 && high.size() == 3 && gap.size() > 0, "rough: not of space");
    require(d.size() >= points.shape[0] && near.size() >= points.shape[0], "rough: the shapes differ");
    Index count = 0;
    for (Index i = 0; i < points.shape[0]; ++i) {
        f8 away = 0.0;
        Index cell[3];
        for (int k = 0; k < 3; ++k) {
            f8 x = points(i, k);
            if (!(x > low[k])) x = low[k];  // also if x is NaN
            x = std::min(x, high[k]);
            cell[k] = std::min(static_cast<Index>((x - low[k]) / size), gap.shape[k] - 1);
            away += square(points(i, k) - x);
        }
        f8 bound = gap(cell[0], cell[1], cell[2]);
        if (away > 0.0) bound = std::sqrt(away + bound * bound);  // the mesh lies inside its box
        else if (away != 0.0) bound = std::numeric_limits<f8>::infinity();
        d[i] = bound;
        if (least <= bound && bound <= most) near[count++] = i;
    }
    return count;
}

inline void sign(View<const f8, 2> points, View<const f8, 1> squared, View<const i8, 1> face, View<const f8, 2> nearest,
                 View<const f8, 3> inward, View<const f8, 2> offset, View<const f8, 2> normals, View<const i8, 2> features,
                 View<const i8, 1> where, View<f8, 1> d) {
    const Index K = points.shape[0];
    require(points.shape[1] == 3 && squared.size() == K && face.size() == K && nearest.shape[0] == K && where.size() == K,
            "sign: the shapes differ");
    for (Index k = 0; k < K; ++k) {
        f8& made = d[where[k]];
        made = std::sqrt(squared[k]);
        const f8 total = points(k, 0) + points(k, 1) + points(k, 2);
        if (!std::isfinite(total)) {
            made = std::numeric_limits<f8>::infinity();
            continue;
        }
        const Index f = face[k];
        int on = 0;
        for (int i = 0; i < 3; ++i) {
            f8 s = offset(f, i);
            for (int j = 0; j < 3; ++j) s += inward(f, i, j) * nearest(k, j);
            if (s < ON) on += 1 << i;
        }
        const Index n = features(f, on);
        f8 side = 0.0;
        for (int j = 0; j < 3; ++j) side += (points(k, j) - nearest(k, j)) * normals(n, j);
        if (side < 0.0) made = -made;
    }
}

inline void define_checked(nb::module_& m) {
    define_closest(m);
    kernel(m, "near", &near,
           "Write the indices of the objects whose bounding spheres touch any of the boxes at time t [s]; return how many.\n\n"
           "bounds: as `Scene.bounds`, (objects, 8). boxes: lower and upper corners, (boxes, 6) [m]. found: (objects,).",
           "bounds", "t", "boxes", "found");
    kernel(m, "rough", &rough,
           "Write bounds of the distance to `d`, and to `near` the indices of those from least to most [m]; return how many.\n\n"
           "low, high: corners of the box of cells [m]. size: of a cell [m]. gap: bound of each cell [m]; a point outside of the\n"
           "box is at a right angle or more from there to all in it.",
           "points", "low", "high", "size", "gap", "least", "most", "d", "near");
    kernel(m, "sign", &sign,
           "Write the signed distance of the k-th point to d[where[k]].\n\n"
           "squared: of the distance [m^2], to the point `nearest` [m] of `face`. The others: see `MeshDistance`.",
           "points", "squared", "face", "nearest", "inward", "offset", "normals", "features", "where", "d");
}

}  // namespace pacinian::scene
