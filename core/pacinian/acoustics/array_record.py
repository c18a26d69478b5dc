"""Convert an array to and from plain values of a file, apart from positions and normals."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.array import Array
from pacinian.acoustics.directivity import DIRECTIVITIES, DirectivityTable, Piston
from pacinian.acoustics.transducer import Transducer

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import Floats


def to_map(array: Array) -> dict[str, Any]:
    """Return the transducers' type and responses as plain values; None for a user's own directivity.

    A user's own directivity is a Python function, which cannot be read back; `DirectivityTable.sample` converts it.
    """
    kind, response = array.transducer, array.response
    return {
        "transducer": {
            "frequency": kind.frequency,
            "pressure": kind.pressure,
            "directivity": _describe_directivity(kind.directivity),
        },
        "response": None if response is None else response.astype("<c16").tobytes(),
    }


def from_map(settings: dict[str, Any], positions: Floats, normals: Floats) -> Array:
    """Return the array; omnidirectional if the directivity is missing. Damaged values raise any Exception."""
    transducer: dict[str, Any] = settings["transducer"]
    kind = Transducer(
        frequency=transducer["frequency"],
        pressure=transducer["pressure"],
        directivity=_make_directivity(transducer["directivity"]),
    )
    given = settings.get("response")
    response = None if given is None else np.frombuffer(given, "<c16")
    array = Array(positions, normals, kind, response)
    object.__setattr__(array, "normals", normals)  # bit for bit, without normalising again
    return array


def _describe_directivity(D: Callable[[Floats], Floats]) -> dict[str, Any] | str | None:
    if isinstance(D, Piston):
        return asdict(D)
    if isinstance(D, DirectivityTable):
        return {"angles": list(D.angles), "values": list(D.values)}
    return next((name for name, function in DIRECTIVITIES.items() if function is D), None)


def _make_directivity(record: dict[str, Any] | str | None) -> Callable[[Floats], Floats]:
    if isinstance(record, dict):
        return DirectivityTable(**record) if "angles" in record else Piston(**record)
    return DIRECTIVITIES["omni" if record is None else record]
