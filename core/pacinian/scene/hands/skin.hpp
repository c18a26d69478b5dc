// Place the points of a skin that are fixed to capsules, or to the faces of a mesh.
#pragma once
#include <algorithm>
#include <cmath>

#include "pacinian/scene/hands/capsules.hpp"

namespace pacinian::scene {

constexpr f8 SHORT = 1e-12;     // a shorter vector has no direction [m]
constexpr f8 STRAIGHT = 1e-18;  // squared sine below which two directions are parallel

struct Tilted {
    f8 axial, area;
};

using Frame = f8[3][3];  // the axes are the columns

// Return the axial component of a normal on a tapered capsule, and a value proportional to the area there [m^2].
//
// axial, along: as for `capsule_skin._Around`. first, last: radii [m]. A cap grows or shrinks as the mantle tilts. Equal
// steps along the axis of a cap have equal areas (Archimedes), so its points stay evenly spread.
inline Tilted tilted(f8 axial, f8 along, f8 first, f8 last, f8 length) {
    f8 lean = first - last;
    lean = std::abs(lean) < length ? lean / length : lean > 0.0 ? 1.0 : lean < 0.0 ? -1.0 : 0.0;
    if (axial == 0.0) return {lean, (first + along * (last - first)) * length * (1.0 - lean * lean)};
    if (along == 0.0) return {-1.0 + (1.0 + axial) * (1.0 + lean), first * first * (1.0 + lean)};
    return {1.0 - (1.0 - axial) * (1.0 - lean), last * last * (1.0 - lean)};
}

inline void tilt(View<const f8, 1> axial, View<const f8, 1> along, f8 first, f8 last, f8 length, View<f8, 1> out, View<f8, 1> area) {
    const Index N = axial.size();
    require(along.size() == N && out.size() == N && area.size() == N, "tilt: the shapes differ");
    for (Index k = 0; k < N; ++k) {
        const Tilted now = tilted(axial[k], along[k], first, last, length);
        out[k] = now.axial;
        area[k] = now.area;
    }
}

inline f8 dot(const f8 (&a)[3], const f8 (&b)[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline void cross(const f8 (&a)[3], const f8 (&b)[3], f8 (&out)[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

// Make the palm's frame: y from the wrist to the middle finger's proximal joint, x from the index's to the little one's.
inline void palm(View<const f8, 2> joints, f8 mirror, Frame& out) {
    f8 x[3], y[3], z[3];
    for (int i = 0; i < 3; ++i) {
        x[i] = (joints(22, i) - joints(7, i)) * (i ? 1.0 : mirror);
        y[i] = (joints(12, i) - joints(1, i)) * (i ? 1.0 : mirror);
    }
    const f8 long_y = std::max(std::sqrt(dot(y, y)), SHORT);
    for (f8& v : y) v /= long_y;
    const f8 along = dot(x, y);
    for (int i = 0; i < 3; ++i) x[i] -= along * y[i];
    const f8 long_x = std::max(std::sqrt(dot(x, x)), SHORT);
    for (f8& v : x) v /= long_x;
    cross(x, y, z);
    f8 total = 0.0;
    for (int i = 0; i < 3; ++i) {
        out[i][0] = x[i], out[i][1] = y[i], out[i][2] = z[i];
        total += x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    }
    if (total >= 2.5) return;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) out[i][j] = i == j ? 1.0 : 0.0;
}

// Rotate the frame `parent` by the smallest rotation that takes `rest`, given in this frame, to `now`.
inline void turn(const Frame& parent, const f8 (&rest)[3], const f8 (&now)[3], Frame& out) {
    std::copy(&parent[0][0], &parent[0][0] + 9, &out[0][0]);
    const f8 size = std::sqrt(dot(now, now));
    if (size < SHORT) return;
    f8 d[3] = {}, v[3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) d[i] += parent[j][i] * now[j] / size;
    cross(rest, d, v);
    f8 cosine = dot(rest, d), half;
    const f8 squared = dot(v, v);
    Frame R = {};
    if (cosine > 0.0 || squared > STRAIGHT) {
        half = cosine > 0.0 ? 1.0 / (1.0 + cosine) : (1.0 - cosine) / squared;
        R[0][1] = -v[2], R[1][0] = v[2], R[0][2] = v[1], R[2][0] = -v[1], R[1][2] = -v[0], R[2][1] = v[0];
    } else {  // half a turn about any axis across `rest`
        int least = 0;
        for (int i = 1; i < 3; ++i)
            if (std::abs(rest[i]) < std::abs(rest[least])) least = i;
        const f8 along = rest[least];
        for (int i = 0; i < 3; ++i) v[i] = (i == least ? 1.0 : 0.0) - along * rest[i];
        half = 2.0 / dot(v, v);
        cosine = -1.0;
    }
    for (int i = 0; i < 3; ++i) {
        R[i][i] += cosine;
        for (int j = 0; j < 3; ++j) R[i][j] += half * v[i] * v[j];
    }
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) out[i][j] = parent[i][0] * R[0][j] + parent[i][1] * R[1][j] + parent[i][2] * R[2][j];
}

inline void place_on_capsules(View<const f8, 2> joints, f8 mirror, View<const f8, 2> capsules, View<const i8, 1> parents,
                              View<const f8, 2> axes, View<const f8, 1> length, View<const f8, 2> radii, View<const i8, 1> bone,
                              View<const f8, 1> along, View<const f8, 1> axial, View<const f8, 2> sides, View<const f8, 1> area,
                              View<f8, 2> at, View<f8, 2> facing, View<f8, 1> stands) {
    const Index C = capsules.shape[0], K = bone.size();
    require_capsules(capsules);
    require(joints.shape[0] == 26 && joints.shape[1] == 3 && parents.size() == C && axes.shape[0] == C && length.size() == C,
            "place: no bones");
    require(radii.shape[0] == C && radii.shape[1] == 2 && axes.shape[1] == 3, "place: no bones");
    require(along.size() == K && axial.size() == K && sides.shape[0] == K && sides.shape[1] == 3 && area.size() == K, "place: no skin");
    require(at.shape[0] == K && facing.shape[0] == K && stands.size() == K && at.shape[1] == 3 && facing.shape[1] == 3,
            "place: the shapes differ");
    struct Bone {
        Frame frame;
        f8 ahead[3], length;
    };
    std::vector<Bone> bones(C);
    Frame hand;
    palm(joints, mirror, hand);
    for (Index c = 0; c < C; ++c) {
        Bone& now = bones[c];
        const f8* a = capsules.row(c);
        const f8 u[3] = {mirror * (a[3] - a[0]), a[4] - a[1], a[5] - a[2]};
        const f8 rest[3] = {axes(c, 0), axes(c, 1), axes(c, 2)};
        turn(parents[c] < 0 ? hand : bones[parents[c]].frame, rest, u, now.frame);
        now.length = std::sqrt(dot(u, u));
        for (int i = 0; i < 3; ++i) now.ahead[i] = dot(now.frame[i], rest);
    }
    for (Index k = 0; k < K; ++k) {
        const Index c = bone[k];
        const Bone& own = bones[c];
        const f8* a = capsules.row(c);
        const f8 first = a[6], last = a[7];
        f8 s = along[k];
        const Tilted now = tilted(axial[k], s, first, last, own.length);
        const f8 rest = tilted(axial[k], s, radii(c, 0), radii(c, 1), length[c]).area;
        if (own.length <= std::abs(first - last) && std::abs(first - last) > 0.0) s = first > last ? 0.0 : 1.0;  // one sphere contains the other
        const f8 aside = std::sqrt(std::max(1.0 - now.axial * now.axial, 0.0)), r = first + s * (last - first);
        for (int i = 0; i < 3; ++i) {
            const auto& F = own.frame[i];
            const f8 across = F[0] * sides(k, 0) + F[1] * sides(k, 1) + F[2] * sides(k, 2);
            const f8 n = (now.axial * own.ahead[i] + aside * across) * (i ? 1.0 : mirror);
            at(k, i) = a[i] + s * (a[3 + i] - a[i]) + r * n;
            facing(k, i) = n;
        }
        stands[k] = area[k] * now.area / rest;
    }
}

inline void place_on_mesh(View<const f8, 2> vertices, View<const i8, 2> corners, View<const f8, 2> coordinates, f8 outward,
                          View<const f8, 1> doubled, View<const f8, 1> area, View<const i8, 1> patch, View<f8, 2> at,
                          View<f8, 2> facing, View<f8, 1> stands, View<f8, 2> bounds) {
    const Index K = area.size(), C = bounds.shape[0];
    require(vertices.shape[1] == 3 && corners.shape[0] == K && corners.shape[1] == 3 && coordinates.shape[0] == K, "place: no faces");
    require(coordinates.shape[1] == 3 && doubled.size() == K && patch.size() == K && at.shape[0] == K && at.shape[1] == 3, "place: no skin");
    require(facing.shape[0] == K && facing.shape[1] == 3 && stands.size() == K && bounds.shape[1] == 4, "place: the shapes differ");
    std::vector<f8> counts(C, 0.0);
    for (Index k = 0; k < K; ++k) {
        const f8 *a = vertices.row(corners(k, 0)), *b = vertices.row(corners(k, 1)), *c = vertices.row(corners(k, 2));
        const f8 u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        f8 n[3];
        cross(u, v, n);
        const f8 size = std::sqrt(dot(n, n));
        counts[patch[k]] += 1.0;
        for (int i = 0; i < 3; ++i) {
            at(k, i) = coordinates(k, 0) * a[i] + coordinates(k, 1) * b[i] + coordinates(k, 2) * c[i];
            facing(k, i) = size > 0.0 ? outward * n[i] / size : 0.0;
            bounds(patch[k], i) += at(k, i);
        }
        stands[k] = area[k] * size / doubled[k];
    }
    for (Index p = 0; p < C; ++p)
        for (int i = 0; i < 3; ++i) bounds(p, i) /= std::max(counts[p], 1.0);
    for (Index k = 0; k < K; ++k) {
        f8* ball = bounds.row(patch[k]);
        ball[3] = std::max(ball[3], std::sqrt(square(at(k, 0) - ball[0]) + square(at(k, 1) - ball[1]) + square(at(k, 2) - ball[2])));
    }
}

inline void define_skin(nb::module_& m) {
    kernel(m, "tilt", &tilt,
           "Write the axial parts of normals where a capsule tapers, and what the areas there are proportional to [m^2].\n\n"
           "axial, along: (N,), as for `capsule_skin._Around`. first, last: radii [m]. length: [m]. out, area: (N,).",
           "axial", "along", "first", "last", "length", "out", "area");
    kernel(m, "place_on_capsules", &place_on_capsules,
           "Write where the points of a capsule skin are: `at`, `facing`, (K, 3), and the area each `stands` for, (K,).\n\n"
           "joints: (26, 3) [m]. mirror: -1 for a left hand. capsules: (C, 8) [m]. parents, axes, length, radii: of the bones at\n"
           "rest, (C,), (C, 3), (C,), (C, 2). bone, along, axial, sides, area: of the points: see `CapsuleSkin`.",
           "joints", "mirror", "capsules", "parents", "axes", "length", "radii", "bone", "along", "axial", "sides", "area", "at",
           "facing", "stands");
    kernel(m, "place_on_mesh", &place_on_mesh,
           "Write where the points of a mesh skin are: `at`, `facing`, (K, 3), the area each `stands` for, (K,), `bounds`, (C, 4).\n\n"
           "vertices: (V, 3) [m]. corners: of each point's face, (K, 3). coordinates: barycentric, (K, 3). outward: 1 or -1.\n"
           "doubled: twice the face's area at rest. area: of each point at rest. patch: of each, (K,). bounds are 0 before.",
           "vertices", "corners", "coordinates", "outward", "doubled", "area", "patch", "at", "facing", "stands", "bounds");
}

}  // namespace pacinian::scene
