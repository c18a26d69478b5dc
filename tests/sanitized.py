"""A pytest plug-in that imports the kernels that `native_build.build(sanitize=CHECKS)` has compiled."""

from __future__ import annotations

import importlib.util
import sys
import sysconfig
from importlib.abc import MetaPathFinder
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType

CHECKS = "address,undefined"
ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "build" / f"native-{CHECKS.replace(',', '-')}"
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
