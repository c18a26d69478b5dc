// Contact kernels: find the skin points that may touch an object, and distribute their forces among nodes.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/scene/hands/capsules.hpp"

namespace pacinian::scene {

constexpr f8 TINY = 1e-300;

inline Index candidates(View<const f8, 2> points, View<const f8, 2> normals, View<const i8, 1> bone, View<const f8, 2> bounds,
                        View<const f8, 1> centre, f8 radius, View<const f8, 2> R, View<const f8, 2> corners, View<i8, 1> which,
                        View<f8, 2> local) {
    const Index K = points.shape[0], C = bounds.shape[0], V = corners.shape[0];
    require(points.shape[1] == 3 && normals.shape[0] == K && normals.shape[1] == 3 && bone.size() == K, "candidates: no skin");
    require(bounds.shape[1] == 4 && centre.size() == 3 && R.size() == 9 && corners.shape[1] == 3, "candidates: not of space");
    require(which.size() >= K && local.shape[0] >= K && local.shape[1] == 3, "candidates: no room");
    std::vector<char> touches(C);
    for (Index c = 0; c < C; ++c) {
        f8 squared = 0.0;
        for (int k = 0; k < 3; ++k) squared += square(bounds(c, k) - centre[k]);
        touches[c] = squared <= square(bounds(c, 3) + radius);
    }
    Index count = 0;
    for (Index i = 0; i < K; ++i) {
        if (!touches[bone[i]]) continue;
        const f8 x = points(i, 0) - centre[0], y = points(i, 1) - centre[1], z = points(i, 2) - centre[2];
        if (x * x + y * y + z * z > radius * radius) continue;
        bool faces = V == 0;
        for (Index v = 0; v < V && !faces; ++v) {
            f8 along = 0.0;
            for (int k = 0; k < 3; ++k) along += normals(i, k) * (corners(v, k) - points(i, k));
            faces = along > 0.0;
        }
        if (!faces) continue;
        which[count] = i;
        for (int k = 0; k < 3; ++k) local(count, k) = x * R(0, k) + y * R(1, k) + z * R(2, k);
        ++count;
    }
    return count;
}

inline void box(View<const f8, 2> bounds, View<f8, 1> out) {
    require(bounds.shape[1] == 4 && out.size() == 6, "box: the shapes differ");
    for (int k = 0; k < 3; ++k) {
        f8 low = 1e300, high = -1e300;
        for (Index c = 0; c < bounds.shape[0]; ++c) {
            low = std::min(low, bounds(c, k) - bounds(c, 3));
            high = std::max(high, bounds(c, k) + bounds(c, 3));
        }
        out[k] = low;
        out[3 + k] = high;
    }
}

// Return the mean cos^2 of the angle of incidence from places of the array, (V, 3), with weights of 1 / distance^2.
inline f8 seen(const f8* point, const f8* normal, View<const f8, 2> viewpoints) {
    f8 total = 0.0, weights = 0.0;
    for (Index v = 0; v < viewpoints.shape[0]; ++v) {
        f8 along = 0.0, away = 0.0;
        for (int k = 0; k < 3; ++k) {
            const f8 d = viewpoints(v, k) - point[k];
            along += normal[k] * d;
            away += d * d;
        }
        const f8 weight = 1.0 / std::max(away, TINY);
        along = std::max(along, 0.0);
        total += along * along * weight * weight;
        weights += weight;
    }
    return total / weights;
}

// Find the pressed points among `which`, and the force on each. The pressure at a depth is the same law as
// `Material.pressure` in scene/material.py, which points, paths and particles use: change both.
inline Index press(View<const f8, 1> d, View<const i8, 1> which, f8 reach, f8 stiffness, f8 max_pressure, View<const f8, 2> points,
                   View<const f8, 2> normals, View<const f8, 1> area, View<const i8, 1> bone, View<const f8, 1> slack,
                   View<const f8, 2> capsules, View<const f8, 2> viewpoints, f8 blocked, f8 full, View<i8, 1> inside, View<f8, 1> force) {
    const Index I = which.size(), K = points.shape[0];
    require(d.size() == I && inside.size() >= I && force.size() >= I && area.size() == K, "press: the shapes differ");
    require(points.shape[1] == 3 && normals.shape[0] == K && normals.shape[1] == 3, "press: no skin");
    require(viewpoints.shape[1] == 3 || !viewpoints.shape[0], "press: not of space");
    std::vector<i8> touched(I);
    std::vector<f8> pressure(I);
    Index count = 0, kept = 0;
    for (Index i = 0; i < I; ++i) {
        const f8 depth = reach - d[i];
        if (depth <= 0.0) continue;
        inside[count] = i;
        touched[count] = which[i];
        pressure[count] = std::min(depth * stiffness, max_pressure);
        ++count;
    }
    std::vector<char> deep(count, 0);
    static_assert(sizeof(bool) == 1);
    if (capsules.shape[0]) {
        View<const i8, 1> of{touched.data(), {count}};
        buried(capsules, points, bone, slack, of, View<bool, 1>{reinterpret_cast<bool*>(deep.data()), {count}});
    }
    for (Index n = 0; n < count; ++n) {
        const Index k = touched[n];
        f8 share = deep[n] ? 0.0 : 1.0;
        if (viewpoints.shape[0] && !deep[n]) {
            f8 x = (seen(points.row(k), normals.row(k), viewpoints) - blocked) / (full - blocked);
            x = std::min(std::max(x, 0.0), 1.0);
            share = x * x * (3.0 - 2.0 * x);
        }
        if (!(share > 0.0 && pressure[n] * area[k] > 0.0)) continue;
        inside[kept] = inside[n];
        force[kept] = share * pressure[n] * area[k];
        ++kept;
    }
    return kept;
}

inline Index stale(View<const i8, 1> which, View<const f8, 2> local, View<const f8, 2> places, View<const f8, 1> known, f8 beyond,
                   f8 deep, View<f8, 1> d, View<i8, 1> ask) {
    const Index I = which.size();
    require(local.shape[0] >= I && local.shape[1] == 3 && places.shape[1] == 3 && known.size() == places.shape[0], "stale: no points");
    require(d.size() >= I && ask.size() >= I, "stale: the shapes differ");
    Index count = 0;
    for (Index i = 0; i < I; ++i) {
        const Index k = which[i];
        f8 away = 0.0;
        for (int x = 0; x < 3; ++x) away += square(local(i, x) - places(k, x));
        away = std::sqrt(away);
        if (known[k] - away > beyond) d[i] = known[k] - away;
        else if (known[k] + away < -deep) d[i] = known[k] + away;
        else ask[count++] = i;
    }
    return count;
}

inline Index share_out(View<const i8, 1> touched, View<const f8, 1> force, View<const i8, 2> indices, View<const f8, 2> weights,
                       f8 least, View<f8, 1> got, View<i8, 1> nodes) {
    const Index width = indices.shape[1];
    require(force.size() >= touched.size() && weights.shape[0] == indices.shape[0] && weights.shape[1] == width, "share_out: no points");
    require(got.size() > 0 && nodes.size() >= got.size(), "share_out: the shapes differ");
    std::fill(got.data, got.data + got.size(), 0.0);
    for (Index t = 0; t < touched.size(); ++t) {
        const Index k = touched[t];
        for (Index j = 0; j < width; ++j) got[indices(k, j)] += weights(k, j) * force[t];
    }
    f8 most = got[0];
    for (Index n = 1; n < got.size(); ++n) most = std::max(most, got[n]);
    Index count = 0;
    for (Index n = 0; n < got.size(); ++n)
        if (got[n] > least * most) nodes[count++] = n;
    return count;
}

inline Index around(View<const f8, 2> points, View<const f8, 2> normals, i8 count, View<const f8, 2> q, View<const f8, 1> centre,
                    f8 inner, f8 outer, View<const f8, 2> capsules, View<const i8, 1> bone, View<const f8, 1> slack, i8 most,
                    View<i8, 1> which, View<i8, 1> nearest) {
    const Index K = q.shape[0];
    require(points.shape[1] == 3 && normals.shape[0] == points.shape[0] && normals.shape[1] == 3, "around: no skin");
    require(K > 0 && q.shape[1] == 3 && centre.size() == 3, "around: not of space");
    require(count <= points.shape[0] && which.size() >= count && nearest.size() >= count, "around: the shapes differ");
    f8 low[3] = {q(0, 0), q(0, 1), q(0, 2)}, high[3] = {q(0, 0), q(0, 1), q(0, 2)};
    for (Index k = 0; k < K; ++k) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], q(k, i));
            high[i] = std::max(high[i], q(k, i));
        }
    }
    Index found = 0;
    for (Index n = 0; n < count; ++n) {
        const f8* p = points.row(n);
        bool near = true;
        f8 faces = 0.0;
        for (int i = 0; i < 3; ++i) {
            near = near && low[i] - outer < p[i] && p[i] < high[i] + outer;
            faces += normals(n, i) * (centre[i] - p[i]);
        }
        if (!near || faces <= 0.0) continue;
        f8 best = outer * outer;
        Index at = -1;
        for (Index k = 0; k < K; ++k) {
            const f8 squared = square(q(k, 0) - p[0]) + square(q(k, 1) - p[1]) + square(q(k, 2) - p[2]);
            if (squared < best) {
                best = squared;
                at = k;
                if (squared < inner * inner) break;
            }
        }
        if (at < 0 || best < inner * inner) continue;
        which[found] = n;
        nearest[found] = at;
        ++found;
    }
    if (!capsules.shape[0] || !found) return std::min<Index>(found, most);
    std::vector<char> deep(found, 0);
    buried(capsules, points, bone, slack, {which.data, {found}}, View<bool, 1>{reinterpret_cast<bool*>(deep.data()), {found}});
    Index kept = 0;
    for (Index n = 0; n < found && kept < most; ++n) {
        if (deep[n]) continue;
        which[kept] = which[n];
        nearest[kept] = nearest[n];
        ++kept;
    }
    return kept;
}

inline void define_contact(nb::module_& m) {
    kernel(m, "candidates", &candidates,
           "Write which points of a skin lie in a sphere and face any of the corners, and where in its frame; return how many.\n\n"
           "points, normals: (K, 3). bone: of each, (K,). bounds: sphere of each bone, (C, 4). centre: (3,), radius: [m]. R: the\n"
           "frame's axes as columns, (3, 3). corners: (V, 3); without any, points need not face anything. which: (K,).\n"
           "local: (K, 3).",
           "points", "normals", "bone", "bounds", "centre", "radius", "R", "corners", "which", "local");
    kernel(m, "box", &box, "Write the lower and the upper corner of the box around spheres, (C, 4), to `out`, (6,) [m].", "bounds", "out");
    kernel(m, "press", &press,
           "Write which points of a skin are pressed, and with how much; return how many.\n\n"
           "d: signed distance of the points `which`, (I,) [m]. reach [m], stiffness [Pa/m], max_pressure [Pa]: of a material.\n"
           "points, normals, area, bone, slack: of the skin, (K, 3), (K,). capsules: of the hand, (C, 8), inside of which, deeper\n"
           "than the slack, there is no skin; none for a mesh. viewpoints: positions of transducers, (V, 3); none: all skin is pressed.\n"
           "blocked, full: weighted mean cos^2 of the angle of incidence at which skin is not pressed, and fully. inside: indices into `which`, (I,). force: of each [N], (I,).",
           "d", "which", "reach", "stiffness", "max_pressure", "points", "normals", "area", "bone", "slack", "capsules",
           "viewpoints", "blocked", "full", "inside", "force");
    kernel(m, "stale", &stale,
           "Reuse the known distances of points that have moved little; list the others, and return how many these are.\n\n"
           "A distance changes by no more than the point has moved. which: points, (I,). local: where they are, (I, 3). places,\n"
           "known: of all points, where each distance was asked, far away if never, and what it was, (K, 3), (K,). d: (I,), if\n"
           "farther outside than `beyond` or deeper inside than `deep` [m] not exactly. ask: the places in `which` of the others.",
           "which", "local", "places", "known", "beyond", "deep", "d", "ask");
    kernel(m, "share_out", &share_out,
           "Share forces on points out among the nodes of a level; write which nodes got any, in order, and return how many.\n\n"
           "touched: (T,). force: (T,) [N]. indices, weights: of every point, (K, 3). least: share of the largest that counts as\n"
           "any. got: by node, (count,) [N]. nodes: (count,).",
           "touched", "force", "indices", "weights", "least", "got", "nodes");
    kernel(m, "around", &around,
           "Write which of the first `count` points of a skin lie beside q, (K, 3), and by which of these they are nearest.\n\n"
           "points, normals: (N, 3). inner, outer: how far away the nearest of q is [m]. centre: (3,); points that face away from\n"
           "it are left out, and so are those inside other flesh. capsules, bone, slack: as for `buried`; no capsules for a mesh.\n"
           "most: largest number of points. which, nearest: (count,). Returns how many there are.",
           "points", "normals", "count", "q", "centre", "inner", "outer", "capsules", "bone", "slack", "most", "which", "nearest");
}

}  // namespace pacinian::scene
