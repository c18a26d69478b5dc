"""The patterns of a study: points in a plane, and the proportions of their targets."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from msgspec import Struct

from pacinian.argument_checks import check_integer, check_length, check_number, check_numbers
from pacinian.errors import ArgumentError
from pacinian_lab.study.sweep import Count, Number, Word, check_each, check_single

if TYPE_CHECKING:
    from PIL.ImageFont import FreeTypeFont, ImageFont

    from pacinian.types import Floats

    Dots = np.ndarray[tuple[int, int], np.dtype[np.bool_]]

MAX_POINTS = 10_000  # maximum number of points
FONT_SIZE = 32  # size at which each character of a font looks different from the others [pixels]
NO_CHARACTER = "\uffff"  # Unicode guarantees that this is no character, so no font has it
EDGE = 1e-9  # by how much a point must be inside a shape, so that rounding does not take sides
FORMS = ("ring", "disc", "cross", "square")

PatternPoints = tuple["Floats", "Floats"]


class Pattern(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="type"):
    """The base of all patterns. u and v are the axes of the pattern's plane, and 0, 0 is its origin.

    name: its label; the type by default. Numbers may be lists, which are swept. Raises ArgumentError.
    """

    whole: ClassVar[tuple[str, ...]] = ()
    """Fields that are lists, not sweeps."""

    drawn: ClassVar[bool] = False
    """Whether the pattern is random."""

    name: str = ""

    def make(self, rng: np.random.Generator) -> PatternPoints:
        """Return points [m], (M, 2), and proportions, (M,), not negative; rng: of the study, for this pattern.

        Raises ArgumentError.
        """
        uv, proportions = self._make(rng)
        if len(uv) > MAX_POINTS:
            raise ArgumentError("pattern", f"has {len(uv)} points: more than {MAX_POINTS}")
        if not proportions.any():
            raise ArgumentError("pattern", "is silent: none of its points has a target")
        return uv, proportions

    def _make(self, rng: np.random.Generator) -> PatternPoints:
        raise NotImplementedError


class Focus(Pattern, frozen=True, tag="focus"):
    """One point."""

    def _make(self, rng: np.random.Generator) -> PatternPoints:
        return np.zeros((1, 2)), np.ones(1)


class Circle(Pattern, frozen=True, tag="circle"):
    """Points evenly spaced on a circle."""

    radius: Number
    count: Count

    def __post_init__(self) -> None:
        check_each("radius", self.radius, check_length)
        check_each("count", self.count, _some)

    def _make(self, rng: np.random.Generator) -> PatternPoints:
        angle = 2.0 * math.pi / check_single(self.count) * np.arange(check_single(self.count))
        uv = check_single(self.radius) * np.column_stack([np.cos(angle), np.sin(angle)])
        return uv, np.ones(len(uv))


class PointGrid(Pattern, frozen=True, tag="grid"):
    """`columns` x `rows` points, `pitch` apart [m]."""

    columns: Count
    rows: Count
    pitch: Number

    def __post_init__(self) -> None:
        check_each("columns", self.columns, _some)
        check_each("rows", self.rows, _some)
        check_each("pitch", self.pitch, check_length)

    def _make(self, rng: np.random.Generator) -> PatternPoints:
        counts = check_single(self.columns), check_single(self.rows)
        u, v = (check_single(self.pitch) * (np.arange(n) - (n - 1) / 2.0) for n in counts)
        U, V = np.meshgrid(u, v)
        return np.column_stack([U.ravel(), V.ravel()]).astype(np.float64), np.ones(U.size)


class Letters(Pattern, frozen=True, tag="letters"):
    """A line of text in dots. A capital letter is `height` high [m], or `dots` dots. The font is Pillow's default."""

    text: Word
    height: Number = 0.06
    dots: Count = 8

    def __post_init__(self) -> None:
        check_each("text", self.text, _check_printable)
        check_each("height", self.height, check_length)
        check_each(
            "dots", self.dots, lambda n, v: check_number(n, check_integer(n, v, low=5), high=64)
        )

    def _make(self, rng: np.random.Generator) -> PatternPoints:
        dots = _dots(check_single(self.text), check_single(self.dots))
        v, u = np.nonzero(dots[::-1])
        uv = np.column_stack([u, v]).astype(np.float64)
        uv -= (uv.min(axis=0) + uv.max(axis=0)) / 2.0
        return uv * check_single(self.height) / (check_single(self.dots) - 1), np.ones(len(uv))


class RandomPoints(Pattern, frozen=True, tag="random"):
    """Random points in a square of `side` [m], with proportions `low` to 1; each seed gives another draw."""

    drawn: ClassVar[bool] = True

    count: Count
    side: Number = 0.2
    low: Number = 0.3
    seed: Count = 0

    def __post_init__(self) -> None:
        check_each("count", self.count, _some)
        check_each("side", self.side, check_length)
        check_each("low", self.low, lambda n, v: check_number(n, v, low=0.0, high=1.0, above=True))
        check_each("seed", self.seed, lambda n, v: check_integer(n, v, low=0))

    def _make(self, rng: np.random.Generator) -> PatternPoints:
        half, count = check_single(self.side) / 2.0, check_single(self.count)
        return rng.uniform(-half, half, (count, 2)), rng.uniform(check_single(self.low), 1.0, count)


class Shape(Pattern, frozen=True, tag="shape"):
    """One of the paper's patterns, on a lattice over a square of `side` [m]: 1 inside, silence outside.

    form: with u and v in -1..1 over the square and r = hypot(u, v), "ring" (|r - 0.5| < 0.08), "disc" (r < 0.3),
    "cross" (|u| or |v| < 0.06, both < 0.6), "square" (|max(|u|, |v|) - 0.5| < 0.08).
    """

    form: Word
    side: Number = 0.4
    pitch: Number = 0.01

    def __post_init__(self) -> None:
        check_each("form", self.form, _form)
        check_each("side", self.side, check_length)
        check_each("pitch", self.pitch, check_length)

    def _make(self, rng: np.random.Generator) -> PatternPoints:
        side = check_single(self.side)
        count = 1 + round(side / check_single(self.pitch))
        line = np.linspace(-1.0, 1.0, count)
        v, u = np.meshgrid(line, line, indexing="ij")
        r, far = np.hypot(u, v), np.maximum(np.abs(u), np.abs(v))
        asked = {
            "ring": np.abs(r - 0.5) < 0.08 - EDGE,
            "disc": r < 0.3 - EDGE,
            "cross": (np.minimum(np.abs(u), np.abs(v)) < 0.06 - EDGE) & (far < 0.6 - EDGE),
            "square": np.abs(far - 0.5) < 0.08 - EDGE,
        }[check_single(self.form)]
        return side / 2.0 * np.column_stack([u.ravel(), v.ravel()]), asked.ravel().astype(float)


class Points(Pattern, frozen=True, tag="points"):
    """Any points (u, v) [m], with `proportions`, which are equal by default."""

    whole: ClassVar[tuple[str, ...]] = ("points", "proportions")

    points: tuple[tuple[float, float], ...]
    proportions: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not 1 <= len(self.points) <= MAX_POINTS:
            raise ArgumentError("points", f"must be 1 to {MAX_POINTS}, not {len(self.points)}")
        if self.proportions and len(self.proportions) != len(self.points):
            raise ArgumentError("proportions", f"must be {len(self.points)}, as many as points")
        self.make(np.random.default_rng(0))

    def _make(self, rng: np.random.Generator) -> PatternPoints:
        uv = check_numbers("points", self.points, (None, 2))
        if not self.proportions:
            return uv, np.ones(len(uv))
        share = check_numbers("proportions", self.proportions, (len(uv),))
        if share.min() < 0.0:
            raise ArgumentError("proportions", "must be 0 or more")
        return uv, share


AnyPattern = Focus | Circle | PointGrid | Letters | RandomPoints | Shape | Points


def _dots(text: str, height: int) -> Dots:
    """Return a line of text as rows of dots, with capital letters `height` rows high."""
    from PIL import ImageFont

    fonts = (ImageFont.load_default(size) for size in range(height, 3 * height))
    font = next(f for f in fonts if _tall(f.getbbox("H")) >= height)
    return _draw(text, font)


def _draw(text: str, font: FreeTypeFont | ImageFont) -> Dots:
    """Return a line of text as rows of dots, without empty rows around it."""
    from PIL import Image, ImageDraw

    left, top, right, bottom = font.getbbox(text)
    picture = Image.new("1", (math.ceil(right - left), math.ceil(bottom - top)))
    draw = ImageDraw.Draw(picture)
    draw.fontmode = "1"
    draw.text((-left, -top), text, fill=1, font=font)
    return np.asarray(picture, dtype=np.bool_)


def _tall(box: tuple[float, float, float, float]) -> float:
    return box[3] - box[1]


def _check_printable(name: str, text: str) -> None:
    if not (text.isprintable() and text.strip() and len(text) <= 40):
        raise ArgumentError(name, f"must be 1 to 40 characters on one line, not {text!r}")
    if missing := _find_missing(text):
        raise ArgumentError(
            name, f"has {missing!r}, which Pillow's default font lacks: leave it out"
        )


def _find_missing(text: str) -> str:
    """Return the first character that the font would replace by a box, or ""."""
    from PIL import ImageFont

    font = ImageFont.load_default(FONT_SIZE)
    box = _draw(NO_CHARACTER, font)
    return next((c for c in text if c != " " and np.array_equal(_draw(c, font), box)), "")


def _form(name: str, form: str) -> None:
    if form not in FORMS:
        raise ArgumentError(name, f"must be one of {', '.join(FORMS)}, not {form!r}")


def _some(name: str, value: float) -> None:
    if check_integer(name, value, low=1) > MAX_POINTS:
        raise ArgumentError(name, f"must be at most {MAX_POINTS}, not {value}")
