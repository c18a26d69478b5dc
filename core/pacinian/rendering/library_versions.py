"""What frames depend on besides the scene: versions and variants of the libraries that compute them."""

from __future__ import annotations

import importlib.metadata
import platform

import numpy as np
from threadpoolctl import threadpool_info

from pacinian.native import VARIANT


def list_versions() -> dict[str, str]:
    """Return versions of Pacinian and of what computes for it, the variant of the kernels, and that of BLAS."""
    blas = {
        f"{library['internal_api']} {library['version']} {library.get('architecture', '')}".rstrip()
        for library in threadpool_info()
        if library["user_api"] == "blas"
    }
    return {
        "Pacinian": importlib.metadata.version("pacinian"),
        "kernels": VARIANT,
        "Python": platform.python_version(),
        "NumPy": np.__version__,
        "SciPy": importlib.metadata.version("scipy"),
        "BLAS": ", ".join(sorted(blas)),
        "processor": platform.machine(),
    }


def compare_versions(before: dict[str, str], now: dict[str, str]) -> tuple[str, ...]:
    """Return in words what differs between two lists."""
    names = [*before, *(name for name in now if name not in before)]
    return tuple(
        f"{name}: {before.get(name, 'unknown')} when recorded, {now.get(name, 'unknown')} now"
        for name in names
        if before.get(name) != now.get(name)
    )
