from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import pacinian as pc

PITCH = 0.01016  # [m]


def test_an_autd_unit_has_249_transducers_on_a_grid_of_18_by_14_less_3() -> None:
    r = pc.autd(1, 1).positions
    assert len(r) == 249
    assert not r[:, 2].any()
    x = (np.arange(18) - 8.5) * PITCH
    y = (np.arange(14) - 6.5) * PITCH
    holes = {(1, 1), (2, 1), (16, 1)}
    grid = [(x[i], y[j], 0.0) for j in range(14) for i in range(18) if (i, j) not in holes]
    np.testing.assert_allclose(r, grid, atol=1e-15)


def test_units_are_192_0_by_151_4_millimetres_apart_along_x_then_y() -> None:
    units = pc.autd(3, 2).positions.reshape(6, 249, 3)
    one = pc.autd(1, 1).positions
    for index, unit in enumerate(units):
        shift = ((index % 3 - 1) * 0.192, (index // 3 - 0.5) * 0.1514, 0.0)
        np.testing.assert_allclose(unit, one + shift, atol=1e-15)


def test_autd_units_hold_t4010a1s_that_point_up() -> None:
    array = pc.autd()
    assert array.transducer == pc.T4010A1
    assert np.array_equal(array.normals, np.tile([0.0, 0.0, 1.0], (249, 1)))


@pytest.mark.parametrize("argument", ["columns", "rows"])
def test_a_number_of_units_that_is_none_is_refused(argument: str) -> None:
    for value in (0, 1.5, "two", 1001):
        with pytest.raises(pc.ArgumentError):
            pc.autd(**{argument: value})


def test_a_lattice_of_200_by_400_millimetres_has_861_transducers() -> None:
    array = pc.lattice(0.2, 0.4)
    assert len(array) == 861 == 21 * 41
    r = array.positions
    np.testing.assert_allclose(np.unique(r[:, 0].round(9)), np.arange(-10, 11) / 100)
    np.testing.assert_allclose(np.unique(r[:, 1].round(9)), np.arange(-20, 21) / 100)
    assert not r[:, 2].any()
    assert array.transducer == pc.IDEAL


@given(st.integers(1, 12), st.integers(1, 12), st.floats(1e-3, 0.05))
def test_a_lattice_is_symmetric_about_the_origin(columns: int, rows: int, pitch: float) -> None:
    array = pc.lattice(columns * pitch, rows * pitch, pitch)
    assert len(array) == (columns + 1) * (rows + 1)
    np.testing.assert_allclose(array.positions, -array.positions[::-1], atol=1e-15)
    np.testing.assert_allclose(
        np.ptp(array.positions, axis=0), [columns * pitch, rows * pitch, 0], rtol=1e-12
    )


@pytest.mark.parametrize("argument", ["width", "height", "pitch"])
def test_a_lattice_of_no_size_or_in_millimetres_is_refused(argument: str) -> None:
    for value in (0.0, 200.0):
        with pytest.raises(pc.ArgumentError, match=f"`{argument}`"):
            pc.lattice(**{"width": 0.1, "height": 0.1, argument: value})


@pytest.mark.parametrize(("size", "pitch"), [(0.1, 1e-5), (0.1, 5e-324), (1.0, 5e-4)])
def test_a_lattice_of_millions_is_refused(size: float, pitch: float) -> None:
    with pytest.raises(pc.ArgumentError, match="`pitch`"):
        pc.lattice(size, size, pitch)


def test_folding_about_x_by_45_raises_each_half_by_45_degrees() -> None:
    flat = pc.lattice(0.2, 0.4)
    folded = flat.fold("x", math.radians(45.0))
    x, y, _ = flat.positions.T
    cos = sin = math.sqrt(0.5)
    np.testing.assert_allclose(
        folded.positions, np.stack([x, y * cos, np.abs(y) * sin], axis=1), atol=1e-15
    )


def test_folding_about_y_is_folding_about_x_with_the_axes_exchanged() -> None:
    flat = pc.Array([[0.01, 0.03, 0.0], [-0.02, -0.03, 0.0], [0.01, 0.04, 0.0], [0.0, -0.04, 0.0]])
    exchanged = pc.Array(flat.positions[:, [1, 0, 2]])
    one, other = flat.fold("x", math.radians(30.0)), exchanged.fold("y", math.radians(30.0))
    np.testing.assert_allclose(one.positions, other.positions[:, [1, 0, 2]], atol=1e-15)
    np.testing.assert_allclose(one.normals, other.normals[:, [1, 0, 2]], atol=1e-15)


@given(st.floats(0.0, 89.0))
@settings(max_examples=20)
def test_folding_keeps_distances_along_each_half(angle: float) -> None:
    flat = pc.lattice(0.04, 0.08)
    folded = flat.fold("x", math.radians(angle))
    for half in (flat.positions[:, 1] > 1e-6, flat.positions[:, 1] < -1e-6):
        before, after = flat.positions[half], folded.positions[half]
        np.testing.assert_allclose(
            np.linalg.norm(before[:, None] - before, axis=2),
            np.linalg.norm(after[:, None] - after, axis=2),
            atol=1e-14,
        )


def test_the_normals_of_the_halves_point_to_each_other() -> None:
    flat = pc.lattice(0.2, 0.4)
    normals = flat.fold("x", math.radians(45.0)).normals
    s = math.sqrt(0.5)
    y = flat.positions[:, 1]
    np.testing.assert_allclose(normals[y > 1e-6], np.tile([0, -s, s], (420, 1)), atol=1e-15)
    np.testing.assert_allclose(normals[y < -1e-6], np.tile([0, s, s], (420, 1)), atol=1e-15)


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (1e3, -1e3, 1e3)])
def test_the_ridge_of_a_fold_points_straight_up_wherever_the_array_is(place: Any) -> None:
    flat = pc.lattice(0.2, 0.4)
    ridge = np.abs(flat.positions[:, 1]) < 1e-9
    folded = flat.transform(pc.Pose(position=place)).fold("x", math.radians(45.0))
    np.testing.assert_allclose(folded.normals[ridge], np.tile([0.0, 0.0, 1.0], (21, 1)), atol=1e-9)


def test_folding_two_units_bends_them_between_the_boards() -> None:
    flat = pc.autd(2, 1)
    folded = flat.fold("y", math.radians(45.0))
    inner = np.abs(flat.positions[:, 0]).min()  # half the gap between the boards' transducers [m]
    np.testing.assert_allclose(
        np.abs(folded.positions[:, 0]).min(), inner * math.sqrt(0.5), rtol=1e-9
    )
    left, right = folded.positions[:, 0] < 0, folded.positions[:, 0] > 0
    assert left.sum() == right.sum() == 249


@pytest.mark.parametrize(
    ("argument", "given_as"),
    [
        ("hinge", ("z",)),
        ("hinge", (None,)),
        ("angle", ("x", math.nan)),
        ("angle", ("y", 3.2)),
        ("angle", ("y", 45.0)),
    ],
)
def test_a_fold_that_cannot_be_is_refused(argument: str, given_as: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=f"`{argument}`"):
        pc.lattice(0.1, 0.1).fold(*given_as)


def test_moved_places_positions_and_turns_normals() -> None:
    array = pc.lattice(0.02, 0.03)
    pose = pc.Pose((1.0, 2.0, 3.0)).rotate("y", math.pi / 2.0)
    moved = array.transform(pose)
    R = Rotation.from_euler("y", 90, degrees=True)
    expected = R.apply(array.positions.copy()) + np.array([1.0, 2.0, 3.0])
    np.testing.assert_allclose(moved.positions, expected, atol=1e-14)
    np.testing.assert_allclose(moved.normals, np.tile([1.0, 0, 0], (len(array), 1)), atol=1e-15)
    assert moved.transducer == array.transducer


def test_translate_shifts_positions_only() -> None:
    array = pc.lattice(0.02, 0.03)
    moved = array.translate((1.0, 2.0, 3.0))
    np.testing.assert_array_equal(moved.positions, array.positions + np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(moved.normals, array.normals)


@pytest.mark.parametrize(
    ("argument", "use"),
    [
        ("pose", lambda a: a.transform((0.0, 0.0, 0.1))),
        ("offset", lambda a: a.translate(0.1)),
        ("offset", lambda a: a.translate((0.0, 0.0, math.nan))),
        ("transducer", lambda a: a.replace_transducer("T4010A1")),
    ],
)
def test_bad_arguments_are_named(argument: str, use: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=f"`{argument}`"):
        use(pc.lattice(0.02, 0.02))


def test_plus_puts_one_array_after_the_other() -> None:
    one = pc.lattice(0.02, 0.02)
    other = pc.lattice(0.01, 0.01).transform(pc.Pose((0, 0.1, 0)).rotate("x", math.pi / 2.0))
    both = one + other
    assert len(both) == 9 + 4
    assert np.array_equal(both.positions, np.concatenate([one.positions, other.positions]))
    np.testing.assert_allclose(
        both.normals, np.concatenate([one.normals, other.normals]), atol=1e-15
    )


def test_arrays_of_two_kinds_are_not_added() -> None:
    with pytest.raises(pc.ArgumentError, match="`other`"):
        pc.lattice(0.02, 0.02) + pc.autd()


def test_adding_what_is_no_array_is_a_type_error() -> None:
    with pytest.raises(TypeError):
        pc.lattice(0.02, 0.02) + 1  # type: ignore[operator]


def test_driven_by_changes_only_the_kind() -> None:
    array = pc.autd().replace_transducer(pc.IDEAL)
    assert array.transducer == pc.IDEAL
    assert np.array_equal(array.positions, pc.autd().positions)


@pytest.mark.parametrize("dead", [[0], [3, 5], [8, -1], [], np.array([2]), 4, [1, 1]])
def test_without_leaves_the_others_in_order(dead: Any) -> None:
    array = pc.lattice(0.02, 0.02)
    gone = {int(i) % 9 for i in np.ravel(dead)}
    expected = [array.positions[i] for i in range(9) if i not in gone]
    assert np.array_equal(array.remove_transducers(dead).positions, expected)


@pytest.mark.parametrize("dead", [[9], [-10], [1.5], "x", None, [2**70], [True] * 8, range(9)])
def test_dead_transducers_that_are_no_indices_are_refused(dead: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`dead`"):
        pc.lattice(0.02, 0.02).remove_transducers(dead)


def test_dead_transducers_may_be_given_as_flags() -> None:
    array = pc.lattice(0.02, 0.02)
    rest = array.remove_transducers(np.arange(9) == 4)
    assert np.array_equal(rest.positions, np.delete(array.positions, 4, axis=0))


def test_transducers_at_one_place_are_warned_of() -> None:
    for second in ([0.0, 0.0, 0.0], [-0.0, 0.0, 0.0]):
        with pytest.warns(pc.CoincidentTransducers, match="1 transducers share"):
            pc.Array([[0.0, 0.0, 0.0], second])
    pc.Array([[0.0, 0.0, 0.0], [1e-3, 0.0, 0.0]])  # a warning would be an error


@pytest.mark.parametrize("far", [2e7, 1e308])
def test_an_array_so_far_from_the_origin_that_its_places_are_lost_is_refused(far: float) -> None:
    with pytest.raises(pc.ArgumentError, match=r"`positions` reach .* from the origin"):
        pc.lattice(0.1, 0.1).transform(pc.Pose((far, 0.0, 0.0)))


def test_an_array_in_a_game_s_far_corner_sounds_as_at_its_origin() -> None:
    array, q = pc.lattice(0.1, 0.1), np.array([[0.01, 0.02, 0.15]])
    far = (30_000.0, -70_000.0, 500.0)
    solution = pc.solve(array, q, [500.0])
    moved = pc.solve(array.transform(pc.Pose(far)), q + far, [500.0])
    np.testing.assert_allclose(moved.gains, solution.gains, atol=1e-5)


@pytest.mark.parametrize(
    "positions",
    [[], [[0.0, 0.0]], [[math.nan, 0, 0]], [[0, 0, 1j]], [[0, 0, 0], [192.0, 0, 0]]],
    ids=["none", "shape", "NaN", "complex", "millimetres"],
)
def test_bad_positions_are_refused(positions: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`positions`"):
        pc.Array(positions)


@pytest.mark.parametrize(
    "normals", [(0, 0, 0), [[0, 0, 1], [0, 0, 0]], [[0, 0, 1]] * 3, (0, 0, math.nan), None]
)
def test_bad_normals_are_refused(normals: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`normals`"):
        pc.Array([[0, 0, 0], [0.01, 0, 0]], normals)


@given(st.tuples(*[st.floats(-1.0, 1.0)] * 3), st.sampled_from([1e-9, 1e-3, 1.0, 1e6, 1e100]))
def test_normals_are_normalised(direction: tuple[float, ...], size: float) -> None:
    n = np.array(direction)
    length = np.linalg.norm(n)
    if length < 1e-2:
        return
    array = pc.Array([[0, 0, 0]], n * size)
    np.testing.assert_allclose(array.normals, [n / length], atol=1e-14)


def test_the_arrays_of_an_array_are_read_only_copies() -> None:
    r = np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]])
    array = pc.Array(r)
    r[0] = 1.0
    assert not array.positions[0].any()
    for held in (array.positions, array.normals):
        with pytest.raises(ValueError, match="read-only"):
            held[0, 0] = 1.0
    with pytest.raises(AttributeError):
        array.positions = r  # type: ignore[misc]


def test_one_transducer_is_an_array() -> None:
    array = pc.Array([[0.1, 0.2, 0.3]], (0, 1, 0))
    assert len(array) == 1
    assert array.centre.tolist() == [0.1, 0.2, 0.3]
    assert "1 transducers" in repr(array)
