// Nearest points, and points within a radius, by a balanced k-d tree.
#pragma once
#include <algorithm>
#include <numeric>

#include "pacinian/native/math.hpp"

namespace pacinian::neighbours {

// J. L. Bentley, "Multidimensional binary search trees used for associative searching", Commun. ACM 18 (1975) 509. The
// middle of each part of `order` is a node; those before it lie on one side of it along `axis`, those after on the other.
class Tree {
public:
    explicit Tree(View<const f8, 2> points) : points_(points), order_(points.shape[0]), axis_(points.shape[0]) {
        std::iota(order_.begin(), order_.end(), Index{0});
        build(0, points.shape[0]);
    }

    // The nearest point to q, of several the first; `squared` is the squared distance.
    Index nearest(const f8* q, f8& squared) const {
        Index best = -1;
        squared = 0.0;
        search(0, points_.shape[0], q, best, squared);
        return best;
    }

    // Call `take` with each point at most `radius` from q.
    template <typename Take>
    void within(const f8* q, f8 radius, const Take& take) const {
        collect(0, points_.shape[0], q, radius, take);
    }

private:
    void build(Index begin, Index end) {
        if (end - begin < 1) return;
        f8 low[3], high[3];
        for (int k = 0; k < 3; ++k) low[k] = high[k] = points_(order_[begin], k);
        for (Index i = begin + 1; i < end; ++i) {
            for (int k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], points_(order_[i], k));
                high[k] = std::max(high[k], points_(order_[i], k));
            }
        }
        int axis = 0;
        for (int k = 1; k < 3; ++k) {
            if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
        }
        const Index middle = begin + (end - begin) / 2;
        std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                         [this, axis](Index a, Index b) { return points_(a, axis) < points_(b, axis); });
        axis_[middle] = static_cast<char>(axis);
        build(begin, middle);
        build(middle + 1, end);
    }

    f8 away(Index i, const f8* q) const {
        return square(points_(i, 0) - q[0]) + square(points_(i, 1) - q[1]) + square(points_(i, 2) - q[2]);
    }

    void search(Index begin, Index end, const f8* q, Index& best, f8& least) const {
        if (end - begin < 1) return;
        const Index middle = begin + (end - begin) / 2, i = order_[middle];
        const f8 d = away(i, q);
        if (best < 0 || d < least || (d == least && i < best)) {
            best = i;
            least = d;
        }
        const int axis = axis_[middle];
        const f8 side = q[axis] - points_(i, axis);
        if (side < 0.0) search(begin, middle, q, best, least);
        else search(middle + 1, end, q, best, least);
        if (square(side) > least) return;
        if (side < 0.0) search(middle + 1, end, q, best, least);
        else search(begin, middle, q, best, least);
    }

    template <typename Take>
    void collect(Index begin, Index end, const f8* q, f8 radius, const Take& take) const {
        if (end - begin < 1) return;
        const Index middle = begin + (end - begin) / 2, i = order_[middle];
        if (away(i, q) <= square(radius)) take(i);
        const int axis = axis_[middle];
        const f8 side = q[axis] - points_(i, axis);
        if (side <= radius) collect(begin, middle, q, radius, take);
        if (side >= -radius) collect(middle + 1, end, q, radius, take);
    }

    View<const f8, 2> points_;
    std::vector<Index> order_;
    std::vector<char> axis_;
};

inline void find_nearest(View<const f8, 2> points, View<const f8, 2> queries, View<f8, 1> distance, View<i8, 1> which) {
    const Index Q = queries.shape[0];
    require(points.shape[0] > 0 && points.shape[1] == 3 && queries.shape[1] == 3, "find_nearest: no points of space");
    require(distance.size() == Q && which.size() == Q, "find_nearest: the shapes differ");
    const Tree tree(points);
    for (Index i = 0; i < Q; ++i) {
        f8 squared;
        which[i] = tree.nearest(queries.row(i), squared);
        distance[i] = std::sqrt(squared);
    }
}

inline void thin(View<const f8, 2> points, View<const i8, 1> order, f8 radius, View<bool, 1> kept) {
    const Index K = points.shape[0];
    require(points.shape[1] == 3 && order.size() == K && kept.size() == K, "thin: the shapes differ");
    const Tree tree(points);
    std::vector<char> left(K, 1);
    for (Index n = 0; n < K; ++n) {
        const Index i = order[n];
        kept[i] = left[i];
        if (left[i]) tree.within(points.row(i), radius, [&](Index j) { left[j] = 0; });
    }
}

inline void define(nb::module_& m) {
    kernel(m, "find_nearest", &find_nearest,
           "Write for each of `queries`, (Q, 3) [m], which of `points`, (K, 3) [m], is nearest, of several the first, and its\n"
           "distance, both (Q,). All are finite.",
           "points", "queries", "distance", "which");
    kernel(m, "thin", &thin,
           "Write which of `points`, (K, 3) [m], are kept, (K,): in `order`, (K,), those farther than `radius` [m] from all kept\n"
           "before. All are finite.",
           "points", "order", "radius", "kept");
}

}  // namespace pacinian::neighbours
