"""Run every example, and check its output and its picture."""

import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from pacinian.rendering import renderer
from pacinian.testing import ManualClock

ROOT = Path(__file__).parents[1]
SAYS = {
    "focus": "dB SPL",
    "control_points": "ok",
    "quiet_zone": "at the ear",
    "stm_circle": "30 mm across",
    "fingertip_wav": "on the fingertip",
    "texture": "by the ridge",
    "hand_session": " 0 differ",
    "custom_solver": "superposition",
    "temperature": "degrees wrong",
    "how_sure": "Pa at the focus",
    "own_array": "at the focus",
    "array_study": "sunflower",
}
UNSEEN = {"touch", "client"}  # test_readme.py runs the client, because it has a server


def test_all_are_run() -> None:
    assert {path.stem for path in (ROOT / "examples").glob("*.py")} == {*SAYS, *UNSEEN}


@pytest.mark.parametrize("name", SAYS)
def test_it_says_and_draws(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "it.png"
    monkeypatch.setattr(renderer, "SystemClock", ManualClock)  # so that no tick is missed
    monkeypatch.setattr("sys.argv", [name, str(picture)])
    runpy.run_path(str(ROOT / f"examples/{name}.py"))
    assert SAYS[name] in capsys.readouterr().out
    drawn, shown = coarse(picture), coarse(ROOT / f"docs/pictures/example-{name}.png")
    assert np.abs(drawn - shown).mean() < 0.04 * np.ptp(shown)


def coarse(picture: Path) -> np.ndarray[Any, Any]:
    """Return a picture's grey levels, coarse enough that fonts and single ticks do not matter."""
    with Image.open(picture) as found:
        return np.asarray(found.convert("L").resize((60, 40), Image.Resampling.BOX), np.float64)


def test_the_page_shows_them() -> None:
    page = (ROOT / "docs/examples.md").read_text()
    for name in SAYS:
        assert f"../examples/{name}.py" in page
        assert f"pictures/example-{name}.png" in page


def test_a_loop_of_ones_own(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(ROOT / "examples/touch.py"))
    out = capsys.readouterr().out
    ticks = int(re.match(r"(\d+) ticks", out)[1])  # type: ignore[index]
    missed = re.search(r"(\d+) missed ticks", out)
    assert ticks + (int(missed[1]) if missed else 0) == 2000
    assert " 0 faults" in out
    assert "too faint to feel" in out
