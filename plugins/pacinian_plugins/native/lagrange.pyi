# Made by `python native_build.py --stubs`.
from typing import overload

from pacinian.types import Complexes, Flags, Floats, Gains, Indices, Longs, Singles


class Workspace:
    """
    Memory for M samples and N transducers, reused from solve to solve, and what the kernels found.

    p: targets, (M,) [Pa per unit limit]. free: whether their phase is free, (M,). y: multipliers, (M,). h: real and
    imaginary part of the gains in units of the limit, and |x_n|, (3, N). made: real and imaginary part of B h, (2, M).
    tile: see fused_passes.hpp. error: ||targets - made|| / ||p||, where free phases are those made. cost: sum of c(x_n)
    at y. multiple: of |p| that is nearest to what full drive makes. stalled: dual steps in a row that did little.
    bound, objective: [Pa^2] for unit limits. held: transducers at their limit.
    """

    def __init__(self, M: int, N: int) -> None: ...

    @property
    def p(self, /) -> Complexes: ...

    @property
    def free(self, /) -> Flags: ...

    @property
    def y(self, /) -> Complexes: ...

    @property
    def h(self, /) -> Singles: ...

    @property
    def made(self, /) -> Floats: ...

    @property
    def tile(self, /) -> Singles: ...

    @property
    def cost(self) -> float: ...

    @cost.setter
    def cost(self, arg: float, /) -> None: ...

    @property
    def error(self) -> float: ...

    @property
    def multiple(self) -> float: ...

    @property
    def stalled(self) -> int: ...

    @property
    def bound(self) -> float: ...

    @property
    def objective(self) -> float: ...

    @property
    def held(self) -> int: ...

    def restart_dual(self) -> None:
        """Count the dual steps that did little from 0."""

    def restart_primal(self) -> None:
        """Start the primal steps with the default damping."""

class RegionWorkspace:
    """
    Memory for regions with M samples and N transducers, and what `solve_region` found.

    sizes: number of samples of each block of the preconditioner; empty for no preconditioner. stride: every so many
    transducers one is in it. order: the samples of the first block, then those of the next, (M,); the caller writes
    them. factor: of each block, real and imaginary part, (2, K, K), K = its size rounded up to 2. h, made: as in
    `Workspace`. met: whether the steps have converged. bound, objective: D(y), and
    1/2 sum_m |p - B h|_m^2 / D_m + mu/2 ||h||^2. held: gains at their limit.
    """

    def __init__(self, M: int, N: int, sizes: Longs, stride: int) -> None: ...

    @property
    def order(self, /) -> Indices: ...

    @property
    def h(self, /) -> Singles: ...

    @property
    def made(self, /) -> Floats: ...

    @property
    def factor(self, /) -> Singles: ...

    @property
    def met(self) -> bool: ...

    @property
    def held(self) -> int: ...

    @property
    def bound(self) -> float: ...

    @property
    def objective(self) -> float: ...

    def restart(self, same: bool) -> None:
        """
        Begin anew. same: whether to start with the last preconditioner, because the samples are the same or have moved alike.
        """

def scale_for_single(size: float, relative: float, mu: float, N: int) -> float:
    """
    Return the factor that scales targets of norm `size` [Pa per unit limit] into the range of single precision.

    Up to the lower bound, 2 sqrt(mu), nothing reaches its limit: ||g|| <= ||p|| / (2 sqrt(mu)). Beyond the upper one
    the answer hardly changes. relative: mu over trace(G) / M.
    """

def factor(A: Floats, K: int, positive: int) -> int:
    """
    Factor the lower triangle of A, (K, K) or more, in place: A = L S L^T, S = +1 then -1.

    The first `positive` pivots are to be positive, the others negative. One of the wrong sign, or that is rounding,
    becomes so large that its unknown is left at 0. Returns how many did.
    """

def rotate_gram(G: Complexes, sample: Longs, u: Singles, scale: float, A: Floats) -> None:
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
    phasor, (2, K). h: as of `evaluate`. Workspace: V, (K rounded up to 4, 2 TILE); which, (TILE,).
    """

def solve_dual(B: Gains, G: Complexes, mu: float, steps: int, enough: float, workspace: Workspace, unit: float, out: Gains) -> int:
    """
    Solve Re(conj(u_k) (B h(B^H y) + y)) = t_k by Newton steps on the multipliers y, then `certify` and `write_gains`.

    One equation per sample where its phase is `free`, along the phasor of the pressure made, two where it is fixed.
    G: B B^H, (M, M). mu: [Pa^2]. steps: at most. enough: ||F|| / ||p|| to stop at. workspace: has the targets p and the
    multipliers y to start from; the kernel writes y, h, made, error, cost and stalled. unit, out: as of `write_gains`.
    Returns the number of steps, negative if they came to nothing.
    """

def certify(mu: float, workspace: Workspace) -> None:
    """
    Write `bound`, D(y), `objective`, 1/2 ||p - made||^2 + mu/2 ||h||^2 for the phases made, and `held`.

    workspace: with p, free, y, h, made, and cost at y.
    """

def write_gains(h: Singles, unit: float, out: Gains) -> None:
    """
    Write the gains, (N,), of those in units of the limit, h, (2 or more, N).
    """

def equalise(B: Gains, steps: int, workspace: Workspace) -> int:
    """
    Make |B h| proportional to |p| with every |h_n| = 1, from the multipliers y, by weighted Gerchberg-Saxton steps.

    All targets are above 0 and their phases free (Di Leonardo et al., Opt. Express 15, 2007, here over-relaxed).
    workspace: has p and y; the kernel writes y, h, made and multiple.
    Returns the number of steps, negative if more may help.
    """

def project_gradient(h: Singles, mu: float, damping: float, x: Singles, held: Flags, D: Singles) -> None:
    """
    Turn x = B^H y, (2, N), into the gradient v along what can move; write what is held, and D, (N,).

    h: gains, (2 or more, N). damping: in units of the mean |x|.
    """

def newton_step(B: Gains, u: Singles, bend: Floats, h: Singles, held: Flags, D: Singles, v: Singles, d: Singles, p: Floats, A: Floats, tile: Singles, V: Singles, y: Singles) -> None:
    """
    Write the step d, (2, N), for the gradient v, (2, N).

    u: phasors, (2, M). bend: weight of the pressures across u, (M,). h, held, D: as of `project_gradient`. Workspace:
    p, (2, M); A, (2M + 4, 2M + 4); tile, as in fused_passes.hpp; V, (2M rounded up to 4, 2 TILE); y, (2, M or more).
    """

def solve_primal(B: Gains, mu: float, steps: int, enough: float, finished: float, workspace: Workspace) -> int:
    """
    Lower 1/2 ||p - B h||^2 + mu/2 ||h||^2 over |h_n| <= 1 by Newton steps from the gains h.

    enough: ||p - made|| / ||p|| to stop at. finished: two steps that lower the cost by a smaller share are the last.
    workspace: has the targets p, the gains h, and made, B h of these gains; the kernel writes h, made and error.
    Returns the number of steps, negative if more may help.
    """

def solve_region(B: Gains, p: Complexes, D: Floats, mu: float, y: Complexes, max_gap: float, workspace: RegionWorkspace, spent: object) -> int:
    """
    Solve p - D y - B h(B^H y) = 0 by Newton steps on the multipliers y, from those given; return the number of steps.

    B: (M, N) [Pa]. p: targets, (M,). D: 1 over the weights of the squared errors, (M,). y: (M,), in place. max_gap: largest
    duality gap of the given y, relative to that of none, to start from them. workspace: the kernel writes h of y, met,
    bound, objective and held; it keeps the preconditioner for later calls with similar B. If F is not small at the end, h
    is instead the best of all steps, weakened where that is better, so it is never worse than silence. spent: returns whether the time is up, asked after the first step and after some products of each.
    """

def start_region(t: Floats, phases: Floats, beside: Flags, scale: float, quiet: float, warm: Complexes, before: Floats, factor: float, p: Complexes, D: Floats, y: Complexes) -> None:
    """
    Write targets p, 1 over the weights D, and multipliers y to start from, (M,) each.

    t: amplitudes [Pa], phases: [rad], beside: whether a sample is silent, (M,). scale: factor on t. quiet: weight of silent
    samples. warm, before: earlier multipliers and phases, which turn together, (M,), or of size 0 for none. factor: on
    these multipliers.
    """

def find_loudest(points: Floats, regions: Longs, p: Complexes, made: Floats, near: float) -> float:
    """
    The highest pressure at silent samples, relative to the mean of the nearest region.

    points: (M, 3) [m]. regions: their numbers, (M,). p: targets, (M,). made: what is made, real and imaginary part, (2, M).
    near: samples nearer to a region do not count [m].
    """

MAX_START: int = 16

def start(G: Complexes, t: Floats, phi: Floats, first: Floats, steps: int, mu: float, relative: float, unit: float, workspace: Workspace) -> float:
    """
    Write targets p [Pa per unit limit], with phases chosen as by `choose_phases`, and y = mu (G + mu I)^-1 p.

    G: (M, M), for at most MAX_START samples, for which this is quicker than LAPACK. t, phi, first: (M,). Returns the
    factor on the targets, as by `scale_for_single`.
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

    out: workspace for (2R, N), flat; written as (2R, count), real parts above imaginary parts. Columns of slope 0 are left out,
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

def measure_excess(p: Complexes, made: Complexes, limit: Floats, slack: Floats, s: float, r: Complexes) -> tuple[float, float]:
    """
    Write r = s p - made, (M,); return the largest excess over a limit, and the sum of squares of the samples without one.

    Exact ones, of limit 0, may be s times as inexact.
    """

def real(G: Complexes, scale: float, S: Floats) -> None:
    """Write scale G, (R, R), as a real matrix, (2R, 2R), transposed."""

def add_blocks(y: Complexes, radial: Floats, tangential: Floats, ridge: float, S: Floats) -> None:
    """
    Add one 2 x 2 matrix for each y, (R,), to S, (2R, 2R), transposed: slopes along and across it, and `ridge`.
    """
