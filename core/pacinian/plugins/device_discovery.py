"""Discovery of connected devices through the installed backends."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from pacinian.errors import describe_error
from pacinian.plugins.backend import FoundDevice
from pacinian.plugins.registry import describe_plugin_error

if TYPE_CHECKING:
    from pacinian.plugins.backend import Backend
    from pacinian.plugins.registry import Plugins

TWICE = "another one has this serial, so neither can be chosen by it: unplug one"


def list_connected(plugins: Plugins, backend: str = "") -> list[FoundDevice]:
    """List the devices that are connected now, sorted by backend and serial.

    backend: the backend to ask; all of them if empty. A backend that does not load or cannot search is listed as a
    problem, and so are two devices with the same serial. Plug-ins that offer no backend are not imported. Raises
    UnknownPlugin and PluginError for a `backend` that is given.
    """
    found: list[FoundDevice] = []
    if backend:
        plugins.find("backend", backend)
    else:
        plugins.load(kind="backend")
        broken = {**plugins.failed, **plugins.clashes}
        found += [
            FoundDevice(name, "", "", describe_error(error))
            for name, error in sorted(broken.items())
        ]
    for (kind, name), offer in sorted(plugins.offers.items()):
        if kind == "backend" and backend in ("", name):
            found += _ask(cast("type[Backend]", offer.cls))
    keys = [(f.backend, f.serial) for f in found]
    return [
        FoundDevice(f.backend, f.serial, f.title, f.problem or TWICE)
        if f.serial and keys.count((f.backend, f.serial)) > 1
        else f
        for f in found
    ]


def _ask(backend: type[Backend]) -> list[FoundDevice]:
    try:
        return sorted(backend.find_devices(), key=lambda f: f.serial)
    except (Exception, SystemExit) as error:  # it must not hide the devices of the others
        problem = f"this backend cannot look for its devices: {describe_plugin_error(error)}"
        return [FoundDevice(backend.name, "", "", problem)]
