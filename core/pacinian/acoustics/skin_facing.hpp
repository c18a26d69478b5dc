// The kernel of `SkinFacing`: multiply rows of B by the weights, tile by tile, in single precision.
//
// A capsule below a plane through a sample cannot occlude transducers above that plane. Therefore a capsule is evaluated
// only if no such plane is found between it and a tile of transducers.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/acoustics/tapered_capsules.hpp"

namespace pacinian::acoustics {

constexpr Index LANES = 16;          // counts are rounded up to this, because whole vectors are faster
constexpr f4 SMALLEST = 1e-30f;      // smallest divisor [m^2]
constexpr f4 PARALLEL = 1e-6f;       // squared sine of an angle that may be due to rounding
constexpr f4 FAINT = 1e-3f;          // MIN_WEIGHT of skin_facing.py
constexpr f4 SLACK = 1e-3f;          // height above a plane that does not count, relative to the edge
constexpr f8 FAR = 1e3;              // distance from the array that no hand exceeds [m]

// For each transducer of a tile: its distance from the sample [m], and the unit vector to it.
struct Ways {
    f4 *away, *x, *y, *z;
};

// For each capsule, relative to the sample: one end of the axis, the vector to the other end, the radius at the first
// end, the radius at the other end minus this one [m], and the nearest position on the axis, 0..1.
struct Seen {
    f4 *ax, *ay, *az, *ex, *ey, *ez, *radius, *grows, *nearest;
};

inline Index whole_vectors(Index count) { return (count + LANES - 1) / LANES * LANES; }

// Write the weights at q of the transducers first..first + count, without a hand.
inline void look(const f4* q, const f4* normal, View<const f4, 2> r, Index first, Index count, f4* __restrict w) {
    const f4 x = q[0], y = q[1], z = q[2], nx = normal[0], ny = normal[1], nz = normal[2];
    const f4 free = nx == 0.0f && ny == 0.0f && nz == 0.0f ? 1.0f : 0.0f;
    const f4 *__restrict rx = r.row(0) + first, *__restrict ry = r.row(1) + first, *__restrict rz = r.row(2) + first;
    for (Index i = 0; i < count; ++i) {
        const f4 dx = rx[i] - x, dy = ry[i] - y, dz = rz[i] - z;
        const f4 inverse = 1.0f / std::sqrt(dx * dx + dy * dy + dz * dz + SMALLEST);
        const f4 cosine = (dx * nx + dy * ny + dz * nz) * inverse + free;
        w[i] = cosine > 0.0f ? cosine : 0.0f;
    }
}

// Write distances and directions of the transducers first..first + count from q.
inline void aim(const f4* q, View<const f4, 2> r, Index first, Index count, const Ways& ways) {
    const f4 x = q[0], y = q[1], z = q[2];
    const f4 *__restrict rx = r.row(0) + first, *__restrict ry = r.row(1) + first, *__restrict rz = r.row(2) + first;
    f4 *__restrict away = ways.away, *__restrict ux = ways.x, *__restrict uy = ways.y, *__restrict uz = ways.z;
    for (Index i = 0; i < count; ++i) {
        const f4 dx = rx[i] - x, dy = ry[i] - y, dz = rz[i] - z;
        const f4 d = std::sqrt(dx * dx + dy * dy + dz * dz + SMALLEST);
        away[i] = d;
        ux[i] = dx / d;
        uy[i] = dy / d;
        uz[i] = dz / d;
    }
}

// Return the position on an axis where a path is deepest, if it is nearest at t, `gap` away: as in `_depth`.
inline f4 deepest(f4 t, f4 gap, f4 across, f4 grows) {
    const f4 room = across * std::max(across - grows * grows, 0.0f) + SMALLEST;
    return std::min(std::max(t + grows * gap / std::sqrt(room), 0.0f), 1.0f);
}

// Return the fraction of sound that passes a capsule at this depth [m]. sharp: one over the edge [1/m].
inline f4 passing(f4 deep, f4 sharp) {
    const f4 u = std::min(std::max(1.0f - deep * sharp, 0.0f), 1.0f);
    return u * u * (3.0f - 2.0f * u);
}

// Multiply weights by the fraction that passes a capsule, for transducers in or before it, where the path is deepest.
inline void shade_ends(const Seen& near, Index c, f4 sharp, const Ways& ways, f4* w, Index count) {
    const f4 ax = near.ax[c], ay = near.ay[c], az = near.az[c], ex = near.ex[c], ey = near.ey[c], ez = near.ez[c];
    const f4 grows = near.grows[c], ee = ex * ex + ey * ey + ez * ez + SMALLEST, ae = ax * ex + ay * ey + az * ez;
    for (Index i = 0; i < count; ++i) {
        const f4 end = ways.away[i], ux = ways.x[i], uy = ways.y[i], uz = ways.z[i];
        const f4 eu = ex * ux + ey * uy + ez * uz, au = ax * ux + ay * uy + az * uz;
        const f4 across = std::max(ee - eu * eu, PARALLEL * ee);
        const auto gap = [&](f4 t, f4 s) {
            const f4 x = ax + t * ex - s * ux, y = ay + t * ey - s * uy, z = az + t * ez - s * uz;
            return std::sqrt(x * x + y * y + z * z);
        };
        f4 t = (eu * au - ae) / across;
        t = deepest(t, gap(t, au + eu * t), across, grows);
        if (au + eu * t > end) {
            t = (eu * end - ae) / ee;
            t = deepest(t, gap(t, end), ee, grows);
            w[i] *= passing(near.radius[c] + t * grows - gap(t, end), sharp);
        }
    }
}

// Multiply weights by the fraction that passes a capsule; see `_depth` in skin_facing.py.
inline void shade(const Seen& near, Index c, f4 edge, const Ways& ways, f4* __restrict w, Index count) {
    const f4 ax = near.ax[c], ay = near.ay[c], az = near.az[c], ex = near.ex[c], ey = near.ey[c], ez = near.ez[c];
    const f4 radius = near.radius[c], grows = near.grows[c], nearest = near.nearest[c];
    const f4 *__restrict away = ways.away, *__restrict ux = ways.x, *__restrict uy = ways.y, *__restrict uz = ways.z;
    const f4 ee = ex * ex + ey * ey + ez * ez + SMALLEST, ae = ax * ex + ay * ey + az * ez;
    const f4 sharp = 1.0f / edge, least = PARALLEL * ee;
    for (Index i = 0; i < count; ++i) {
        const f4 eu = ex * ux[i] + ey * uy[i] + ez * uz[i], au = ax * ux[i] + ay * uy[i] + az * uz[i];
        const f4 across = std::max(ee - eu * eu, least);
        f4 t = (eu * au - ae) / across;  // where the lines are nearest to each other
        f4 s = au + eu * t;
        f4 x = ax + t * ex - s * ux[i], y = ay + t * ey - s * uy[i], z = az + t * ez - s * uz[i];
        t = deepest(t, std::sqrt(x * x + y * y + z * z), across, grows);
        t = au + eu * t > 0.0f ? t : nearest;  // deepest at the sample
        s = std::max(au + eu * t, 0.0f);
        x = ax + t * ex - s * ux[i], y = ay + t * ey - s * uy[i], z = az + t * ez - s * uz[i];
        const f4 let = passing(radius + t * grows - std::sqrt(x * x + y * y + z * z), sharp);
        w[i] *= s <= away[i] ? let : 1.0f;  // otherwise deepest at the transducer, see below
    }
    const f4 aa = ax * ax + ay * ay + az * az;
    f4 shortest = away[0];
    for (Index i = 1; i < count; ++i) shortest = std::min(shortest, away[i]);
    if (std::max(aa, aa + 2.0f * ae + ee) >= shortest * shortest) shade_ends(near, c, sharp, ways, w, count);
}

// Return the sine of the angle by which a ray must turn from straight ahead to touch a circle of radius r.
//
// along, across: distance of the circle's centre ahead and to the side. Returns 1 if the ray turns by 90 degrees or
// more, and -1 if it starts inside the circle.
inline f4 tangent(f4 along, f4 across, f4 r) {
    const f4 square = along * along + across * across + SMALLEST;
    const f4 k = std::sqrt(std::max(square - r * r, 0.0f));
    f4 sine = (k * across - r * along) / square;
    sine = r * across + k * along >= 0.0f ? sine : 1.0f;
    return square > r * r ? sine : -1.0f;
}

// Write whether each capsule may occlude part of a box. box: its middle and half its sides, (6,) [m].
//
// For each capsule, two planes are tried that touch it on the side of the box. The nearest point of its axis determines
// the tilt of one plane, and the middle of its axis that of the other.
inline void sift(const Seen& near, Index count, const f4* box, f4 slack, i4* __restrict hides) {
    const f4 bx = box[0], by = box[1], bz = box[2], sx = box[3], sy = box[4], sz = box[5];
    const f4 inverse = 1.0f / std::sqrt(bx * bx + by * by + bz * bz + SMALLEST);
    const f4 ux = bx * inverse, uy = by * inverse, uz = bz * inverse;
    const f4 *__restrict ax = near.ax, *__restrict ay = near.ay, *__restrict az = near.az;
    const f4 *__restrict ex = near.ex, *__restrict ey = near.ey, *__restrict ez = near.ez;
    const f4 *__restrict radius = near.radius, *__restrict grows = near.grows, *__restrict nearest = near.nearest;
    for (Index c = 0; c < count; ++c) {
        const f4 rp = std::max(radius[c], 0.0f), rq = std::max(radius[c] + grows[c], 0.0f);
        const f4 px = ax[c], py = ay[c], pz = az[c], qx = px + ex[c], qy = py + ey[c], qz = pz + ez[c];
        const f4 p = px * ux + py * uy + pz * uz, q = qx * ux + qy * uy + qz * uz;
        const auto hidden = [&](f4 t) {
            f4 x = px + t * ex[c], y = py + t * ey[c], z = pz + t * ez[c];
            const f4 along = x * ux + y * uy + z * uz;
            x -= along * ux, y -= along * uy, z -= along * uz;
            const f4 unit = 1.0f / std::sqrt(x * x + y * y + z * z + SMALLEST);
            x *= unit, y *= unit, z *= unit;
            const f4 sine = std::min(tangent(p, px * x + py * y + pz * z, rp), tangent(q, qx * x + qy * y + qz * z, rq));
            const f4 cosine = std::sqrt(std::max(0.0f, 1.0f - sine * sine));
            x = sine * ux - cosine * x, y = sine * uy - cosine * y, z = sine * uz - cosine * z;
            const f4 low = bx * x + by * y + bz * z - sx * std::abs(x) - sy * std::abs(y) - sz * std::abs(z);
            const f4 high = std::max(px * x + py * y + pz * z + rp, qx * x + qy * y + qz * z + rq);
            return static_cast<i4>(sine <= 0.0f) | static_cast<i4>(low < 0.0f) | static_cast<i4>(high > slack);
        };
        hides[c] = hidden(0.5f) & hidden(nearest[c]);
    }
}

// Collect the capsules that rise above the tangent plane at q, relative to q; return their number. A capsule that
// contains q is reduced so that its surface passes through q.
inline Index gather(const f8* q, View<const f8, 2> capsules, const f4* normal, const f8* origin, f4 slack, const Seen& near) {
    const bool free = normal[0] == 0.0f && normal[1] == 0.0f && normal[2] == 0.0f;
    f4* const ends[6] = {near.ax, near.ay, near.az, near.ex, near.ey, near.ez};
    Index found = 0;
    for (Index c = 0; c < capsules.shape[0]; ++c) {
        const f8* capsule = capsules.row(c);
        f8 a_high = 0.0, e_high = 0.0, far = 0.0;
        for (int k = 0; k < 3; ++k) {
            const f8 a = capsule[k] - q[k], e = capsule[3 + k] - capsule[k];
            ends[k][found] = static_cast<f4>(a);
            ends[3 + k][found] = static_cast<f4>(e);
            a_high += a * normal[k];
            e_high += e * normal[k];
            far = std::max(far, std::abs(capsule[k] - origin[k]));
        }
        const f8 grows = capsule[7] - capsule[6], high = a_high + std::max(e_high + grows, 0.0);
        if (far >= FAR || !(free || high + capsule[6] > slack)) continue;
        const FromAxis way = from_axis(capsules, c, q[0], q[1], q[2]);
        const f8 r = capsule[6] - std::max(way.radius - way.away, 0.0);
        near.radius[found] = static_cast<f4>(r);
        near.grows[found] = static_cast<f4>(grows);
        near.nearest[found] = static_cast<f4>(way.t);
        if (free || high + r > slack) ++found;
    }
    return found;
}

inline void weigh(View<const f8, 2> points, View<const f8, 2> normals, View<const f8, 2> capsules, f8 edge,
                  View<const f8, 1> origin, View<const f4, 2> r, View<const f4, 2> boxes, View<const i8, 1> rows,
                  View<c8, 2> out) {
    const Index N = r.shape[1], C = capsules.shape[0], tiles = boxes.shape[0];
    require(points.shape[1] == 3 && normals.shape[1] == 3 && capsules.shape[1] == 8 && origin.size() == 3, "weigh: not of space");
    require(r.shape[0] == 3 && boxes.shape[1] == 6 && tiles > 0 && out.shape[1] == N, "weigh: no array");
    require(rows.size() == points.shape[0] && normals.shape[0] == out.shape[0], "weigh: as many points as rows");
    const Index step = (N + tiles - 1) / tiles, width = step + LANES, deep = C + LANES;
    std::vector<f4> room(4 * width + 9 * deep + N + LANES, 0.0f);
    std::vector<i4> hides(deep, 0);
    f4* place = room.data();
    const auto next = [&place](Index size) { return std::exchange(place, place + size); };
    const Ways ways{next(width), next(width), next(width), next(width)};
    const Seen near{next(deep), next(deep), next(deep), next(deep), next(deep), next(deep), next(deep), next(deep), next(deep)};
    f4* weights = next(N + LANES);
    const f4 slack = SLACK * static_cast<f4>(edge);
    for (Index k = 0; k < points.shape[0]; ++k) {
        const Index m = rows[k];
        f4 q[3], normal[3], box[6];
        for (int axis = 0; axis < 3; ++axis) {
            q[axis] = static_cast<f4>(points(k, axis) - origin[axis]);
            normal[axis] = static_cast<f4>(normals(m, axis));
        }
        const Index found = gather(points.row(k), capsules, normal, origin.data, slack, near);
        for (Index j = 0; j < tiles; ++j) {
            const Index first = j * step;
            const Index count = std::min(whole_vectors(step), N - first);  // the next tile overwrites the surplus
            f4* w = weights + first;
            f4 high = 0.0f;
            for (int axis = 0; axis < 3; ++axis) {
                box[axis] = boxes(j, axis) - q[axis];
                box[3 + axis] = boxes(j, 3 + axis);
                high += box[axis] * normal[axis] + box[3 + axis] * std::abs(normal[axis]);
            }
            if (high < 0.0f) {
                std::fill(w, w + count, 0.0f);
                continue;
            }
            look(q, normal, r, first, count, w);
            if (!found) continue;
            sift(near, whole_vectors(found), box, slack, hides.data());
            bool aimed = false;
            for (Index c = 0; c < found; ++c) {
                if (!hides[c]) continue;
                if (!aimed) aim(q, r, first, count, ways);
                aimed = true;
                shade(near, c, static_cast<f4>(edge), ways, w, count);
            }
        }
        f4* __restrict row = reinterpret_cast<f4*>(out.row(m));
        f4 size = 0.0f;
        for (Index n = 0; n < N; ++n) {
            row[2 * n] *= weights[n];
            row[2 * n + 1] *= weights[n];
            size += weights[n] * weights[n];
        }
        if (size < FAINT * FAINT) std::fill(row, row + 2 * N, 0.0f);
    }
}

}  // namespace pacinian::acoustics
