from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import pacinian as pc

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

    from pacinian.types import Floats, Gains

SOURCE = pc.Transducer(pressure=4.3859003539)  # [Pa m]; the emulator's own figure, omnidirectional
UPRIGHT = (1.0, 0.0, 0.0, 0.0)  # (w, x, y, z)
TURNED = (np.cos(0.3), 0.6 * np.sin(0.3), 0.0, 0.8 * np.sin(0.3))  # (w, x, y, z)


@pytest.fixture(scope="module")
def emulator(need: Callable[..., ModuleType]) -> Any:
    need("autd3_emulator")
    need("autd3_pattern")
    return need(".emulator", __package__)


def unit(
    position: tuple[float, ...] = (0.0, 0.0, 0.0), wxyz: tuple[float, ...] = UPRIGHT
) -> pc.Array:
    """Return an AUTD unit that is placed by its first transducer, as in the emulator."""
    here = pc.autd(1, 1, SOURCE)
    first = here.transform(pc.Pose(position=tuple(-here.positions[0])))
    w, x, y, z = wxyz
    return first.transform(pc.Pose(position=position, rotation=(x, y, z, w)))


def gains(phases: np.ndarray, intensities: np.ndarray) -> Gains:
    """Return the gains of the emulator's levels."""
    width = np.round(512 * np.arcsin(intensities / 255) / np.pi)
    amplitude = np.sin(np.pi * width / 512)
    return (amplitude * np.exp(-2j * np.pi * phases / 256)).astype(np.complex64)


AIR = pc.Air(speed_of_sound=340.0)  # the emulator's, in `emulator.rms`


def agrees(array: pc.Array, g: Gains, points: Floats, theirs: Floats) -> None:
    for precision in ("single", "double"):
        rms = np.abs(pc.field(array, g, points, AIR, precision)) / np.sqrt(2.0)
        np.testing.assert_allclose(rms, theirs, rtol=1e-4, atol=1e-5 * theirs.max())


def test_a_unit_has_its_transducers_where_the_emulator_has_them(emulator: Any) -> None:
    for place, turn in (((0.0, 0.0, 0.0), UPRIGHT), ((0.2, 0.01, 0.02), TURNED)):
        np.testing.assert_allclose(
            unit(place, turn).positions, emulator.positions([(place, turn)]), atol=2e-7
        )


def test_a_focused_unit_makes_the_field_of_the_emulator(emulator: Any) -> None:
    rng = np.random.default_rng(2)
    focus = np.array([0.09, 0.07, 0.2])
    array = unit()
    distance = np.linalg.norm(array.positions - focus, axis=1)
    turns = 40e3 / 340.0 * distance
    phases = np.round(-256 * turns).astype(int) % 256  # their sign: exp(-2j pi p / 256)
    points = np.concatenate([[focus], focus + rng.uniform(-0.02, 0.02, (100, 3))])
    full = np.full(249, 255)
    theirs = emulator.rms([((0, 0, 0), UPRIGHT)], phases, full, points)
    agrees(array, gains(phases, full), points, theirs)
    np.testing.assert_allclose(  # at the focus all arrive in step
        theirs[0], (4.3859003539 / distance).sum() / np.sqrt(2.0), rtol=1e-3
    )


def test_two_units_driven_at_random_make_the_field_of_the_emulator(emulator: Any) -> None:
    rng = np.random.default_rng(3)
    place = (0.2, 0.01, 0.02)
    phases, intensities = rng.integers(0, 256, (2, 498))
    points = rng.uniform([0.0, 0.0, 0.1], [0.35, 0.15, 0.3], (100, 3))
    theirs = emulator.rms([((0, 0, 0), UPRIGHT), (place, TURNED)], phases, intensities, points)
    agrees(unit() + unit(place, TURNED), gains(phases, intensities), points, theirs)
