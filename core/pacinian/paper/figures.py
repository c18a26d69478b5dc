"""The paper's figures, drawn without a display."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.errors import MissingExtra
from pacinian.paper import experiment, fourier

try:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
except ImportError as error:
    raise MissingExtra("matplotlib", "plot") from error

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.paper.experiment import Experiment
    from pacinian.paper.focus import Focus, Width
    from pacinian.paper.fourier import Comparison
    from pacinian.types import Floats

Panel = Any  # Matplotlib's axes: its stubs leave too much open
BLUE, RED, GREY = "#0072b2", "#d55e00", "0.55"
MAP = "viridis"


def draw_experiment(results: Experiment, path: Path) -> None:
    """Figures 5 to 7: the four places, and |p| of every pattern in each, on one scale."""
    rows, columns = len(experiment.PATTERNS), len(experiment.CASES)
    figure = _figure(10.6, 11.2)
    cells = figure.add_gridspec(rows + 1, columns + 1, height_ratios=[1.25] + [1.0] * rows)
    for j, name in enumerate(experiment.CASES):
        _layout(figure.add_subplot(cells[0, j + 1], projection="3d"), name)
    top = max(outcome.maximum for outcome in results.outcomes.values())
    panels: list[Panel] = []
    for i, name in enumerate(experiment.PATTERNS):
        target = figure.add_subplot(cells[i + 1, 0])
        _map(target, experiment.pattern(name), "1", top)
        target.set_ylabel(f"{name}\n\ny [mm]")
        panels.append(target)
        for j, case in enumerate(experiment.CASES):
            outcome = results.outcomes[name, case]
            panel = figure.add_subplot(cells[i + 1, j + 1])
            _map(panel, outcome.amplitude, case[0], top)
            panel.set_title(_score(outcome.correlation, outcome.maximum), fontsize=9)
            panels.append(panel)
    panels[0].set_title("target", fontsize=9)
    for panel in panels[: -columns - 1]:
        panel.set_xlabel("")
    _colour_bar(figure, panels)
    _save(figure, path)


def draw_fourier(comparisons: dict[tuple[str, str], Comparison], path: Path) -> None:
    """The Fourier baseline beside the pseudo-inverse: 1a, the same further away, and 2a."""
    places = {"1a": "1a", "1a far": f"1a at {1e3 * fourier.FAR:.0f} mm", "2a": "2a"}
    figure = _figure(13.2, 8.2)
    panels: Panel = figure.subplots(len(experiment.PATTERNS), 1 + 2 * len(places))
    top = max(max(c.maximum, c.pseudo_inverse.maximum) for c in comparisons.values())
    for row, name in zip(panels, experiment.PATTERNS, strict=True):
        _map(row[0], experiment.pattern(name), "1", top)
        row[0].set_ylabel(f"{name}\n\ny [mm]")
        for j, place in enumerate(places):
            c = comparisons[name, place]
            ours = c.pseudo_inverse
            for panel, size, score in (
                (row[1 + 2 * j], c.amplitude, _score(c.correlation, c.maximum)),
                (row[2 + 2 * j], ours.amplitude, _score(ours.correlation, ours.maximum)),
            ):
                _map(panel, size, place[0], top)
                panel.set_title(score, fontsize=9)
    panels[0, 0].set_title("target", fontsize=9)
    for j, place in enumerate(places.values()):
        for panel, method in (
            (panels[0, 1 + 2 * j], "Fourier"),
            (panels[0, 2 + 2 * j], "pseudo-inverse"),
        ):
            panel.set_title(f"{place}, {method}\n{panel.get_title()}", fontsize=9)
    for panel in panels[:-1].flat:
        panel.set_xlabel("")
    _colour_bar(figure, list(panels.flat))
    _save(figure, path)


def draw_focus(spot: Focus, widths: list[Width], path: Path) -> None:
    """Figure 3: radiation pressure around the focus, and its profiles with their widths."""
    figure = _figure(11.0, 4.4)
    plane: Panel
    plane, *profiles = figure.subplots(1, 3, width_ratios=[1.25, 1.0, 1.0])
    s = np.linspace(-0.04, 0.04, 241)  # [m]
    X, Y = np.meshgrid(s, s)
    P = spot.radiation_pressure(X, Y)  # [Pa]
    image = plane.imshow(P, origin="lower", extent=(-40, 40, -40, 40), cmap=MAP, vmin=0.0)
    plane.set(xlabel="x [mm]", ylabel="y [mm]", title=f"focus at {1e3 * spot.distance:.0f} mm")
    figure.colorbar(image, ax=plane, label="radiation pressure [Pa]", shrink=0.8)
    middle = len(s) // 2
    for panel, width, profile in zip(profiles, widths, (P[middle], P[:, middle]), strict=True):
        _profile(panel, width, s, profile)
    profiles[0].set_ylabel("radiation pressure [Pa]")
    _save(figure, path)


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
            panel.axvline(sign * 1e3 * value, color=GREY, linestyle=style, linewidth=1, label=text)
    panel.set(xlim=(-40, 40), xlabel=f"{width.axis} [mm]")
    panel.set_ylim(0.0, 1.55 * P.max())
    panel.set_title(f"along {width.axis}, aperture {1e3 * width.aperture:.0f} mm")
    panel.legend(loc="upper center", fontsize=8, frameon=False)


def _layout(panel: Panel, name: str) -> None:
    place = experiment.case(name)
    for points, colour, size in ((place.points, RED, 0.4), (place.array.positions, BLUE, 0.8)):
        panel.scatter(*(1e3 * points.T), s=size, color=colour, linewidths=0, rasterized=True)
    panel.set(xlim=(-200, 200), ylim=(-200, 200), zlim=(0, 400))
    panel.set(xticks=(-200, 0, 200), yticks=(-200, 0, 200), zticks=(0, 200, 400))
    panel.set_box_aspect((1, 1, 1), zoom=0.92)
    panel.view_init(elev=22, azim=-55)
    panel.tick_params(labelsize=7, pad=-2)
    for axis in "xyz":
        getattr(panel, f"set_{axis}label")(f"{axis} [mm]", fontsize=8, labelpad=-6)
    panel.set_title(name, fontsize=12)


def _map(panel: Panel, amplitude: Floats, region: str, top: float) -> None:
    """|p| in region "1" (x, y) or "2" (y, z); the outer samples' squares reach 5 mm further."""
    low = (-205, -205) if region == "1" else (-205, -5)
    extent = (low[0], low[0] + 410, low[1], low[1] + 410)
    panel.imshow(amplitude, origin="lower", extent=extent, cmap=MAP, vmin=0.0, vmax=top)
    across, up = "xy" if region == "1" else "yz"
    panel.set(xlabel=f"{across} [mm]", ylabel=f"{up} [mm]", xticks=(-200, 0, 200))
    panel.set_yticks((-200, 0, 200) if region == "1" else (0, 200, 400))
    panel.tick_params(labelsize=8)
    panel.yaxis.labelpad = 0


def _score(correlation: float, maximum: float) -> str:
    return f"corr. {correlation:.2f}, max {maximum:.2f}"


def _figure(width: float, height: float) -> Any:
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _colour_bar(figure: Any, panels: list[Panel]) -> None:
    label = "|p| / target amplitude"
    figure.colorbar(panels[0].images[0], ax=panels, label=label, shrink=0.6, aspect=35, pad=0.01)


def _save(figure: Any, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=130)
