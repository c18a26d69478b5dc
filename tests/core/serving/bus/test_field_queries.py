from __future__ import annotations

import numpy as np
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.errors import WireError
from pacinian.serving.bus.field_queries import EmittedGains, FieldQueries
from pacinian.serving.ipc.messages import DeviceStatus, FrameHead
from pacinian.wire.binary_arrays import pack, unpack
from pacinian.wire.commands import Field
from pacinian.wire.replies import Error, Pressures

from ..fake_renderer import KEY, client

ARRAY, AIR = pc.lattice(0.1, 0.1), pc.Air()
N = len(ARRAY)


def device(
    generation: int = 1, later: int = 0, amplitudes: int = 256, **given: bool
) -> DeviceStatus:
    sounding = given.get("sounding", True)
    return DeviceStatus(generation, later, "d", 16, amplitudes, 1000.0, None, 0.0, sounding)


def frame(rows: int, generation: int = 1, columns: int = N) -> tuple[bytes, np.ndarray, np.ndarray]:
    random = np.random.default_rng(3)
    phase, amplitude = random.integers(0, 16, (2, rows, columns)).astype("<u2")
    head = FrameHead(5, 2.5, 1, generation, rows, columns)
    return head.pack() + phase.tobytes() + amplitude.tobytes(), phase, amplitude


def field(points: object, ident: int = 1) -> Field:
    return Field(session=KEY, sequence=1, time=0.0, id=ident, points=pack(points))  # type: ignore[arg-type]


def emitted() -> tuple[np.ndarray, float]:
    gains = np.exp(1j * np.arange(N)).astype(np.complex64)
    return gains, 2.5


def grid(count: int) -> np.ndarray:
    random = np.random.default_rng(1)
    return random.uniform((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3), (count, 3)).astype(np.float32)


def run(fields: FieldQueries, most: int = 10_000) -> list[tuple[object, object]]:
    answers = []
    for _ in range(most):
        if (answer := fields.run_chunk()) is not None:
            answers.append(answer)
        if not fields:
            return answers
    raise AssertionError("it never ends")


@pytest.mark.parametrize("count", [0, 1, 5000])
def test_the_pressures_are_those_of_the_emitted_gains(count: int) -> None:
    fields, who, points = FieldQueries(ARRAY, AIR), client(), grid(count)
    assert fields.begin(who, field(points), emitted()) is None
    [(whose, answer)] = run(fields)
    assert whose is who
    assert isinstance(answer, Pressures)
    assert (answer.id, answer.time) == (1, 2.5)
    p = unpack(answer.pressures, 2).view(np.complex64)[:, 0]
    want = pc.field(ARRAY, emitted()[0], points, AIR, "double")
    assert p.shape == (count,)
    assert np.abs(p - want).max(initial=0.0) <= 1e-4 * np.abs(want).max(initial=1.0)


def test_long_queries_are_done_in_slices_and_clients_take_turns() -> None:
    fields, one, other = FieldQueries(ARRAY, AIR), client(1), client(2)
    assert fields.begin(one, field(grid(20_000)), emitted()) is None
    assert fields.begin(other, field(grid(5), 2), emitted()) is None
    busy = fields.begin(one, field(grid(5), 3), emitted())
    assert busy is not None
    assert (busy.code, busy.id) == ("busy", 3)
    steps = [fields.run_chunk() for _ in range(4)]
    assert [answer[0] for answer in steps if answer is not None] == [other]
    assert len(fields) == 1
    assert [answer[0] for answer in run(fields)] == [one]
    assert fields.begin(one, field(grid(5), 3), emitted()) is None
    fields.forget(one)
    assert fields.run_chunk() is None


def test_points_that_cannot_be_meant_are_refused() -> None:
    fields, who = FieldQueries(ARRAY, AIR), client()
    with pytest.raises(WireError, match="id"):
        fields.begin(who, field(grid(1), 0), emitted())
    with pytest.raises(WireError, match="points"):
        fields.begin(who, field([[9.0, 9.0, 9.0]]), emitted())
    on = field(ARRAY.positions[:1], 4)
    fields.begin(who, on, emitted())
    [(_, answer)] = run(fields)
    assert isinstance(answer, Error)
    assert (answer.code, answer.path, answer.id) == ("argument", "$.points", 4)


def test_gains_are_those_of_the_last_row_in_the_device_s_levels() -> None:
    known = EmittedGains(N)
    assert not known.decode_gains(b"")[0].any()
    data, phase, amplitude = frame(3)
    assert not known.decode_gains(data)[0].any()  # that device is unknown
    known.note_device(device())
    gains, time = known.decode_gains(data)
    want = amplitude[-1] / 255 * np.exp(2j * np.pi * phase[-1] / 16)
    assert gains == pytest.approx(want, abs=1e-6)
    assert time == 2.5
    known.note_device(device(sounding=False))
    assert not known.decode_gains(data)[0].any()


def test_amplitudes_that_are_not_even_are_those_of_the_table() -> None:
    known, (data, phase, amplitude) = EmittedGains(N), frame(1)
    sizes = np.sin(np.pi / 2.0 * np.arange(16) / 15.0).astype("<f4")
    known.note_device(replace(device(amplitudes=16), sizes=sizes.tobytes()))
    want = sizes[amplitude[-1]] * np.exp(2j * np.pi * phase[-1] / 16)
    assert known.decode_gains(data)[0] == pytest.approx(want, abs=1e-6)


def test_levels_that_the_device_does_not_have_are_no_sound() -> None:
    known, (data, _, amplitude) = EmittedGains(N), frame(1)
    known.note_device(device(amplitudes=int(amplitude.max())))
    assert not known.decode_gains(data)[0].any()


def test_while_devices_change_each_frame_is_read_in_the_levels_it_was_made_for() -> None:
    known, (old, _, amplitude), (new, _, _) = EmittedGains(N), frame(1, 1), frame(1, 2)
    known.note_device(device(1))
    known.note_device(device(1, later=2, amplitudes=16))
    assert np.abs(known.decode_gains(old)[0]) == pytest.approx(amplitude[0] / 255, abs=1e-6)
    assert np.abs(known.decode_gains(new)[0]) == pytest.approx(amplitude[0] / 15, abs=1e-6)
    known.note_device(device(2, amplitudes=16))
    assert not known.decode_gains(old)[0].any()


def test_a_frame_of_another_array_is_none() -> None:
    known = EmittedGains(N)
    known.note_device(device())
    assert not known.decode_gains(frame(1, columns=N + 1)[0])[0].any()
    assert not known.decode_gains(frame(1)[0][:-2])[0].any()
