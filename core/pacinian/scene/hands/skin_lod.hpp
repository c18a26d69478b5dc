// Levels of detail of a skin: evenly spread points, of which coarse levels use a part, and how nodes share forces.
//
// Two points are on the same side of the skin if their normals are less than 90 degrees apart and they are not on two
// different fingers. Points keep their distance from, and share forces with, only points on the same side.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <queue>
#include <vector>

#include "pacinian/native/math.hpp"

namespace pacinian::scene {

constexpr f8 ENDLESS = 1e150;  // stands for infinity; its square is finite
constexpr int SHARERS = 3;     // number of nodes that share a point's force

// N points of a skin at rest: points (N, 3) [m], normals (N, 3), fingers (N,), 0 for the palm.
struct Surface {
    View<const f8, 2> points, normals;
    View<const i8, 1> fingers;

    Index size() const {
        require(points.shape[1] == 3 && normals.shape[0] == points.shape[0] && normals.shape[1] == 3, "surface: no points");
        require(fingers.size() == points.shape[0], "surface: the shapes differ");
        return points.shape[0];
    }
    f8 squared(Index i, Index j) const {
        return square(points(i, 0) - points(j, 0)) + square(points(i, 1) - points(j, 1)) + square(points(i, 2) - points(j, 2));
    }
    // Return the cosine between the normals of two points on the same side, else 0.
    f8 cosine(Index i, Index j) const {
        if (fingers[i] != fingers[j] && fingers[i] && fingers[j]) return 0.0;
        const f8 dot = normals(i, 0) * normals(j, 0) + normals(i, 1) * normals(j, 1) + normals(i, 2) * normals(j, 2);
        return dot > 0.0 ? dot : 0.0;
    }
};

// Points of a surface in a cube of space: those from `begin` to `end` of an order. most: the largest `away`, of the first
// point that has it. low, high: corners of their box [m].
struct Cube {
    Index begin, end, first;
    f8 most, low[3], high[3];

    f8 squared(const f8* place) const {  // distance of a place from the box
        f8 sum = 0.0;
        for (int k = 0; k < 3; ++k) sum += square(std::max({low[k] - place[k], place[k] - high[k], 0.0}));
        return sum;
    }
};

constexpr f8 CUBE = 4.0;           // side of a cube for the search of the farthest point, in spacings
constexpr f8 NODE_CUBE = 2.0;      // side of a cube for the search of the nearest nodes, in spacings
constexpr f8 BARELY = 1.0 - 1e-9;  // leaves room for rounding in distances from boxes

// The cubes of a surface by their cell in a grid.
struct Grid {
    f8 side;
    std::vector<Cube> cubes;
    std::vector<std::array<i8, 3>> cells;  // of the cubes, sorted

    // Call `visit` with the number of each cube that may have a point within `radius` of a place.
    template <typename Visit>
    void visit_near(const f8* place, f8 radius, Visit visit) const {
        std::array<i8, 3> low, high;
        f8 count = 1.0;
        for (int k = 0; k < 3; ++k) {
            const f8 first = std::floor((place[k] - radius) / side), last = std::floor((place[k] + radius) / side);
            count *= last - first + 1.0;
            low[k] = static_cast<i8>(std::max(first, -1e15)), high[k] = static_cast<i8>(std::min(last, 1e15));
        }
        if (count >= static_cast<f8>(cells.size())) {
            for (Index n = 0; n < static_cast<Index>(cells.size()); ++n) visit(n);
            return;
        }
        for (i8 x = low[0]; x <= high[0]; ++x)
            for (i8 y = low[1]; y <= high[1]; ++y) {
                auto at = std::lower_bound(cells.begin(), cells.end(), std::array<i8, 3>{x, y, low[2]});
                for (; at != cells.end() && (*at)[0] == x && (*at)[1] == y && (*at)[2] <= high[2]; ++at)
                    visit(static_cast<Index>(at - cells.begin()));
            }
    }
};

inline Grid sort_into_cubes(View<const f8, 2> points, f8 side, std::vector<Index>& sorted) {
    const Index N = points.shape[0];
    std::vector<std::array<i8, 3>> cell(N);
    for (Index i = 0; i < N; ++i) {
        for (int k = 0; k < 3; ++k) cell[i][k] = static_cast<i8>(std::floor(points(i, k) / side));
    }
    sorted.resize(N);
    std::iota(sorted.begin(), sorted.end(), Index{0});
    std::sort(sorted.begin(), sorted.end(), [&](Index a, Index b) { return cell[a] != cell[b] ? cell[a] < cell[b] : a < b; });
    Grid grid{side, {}, {}};
    std::vector<Cube>& cubes = grid.cubes;
    for (Index n = 0; n < N; ++n) {
        const Index i = sorted[n];
        if (!n || cell[i] != cell[sorted[n - 1]]) {
            grid.cells.push_back(cell[i]);
            cubes.push_back({n, n, i, ENDLESS, {}, {}});
            for (int k = 0; k < 3; ++k) cubes.back().low[k] = cubes.back().high[k] = points(i, k);
        }
        Cube& cube = cubes.back();
        cube.end = n + 1;
        for (int k = 0; k < 3; ++k) {
            cube.low[k] = std::min(cube.low[k], points(i, k));
            cube.high[k] = std::max(cube.high[k], points(i, k));
        }
    }
    return grid;
}

// The cube with the farthest point comes first; of equals, the one whose point comes first.
struct Candidate {
    f8 most;
    Index first, cube;

    bool operator<(const Candidate& other) const { return most < other.most || (most == other.most && first > other.first); }
};

// Only cubes that have a point farther from all chosen ones than from the new one are visited. No point is farther from the
// chosen ones than the new one, so these cubes are near it.
inline void spread(View<const f8, 2> points, View<const f8, 2> normals, View<const i8, 1> fingers, View<const f8, 1> spacings,
                   View<i8, 1> order, View<f8, 1> apart, View<i8, 2> nearest, View<i8, 1> counts) {
    const Surface surface{points, normals, fingers};
    const Index N = surface.size(), L = spacings.size();
    require(order.size() == N && apart.size() == N && counts.size() == L, "spread: the shapes differ");
    require(L > 0 && nearest.shape[0] == L && nearest.shape[1] == N, "spread: the shapes differ");
    require(spacings[L - 1] > 0.0, "spread: there is no spacing");
    std::vector<Index> sorted;
    Grid grid = sort_into_cubes(points, CUBE * spacings[L - 1], sorted);
    std::vector<f8> away(N, ENDLESS);
    std::vector<i8> to(N, 0);  // the nearest chosen point
    std::priority_queue<Candidate> farthest;
    Index chosen = 0, K = 0, level = 0;
    while (true) {
        for (; level < L && (K == N || !(away[chosen] >= square(spacings[level]))); ++level) {
            counts[level] = K;
            std::copy(to.begin(), to.end(), nearest.row(level));
        }
        if (level == L) return;
        order[K] = chosen;
        apart[K] = std::sqrt(away[chosen]);
        grid.visit_near(points.row(chosen), apart[K] / BARELY, [&](Index at) {
            Cube& cube = grid.cubes[at];
            if (!(BARELY * cube.squared(points.row(chosen)) < cube.most)) return;
            cube.most = -1.0;
            for (Index n = cube.begin; n < cube.end; ++n) {
                const Index i = sorted[n];
                const f8 d = surface.squared(i, chosen);
                if (d < away[i] && surface.cosine(i, chosen) > 0.0) {
                    away[i] = d;
                    to[i] = K;
                }
                if (away[i] > cube.most) {
                    cube.most = away[i];
                    cube.first = i;
                }
            }
            farthest.push({cube.most, cube.first, at});
        });
        ++K;
        const auto outdated = [&](const Candidate& top) {
            const Cube& cube = grid.cubes[top.cube];
            return cube.most != top.most || cube.first != top.first;
        };
        while (!farthest.empty() && outdated(farthest.top())) farthest.pop();  // the newest of each cube is up to date
        require(!farthest.empty(), "spread: the points are not finite");
        chosen = farthest.top().first;
    }
}

// The nodes with the smallest D from a point, nearest first; of equal ones, the first.
struct NearestNodes {
    f8 D[SHARERS + 1];
    i8 which[SHARERS + 1] = {};

    NearestNodes() { std::fill(D, D + SHARERS + 1, ENDLESS); }
    void add(f8 distance, i8 node) {
        const auto before = [&](int i) { return distance < D[i] || (distance == D[i] && node < which[i]); };
        int i = SHARERS;
        if (!before(i)) return;
        for (; i > 0 && before(i - 1); --i) {
            D[i] = D[i - 1];
            which[i] = which[i - 1];
        }
        D[i] = distance;
        which[i] = node;
    }
};

// Return the nodes with the smallest D from point k, of those in the cubes near it. D is at least the distance, so that the
// search ends once no node outside of its radius could be nearer.
inline NearestNodes find_nodes(const Surface& surface, const Grid& grid, const std::vector<Index>& sorted, Index k) {
    const f8* place = surface.points.row(k);
    for (f8 radius = grid.side;; radius *= 2.0) {
        NearestNodes found;
        Index visited = 0;
        grid.visit_near(place, radius, [&](Index at) {
            const Cube& cube = grid.cubes[at];
            visited += 1;
            if (BARELY * cube.squared(place) >= square(found.D[SHARERS])) return;
            for (Index n = cube.begin; n < cube.end; ++n) {
                const f8 squared = surface.squared(k, sorted[n]);
                if (squared > square(found.D[SHARERS])) continue;
                const f8 cosine = surface.cosine(k, sorted[n]);
                if (cosine > 0.0) found.add(std::sqrt(squared / cosine), sorted[n]);
            }
        });
        if (found.D[SHARERS] <= BARELY * radius || visited == static_cast<Index>(grid.cubes.size())) return found;
    }
}

// spacing: of the nodes [m].
inline void share(View<const f8, 2> points, View<const f8, 2> normals, View<const i8, 1> fingers, i8 nodes, f8 spacing,
                  View<i8, 2> indices, View<f8, 2> weights) {
    const Surface surface{points, normals, fingers};
    const Index N = surface.size();
    require(0 < nodes && nodes <= N && indices.shape[0] == N && weights.shape[0] == N, "share: the shapes differ");
    require(indices.shape[1] == SHARERS && weights.shape[1] == SHARERS, "share: the shapes differ");
    require(spacing > 0.0, "share: there is no spacing");
    std::vector<Index> sorted;
    const Grid grid = sort_into_cubes({points.data, {nodes, 3}}, NODE_CUBE * spacing, sorted);
    for (Index k = 0; k < N; ++k) {
        if (k < nodes) {
            std::fill(indices.row(k), indices.row(k) + SHARERS, k);
            weights(k, 0) = 1.0;
            continue;
        }
        const auto [D, which] = find_nodes(surface, grid, sorted, k);
        std::fill(indices.row(k), indices.row(k) + SHARERS, which[0]);
        const f8 beyond = (1.0 - 1e-6) / D[SHARERS];
        f8 total = 0.0;
        for (int i = 0; i < SHARERS; ++i) {
            if (D[i] < ENDLESS) {
                indices(k, i) = which[i];
                weights(k, i) = square(1.0 / D[i] - beyond);
                total += weights(k, i);
            }
        }
        for (int i = 0; i < SHARERS; ++i) weights(k, i) /= total;
    }
}

inline void define_levels(nb::module_& m) {
    kernel(m, "spread", &spread,
           "Choose points one after the other, each the one farthest from those before it: see `skin_lod.spread_pressure`.\n\n"
           "points, normals: (N, 3). fingers: (N,). spacings: of each level, coarse to fine, (L,) [m]. order, apart: written,\n"
           "(N,). nearest: written, (L, N). counts: of the points of each level, written, (L,).",
           "points", "normals", "fingers", "spacings", "order", "apart", "nearest", "counts");
    kernel(m, "share", &share,
           "Share every point among the nearest of the first `nodes`: see `skin_lod.share_pressure`.\n\n"
           "points, normals: (N, 3). fingers: (N,). spacing: of the nodes [m]. indices, weights: written, (N, 3); zero before.",
           "points", "normals", "fingers", "nodes", "spacing", "indices", "weights");
}

}  // namespace pacinian::scene
