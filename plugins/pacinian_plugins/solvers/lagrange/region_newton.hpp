// Least squares of regions under the gain limit: Newton steps on the multipliers y, by preconditioned conjugate gradients.
//
// See regions.py for the equations. A step solves (D + B W B^H) d = F. The preconditioner is the Cholesky factor of that
// matrix for some of the transducers, in single precision: of the whole matrix, or of blocks on its diagonal.
//
// Common arguments: B, y, h, made, tile: as in fused_passes.hpp. block: the M samples of one block. L: lower triangle for it,
// real and imaginary parts, (2, K, K), K = M rounded up to 2. See `RegionWorkspace`.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pacinian/native/math.hpp"
#include "pacinian_plugins/solvers/lagrange/fused_passes.hpp"
#include "pacinian_plugins/solvers/lagrange/workspace.hpp"

namespace pacinian::lagrange {

constexpr f8 STOP_RESIDUAL = 5e-3;     // ||F|| / ||p|| to stop at: a smaller error cannot be felt
constexpr f8 INEXACT = 0.1;            // residual of a Newton system, relative to ||F||
constexpr Index MAX_STEPS = 15;        // Newton steps in one call
constexpr Index MAX_PASSES = 300;      // conjugate gradients in one Newton step
// Conjugate gradients with an old preconditioner after which the next step makes a new one, and their ratio to those with
// the new one.
constexpr Index MAX_OLD_PASSES = 8, MAX_OLD_RATIO = 2;
constexpr Index MIN_PASSES = 4;        // conjugate gradients taken even without time, so that the next call starts closer
constexpr Index MAX_KEPT = 1 << 22;    // elements of B whose copy is kept for the next call
constexpr f8 ARMIJO = 1e-4;            // least share of the expected increase
constexpr f8 MIN_STEP = 1e-6;          // shortest step
constexpr i8 SILENT = -2;              // region number of silent samples, as `pacinian.region_numbers.BESIDE`
constexpr f8 HELD = 1.0 - 1e-5;        // |h| from which a transducer is at its limit, as `pacinian.solving.solution_metrics.AT_LIMIT`

struct Sum {
    f4 re, im;
};

// Return sum_k x_k conj(z_k) of two rows by two, in s[row of x][row of z].
inline void products(const f4* __restrict xr0, const f4* __restrict xi0, const f4* __restrict xr1, const f4* __restrict xi1,
                     const f4* __restrict zr0, const f4* __restrict zi0, const f4* __restrict zr1, const f4* __restrict zi1,
                     Index count, Sum (&s)[2][2]) {
    f4 r00 = 0, i00 = 0, r01 = 0, i01 = 0, r10 = 0, i10 = 0, r11 = 0, i11 = 0;
    for (Index n = 0; n < count; ++n) {
        r00 += xr0[n] * zr0[n] + xi0[n] * zi0[n];
        i00 += xi0[n] * zr0[n] - xr0[n] * zi0[n];
        r01 += xr0[n] * zr1[n] + xi0[n] * zi1[n];
        i01 += xi0[n] * zr1[n] - xr0[n] * zi1[n];
        r10 += xr1[n] * zr0[n] + xi1[n] * zi0[n];
        i10 += xi1[n] * zr0[n] - xr1[n] * zi0[n];
        r11 += xr1[n] * zr1[n] + xi1[n] * zi1[n];
        i11 += xi1[n] * zr1[n] - xr1[n] * zi1[n];
    }
    s[0][0] = {r00, i00}, s[0][1] = {r01, i01}, s[1][0] = {r10, i10}, s[1][1] = {r11, i11};
}

// Write D + B W B^H of one block for every `stride`-th transducer, each with that weight, to the lower triangle L.
inline void couple(View<const c8, 2> B, View<const f8, 1> D, View<const f4, 2> h, f4 mu, const i8* block, Index M, Index stride,
                   View<f4, 3> tile, View<f4, 3> L) {
    const Index N = B.shape[1], K = L.shape[1], all = (N + stride - 1) / stride;
    const f4 share = static_cast<f4>(N) / static_cast<f4>(all);
    std::fill(L.data, L.data + L.size(), 0.0f);
    for (Index i = 0; i < K; ++i) L(0, i, i) = i < M ? static_cast<f4>(D[block[i]]) : 1.0f;
    if (K > M) std::fill(tile.row(0, M), tile.row(0, M) + TILE, 0.0f), std::fill(tile.row(1, M), tile.row(1, M) + TILE, 0.0f);
    alignas(64) f4 root[TILE];
    for (Index first = 0; first < all; first += TILE) {
        const Index count = std::min(TILE, all - first);
        const f4* size = h.row(2) + stride * first;
        for (Index n = 0; n < count; ++n) {  // a gain at its limit can turn but not grow: one of two directions
            const f4 weight = size[stride * n] > mu ? 0.5f / size[stride * n] : 1.0f / mu;
            root[n] = std::sqrt(share * weight);
        }
        for (Index m = 0; m < M; ++m) {
            const f4* __restrict row = reinterpret_cast<const f4*>(B.row(block[m]) + stride * first);
            f4 *__restrict re = tile.row(0, m), *__restrict im = tile.row(1, m);
            for (Index n = 0; n < count; ++n) {
                re[n] = row[2 * stride * n] * root[n];
                im[n] = row[2 * stride * n + 1] * root[n];
            }
        }
        Sum s[2][2];
        for (Index i = 0; i < K; i += 2)
            for (Index j = 0; j <= i; j += 2) {
                products(tile.row(0, i), tile.row(1, i), tile.row(0, i + 1), tile.row(1, i + 1), tile.row(0, j), tile.row(1, j),
                         tile.row(0, j + 1), tile.row(1, j + 1), count, s);
                for (int a = 0; a < 2; ++a)
                    for (int b = 0; b < 2; ++b) {
                        L(0, i + a, j + b) += s[a][b].re;
                        L(1, i + a, j + b) += s[a][b].im;
                    }
            }
    }
}

// Replace the lower triangle L of a Hermitian matrix by its Cholesky factor; return whether it is positive definite.
inline bool decompose(View<f4, 3> L) {
    const Index K = L.shape[1];
    Sum s[2][2];
    const auto finish = [&](Index i, Index j, Sum sum) {  // the element (i, j), given the sum over all columns before j
        L(0, i, j) = (L(0, i, j) - sum.re) / L(0, j, j);
        L(1, i, j) = (L(1, i, j) - sum.im) / L(0, j, j);
    };
    const auto pivot = [&](Index i, f4 sum) {
        const f4 rest = L(0, i, i) - sum;
        L(0, i, i) = std::sqrt(std::max(rest, 0.0f));
        L(1, i, i) = 0.0f;
        return rest > 0.0f;
    };
    for (Index i = 0; i < K; i += 2) {
        for (Index j = 0; j <= i; j += 2) {
            products(L.row(0, i), L.row(1, i), L.row(0, i + 1), L.row(1, i + 1), L.row(0, j), L.row(1, j), L.row(0, j + 1),
                     L.row(1, j + 1), j, s);
            if (j == i) break;
            const f4 re = L(0, j + 1, j), im = L(1, j + 1, j);
            for (int a = 0; a < 2; ++a) {
                finish(i + a, j, s[a][0]);
                const f4 x = L(0, i + a, j), y = L(1, i + a, j);
                finish(i + a, j + 1, {s[a][1].re + x * re + y * im, s[a][1].im + y * re - x * im});
            }
        }
        if (!pivot(i, s[0][0].re)) return false;
        finish(i + 1, i, s[1][0]);
        if (!pivot(i + 1, s[1][1].re + square(L(0, i + 1, i)) + square(L(1, i + 1, i)))) return false;
    }
    return true;
}

// Solve L L^H x = z in place; z: real and imaginary parts, K each.
inline void resolve(View<const f4, 3> L, f4* __restrict zr, f4* __restrict zi) {
    const Index K = L.shape[1];
    for (Index i = 0; i < K; ++i) {
        const f4 *__restrict re = L.row(0, i), *__restrict im = L.row(1, i);
        f4 sr = 0.0f, si = 0.0f;
        for (Index k = 0; k < i; ++k) {
            sr += re[k] * zr[k] - im[k] * zi[k];
            si += re[k] * zi[k] + im[k] * zr[k];
        }
        zr[i] = (zr[i] - sr) / re[i];
        zi[i] = (zi[i] - si) / re[i];
    }
    for (Index i = K - 1; i >= 0; --i) {
        const f4 *__restrict re = L.row(0, i), *__restrict im = L.row(1, i);
        const f4 xr = zr[i] / re[i], xi = zi[i] / re[i];
        zr[i] = xr;
        zi[i] = xi;
        for (Index k = 0; k < i; ++k) {
            zr[k] -= re[k] * xr + im[k] * xi;
            zi[k] -= re[k] * xi - im[k] * xr;
        }
    }
}

using Vector = std::vector<c16>;

inline f8 inner(const Vector& a, const Vector& b) {  // Re(a^H b)
    f8 total = 0.0;
    for (std::size_t m = 0; m < a.size(); ++m) total += a[m].real() * b[m].real() + a[m].imag() * b[m].imag();
    return total;
}

struct Ascent {
    View<const c8, 2> B;
    View<const c16, 1> p;
    View<const f8, 1> D;
    f4 mu;
    View<c16, 1> y;
    View<f4, 2> h;
    View<f8, 2> made;
    solving::Copied tiles;
    RegionWorkspace& w;
    nb::handle spent;
    f8 cost = 0.0;  // sum of c(x_n) at y
    std::vector<f4> plane{};

    Index count() const { return p.size(); }

    bool late() const {
        nb::gil_scoped_acquire held;
        return nb::cast<bool>(spent());
    }

    View<const f4, 2> planes(const c16* x) {
        const Index rows = tiles.rows;
        plane.assign(2 * rows, 0.0f);
        for (Index m = 0; m < count(); ++m) {
            plane[m] = static_cast<f4>(x[m].real());
            plane[rows + m] = static_cast<f4>(x[m].imag());
        }
        View<const f4, 2> view;
        view.data = plane.data(), view.shape[0] = 2, view.shape[1] = rows;
        return view;
    }

    c16 made_at(Index m) const { return {made(0, m), made(1, m)}; }

    // Evaluate y = at + step d, and write F; return the value D(y) of the dual.
    f8 look(const Vector& at, f8 step, const Vector& d, Vector& F) {
        for (Index m = 0; m < count(); ++m) y[m] = at[m] + step * d[m];
        cost = evaluate_tiles(tiles, planes(y.data), mu, h, made);
        f8 value = -cost;
        for (Index m = 0; m < count(); ++m) {
            value += y[m].real() * p[m].real() + y[m].imag() * p[m].imag() - 0.5 * D[m] * power(y[m]);
            F[m] = p[m] - D[m] * y[m] - made_at(m);
        }
        return value;
    }

    // Make the preconditioner at y; return whether all blocks are positive definite.
    bool precondition() {
        return w.visit_blocks([&](const i8* block, Index size, View<f4, 3> L) {
            couple(B, D, h, mu, block, size, w.stride, w.tile.view, L);
            return decompose(L);
        });
    }

    // Write z = the preconditioner times r.
    void approximate(const Vector& r, bool factored, Vector& z) {
        z = r;
        if (!factored) return;
        w.visit_blocks([&](const i8* block, Index size, View<f4, 3> L) {
            const Index K = L.shape[1];
            plane.assign(2 * K, 0.0f);
            for (Index i = 0; i < size; ++i) {
                plane[i] = static_cast<f4>(r[block[i]].real());
                plane[K + i] = static_cast<f4>(r[block[i]].imag());
            }
            resolve(L, plane.data(), plane.data() + K);
            for (Index i = 0; i < size; ++i) z[block[i]] = c16(plane[i], plane[K + i]);
            return true;
        });
    }

    // Solve (D + B W B^H) d = F with a residual of at most `enough`; return the number of products with B.
    Index direction(const Vector& F, f8 enough, bool factored, Vector& d) {
        const Index M = count();
        std::fill(d.begin(), d.end(), c16(0.0));
        Vector r = F, z(M), Hq(M);
        approximate(r, factored, z);
        Vector q = z;
        f8 weight = inner(r, q);
        for (Index done = 0; done < MAX_PASSES; ++done) {
            apply_curvature(tiles, planes(q.data()), h, mu, made);
            for (Index m = 0; m < M; ++m) Hq[m] = D[m] * q[m] + made_at(m);
            const f8 a = weight / inner(q, Hq);
            f8 rest = 0.0;
            for (Index m = 0; m < M; ++m) {
                d[m] += a * q[m];
                r[m] -= a * Hq[m];
                rest += power(r[m]);
            }
            if (rest <= enough * enough || (done >= MIN_PASSES && late())) return done + 1;
            approximate(r, factored, z);
            const f8 last = weight;
            weight = inner(r, z);
            for (Index m = 0; m < M; ++m) q[m] = z[m] + (weight / last) * q[m];
        }
        return MAX_PASSES;
    }
};

// The primal problem at one point of the ascent: gains h, pressures B h, and the objective 1/2 sum |p - B h|^2 / D + mu/2 |h|^2.
//
// The dual value grows with every step. The objective need not fall, and may rise far above that of silence, until the steps
// have converged.
struct Primal {
    std::vector<f4> h;
    std::vector<f8> made;
    f8 objective = std::numeric_limits<f8>::infinity();

    static f8 measure(const Ascent& a) {
        f8 missed = 0.0, strength = 0.0;
        for (Index m = 0; m < a.count(); ++m) missed += power(a.p[m] - a.made_at(m)) / a.D[m];
        const f4 *__restrict re = a.h.row(0), *__restrict im = a.h.row(1);
        for (Index n = 0; n < a.h.shape[1]; ++n) strength += re[n] * re[n] + im[n] * im[n];
        return 0.5 * (missed + a.mu * strength);
    }

    // Keep the present gains if they are the best.
    void consider(const Ascent& a) {
        const f8 found = measure(a);
        if (!(found < objective)) return;
        objective = found;
        h.assign(a.h.data, a.h.data + 2 * a.h.shape[1]);
        made.assign(a.made.data, a.made.data + a.made.size());
    }

    // Write the best gains, weakened to the best multiple that is at most 1.
    void restore(Ascent& a) const {
        if (h.empty()) return;
        f8 along = 0.0, size = 0.0;
        const Index M = a.count();
        for (Index m = 0; m < M; ++m) {
            along += (made[m] * a.p[m].real() + made[M + m] * a.p[m].imag()) / a.D[m];
            size += (square(made[m]) + square(made[M + m])) / a.D[m];
        }
        for (const f4 x : h) size += a.mu * square(static_cast<f8>(x));
        const f8 share = size > 0.0 ? std::clamp(along / size, 0.0, 1.0) : 1.0;
        for (std::size_t n = 0; n < h.size(); ++n) a.h.data[n] = static_cast<f4>(share) * h[n];
        for (std::size_t m = 0; m < made.size(); ++m) a.made.data[m] = share * made[m];
    }
};

inline Index solve_region(View<const c8, 2> B, View<const c16, 1> p, View<const f8, 1> D, f4 mu, View<c16, 1> y, f8 max_gap,
                          RegionWorkspace& w, nb::handle spent) {
    const Index M = w.M, N = w.N;
    require(B.shape[0] == M && B.shape[1] == N && p.size() == M && D.size() == M && y.size() == M, "solve_region: the shapes differ");
    require(mu > 0.0f, "solve_region: mu is not positive");
    const View<f4, 2> h = w.h.view;
    for (Index m = 0; m < M; ++m) require(w.order.view[m] >= 0 && w.order.view[m] < M, "solve_region: a block has a sample that does not exist");
    // for the tiles of B: all problems of a thread share it, but a very large one
    static thread_local std::vector<f4> kept;
    std::vector<f4> large;
    Ascent ascent{B, p, D, mu, y, h, w.made.view, solving::copy_tiles(B, B.size() > MAX_KEPT ? large : kept), w, spent};
    using Factor = RegionWorkspace::Factor;
    f8 size = 0.0;
    for (Index m = 0; m < M; ++m) size += power(p[m]);
    size = std::sqrt(size);
    Vector at(y.data, y.data + M), F(M), d(M), none(M);
    f8 value = ascent.look(at, 0.0, none, F), silence = 0.0;
    for (Index m = 0; m < M; ++m) silence += 0.5 * power(p[m]) / D[m];
    if (Primal::measure(ascent) - value > max_gap * silence) {  // no better a start than no multipliers
        at = none;
        value = ascent.look(at, 0.0, none, F);
        w.state = Factor::none;  // W differs, too
    }
    f8 missed = std::sqrt(inner(F, F));
    Primal best;
    best.consider(ascent);
    Index steps = 0;
    while (missed > STOP_RESIDUAL * size && steps < MAX_STEPS && !(steps && ascent.late())) {
        const bool old = w.state != Factor::none;
        if (!old && !w.sizes.empty()) w.state = ascent.precondition() ? Factor::usable : Factor::indefinite;
        const f8 enough = std::max(INEXACT * missed, STOP_RESIDUAL * size / 2.0);
        const bool usable = w.state == Factor::usable;
        const Index passes = ascent.direction(F, enough, usable, d);
        if (!old) w.passes = passes;
        else if (usable && passes > std::max(MAX_OLD_PASSES, MAX_OLD_RATIO * w.passes)) w.state = Factor::none;
        const f8 slope = inner(F, d), before = value;
        std::copy(y.data, y.data + M, at.begin());
        f8 step = 1.0;
        for (; step > MIN_STEP; step /= 2.0)
            if ((value = ascent.look(at, step, d, F)) >= before + ARMIJO * step * slope) break;
        if (step <= MIN_STEP) {
            ascent.look(at, 0.0, none, F);
            break;
        }
        ++steps;
        missed = std::sqrt(inner(F, F));
        best.consider(ascent);
    }
    w.met = missed <= STOP_RESIDUAL * size;
    f8 dual = -ascent.cost;
    for (Index m = 0; m < M; ++m)
        dual += y[m].real() * p[m].real() + y[m].imag() * p[m].imag() - 0.5 * D[m] * power(y[m]);
    if (!w.met) best.restore(ascent);
    Index held = 0;
    for (Index n = 0; n < N; ++n)
        held += square(static_cast<f8>(h(0, n))) + square(static_cast<f8>(h(1, n))) > HELD * HELD ? 1 : 0;
    w.bound = dual;
    w.objective = Primal::measure(ascent);
    w.held = held;
    return steps;
}

inline void start_region(View<const f8, 1> t, View<const f8, 1> phases, View<const bool, 1> beside, f8 scale, f8 quiet, View<const c16, 1> warm,
                         View<const f8, 1> before, f8 factor, View<c16, 1> p, View<f8, 1> D, View<c16, 1> y) {
    const Index M = t.size();
    require(phases.size() == M && beside.size() == M && p.size() == M && D.size() == M && y.size() == M, "start_region: the shapes differ");
    require(!warm.size() || (warm.size() == M && before.size() == M), "start_region: the shapes differ");
    for (Index m = 0; m < M; ++m) {
        p[m] = std::polar(scale * t[m], phases[m]);
        D[m] = beside[m] ? 1.0 / quiet : 1.0;
        y[m] = warm.size() ? warm[m] * std::polar(factor, phases[m] - before[m]) : c16(0.0);
    }
}

inline f8 find_loudest(View<const f8, 2> points, View<const i8, 1> regions, View<const c16, 1> p, View<const f8, 2> made, f8 near) {
    const Index M = regions.size();
    require(points.shape[0] == M && points.shape[1] == 3 && p.size() == M && made.shape[0] == 2 && made.shape[1] == M, "find_loudest: the shapes differ");
    std::unordered_map<i8, std::pair<f8, f8>> sums;  // of the squared targets of each region, and how many
    for (Index m = 0; m < M; ++m)
        if (regions[m] >= 0) {
            auto& [sum, count] = sums[regions[m]];
            sum += power(p[m]);
            count += 1.0;
        }
    f8 loudest = 0.0;
    for (Index m = 0; m < M; ++m) {
        if (regions[m] != SILENT) continue;
        f8 nearest = std::numeric_limits<f8>::max();
        Index of = -1;
        for (Index k = 0; k < M; ++k) {
            if (regions[k] < 0) continue;
            const f8 distance = square(points(m, 0) - points(k, 0)) + square(points(m, 1) - points(k, 1)) + square(points(m, 2) - points(k, 2));
            if (distance < nearest) nearest = distance, of = k;
        }
        if (of < 0 || nearest < near * near) continue;
        const auto& [sum, count] = sums[regions[of]];
        const f8 made_there = (square(made(0, m)) + square(made(1, m))) * count;
        if (made_there > loudest * sum && sum > 0.0) loudest = made_there / sum;
    }
    return loudest;
}

inline void define_region(nb::module_& m) {
    kernel(m, "solve_region", &solve_region,
           "Solve p - D y - B h(B^H y) = 0 by Newton steps on the multipliers y, from those given; return the number of steps.\n\n"
           "B: (M, N) [Pa]. p: targets, (M,). D: 1 over the weights of the squared errors, (M,). y: (M,), in place. max_gap: largest\n"
           "duality gap of the given y, relative to that of none, to start from them. workspace: the kernel writes h of y, met,\n"
           "bound, objective and held; it keeps the preconditioner for later calls with similar B. If F is not small at the end, h\n"
           "is instead the best of all steps, weakened where that is better, so it is never worse than silence. spent: returns whether the time is up, asked after the first step and after some products of each.",
           "B", "p", "D", "mu", "y", "max_gap", "workspace", "spent");
    kernel(m, "start_region", &start_region,
           "Write targets p, 1 over the weights D, and multipliers y to start from, (M,) each.\n\n"
           "t: amplitudes [Pa], phases: [rad], beside: whether a sample is silent, (M,). scale: factor on t. quiet: weight of silent\n"
           "samples. warm, before: earlier multipliers and phases, which turn together, (M,), or of size 0 for none. factor: on\n"
           "these multipliers.",
           "t", "phases", "beside", "scale", "quiet", "warm", "before", "factor", "p", "D", "y");
    kernel(m, "find_loudest", &find_loudest,
           "The highest pressure at silent samples, relative to the mean of the nearest region.\n\n"
           "points: (M, 3) [m]. regions: their numbers, (M,). p: targets, (M,). made: what is made, real and imaginary part, (2, M).\n"
           "near: samples nearer to a region do not count [m].",
           "points", "regions", "p", "made", "near");
}

}  // namespace pacinian::lagrange
