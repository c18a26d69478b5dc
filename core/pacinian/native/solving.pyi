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
def powers(B: Gains, out: Floats) -> None: ...

@overload
def powers(B: Complexes, out: Floats) -> None:
    """
    Write sum_n |B_mn|^2 of each row, (M,); summed in B's precision for 64 columns at most.
    """

@overload
def restrain(g: Gains, factor: float, highest: float) -> None: ...

@overload
def restrain(g: Complexes, factor: float, highest: float) -> None:
    """
    Multiply gains (N,) by `factor` in place; then shorten those above `highest` to it.
    """

TILE: int = 256

def spread(B: Gains, y: Singles, x: Singles, tile: Singles) -> None:
    """Write x = B^H y, (2, N)."""

def gather(B: Gains, g: Singles, p: Floats, tile: Singles) -> None:
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
def stand_for(B: Gains, p: Complexes, group: Longs, rows: Gains) -> None: ...

@overload
def stand_for(B: Complexes, p: Complexes, group: Longs, rows: Complexes) -> None:
    """
    Write p_g^H B_g for the samples of each group g, (R, N).

    B: (M, N). p, group: of each sample, (M,).
    """

def choose(G: Complexes, t: Floats, phi: Floats, start: Floats, steps: int, p: Complexes, free: Flags) -> float:
    """
    Write targets p, (M,), with the phases phi, where NaN by Gerchberg-Saxton steps from `start`.

    G: (M, M). t: amplitudes, (M,). free: where a phase may be any, and counts, (M,). Returns ||t||.
    """

def furthest(q: Floats, origin: Floats, t: Floats) -> float:
    """
    The largest |q_m - origin|^2, (M, 3); NaN where a number is not finite, or t_m neither 0 nor 1e-30..1e30.
    """

def miss(p: Complexes, t: Floats, phi: Floats) -> float:
    """
    ||asked - p|| / ||t||; phases phi, (M,) [rad], are as p has them where NaN.
    """

@overload
def peak(g: Gains) -> float: ...

@overload
def peak(g: Complexes) -> float:
    """The largest |g_n|^2, or NaN where any is not finite."""
