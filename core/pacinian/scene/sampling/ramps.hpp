// One tick of all pressure ramps: match samples with those of the tick before, and move their pressures. See ramps.py.
//
// Common arguments, for M samples asked for and L of the tick before: keys, (M,) and (L,). positions, (M, 3) and (L, 3) [m].
// regions, area [m^2], P, most [Pa]: (M,) and (L,).
#pragma once
#include <algorithm>
#include <cmath>
#include <numeric>

#include "pacinian/neighbours.hpp"

namespace pacinian::scene {

struct Set {
    View<const i8, 1> keys;
    View<const f8, 2> positions;
    View<const i8, 1> regions;
    View<const f8, 1> area, P, most;

    Index size() const { return keys.size(); }
};

// Find for each sample of `which` the nearest of `others` in its region, if it lies on that sample's area; else -1.
inline std::vector<Index> beneath(const Set& samples, const std::vector<Index>& which, const Set& others) {
    std::vector<Index> found(which.size(), -1), there;
    std::vector<f8> points;
    std::vector<char> done(which.size(), 0);
    for (std::size_t first = 0; first < which.size(); ++first) {
        if (done[first]) continue;
        const i8 region = samples.regions[which[first]];
        there.clear();
        points.clear();
        for (Index i = 0; i < others.size(); ++i)
            if (others.regions[i] == region) {
                there.push_back(i);
                points.insert(points.end(), others.positions.row(i), others.positions.row(i) + 3);
            }
        const neighbours::Tree tree({points.data(), {static_cast<Index>(there.size()), 3}});
        for (std::size_t n = first; n < which.size(); ++n) {
            if (samples.regions[which[n]] != region) continue;
            done[n] = 1;
            if (there.empty()) continue;
            f8 squared;
            const Index i = there[tree.nearest(samples.positions.row(which[n]), squared)];
            if (squared <= others.area[i]) found[n] = i;
        }
    }
    return found;
}

// Advance a pressure by `share` of a full ramp from 0 to `most`. The ramp is the square of a sine.
inline f8 advance(f8 P, f8 most, f8 share) {
    if (share == 0.0) return P;
    const f8 way = std::asin(std::sqrt(std::min(P / std::max(most, 1e-300), 1.0))) / M_PI_2 + share;
    if (way >= 1.0) return most;  // exactly, whatever the sine's rounding
    return way > 0.0 ? most * square(std::sin(M_PI_2 * way)) : 0.0;
}

inline Index ramp(View<const i8, 1> keys, View<const f8, 2> positions, View<const i8, 1> regions, View<const f8, 1> area,
                  View<const f8, 1> P, View<const f8, 1> most, View<const i8, 1> last_keys, View<const f8, 2> last_positions,
                  View<const i8, 1> last_regions, View<const f8, 1> last_area, View<const f8, 1> last_P, View<const f8, 1> last_most,
                  f8 share, f8 jump, View<f8, 1> now, View<f8, 1> top, View<i8, 1> going, View<f8, 1> fading, View<bool, 1> jumped) {
    const Set asked{keys, positions, regions, area, P, most};
    const Set last{last_keys, last_positions, last_regions, last_area, last_P, last_most};
    const Index M = asked.size(), L = last.size();
    for (const Set* set : {&asked, &last}) {
        const Index count = set->size();
        require(set->positions.shape[0] == count && set->positions.shape[1] == 3 && set->regions.size() == count, "ramp: the shapes differ");
        require(set->area.size() == count && set->P.size() == count && set->most.size() == count, "ramp: the shapes differ");
    }
    require(now.size() == M && top.size() == M && going.size() == L && fading.size() == L && jumped.size() == L, "ramp: no room");
    std::vector<Index> from(M, -1);  // sample of the tick before, by key
    if (M == L && std::equal(keys.data, keys.data + M, last_keys.data)) std::iota(from.begin(), from.end(), Index{0});
    else {
        std::vector<Index> order(L);
        std::iota(order.begin(), order.end(), Index{0});
        std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return last_keys[a] < last_keys[b]; });
        for (Index m = 0; m < M; ++m) {
            const auto place = std::lower_bound(order.begin(), order.end(), keys[m], [&](Index i, i8 key) { return last_keys[i] < key; });
            if (place != order.end() && last_keys[*place] == keys[m]) from[m] = *place;
        }
    }
    std::vector<char> gone(L, 1);
    std::vector<Index> fresh, left;
    std::fill(jumped.data, jumped.data + L, false);
    for (Index m = 0; m < M; ++m) {
        now[m] = top[m] = 0.0;
        const Index i = from[m];
        if (i < 0) {
            if (regions[m] >= 0) fresh.push_back(m);
            continue;
        }
        f8 squared = 0.0;
        for (int x = 0; x < 3; ++x) squared += square(positions(m, x) - last_positions(i, x));
        if (squared > jump * jump) {
            jumped[i] = true;
            continue;
        }
        gone[i] = 0;
        now[m] = last_P[i];
        top[m] = last_most[i];
    }
    // the samples of a region change when it moves over the skin: new ones start from the pressure that was there, and old ones end
    if (L && !fresh.empty()) {
        const std::vector<Index> under = beneath(asked, fresh, last);
        for (std::size_t n = 0; n < fresh.size(); ++n)
            if (under[n] >= 0) now[fresh[n]] = top[fresh[n]] = std::min(P[fresh[n]], last_P[under[n]]);
    }
    if (M) {
        for (Index i = 0; i < L; ++i)
            if (gone[i] && !jumped[i] && last_regions[i] >= 0) left.push_back(i);
        const std::vector<Index> under = left.empty() ? left : beneath(last, left, asked);
        for (std::size_t n = 0; n < left.size(); ++n)
            if (under[n] >= 0) gone[left[n]] = 0;
    }
    for (Index m = 0; m < M; ++m) {
        // by rounding, a target can be above its highest pressure: its ramp must end nevertheless
        top[m] = std::max({most[m], P[m], now[m] > P[m] ? top[m] : now[m]});
        now[m] = std::min(std::max(P[m], advance(now[m], top[m], -share)), advance(now[m], top[m], share));
    }
    Index count = 0;
    for (Index i = 0; i < L; ++i) {
        if (!gone[i]) continue;
        const f8 rest = advance(last_P[i], std::max(last_most[i], last_P[i]), -share);
        if (!(rest > 0.0)) continue;
        going[count] = i;
        fading[count] = rest;
        jumped[count] = jumped[i];
        ++count;
    }
    return count;
}

inline void define_ramps(nb::module_& m) {
    kernel(m, "ramp", &ramp,
           "Write the pressures and their maxima after one tick, `now` and `top`, (M,) [Pa]; return how many samples fade out.\n\n"
           "keys to most: of the samples asked for. last_keys to last_most: of those of the tick before. share: part of a full ramp\n"
           "that the tick covers. jump: distance from which on a sample starts anew [m]. going, fading, jumped: which of the last\n"
           "samples fade out, with what pressure [Pa], and whether they jumped; room for all, (L,).",
           "keys", "positions", "regions", "area", "P", "most", "last_keys", "last_positions", "last_regions", "last_area", "last_P",
           "last_most", "share", "jump", "now", "top", "going", "fading", "jumped");
}

}  // namespace pacinian::scene
