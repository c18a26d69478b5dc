"""Exports array, scene and field to 3-D programs: glTF for viewing, VTK for analysis."""

from __future__ import annotations

from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.array import Array
from pacinian.acoustics.pressure import sound_pressure_level
from pacinian.acoustics.propagation import check_medium
from pacinian.argument_checks import check_kind, check_number
from pacinian.atomic_file import replace_file
from pacinian.errors import ArgumentError, MissingExtra
from pacinian.plot import meshes
from pacinian.plot.fields import NONE, cut_both
from pacinian.plot.mesh_colours import make_plain_mesh, make_textured_mesh, picture, strip, wheel
from pacinian.plot.outlines import find_pose
from pacinian.plot.quantities import compute_colour_limits, find_distant_points
from pacinian.plot.style import METAL, SAMPLES_MAP, SKIN, THING
from pacinian.plot.volumes import isosurface, volume
from pacinian.scene.sampling.samples import Samples
from pacinian.scene.scene import Scene

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
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
    """Write the array, scene and field to a file; the extension selects the format.

    ".glb", binary glTF in metres with y up: the array, coloured by phase and darkened where the amplitude is low; the
    scene's objects and hands at time t [s]; samples, coloured by target; radiation pressure in two planes, and its
    isosurface at `level` of the maximum, 0..1. ".vti", VTK image data: sound and radiation pressure on a grid.

    gains: (N,), and medium, the air: for a field. box: lower and upper corner of the field [m]; default: around the
    samples, or 0.2 m in front of the array. spacing: of the grid [m]; default: a quarter of a wavelength, or coarser
    to stay within a million points. Raises ArgumentError, MissingExtra, OSError.
    """
    check_kind("array", array, Array)
    check_kind("scene", scene, Scene, NoneType)
    check_kind("samples", samples, Samples, NoneType)
    where = Path(path)
    if where.suffix not in (".glb", ".vti"):
        raise ArgumentError("path", f"must end in .glb or .vti, not {where.suffix!r}")
    points = NONE if samples is None else samples.positions
    grid = None
    if gains is not None:
        grid = volume(array, gains, points, check_medium(medium), box, spacing)
    if where.suffix == ".vti":
        if grid is None:
            raise ArgumentError("gains", "must be given for .vti: it holds the field")
        _vti(where, grid.p, grid.radiation(), grid.corner, grid.step)
        return
    level = check_number("level", level, low=0.0, high=1.0, above=True)
    made = _Model()
    made.array(array, gains)
    if scene is not None:
        made.scene(scene, t)
    if samples is not None and len(samples):
        made.samples(samples)
    if grid is not None and gains is not None:
        made.planes(array, gains, points, grid.medium)
        made.surface(grid, level)
    made.write(where)


class _Model:
    """Builder of a glTF model. extras: its metadata."""

    def __init__(self) -> None:
        import trimesh

        self.made: Any = trimesh.Scene()
        self.extras: dict[str, Any] = {"unit": "m"}

    def add(self, name: str, made: Any) -> None:
        """Add a part under a unique name."""
        if len(made.faces):
            self.made.add_geometry(made, node_name=name, geom_name=name)

    def array(self, array: Array, gains: ArrayLike | None) -> None:
        """Add the transducers with their drive: u is the phase, in turns from -1/2, v the amplitude."""
        flat = meshes.discs(array)
        if gains is None:
            self.add("array", make_plain_mesh(flat, METAL))
            return
        g = np.asarray(gains)
        most = float(np.abs(g).max()) or 1.0
        uv = np.stack([np.angle(g) / (2.0 * np.pi) + 0.5, np.abs(g) / most], axis=-1)
        self.add("array", make_textured_mesh(flat, uv[flat.thing], wheel()))
        self.extras["array, largest amplitude |g|"] = most

    def scene(self, scene: Scene, t: float) -> None:
        """Add objects at time t [s], and hands."""
        for k, item in enumerate(scene.objects):
            self.add(f"object {item.name or k}", make_plain_mesh(_place_object(item, t), THING))
        for held in scene.hands:
            if not held.lost:
                self.add(f"hand {held.name}", make_plain_mesh(meshes.hand(held), SKIN))

    def samples(self, samples: Samples) -> None:
        """Add a ball per sample: u is its target, relative to the largest."""
        balls, P = meshes.spots(samples.positions), samples.radiation_pressure
        most = float(P.max()) or 1.0
        uv = np.stack([P / most, np.full(len(P), 0.5)], axis=-1)
        self.add("samples", make_textured_mesh(balls, uv[balls.thing], strip(SAMPLES_MAP)))
        self.extras["samples, most radiation pressure asked [Pa]"] = most

    def planes(self, array: Array, gains: ArrayLike, points: Floats, medium: Air) -> None:
        """Add the radiation pressure in two planes, transparent where it is weak."""
        both = cut_both(array, gains, points, medium)
        tops = [
            compute_colour_limits(P, find_distant_points(array, plane.points, medium), "radiation")
            for plane, P in both
        ]
        most = max(tops)[1]
        for plane, P in both:
            corners = _corners(plane)
            quad = meshes.make_triangles(corners, np.array([[0, 1, 2], [0, 2, 3]]))
            uv = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
            self.add(
                f"field {plane.place}", make_textured_mesh(quad, uv, picture(P, most), clear=True)
            )
        self.extras["field, most radiation pressure on skin [Pa]"] = most

    def surface(self, grid: Volume, level: float) -> None:
        """Add the isosurface of the radiation pressure at a share of its maximum."""
        P = grid.radiation()
        if (value := level * float(np.nanmax(P))) > 0.0:
            vertices, faces = isosurface(P, grid.corner, grid.step, value)
            whole = meshes.make_triangles(vertices, faces)
            self.add("isosurface", make_plain_mesh(whole, SOUND, opacity=0.5))
            self.extras["isosurface, radiation pressure on skin [Pa]"] = value

    def write(self, path: Path) -> None:
        """Write the file with y up."""
        self.made.metadata.update(self.extras)
        self.made.apply_transform(UP)
        with replace_file(path) as file:
            file.write(self.made.export(file_type="glb"))


def _corners(plane: Plane) -> Floats:
    """Return the corners from the lower left on, half a step beyond the outer points, (4, 3) [m]."""
    q = plane.points
    right, up = (q[0, 1] - q[0, 0]) / 2.0, (q[1, 0] - q[0, 0]) / 2.0
    signs = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    outer = q[[0, 0, -1, -1], [0, -1, -1, 0]]
    return np.array([c + s * right + t * up for c, (s, t) in zip(outer, signs, strict=True)])


def _place_object(item: Object, t: float) -> Triangles:
    made = meshes.make_object(item)
    return made._replace(vertices=find_pose(item, t).points(made.vertices))


def _vti(path: Path, p: Any, P: Floats, corner: Floats, step: float) -> None:
    """Encode VTK image data: x is its fastest index, and the first index here."""
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
