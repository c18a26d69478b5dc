// The hand's flesh as a union of tapered capsules, one around each bone and some that fill the palm.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/acoustics/tapered_capsules.hpp"
#include "pacinian/native/math.hpp"

namespace pacinian::scene {

using acoustics::from_axis;
using acoustics::FromAxis;

constexpr f8 ROUNDING = 1e-10;  // a point at most this deep inside counts as on the surface [m]
constexpr i8 TURNS = 50;        // steps before the search stops changing its direction
constexpr f8 ARRIVED = 1e-12;   // the search ends at this depth below the surface [m]
constexpr f8 NO_LENGTH = 1e-15; // a point this near to an axis has no direction away from it [m]

inline void require_capsules(View<const f8, 2> capsules) { require(capsules.shape[1] == 8, "capsules have eight columns"); }

inline void capsules(View<const f8, 2> joints, View<const f8, 1> radii, View<const i8, 2> ends, View<f8, 2> out) {
    require_capsules(out);
    require(ends.shape[0] == out.shape[0] && ends.shape[1] == 4 && joints.shape[1] == 3, "capsules: the shapes differ");
    for (Index c = 0; c < ends.shape[0]; ++c) {
        const i8 i = ends(c, 0), j = ends(c, 1), k = ends(c, 2), m = ends(c, 3);
        for (int x = 0; x < 3; ++x) {
            out(c, x) = (joints(i, x) + joints(j, x)) / 2.0;
            out(c, 3 + x) = (joints(k, x) + joints(m, x)) / 2.0;
        }
        out(c, 6) = (radii[i] + radii[j]) / 2.0;
        out(c, 7) = (radii[k] + radii[m]) / 2.0;
    }
}

inline void bounds(View<const f8, 2> capsules, View<f8, 2> out) {
    require_capsules(capsules);
    require(out.shape[0] == capsules.shape[0] && out.shape[1] == 4, "bounds: the shapes differ");
    for (Index c = 0; c < capsules.shape[0]; ++c) {
        f8 squared = 0.0;
        for (int x = 0; x < 3; ++x) {
            const f8 half = (capsules(c, 3 + x) - capsules(c, x)) / 2.0;
            out(c, x) = capsules(c, x) + half;
            squared += half * half;
        }
        out(c, 3) = std::sqrt(squared) + std::max(capsules(c, 6), capsules(c, 7));
    }
}

// Signed distance to the union [m], and the nearest capsule or, inside, the one in which the point is deepest.
struct Union {
    f8 away;
    Index bone;
};

inline Union of_union(View<const f8, 2> capsules, const f8 (&p)[3]) {
    Union best{1e300, 0};
    for (Index c = 0; c < capsules.shape[0]; ++c) {
        const FromAxis way = from_axis(capsules, c, p[0], p[1], p[2]);
        if (way.away - way.radius < best.away) best = {way.away - way.radius, c};
    }
    return best;
}

// Write the direction from a capsule's axis to a point to n, and return the distance to the surface that way [m].
inline f8 outward(View<const f8, 2> capsules, Index c, const f8 (&p)[3], f8 (&n)[3]) {
    const FromAxis way = from_axis(capsules, c, p[0], p[1], p[2]);
    if (way.away > NO_LENGTH) {
        n[0] = way.x / way.away, n[1] = way.y / way.away, n[2] = way.z / way.away;
        return way.radius - way.away;
    }
    const f8 ux = capsules(c, 3) - capsules(c, 0), uy = capsules(c, 4) - capsules(c, 1), uz = capsules(c, 5) - capsules(c, 2);
    if (std::abs(ux) > std::abs(uz)) {  // any direction across the axis
        const f8 size = std::sqrt(ux * ux + uy * uy);
        n[0] = -uy / size, n[1] = ux / size, n[2] = 0.0;
    } else {
        const f8 size = std::sqrt(uy * uy + uz * uz);
        n[0] = 0.0, n[1] = size > 0.0 ? -uz / size : 0.0, n[2] = size > 0.0 ? uy / size : 1.0;
    }
    return way.radius - way.away;
}

inline void nearest(View<const f8, 2> capsules, View<const f8, 2> points, i8 steps, View<f8, 2> surface, View<f8, 2> normals,
                    View<f8, 1> distance, View<i8, 1> bone) {
    const Index P = points.shape[0];
    require_capsules(capsules);
    require(points.shape[1] == 3 && surface.shape[0] == P && surface.shape[1] == 3 && normals.shape[0] == P, "nearest: no points");
    require(normals.shape[1] == 3 && distance.size() == P && bone.size() == P, "nearest: the shapes differ");
    for (Index p = 0; p < P; ++p) {
        f8 at[3] = {points(p, 0), points(p, 1), points(p, 2)}, n[3] = {};
        Union found = of_union(capsules, at);
        distance[p] = found.away;
        for (i8 step = 0; step < steps; ++step) {
            const f8 out = step < TURNS ? outward(capsules, found.bone, at, n) : -found.away;
            for (int x = 0; x < 3; ++x) at[x] += out * n[x];
            bone[p] = found.bone;
            found = of_union(capsules, at);
            if (found.away > -ARRIVED) {
                if (step >= TURNS) {
                    bone[p] = found.bone;
                    outward(capsules, found.bone, at, n);
                }
                break;
            }
        }
        for (int x = 0; x < 3; ++x) {
            surface(p, x) = at[x];
            normals(p, x) = n[x];
        }
    }
}

// As `from_axis`, but the values that are the same for all points are computed once.
inline void buried(View<const f8, 2> capsules, View<const f8, 2> points, View<const i8, 1> bone, View<const f8, 1> slack,
                   View<const i8, 1> which, View<bool, 1> out) {
    const Index C = capsules.shape[0];
    require_capsules(capsules);
    require(points.shape[1] == 3 && bone.size() == points.shape[0] && slack.size() == points.shape[0], "buried: no points");
    require(out.size() == which.size(), "buried: the shapes differ");
    struct Made {
        f8 start[3], u[3], inverse, tilt, radius, grows, ball[3], reach;
    };
    std::vector<Made> made(C);
    for (Index c = 0; c < C; ++c) {
        const f8* a = capsules.row(c);
        Made& now = made[c] = {};
        const f8 difference = a[7] - a[6];
        f8 squared = 0.0;
        for (int x = 0; x < 3; ++x) {
            const f8 along = a[3 + x] - a[x];
            squared += along * along;
            now.ball[x] = a[x] + along / 2.0;
        }
        now.reach = std::sqrt(squared) / 2.0 + std::max(a[6], a[7]);
        now.radius = std::max(a[6], a[7]);
        int first = difference > 0.0 ? 3 : 0;
        if (squared > difference * difference) {  // otherwise, one sphere contains the other
            first = 0;
            now.radius = a[6];
            now.grows = difference;
            now.inverse = 1.0 / squared;
            now.tilt = difference / std::sqrt(squared * (squared - difference * difference));
            for (int x = 0; x < 3; ++x) now.u[x] = a[3 + x] - a[x];
        }
        for (int x = 0; x < 3; ++x) now.start[x] = a[first + x];
    }
    std::vector<Index> touching(C * C), touched(C, 0);
    for (Index c = 0; c < C; ++c) {
        for (Index other = 0; other < C; ++other) {
            const Made &one = made[c], &two = made[other];
            f8 squared = 0.0;
            for (int x = 0; x < 3; ++x) squared += square(one.ball[x] - two.ball[x]);
            if (c != other && squared < square(one.reach + two.reach)) touching[c * C + touched[c]++] = other;
        }
    }
    for (Index i = 0; i < which.size(); ++i) {
        const Index k = which[i], c = bone[k];
        out[i] = false;
        for (Index n = 0; n < touched[c]; ++n) {
            const Made& other = made[touching[c * C + n]];
            f8 d[3], t = 0.0, across = 0.0, away = 0.0;
            for (int x = 0; x < 3; ++x) {
                d[x] = points(k, x) - other.start[x];
                t += d[x] * other.u[x];
            }
            t *= other.inverse;
            for (int x = 0; x < 3; ++x) across += square(d[x] - t * other.u[x]);
            t = std::min(std::max(t + other.tilt * std::sqrt(across), 0.0), 1.0);
            for (int x = 0; x < 3; ++x) away += square(d[x] - t * other.u[x]);
            const f8 within = other.radius + t * other.grows - std::max(slack[k], ROUNDING);
            if (within > 0.0 && away < within * within) {
                out[i] = true;
                break;
            }
        }
    }
}

inline void define_capsules(nb::module_& m) {
    kernel(m, "capsules", &capsules,
           "Write a hand's capsules, (C, 8) [m]: both ends of each axis, and the radius at either, means of two joints.\n\n"
           "joints: (26, 3) [m]. radii: (26,) [m]. ends: the joints of the first end and of the last, (C, 4).",
           "joints", "radii", "ends", "out");
    kernel(m, "bounds", &bounds, "Write a sphere around each capsule, (C, 8): its centre and radius, (C, 4) [m].", "capsules", "out");
    kernel(m, "nearest", &nearest,
           "Write the nearest skin of the union of capsules, (C, 8), to points, (P, 3) [m]: see `capsules.Nearest`.\n\n"
           "steps: at most, from inside to the surface; with 0 the distances alone are to be used.",
           "capsules", "points", "steps", "surface", "normals", "distance", "bone");
    kernel(m, "buried", &buried,
           "Write whether each of the points `which`, (K,), lies inside of a capsule, deeper than its slack: `out`, (K,).\n\n"
           "capsules: (C, 8). points: (P, 3) [m]. bone: each point's own capsule, which does not count, (P,). slack: (P,) [m].",
           "capsules", "points", "bone", "slack", "which", "out");
}

}  // namespace pacinian::scene
