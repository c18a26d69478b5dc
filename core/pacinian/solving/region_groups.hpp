// Regions and groups: samples that share one free phase. They are the samples of a region, or one isolated sample.
//
// Common arguments: regions: of each sample, (M,); ISOLATED, BESIDE, or from 0 on. given: phases [rad], NaN where free, (M,).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "pacinian/neighbours.hpp"
#include "pacinian/solving/regions.hpp"

namespace pacinian::solving {

constexpr i8 ISOLATED = -1;  // as in region_numbers.py
constexpr i8 BESIDE = -2;

inline Index number(View<const i8, 1> regions, View<i8, 1> out) {
    require(out.size() == regions.size(), "number: the shapes differ");
    std::vector<i8> names;
    bool any = false;
    for (Index m = 0; m < regions.size(); ++m) {
        const i8 name = regions[m];
        if (name < BESIDE) return -1;
        any = any || name != ISOLATED;
        if (name >= 0 && (names.empty() || names.back() != name)) names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    for (Index m = 0; m < regions.size(); ++m) {
        const i8 name = regions[m];
        out[m] = name < 0 ? name : std::lower_bound(names.begin(), names.end(), name) - names.begin();
    }
    return any ? 1 : 0;
}

inline void waves(View<const f8, 2> q, View<const f8, 1> t, View<const i8, 1> regions, View<const f8, 2> some, View<const f8, 1> centre,
                  f8 k, f8 least, f8 tilt, View<f8, 1> phases) {
    const Index M = q.shape[0];
    require(q.shape[1] == 3 && t.size() == M && regions.size() == M && phases.size() == M, "waves: the shapes differ");
    std::vector<f8> room;
    std::vector<Index> own;
    i8 last = -1;
    for (Index m = 0; m < M; ++m) last = std::max(last, regions[m]);
    std::fill(phases.data, phases.data + M, 0.0);
    for (i8 region = 0; region <= last; ++region) {
        own.clear();
        for (Index m = 0; m < M; ++m)
            if (regions[m] == region) own.push_back(m);
        const Index count = static_cast<Index>(own.size());
        room.resize(5 * count);
        f8 *points = room.data(), *P = points + 3 * count, *made = P + count;
        for (Index i = 0; i < count; ++i) {
            for (int x = 0; x < 3; ++x) points[3 * i + x] = q(own[i], x);
            P[i] = square(t[own[i]]);
        }
        converge({points, {count, 3}}, {P, {count}}, some, centre, k, least, tilt, {made, {count}});
        for (Index i = 0; i < count; ++i) phases[own[i]] = made[i];
    }
}

inline Index combine_regions(View<const f8, 1> t, View<const f8, 1> given, View<const i8, 1> regions, View<const f8, 1> wave,
                  View<const f8, 1> start, bool warm, f8 norm, View<i8, 1> group, View<f8, 1> phi, View<c16, 1> p, View<c16, 1> z) {
    const Index M = t.size();
    require(given.size() == M && regions.size() == M && wave.size() == M && start.size() == M, "combine_regions: the shapes differ");
    require(group.size() == M && phi.size() == M && p.size() == M && z.size() == M + 1, "combine_regions: the shapes differ");
    const auto is_given = [&](Index m) { return given[m] == given[m]; };
    i8 last = 0;
    bool fixed = false;
    for (Index m = 0; m < M; ++m) {
        last = std::max(last, regions[m]);
        fixed = fixed || is_given(m);
    }
    std::vector<Index> of(last + 1, -1);  // group of each region; silence has no phase, and joins the first
    for (Index m = 0; m < M; ++m)
        if (!is_given(m) && regions[m] != ISOLATED) of[std::max<i8>(regions[m], 0)] = 0;
    Index count = fixed;
    for (Index& one : of)
        if (one == 0) one = count++;
    for (Index m = 0; m < M; ++m)
        group[m] = is_given(m) ? 0 : regions[m] == ISOLATED ? count++ : of[std::max<i8>(regions[m], 0)];
    std::fill(z.data, z.data + count, c16(0.0));
    for (Index m = 0; m < M; ++m) {
        const bool alone = regions[m] == ISOLATED && !is_given(m);
        phi[m] = is_given(m) ? given[m] : alone ? start[m] : wave[m];
        const f8 turn = (warm || alone ? start[m] : wave[m]) - phi[m];
        z[group[m]] += std::polar(t[m], turn);
    }
    for (Index g = 0; g < count; ++g) {
        const f8 size = std::sqrt(power(z[g]));
        z[g] = size > 0.0 && !(fixed && g == 0) ? z[g] / size : c16(1.0);
    }
    if (count > 1)
        for (Index m = 0; m < M; ++m) p[m] = std::polar(t[m] / norm, phi[m]);
    return count;
}

inline void rotate_phases(View<const f8, 1> given, View<const i8, 1> group, View<const c16, 1> z, View<f8, 1> phi) {
    require(given.size() == phi.size() && group.size() == phi.size(), "rotate_phases: the shapes differ");
    for (Index m = 0; m < phi.size(); ++m)
        if (given[m] != given[m]) phi[m] += std::arg(z[group[m]]);
}

// Return the median of each coordinate of displacements, (count, 3), which it reorders.
inline std::array<f8, 3> median(std::vector<std::array<f8, 3>>& displacements) {
    std::array<f8, 3> out{};
    const auto middle = displacements.begin() + static_cast<Index>(displacements.size() / 2);
    for (int x = 0; x < 3 && middle != displacements.end(); ++x) {
        std::nth_element(displacements.begin(), middle, displacements.end(), [x](const auto& a, const auto& b) { return a[x] < b[x]; });
        out[x] = (*middle)[x];
    }
    return out;
}

inline Index carry_multipliers(View<const f8, 2> q, View<const i8, 1> now, View<const f8, 2> before, View<const i8, 1> were,
                   View<const f8, 1> asked, View<const c16, 1> multipliers, View<const c16, 1> made, f8 near, f8 still,
                   View<f8, 1> phases, View<c16, 1> y) {
    const Index M = q.shape[0], K = before.shape[0];
    require(q.shape[1] == 3 && before.shape[1] == 3 && now.size() == M && were.size() == K, "carry_multipliers: the shapes differ");
    require(asked.size() == K && multipliers.size() == K && made.size() == M && phases.size() == M && y.size() == M,
            "carry_multipliers: the shapes differ");
    for (Index m = 0; m < M; ++m) phases[m] = std::arg(made[m]), y[m] = 0.0;
    i8 last = ISOLATED;
    for (Index m = 0; m < M; ++m) last = std::max(last, now[m]);
    std::vector<Index> there;
    std::vector<f8> points;
    std::vector<std::array<f8, 3>> moves;
    Index found = 0;
    for (const i8 kind : {BESIDE, ISOLATED, i8(0)}) {  // 0: any region
        there.clear();
        points.clear();
        for (Index i = 0; i < K; ++i)
            if (std::min<i8>(were[i], 0) == kind) {
                there.push_back(i);
                points.insert(points.end(), before.row(i), before.row(i) + 3);
            }
        if (there.empty()) continue;
        const neighbours::Tree tree({points.data(), {static_cast<Index>(there.size()), 3}});
        for (i8 region = kind; region <= (kind ? kind : last); ++region) {
            f8 squared;
            moves.clear();
            for (Index m = 0; m < M; ++m) {
                if (now[m] != region) continue;
                const Index i = there[tree.nearest(q.row(m), squared)];
                if (std::sqrt(squared) >= near) continue;
                phases[m] = asked[i];
                moves.push_back({q(m, 0) - before(i, 0), q(m, 1) - before(i, 1), q(m, 2) - before(i, 2)});
            }
            const auto move = median(moves);
            for (Index m = 0; m < M; ++m) {
                if (now[m] != region) continue;
                const f8 came[3] = {q(m, 0) - move[0], q(m, 1) - move[1], q(m, 2) - move[2]};
                const Index i = there[tree.nearest(came, squared)];
                if (std::sqrt(squared) >= still) continue;
                phases[m] = asked[i];
                y[m] = multipliers[i];
                ++found;
            }
        }
    }
    return found;
}

inline void define_groups(nb::module_& m) {
    kernel(m, "number", &number,
           "Write the regions, (M,), renumbered from 0; return 1 if any sample is not isolated, else 0, and -1 for a wrong number.",
           "regions", "out");
    kernel(m, "waves", &waves,
           "Write the phases [rad] of the regions' points, (M,), as `converge` does for each region; 0 for all other points.\n\n"
           "q: (M, 3) [m]. t: amplitudes, (M,) [Pa]. regions: numbered from 0, (M,). Others: as for `converge`.",
           "q", "t", "regions", "some", "centre", "k", "least", "tilt", "phases");
    kernel(m, "combine_regions", &combine_regions,
           "Write the group of each sample, (M,), the samples of which share one free phase; return the number of groups.\n\n"
           "Samples with given phases are group 0, if there are any; then come the regions, then each isolated sample. t, given,\n"
           "regions: of each sample, (M,); given: NaN where free [rad]. wave: see `waves`. start: phases that the groups start\n"
           "from, (M,); for regions only if `warm`. norm: of t. phi: phases within the groups, (M,). p: t / norm with these\n"
           "phases, (M,), written if there are several groups. z: phase factor of each group, (M + 1,).",
           "t", "given", "regions", "wave", "start", "warm", "norm", "group", "phi", "p", "z");
    kernel(m, "rotate_phases", &rotate_phases, "Add the phase of its group's factor z to each free phase phi, (M,) [rad]; see `combine_regions`.", "given", "group", "z",
           "phi");
    kernel(m, "carry_multipliers", &carry_multipliers,
           "Write the phases, (M,) [rad], and multipliers y, (M,), that points take over from earlier points of their kind.\n\n"
           "Kinds are: in a region, isolated, beside regions. The multiplier is that of the same point, the phase is that of the\n"
           "same or the nearest point; without one, they are 0 and the phase of the pressure `made`, (M,). The same point is where\n"
           "a point was if its whole region has moved alike, within `still` [m]. near: distance from which on there is no nearest\n"
           "point [m]. q, now: points, (M, 3) [m], and their regions. before, were, asked, multipliers: earlier points, (K, 3) [m],\n"
           "with their regions, phases [rad] and multipliers. Returns how many points have a multiplier.",
           "q", "now", "before", "were", "asked", "multipliers", "made", "near", "still", "phases", "y");
}

}  // namespace pacinian::solving
