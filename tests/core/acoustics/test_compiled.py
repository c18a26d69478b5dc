"""What compiled kernels may assume of their numbers."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

import numba

from pacinian.acoustics import compiled as compiling
from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    import pytest

SOURCE = """
def kernel(x, y):
    z = complex(x, y)
    size = x**2 + math.hypot(x, y) + abs(z) + abs(z * z) + abs(z / (z + 1.0))
    if size > 0.0:
        return 1.0
    elif size != 0.0:
        return math.inf
    return 0.0
"""


def made(finite: bool) -> Any:
    """Of no file, so that it is compiled each time."""
    names: dict[str, Any] = {"math": math}
    exec(SOURCE, names)
    return compiled("f8(f8, f8)", finite=finite)(names["kernel"])


def assumed(kernel: Any) -> bool:
    """Whether there is any operation that may take its numbers for finite."""
    (code,) = kernel.inspect_llvm().values()
    return re.search(r"\b(fast|nnan|ninf)\b", code) is not None  # fast: all of LLVM's flags


def test_only_kernels_of_finite_numbers_assume_them_though_one_was_compiled_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(compiling, "helpers", {True: {}, False: {}})
    assert assumed(made(True))
    careful = made(False)
    assert not assumed(careful)
    assert [careful(x, 0.0) for x in (0.0, 1.0, math.nan)] == [0.0, 1.0, math.inf]
    names: dict[str, Any] = {"math": math}
    exec(SOURCE, names)
    assert not assumed(numba.njit("f8(f8, f8)")(names["kernel"]))  # functions of others
