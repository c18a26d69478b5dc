// Which points sound can reach, and the power there, looked up by cells.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/native/math.hpp"

namespace pacinian::rendering {

constexpr f8 LARGEST = 1e6;   // cells are numbered from -1e6 to 1e6 in each direction
constexpr i8 SIDE = 2000003;  // more than that range, so that one number tells all three

inline Index locate(View<const f8, 2> q, View<const f8, 1> origin, View<const f8, 1> extent, f8 farthest) {
    require(q.shape[1] == 3 && origin.size() == 3 && extent.size() == 3, "locate: not of space");
    Index found = 0;
    for (Index m = 0; m < q.shape[0]; ++m) {
        bool inside = true;
        for (int x = 0; x < 3; ++x) {
            const f8 away = std::abs(q(m, x) - origin[x]);
            if (away > farthest) found |= 1;
            inside = inside && away <= extent[x];
        }
        if (inside) found |= 2;
    }
    return found;
}

inline Index look_up(View<const f8, 2> q, f8 size, View<const i8, 1> cells, View<const f8, 1> known, View<f8, 1> out,
                     View<i8, 1> missing) {
    const Index M = q.shape[0];
    require(q.shape[1] == 3 && known.size() == cells.size() && out.size() == M && missing.size() == M, "look_up: the shapes differ");
    Index count = 0;
    i8 last = -1;
    f8 value = 0.0;
    for (Index m = 0; m < M; ++m) {
        i8 cell = 0;
        for (int x = 0; x < 3; ++x)
            cell = cell * SIDE + static_cast<i8>(std::floor(std::min(std::max(q(m, x) / size, -LARGEST), LARGEST)) + LARGEST);
        if (cell != last) {
            const i8* place = std::lower_bound(cells.data, cells.data + cells.size(), cell);
            if (place == cells.data + cells.size() || *place != cell) {
                missing[count++] = cell;
                continue;
            }
            last = cell;
            value = known[place - cells.data];
        }
        out[m] = value;
    }
    return count;
}

inline void define_reachability(nb::module_& m) {
    m.attr("LARGEST") = LARGEST;
    m.attr("SIDE") = SIDE;
    kernel(m, "locate", &locate,
           "Return 1 if any point q, (M, 3) [m], is farther than `farthest` [m] from the origin along an axis, plus 2 if any is\n"
           "within `extent`, (3,) [m], along all axes.",
           "q", "origin", "extent", "farthest");
    kernel(m, "look_up", &look_up,
           "Write the value of the cell of each point q, (M, 3) [m], to `out`, (M,); return the number of points without one.\n\n"
           "size: of a cell [m]. cells: numbers of those known, ascending, with the values `known`. missing: numbers of the cells\n"
           "without a value, (M,): ((x + LARGEST) SIDE + y + LARGEST) SIDE + z + LARGEST for the cell (x, y, z).",
           "q", "size", "cells", "known", "out", "missing");
}

}  // namespace pacinian::rendering
