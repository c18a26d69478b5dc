// Samples of a contact: the nodes of a level of the skin, each at its own pressure.
#pragma once
#include <algorithm>

#include "pacinian/scene/hands/capsules.hpp"

namespace pacinian::scene {

inline Index thin(View<const i8, 1> touched, View<const f8, 1> force, i8 level_count, View<const f8, 1> node_area,
                  View<const f8, 1> rest_area, View<const f8, 1> area, View<const f8, 2> points, View<const f8, 2> capsules,
                  View<const i8, 1> bone, View<const f8, 1> slack, View<i8, 1> nodes, View<f8, 1> pressed, View<f8, 1> extent) {
    const Index K = points.shape[0], I = touched.size();
    require(force.size() == I && nodes.size() >= I && pressed.size() >= I && extent.size() >= I, "thin: the shapes differ");
    require(area.size() == K && rest_area.size() == K && level_count <= K && node_area.size() >= level_count, "thin: no skin");
    Index count = 0;
    for (Index i = 0; i < I; ++i) {
        const Index k = touched[i];
        if (k >= level_count) continue;
        const f8 stretch = node_area[k] / rest_area[k];
        nodes[count] = k;
        pressed[count] = force[i] * stretch;
        extent[count] = area[k] * stretch;
        ++count;
    }
    if (!capsules.shape[0] || !count) return count;
    std::vector<char> deep(count, 0);
    static_assert(sizeof(bool) == 1);
    buried(capsules, points, bone, slack, {nodes.data, {count}}, View<bool, 1>{reinterpret_cast<bool*>(deep.data()), {count}});
    Index kept = 0;
    for (Index n = 0; n < count; ++n) {
        if (deep[n]) continue;
        nodes[kept] = nodes[n];
        pressed[kept] = pressed[n];
        extent[kept] = extent[n];
        ++kept;
    }
    return kept;
}

inline Index press_on(View<const i8, 1> nodes, View<const f8, 1> force, View<const f8, 1> extent, f8 least, View<const f8, 2> points,
                      View<const f8, 2> normals, i8 name, View<f8, 1> P, View<f8, 1> area, View<f8, 2> positions, View<f8, 2> outward,
                      View<i8, 1> keys) {
    const Index I = nodes.size();
    require(force.size() == I && extent.size() == I && P.size() >= I && area.size() >= I && keys.size() >= I, "press_on: the shapes differ");
    require(points.shape[1] == 3 && normals.shape[1] == 3 && normals.shape[0] == points.shape[0], "press_on: no skin");
    require(positions.shape[0] >= I && positions.shape[1] == 3 && outward.shape[0] >= I && outward.shape[1] == 3, "press_on: no room");
    Index count = 0;
    for (Index i = 0; i < I; ++i) {
        if (!(0.0 < extent[i])) continue;  // skin of a collapsed hand
        const f8 pressure = force[i] / extent[i];
        if (!(least <= pressure)) continue;
        const Index k = nodes[i];
        P[count] = pressure;
        area[count] = extent[i];
        keys[count] = (name << 31) + k;
        for (int x = 0; x < 3; ++x) {
            positions(count, x) = points(k, x);
            outward(count, x) = normals(k, x);
        }
        ++count;
    }
    return count;
}

inline void define_nodes(nb::module_& m) {
    kernel(m, "thin", &thin,
           "Keep those of the points `touched`, (I,), that are nodes of a level and not inside other flesh; return how many.\n\n"
           "force: on each, (I,) [N]. level_count: number of points, from the first on, that are nodes. node_area: area of each\n"
           "node at rest, (level_count,) [m^2]. rest_area, area: of each point, at rest and now, (K,) [m^2]. points: (K, 3) [m].\n"
           "capsules, bone, slack: as for `buried`; no capsules for a mesh. nodes, pressed, extent: the nodes kept, the force on\n"
           "each [N] and its area [m^2], with room for I.",
           "touched", "force", "level_count", "node_area", "rest_area", "area", "points", "capsules", "bone", "slack", "nodes",
           "pressed", "extent");
    kernel(m, "press_on", &press_on,
           "Write the samples on `nodes`, (I,), that have an area and a pressure of at least `least` [Pa]; return how many.\n\n"
           "force, extent: on each node [N], and its area [m^2], (I,). points, normals: of the skin, (K, 3). name: number of the\n"
           "object in the samples' keys. P, area, positions, outward (normals), keys: of the samples, with room for I.",
           "nodes", "force", "extent", "least", "points", "normals", "name", "P", "area", "positions", "outward", "keys");
}

}  // namespace pacinian::scene
