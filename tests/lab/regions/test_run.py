"""`pacinian bench regions`: its shapes, figures, peers, costs and pictures."""

from __future__ import annotations

import json
import math
from contextlib import closing
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from click.testing import CliRunner

import pacinian as pc
from pacinian_lab.commands.bench import bench
from pacinian_lab.regions import contacts, cost, pictures, shapes
from pacinian_lab.regions.methods import FREE, OURS, SWEPT
from pacinian_lab.regions.peers import Peers
from pacinian_lab.regions.run import judge, make
from pacinian_lab.regions.score import evaluate_pressure, score
from pacinian_lab.regions.shapes import SHAPES
from pacinian_lab.solvers import peers as environments
from pacinian_lab.solvers.worker_process import Worker, WorkerError

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.types import Complexes, Floats

DISC = "disc, 30 mm"
OMNI = pc.Transducer(pressure=4.386)
FAR, NEAR = FREE


def press(positions: Floats, gains: Complexes, places: Floats) -> Floats:
    """Radiation pressure by the formulas, with other code: omnidirectional, 1/r, 40 kHz, 340 m/s, 1.2 kg/m^3."""
    r = np.linalg.norm(places[:, None] - positions, axis=2)
    p = (4.386 / r * np.exp(-2j * math.pi * 40_000.0 / 340.0 * r)) @ gains
    return np.asarray(2.0 * (np.abs(p) ** 2 / 2.0) / (1.2 * 340.0**2))


def invoke(*how: str) -> Any:
    return CliRunner().invoke(bench, ["regions", *how], catch_exceptions=False)


# ---------------------------------------------------------------------------- figures


def test_the_figures_are_those_of_a_small_example() -> None:
    found = score(np.array([4.0, 4.0, 1.0, 3.0]), np.array([4.0, 4.0, 4.0, 0.0]), np.array([6.0]))
    assert found.force == pytest.approx(12.0 / 12.0)
    assert found.rms == pytest.approx(math.sqrt((9.0 + 9.0) / 48.0))
    assert found.holes == pytest.approx(1.0 / 3.0)  # of the three places where anything is asked
    assert found.beside == pytest.approx(6.0 / 3.0)
    factors = np.linspace(0.0, 2.0, 20_001)[:, None]
    errors = factors * np.array([4.0, 4.0, 1.0, 3.0]) - np.array([4.0, 4.0, 4.0, 0.0])
    least = np.sqrt((errors**2).sum(axis=1).min() / 48.0)
    assert found.scaled_rms == pytest.approx(float(least), abs=1e-6)


def test_a_pressure_that_is_right_up_to_a_factor_has_no_scaled_rms() -> None:
    asked = np.linspace(1.0, 2.0, 9)
    found = score(0.3 * asked, asked, np.empty(0))
    assert found.scaled_rms == pytest.approx(0.0, abs=1e-7)
    assert found.rms == pytest.approx(0.7)
    assert found.holes == 1.0
    assert math.isnan(found.beside)
    silent = score(0.0 * asked, asked, np.empty(0))
    assert (silent.force, silent.rms, silent.scaled_rms) == (0.0, 1.0, 1.0)


def test_pressure_is_that_of_the_formulas_and_the_mean_over_frames() -> None:
    array, rng = pc.autd(transducer=OMNI), np.random.default_rng(1)
    gains = rng.normal(size=(2, 249)) + 1j * rng.normal(size=(2, 249))
    places = rng.uniform(-0.02, 0.02, (50, 3)) + np.array([0.0, 0.0, 0.2])
    each = np.stack([press(array.positions, g, places) for g in gains])
    assert evaluate_pressure(array, gains[0], places) == pytest.approx(each[0], rel=1e-3)
    assert evaluate_pressure(array, gains, places) == pytest.approx(each.mean(axis=0), rel=1e-3)


@pytest.mark.parametrize("name", [DISC, "letter H", "square, tilted by 30 degrees"])
def test_a_region_is_even_by_a_field_of_our_own_at_places_of_our_own(name: str) -> None:
    array, shape, rng = pc.autd(transducer=OMNI), SHAPES[name](), np.random.default_rng(7)
    made = make(array, shape, OURS, 1.0)
    near = rng.uniform(-2e-4, 2e-4, (len(shape.places), 1)) * [1.0, 0.0, 0.0]
    P = press(array.positions, made.gains, shape.places + near)
    assert P.mean() == pytest.approx(1.0, abs=0.06)
    assert math.sqrt(((P - 1.0) ** 2).mean()) < 0.15
    row = judge(array, shape, made, (name, OURS, 0.5, 1.0))
    assert row.rms == pytest.approx(math.sqrt(((P - 1.0) ** 2).mean()), abs=0.02)


# ---------------------------------------------------------------------------- shapes


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_is_measured_within_itself_and_beside(name: str) -> None:
    shape = SHAPES[name]()
    assert len(shape.places) == len(shape.asked) > 20
    assert shape.asked.min() >= 0.0
    assert 0.9 < shape.asked.max() <= 1.0
    samples = shape.samples(pc.autd())
    assert (samples.regions[samples.radiation_pressure > 0.0] >= 0).all()
    if len(shape.beside):
        away = np.sqrt(((shape.beside[:, None] - shape.places) ** 2).sum(axis=2)).min(axis=1)
        assert 0.0029 < away.min() <= away.max() < 0.0101
    assert shape.view.points.shape == (*shape.view.asked.shape, 3)
    assert 0.9 < shape.view.asked.max() <= 1.0


@pytest.mark.parametrize("name", SHAPES)
def test_a_view_asks_what_the_places_and_the_samples_ask(name: str) -> None:
    from scipy.spatial import KDTree

    shape = SHAPES[name]()
    away, nearest = KDTree(shape.view.points.reshape(-1, 3)).query(shape.places)
    seen = shape.view.asked.ravel()[nearest]
    flat = away < 2e-4  # of a volume few places lie in the view
    assert flat.sum() > 20
    assert (np.abs(seen - shape.asked)[flat] < 0.05).mean() > 0.9  # edges lie between its points
    samples = shape.samples(pc.autd(3, 3))
    # half a diagonal between places; a sample with several that differ lies on an edge
    near = KDTree(shape.places).query_ball_point(samples.positions, 7.1e-4)
    inner = [m for m, of in enumerate(near) if of and np.ptp(shape.asked[of]) < 0.05]
    assert len(inner) > 0.4 * len(samples)
    asked = np.array([shape.asked[near[m]].mean() for m in inner])
    assert (np.abs(samples.radiation_pressure[inner] - asked) < 0.1).mean() > 0.8


def test_gratings_and_ramps_ask_what_they_say() -> None:
    for period in (20, 10, 5):
        shape = SHAPES[f"grating, period {period} mm"]()
        phase = (1e3 * shape.places[:, 0]) % period
        assert set(shape.asked[phase < period / 2 - 0.01].tolist()) == {0.0}
        assert set(shape.asked[phase > period / 2 + 0.01].tolist()) == {1.0}
    ramp = SHAPES["ramp, 43 x 31 mm"]()
    assert ramp.asked == pytest.approx((ramp.places[:, 0] + 0.0215) / 0.043)
    samples = ramp.samples(pc.autd())
    assert samples.radiation_pressure == pytest.approx(
        (samples.positions[:, 0] + 0.0215) / 0.043, abs=1e-6
    )


def test_an_unrolled_ball_has_equal_areas_and_lies_on_the_ball() -> None:
    view = SHAPES["shell of a ball, radius 12 mm"]().view
    away = view.points - np.array([0.0, 0.0, 0.2])
    assert np.linalg.norm(away, axis=2) == pytest.approx(0.012)
    left, right, bottom, top = view.sides
    assert (right - left) * (top - bottom) == pytest.approx(4.0 * math.pi * 0.012**2)


# ---------------------------------------------------------------------------- the command


def test_a_disc_is_even_by_regions_and_not_by_far_foci() -> None:
    told = invoke("--units", "1", "--shape", DISC, "--strength", "0.5", "--json")
    rows = {row["way"]: row for row in json.loads(told.stdout)}
    assert set(rows) == {OURS, FAR, NEAR, SWEPT}
    ours = rows[OURS]
    assert ours["rms"] < 0.04 < rows[FAR]["rms"]
    assert ours["scaled_rms"] <= ours["rms"]
    assert ours["force"] == pytest.approx(1.0, abs=0.03)
    assert ours["status"] == "ok"
    assert rows[SWEPT]["force"] == pytest.approx(1.0, abs=0.01)
    assert rows[SWEPT]["cold_ms"] is None  # no NaN in JSON


def test_as_a_table_and_with_what_does_not_exist() -> None:
    told = invoke("--units", "1", "--shape", "disc, 8 mm", "--strength", "0.25")
    assert OURS in told.output
    assert "0.25 of the strongest" in told.output
    assert max(map(len, told.output.splitlines())) <= 80
    assert "…" not in told.output
    for wrong in (["--units", "2"], ["--shape", "nothing"]):
        assert CliRunner().invoke(bench, ["regions", *wrong]).exit_code == 2


# ---------------------------------------------------------------------------- peers


class Focuser(Worker):
    """A peer that makes one focus at the first point, and remembers what it was asked."""

    def __init__(self, answer: dict[str, Any] | None = None) -> None:
        super().__init__("autd3", [], 1)
        self.answer, self.asked, self.closed = answer, list[dict[str, Any]](), False

    def ask(self, message: dict[str, Any], limit: float) -> dict[str, Any]:
        self.asked.append(message)
        if self.answer is not None:
            return self.answer
        problem = message["problem"]
        r = np.linalg.norm(np.array(problem["positions"]) - problem["frames"][0][0], axis=1)
        g = 0.5 * np.exp(1j * problem["wavenumber"] * r)
        return {"re": g.real.tolist(), "im": g.imag.tolist()}

    def close(self) -> None:
        self.closed = True


def test_peers_are_asked_what_ours_are_asked_and_judged_by_their_model() -> None:
    worker, shape = Focuser(), SHAPES["grating, period 20 mm"]()
    with closing(Peers(worker, 1)) as peers:
        assert len(peers.ways) == 4
        made = peers.make(shape, "autd3 gspat, 8.5 mm", 2.0)
        row = judge(peers.array, shape, made, ("grating", "autd3", 0.5, 2.0))
    assert worker.closed
    (message,) = worker.asked
    problem = message["problem"]
    assert message["solver"] == "autd3-gspat"
    samples = shape.samples(peers.array, 0.0085)
    wanted = samples.radiation_pressure > 0.0
    assert 0 < wanted.sum() < len(wanted)  # foci are asked for where anything is
    assert problem["frames"][0] == samples.positions[wanted].tolist()
    P = 2.0 * samples.radiation_pressure[wanted]
    assert problem["targets"] == pytest.approx(np.sqrt(1.2 * 340.0**2 * P).tolist())
    own = press(peers.array.positions, made.gains, shape.places)
    assert row.force == pytest.approx(own.sum() / (2.0 * shape.asked.sum()), rel=1e-3)
    assert row.samples == made.samples == wanted.sum()
    assert row.saturation == 0.0
    assert row.status == ""


@pytest.mark.parametrize("answer", [{}, {"re": [1.0], "im": [0.0]}, {"re": ["a"], "im": [0.0]},
                                    {"re": [math.nan] * 249, "im": [0.0] * 249}])  # fmt: skip
def test_a_peer_that_answers_nonsense_is_told(answer: dict[str, Any]) -> None:
    with closing(Peers(Focuser(answer), 1)) as peers, pytest.raises(WorkerError):
        peers.make(SHAPES["disc, 8 mm"](), peers.ways[0], 1.0)


def test_without_autd3_the_command_says_how_to_install_it(tmp_path: Path) -> None:
    told = CliRunner().invoke(bench, ["regions", "--peers", str(tmp_path)])
    assert told.exit_code == 2
    assert ".ci/peers" in told.output
    assert "autd3" in told.output


def test_autd3_itself_on_a_disc() -> None:
    python = environments.find_python(environments.find_folder(), "autd3")
    if python is None:
        pytest.skip("no environment of autd3: .ci/peers builds it")
    told = invoke("--units", "1", "--shape", DISC, "--strength", "0.5", "--peers", "--json")
    rows = {row["way"]: row for row in json.loads(told.stdout)}
    assert len(rows) == 9
    assert rows["regions, autd3's field"]["rms"] < rows["autd3 gspat, 4.25 mm"]["rms"]
    assert rows["autd3 gspat, 8.5 mm"]["force"] == pytest.approx(1.0, abs=0.5)
    assert rows["autd3 greedy, 8.5 mm"]["saturation"] == 1.0


# ---------------------------------------------------------------------------- costs


@pytest.mark.parametrize("samples", cost.GRIDS)
def test_the_regions_whose_cost_is_measured(samples: int) -> None:
    places = cost.place_grid(*cost.GRIDS[samples])
    assert len(places) == samples
    assert places.mean(axis=0) == pytest.approx([0.0, 0.0, 0.2])
    apart = np.linalg.norm(places[:, None] - places, axis=2) + np.eye(samples)
    assert apart.min() == pytest.approx(0.003)


def test_costs_as_a_table_and_as_json(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cost, "SIDES", (1,))
    monkeypatch.setattr(cost, "GRIDS", {60: (10, 6)})
    monkeypatch.setattr(cost, "TIMES", 2)
    (row,) = json.loads(invoke("--cost", "--json").stdout)
    assert (row["transducers"], row["samples"]) == (249, 60)
    assert all(row[step] > 0.0 for step in ("build_ms", "cold_ms", "warm_ms"))
    assert 0.0 <= row["saturation"] < 1.0
    assert row["cold_steps"] >= 1
    told = invoke("--cost").output
    assert "249" in told
    assert "B alone" in told


# ---------------------------------------------------------------------------- contacts


def test_contacts_are_felt_as_asked_by_regions_and_not_by_foci(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    name = "ball of 20 mm radius at the palm"
    monkeypatch.setattr(contacts, "CONTACTS", {name: contacts.CONTACTS[name]})
    rows = {
        row["way"]: row for row in json.loads(invoke("--units", "9", "--contacts", "--json").stdout)
    }
    assert set(rows) == {OURS, FAR, NEAR}
    ours = rows[OURS]
    assert ours["force"] == pytest.approx(1.0, abs=0.03)
    assert ours["rms"] < 0.09 < rows[NEAR]["rms"] < rows[FAR]["rms"]
    assert ours["holes"] == 0.0
    assert ours["beside"] < 0.7
    told = invoke("--units", "1", "--contacts").output
    assert "over all touched skin" in told
    assert OURS in told


def test_every_contact_touches_skin() -> None:
    array = pc.autd(3, 3)
    for scene in contacts.CONTACTS.values():
        sampler = pc.Sampler(1000)
        sampler.prepare(array, pc.Air())
        samples = sampler.sample(scene())
        assert len(samples) > 30
        assert samples.radiation_pressure.max() == pytest.approx(contacts.PRESSURE, rel=0.15)


# ---------------------------------------------------------------------------- pictures


def test_pictures_of_a_flat_shape_and_of_an_unrolled_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from PIL import Image

    monkeypatch.setattr(shapes, "PICTURE_SPACING", 0.001)
    monkeypatch.setattr(pictures, "FRONT", ("disc, 8 mm",))
    folder = tmp_path / "new"
    names = ("disc, 8 mm", "shell of a ball, radius 12 mm")
    told = invoke("--units", "1", "--pictures", str(folder),
                  *(part for name in names for part in ("--shape", name)))  # fmt: skip
    files = sorted(path.name for path in folder.iterdir())
    assert files == ["regions-disc-8-mm.png", "regions-shell-of-a-ball-radius-12-mm.png",
                     "regions.png"]  # fmt: skip
    for name in files:
        assert f"wrote {folder / name}" in told.output
        with Image.open(folder / name) as image:
            assert image.width > 600
            assert len(set(image.convert("L").tobytes())) > 50  # not empty


def test_a_picture_shows_the_field(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shapes, "PICTURE_SPACING", 0.002)
    picture = pictures.Picture(pc.autd(), DISC)
    row, made = picture.made[OURS]
    assert picture.asked.max() == pytest.approx(picture.pressure)
    inside = picture.asked > 0.0
    assert made.shape == picture.asked.shape
    rms = np.sqrt(((made - picture.asked)[inside] ** 2).mean()) / picture.pressure
    assert rms == pytest.approx(row.rms, abs=0.01)
    assert pictures.describe(row).startswith("force 10")
    assert set(picture.made) == {OURS, FAR}


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    told = CliRunner().invoke(bench, ["regions", "--pictures", str(tmp_path / "file")])
    assert told.exit_code == 2
    assert "--pictures" in told.output
