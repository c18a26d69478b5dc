"""BLAS and LAPACK of SciPy, loaded without the rest of SciPy (decision 52).

`scipy.linalg` takes 18 MB and 0.15 s, of which the two compiled modules that it takes these functions from are 2 MB and
10 ms. If SciPy keeps them elsewhere, `scipy.linalg` is loaded.
"""

from __future__ import annotations

import sys
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import ModuleType

    from scipy.linalg import blas, lapack
else:

    def _load(name: str) -> ModuleType | None:
        """Load a compiled module of `scipy.linalg`, which takes it over if it is loaded later; None if that fails."""
        whole = f"scipy.linalg.{name}"
        if whole in sys.modules:
            return sys.modules[whole]
        package = find_spec("scipy")
        if package is None:
            return None
        folders = [str(Path(path) / "linalg") for path in package.submodule_search_locations or ()]
        spec = PathFinder.find_spec(whole, folders)
        if spec is None or spec.loader is None:
            return None
        try:
            module = module_from_spec(spec)
            spec.loader.exec_module(module)
        except ImportError:  # for example, its libraries are found by `scipy` only
            return None
        return sys.modules.setdefault(whole, module)

    blas, lapack = _load("_fblas"), _load("_flapack")
    if blas is None or lapack is None:
        from scipy.linalg import blas, lapack

__all__ = ["blas", "lapack"]
