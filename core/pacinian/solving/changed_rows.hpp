// Which rows of B have changed: the point has moved, its skin has turned, or what may hide it has moved.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/math.hpp"

namespace pacinian::solving {

inline bool differs(const f8* a, const f8* b, int count) { return !std::equal(a, a + count, b); }

inline Index moved(View<const f8, 2> points, View<const f8, 2> before, View<i8, 1> rows) {
    require(points.shape[1] == 3 && before.size() == points.size() && rows.size() == points.shape[0], "moved: the shapes differ");
    Index count = 0;
    for (Index m = 0; m < points.shape[0]; ++m)
        if (differs(points.row(m), before.row(m), 3)) rows[count++] = m;
    return count;
}

inline Index changed(View<const f8, 2> points, View<const f8, 2> before, View<const f8, 2> normals, View<const f8, 2> normals_before,
                     View<const f8, 2> capsules, View<const f8, 2> capsules_before, View<i8, 1> rows) {
    const Index M = points.shape[0];
    require(points.shape[1] == 3 && before.size() == 3 * M && rows.size() == M, "changed: the shapes differ");
    require(normals.size() == 3 * M && normals_before.size() == 3 * M, "changed: the shapes differ");
    require(capsules.shape[1] == 8 && capsules_before.shape[1] == 8, "changed: no capsules");
    const bool same = capsules.shape[0] == capsules_before.shape[0];
    std::vector<const f8*> other;
    for (Index c = 0; c < capsules.shape[0]; ++c)
        if (!same || differs(capsules.row(c), capsules_before.row(c), 8)) other.push_back(capsules.row(c));
    for (Index c = 0; c < capsules_before.shape[0]; ++c)
        if (!same || differs(capsules.row(c), capsules_before.row(c), 8)) other.push_back(capsules_before.row(c));
    Index count = 0;
    for (Index m = 0; m < M; ++m) {
        const f8 *q = points.row(m), *n = normals.row(m);
        bool any = differs(q, before.row(m), 3) || differs(n, normals_before.row(m), 3);
        const f8 here = n[0] * q[0] + n[1] * q[1] + n[2] * q[2];
        for (std::size_t c = 0; c < other.size() && !any; ++c) {  // a capsule above the tangent plane may hide the point
            const f8* a = other[c];
            const f8 one = n[0] * a[0] + n[1] * a[1] + n[2] * a[2] + a[6], two = n[0] * a[3] + n[1] * a[4] + n[2] * a[5] + a[7];
            any = std::max(one, two) > here;
        }
        if (any) rows[count++] = m;
    }
    return count;
}

inline void define_changes(nb::module_& m) {
    kernel(m, "moved", &moved, "Write the indices of the rows in which points and `before`, (M, 3), differ, to `rows`, (M,); return how many.",
           "points", "before", "rows");
    kernel(m, "changed", &changed,
           "Like `moved`, with the rows added whose weights by `SkinFacing` may differ; see `SkinFacing.find_changed`.\n\n"
           "normals, normals_before: (M, 3). capsules, capsules_before: (C, 8) [m], any numbers of them.",
           "points", "before", "normals", "normals_before", "capsules", "capsules_before", "rows");
}

}  // namespace pacinian::solving
