# Made by `python native_build.py --stubs`.
from typing import overload

from pacinian.types import Complexes, Flags, Floats, Gains, Longs, Singles


TILE: int = 256

def within(size: float, relative: float, mu: float, N: int) -> float:
    """
    By how much to scale targets of norm `size` [Pa per unit limit] so that single precision can work.

    Up to the lower bound, 2 sqrt(mu), nothing reaches its limit: ||g|| <= ||p|| / (2 sqrt(mu)). Beyond the upper one
    the answer hardly changes. relative: mu over trace(G) / M.
    """

def factor(A: Floats, K: int, positive: int) -> int:
    """
    Factor the lower triangle of A, (K, K) or more, in place: A = L S L^T, S = +1 then -1.

    The first `positive` pivots are to be positive, the others negative. One of the wrong sign, or that is rounding,
    becomes so large that its unknown is left at 0. Returns how many did.
    """

def turned(G: Complexes, sample: Longs, u: Singles, scale: float, A: Floats) -> None:
    """
    Write the lower triangle of scale Re(conj(u_i) G_ij u_j) for equations of the given samples, (K,), to A.

    G: (M, M). u: (2, K). A: (K, K) or more.
    """

def substitute(L: Floats, K: int, positive: int, b: Floats) -> None:
    """Solve L S L^T x = b in place."""

def evaluate(B: Gains, y: Singles, mu: float, h: Singles, p: Floats, tile: Singles) -> float:
    """
    Write h(x), |x| and p for multipliers y, (2, rows of `tile`); return the sum of c(x_n).

    B: (M, N) [Pa]. h: (3, N): real and imaginary part of h(x_n), and |x_n|, with x = B^H y. p: B h, (2, M). tile: as in
    `passes`. h = x / max(|x|, mu); c = |x|^2 / (2 mu) where |x| <= mu, else |x| - mu / 2. mu = 0: all at the limit.
    """

def curvature(B: Gains, sample: Longs, u: Singles, h: Singles, mu: float, few: bool, A: Floats, V: Singles, which: Longs) -> None:
    """
    Add to A, (K, K), lower triangle, how Re(conj(u_i) p_i) changes with y_j = u_j.

    Where h is free it is 1 / mu in both directions, at the limit 1 / |x| along its phase. few: subtract instead, from
    1 / mu for all, what those at their limit lack: cheap while they are few. sample: of each equation, (K,); u: its
    phasor, (2, K). h: as of `evaluate`. V: room, (K rounded up to 4, 2 TILE); which: (TILE,).
    """

def bend(B: Gains, d: Singles, h: Singles, mu: float, p: Floats, tile: Singles) -> None:
    """
    Write p = B W B^H d, (2, M), W = dh/dx at the gains h; arguments as of `evaluate`. d: (2, rows of `tile`).
    """

def descend(B: Gains, G: Complexes, p: Complexes, free: Flags, mu: float, steps: int, enough: float, y: Complexes, h: Singles, made: Floats, A: Floats, tile: Singles, V: Singles, which: Longs, found: Floats) -> int:
    """
    Solve Re(conj(u_k) (B h(B^H y) + y)) = t_k by Newton steps on the multipliers y.

    One equation per sample where its phase is `free`, along the phasor of the pressure made, two where it is fixed.
    G: B B^H, (M, M). p: targets, (M,) [Pa]. y: multipliers to start from, (M,), in place. h, made, tile, V, which: as of
    `evaluate`, `curvature`. A: room, (2M + 4, 2M + 4). found: ||asked - made|| / ||p||, the sum of c(x_n), the number at
    their limit; ||F|| / ||p|| and how many steps in a row did little, to go on with.
    Returns the number of steps, negative if they came to nothing.
    """

def certify(p: Complexes, free: Flags, mu: float, y: Complexes, h: Singles, made: Floats, cost: float, proof: Floats) -> None:
    """
    Write D(y), 1/2 ||p - made||^2 + mu/2 ||h||^2 for the phases made, and how many are at their limit.

    proof: they are its elements 5 to 7. cost: the sum of c(x_n) at y. Others as of `descend`.
    """

def deliver(h: Singles, unit: float, out: Gains) -> None:
    """
    Write the gains, (N,), of those in units of the limit, h, (2 or more, N).
    """

def attempt(B: Gains, G: Complexes, p: Complexes, free: Flags, mu: float, steps: int, enough: float, y: Complexes, h: Singles, made: Floats, A: Floats, tile: Singles, V: Singles, which: Longs, found: Floats, unit: float, out: Gains) -> int:
    """As `descend`, then `certify` and `deliver`."""

def equalise(B: Gains, p: Complexes, steps: int, y: Complexes, h: Singles, made: Floats, tile: Singles, found: Floats) -> int:
    """
    Make |B h| proportional to |p| with every |h_n| = 1, from multipliers y, (M,), in place.

    h, made, tile: as of `evaluate`. All targets are above 0 and their phases free (Di Leonardo et al., Opt. Express 15,
    2007, here over-relaxed). found[0]: the multiple of |p| that is nearest to what is made.
    Returns the number of steps, negative if more may help.
    """

def movable(h: Singles, mu: float, damping: float, x: Singles, held: Flags, D: Singles) -> None:
    """
    Turn x = B^H y, (2, N), into the gradient v along what can move; write what is held, and D, (N,).

    h: gains, (2 or more, N). damping: in units of the mean |x|.
    """

def step(B: Gains, u: Singles, bend: Floats, h: Singles, held: Flags, D: Singles, v: Singles, d: Singles, p: Floats, A: Floats, tile: Singles, V: Singles, y: Singles) -> None:
    """
    Write the step d, (2, N), for the gradient v, (2, N).

    u: phasors, (2, M). bend: the weight of what is across u, (M,). h, held, D: as of `movable`. p, A, tile, V, y: room,
    (2, M), (2M + 4, 2M + 4), as in `passes`, (2M rounded up to 4, 2 TILE), (2, M or more).
    """

def nearest(B: Gains, p: Complexes, free: Flags, mu: float, steps: int, enough: float, h: Singles, made: Floats, A: Floats, tile: Singles, V: Singles, W: Singles, held: Flags, found: Floats, finished: float) -> int:
    """
    Lower 1/2 ||p - B h||^2 + mu/2 ||h||^2 over |h_n| <= 1, from the gains h, (3, N), in place.

    made: B h, (2, M), of the gains given. enough: ||p - made|| / ||p|| to stop at. A: room, (2M + 4, 2M + 4). V: room,
    (2M rounded up to 4, 2 TILE). tile: as in `passes`. W, held: room, (7, N) and (N,). found: that error, the damping (1)
    and how many steps in a row did little (4), to go on with. finished: two steps that lower the cost by a smaller
    share are the last.
    Returns the number of steps, negative if more may help.
    """

def ascend(B: Gains, p: Complexes, D: Floats, mu: float, y: Complexes, h: Singles, made: Floats, tile: Singles, L: Singles, found: Floats, spent: object) -> int:
    """
    Solve p - D y - B h(B^H y) = 0 by Newton steps on the multipliers y, from those given; return the number of steps.

    B: (M, N) [Pa]. p: targets, (M,). D: 1 over the weights of the squared errors, (M,). y: (M,), in place. h, made, tile:
    as of `evaluate`; h is that of y in the end. L: room for the preconditioner, (2, K, K) with K = M rounded up to 2; of
    size 0 for none. found: whether ||F|| <= 0.005 ||p||; the dual's value; 1/2 sum_m |p - B h|_m^2 / D_m + mu/2 ||h||^2;
    the number of gains at their limit; ||F||; and the state of L, which later calls for the same B and D keep: 0 at
    first. spent: returns whether the time is up, asked after the first step and after some products of each.
    """

def start(t: Floats, phases: Floats, beside: Flags, scale: float, quiet: float, warm: Complexes, before: Floats, factor: float, p: Complexes, D: Floats, y: Complexes) -> None:
    """
    Write targets p, 1 over the weights D, and multipliers y to start from, (M,) each.

    t: amplitudes [Pa], phases: [rad], beside: whether a sample is silent, (M,). scale: factor on t. quiet: weight of silent
    samples. warm, before: earlier multipliers and phases, which turn together, (M,), or of size 0 for none. factor: on
    these multipliers.
    """

def begin(G: Complexes, t: Floats, phi: Floats, start: Floats, steps: int, mu: float, relative: float, unit: float, N: int, p: Complexes, free: Flags, y: Complexes, L: Complexes, found: Floats) -> int:
    """
    Write targets p [Pa per unit limit], with phases chosen as by `choose`, and y = mu (G + mu I)^-1 p.

    G: (M, M); for few samples it is quicker to solve here than by LAPACK. t, phi, start: (M,). L: room, (M, M).
    found: by how much the targets are scaled, as by `within`.
    """

@overload
def adjoint(A: Gains, y: Complexes, x: Complexes) -> None: ...

@overload
def adjoint(A: Complexes, y: Complexes, x: Complexes) -> None:
    """Write x = A^H y, (N,), for A, (R, N), and y, (R,)."""

@overload
def forward(A: Gains, h: Complexes, made: Complexes) -> None: ...

@overload
def forward(A: Complexes, h: Complexes, made: Complexes) -> None:
    """Write made = A h, (R,), for A, (R, N), and h, (N,)."""

@overload
def columns(A: Gains, x: Complexes, slope: Floats, across: bool, out: Singles) -> int: ...

@overload
def columns(A: Gains, x: Complexes, slope: Floats, across: bool, out: Floats) -> int: ...

@overload
def columns(A: Complexes, x: Complexes, slope: Floats, across: bool, out: Floats) -> int:
    """
    Write the columns of A, (R, N), turned along x_n (or across it), times sqrt(slope_n); return how many.

    out: room for (2R, N), flat; written as (2R, count), real parts above imaginary parts. Columns of slope 0 are left out,
    or where they are few, written as 0.
    """

def clip(x: Complexes, weight: Floats, extra: float, limit: Floats, h: Complexes) -> float:
    """
    Write h(x) for weights `weight` + `extra`; return the sum of max Re(x^* h) - weight |h|^2 / 2. All (N,).
    """

def lift(x: Complexes, weight: Floats, limit: Floats, power: float) -> float:
    """
    The least nu >= 0 that keeps ||h(x)||^2 <= power when added to the weights.

    Newton steps on 1 / ||h||, which is linear in nu while nothing is held, inside a bracket.
    """

def slopes(x: Complexes, g: Complexes, weight: Floats, extra: float, limit: Floats, radial: Floats, tangential: Floats) -> int:
    """
    Write how fast h follows x along it and across it; return how many are held at their limit. All (N,).

    Those held do not follow along x, strictly. But where the last step expected h to be, at g, says how far that can be
    trusted: their slope along x fades out as g comes to lie along x (Chan, Golub and Mulet 1999; Hintermueller and
    Stadler 2006). This keeps steps from overshooting.
    """

def expect(x: Complexes, dx: Complexes, h: Complexes, radial: Floats, tangential: Floats, limit: Floats, shrink: float, g: Complexes) -> None:
    """
    Write g, what h is expected to be after a step dx; those not held shrink by a share besides. All (N,).
    """

def judge(p: Complexes, made: Complexes, limit: Floats, slack: Floats, s: float, r: Complexes, found: Floats) -> None:
    """
    Write r = s p - made, (M,), and to `found` how far it is over a limit at most, and the rest's sum of squares.

    Exact ones, of limit 0, may be s times as inexact.
    """

def real(G: Complexes, scale: float, S: Floats) -> None:
    """Write scale G, (R, R), as a real matrix, (2R, 2R), transposed."""

def add_blocks(y: Complexes, radial: Floats, tangential: Floats, ridge: float, S: Floats) -> None:
    """
    Add one 2 x 2 matrix for each y, (R,), to S, (2R, 2R), transposed: slopes along and across it, and `ridge`.
    """
