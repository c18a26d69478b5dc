// Cubic cells of space: distances to marked cells, and connected parts.
#pragma once
#include <algorithm>

#include "pacinian/native/math.hpp"

namespace pacinian::scene {

constexpr f8 NO_CELL = 1e12;  // squared distance where no cell is marked [cells^2]

// The lower envelope of the parabolas f(v) + (x - v)^2 along a line of n cells, `stride` apart. P. Felzenszwalb and D.
// Huttenlocher, "Distance transforms of sampled functions", Theory Comput. 8 (2012) 415.
inline void lower_envelope(f8* line, Index n, Index stride, std::vector<Index>& at, std::vector<f8>& begin, std::vector<f8>& f) {
    Index last = -1;
    for (Index x = 0; x < n; ++x) f[x] = line[x * stride];
    for (Index x = 0; x < n; ++x) {
        if (f[x] >= NO_CELL) continue;
        f8 from = -1.0;
        while (last >= 0) {
            const Index v = at[last];
            from = ((f[x] + square(static_cast<f8>(x))) - (f[v] + square(static_cast<f8>(v)))) / (2.0 * static_cast<f8>(x - v));
            if (from > begin[last]) break;
            --last;
        }
        ++last;
        at[last] = x;
        begin[last] = last > 0 ? from : -1.0;
    }
    if (last < 0) return;
    Index k = 0;
    for (Index x = 0; x < n; ++x) {
        while (k < last && begin[k + 1] <= static_cast<f8>(x)) ++k;
        line[x * stride] = f[at[k]] + square(static_cast<f8>(x - at[k]));
    }
}

inline void measure_cells(View<const bool, 3> marked, View<f8, 3> squared) {
    const Index X = marked.shape[0], Y = marked.shape[1], Z = marked.shape[2];
    require(squared.shape[0] == X && squared.shape[1] == Y && squared.shape[2] == Z, "measure_cells: the shapes differ");
    for (Index i = 0; i < X * Y * Z; ++i) squared.data[i] = marked.data[i] ? 0.0 : NO_CELL;
    const Index most = std::max({X, Y, Z});
    std::vector<Index> at(most);
    std::vector<f8> begin(most), f(most);
    for (Index i = 0; i < X * Y; ++i) lower_envelope(squared.data + i * Z, Z, 1, at, begin, f);
    for (Index x = 0; x < X; ++x) {
        for (Index z = 0; z < Z; ++z) lower_envelope(squared.data + x * Y * Z + z, Y, Z, at, begin, f);
    }
    for (Index i = 0; i < Y * Z; ++i) lower_envelope(squared.data + i, X, Y * Z, at, begin, f);
}

inline Index label_cells(View<const bool, 3> free, View<i8, 3> part) {
    const Index X = free.shape[0], Y = free.shape[1], Z = free.shape[2];
    require(part.shape[0] == X && part.shape[1] == Y && part.shape[2] == Z, "label_cells: the shapes differ");
    std::fill(part.data, part.data + part.size(), i8{0});
    std::vector<Index> front;
    Index count = 0;
    for (Index begin = 0; begin < X * Y * Z; ++begin) {
        if (!free.data[begin] || part.data[begin]) continue;
        part.data[begin] = ++count;
        front.push_back(begin);
        while (!front.empty()) {
            const Index i = front.back(), x = i / (Y * Z), y = i / Z % Y, z = i % Z;
            front.pop_back();
            const auto visit = [&](bool inside, Index j) {
                if (!inside || !free.data[j] || part.data[j]) return;
                part.data[j] = count;
                front.push_back(j);
            };
            visit(x > 0, i - Y * Z);
            visit(x < X - 1, i + Y * Z);
            visit(y > 0, i - Z);
            visit(y < Y - 1, i + Z);
            visit(z > 0, i - 1);
            visit(z < Z - 1, i + 1);
        }
    }
    return count;
}

inline void define_cells(nb::module_& m) {
    kernel(m, "measure_cells", &measure_cells,
           "Write the squared distance of each cell, (X, Y, Z), from the nearest marked one [cells^2]; 1e12 if none is marked.",
           "marked", "squared");
    kernel(m, "label_cells", &label_cells,
           "Write the number of the part of each free cell, (X, Y, Z), from 1 on; 0 for the others. Cells that share a face are\n"
           "of the same part. Returns the number of parts.",
           "free", "part");
}

}  // namespace pacinian::scene
