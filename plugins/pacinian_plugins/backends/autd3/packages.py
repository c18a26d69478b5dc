"""The AUTD3 project's packages, which are optional."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import pacinian as pc

NAME = "autd3"


def import_package(name: str) -> Any:
    """One of the packages. Raises MissingExtra."""
    try:
        return import_module(name)
    except ImportError as error:
        raise pc.MissingExtra(name.replace("_", "-"), "autd3") from error
