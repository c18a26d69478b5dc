"""The paper's figures, drawn without a display."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.plot.page import figure, require, save
from pacinian.plot.style import BLUE, GREY, MAP, RED
from pacinian_lab.paper import experiment, fourier
from pacinian_lab.paper.panels import colour_bar, draw_map, inner, layout, legend, score

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

    from pacinian.plot.style import Panel
    from pacinian.types import Floats
    from pacinian_lab.paper.experiment import Experiment
    from pacinian_lab.paper.focus import Focus, Width
    from pacinian_lab.paper.fourier import Comparison
    from pacinian_lab.paper.report import Report


require()  # before anything is computed


def draw(report: Report, folder: Path) -> list[Path]:
    """Draw all figures as PNG files in `folder` and return the files."""
    pages = {
        "experiment": of_experiment(report.experiment),
        "fourier": of_fourier(report.fourier),
        "focus": of_focus(report.focus, report.widths),
    }
    for name, page in pages.items():
        save(page, folder / f"{name}.png")
    return [folder / f"{name}.png" for name in pages]


def of_experiment(results: Experiment) -> Figure:
    """Draw figures 5 to 7: the four cases, and |p| of every pattern in each, on one scale."""
    rows, columns = len(experiment.PATTERNS), len(experiment.CASES)
    page = figure(10.8, 10.0)
    cells = page.add_gridspec(rows + 1, columns + 1, height_ratios=[1.3] + [1.0] * rows)
    legend(page.add_subplot(cells[0, 0]))
    for j, name in enumerate(experiment.CASES):
        layout(page.add_subplot(cells[0, j + 1], projection="3d"), name)
    top = max(outcome.maximum for outcome in results.outcomes.values())
    panels: list[Panel] = []
    for i, name in enumerate(experiment.PATTERNS):
        target = page.add_subplot(cells[i + 1, 0])
        draw_map(target, experiment.pattern(name), "1", top)
        target.set_ylabel(f"{name}\n\ny [mm]")
        panels.append(target)
        for j, case in enumerate(experiment.CASES):
            outcome = results.outcomes[name, case]
            panel = page.add_subplot(cells[i + 1, j + 1])
            draw_map(panel, outcome.amplitude, case[0], top)
            panel.set_title(score(outcome.correlation, outcome.maximum), fontsize=9)
            panels.append(panel)
    panels[0].set_title("target", fontsize=9)
    inner(panels[: -columns - 1])
    colour_bar(page, panels)
    return page


def of_fourier(comparisons: dict[tuple[str, str], Comparison]) -> Figure:
    """Draw the Fourier baseline next to the pseudo-inverse: case 1a, 1a at a larger distance, and 2a."""
    places = {"1a": "1a", "1a far": f"1a at {1e3 * fourier.FAR_HEIGHT:.0f} mm", "2a": "2a"}
    page = figure(13.2, 7.4)
    panels: Panel = page.subplots(len(experiment.PATTERNS), 1 + 2 * len(places))
    top = max(max(c.maximum, c.pseudo_inverse.maximum) for c in comparisons.values())
    for row, name in zip(panels, experiment.PATTERNS, strict=True):
        draw_map(row[0], experiment.pattern(name), "1", top)
        row[0].set_ylabel(f"{name}\n\ny [mm]")
        for j, place in enumerate(places):
            c = comparisons[name, place]
            for panel, o in ((row[1 + 2 * j], c), (row[2 + 2 * j], c.pseudo_inverse)):
                draw_map(panel, o.amplitude, place[0], top)
                panel.set_title(score(o.correlation, o.maximum), fontsize=9)
    panels[0, 0].set_title("target", fontsize=9)
    for j, place in enumerate(places.values()):
        for panel, method in (
            (panels[0, 1 + 2 * j], "Fourier"),
            (panels[0, 2 + 2 * j], "pseudo-inverse"),
        ):
            panel.set_title(f"{place}\n{method}\n{panel.get_title()}", fontsize=9)
    inner(panels[:-1].flat)
    colour_bar(page, list(panels.flat))
    return page


def of_focus(spot: Focus, widths: list[Width]) -> Figure:
    """Draw figure 3: radiation pressure around the focus, and its profiles with their widths."""
    page = figure(11.0, 4.4)
    plane: Panel
    plane, *profiles = page.subplots(1, 3, width_ratios=[1.25, 1.0, 1.0])
    s = np.linspace(-0.04, 0.04, 241)  # [m]
    X, Y = np.meshgrid(s, s)
    P = spot.radiation_pressure(X, Y)  # [Pa]
    image = plane.imshow(P, origin="lower", extent=(-40, 40, -40, 40), cmap=MAP, vmin=0.0)
    plane.set(xlabel="x [mm]", ylabel="y [mm]", title=f"focus at {1e3 * spot.distance:.0f} mm")
    page.colorbar(image, ax=plane, label="radiation pressure [Pa]", shrink=0.8)
    middle = len(s) // 2
    for panel, width, profile in zip(profiles, widths, (P[middle], P[:, middle]), strict=True):
        _profile(panel, width, s, profile)
    profiles[0].set_ylabel("radiation pressure [Pa]")
    return page


def _profile(panel: Panel, width: Width, s: Floats, P: Floats) -> None:
    panel.plot(1e3 * s, P, color=BLUE)
    half = 500.0 * width.half  # [mm]
    label = f"half: {2.0 * half:.1f} mm\n(integral {1e3 * width.half_integral:.1f} mm)"
    panel.plot([-half, half], [P.max() / 2.0] * 2, color=RED, marker="|", label=label)
    for value, style, name in (
        (width.minimum, "-", "minimum"),
        (width.minimum_integral, "--", "integral"),
        (width.formula, ":", "1.22 $\\lambda z$ / aperture"),
    ):
        for sign, text in ((-1.0, None), (1.0, f"{name}: {1e3 * value:.1f} mm")):
            x = [sign * 1e3 * value] * 2
            panel.plot(x, [0.0, P.max()], color=GREY, linestyle=style, linewidth=1, label=text)
    panel.set(xlim=(-40, 40), xlabel=f"{width.axis} [mm]")
    panel.set_ylim(0.0, 1.55 * P.max())
    panel.set_title(f"along {width.axis}, aperture {1e3 * width.aperture:.0f} mm")
    panel.legend(loc="upper center", fontsize=8, frameon=False)
