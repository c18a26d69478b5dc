"""A solution keeps its problem: fields, pressures, forces and tables use its own array and air."""

from __future__ import annotations

import dataclasses
import sys
from typing import Any

import numpy as np
import pytest
from scipy.integrate import simpson

import pacinian as pc

ARRAY = pc.autd()
COLD = pc.Air(temperature=2.0)
POINTS = np.array([[0.02, 0.0, 0.15], [-0.02, 0.01, 0.16]])


@pytest.fixture(scope="module")
def solution() -> pc.Solution:
    return pc.solve(ARRAY, POINTS, [400.0, 300.0], medium=COLD)


def test_it_holds_array_medium_points_targets_and_limits(solution: pc.Solution) -> None:
    assert solution.array is ARRAY
    assert solution.medium is COLD
    assert (solution.points == POINTS).all()
    assert not solution.points.flags.writeable
    assert (solution.targets.amplitudes == [400.0, 300.0]).all()
    assert solution.limits == pc.Limits() or solution.limits.gain == 1.0


def test_its_points_are_its_own() -> None:
    places = POINTS.copy()
    session = pc.Session(ARRAY, COLD)
    first = session.solve(places, np.array([400.0, 300.0]))
    again = session.solve(places, np.array([200.0, 150.0]))  # scaled, not solved
    places[:] = 0.1
    moved = session.solve(POINTS + np.array([0.0, 0.0, 0.05]), np.array([400.0, 300.0]))
    assert (first.points == POINTS).all()
    assert (again.points == POINTS).all()
    assert (moved.points == POINTS + np.array([0.0, 0.0, 0.05])).all()


def test_its_field_is_in_its_own_air(solution: pc.Solution) -> None:
    assert np.abs(solution.field(POINTS)) == pytest.approx([400.0, 300.0], rel=1e-3)
    reference = pc.matrix(ARRAY, POINTS, COLD) @ solution.gains
    assert solution.field(POINTS, precision="double") == pytest.approx(reference, rel=1e-12)
    assert solution.field(POINTS[0]).shape == ()
    assert solution.field(np.broadcast_to(POINTS, (4, 2, 3))).shape == (4, 2)


def test_without_a_medium_a_field_is_refused(solution: pc.Solution) -> None:
    with pytest.raises(TypeError, match="medium"):
        pc.field(ARRAY, solution.gains, POINTS)  # type: ignore[call-arg]
    with pytest.raises(pc.ArgumentError, match="solution, its `medium`"):
        pc.field(ARRAY, solution.gains, POINTS, None)  # type: ignore[arg-type]


def test_its_radiation_pressure_is_that_of_its_air(solution: pc.Solution) -> None:
    expected = np.abs(solution.sound_pressure) ** 2 / (COLD.density * COLD.speed_of_sound**2)
    assert solution.radiation_pressure() == pytest.approx(expected, rel=1e-6)
    assert solution.radiation_pressure(POINTS) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("turn", [0.0, 0.4, np.pi], ids=["flat", "tilted", "over"])
def test_its_force_is_that_of_the_radiation_stress_on_a_rigid_plate(
    solution: pc.Solution, turn: float
) -> None:
    """At the plate, p and the parallel velocity are twice those of the free field; the normal velocity is 0."""
    pose = pc.Pose((0.01, 0.0, 0.15)).rotate("x", turn)
    plate = pc.Surface(shape=pc.Rectangle(0.06, 0.04), pose=pose, radiation_pressure=1.0)
    x, y, h = np.linspace(-0.03, 0.03, 81), np.linspace(-0.02, 0.02, 61), 1e-5
    X, Y = np.meshgrid(x, y)
    q = pose.points(np.stack([X, Y, 0 * X], axis=-1))
    P = np.abs(solution.field(q, precision="double")) ** 2 / (COLD.density * COLD.speed_of_sound**2)
    for along in h * pose.matrix.T[:2]:
        up, down = (solution.field(q + s * along, precision="double") for s in (1, -1))
        v = (up - down) / (2.0 * h * COLD.density * 2.0 * np.pi * 40_000.0)  # [m/s]
        P -= COLD.density * np.abs(v) ** 2
    assert solution.force(plate) == pytest.approx(simpson(simpson(P, x=x), x=y), rel=0.02)


def test_a_body_shades_its_own_far_side() -> None:
    """A plane wave of energy density E presses the near half of a ball with 2 E cos^2, in total 4 pi r^2 E / 3."""
    array = pc.Array([[0.0, 0.0, 0.0]])
    solution = pc.solve(array, (0.0, 0.0, 3.0), 1.0, scale="max", medium=COLD)
    ball = pc.Volume(shape=pc.Sphere(0.01), pose=pc.Pose((0.0, 0.0, 3.0)), force=0.001)
    twice_E = solution.radiation_pressure()[0]
    expected = 2.0 * np.pi * 0.01**2 / 3.0 * twice_E
    assert solution.force(ball) == pytest.approx(expected, rel=0.01)


def test_as_strong_as_possible_it_tells_strength_and_proportions() -> None:
    strong = pc.solve(ARRAY, POINTS, [2.0, 1.0], scale="max")
    most = np.abs(strong.sound_pressure).max()
    assert f"up to {most:.4g} Pa, error of the proportions" in repr(strong)
    assert "of the proportions" in strong._repr_html_()


def test_finer_samples_bring_the_force_closer(solution: pc.Solution) -> None:
    surface = pc.Surface(shape=pc.Disc(0.012), pose=pc.Pose((0.0, 0.0, 0.15)), force=0.001)
    best = solution.force(surface, spacing=0.0002)
    errors = [abs(solution.force(surface, spacing=s) / best - 1.0) for s in (0.006, 0.001)]
    assert errors[1] < 0.005 < errors[0]


@pytest.mark.parametrize(
    ("ask", "argument"),
    [
        (lambda s: s.force("plate"), "surface"),
        (lambda s: s.force(pc.Disc(0.01)), "surface"),
        (lambda s: s.force(pc.Surface(shape=pc.Disc(0.01), force=0.1), spacing=-1.0), "spacing"),
        (lambda s: s.force(pc.Surface(shape=pc.Disc(0.1), force=0.1), spacing=1e-6), "spacing"),
        (lambda s: s.field([[0.0, 0.0]]), "points"),
        (lambda s: s.field([[0.0, 0.0, np.nan]]), "points"),
        (lambda s: s.radiation_pressure("here"), "points"),
        (lambda s: s.field(POINTS, precision="half"), "precision"),
    ],
)
def test_bad_arguments_are_named(solution: pc.Solution, ask: Any, argument: str) -> None:
    with pytest.raises(pc.ArgumentError) as caught:
        ask(solution)
    assert caught.value.argument == argument


def test_on_skin_the_pressure_is_that_along_the_normals() -> None:
    facing = pc.SkinFacing([[0.0, 0.6, -0.8], [0.0, 0.0, -1.0]])
    made = pc.solve(ARRAY, POINTS, [300.0, 200.0], facing=facing, medium=COLD)
    assert made.facing is facing
    reference = pc.normal_pressure(ARRAY, made.gains, POINTS, facing, COLD)
    assert made.radiation_pressure() == pytest.approx(reference, rel=1e-4)
    assert made.radiation_pressure(POINTS, facing) == pytest.approx(reference, rel=1e-9)


def test_a_table_has_a_row_for_each_point(solution: pc.Solution) -> None:
    pytest.importorskip("pandas")
    table = solution.to_dataframe()
    assert list(table.index) == [0, 1]
    assert table[["x", "y", "z"]].to_numpy() == pytest.approx(POINTS)
    assert table["target"].to_list() == [400.0, 300.0]
    p = table["sound_pressure"] * np.exp(1j * table["phase"])
    assert p.to_numpy() == pytest.approx(solution.sound_pressure)
    assert table["radiation_pressure"].to_list() == pytest.approx(solution.radiation_pressure())
    assert table.attrs["status"] == solution.status.name
    assert "region" not in table


def test_a_dataset_has_points_and_transducers_with_units(
    solution: pc.Solution, tmp_path: Any
) -> None:
    xr = pytest.importorskip("xarray")
    data = solution.to_xarray()
    assert dict(data.sizes) == {"point": 2, "transducer": len(ARRAY)}
    g = data["gain_amplitude"] * np.exp(1j * data["gain_phase"])
    assert g.to_numpy() == pytest.approx(solution.gains, rel=1e-5)
    assert data["transducer_x"].to_numpy() == pytest.approx(ARRAY.positions[:, 0])
    assert all(data[name].attrs["units"] for name in data.variables)
    data.to_netcdf(tmp_path / "solution.nc", engine="scipy")  # without complex numbers and NaN
    with xr.open_dataset(tmp_path / "solution.nc", engine="scipy") as again:
        assert again.attrs["solver"] == solution.solver
        assert again["target"].to_numpy() == pytest.approx([400.0, 300.0])


def test_a_table_of_regions_tells_them() -> None:
    pytest.importorskip("pandas")
    points = pc.disc(0.006, 0.003, (0.0, 0.0, 0.15))
    made = pc.solve(ARRAY, points, 200.0, regions=np.zeros(len(points), int), medium=COLD)
    assert made.to_dataframe()["region"].to_list() == [0] * len(points)


@pytest.mark.parametrize(
    ("method", "library"), [("to_dataframe", "pandas"), ("to_xarray", "xarray")]
)
def test_a_missing_library_is_named_with_its_extra(
    solution: pc.Solution, method: str, library: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(
        pc.MissingExtra, match=rf"{library} is not installed.*pip install .*\[tables\]"
    ):
        getattr(solution, method)()


def test_it_draws_its_own_field(solution: pc.Solution) -> None:
    page = solution.plot("xy")
    colours = page.axes[0].get_images()[0].get_array()
    grid = pc.grid((0.1, 0.1), 0.0005, POINTS.mean(axis=0))
    assert colours.max() == pytest.approx(solution.radiation_pressure(grid).max(), rel=0.1)
    axes = page.add_subplot()
    assert solution.plot("xz", show="phase", ax=axes) is axes
    with pytest.raises(pc.ArgumentError, match="`plane`"):
        solution.plot("zz")


def test_its_text_says_what_was_asked_and_made(solution: pc.Solution) -> None:
    text = repr(solution)
    assert "lagrange" in text or "auto" in text or solution.solver in text
    for part in ("ok", "2 points", "300 to 400 Pa", f"{len(ARRAY)} transducers", "error"):
        assert part in text
    silent = pc.solve(ARRAY, POINTS, 0.0, medium=COLD)
    assert "silent" in repr(silent)
    empty = pc.solve(ARRAY, np.empty((0, 3)), [], medium=COLD)
    assert "0 points" in repr(empty)


def test_replaced_parts_stay_consistent(solution: pc.Solution) -> None:
    half = dataclasses.replace(solution, gains=solution.gains / 2)
    assert half.field(POINTS) == pytest.approx(solution.field(POINTS) / 2, rel=1e-6)
