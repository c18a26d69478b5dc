"""The charts of a study."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from pacinian_lab.study import charts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

pytest.importorskip("matplotlib")


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """Return the figures that are drawn."""
    made: list[Figure] = []
    monkeypatch.setattr(charts, "save", lambda page, *_: made.append(page))
    return made


def row(layout: str, **values: float) -> dict[str, Any]:
    nothing = dict.fromkeys((*charts.MESSAGES, *charts.AGAINST), None)
    return {**nothing, "layout": layout, "layout.type": "lattice", "plane": "plane", **values}


@pytest.mark.parametrize(
    ("contrasts", "best"),
    [
        ((0.5, 0.4, 0.3), "best: a"),
        ((0.5, 0.5 * (1.0 + 0.1 * charts.TIE), 0.3), "best: a and b"),
        ((0.5, 0.5 * (1.0 + 10.0 * charts.TIE), 0.3), "best: b"),
        ((0.5, 0.5, 0.5), "best: a and 2 others"),
    ],
)
def test_layouts_that_tie_are_best_together(
    contrasts: tuple[float, ...], best: str, drawn: list[Figure]
) -> None:
    rows = [row(name, contrast=value) for name, value in zip("abc", contrasts, strict=True)]
    charts.measures(rows, Path())
    titles = [panel.get_title() for panel in drawn[0].get_axes()]
    assert f"{charts.MESSAGES['contrast']}\n{best}" in titles


def test_a_panel_without_values_says_so(drawn: list[Figure]) -> None:
    rows = [row("a", contrast=0.5, efficiency=0.5, aperture=0.1)]
    charts.measures(rows, Path())
    charts.trends(rows, Path())
    for page in drawn:
        for panel in page.get_axes():
            told = [text.get_text() for text in panel.texts]
            assert told == (
                [] if any(len(line.get_xdata()) for line in panel.lines) else ["no values"]
            )
