# Made by `python native_build.py --stubs`.
from pacinian.types import Floats, Gains, Longs, Singles


def matrix(q: Singles, r: Singles, n: Singles, law: Singles, table: Singles, rows: Longs, out: Gains, touches: Singles) -> float:
    """
    Write rows of B [Pa], (N,) each, for points q [m], (K, 3), to the rows of `out`, (M, N).

    touches: how many transducers each point lies on, (K,). Returns their sum.
    """

def field(q: Singles, r: Singles, n: Singles, law: Singles, table: Singles, g: Singles, out: Gains, touches: Singles) -> None:
    """
    Write p = B g [Pa], (M,), without building B. g: real and imaginary parts, (2, N).
    """

def weigh(points: Floats, normals: Floats, capsules: Floats, edge: float, origin: Floats, r: Singles, boxes: Singles, rows: Longs, out: Gains) -> None:
    """
    Multiply rows of B, `out`, (M, N), by the weights of samples at `points`, (K, 3) [m], for rows (K,).

    normals: (M, 3). capsules: (C, 8). edge: [m]. origin: of r, the transducers' positions (3, N) [m]. boxes: around
    equal tiles of them, (tiles, 6).
    """

def spread(q: Floats, n: Floats, r: Floats, B: Gains, uniform: bool, mean: Floats, covariance: Floats) -> None:
    """
    Write the mean, (M, 3), and the covariance, (M, 3, 3), of the unit vectors from points to transducers.

    q: points, (M, 3) [m]. n: normals there, zero where sound counts from every side, (M, 3). r: transducers, (N, 3) [m].
    B: (M, N). uniform: whether the weights are |B| times the cosine of the incidence; else that squared.
    """
