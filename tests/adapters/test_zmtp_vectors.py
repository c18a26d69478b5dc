"""The byte vectors of ZMTP over TCP, in C# and C++: all except those about times and about sending binary data."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

import pytest

from ..waiting import PATIENCE, eventually
from . import tools
from .game import Game
from .mutations import WIRE
from .test_csharp_zmtp import driver
from .zmtp import Listener

if TYPE_CHECKING:
    from collections.abc import Callable

    from .zmtp import Peer

__all__ = ["driver"]  # a fixture

WORD = re.compile(r"'([^']*)'|\{(\w+)\}|(?:(\d+)\*)?([0-9a-f]+)")
SHOWN = 40  # [bytes] of a message that a driver prints


class Case(NamedTuple):
    """Steps: what is done, and with which arguments."""

    name: str
    steps: list[tuple[str, str]]


def read_cases() -> tuple[dict[str, bytes], list[Case]]:
    """Return the words that stand for bytes, and the cases."""
    words: dict[str, bytes] = {}
    cases: list[Case] = []
    for line in (WIRE / "zmtp.txt").read_text(encoding="utf-8").splitlines():
        what, _, rest = line.partition(" ")
        if what == "let":
            name, _, written = rest.partition(" ")
            words[name] = read_bytes(written, words)
        elif what == "case":
            cases.append(Case(rest, []))
        elif line and not line.startswith("#"):
            cases[-1].steps.append((what, rest))
    return words, cases


def read_bytes(written: str, words: dict[str, bytes]) -> bytes:
    found = b""
    for text, name, times, digits in WORD.findall(written):
        if name:
            found += words[name]
        else:
            found += bytes.fromhex(digits) * int(times or 1) if digits else text.encode()
    return found


WORDS, CASES = read_cases()
OVER_TCP = [case for case in CASES if not {"time", "sends"} & {what for what, _ in case.steps}]


@pytest.fixture(
    params=[
        pytest.param("cpp", marks=pytest.mark.deep("cmake", "ninja", "g++", "pkg-config")),
        pytest.param("csharp", marks=pytest.mark.deep("mono", "mcs")),
    ]
)
def start(request: pytest.FixtureRequest) -> Callable[[str, str, str], Game]:
    """Return a function that starts a socket: of a kind, for an address, with a password."""
    if request.param == "cpp":
        settings = "-DPACINIAN_SANITIZE=ON", *tools.JOINED
        program = [tools.cmake("sanitized", ["zmtp_answers"], *settings) / "zmtp_answers"]
    else:
        program = ["mono", "--debug", request.getfixturevalue("driver")]
    times = "0", str(PATIENCE), str(PATIENCE)
    return lambda kind, at, token: Game([*program, kind, at, token, *times, "once"])


def connect(start: Callable[[str, str, str], Game], kind: str, options: str, address: str) -> Game:
    known = dict(option.split("=") for option in options.split())
    game = start(kind.capitalize(), address, known.get("password", ""))
    if "topic" in known:
        game.do(f"subscribe {known['topic']}")
    return game


def expect(peer: Peer, wanted: bytes) -> None:
    while len(peer.heard) < len(wanted) and peer.read():
        pass
    assert peer.heard[: len(wanted)] == wanted
    peer.heard = peer.heard[len(wanted) :]


def follow(step: tuple[str, str], game: Game, peer: Peer) -> None:
    what, rest = step
    if what == "gives":
        with suppress(OSError):  # the peer may have refused and closed it
            peer.send(read_bytes(rest, WORDS))
    elif what == "says":
        expect(peer, read_bytes(rest, WORDS))
    elif what == "ready":
        eventually(lambda: game.do("room")["done"])
    elif what == "reads":
        wanted = read_bytes(rest, WORDS)
        told = game.wait(lambda t: "received" in t)
        assert (told["received"], bytes.fromhex(told["hex"])) == (len(wanted), wanted[:SHOWN])
    elif what == "ends":
        how, _, why = rest.partition(" ")
        told = game.wait(lambda t: "ended" in t)
        assert told["ended"] == how.capitalize()
        assert why in told["problem"]
    else:
        assert what == "open", what


@pytest.mark.parametrize("case", OVER_TCP, ids=lambda case: case.name)
def test_a_case(start: Callable[[str, str, str], Game], case: Case) -> None:
    (kind, options), *steps = case.steps
    with (
        Listener() as listener,
        connect(start, kind, options, listener.address) as game,
        listener.accept() as peer,
    ):
        for step in steps:
            follow(step, game, peer)
        received = sum("received" in told for told in game.told)
        assert received == sum(what == "reads" for what, _ in steps)


def test_there_are_cases() -> None:
    assert len(OVER_TCP) > 40
    assert {step for case in CASES for step, _ in case.steps} >= {"gives", "says", "reads", "ends"}
