"""What notebooks show of objects: whole, quick, and never an error."""

import sys
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.notebook import MAX_ROWS, Card, card
from pacinian.scene.sampling.samples import no_samples
from pacinian.wire.state import State

ARRAY = pc.autd()
POINTS = np.array([[0.02, 0.0, 0.15], [-0.02, 0.0, 0.15]])
LIMITED = pc.Limits(quiet=([[0.0, 0.05, 0.15]], 1.0))
EVIL = "<script>alert('x')</script>&"
BALL = pc.Volume(
    shape=pc.Sphere(0.02), pose=pc.Pose((0.0, 0.0, 0.14)), radiation_pressure=5.0, name=EVIL
)
HAND = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.165)))
LOST = pc.Hand(np.full((26, 3), np.nan), side="left")


class Tree(HTMLParser):
    """Checks that what is opened is closed; text and tags apart."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.text = ""
        self.feed(html)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        self.tags.append(tag)
        if tag != "img":
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data + " "


def felt(scene: pc.Scene) -> pc.Samples:
    sampler = pc.Sampler()
    sampler.prepare(ARRAY, pc.Air())
    return sampler.sample(scene)


def report() -> pc.Report:
    made = pc.Report()
    for k in range(100):
        made.count_tick(1e-5 * k, late=k == 7)
    error = ValueError(EVIL)
    made.count_fault(pc.Fault(3, "solve", f"ValueError: {EVIL}", error))
    made.skipped["solve, nothing moved"] = 5
    return made


def recording(folder: Path) -> pc.Recording:
    recorder = pc.Recorder(folder / "a<b>.rec")
    recorder.begin(ARRAY, pc.Capability(), {"rate": 1000.0, "medium": {}})
    recorder.close()
    return pc.Recording(folder / "a<b>.rec")


STATE = State(
    sequence=4, time=1.0, output="silent", armed=False, owner="", scene="", solver=EVIL, backend="simulated",
    technique="", intensity=1.0, points=bytes(12), asked=bytes(4), hands=bytes(312),
    cause="not armed", why=f"not armed: {EVIL}",
)  # fmt: skip
FULL: dict[str, tuple[Any, list[str], bool]] = {
    "array": (ARRAY, ["249 transducers", "40 kHz"], True),
    "solution": (pc.solve(ARRAY, POINTS, [300.0, 200.0]), ["the targets are met", "error"], True),
    "limits": (pc.solve(ARRAY, POINTS, [3e3, 2e3], limits=LIMITED), ["limit", "proof"], True),
    "scene": (pc.Scene((BALL,), hands=(HAND, LOST)), [EVIL, "volume", "left (lost)"], True),
    "samples": (felt(pc.Scene((BALL,), hands=(HAND,))), ["samples", "mN"], True),
    "report": (report(), ["100 ticks", EVIL, "1 (1.0%)", "work saved 5 times"], True),
    "state": (STATE, ["State 4", "silent", f"not armed: {EVIL}"], False),
    "plugins": (pc.Plugins(), ["lagrange", "simulated", "pacinian"], False),
    "no points": (pc.solve(ARRAY, np.empty((0, 3)), []), ["silent"], False),
    "no objects": (pc.Scene(), ["0 objects"], False),
    "no samples": (no_samples(), ["0 samples"], False),
    "no ticks": (pc.Report(), ["0 ticks"], False),
    "one": (pc.Array([[0.0, 0.0, 0.0]]), ["1 transducers"], True),
}


@pytest.mark.parametrize("name", FULL)
def test_each_says_what_it_is(name: str) -> None:
    thing, words, drawn = FULL[name]
    tree = Tree(type(thing)._repr_html_.__wrapped__(thing).html())
    for word in words:
        assert word in tree.text
    assert ("img" in tree.tags) is drawn
    assert "script" not in tree.tags


def test_a_recording_is_not_read_through(tmp_path: Path) -> None:
    made = recording(tmp_path)
    assert "a<b>.rec" in Tree(made._repr_html_() or "").text
    made.path.unlink()
    assert made._repr_html_() is None  # and then its plain text is shown


def test_plain_text_is_as_before() -> None:
    assert repr(ARRAY).startswith("<Array of 249 transducers")
    assert repr(FULL["solution"][0]).startswith("<Solution by ")


def test_what_goes_wrong_is_no_error() -> None:
    class Broken:
        @card
        def _repr_html_(self) -> Card:
            raise RuntimeError("broken")

    assert Broken()._repr_html_() is None
    wrong = Card("a", {}, draw=lambda panel: panel.nothing())
    assert card(lambda self: wrong)(None) is None


def test_without_matplotlib_there_is_no_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    tree = Tree(ARRAY._repr_html_() or "")
    assert "249 transducers" in tree.text
    assert "img" not in tree.tags


def test_long_tables_are_cut() -> None:
    objects = tuple(
        pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=1.0, name=f"p{k}")
        for k in range(1000)
    )
    html = pc.Scene(objects)._repr_html_() or ""
    tree = Tree(html)
    assert f"p{MAX_ROWS - 1}" in tree.text
    assert f"p{MAX_ROWS}" not in tree.text
    assert f"and {1000 - MAX_ROWS} more" in tree.text
    assert len(html) < 100_000


def test_large_arrays_are_thinned() -> None:
    assert len(pc.lattice(2.0, 2.0)._repr_html_() or "") < 100_000


def test_a_plug_in_that_does_not_load_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    from importlib.metadata import EntryPoint

    tree = Tree(
        pc.Plugins([EntryPoint("gone", "not_there_at_all", "pacinian")])._repr_html_() or ""
    )
    assert "not_there_at_all" in tree.text
