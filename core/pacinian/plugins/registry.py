"""Plug-in registry: finds Pacinian's own and third-party plug-ins by their entry points (group `pacinian`)."""

from __future__ import annotations

import functools
import importlib.metadata
import importlib.util
import inspect
import re
import sys
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.abc import InspectLoader
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, cast, get_args

import pluggy

from pacinian.errors import (
    ArgumentError,
    PacinianError,
    PluginError,
    UnknownPlugin,
    describe_error,
    shorten,
)
from pacinian.notebook import MAX_ROWS, Card, card
from pacinian.plugins import hookspecs
from pacinian.plugins.backend import Backend, Capability
from pacinian.plugins.hookspecs import CommandGroup
from pacinian.plugins.solver import Solver

if TYPE_CHECKING:
    from collections.abc import Iterable
    from importlib.metadata import EntryPoint

    import click

GROUP = "pacinian"
DISTRIBUTION = "pacinian"  # whose plug-ins no others replace
MAX_NAME = 64  # length of a plug-in's name [characters], as on the wire
Kind = Literal["solver", "backend"]
BASES: dict[Kind, type[Solver] | type[Backend]] = {"solver": Solver, "backend": Backend}


@dataclass(frozen=True)
class Offer:
    """One class that a plug-in offers.

    kind: "solver" or "backend". plugin: name of the entry point. distribution: module and distribution that ship it.
    """

    kind: Kind
    cls: type[Solver] | type[Backend]
    plugin: str
    distribution: str

    @property
    def name(self) -> str:
        """The name by which users select it."""
        return self.cls.name

    @property
    def options(self) -> dict[str, Any]:
        """Arguments of the constructor and their defaults; `...` if an argument is required."""
        parameters = inspect.signature(self.cls).parameters.values()
        return {p.name: ... if p.default is p.empty else p.default for p in parameters}


@dataclass(frozen=True)
class CommandOffer:
    """One subcommand of `pacinian` that a plug-in offers.

    plugin: name of the entry point. distribution: module and distribution that ship it. group: where `pacinian --help`
    lists it.
    """

    name: str
    command: click.Command
    plugin: str
    distribution: str
    group: CommandGroup = "develop"


_Offers: TypeAlias = tuple[list[Offer], list[CommandOffer]]


class Plugins:
    """The installed plug-ins. Any thread may use them, also while it imports a plug-in.

    entry_points: by default those of the group `pacinian`. A plug-in is imported only when it may offer what is
    requested: first the entry point of the requested name, then all others. A plug-in that does not load is recorded
    in `failed` and does not affect the others.

    If several plug-ins offer one name, a plug-in of Pacinian's own wins, or else the plug-in whose entry point has that
    name; `shadowed` records the others. If neither rule decides, `clashes` records the name of a solver or backend, and
    `find` refuses it. Of commands, the first one found is used.
    """

    def __init__(self, entry_points: Iterable[EntryPoint] | None = None) -> None:
        if entry_points is None:
            entry_points = importlib.metadata.entry_points(group=GROUP)
        self.offers: dict[tuple[Kind, str], Offer] = {}
        self.commands: dict[str, CommandOffer] = {}
        self.failed: dict[str, PluginError] = {}
        self.clashes: dict[str, PluginError] = {}
        self.shadowed: dict[str, PluginError] = {}
        """By plug-in: which of its offers are not used, because a plug-in that wins has the name."""
        # not held while a plug-in's code runs, because that may wait for another thread
        self._lock = threading.Lock()
        # each plug-in that is being imported, with the thread that does it
        self._reading: dict[tuple[str, int], None] = {}
        # of each name, those beside the first
        self._clashing: dict[tuple[Kind, str], list[Offer]] = {}
        self._searched: set[str] = set()  # kinds of which all plug-ins are loaded
        self._waiting: dict[str, EntryPoint] = {}
        for point in entry_points:
            known = self._waiting.setdefault(point.name, point)
            if known.value != point.value:
                self._choose_entry_point(known, point)
        for name in self.clashes:
            del self._waiting[name]

    def _choose_entry_point(self, known: EntryPoint, new: EntryPoint) -> None:
        """Choose one of two entry points of the same name, or record a clash."""
        name = known.name
        if not (_is_own(known) or _is_own(new)):
            self.clashes[name] = PluginError(
                f"two plug-ins are called {name!r}: {_origin(known)} and {_origin(new)}; uninstall one"
            )
            return
        used, other = (known, new) if _is_own(known) else (new, known)
        self._waiting[name] = used
        self.clashes.pop(name, None)
        self.shadowed[name] = PluginError(
            f"plug-in {name!r} ({_origin(other)}) is not used, because {_origin(used)} has that name: "
            "give its entry point another name, or uninstall it"
        )

    @property
    def importing(self) -> str:
        """The plug-in that is being imported now; empty if there is none."""
        return next((name for name, _ in reversed(self._reading.copy())), "")

    @property
    def problems(self) -> dict[str, PluginError]:
        """What is wrong with plug-ins, by name: all of `failed`, `clashes` and `shadowed`."""
        return {**self.failed, **self.clashes, **self.shadowed}

    def load(self, name: str | None = None, kind: Kind | Literal["command"] | None = None) -> None:
        """Import the plug-in of that name, or all that are not loaded yet. Records errors.

        kind: if given, import only plug-ins that may offer this kind. Threads that need the same plug-in at the same
        time all read it, and the first result counts: if one waited for another, both could wait for ever for the
        imports of each other.
        """
        with self._lock:
            points = [p for n, p in self._waiting.items() if name in (None, n)]
        for point in points:
            reader = point.name, threading.get_ident()
            if reader in self._reading or not (kind is None or _may_offer(point, kind)):
                continue  # the plug-in's own code asks for others
            found: _Offers | PluginError
            self._reading[reader] = None
            try:
                found = self._read(point)
            except (Exception, SystemExit) as error:
                found = PluginError(
                    f"plug-in {point.name!r} ({_origin(point)}) does not load: {describe_plugin_error(error)}"
                )
                found.__cause__ = error
            finally:
                del self._reading[reader]
            # if its module has not run to its end, its own code called this, and a later call reads all of it
            if not _is_initializing(point.module):
                self._record(point, found)
        if name is None:
            self._searched |= {kind} if kind else set(BASES)

    def _record(self, point: EntryPoint, found: _Offers | PluginError) -> None:
        """Record what the plug-in offers, or why it does not load, unless another thread has."""
        with self._lock:
            if self._waiting.get(point.name) is not point:
                return
            if isinstance(found, PluginError):
                self.failed[point.name] = found
            else:
                offers, commands = found
                for offer in offers:
                    self._add_offer(offer)
                for command in commands:
                    self._add_command(command, point)
            del self._waiting[point.name]  # last, as `find` reads without the lock

    def _add_offer(self, new: Offer) -> None:
        key = new.kind, new.name
        known = self.offers.setdefault(key, new)
        used, other = (new, known) if new.plugin == new.name else (known, new)
        self.offers[key] = used
        if known.cls is new.cls:
            return
        if used.plugin == used.name != other.plugin:
            if clashing := self._clashing.pop(key, []):
                self.clashes.pop(new.name, None)
            for loser in (other, *clashing):
                self._shadow(loser, new.kind, new.name, used)
        else:
            self._clashing.setdefault(key, []).append(new)
            self.clashes[new.name] = PluginError(
                f"two {new.kind}s are called {new.name!r}: "
                f"{known.cls.__module__} and {new.cls.__module__}; uninstall one"
            )

    def _add_command(self, new: CommandOffer, point: EntryPoint) -> None:
        known = self.commands.setdefault(new.name, new)
        if known.command is new.command:
            return
        used, other = (new, known) if _is_own(point) else (known, new)
        self.commands[new.name] = used
        self._shadow(other, "command", new.name, used)

    def _shadow(
        self, other: Offer | CommandOffer, kind: str, name: str, used: Offer | CommandOffer
    ) -> None:
        text = (
            f"the {kind} {name!r} of plug-in {other.plugin!r} ({other.distribution}) is not used, because "
            f"{used.distribution} has that name: give it another name, or uninstall the plug-in"
        )
        before = self.shadowed.get(other.plugin)
        self.shadowed[other.plugin] = PluginError(f"{before}; {text}" if before else text)

    @card
    def _repr_html_(self) -> Card:
        offers = self.list()
        head = "kind", "name", "settings", "shipped by"
        table = [(o.kind, o.name, _settings(o), o.distribution) for o in offers[:MAX_ROWS]]
        return Card(f"{len(offers)} plug-ins", dict(self.problems), [head, *table], len(offers))

    def _read(self, point: EntryPoint) -> _Offers:
        manager = pluggy.PluginManager(GROUP)  # one per plug-in, to tell apart what each offers
        manager.add_hookspecs(hookspecs)
        manager.register(point.load(), name=point.name)
        manager.check_pending()
        offers: list[Offer] = []
        for kind, base in BASES.items():
            hook = getattr(manager.hook, f"register_{kind}s")
            for cls in (cls for classes in hook() for cls in classes):
                if not (inspect.isclass(cls) and issubclass(cls, base)):
                    raise TypeError(
                        f"register_{kind}s must return classes derived from {base.__name__}, not {cls!r}"
                    )
                name = getattr(cls, "name", None)
                lacks = sorted(cls.__abstractmethods__)
                if lacks or not isinstance(name, str):
                    lacks += [] if isinstance(name, str) else ["name"]
                    listed = ", ".join(f"`{one}`" for one in lacks)
                    raise TypeError(f"{cls.__name__} lacks {listed} of {base.__name__}: define it")
                if not 0 < len(name) <= MAX_NAME or not name.isprintable():
                    problem = f"must be 1 to {MAX_NAME} characters that can be printed"
                    raise TypeError(f"the name of {cls.__name__} {problem}: {shorten(repr(name))}")
                offers.append(Offer(kind, cls, point.name, _origin(point)))
        commands = [
            CommandOffer(_check_command(command), command, point.name, _origin(point), group)
            for given in manager.hook.register_commands()
            for group, several in _group_commands(given)
            for command in several
        ]
        if not (offers or commands):
            raise TypeError(_explain_nothing(manager))
        return offers, commands

    def list(self) -> list[Offer]:
        """Return all offers of all plug-ins, sorted by kind and name. Raises PluginError if two share a name."""
        self.load()
        for clash in self.clashes.values():
            raise clash
        return [self.offers[key] for key in sorted(self.offers)]

    def find(self, kind: Kind, name: str) -> Offer:
        """Return the offer of that name. Raises UnknownPlugin; PluginError if it is broken or not unique.

        Imports one plug-in if its entry point has that name. Otherwise imports all that may offer it.
        """
        scopes: tuple[tuple[str | None, Kind | None], ...] = (
            (name, None),
            (None, kind),
            (None, None),
        )
        for scope in scopes:
            if self.find_loaded(kind, name) or name in self.clashes:
                break
            self.load(*scope)
        if name in self.clashes:
            raise self.clashes[name]
        if offer := self.offers.get((kind, name)):
            return offer
        if name in self.failed:
            raise self.failed[name]
        known = sorted(other for k, other in self.offers.copy() if k == kind)
        broken = f" ({', '.join(self.failed)} did not load)" if self.failed else ""
        raise UnknownPlugin(kind, name, known, broken)

    def find_loaded(self, kind: Kind, name: str) -> Offer | None:
        """Return the offer of that name if that takes no import; otherwise None."""
        offer = self.offers.get((kind, name))
        if offer is None or name in self.clashes:
            return None
        return offer if offer.plugin == name or kind in self._searched else None

    def make(self, kind: Kind, name: str, options: dict[str, Any]) -> Solver | Backend:
        """Construct the solver or backend of that name. Raises as `find`; ArgumentError for an unknown option."""
        offer = self.find(kind, name)
        if options and (unknown := set(options) - set(offer.options)):
            known = ", ".join(offer.options) or "none"
            raise ArgumentError(
                min(unknown), f"is no option of {kind} {name!r}; its options: {known}"
            )
        try:
            return offer.cls(**options)
        except PacinianError:
            raise
        except (Exception, SystemExit) as error:
            problem = f"{kind} {name!r} cannot be made: {describe_plugin_error(error)}"
            raise PluginError(problem) from error


def read_capability(backend: Backend) -> Capability:
    """Return the capability of a backend. Raises PluginError if it is not one, or if the backend cannot tell it."""
    try:
        found = cast("object", backend.capability)  # a plug-in may return anything
    except PacinianError:
        raise
    except (Exception, SystemExit) as error:
        problem = f"backend {backend.name!r} has no capability: {describe_plugin_error(error)}"
        raise PluginError(problem) from error
    if not isinstance(found, Capability):
        problem = f"must be a pacinian.Capability, not {shorten(repr(found))}"
        raise PluginError(f"backend {backend.name!r}: `capability` {problem}")
    return found


def describe_plugin_error(error: BaseException) -> str:
    """Return the text of an error that a plug-in raised, as `describe_error`. Name the remedy for SystemExit."""
    if isinstance(error, SystemExit):
        return f"{describe_error(error)}; a plug-in must not end the program: update it, or uninstall it"
    return describe_error(error)


def _group_commands(given: Any) -> Iterable[tuple[CommandGroup, Iterable[Any]]]:
    """Return the commands of a plug-in by group. Raises TypeError for an unknown group."""
    if not isinstance(given, Mapping):
        return [("develop", given)]
    known = get_args(CommandGroup)
    if unknown := [group for group in given if group not in known]:
        names = ", ".join(known)
        raise TypeError(
            f"register_commands: no group is called {unknown[0]!r}; the groups are {names}"
        )
    return list(given.items())


def _check_command(command: object) -> str:
    """Return the name of a command. Raises TypeError if it is no command, or if users cannot type its name."""
    import click

    if not isinstance(command, click.Command):
        raise TypeError(f"register_commands must return click commands, not {command!r}")
    name = command.name or ""
    if not 0 < len(name) <= MAX_NAME or not re.fullmatch(r"[\w.-]+", name):
        problem = f"must be 1 to {MAX_NAME} letters, digits, dots, hyphens and underscores"
        raise TypeError(f"the name of a command {problem}: {shorten(repr(name))}")
    return name


def _may_offer(point: EntryPoint, kind: Kind | Literal["command"]) -> bool:
    """Whether the module's source mentions the hook, or cannot be read. Does not import the module."""
    try:
        spec = importlib.util.find_spec(point.module)
        loader = spec.loader if spec else None
        text = loader.get_source(point.module) if isinstance(loader, InspectLoader) else None
    except (Exception, SystemExit):  # raised when its parent package is imported
        return True
    return text is None or f"register_{kind}s" in text or "import *" in text


def _explain_nothing(manager: pluggy.PluginManager) -> str:
    """Return why a plug-in offers nothing."""
    hooks = [name for name in vars(hookspecs) if name.startswith("register_")]
    empty = [name for name in hooks if getattr(manager.hook, name).get_hookimpls()]
    if not empty:
        return "offers nothing: is its hook decorated with @pacinian.hookimpl?"
    listed = " and ".join(f"`{name}`" for name in empty)
    return f"offers nothing: {listed} must return a list that is not empty, and not None"


def _is_initializing(module: str) -> bool:
    """Return whether a module, or a package that contains it, has not run to its end yet."""
    parts = module.split(".")
    names = [".".join(parts[: i + 1]) for i in range(len(parts))]
    specs = [getattr(sys.modules.get(name), "__spec__", None) for name in names]
    return any(getattr(spec, "_initializing", False) for spec in specs)


def _is_own(point: EntryPoint) -> bool:
    """Return whether Pacinian's own distribution ships a plug-in."""
    return point.dist is not None and point.dist.name == DISTRIBUTION


def _settings(offer: Offer) -> str:
    return ", ".join(k if v is ... else f"{k}={v!r}" for k, v in offer.options.items()) or "none"


def _origin(point: EntryPoint) -> str:
    shipped = f"{point.dist.name} {point.dist.version}" if point.dist else "no distribution"
    return f"{point.value}, {shipped}"


@functools.cache
def discover_plugins() -> Plugins:
    """Return the plug-ins of this installation, which are discovered once."""
    return Plugins()


def solver(name: str, **options: Any) -> Solver:
    """Construct a solver by name, with its settings. Raises UnknownPlugin, PluginError, ArgumentError."""
    if not options:
        return _usual(discover_plugins(), name)
    return cast("Solver", discover_plugins().make("solver", name, options))


@functools.lru_cache(maxsize=64)
def _usual(plugins: Plugins, name: str) -> Solver:
    """Return a solver with default settings. All callers share it, because solvers keep no state between calls."""
    return cast("Solver", plugins.make("solver", name, {}))


def backend(name: str, **options: Any) -> Backend:
    """Construct a backend by name, with its settings. Raises UnknownPlugin, PluginError, ArgumentError."""
    return cast("Backend", discover_plugins().make("backend", name, options))
