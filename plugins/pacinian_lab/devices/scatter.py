"""Compute the effect of scatter in strengths and phases by formula and on random arrays, and what a scan corrects.

Run: `python -m pacinian_lab.devices.scatter [PICTURE.png]`. Double precision; solver `lagrange`.

Responses s = (1 + e) exp(j f) are independent; e has mean 0 and standard deviation A, and f is normal with standard
deviation F [rad]. Then E s = exp(-F^2 / 2) and V = var s = 1 + A^2 - exp(-F^2), and at a point with p = sum_n b_n,
b_n = B_n g_n,

    E|p'|^2 = exp(-F^2) |p|^2 + V Q,    Q = sum_n |b_n|^2
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click
import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array, autd
from pacinian.acoustics.propagation import matrix
from pacinian.devices.scan_fit import fit_scan
from pacinian.errors import ArgumentError
from pacinian.session import solve

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

ARRAYS = {"one unit": (autd(), 0.2), "nine units": (autd(3, 3), 0.3)}  # array, height [m]
CASES = ((5, 5), (10, 5), (20, 10), (30, 10), (45, 20))  # [deg], [%]
RUNS = 200
SIDE, SPACING = 0.03, 0.005  # [m], of a square region
BESIDE = 0.06  # [m] from the focus to the point where the ideal field is 0
SCANS = (
    *((6, 0.01, 0.0), (6, 0.03, 1e-3), (12, 0.03, 0.0), (12, 0.03, 1e-3), (12, 0.1, 1e-3)),
    *((24, 0.03, 1e-3), (24, 0.1, 1e-3), (12, 0.03, 2e-3)),
)  # positions; noise, relative to the rms reading; error of each coordinate [m]


def draw_responses(
    count: int, degrees: float, percent: float, rng: np.random.Generator
) -> Complexes:
    """Draw responses of `count` transducers, with a scatter of phases [deg] and of strengths [%]."""
    strength = 1.0 + 0.01 * percent * rng.normal(size=count)
    return np.asarray(strength * np.exp(1j * np.radians(degrees) * rng.normal(size=count)))


def predict_power(b: Complexes, degrees: float, percent: float) -> Floats:
    """Return E|p'|^2 by the formula, (M,), for B g per transducer, (M, N)."""
    kept = float(np.exp(-(np.radians(degrees) ** 2)))
    V = 1.0 + (0.01 * percent) ** 2 - kept
    power = kept * np.abs(b.sum(axis=1)) ** 2 + V * (np.abs(b) ** 2).sum(axis=1)
    return np.asarray(power, np.float64)


def predict_unevenness(b: Complexes, degrees: float, percent: float) -> float:
    """Return the relative rms error of |p'|^2 over points, scaled to the ideal's mean; b: (M, N).

    The variance of |p'|^2 is (E|p'|^2)^2 - (exp(-F^2) |p|^2)^2 if the scattered sound has uniform phase (Rician).
    """
    ideal, power = np.abs(b.sum(axis=1)) ** 2, predict_power(b, degrees, percent)
    variance = power**2 - (np.exp(-(np.radians(degrees) ** 2)) * ideal) ** 2
    scale = ideal.mean() / power.mean()
    return float(
        np.sqrt(np.mean(scale**2 * variance + (scale * power - ideal) ** 2)) / ideal.mean()
    )


def make_problems(array: Array, height: float) -> dict[str, Complexes]:
    """Return B g per transducer at a focus, at a silent point beside it, and at the points of a square."""
    q = np.array([[0.0, 0.0, height], [BESIDE, 0.0, height]])
    B = matrix(array, q, Air())
    g = np.exp(-1j * np.angle(B[0]))
    g -= B[1].conj() * (B[1] @ g) / np.vdot(B[1], B[1])
    x = np.arange(-SIDE / 2, SIDE / 2 + 1e-9, SPACING)
    square = np.stack(np.meshgrid(x, x, [height], indexing="ij"), axis=-1).reshape(-1, 3)
    R = matrix(array, square, Air())
    t = np.full(len(square), 0.02 * float(np.abs(R).sum(axis=1).mean()))
    gains = solve(array, square, t, solver="lagrange").gains.astype(np.complex128)
    return {"focus": (B * g)[:1], "beside": (B * g)[1:], "square": R * gains}


def measure_scatter(
    b: Complexes, degrees: float, percent: float, runs: int = RUNS
) -> tuple[Floats, float]:
    """Simulate random arrays: mean of |p'|^2, (M,), and relative rms error over points, scaled to the ideal's mean."""
    rng = np.random.default_rng(1)
    ideal = np.abs(b.sum(axis=1)) ** 2
    drawn = [draw_responses(b.shape[1], degrees, percent, rng) for _ in range(runs)]
    power = np.abs(b @ np.array(drawn).T) ** 2  # (M, runs)
    scaled = power * (ideal.mean() / np.maximum(power.mean(axis=0), 1e-300))
    error = np.sqrt(np.mean((scaled - ideal[:, None]) ** 2)) / ideal.mean()
    return np.asarray(power.mean(axis=1)), float(error)


def measure_scan(
    array: Array, height: float, scan: tuple[int, float, float], seed: int
) -> tuple[float, float, float]:
    """Simulate a scan: errors of the corrections [deg], [%], and |p|^2 of a focus over the ideal; NaN if refused."""
    positions, noise, error = scan
    rng = np.random.default_rng(seed)
    N, width = len(array), np.ptp(array.positions, axis=0)[:2] / 2.0
    s = draw_responses(N, 20.0, 10.0, rng)
    low, high = (*-width, height), (*width, 2.0 * height)
    q = rng.uniform(low, high, (positions, 3))
    air = Air(temperature=rng.uniform(15.0, 30.0), attenuation="absorbing")
    X = matrix(array, q, air) * s
    X += noise * np.sqrt(np.mean(np.abs(X) ** 2) / 2.0) * (rng.normal(size=(*X.shape, 2)) @ [1, 1j])
    try:
        fit = fit_scan(array, q + error * rng.normal(size=q.shape), X)
    except ArgumentError:
        return np.nan, np.nan, np.nan
    z = fit.responses / s
    z /= z.mean()
    b = matrix(array, [[0.02, 0.01, height]], air)[0] * s
    p = (b * np.exp(-1j * np.angle(b / s * fit.responses))).sum()
    kept = np.abs(p) ** 2 / np.abs(b).sum() ** 2
    return float(np.degrees(np.std(np.angle(z)))), float(100.0 * np.std(np.abs(z))), float(kept)


def draw(path: str, problems: dict[str, dict[str, Complexes]]) -> None:
    """Draw the effect of phase scatter, by the formula (lines) and on random arrays (dots)."""
    from pacinian.plot.page import figure, save
    from pacinian.plot.style import BLUE, RED, dress

    page = figure(7.0, 2.4)
    panels = page.subplots(1, 3)
    lines, dots = np.linspace(1.0, 60.0, 60), np.arange(5.0, 61.0, 5.0)
    for (name, parts), colour in zip(problems.items(), (BLUE, RED), strict=True):
        loudest = np.abs(parts["focus"].sum()) ** 2
        for panel, part in zip(panels, ("focus", "square", "beside"), strict=True):
            b = parts[part]
            drawn = [measure_scatter(b, d, 10.0) for d in dots]
            for x, style, y in (
                (
                    lines,
                    "-",
                    [(predict_power(b, d, 10.0), predict_unevenness(b, d, 10.0)) for d in lines],
                ),
                (dots, "o", drawn),
            ):
                power, uneven = np.array([(one[0][0], one[1]) for one in y]).T
                shown = {
                    "focus": power / loudest,
                    "square": 100.0 * uneven,
                    "beside": 10.0 * np.log10(power / loudest),
                }[part]
                label = name if style == "-" else None
                panel.plot(x, shown, style, color=colour, ms=2.5, label=label)
    for panel, title in zip(
        panels,
        (
            "radiation pressure of a focus",
            "rms error in a square [%]",
            "in a silent point [dB re focus]",
        ),
        strict=True,
    ):
        panel.set(title=title, xlabel="scatter of phases [deg]")
    panels[0].set_ylim(0.0, 1.05)
    panels[0].legend()
    save(dress(page), path)


def main() -> None:
    """Print Markdown tables; draw the picture if a file is named."""
    problems = {name: make_problems(*where) for name, where in ARRAYS.items()}
    click.echo(
        "| scatter | " + " | ".join(f"{n}: focus | square | silent point" for n in ARRAYS) + " |"
    )
    click.echo("|---|" + "---|" * 6)
    for degrees, percent in CASES:
        cells: list[str] = []
        for parts in problems.values():
            loudest = np.abs(parts["focus"].sum()) ** 2
            for part, b in parts.items():
                power, error = measure_scatter(b, degrees, percent)
                predicted = predict_power(b, degrees, percent)
                if part == "square":
                    uneven = predict_unevenness(b, degrees, percent)
                    cells.append(f"{100 * uneven:.1f}, {100 * error:.1f} %")
                elif part == "beside":
                    decibels = 10.0 * np.log10(np.array([predicted[0], power[0]]) / loudest)
                    cells.append(f"{decibels[0]:.1f}, {decibels[1]:.1f} dB")
                else:
                    cells.append(f"{predicted[0] / loudest:.4f}, {power[0] / loudest:.4f}")
        order = [cells[i] for i in (0, 2, 1, 3, 5, 4)]
        click.echo(f"| {degrees} deg, {percent} % | " + " | ".join(order) + " |")
    click.echo(
        "\n| scan | " + " | ".join(f"{n}: corrections | focus | refused" for n in ARRAYS) + " |"
    )
    click.echo("|---|" + "---|" * 6)
    for case in SCANS:
        cells = []
        for name, where in ARRAYS.items():
            runs = np.array(
                [measure_scan(*where, case, s) for s in range(20 if "one" in name else 5)]
            )
            kept = runs[~np.isnan(runs[:, 0])]
            if len(kept):
                degrees, percent, focus = np.median(kept, axis=0)
                texts = (
                    f"{degrees:.1f} deg, {percent:.1f} %",
                    f"{focus:.4f}, {kept[:, 2].min():.4f}",
                )
            else:
                texts = "-", "-"
            cells += [*texts, f"{len(runs) - len(kept)} of {len(runs)}"]
        scan = f"{case[0]} positions, noise {100 * case[1]:g} %, {1e3 * case[2]:g} mm"
        click.echo(f"| {scan} | " + " | ".join(cells) + " |")
    if len(sys.argv) > 1:
        draw(sys.argv[1], problems)


if __name__ == "__main__":
    main()
