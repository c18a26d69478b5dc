"""What is connected: every installed backend is asked."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from pacinian.errors import describe_error
from pacinian.plugins.backend import Found

if TYPE_CHECKING:
    from pacinian.plugins.backend import Backend
    from pacinian.plugins.registry import Plugins

TWICE = "another one has this serial, so neither can be chosen by it: unplug one"


def list_connected(plugins: Plugins, backend: str = "") -> list[Found]:
    """Devices that are connected now, by backend and serial; of one backend, or of all.

    A backend that does not load or fails to look is told of as a problem; two of one serial are, too. Plug-ins that
    offer no backend are not imported. Raises UnknownPlugin and PluginError for a backend that is named.
    """
    found: list[Found] = []
    if backend:
        plugins.find("backend", backend)
    else:
        plugins.load(kind="backend")
        broken = {**plugins.failed, **plugins.clashes}
        found += [
            Found(name, "", "", describe_error(error)) for name, error in sorted(broken.items())
        ]
    for (kind, name), offer in sorted(plugins.offers.items()):
        if kind == "backend" and backend in ("", name):
            found += _ask(cast("type[Backend]", offer.cls))
    keys = [(f.backend, f.serial) for f in found]
    return [
        Found(f.backend, f.serial, f.title, f.problem or TWICE)
        if f.serial and keys.count((f.backend, f.serial)) > 1
        else f
        for f in found
    ]


def _ask(backend: type[Backend]) -> list[Found]:
    try:
        return sorted(backend.found(), key=lambda f: f.serial)
    except Exception as error:  # whatever a plug-in does, the others are told
        problem = f"this backend cannot look for its devices: {describe_error(error)}"
        return [Found(backend.name, "", "", problem)]
