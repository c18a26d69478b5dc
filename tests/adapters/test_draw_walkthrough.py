"""The walkthroughs of the pages for Unity and Unreal: their steps, and what the drawings say."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from matplotlib import pyplot as plt

from . import draw_walkthrough, tools

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.figure import Figure

PAGES = {
    "unity": tools.ADAPTERS / "unity" / "Documentation~" / "touch-a-ball.md",
    "unreal": tools.ADAPTERS / "unreal" / "docs" / "touch-a-ball.md",
}
STEPS = 8  # at most


@pytest.fixture(autouse=True)
def _no_figure_is_left() -> Iterator[None]:
    yield
    plt.close("all")


def texts(drawn: Figure) -> list[str]:
    return [text.get_text() for axes in drawn.axes for text in axes.texts]


@pytest.mark.parametrize("engine", PAGES)
def test_each_step_of_a_walkthrough_has_its_picture(engine: str) -> None:
    text = PAGES[engine].read_text(encoding="utf-8")
    told = text.split("## In pictures", 1)[1].split("\n## ", 1)[0]
    steps = re.split(r"^\d+\. ", told, flags=re.MULTILINE)[1:]
    assert 1 < len(steps) <= STEPS
    shown = [re.findall(rf"\]\((\S*/{engine}-walkthrough-\w+\.png)\)", step) for step in steps]
    assert all(len(pictures) == 1 for pictures in shown)
    pictures = {(PAGES[engine].parent / path).resolve() for (path,) in shown}
    assert pictures == set(
        (tools.ADAPTERS.parent / "docs/pictures").glob(f"{engine}-walkthrough-*.png")
    )


def test_the_menu_is_the_packages() -> None:
    said = texts(draw_walkthrough.draw_unity_menu())
    for name in ("Array", "Ball", "Hands", "Quiet Zone"):  # the menu's
        assert name in said
    for name in ("Haptic Array", "Haptic Ball", "Haptic Hands"):  # the objects that it makes
        assert name in said
    assert "      Mouse" in said


def test_inspectors_have_the_fields_and_defaults_of_the_sources() -> None:
    rows = {row.label: row for row in draw_walkthrough.read_unity_fields("HapticHand")}
    assert rows["Source"].value == "Tracker"
    assert rows["Mouse Reach"].value == "0.15"
    assert (rows["Predict Motion"].kind, rows["Predict Motion"].value) == ("check", "x")
    assert "Relative strength (8.0 of 20 Pa)" in texts(draw_walkthrough.draw_unity_inspector())


def test_details_hide_what_the_editor_hides() -> None:
    rows = {row.label: row for row in draw_walkthrough.read_unreal_fields("HapticEffectComponent")}
    assert rows["Radiation Pressure"].value == "8"
    assert rows["Technique"].kind == "fold"
    assert "Force" not in rows  # the strength is a pressure
    assert "Stiffness" not in rows  # advanced
    assert draw_walkthrough.read_unreal_fields("HapticHandComponent", Source="Mouse")[1].marked
