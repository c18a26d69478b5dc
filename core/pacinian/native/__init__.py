"""Compiled C++ kernels, in the best variant that this processor can run.

Each group of kernels is a module: `from pacinian.native import acoustics`. The sources lie beside the Python code that
calls them (`acoustics/kernels.hpp`), and their signatures in stubs in this package. Here are `views.hpp` (arrays as
kernels see them), `math.hpp`, `processor.hpp` (what this processor can do), and the modules `module.cpp` and
`non_finite.cpp` (kernels that may meet NaN). The environment variable
`PACINIAN_VARIANT` selects a lower variant, so that tests can run every variant, and different machines can produce
bit-identical results.
"""

from __future__ import annotations

import importlib
import os
import sys
from types import ModuleType

VARIANTS = {"_v4": 4, "_v3": 3, "_plain": 0}
"""Names of the variants, best first, with the x86-64 level that each needs (AVX-512; AVX2 and FMA; none)."""
CHOICE = "PACINIAN_VARIANT"


def list_runnable() -> list[str]:
    """Return the names of the variants that this processor can run, best first. Raises ImportError."""
    level: int = load(__name__, "_plain").level()
    return [name for name, needed in VARIANTS.items() if needed <= level]


def publish(package: str) -> str:
    """Publish the best variant's groups of kernels as submodules of a package. Return its name. Raises ImportError."""
    names = [name.lstrip("_") for name in list_runnable()]
    chosen = os.environ.get(CHOICE, "") or names[0]
    if chosen not in names:
        raise ImportError(f"{CHOICE} must be one of {', '.join(names)}, not {chosen!r}")
    for group, module in vars(load(package, f"_{chosen}")).items():
        if isinstance(module, ModuleType):
            setattr(sys.modules[package], group, module)
            sys.modules[f"{package}.{group}"] = module
    return chosen


def load(package: str, name: str) -> ModuleType:
    """Import one variant of a package's kernels. Raises ImportError."""
    try:
        return importlib.import_module(f"{package}.{name}")
    except ModuleNotFoundError as error:
        if error.name != f"{package}.{name}":
            raise
        raise ImportError(
            f"the kernels of {package} are not compiled for this Python: install Pacinian again, with "
            "`python -m pip install .` in its folder"
        ) from error


VARIANT = publish(__name__)
"""Variant in use: "v4", "v3" or "plain"."""
