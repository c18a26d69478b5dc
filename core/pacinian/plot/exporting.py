"""Array, scene and field for programs that show them in space: glTF to look at, VTK to work with."""

from __future__ import annotations

from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.pressure import sound_pressure_level
from pacinian.checks import check_kind, check_number
from pacinian.errors import ArgumentError, MissingExtra
from pacinian.plot import meshes
from pacinian.plot.fields import NONE, checked, crossed
from pacinian.plot.paints import coloured, painted, picture, strip, wheel
from pacinian.plot.quantities import clear, limits
from pacinian.plot.style import METAL, SKIN, THING
from pacinian.plot.volumes import isosurface, volume
from pacinian.scene.sampling.samples import Samples
from pacinian.scene.scene import Scene

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.plot.meshes import Triangles
    from pacinian.plot.planes import Plane
    from pacinian.plot.volumes import Box, Volume
    from pacinian.scene.objects import Object
    from pacinian.types import ArrayLike, Floats

SOUND = (0.9, 0.3, 0.1)
UP = np.array(
    [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
"""From our z up to glTF's y up."""


def export(
    path: str | Path,
    array: Array,
    scene: Scene | None = None,
    samples: Samples | None = None,
    gains: ArrayLike | None = None,
    *,
    t: float = 0.0,
    level: float = 0.5,
    box: Box | None = None,
    spacing: float | None = None,
    medium: Air | None = None,
) -> None:
    """Write what there is in space to a file, by its extension.

    ".glb", binary glTF in metres with y up: the array, coloured by phase and darkened where the amplitude is low; the
    scene's objects and hands at time t [s]; samples, coloured by what is asked; radiation pressure in two planes, and
    the surface where it is `level` of its most, 0..1. ".vti", VTK image data: sound and radiation pressure on a grid.

    gains: (N,); needed for a field. box: of the field, its lower and upper corner [m]; around the samples, or 0.2 m
    before the array, unless given. spacing: of the grid [m]; a quarter of a wavelength, or what a million points allow,
    unless given. medium: `Air()` unless given. Raises ArgumentError, MissingExtra, OSError.
    """
    medium = checked(array, medium)
    check_kind("scene", scene, Scene, NoneType)
    check_kind("samples", samples, Samples, NoneType)
    where = Path(path)
    if where.suffix not in (".glb", ".vti"):
        raise ArgumentError("path", f"must end in .glb or .vti, not {where.suffix!r}")
    points = NONE if samples is None else samples.positions
    grid = None if gains is None else volume(array, gains, points, medium, box, spacing)
    if where.suffix == ".vti":
        if grid is None:
            raise ArgumentError("gains", "must be given for .vti: it holds the field")
        _vti(where, grid.p, grid.radiation(medium), grid.corner, grid.step)
        return
    level = check_number("level", level, low=0.0, high=1.0, above=True)
    made = _Model()
    made.array(array, gains)
    if scene is not None:
        made.scene(scene, t)
    if samples is not None and len(samples):
        made.samples(samples)
    if grid is not None and gains is not None:
        made.planes(array, gains, points, medium)
        made.surface(grid, medium, level)
    made.write(where)


class _Model:
    """A glTF model that is being made. extras: what is said of it."""

    def __init__(self) -> None:
        import trimesh

        self.made: Any = trimesh.Scene()
        self.extras: dict[str, Any] = {"unit": "m"}

    def add(self, name: str, made: Any) -> None:
        """A part, under a name of its own."""
        if len(made.faces):
            self.made.add_geometry(made, node_name=name, geom_name=name)

    def array(self, array: Array, gains: ArrayLike | None) -> None:
        """Its transducers, with their drive: u is the phase, in turns from -1/2, v the amplitude."""
        flat = meshes.discs(array)
        if gains is None:
            self.add("array", painted(flat, METAL))
            return
        g = np.asarray(gains)
        most = float(np.abs(g).max()) or 1.0
        uv = np.stack([np.angle(g) / (2.0 * np.pi) + 0.5, np.abs(g) / most], axis=-1)
        self.add("array", coloured(flat, uv[flat.thing], wheel()))
        self.extras["array, largest amplitude |g|"] = most

    def scene(self, scene: Scene, t: float) -> None:
        """Objects at time t [s], and hands."""
        for k, item in enumerate(scene.objects):
            self.add(f"object {item.name or k}", painted(_placed(item, t), THING))
        for held in scene.hands:
            if not held.lost:
                self.add(f"hand {held.name}", painted(meshes.hand(held), SKIN))

    def samples(self, samples: Samples) -> None:
        """A ball each: u is what is asked, as a share of the most."""
        balls, P = meshes.spots(samples.positions), samples.radiation_pressure
        most = float(P.max()) or 1.0
        uv = np.stack([P / most, np.full(len(P), 0.5)], axis=-1)
        self.add("samples", coloured(balls, uv[balls.thing], strip("inferno")))
        self.extras["samples, most radiation pressure asked [Pa]"] = most

    def planes(self, array: Array, gains: ArrayLike, points: Floats, medium: Air) -> None:
        """Radiation pressure in the two planes that tell most, seen through where it is weak."""
        both = crossed(array, gains, points, medium)
        tops = [limits(P, clear(array, plane.points, medium), "radiation") for plane, P in both]
        most = max(tops)[1]
        for plane, P in both:
            corners = _corners(plane)
            quad = meshes.Triangles(
                corners, np.array([[0, 1, 2], [0, 2, 3]]), np.zeros(4, dtype=np.intp)
            )
            uv = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
            self.add(f"field {plane.place}", coloured(quad, uv, picture(P, most), clear=True))
        self.extras["field, most radiation pressure on skin [Pa]"] = most

    def surface(self, grid: Volume, medium: Air, level: float) -> None:
        """Where radiation pressure is a share of its most."""
        P = grid.radiation(medium)
        if (value := level * float(np.nanmax(P))) > 0.0:
            vertices, faces = isosurface(P, grid.corner, grid.step, value)
            whole = meshes.Triangles(vertices, faces, np.zeros(len(vertices), dtype=np.intp))
            self.add("isosurface", painted(whole, SOUND, opacity=0.5))
            self.extras["isosurface, radiation pressure on skin [Pa]"] = value

    def write(self, path: Path) -> None:
        """With y up."""
        self.made.metadata.update(self.extras)
        self.made.apply_transform(UP)
        path.write_bytes(self.made.export(file_type="glb"))


def _corners(plane: Plane) -> Floats:
    """From the lower left on round, half a step beyond the outer points: (4, 3) [m]."""
    q = plane.points
    right, up = (q[0, 1] - q[0, 0]) / 2.0, (q[1, 0] - q[0, 0]) / 2.0
    signs = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    outer = q[[0, 0, -1, -1], [0, -1, -1, 0]]
    return np.array([c + s * right + t * up for c, (s, t) in zip(outer, signs, strict=True)])


def _placed(item: Object, t: float) -> Triangles:
    made = meshes.thing(item)
    pose = item.pose if item.motion is None else item.motion.pose(item.pose, t)
    return made._replace(vertices=pose.points(made.vertices))


def _vti(path: Path, p: Any, P: Floats, corner: Floats, step: float) -> None:
    """VTK image data: x is the fastest index there, and the first here."""
    try:
        from pyevtk.hl import imageToVTK
    except ImportError as error:
        raise MissingExtra("pyevtk", "plot") from error
    p = p.T
    level = np.nan_to_num(sound_pressure_level(p), neginf=0.0)
    imageToVTK(
        str(path.with_suffix("")), tuple(corner.tolist()), (step, step, step),
        pointData={
            "radiation pressure on skin [Pa]": np.asfortranarray(P.T),
            "sound pressure, real [Pa]": np.asfortranarray(p.real, np.float64),
            "sound pressure, imaginary [Pa]": np.asfortranarray(p.imag, np.float64),
            "sound pressure level [dB re 20 uPa]": np.asfortranarray(level),
        },
    )  # fmt: skip
