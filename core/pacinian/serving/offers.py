"""What can be selected: plug-ins by name, with their simple settings."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from pacinian.plugins import registry
from pacinian.wire.replies import Plugin

if TYPE_CHECKING:
    from pacinian.plugins.registry import Kind

LOADING = threading.Lock()  # plug-ins are found by one thread at a time


def offers(kind: Kind) -> tuple[Plugin, ...]:
    """The installed plug-ins of a kind; all are imported."""
    plugins = registry.installed()
    with LOADING:
        plugins.load()
    return tuple(
        Plugin(
            name=offer.name[:64],
            summary=(offer.cls.__doc__ or "").strip().partition("\n")[0][:200],
            options={k: v for k, v in offer.options.items() if isinstance(v, int | float | str)},
        )
        for _, offer in sorted(plugins.offers.items())
        if offer.kind == kind
    )
