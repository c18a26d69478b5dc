"""One good message of each type, as maps: what is spoiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from pacinian.wire.binary_arrays import pack
from pacinian.wire.protocol import MAJOR, MINOR

Message = dict[str, Any]

POSE = {"position": [0.0, 0.0, 0.2], "rotation": [0.0, 0.0, 0.0, 1.0]}
JOINTS = pack([[0.0, 0.0, 0.3]] * 26)
MESH = pack([[0.0, 0.0, 0.0], [0.02, 0.0, 0.0], [0.0, 0.02, 0.0]])
FACES = np.array([0, 1, 2], "<i4").tobytes()
GRID = pack(np.linspace(0.0, 1.0, 16))

OBJECTS: dict[str, Message] = {
    "point": {
        "type": "point", "position": [0.0, 0.01, 0.2], "radiation_pressure": 10.0,
        "technique": {"type": "am", "frequency": 200.0, "depth": 1.0},
        "motion": {"velocity": [0.1, 0.0, 0.0], "angular_velocity": [0.0, 0.0, 0.0]},
    },
    "path": {
        "type": "path", "shape": {"type": "circle", "radius": 0.02}, "pose": POSE, "width": 0.01,
        "radiation_pressure": 10.0, "envelope": {"type": "sine", "frequency": 5.0},
        "technique": {"type": "stm", "frequency": 70.0, "along": "outline"},
    },
    "particles": {
        "type": "particles", "positions": GRID[:48], "pose": POSE, "radius": 0.004, "force": 0.001,
        "envelope": {"type": "noise", "low_frequency": 20.0, "high_frequency": 200.0},
    },
    "surface": {
        "type": "surface", "shape": {"type": "rectangle", "width": 0.04, "height": 0.04},
        "pose": POSE, "radiation_pressure": 10.0, "thickness": 0.02,
        "texture": {"values": GRID, "grid": [4, 4], "size": [0.04, 0.04]},
        "material": {"stiffness": 1e4, "reach": 0.001},
    },
    "mesh": {
        "type": "surface", "radiation_pressure": 10.0, "pose": POSE, "priority": 3,
        "shape": {"type": "mesh", "vertices": MESH, "faces": FACES},
        "envelope": {"type": "wave", "samples": GRID, "rate": 1000.0},
    },
    "volume": {
        "type": "volume", "shape": {"type": "sphere", "radius": 0.02}, "pose": POSE,
        "radiation_pressure": 10.0, "duration": 0.5, "felt": "interior", "envelope": "buzzing",
    },
}  # fmt: skip

COMMANDS: tuple[Message, ...] = (
    *({"type": "put", "objects": {name: item}} for name, item in OBJECTS.items()),
    {"type": "put", "objects": OBJECTS},
    {"type": "move", "names": ["point"], "poses": GRID[:28], "velocities": GRID[:24]},
    {"type": "remove", "names": ["point", "path"]},
    {"type": "clear"},
    {
        "type": "envelope",
        "names": ["point"],
        "envelope": {"type": "pulse", "width": 0.1, "period": 1.0, "rise": 0.01},
    },
    {"type": "hands", "hands": [{"side": "left", "name": "a", "joints": JOINTS}]},
    {"type": "quiet", "zones": [{"position": [0.0, 0.3, 0.3], "pressure": 100.0, "radius": 0.1}]},
    {"type": "field", "points": GRID[:12]},
    {"type": "show", "scene": "shared", "since": 1},
)
CONTROLS: tuple[Message, ...] = (
    {"type": "renew", "sequence": 1, "time": 0.0},
    {"type": "disarm"},
    {"type": "reset"},
    {"type": "capabilities"},
    {"type": "status"},
    {
        "type": "select",
        "solver": {"name": "lagrange", "options": {"tolerance": 0.1}},
        "technique": {"type": "lm", "frequency": 50.0, "amplitude": 0.003},
        "intensity": 0.5,
    },
)
HELLO: Message = {
    "type": "hello", "id": 1, "protocol": [MAJOR, MINOR], "client": "spoiled", "version": "1",
    "scene": "shared", "lease": 0.2,
}  # fmt: skip
STOP: Message = {"type": "stop", "id": -1}  # with a good id it would be a good message
