// The nearest point of a triangle mesh, by a tree of boxes. Compiled for numbers that may be infinite or NaN.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pacinian/native/math.hpp"

namespace pacinian::scene {

constexpr Index LEAF = 4;  // most triangles of a box without boxes inside

struct Point3 {
    f8 x, y, z;
    Point3 operator-(Point3 o) const { return {x - o.x, y - o.y, z - o.z}; }
    Point3 operator+(Point3 o) const { return {x + o.x, y + o.y, z + o.z}; }
    Point3 operator*(f8 s) const { return {s * x, s * y, s * z}; }
};

inline f8 dot(Point3 a, Point3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline Point3 on_segment(Point3 p, Point3 a, Point3 b) {
    const Point3 ab = b - a;
    const f8 whole = dot(ab, ab), part = dot(p - a, ab);
    if (!(part > 0.0)) return a;
    return part < whole ? a + ab * (part / whole) : b;
}

// C. Ericson, "Real-time collision detection", 2005, section 5.1.5; a triangle without area counts as its edges.
inline Point3 on_triangle(Point3 p, Point3 a, Point3 b, Point3 c) {
    const Point3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const f8 d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
    const f8 va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2, whole = va + vb + vc;
    if (va > 0.0 && vb > 0.0 && vc > 0.0 && whole > 0.0) return a + ab * (vb / whole) + ac * (vc / whole);
    Point3 best = on_segment(p, a, b);
    f8 least = dot(p - best, p - best);
    for (const Point3 other : {on_segment(p, b, c), on_segment(p, c, a)}) {
        const f8 d = dot(p - other, p - other);
        if (d < least) {
            least = d;
            best = other;
        }
    }
    return best;
}

// F triangles, sorted by `order`; node i of the tree has the box boxes[i] and, unless it is a leaf, the nodes i + 1 and
// right[i], which have half of its triangles each.
template <typename Real, typename Long>
struct Boxes {
    View<const f8, 2> vertices;
    View<const i8, 2> faces;
    View<Long, 1> order;
    View<Real, 2> boxes;
    View<Long, 1> right;

    Point3 corner(Index face, int k) const {
        const f8* v = vertices.row(faces(face, k));
        return {v[0], v[1], v[2]};
    }
};

using TreeInMaking = Boxes<f8, i8>;
using BoxTree = Boxes<const f8, const i8>;

inline Index make_node(const TreeInMaking& t, Index node, Index begin, Index end) {
    f8* box = t.boxes.row(node);
    f8 low[3], high[3];  // of the middles
    for (int k = 0; k < 3; ++k) {
        box[k] = low[k] = std::numeric_limits<f8>::infinity();
        box[3 + k] = high[k] = -low[k];
    }
    const auto middle_of = [&t](Index face, int k) {
        return t.vertices(t.faces(face, 0), k) + t.vertices(t.faces(face, 1), k) + t.vertices(t.faces(face, 2), k);
    };
    for (Index i = begin; i < end; ++i) {
        for (int k = 0; k < 3; ++k) {
            const f8 m = middle_of(t.order[i], k);
            low[k] = std::min(low[k], m);
            high[k] = std::max(high[k], m);
            for (int c = 0; c < 3; ++c) {
                const f8 x = t.vertices(t.faces(t.order[i], c), k);
                box[k] = std::min(box[k], x);
                box[3 + k] = std::max(box[3 + k], x);
            }
        }
    }
    t.right[node] = 0;
    if (end - begin <= LEAF) return node + 1;
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
        if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    }
    const Index half = begin + (end - begin) / 2;
    std::nth_element(t.order.data + begin, t.order.data + half, t.order.data + end,
                     [&](i8 a, i8 b) { return middle_of(a, axis) < middle_of(b, axis); });
    t.right[node] = make_node(t, node + 1, begin, half);
    return make_node(t, t.right[node], half, end);
}

inline Index build_boxes(View<const f8, 2> vertices, View<const i8, 2> faces, View<i8, 1> order, View<f8, 2> boxes,
                         View<i8, 1> right) {
    const Index F = faces.shape[0];
    require(vertices.shape[1] == 3 && faces.shape[1] == 3 && F > 0, "build_boxes: no triangles of space");
    require(order.size() == F && boxes.shape[0] == F && boxes.shape[1] == 6 && right.size() == F, "build_boxes: the shapes differ");
    std::iota(order.data, order.data + F, i8{0});
    return make_node({vertices, faces, order, boxes, right}, 0, 0, F);
}

struct Found {
    f8 squared = std::numeric_limits<f8>::infinity();
    Index face = 0;
    Point3 at = {0.0, 0.0, 0.0};
};

inline f8 to_box(const f8* box, Point3 p) {
    const f8 q[3] = {p.x, p.y, p.z};
    f8 squared = 0.0;
    for (int k = 0; k < 3; ++k) squared += square(std::max({box[k] - q[k], q[k] - box[3 + k], 0.0}));
    return squared;
}

inline void search_node(const BoxTree& t, Index node, Index begin, Index end, Point3 p, Found& found) {
    const Index right = t.right[node];
    if (!right) {
        for (Index i = begin; i < end; ++i) {
            const Index face = t.order[i];
            const Point3 at = on_triangle(p, t.corner(face, 0), t.corner(face, 1), t.corner(face, 2));
            const f8 squared = dot(p - at, p - at);
            if (squared < found.squared) found = {squared, face, at};
        }
        return;
    }
    const Index half = begin + (end - begin) / 2;
    const f8 first = to_box(t.boxes.row(node + 1), p), second = to_box(t.boxes.row(right), p);
    for (const bool left : {first <= second, first > second}) {
        if (left ? first < found.squared : second < found.squared)
            left ? search_node(t, node + 1, begin, half, p, found) : search_node(t, right, half, end, p, found);
    }
}

inline void find_closest(View<const f8, 2> vertices, View<const i8, 2> faces, View<const i8, 1> order, View<const f8, 2> boxes,
                         View<const i8, 1> right, View<const f8, 2> points, View<f8, 1> squared, View<i8, 1> face,
                         View<f8, 2> nearest) {
    const Index K = points.shape[0], F = faces.shape[0];
    require(vertices.shape[1] == 3 && faces.shape[1] == 3 && F > 0 && order.size() == F && boxes.shape[1] == 6 &&
                boxes.shape[0] == right.size(), "find_closest: no tree");
    require(points.shape[1] == 3 && squared.size() == K && face.size() == K && nearest.shape[0] == K && nearest.shape[1] == 3,
            "find_closest: the shapes differ");
    const BoxTree tree{vertices, faces, order, boxes, right};
    for (Index i = 0; i < K; ++i) {
        Found found;
        search_node(tree, 0, 0, F, {points(i, 0), points(i, 1), points(i, 2)}, found);
        squared[i] = found.squared;
        face[i] = found.face;
        nearest(i, 0) = found.at.x;
        nearest(i, 1) = found.at.y;
        nearest(i, 2) = found.at.z;
    }
}

inline Index find_root(View<i8, 1> group, Index i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
}

inline Index label_bodies(View<const i8, 2> edges, View<i8, 1> first, View<i8, 1> body) {
    const Index F = edges.shape[0];
    require(edges.shape[1] == 3 && body.size() == F, "label_bodies: the shapes differ");
    std::fill(first.data, first.data + first.size(), i8{-1});
    std::iota(body.data, body.data + F, i8{0});
    for (Index f = 0; f < F; ++f) {
        for (int k = 0; k < 3; ++k) {
            i8& known = first[edges(f, k)];
            if (known < 0) {
                known = f;
                continue;
            }
            const Index a = find_root(body, known), b = find_root(body, f);
            body[std::max(a, b)] = std::min(a, b);
        }
    }
    for (Index f = 0; f < F; ++f) body[f] = find_root(body, f);  // the first of its body
    Index count = 0;  // below 0, a number that is known
    for (Index f = 0; f < F; ++f) body[f] = body[f] == f ? -1 - count++ : body[body[f]];
    for (Index f = 0; f < F; ++f) body[f] = -1 - body[f];
    return count;
}

inline void define_closest(nb::module_& m) {
    kernel(m, "build_boxes", &build_boxes,
           "Write the tree of boxes of triangles: vertices, (V, 3) [m], faces, (F, 3), F > 0. Returns the number of nodes.\n\n"
           "order: of the triangles, (F,). boxes: lower and upper corner of each node, (F, 6) [m]. right: its second node, (F,).",
           "vertices", "faces", "order", "boxes", "right");
    kernel(m, "find_closest", &find_closest,
           "Write the squared distance of points, (K, 3), from triangles [m^2], the nearest triangle and the nearest point [m].\n\n"
           "order, boxes, right: from `build_boxes`. From a point that is not finite, the distance is infinite.",
           "vertices", "faces", "order", "boxes", "right", "points", "squared", "face", "nearest");
    kernel(m, "label_bodies", &label_bodies,
           "Write the number of each triangle's body, (F,): bodies are parts that edges connect. Returns the number of bodies.\n\n"
           "edges: of the triangles, (F, 3). first: room for the first triangle of each edge, (E,).",
           "edges", "first", "body");
}

}  // namespace pacinian::scene
