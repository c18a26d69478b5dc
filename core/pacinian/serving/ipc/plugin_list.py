"""What can be selected, and is made: plug-ins by name, with settings of the configuration and of clients."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

import msgspec

from pacinian.errors import shorten
from pacinian.plugins import registry
from pacinian.plugins.options import check_options, find_client_options
from pacinian.wire.control import Choice
from pacinian.wire.replies import Plugin

if TYPE_CHECKING:
    from pacinian.plugins.backend import Backend
    from pacinian.plugins.registry import Kind, Offer
    from pacinian.plugins.solver import Solver
    from pacinian.scene.file import Choice as Configured

LOADING = threading.Lock()  # plug-ins are found by one thread at a time


def list_offers(kind: Kind) -> tuple[Plugin, ...]:
    """The installed plug-ins of a kind; all that may offer such are imported."""
    plugins = registry.installed()
    with LOADING:
        plugins.load(kind=kind)
    return tuple(
        Plugin(
            name=offer.name,
            summary=shorten(str(offer.cls.__doc__ or "").strip().partition("\n")[0])[:200],
            options=_options(offer),
        )
        for _, offer in sorted(plugins.offers.items())
        if offer.kind == kind
    )


def make_plugin(
    kind: Kind, choice: Configured | Choice, configured: Configured | Choice
) -> Solver | Backend:
    """A plug-in as configured; or as a client chooses it: with the options of the configuration, if that has the same.

    Raises UnknownPlugin, PluginError; ArgumentError also for options that no client may set.
    """
    offer, options = find_plugin(kind, choice.name), dict(choice.options)
    if isinstance(choice, Choice):
        asked = check_options(offer.cls, options)
        options = {**(configured.options if configured.name == choice.name else {}), **asked}
    return registry.installed().make(kind, choice.name, options)


def find_plugin(kind: Kind, name: str) -> Offer:
    """The plug-in of a name, imported where it is not yet. Raises UnknownPlugin, PluginError."""
    plugins = registry.installed()
    if (kind, name) not in plugins.offers:
        with LOADING:
            plugins.find(kind, name)
    return plugins.find(kind, name)


def _options(offer: Offer) -> dict[str, int | float | str]:
    """What clients may set, where it is simple; none of one of which that cannot be read, or told."""
    try:
        allowed, given = find_client_options(offer.cls), offer.options
        found = {
            k: v for k, v in given.items() if k in allowed and isinstance(v, int | float | str)
        }
        msgspec.msgpack.encode(found)
    except Exception:  # whatever a plug-in does, the process starts
        return {}
    return found
