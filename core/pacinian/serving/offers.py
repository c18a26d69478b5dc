"""What can be selected: plug-ins by name, with their simple settings."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

import msgspec

from pacinian.errors import plain
from pacinian.plugins import registry
from pacinian.wire.replies import Plugin

if TYPE_CHECKING:
    from pacinian.plugins.registry import Kind, Offer

LOADING = threading.Lock()  # plug-ins are found by one thread at a time


def offers(kind: Kind) -> tuple[Plugin, ...]:
    """The installed plug-ins of a kind; all are imported."""
    plugins = registry.installed()
    with LOADING:
        plugins.load()
    return tuple(
        Plugin(
            name=offer.name,
            summary=plain(str(offer.cls.__doc__ or "").strip().partition("\n")[0])[:200],
            options=_options(offer),
        )
        for _, offer in sorted(plugins.offers.items())
        if offer.kind == kind
    )


def _options(offer: Offer) -> dict[str, int | float | str]:
    """Its simple settings; none of one of which they cannot be read, or told."""
    try:
        found = {k: v for k, v in offer.options.items() if isinstance(v, int | float | str)}
        msgspec.msgpack.encode(found)
    except Exception:  # whatever a plug-in does, the process starts
        return {}
    return found
