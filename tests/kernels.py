"""Compile the kernels whose compiled form is missing or old, on all cores, before the tests need them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCES = ROOT / "core", ROOT / "plugins"
IMPORT = "import importlib, sys\nfor name in sys.argv[1:]: importlib.import_module(name)"


def find_stale() -> dict[str, list[Path]]:
    """The modules with kernels that Numba may have to compile, and what is kept of them."""
    found = {}
    for root in SOURCES:
        for path in root.rglob("*.py"):
            if "\n@compiled(" in path.read_text("utf-8"):
                kept = list((path.parent / "__pycache__").glob(f"{path.stem}.*.nbi"))
                if not kept or min(k.stat().st_mtime for k in kept) < path.stat().st_mtime:
                    found[".".join(path.relative_to(root).with_suffix("").parts)] = kept
    return found


def compile_stale() -> None:
    """Import those modules, each core its share. What fails is left to the tests, which tell it better."""
    stale, cores = find_stale(), os.cpu_count() or 1
    names = sorted(stale)
    shares = [share for i in range(cores) if (share := names[i::cores])]
    for process in [subprocess.Popen([sys.executable, "-c", IMPORT, *share]) for share in shares]:
        process.wait()
    for path in (path for kept in stale.values() for path in kept if path.exists()):
        path.touch()  # Numba has compared the sources, and does not write what is still right
