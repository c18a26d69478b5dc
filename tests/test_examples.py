"""Run every example, and check its output and its picture."""

import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import pacinian as pc
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
    "hand_session": " 0 frames differ",
    "custom_solver": "superposition",
    "temperature": "degrees wrong",
    "how_sure": "Pa at the focus",
    "gorkov": "times its weight",
    "own_array": "at the focus",
    "array_study": "sunflower",
}
LONG = {"hand_session", "stm_circle", "texture"}
UNSEEN = {"touch", "client"}  # test_documented_code.py runs the client, because it has a server


def test_all_are_run() -> None:
    assert {path.stem for path in (ROOT / "examples").glob("*.py")} == {*SAYS, *UNSEEN}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.deep] if name in LONG else []) for name in SAYS],
)
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


def test_the_force_on_a_bead_in_a_standing_wave_is_that_of_the_closed_form(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """F = 4 pi k a^3 E (f1 / 3 + f2 / 2) sin(2 k z), H. Bruus, Lab Chip 12, 1014 (2012), equation 8."""
    monkeypatch.setattr("sys.argv", ["gorkov", str(tmp_path / "it.png")])
    gorkov = runpy.run_path(str(ROOT / "examples/gorkov.py"))
    array, air, z = pc.Array([[0, 0, -4.0], [0, 0, 4.0]]), pc.Air(), np.linspace(-2e-3, 2e-3, 9)
    places = np.stack([0.0 * z, 0.0 * z, z], axis=1)
    k, rho, c, a = air.wavenumber(40_000.0), air.density, air.speed_of_sound, gorkov["RADIUS"]
    heavy, stiff = gorkov["DENSITY"] / rho, gorkov["DENSITY"] * gorkov["SPEED"] ** 2 / (rho * c**2)
    contrast = (1.0 - 1.0 / stiff) / 3.0 + (heavy - 1.0) / (2.0 * heavy + 1.0)
    E = (2.0 * array.transducer.pressure / 4.0) ** 2 / (4.0 * rho * c**2)
    exact = 4.0 * np.pi * k * a**3 * E * contrast * np.sin(2.0 * k * z)
    found = gorkov["force"](array, np.ones(2), places, air)[:, 2]
    np.testing.assert_allclose(found, exact, atol=1e-3 * np.abs(exact).max())


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
