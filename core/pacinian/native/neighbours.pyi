# Made by `python native_build.py --stubs`.
from pacinian.types import Flags, Floats, Longs


def find_nearest(points: Floats, queries: Floats, distance: Floats, which: Longs) -> None:
    """
    Write for each of `queries`, (Q, 3) [m], which of `points`, (K, 3) [m], is nearest, of several the first, and its
    distance, both (Q,). All are finite.
    """

def thin(points: Floats, order: Longs, radius: float, kept: Flags) -> None:
    """
    Write which of `points`, (K, 3) [m], are kept, (K,): in `order`, (K,), those farther than `radius` [m] from all kept
    before. All are finite.
    """
