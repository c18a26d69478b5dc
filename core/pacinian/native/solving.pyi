# Made by `python native_build.py --stubs`.
from typing import overload

from pacinian.types import Complexes, Flags, Floats, Gains, Longs, Singles


def gram(B: Gains, start: int, stop: int, scratch: Singles, out: Complexes) -> None:
    """
    Write B B^H, (M, M), exactly Hermitian, of the columns start..stop.

    Sums over a tile are single, over tiles double. scratch: (2, M + M % 2, tile). Rows are taken two by two, so that
    each number loaded is used twice: 2 times as fast as BLAS for M = 16 to 24, and no slower to M = 128.
    """

def gerchberg_saxton(G: Complexes, free: Flags, steps: int, p: Complexes) -> None:
    """
    Repeat p <- |p| exp(j arg(G p)) in place where `free`, (M,); a point that nothing reaches stays.
    """

@overload
def power(g: Gains) -> float: ...

@overload
def power(g: Complexes) -> float:
    """
    ||g||^2 of gains (N,), summed in double precision: squares of small gains vanish in single.
    """

@overload
def count_at_limit(g: Gains, limit: float) -> int: ...

@overload
def count_at_limit(g: Complexes, limit: float) -> int:
    """The number of gains, (N,), with |g_n| >= limit."""

@overload
def powers(B: Gains, out: Floats) -> None: ...

@overload
def powers(B: Complexes, out: Floats) -> None:
    """
    Write sum_n |B_mn|^2 of each row, (M,); summed in B's precision for 64 columns at most.
    """

@overload
def limit_gains(g: Gains, factor: float, highest: float) -> None: ...

@overload
def limit_gains(g: Complexes, factor: float, highest: float) -> None:
    """
    Multiply gains (N,) by `factor` in place; then shorten those above `highest` to it.
    """

def moved(points: Floats, before: Floats, rows: Longs) -> int:
    """
    Write the indices of the rows in which points and `before`, (M, 3), differ, to `rows`, (M,); return how many.
    """

def changed(points: Floats, before: Floats, normals: Floats, normals_before: Floats, capsules: Floats, capsules_before: Floats, rows: Longs) -> int:
    """
    Like `moved`, with the rows added whose weights by `SkinFacing` may differ; see `SkinFacing.find_changed`.

    normals, normals_before: (M, 3). capsules, capsules_before: (C, 8) [m], any numbers of them.
    """

TILE: int = 256

def adjoint_planar(B: Gains, y: Singles, x: Singles, tile: Singles) -> None:
    """Write x = B^H y, (2, N)."""

def apply_planar(B: Gains, g: Singles, p: Floats, tile: Singles) -> None:
    """Write p = B g, (2, M), for gains (2 or more, N)."""

def apply(B: Gains, g: Gains, p: Complexes) -> None:
    """Write p = B g, (M,), for gains (N,)."""

def adjoint(B: Gains, y: Complexes, x: Gains) -> None:
    """Write x = B^H y, (N,), for y of shape (M,)."""

def converge(q: Floats, P: Floats, some: Floats, centre: Floats, k: float, least: float, tilt: float, phases: Floats) -> None:
    """
    Write the phases [rad] of a region's points, (M,): see `joint_phases`.

    q: (M, 3) [m]. P: radiation pressures, (M,) [Pa]. some: transducers that stand for all, (V, 3) [m], and the centre
    of all, (3,). k: wavenumber [1/m]. least: d'/d at least. tilt: by how much the point f is moved aside, over the
    array's radius times d'/d.
    """

@overload
def sum_group_rows(B: Gains, p: Complexes, group: Longs, rows: Gains) -> None: ...

@overload
def sum_group_rows(B: Complexes, p: Complexes, group: Longs, rows: Complexes) -> None:
    """
    Write p_g^H B_g for the samples of each group g, (R, N).

    B: (M, N). p, group: of each sample, (M,).
    """

def number(regions: Longs, out: Longs) -> int:
    """
    Write the regions, (M,), renumbered from 0; return 1 if any sample is not isolated, else 0, and -1 for a wrong number.
    """

def waves(q: Floats, t: Floats, regions: Longs, some: Floats, centre: Floats, k: float, least: float, tilt: float, phases: Floats) -> None:
    """
    Write the phases [rad] of the regions' points, (M,), as `converge` does for each region; 0 for all other points.

    q: (M, 3) [m]. t: amplitudes, (M,) [Pa]. regions: numbered from 0, (M,). Others: as for `converge`.
    """

def combine_regions(t: Floats, given: Floats, regions: Longs, wave: Floats, start: Floats, warm: bool, norm: float, group: Longs, phi: Floats, p: Complexes, z: Complexes) -> int:
    """
    Write the group of each sample, (M,), the samples of which share one free phase; return the number of groups.

    Samples with given phases are group 0, if there are any; then come the regions, then each isolated sample. t, given,
    regions: of each sample, (M,); given: NaN where free [rad]. wave: see `waves`. start: phases that the groups start
    from, (M,); for regions only if `warm`. norm: of t. phi: phases within the groups, (M,). p: t / norm with these
    phases, (M,), written if there are several groups. z: phase factor of each group, (M + 1,).
    """

def rotate_phases(given: Floats, group: Longs, z: Complexes, phi: Floats) -> None:
    """
    Add the phase of its group's factor z to each free phase phi, (M,) [rad]; see `combine_regions`.
    """

def carry_multipliers(q: Floats, now: Longs, before: Floats, were: Longs, asked: Floats, multipliers: Complexes, made: Complexes, near: float, still: float, phases: Floats, y: Complexes) -> int:
    """
    Write the phases, (M,) [rad], and multipliers y, (M,), that points take over from earlier points of their kind.

    Kinds are: in a region, isolated, beside regions. The multiplier is that of the same point, the phase is that of the
    same or the nearest point; without one, they are 0 and the phase of the pressure `made`, (M,). The same point is where
    a point was if its whole region has moved alike, within `still` [m]. near: distance from which on there is no nearest
    point [m]. q, now: points, (M, 3) [m], and their regions. before, were, asked, multipliers: earlier points, (K, 3) [m],
    with their regions, phases [rad] and multipliers. Returns how many points have a multiplier.
    """

def choose_phases(G: Complexes, t: Floats, phi: Floats, start: Floats, steps: int, p: Complexes, free: Flags) -> float:
    """
    Write targets p, (M,), with the phases phi, where NaN by Gerchberg-Saxton steps from `start`.

    G: (M, M). t: amplitudes, (M,). free: where a phase may be any, and counts, (M,). Returns ||t||.
    """

def furthest(q: Floats, origin: Floats, t: Floats) -> float:
    """
    The largest |q_m - origin|^2, (M, 3); NaN where a number is not finite, or t_m neither 0 nor 1e-30..1e30.
    """

def relative_error(p: Complexes, t: Floats, phi: Floats) -> float:
    """
    ||asked - p|| / ||t||; phases phi, (M,) [rad], are as p has them where NaN.
    """

@overload
def peak(g: Gains) -> float: ...

@overload
def peak(g: Complexes) -> float:
    """The largest |g_n|^2, or NaN where any is not finite."""
