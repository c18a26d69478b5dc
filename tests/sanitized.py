"""A pytest plug-in that imports kernels with sanitizers, from the folder that `PACINIAN_SANITIZED` names.

`core/test_sanitized_kernels.py` compiles them, and starts pytest with this plug-in.
"""

from __future__ import annotations

import importlib.util
import os
import sys
import sysconfig
from importlib.abc import MetaPathFinder
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType

FOLDER = Path(os.environ["PACINIAN_SANITIZED"])
NAME = "_plain"  # the variant that is compiled with them
PACKAGES = {"pacinian.native": "core", "pacinian_plugins.native": "plugins"}


class SanitizedKernels(MetaPathFinder):
    """Finds the kernels with sanitizers instead of those that are installed."""

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return where the kernels of a package are; None for all other modules."""
        package, _, last = name.rpartition(".")
        if last != NAME or package not in PACKAGES:
            return None
        folder = FOLDER / PACKAGES[package] / package.replace(".", "/")
        file = folder / f"{NAME}{sysconfig.get_config_var('EXT_SUFFIX')}"
        return importlib.util.spec_from_file_location(name, file)


sys.meta_path.insert(0, SanitizedKernels())
