"""Plug-ins by name: list those that can be selected, and create them with options from configuration and clients."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

import msgspec

from pacinian.errors import PluginError, describe_error, shorten
from pacinian.plugins import registry
from pacinian.plugins.options import check_options, find_client_options
from pacinian.serving.ipc.logs import log
from pacinian.wire.control import Choice
from pacinian.wire.replies import Plugin

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.plugins.backend import Backend
    from pacinian.plugins.registry import Kind, Offer
    from pacinian.plugins.solver import Solver
    from pacinian.scene.config_sections import PluginConfig

# held by the one thread that imports plug-ins, so that others do not wait for an import without a limit
LOADING = threading.Lock()
# Longest wait for the list of all plug-ins [s].
MAX_LISTING_TIME = 20.0
MAX_IMPORT_WAIT = 4.0  # longest wait for the import of plug-ins in another thread [s]


def publish_offers(kind: Kind, publish: Callable[[tuple[Plugin, ...]], object]) -> None:
    """Call `publish` with `list_offers`, now or from a thread.

    If a module takes longer than `MAX_LISTING_TIME` to import, `publish` first gets the plug-ins that are known by
    then, and the log names the module.
    """
    lock, done = threading.Lock(), threading.Event()

    def work() -> None:
        try:
            offers = list_offers(kind)
        except BaseException as error:  # a plug-in's module can raise anything
            log().error("not all plug-ins could be listed", kind=kind, error=describe_error(error))
            offers = _collect_offers(kind)
        with lock:
            done.set()
            publish(offers)

    thread = threading.Thread(target=work, name="plug-ins", daemon=True)
    try:
        thread.start()
    except RuntimeError:  # no more threads
        work()
        return
    thread.join(MAX_LISTING_TIME)
    with lock:
        if not done.is_set():
            name = registry.discover_plugins().importing
            log().warning("a plug-in is still being imported", name=name, kind=kind)
            publish(_collect_offers(kind))


def list_offers(kind: Kind) -> tuple[Plugin, ...]:
    """Return the installed plug-ins of a kind. Imports all modules that may offer one."""
    plugins = registry.discover_plugins()
    with LOADING:
        plugins.load(kind=kind)
    for error in (*plugins.clashes.values(), *plugins.shadowed.values()):
        log().warning("several plug-ins have one name", error=describe_error(error))
    return _collect_offers(kind)


def _collect_offers(kind: Kind) -> tuple[Plugin, ...]:
    plugins = registry.discover_plugins()
    return tuple(
        Plugin(
            name=offer.name,
            summary=shorten(str(offer.cls.__doc__ or "").strip().partition("\n")[0])[:200],
            options=_list_options(offer),
        )
        for _, offer in sorted(plugins.offers.copy().items())
        if offer.kind == kind and offer.name not in plugins.clashes
    )


def make_plugin(
    kind: Kind, choice: PluginConfig | Choice, configured: PluginConfig | Choice
) -> Solver | Backend:
    """Create a plug-in as configured, or as a client chooses it.

    A client's options are added to the configured ones if the configuration names the same plug-in. Raises
    UnknownPlugin, PluginError; ArgumentError also for options that no client may set.
    """
    offer, options = find_plugin(kind, choice.name), dict(choice.options)
    if isinstance(choice, Choice):
        asked = check_options(offer.cls, options)
        options = {**(configured.options if configured.name == choice.name else {}), **asked}
    return registry.discover_plugins().make(kind, choice.name, options)


def find_plugin(kind: Kind, name: str) -> Offer:
    """Return the plug-in of that name; import it if necessary. Raises UnknownPlugin, PluginError."""
    plugins = registry.discover_plugins()
    if offer := plugins.find_loaded(kind, name):
        return offer
    if not LOADING.acquire(timeout=MAX_IMPORT_WAIT):
        raise PluginError(
            f"the server cannot search for {name!r} while it imports the plug-in {plugins.importing!r}: try again, "
            f"or uninstall {plugins.importing!r}"
        )
    try:
        return plugins.find(kind, name)
    finally:
        LOADING.release()


def _list_options(offer: Offer) -> dict[str, int | float | str]:
    """Return the simple options that clients may set; none if they cannot be read or encoded."""
    try:
        allowed, given = find_client_options(offer.cls), offer.options
        found = {
            k: v for k, v in given.items() if k in allowed and isinstance(v, int | float | str)
        }
        msgspec.msgpack.encode(found)
    except Exception:  # whatever a plug-in does, the process must start
        return {}
    return found
