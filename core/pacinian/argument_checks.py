"""Validation of arguments at the public interface. Each error names the argument and the fix."""

from __future__ import annotations

import math
import operator
from typing import TYPE_CHECKING, cast

import numpy as np

from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.types import ArrayLike, Floats

MAX_SAMPLES = 20e6  # samples of one object
MAX_LENGTH = 10.0  # largest plausible length, and distance from the array [m]
HEAD_RADIUS = 0.12  # of a ball that holds a head and its ears [m]
MAX_ANGLE = 2.0 * math.pi * (1.0 + 1e-9)  # largest angle, one turn and rounding [rad]


def check_numbers(name: str, value: ArrayLike, shape: tuple[int | None, ...]) -> Floats:
    """Return `value` as finite float64 of the given shape, where None allows any length. Raises ArgumentError."""
    refuse_masked(name, value)
    try:
        array = np.asarray(value)
        if array.dtype != np.float64 and array.dtype.kind not in "biufO" and array.size:
            raise ArgumentError(name, f"must be real numbers, not {array.dtype}")
        array = array.astype(np.float64, copy=False)
    except (TypeError, ValueError, OverflowError) as error:
        if isinstance(error, ArgumentError):
            raise
        raise ArgumentError(name, f"must be numbers: {error}") from None
    if array.shape == (0,) and shape == (None, 3):
        array = array.reshape(0, 3)
    fits = array.ndim == len(shape) and all(
        want is None or want == have for want, have in zip(shape, array.shape, strict=True)
    )
    if not fits:
        wanted = ", ".join("any" if n is None else str(n) for n in shape) + "," * (len(shape) == 1)
        raise ArgumentError(name, f"must have shape ({wanted}), not {array.shape}")
    if not np.isfinite(array).all():
        raise ArgumentError(name, "must be finite, without NaN or infinity")
    return array


def refuse_masked(name: str, value: object) -> None:
    """Refuse an array of `numpy.ma` that hides values, or a list of such, because NumPy would use these values.

    Raises ArgumentError.
    """
    several = isinstance(value, (list, tuple))
    for part in cast("Sequence[object]", value) if several else (value,):
        if hasattr(part, "filled") and np.any(getattr(part, "mask", False)):
            raise ArgumentError(name, "has masked values: leave these out, or fill them")


def check_real(name: str, value: object) -> Floats:
    """Return what a user's function has returned as float64, not always finite. Raises ArgumentError."""
    array = np.asarray(value)
    if array.dtype.kind in "cSU":
        raise ArgumentError(name, f"must return real numbers, not {array.dtype}")
    try:
        return array.astype(np.float64, copy=False)
    except (TypeError, ValueError) as error:
        raise ArgumentError(name, f"must return numbers: {error}") from None


def check_number(
    name: str, value: float, *, low: float = -math.inf, high: float = math.inf, above: bool = False
) -> float:
    """Return `value` as a finite float in [low, high]; `above` excludes `low`. Raises ArgumentError."""
    try:
        result = float(value)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(name, f"must be a number, not {value!r}") from None
    if not math.isfinite(result):
        raise ArgumentError(name, f"must be finite, not {result}")
    if result < low or result > high or (above and result == low):
        bound = f"more than {low:g}" if above else f"{low:g} or more"
        upper = "" if high == math.inf else f" and at most {high:g}"
        raise ArgumentError(name, f"must be {bound}{upper}, not {result:g}")
    return result


def check_near(name: str, points: Floats, origin: Floats) -> None:
    """Refuse `points`, shape (M, 3) [m], that are so far away that millimetres were meant. Raises ArgumentError."""
    if not len(points):
        return
    away = np.minimum(np.abs(points - origin), 1e150)  # [m]
    distance = float(np.sqrt((away * away).sum(axis=1).max()))  # [m]
    if distance > MAX_LENGTH:
        raise ArgumentError(
            name,
            f"reach {distance:.4g} m from the array's centre, more than {MAX_LENGTH:g} m: "
            "lengths are in metres (were millimetres given?)",
        )


def check_length(name: str, value: float) -> float:
    """Return a positive length [m], unless it is so large that millimetres were meant. Raises ArgumentError."""
    result = check_number(name, value, low=0.0, above=True)
    if result > MAX_LENGTH:
        raise ArgumentError(name, f"is {result:g} m: lengths are in metres (millimetres given?)")
    return result


def check_angle(name: str, value: float) -> float:
    """Return an angle [rad], unless it is more than a turn, so that degrees were meant. Raises ArgumentError."""
    result = check_number(name, value)
    if abs(result) > MAX_ANGLE:
        raise ArgumentError(
            name,
            f"is {result:g}, more than a turn (2 pi): angles are in radians; use math.radians(...) for degrees",
        )
    return result


def check_integer(name: str, value: float, *, low: int) -> int:
    """Return `value` as an int of at least `low`. Raises ArgumentError."""
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        whole = isinstance(value, float) and value.is_integer()
        result = int(value) if whole else operator.index(cast("int", value))
    except TypeError:
        result = low - 1
    if result < low:
        raise ArgumentError(name, f"must be a whole number of at least {low}, not {value!r}")
    return result


def check_kind(name: str, value: object, *kinds: type) -> None:
    """Refuse a `value` that is not an instance of `kinds`. Raises ArgumentError."""
    if not isinstance(value, kinds):
        *most, last = (k.__name__ for k in kinds)
        wanted = f"{', '.join(most)} or {last}" if most else last
        article = "an" if wanted[0] in "AEIOU" else "a"
        raise ArgumentError(name, f"must be {article} {wanted}, not {value!r}")


def check_count(measure: float, spacing: float, dimension: int) -> float:
    """Return the number of samples, `spacing` [m] apart, that cover `measure` [m^dimension].

    Raises ArgumentError if there are more than 20 million.
    """
    try:
        samples = measure / spacing**dimension
    except (ZeroDivisionError, OverflowError):
        samples = math.inf
    if not samples <= MAX_SAMPLES:
        raise ArgumentError(
            "spacing", f"of {spacing:g} m makes {samples:g} samples: choose a larger one"
        )
    return samples


def check_names(name: str, given: object) -> tuple[str, ...]:
    """Return distinct names from a list, or from a comma-separated string of a client. Raises ArgumentError."""
    parts = given.split(",") if isinstance(given, str) else given
    if isinstance(parts, (list, tuple)) and all(isinstance(part, str) for part in parts):
        made = tuple(part.strip() for part in parts)
        if made == ("",):
            return ()
        if len(set(made)) == len(made) and (all(made) or not isinstance(given, str)):
            return made
    raise ArgumentError(name, f'must be different names, as ["A", "B"] or "A, B", not {given!r}')
