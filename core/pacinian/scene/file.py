"""Scene files in TOML or JSON. msgspec decodes and checks them; the JSON Schema comes from the same classes.

The suggestion for a wrong key is made in config_key_advice.py.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from msgspec import Struct
from msgspec.structs import replace

from pacinian.acoustics.pose import Pose, Vector
from pacinian.argument_checks import check_number
from pacinian.config_files import decode_document, json_schema
from pacinian.errors import ArgumentError, SceneFileError
from pacinian.scene.config_sections import (
    Device,
    Lattice,
    Medium,
    PluginConfig,
    Sampling,
    Units,
    Workspace,
    resolve_path,
)
from pacinian.scene.hands.hand import Hand
from pacinian.scene.objects import Object
from pacinian.scene.scene import Scene


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
    solver: str | PluginConfig = "auto"
    backend: str | PluginConfig = "simulated"
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
        except (ArgumentError, SceneFileError) as error:  # the latter of a device's file
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
