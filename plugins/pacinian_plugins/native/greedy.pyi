# Made by `python native_build.py --stubs`.
from pacinian.types import Longs, Singles


def choose(B: Singles, t: Singles, order: Longs, E: Singles, h: Singles, p: Singles) -> int:
    """
    Give each transducer of `order` the best of E, keeping p = B h; return how many have changed.

    The best has the least sum_m (|p_m + B_mn E_l| - t_m)^2, p being what the others make; the first of equals.
    B: (N, 2, M), E: (2, L), h: (2, N), p: (2, M): real and imaginary parts. t: (M,).
    """
