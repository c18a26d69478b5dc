// Tapered capsules, (C, 8): both ends of an axis, then the radius at each [m]; the convex hull of the two spheres.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/views.hpp"

namespace pacinian::acoustics {

// From a capsule's axis to a point: vector, its length and the capsule's radius there [m], and position on the axis, 0..1.
struct FromAxis {
    f8 x, y, z, away, radius, t;
};

// Return this for the sphere of capsule c that (x, y, z) is nearest to or deepest in. If the point is h along the axis u
// and rho across it, the centre of this sphere is at s = h + m rho / sqrt(1 - m^2), where m is the slope of the radius.
// This s minimises |p - s u| - r(s).
inline FromAxis from_axis(View<const f8, 2> capsules, Index c, f8 x, f8 y, f8 z) {
    const f8* a = capsules.row(c);
    const f8 ux = a[3] - a[0], uy = a[4] - a[1], uz = a[5] - a[2];
    f8 dx = x - a[0], dy = y - a[1], dz = z - a[2], t;
    const f8 radius = a[6], grows = a[7] - a[6], square = ux * ux + uy * uy + uz * uz;
    if (square <= grows * grows) {  // one sphere contains the other
        t = grows > 0.0 ? 1.0 : 0.0;
    } else {
        t = (dx * ux + dy * uy + dz * uz) / square;
        if (grows != 0.0) {
            const f8 vx = dx - t * ux, vy = dy - t * uy, vz = dz - t * uz;
            t += grows * std::sqrt(vx * vx + vy * vy + vz * vz) / std::sqrt(square * (square - grows * grows));
        }
        t = std::min(std::max(t, 0.0), 1.0);
    }
    dx -= t * ux, dy -= t * uy, dz -= t * uz;
    return {dx, dy, dz, std::sqrt(dx * dx + dy * dy + dz * dz), radius + t * grows, t};
}

}  // namespace pacinian::acoustics
