# Made by `python native_build.py --stubs`.
from pacinian.types import Complexes, Flags, Floats, Singles


def iterate(B: Singles, t: Floats, free: Flags, exponent: float, floor: float, steps: int, w: Floats, u: Complexes, h: Singles, p: Complexes) -> float:
    """
    Back and forth `steps` times; return the floor.

    One step: x = B^H (w t u), h = x / max(|x|, floor), p = B h, then u = p / |p| where `free`, and
    w <- w (mean of |p| / t : |p| / t)^exponent.
    B: (2, M, N), h: (2, N), real and imaginary parts. t: (M,), 0 where nothing is asked. w, u, p: (M,).
    floor: above 1e-18 it is moved so that p comes to the strength of t.
    """
