"""The peers' Python environments: one for each peer, built by `.ci/peers`."""

from __future__ import annotations

import os
import sys
from pathlib import Path

PEERS = ("autd3", "acoustools", "levitate")
VARIABLE = "PACINIAN_PEERS"


def find_folder() -> Path:
    """Return the folder of the environments: `$PACINIAN_PEERS`, or `pacinian/peers` in the user's cache."""
    if given := os.environ.get(VARIABLE):
        return Path(given)
    home = Path.home()
    if sys.platform == "win32":
        cache = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    elif sys.platform == "darwin":
        cache = home / "Library" / "Caches"
    else:
        cache = Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache")
    return cache / "pacinian" / "peers"


def find_python(root: Path, peer: str) -> Path | None:
    """Return the Python of a peer's environment, or None if it has not been built."""
    for place in ("bin/python", "Scripts/python.exe"):
        if (found := root / peer / place).exists():
            return found
    return None


def describe_missing(root: Path, missing: list[str]) -> str:
    """Return a message that explains how to build missing environments."""
    return (
        f"no environment for {', '.join(missing)} in {root}: "
        f"build it with `.ci/peers {root}` (docs/benchmark.md)"
    )
