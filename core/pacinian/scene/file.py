"""Scene files in TOML or JSON. msgspec decodes and checks them; the JSON Schema comes from the same classes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import msgspec
from msgspec import Struct
from msgspec.structs import replace

from pacinian.acoustics.air import ATMOSPHERE, Air
from pacinian.acoustics.array import autd, lattice
from pacinian.acoustics.pose import Pose, Vector
from pacinian.checks import check_integer, check_length, check_number
from pacinian.devices.description import DeviceDescription
from pacinian.documents import decode_document, json_schema
from pacinian.errors import ArgumentError, SceneFileError
from pacinian.scene.hands.hand import Hand
from pacinian.scene.objects import Object
from pacinian.scene.sampling.sources import FINEST
from pacinian.scene.scene import Scene, Workspace

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array

S = TypeVar("S", bound=Struct)


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


class Choice(Struct, frozen=True, forbid_unknown_fields=True):
    """A plug-in, chosen by name, and its own options."""

    name: str
    options: dict[str, bool | int | float | str] = {}


class Sampling(Struct, frozen=True, forbid_unknown_fields=True):
    """How finely the scene is sampled.

    budget: maximum number of samples. spacing: between samples [m]. The default is one wavelength, or the resolution
    of the array where that is coarser.
    """

    budget: int = 256
    spacing: float | None = None

    def __post_init__(self) -> None:
        # The same checks as in `Sampler`. Importing `Sampler` takes 0.5 s, and a guard must restart quickly.
        check_integer("budget", self.budget, low=1)
        if self.spacing is not None:
            check_number("spacing", check_length("spacing", self.spacing), low=FINEST)


class HandPose(Struct, frozen=True, forbid_unknown_fields=True):
    """A hand.

    pose: of the palm of an open hand; with joints, it moves the joints. joints: 26 positions in OpenXR's order [m].
    """

    side: Literal["left", "right"] = "right"
    pose: Pose = Pose()
    joints: tuple[Vector, ...] = ()

    def make(self) -> Hand:
        """Make the hand."""
        if self.joints:
            return Hand(self.joints, side=self.side).transform(self.pose)
        return Hand.open(self.side, self.pose)


class SceneFile(Struct, frozen=True, forbid_unknown_fields=True):
    """The contents of a scene file: the objects and hands, and the array, medium, solver and backend to use.

    rate: ticks per second [Hz]. gain: the gain limit; 1 is full drive.
    """

    array: Units | Lattice | Device = Units()
    medium: Medium = Medium()
    solver: str | Choice = "auto"
    backend: str | Choice = "simulated"
    rate: float = 1000.0
    gain: float = 1.0
    sampling: Sampling = Sampling()
    workspace: Workspace | None = None
    hands: tuple[HandPose, ...] = ()
    objects: tuple[Object, ...] = ()

    def __post_init__(self) -> None:
        check_number("rate", self.rate, low=1.0, high=100_000.0)
        check_number("gain", self.gain, low=0.0, high=1.0, above=True)

    @property
    def scene(self) -> Scene:
        """The scene: the objects, the workspace and the hands."""
        return Scene(self.objects, self.workspace, tuple(hand.make() for hand in self.hands))


def load_scene_file(path: str | Path) -> SceneFile:
    """Read a scene file.

    path: a file whose name ends in .toml or .json. All numbers are in SI units ([m], [Pa], [N], [Hz]). Raises
    SceneFileError, which names the file, the key and the fix.
    """
    path = Path(path)
    file = decode_document(path, SceneFile)
    file = replace(
        file,
        array=resolve_path(file.array, path.parent),
        objects=tuple(_found(item, i, path) for i, item in enumerate(file.objects)),
    )
    parts = ("$.array", file.array.make), ("$.medium", file.medium.make), ("$", lambda: file.scene)
    for key, made in parts:
        try:
            made()
        except ArgumentError as error:
            raise SceneFileError(path, key, str(error)) from error
    return file


def make_schema() -> dict[str, Any]:
    """Make the JSON Schema of scene files."""
    return json_schema(SceneFile, "Pacinian scene")


def _found(item: Object, index: int, path: Path) -> Object:
    """Resolve an object's files relative to the scene file's folder, and read them once to check them."""
    found, field = resolve_path(item, path.parent), ""
    try:
        for name in found.load():
            field = f".{name}"
    except ArgumentError as error:
        raise SceneFileError(path, f"$.objects[{index}]{field}", str(error)) from error
    return found


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
