"""Messages of each kind, with all that a message can contain: the source of the byte vectors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.wire import commands, control, modulation, objects, shapes
from pacinian.wire.binary_arrays import pack, pack_indices
from pacinian.wire.protocol import MAJOR, MINOR
from pacinian_lab.vectors.reply_examples import CORNERS, FRAME, HAND, KEY, STATE, make_answers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from msgspec import Struct

AT = shapes.Pose((0.0, 0.0, 0.2), (0.0, 0.0, 0.6, 0.8))
BALL, BLOCK = shapes.Sphere(0.03), shapes.Box((0.04, 0.05, 0.06))
SIDES = pack_indices([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
MESH = shapes.Mesh(vertices=CORNERS, faces=SIDES, scale=0.5)
FULL = pack(np.pad(np.ones((1, 1, 2)), 1))
VOXELS = shapes.Voxels(values=FULL, grid=(3, 3, 4), pitch=0.01, level=0.25)
TEXTURE = objects.Texture(
    values=pack([[0.0, 0.5, 1.0]]), grid=(1, 3), size=(0.03, 0.01), repeat=False
)

CURVES: tuple[shapes.Curve, ...] = (
    shapes.Line(0.1),
    shapes.Circle(0.02),
    shapes.Lissajous(0.04, 0.03, 3, 4, 45.0),
    shapes.Polyline(CORNERS, closed=True),
)
SHELLS: tuple[shapes.Shell, ...] = (
    shapes.Rectangle(0.06, 0.04),
    shapes.Disc(0.03),
    BALL,
    shapes.HeightMap(
        heights=pack([[0.0, 1.0], [0.5, 0.25]]), grid=(2, 2), width=0.1, height=0.08, depth=0.01
    ),
    MESH,
)
SOLIDS: tuple[shapes.Solid, ...] = (
    BALL,
    BLOCK,
    shapes.Capsule(0.02, 0.06),
    MESH,
    VOXELS,
    shapes.Placed(BLOCK, AT),
    shapes.Union((BALL, shapes.Placed(BLOCK, AT))),
    shapes.Intersection((BALL, BLOCK)),
    shapes.Difference(BLOCK, (BALL,)),
)
ENVELOPES: tuple[modulation.Envelope, ...] = (
    "buzzing",
    modulation.Constant(0.75),
    modulation.Sine(150.0, 0.25, 0.75),
    modulation.Square(50.0, 0.1, 0.9, 0.25),
    modulation.Pulse(0.05, 0.5, 0.125, 0.01, 0.1, 0.9),
    modulation.Noise(20.0, 200.0, 0.1, 0.9, 7),
    modulation.Preset("rapturous"),
    modulation.Wave(samples=pack([0.0, 0.5, -0.5, 1.0]), rate=8000.0, loop=False, mode="loudness"),
)
TECHNIQUES: tuple[modulation.Technique, ...] = (
    modulation.Simultaneous(),
    modulation.AM(150.0, 0.5),
    modulation.STM(100.0, "outline", 0.0005),
    modulation.STM(100.0, shapes.Circle(0.01)),
    modulation.LM(60.0, 0.003, 90.0),
)


def kind_of(item: object) -> str:
    """Return the wire name of an item: its `type`."""
    config = getattr(type(item), "__struct_config__", None)
    return str(config.tag) if config is not None else str(item)


def make_examples() -> Iterator[tuple[str, str, Struct]]:
    """Yield name, socket ("command", "control", "reply", "state") and message."""
    for message in _commands():
        yield kind_of(message), "command", message
    for name, item in _objects():
        yield f"put {name}", "command", _put(item)
    for envelope in ENVELOPES:
        yield (
            f"envelope {kind_of(envelope)}",
            "command",
            commands.Envelopes(session=KEY, sequence=7, time=2.5, names=("a",), envelope=envelope),
        )
    for message in _controls():
        yield kind_of(message), "control", message
    for i, technique in enumerate(TECHNIQUES):
        name = f"select {kind_of(technique)}" + (" along a curve" if i == 3 else "")
        yield name, "control", control.Select(session=KEY, id=9, technique=technique)
    for message in make_answers():
        yield kind_of(message), "reply", message
    yield "state", "state", STATE
    yield "state that was asked for", "reply", STATE
    yield "frame", "state", FRAME


def _put(item: objects.Object) -> commands.Put:
    return commands.Put(session=KEY, sequence=1, time=0.5, objects={"a": item})


def _objects() -> Iterator[tuple[str, objects.Object]]:
    yield "point", objects.Point(position=(0.0, -0.01, 0.2), force=0.005, area=0.0001)
    for curve in CURVES:
        yield (
            f"path {kind_of(curve)}",
            objects.Path(shape=curve, pose=AT, radiation_pressure=200.0, width=0.01),
        )
    yield (
        "particles",
        objects.Particles(positions=CORNERS, pose=AT, radiation_pressure=100.0, radius=0.005),
    )
    for shell in SHELLS:
        yield (
            f"surface {kind_of(shell)}",
            objects.Surface(shape=shell, pose=AT, force=0.01, texture=TEXTURE, thickness=0.01),
        )
    for solid in SOLIDS:
        name = f"volume {kind_of(solid)}"
        yield name, objects.Volume(shape=solid, pose=AT, radiation_pressure=250.0)
    yield (
        "with everything",
        objects.Volume(
            shape=BALL,
            pose=AT,
            texture=TEXTURE,
            thickness=0.01,
            felt="interior",
            radiation_pressure=300.0,
            envelope=modulation.Sine(40.0),
            technique=modulation.STM(70.0),
            material=objects.Material(100_000.0, 0.002),
            motion=objects.Motion((0.1, 0.0, -0.2), (0.0, 0.0, 3.0)),
            priority=-2,
            duration=1.5,
        ),
    )


def _commands() -> tuple[Struct, ...]:
    quaternions = [[0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0], [0.1, 0.0, 0.2, 0.0, 1.0, 0.0, 0.0]]
    left = commands.HandFrame(
        side="left",
        name="palm",
        joints=HAND,
        radii=pack([0.0078125] * 26),
        velocities=pack([[0.0, 0.0, 1.0]]),
    )
    zone = commands.Zone(position=(0.0, 0.0, 0.1), pressure=200.0, radius=0.01)
    return (
        commands.Put(session=KEY, sequence=2**53, time=-1.25, ttl=0.25, id=2**32 - 1, objects={}),
        commands.Move(
            session=KEY,
            sequence=2,
            time=1.0,
            names=("a", "Würfel"),
            poses=pack(quaternions),
            velocities=pack(np.arange(12.0).reshape(2, 6)),
        ),
        commands.Remove(session=KEY, sequence=3, time=1.0, names=("a",)),
        commands.Clear(session=KEY, sequence=4, time=1.0),
        commands.Envelopes(
            session=KEY, sequence=5, time=1.0, names=("a", "b"), envelope="trembling"
        ),
        commands.Hands(session=KEY, sequence=6, time=1.0, hands=(left, commands.HandFrame())),
        commands.Quiet(session=KEY, sequence=300, time=1.0, zones=(zone,)),
        commands.Field(session=KEY, sequence=70_000, time=1.0, id=12, points=CORNERS),
        commands.Show(session=KEY, sequence=70_001, time=1.0, id=13, scene="room", since=41),
    )


def _controls() -> tuple[Struct, ...]:
    options: dict[str, control.Option] = {
        "steps": 20,
        "tolerance": 0.001,
        "warm": True,
        "mode": "x",
    }
    solver = control.Choice(name="lagrange", options=options)
    backend = control.Choice(name="simulated")
    return (
        control.Hello(
            id=1, protocol=(MAJOR, MINOR), client="game", version="1.2", scene="room", lease=0.1
        ),
        control.Renew(session=KEY, id=2, sequence=1, time=12.5),
        control.Arm(session=KEY, id=3, take=True, resume=True),
        control.Disarm(session=KEY, id=4),
        control.Stop(id=5),
        control.Reset(session=KEY, id=6),
        control.Select(session=KEY, id=7, solver=solver, backend=backend, intensity=0.5),
        control.Capabilities(session=KEY, id=8),
        control.Status(session=KEY, id=9),
        control.Bye(session=KEY, id=10),
    )
