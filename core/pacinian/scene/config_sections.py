"""Sections of scene files and of the server's settings: the array, the air, a plug-in, the sampling, the workspace.

These classes load no object, shape or solver, so that a process that needs none of them starts quickly.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import msgspec
import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr, replace

from pacinian.acoustics.air import ATMOSPHERE, Air
from pacinian.acoustics.array import autd, lattice
from pacinian.acoustics.pose import Pose, Vector, vector
from pacinian.argument_checks import check_integer, check_length, check_number
from pacinian.devices.description import DeviceDescription
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.acoustics.array import Array
    from pacinian.types import Flags, Floats

S = TypeVar("S", bound=Struct)

DEFAULT_BUDGET = 320  # samples; a ball of 30 mm radius in free air has 304 (decision 75)
MIN_SAMPLE_SPACING = 1e-4  # smallest spacing of samples [m], about a hundredth of a wavelength


class Units(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="autd"):
    """A grid of AUTD units: columns in x, rows in y."""

    columns: int = 3
    rows: int = 3
    pose: Pose = Pose()

    def make(self) -> Array:
        """Make the array."""
        return autd(self.columns, self.rows).transform(self.pose)


class Lattice(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="lattice"):
    """A planar lattice of ideal transducers.

    width, height, pitch: of the lattice [m]. hinge: the axis, "x" or "y", about which it is folded. angle: of the
    fold [rad]; 0 for a flat lattice.
    """

    width: float
    height: float
    pitch: float = 0.01
    hinge: str = "x"
    angle: float = 0.0
    pose: Pose = Pose()

    def make(self) -> Array:
        """Make the array."""
        flat = lattice(self.width, self.height, self.pitch)
        return (flat.fold(self.hinge, self.angle) if self.angle else flat).transform(self.pose)


class Device(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="device"):
    """A real device.

    file: its `pacinian.DeviceDescription`, relative to the folder of the scene file. pose: of the whole device.
    """

    file: str
    pose: Pose = Pose()

    def make(self) -> Array:
        """Make the array."""
        return DeviceDescription.load(self.file).array().transform(self.pose)

    def copy_to(self, file: Path) -> Device:
        """Write the description, including its calibration, to a .json file; return the device for that file."""
        description = DeviceDescription.load(self.file)
        file.write_bytes(msgspec.json.encode(replace(description, calibration="")))
        return replace(self, file=str(file))


class Medium(Struct, frozen=True, forbid_unknown_fields=True):
    """The air. Its parameters are those of `pacinian.Air`."""

    temperature: float | None = None
    humidity: float = 0.5
    speed_of_sound: float = 0.0
    density: float = 0.0
    attenuation: str | float = "spherical"
    absorption: float | None = None
    ambient_pressure: float = ATMOSPHERE

    def make(self) -> Air:
        """Make the medium."""
        return Air(**msgspec.structs.asdict(self))


class PluginConfig(Struct, frozen=True, forbid_unknown_fields=True):
    """A plug-in, chosen by name, and its own options."""

    name: str
    options: dict[str, bool | int | float | str] = {}


class Sampling(Struct, frozen=True, forbid_unknown_fields=True):
    """How finely the scene is sampled.

    budget: maximum number of samples; one surface or volume in free air, alone in its scene, may have up to twice as
    many. spacing: between samples [m]. The default is one wavelength, or the resolution of the array where that is
    coarser.
    """

    budget: int = DEFAULT_BUDGET
    spacing: float | None = None

    def __post_init__(self) -> None:
        # The same checks as in `Sampler`, which a guard does not load, because it must restart quickly.
        check_integer("budget", self.budget, low=1)
        if self.spacing is not None:
            check_number("spacing", check_length("spacing", self.spacing), low=MIN_SAMPLE_SPACING)


class Workspace(Struct, frozen=True, forbid_unknown_fields=True):
    """The box outside which nothing is felt. lower, upper: its corners [m]. Raises ArgumentError."""

    lower: Vector
    upper: Vector

    def __post_init__(self) -> None:
        force_setattr(self, "lower", vector("lower", self.lower))
        force_setattr(self, "upper", vector("upper", self.upper))
        if any(low >= high for low, high in zip(self.lower, self.upper, strict=True)):
            raise ArgumentError("workspace", "must have `lower` below `upper` in x, y and z")

    def holds(self, points: Floats) -> Flags:
        """Return which of the points, (M, 3) [m], are inside: (M,)."""
        return np.asarray(((points >= self.lower) & (points <= self.upper)).all(axis=1))

    def distance(self, point: Vector) -> float:
        """Return the distance of a point from the box [m]; 0 inside."""
        q = np.asarray(point)
        return float(np.linalg.norm(q - np.clip(q, self.lower, self.upper)))


def resolve_path(struct: S, folder: Path) -> S:
    """Return the struct with its `file` fields, nested ones included, relative to `folder`."""
    new: dict[str, Any] = {}
    for name in struct.__struct_fields__:
        value = getattr(struct, name)
        if name == "file" and value:
            new[name] = str(folder / value)
        elif isinstance(value, Struct):
            new[name] = resolve_path(value, folder)
        elif isinstance(value, tuple) and value and isinstance(value[0], Struct):
            parts = tuple(resolve_path(part, folder) for part in value)
            same = all(a is b for a, b in zip(parts, value, strict=True))
            new[name] = value if same else parts
    changed = {name: value for name, value in new.items() if value is not getattr(struct, name)}
    return replace(struct, **changed) if changed else struct
