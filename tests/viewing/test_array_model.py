"""The model for fields, made from a server's reply, has the server's array and medium."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.plugins.backend import Capability, Frame
from pacinian.serving.control.state_builder import describe_sound
from pacinian.viewing.array_model import ArrayModel
from pacinian.viewing.tick_histogram import EDGES, make_histogram
from pacinian.wire.binary_arrays import pack
from pacinian.wire.replies import Abilities
from pacinian.wire.state import FrameState

UNIT = pc.autd()
TURNED = pc.Array(UNIT.positions, UNIT.normals, UNIT.transducer, np.exp(1j * np.arange(len(UNIT))))
AT = np.random.default_rng(1).uniform((-0.1, -0.1, 0.05), (0.1, 0.1, 0.3), (200, 3))


def abilities(array: pc.Array, medium: pc.Air, **fields: Any) -> Abilities:
    """Return a server's reply, encoded and decoded."""
    made = Abilities(
        solvers=(), backends=(), techniques=(), presets=(), positions=pack(array.positions),
        normals=pack(array.normals), frequency=array.transducer.frequency, wavelength=0.0085, phases=256,
        amplitudes=256, device_rate=1e3, rate=1e3, limits={}, sound=describe_sound(array, medium),
    )  # fmt: skip
    return msgspec.msgpack.decode(msgspec.msgpack.encode(replace(made, **fields)), type=Abilities)


@pytest.mark.parametrize(
    "array", [UNIT, TURNED, pc.lattice(0.1, 0.1)], ids=["unit", "turned", "lattice"]
)
@pytest.mark.parametrize(
    "medium",
    [pc.Air(), pc.Air(attenuation="none"), pc.Air(attenuation="absorbing", temperature=30.0, humidity=0.2)],
    ids=["spherical", "none", "absorbing"],
)  # fmt: skip
def test_its_field_is_the_servers(array: pc.Array, medium: pc.Air) -> None:
    model = ArrayModel.of(abilities(array, medium))
    assert model is not None
    gains = np.exp(2j * np.arange(len(array)))
    wanted = pc.field(array, gains, AT, medium)
    found = pc.field(model.array, gains, AT, model.medium)
    assert np.abs(found - wanted).max() < 1e-4 * np.abs(wanted).max()
    pressure = pc.radiation_pressure(found, model.medium)
    assert np.allclose(
        pressure, pc.radiation_pressure(wanted, medium), rtol=1e-3, atol=1e-3 * pressure.max()
    )


def test_a_server_that_does_not_tell_has_no_field() -> None:
    told = abilities(UNIT, pc.Air())
    assert ArrayModel.of(replace(told, sound=None)) is None
    assert told.sound is not None
    assert ArrayModel.of(replace(told, sound=replace(told.sound, directivity="horn"))) is None
    piston = pc.Transducer(directivity=pc.Piston(0.004, 740.0))
    assert describe_sound(UNIT.replace_transducer(piston), pc.Air()).directivity == ""


@pytest.mark.parametrize("sizes", [(), (0.0, 0.25, 0.75, 1.0)])
def test_levels_are_what_the_device_makes_of_them(sizes: tuple[float, ...]) -> None:
    model = ArrayModel(UNIT, pc.Air(), sizes)
    random = np.random.default_rng(2)
    phase, amplitude = random.integers(0, 16, len(UNIT)), random.integers(0, 4, len(UNIT))
    levels = {
        "phase": phase.astype("<u2").tobytes(),
        "amplitude": amplitude.astype("<u2").tobytes(),
    }
    frame = FrameState(sequence=1, time=0.0, phases=16, amplitudes=4, **levels)
    found = np.frombuffer(model.gains(frame), np.complex64)
    size = np.array(sizes or [0.0, 1 / 3, 2 / 3, 1.0])[amplitude]
    assert np.abs(found - size * np.exp(2j * np.pi * phase / 16)).max() < 1e-6
    table = Capability(16, sizes or 4)
    frames = Frame(1, 0.0, phase[None].astype(np.uint16), amplitude[None].astype(np.uint16))
    assert np.array_equal(found, frames.gains(table)[0])
    assert model.gains(replace(frame, phase=b"", amplitude=b"")) == b""


def test_a_histogram_has_the_edges_of_the_wire() -> None:
    counts = np.arange(64, dtype="<u4")
    made = make_histogram(counts.tobytes(), 500.0)
    assert made.counts == tuple(range(64))
    assert (len(made.edges_ms), made.deadline_ms) == (65, 2.0)
    assert made.edges_ms == EDGES
    assert np.allclose(np.log10(EDGES), np.arange(65) / 16 - 2, atol=1e-3)
