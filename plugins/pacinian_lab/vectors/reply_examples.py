"""One message of each kind that the server sends: see examples.py."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.wire import modulation, objects, replies, shapes, state
from pacinian.wire.binary_arrays import pack
from pacinian.wire.protocol import MAJOR, MINOR, SESSION_BYTES

if TYPE_CHECKING:
    from msgspec import Struct

KEY = bytes(range(SESSION_BYTES))
CORNERS = pack([[0.0, 0.0, 0.0], [0.05, 0.0, 0.0], [0.0, 0.05, 0.0], [0.0, 0.0, 0.05]])
HAND = pack(0.001953125 * np.arange(78.0).reshape(26, 3))
LAGRANGE = replies.Plugin(name="lagrange", summary="Best with limits.", options={"steps": 20})
SOUND = replies.Sound(
    pressure=4.386,
    directivity="t4010a1",
    response=pack([[1.0, 0.0], [0.5, 0.5], [1.0, 0.0], [0.0, -1.0]]),
    sizes=pack([0.0, 0.25, 1.0]),
    speed_of_sound=340.0,
    density=1.2,
    power=1.0,
    absorption=0.125,
    temperature=22.0,
)
SIMULATED = replies.Plugin(name="simulated")


def make_answers() -> tuple[Struct, ...]:
    """Return a reply of each kind."""
    return (
        replies.Welcome(
            id=1,
            session=KEY,
            protocol=(MAJOR, MINOR),
            server="pacinian 0.1.0",
            time=1000.5,
            scene="room",
            lease=0.1,
            link=0.25,
            rate=1000.0,
        ),
        replies.Ok(id=3),
        replies.Error(
            id=4,
            code="argument",
            message="`radius` must be more than 0, not -1",
            path="$.objects[a].shape.radius",
            advice="give it in metres",
        ),
        replies.Renewed(
            id=2, sequence=1, time=12.5, server_time=1001.0, until=1001.25, owner=True, armed=False
        ),
        replies.Abilities(
            id=8,
            solvers=(LAGRANGE,),
            backends=(SIMULATED,),
            techniques=("simultaneous", "am", "stm", "lm"),
            presets=("impulsive", "rapturous", "trembling", "buzzing"),
            positions=CORNERS,
            normals=pack(np.tile([0.0, 0.0, 1.0], (4, 1))),
            frequency=40_000.0,
            wavelength=0.0085,
            phases=256,
            amplitudes=256,
            device_rate=1000.0,
            rate=1000.0,
            limits={"gain": 1.0, "objects": 256.0},
            sound=SOUND,
        ),
        replies.Shown(
            id=13,
            scene="room",
            version=42,
            names=("ball", "button"),
            poses=pack([[0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0], [0.1, 0.0, 0.2, 0.0, 1.0, 0.0, 0.0]]),
            objects={"ball": objects.Volume(shape=shapes.Sphere(0.03), radiation_pressure=8.0)},
        ),
        replies.Pressures(id=12, pressures=pack(np.arange(8.0).reshape(4, 2)), time=1002.0),
    )


STATE = state.State(
    id=9,
    sequence=42,
    time=1003.5,
    output="sounding",
    armed=True,
    owner="game",
    scene="room",
    solver="lagrange",
    backend="simulated",
    technique="simultaneous",
    intensity=0.5,
    points=CORNERS,
    normals=pack(np.zeros((4, 3))),
    asked=pack([100.0, 200.0, 300.0, 400.0]),
    achieved=pack([99.0, 201.0, 300.0, 398.0]),
    index=np.array([0, 0, 1, 1], dtype="<i4").tobytes(),
    objects=("a", "b"),
    hands=HAND,
    error=0.015625,
    felt=np.array([[1.0, 0.03125, 0.0, 0.75], [np.nan] * 4], dtype="<f4").tobytes(),
    status="ok",
    ticks=3500,
    late=1,
    rate=999.5,
    tick_ms=(0.25, 0.5, 0.75),
    frames=3499,
    longest_gap=0.002,
    skipped={"far": 3},
    faults=("the device refused a frame",),
    fault_count=1,
    restarts={"render": 1},
    inputs=np.array([[41.0, 12.0, 1003.0, 1003.002]], dtype="<f8").tobytes(),
    clients=(
        state.ClientState(
            name="game",
            scene="room",
            owner=True,
            objects=2,
            commands=90,
            errors=0,
            dropped=1,
            age=0.001,
            renewed=0.01,
        ),
    ),
    tick_counts=np.arange(64, dtype="<u4").tobytes(),
    cause="pause",
    why="nothing presses at this moment",
    touches=(
        state.TouchState(
            object="a", hand="right", position=(0.125, 0.0, 0.25), pressure=400.0, strength=0.5
        ),
    ),
    presentation=modulation.AM(frequency=150.0, depth=0.5),
)
FRAME = state.FrameState(
    sequence=42,
    time=1003.5,
    phases=256,
    amplitudes=256,
    phase=np.array([0, 64, 128, 255], dtype="<u2").tobytes(),
    amplitude=np.array([255, 255, 0, 1], dtype="<u2").tobytes(),
    scene_time=3.5,
    part=1,
    parts=2,
)
