"""The layouts of a study: arrangements in a plane, and transforms that bend them into space."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

import pacinian as pc
from pacinian.acoustics.pose import Pose
from pacinian.argument_checks import check_angle, check_integer, check_length, check_number
from pacinian.devices.description import DeviceDescription
from pacinian.errors import ArgumentError
from pacinian_lab.study import arrangements
from pacinian_lab.study.sweep import Count, Number, Word, check_each, check_single

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.types import Floats

MAX_TRANSDUCERS = 20_000  # maximum number of transducers
FLAT = 1e-9  # [m]


class Layout(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="type"):
    """The base of all layouts. Before it is bent, a layout lies on the xy-plane, centred, and points to +z.

    name: its label; the type by default. bowl: bends it to a sphere of this radius that touches the xy-plane [m]; 0
    leaves it flat. fold: raises each half by this angle [rad] about the axis `hinge`, "x" or "y". facing: adds a
    second, identical array at this height that points down [m]; 0 for none. pose: of all that. Numbers may be lists,
    which are swept. Raises ArgumentError.
    """

    drawn: ClassVar[bool] = False
    """Whether the layout is random."""

    name: str = ""
    bowl: Number = 0.0
    fold: Number = 0.0
    hinge: Word = "x"
    facing: Number = 0.0
    pose: Pose = Pose()

    def __post_init__(self) -> None:
        check_each("bowl", self.bowl, _length_or_none)
        check_each("fold", self.fold, _fold)
        check_each("facing", self.facing, _length_or_none)
        check_each("hinge", self.hinge, _axis)

    def _places(self, rng: np.random.Generator) -> Floats:
        """Return the positions of the transducers in the plane [m], (N, 2); rng: of the study, for this layout."""
        raise NotImplementedError

    def _flat(self, kind: pc.Transducer, rng: np.random.Generator) -> pc.Array:
        """Return the array before it is bent."""
        xy = self._places(rng)
        return pc.Array(np.pad(xy, ((0, 0), (0, 1))), transducer=kind)

    def make(self, kind: pc.Transducer, rng: np.random.Generator) -> pc.Array:
        """Return the array, with this kind of transducer. Raises ArgumentError."""
        array = self._flat(kind, rng)
        if len(array) > MAX_TRANSDUCERS:
            raise ArgumentError(
                "layout", f"has {len(array)} transducers: more than {MAX_TRANSDUCERS}"
            )
        if bowl := check_single(self.bowl):
            array = bent(array, bowl)
        if fold := check_single(self.fold):
            array = array.fold(check_single(self.hinge), fold)
        if facing := check_single(self.facing):
            array += array.transform(Pose((0.0, 0.0, facing)).rotate("x", math.pi))
        return array.transform(self.pose)


class Autd(Layout, frozen=True, tag="autd"):
    """A grid of AUTD units, `columns` in x and `rows` in y."""

    columns: Count = 1
    rows: Count = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, value in (("columns", self.columns), ("rows", self.rows)):
            check_each(name, value, _some)

    def _places(self, rng: np.random.Generator) -> Floats:
        return pc.autd(check_single(self.columns), check_single(self.rows)).positions[:, :2]


class Spread(Layout, frozen=True, kw_only=True):
    """Layouts over a rectangle, `width` x `height` [m]; the height is the width unless given."""

    width: Number
    height: Number = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_each("width", self.width, check_length)
        check_each("height", self.height, _length_or_none)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [m]."""
        return check_single(self.width), check_single(self.height) or check_single(self.width)


class Lattice(Spread, frozen=True, tag="lattice"):
    """A square lattice, including both ends, as `pacinian.lattice`."""

    pitch: Number = 0.01

    def __post_init__(self) -> None:
        super().__post_init__()
        check_each("pitch", self.pitch, _pitch)

    def _places(self, rng: np.random.Generator) -> Floats:
        return pc.lattice(*self.size, check_single(self.pitch)).positions[:, :2]


class Hexagonal(Spread, frozen=True, tag="hexagonal"):
    """A triangular lattice with six neighbours at the pitch [m]; its rows lie along x."""

    pitch: Number = 0.01

    def __post_init__(self) -> None:
        super().__post_init__()
        check_each("pitch", self.pitch, _pitch)

    def _places(self, rng: np.random.Generator) -> Floats:
        return arrangements.hexagonal(*self.size, check_single(self.pitch))


class Scattered(Spread, frozen=True, kw_only=True, tag="random"):
    """Random positions over the rectangle, at least `apart` [m] from each other; each seed gives another draw."""

    drawn: ClassVar[bool] = True

    count: Count
    apart: Number = 0.0
    seed: Count = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_each("count", self.count, _some)
        check_each("apart", self.apart, _length_or_none)
        check_each("seed", self.seed, lambda n, v: check_integer(n, v, low=0))

    def _places(self, rng: np.random.Generator) -> Floats:
        return arrangements.scatter_points(
            *self.size, check_single(self.count), check_single(self.apart), rng
        )


class Sunflower(Layout, frozen=True, kw_only=True, tag="sunflower"):
    """Fermat's spiral with the golden angle: evenly spread over a disc, without rows."""

    count: Count
    diameter: Number

    def __post_init__(self) -> None:
        super().__post_init__()
        check_each("count", self.count, _some)
        check_each("diameter", self.diameter, check_length)

    def _places(self, rng: np.random.Generator) -> Floats:
        return arrangements.sunflower(check_single(self.count), check_single(self.diameter))


class Rings(Layout, frozen=True, kw_only=True, tag="rings"):
    """Concentric rings around one transducer. Rings, and transducers on a ring, are `pitch` [m] apart."""

    diameter: Number
    pitch: Number = 0.01

    def __post_init__(self) -> None:
        super().__post_init__()
        check_each("diameter", self.diameter, check_length)
        check_each("pitch", self.pitch, _pitch)

    def _places(self, rng: np.random.Generator) -> Floats:
        return arrangements.rings(check_single(self.diameter), check_single(self.pitch))


class Device(Layout, frozen=True, tag="device"):
    """A real device: its description (`pacinian.DeviceDescription`), or the file that holds it.

    It has its own kind of transducer instead of the study's.
    """

    file: str = ""
    device: DeviceDescription | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if bool(self.file) == (self.device is not None):
            raise ArgumentError("file", "must be given, or `device`, and not both")

    def _flat(self, kind: pc.Transducer, rng: np.random.Generator) -> pc.Array:
        """Return the array of the description."""
        if self.device is None:
            raise ArgumentError("file", "has not been read: use `pacinian_lab.study.read`")
        return self.device.array()

    def found(self, folder: Path) -> Device:
        """Return this layout with its description, read from a file in `folder`. Raises SceneFileError."""
        if not self.file:
            return self
        return replace(self, file="", device=DeviceDescription.load(folder / self.file))


AnyLayout = Autd | Lattice | Hexagonal | Scattered | Sunflower | Rings | Device


def bent(array: pc.Array, radius: float) -> pc.Array:
    """Bend a flat array to a sphere of this radius [m], which keeps distances from its centre.

        (s cos a, s sin a, 0) -> R (sin(s/R) cos a, sin(s/R) sin a, 1 - cos(s/R))

    All transducers point to the sphere's centre. Raises ArgumentError.
    """
    r, n = array.positions - array.centre, array.normals
    if np.ptp(r[:, 2]) > FLAT or np.abs(n - (0.0, 0.0, 1.0)).max() > FLAT:
        raise ArgumentError("bowl", "needs a flat array that points to +z")
    s = np.hypot(r[:, 0], r[:, 1])  # [m]
    if s.max() > math.pi / 2.0 * radius:
        raise ArgumentError("bowl", f"of radius {radius:g} m is smaller than the array")
    way = r[:, :2] / np.maximum(s, 1e-30)[:, None]
    across, up = np.sin(s / radius)[:, None] * way, np.cos(s / radius)
    places = radius * np.column_stack([across, 1.0 - up])
    normals: Any = np.column_stack([-across, up])
    return pc.Array(array.centre + places, normals, array.transducer, array.response)


def _fold(name: str, value: float) -> None:
    check_number(name, check_angle(name, value), low=-math.pi / 2.0, high=math.pi / 2.0)


def _axis(name: str, value: str) -> None:
    if value not in ("x", "y"):
        raise ArgumentError(name, f'must be "x" or "y", not {value!r}')


def _some(name: str, value: float) -> None:
    if check_integer(name, value, low=1) > MAX_TRANSDUCERS:
        raise ArgumentError(name, f"must be at most {MAX_TRANSDUCERS}, not {value}")


def _pitch(name: str, value: float) -> None:
    if check_length(name, value) < 1e-3:
        raise ArgumentError(name, f"is {value:g} m: lengths are in metres")


def _length_or_none(name: str, value: float) -> None:
    if check_number(name, value, low=0.0):
        check_length(name, value)
