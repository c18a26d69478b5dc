"""Study files: TOML or JSON, decoded and checked by msgspec. The schema comes from the same classes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec import Struct
from msgspec.structs import replace

from pacinian.acoustics.propagation import Precision
from pacinian.argument_checks import check_integer, check_length, check_number
from pacinian.config_files import decode_document, json_schema
from pacinian.devices.description import LevelCounts, TransducerType
from pacinian.errors import ArgumentError
from pacinian.plugins import registry
from pacinian.scene.config_sections import Medium
from pacinian_lab.study.layouts import AnyLayout, Device
from pacinian_lab.study.patterns import AnyPattern
from pacinian_lab.study.planes import Plane
from pacinian_lab.study.sweep import Entry, format_label, iterate_combinations

if TYPE_CHECKING:
    from pacinian.plugins.solver import Solver

MAX_PIXELS = 1000  # maximum number of pixels along a side of the picture

Option = bool | int | float | str


class Method(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A solver and its settings. Settings that are lists are swept.

    phases: of the target pressures [rad], the same at all points; free by default. precision: "single", or "double"
    for ill-conditioned problems.
    """

    name: str
    options: dict[str, Option | tuple[Option, ...]] = {}
    phases: float | None = None
    precision: Precision = "single"

    def __post_init__(self) -> None:
        if self.phases is not None:
            check_number("phases", self.phases)
        for name, value in self.options.items():
            if value == ():
                raise ArgumentError(f"options.{name}", "is swept over nothing: give a value")

    def make(self) -> Solver:
        """Return the solver. Raises UnknownPlugin, PluginError, ArgumentError."""
        return registry.solver(self.name, **self.options)

    def entries(self) -> list[Entry[Method]]:
        """Return all combinations of the swept settings."""
        made: list[Entry[Method]] = []
        for values in iterate_combinations(self.options):
            item = replace(self, options={**self.options, **values})
            options: dict[str, Any] = dict(item.options)
            if self.phases is not None:
                options["phases"] = self.phases
            if self.precision != "single":
                options["precision"] = self.precision
            made.append(Entry(format_label(self.name, options), item))
        return made


class Picture(Struct, frozen=True, forbid_unknown_fields=True):
    """The part of a plane in which the field is evaluated: a square of `side` [m], with a pixel every `step` [m]."""

    side: float = 0.3
    step: float = 0.002

    def __post_init__(self) -> None:
        check_length("side", self.side)
        check_length("step", self.step)
        if not 3 <= self.side / self.step <= MAX_PIXELS:
            raise ArgumentError("step", f"must make 3 to {MAX_PIXELS} pixels along the side")


class Study(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A study: every layout with every plane, pattern, solver and level.

    levels: ||t||_2 relative to the pressure of a single focus: `gain` times the mean of sum_n |B_mn| over the points
    with a target; `inf` means as strong as possible in these proportions. seed: of all random choices. gain: the
    limit of |g_n|, `inf` for none. emitted: phases and amplitudes of a device, to which gains are quantised before they
    are evaluated. picture: where the field is evaluated. Raises ArgumentError.
    """

    layouts: tuple[AnyLayout, ...]
    patterns: tuple[AnyPattern, ...]
    planes: tuple[Plane, ...] = (Plane(),)
    solvers: tuple[str | Method, ...] = ("auto",)
    levels: tuple[float, ...] = (0.5,)
    title: str = ""
    seed: int = 0
    medium: Medium = Medium()
    transducer: TransducerType = TransducerType()
    gain: float = 1.0
    emitted: LevelCounts | None = None
    picture: Picture = Picture()

    def __post_init__(self) -> None:
        for name in ("layouts", "patterns", "planes", "solvers", "levels"):
            if not getattr(self, name):
                raise ArgumentError(name, "must not be empty: there would be nothing to do")
        for i, level in enumerate(self.levels):
            if level != math.inf:
                check_number(f"levels[{i}]", level, low=0.0, above=True)
        check_integer("seed", self.seed, low=0)
        if self.gain != math.inf:
            check_number("gain", self.gain, low=1e-6, high=1e6)
            if self.emitted is not None and self.gain > 1.0:
                raise ArgumentError("gain", "must be at most 1 where `emitted` is given")
        elif self.emitted is not None or math.inf in self.levels:
            raise ArgumentError(
                "gain", "must be finite where a level is not, or `emitted` is given"
            )

    @property
    def methods(self) -> tuple[Method, ...]:
        """The solvers, all with settings."""
        return tuple(Method(name=s) if isinstance(s, str) else s for s in self.solvers)


def read(path: str | Path) -> Study:
    """Read a study file, and the device descriptions that it names.

    path: a file that ends in .toml or .json; all numbers in SI units ([m], [rad], [degC]). Raises SceneFileError,
    which names the file, the key and the fix.
    """
    path = Path(path)
    study = decode_document(path, Study)
    layouts = [a.found(path.parent) if isinstance(a, Device) else a for a in study.layouts]
    return replace(study, layouts=tuple(layouts))


def schema() -> dict[str, Any]:
    """Return the JSON Schema of study files."""
    return json_schema(Study, "Pacinian study")
