"""Fuzzes the decoders: `python tests/wire/fuzz_decoder.py -atheris_runs=100000`.

Any bytes are either a message, and then the same one again after encoding, or a WireError with a path. Objects that
were understood also become objects of the scene, or a WireError.
"""

from __future__ import annotations

import copy
import math
import random
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import atheris
import msgpack

if TYPE_CHECKING:
    from collections.abc import Iterator

with atheris.instrument_imports(include=["pacinian.wire", "pacinian.scene"]):
    from pacinian.errors import WireError
    from pacinian.wire import commands, control
    from pacinian.wire.codec import encode, id_of
    from pacinian.wire.convert import envelope_to_scene, technique_to_scene, to_scene
    from pacinian_lab.vectors.vectors import DECODE, make_vectors

JUNK = None, -1, 0, 0.5, math.nan, "", "sphere", b"", bytes(12), bytes(36), [], [0.0, 0.0, 0.0], {}
SOCKETS = sorted(DECODE)


def one(data: bytes) -> None:
    """One input: its first byte says which socket."""
    socket, data = SOCKETS[data[0] % len(SOCKETS)] if data else SOCKETS[0], data[1:]
    if not 0 <= id_of(data) < 2**32:
        raise AssertionError("no id")
    try:
        message = DECODE[socket](data)
    except WireError as error:
        if not error.path.startswith("$") or len(str(error)) > 1000:
            raise AssertionError("no path") from error
        return
    again = encode(message)
    if encode(DECODE[socket](again)) != again:
        raise AssertionError("not the same again")
    try:
        if isinstance(message, commands.Put):
            for name, item in message.objects.items():
                to_scene(name, item)
        elif isinstance(message, commands.Envelopes):
            envelope_to_scene(message.envelope)
        elif isinstance(message, control.Select) and message.technique is not None:
            technique_to_scene(message.technique)
    except WireError as error:
        if not error.path.startswith("$"):
            raise AssertionError("no path") from error


def mutate(data: bytes, most: int, seed: int) -> bytes:
    """Every other time a value anywhere in the message becomes another one, else bytes change."""
    choose = random.Random(seed)
    try:
        value: Any = msgpack.unpackb(data[1:]) if choose.random() < 0.5 else None
        holders = list(_holders(value))
        holder, key = choose.choice(holders)
        holder[key] = choose.choice(
            [choose.choice(JUNK), _held(choose.choice(holders)), 10.0 ** choose.randint(-9, 9)]
        )
        return (data[:1] + (msgpack.packb(value) or b""))[:most]
    except (ValueError, TypeError, IndexError, RecursionError, msgpack.UnpackException):
        return atheris.Mutate(data, most)


def _holders(value: Any) -> Iterator[tuple[Any, Any]]:
    """All maps and arrays in a value, with each of their keys."""
    if isinstance(value, (dict, list)):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield value, key
            yield from _holders(item)


def _held(place: tuple[Any, Any]) -> Any:
    return copy.deepcopy(place[0][place[1]])


def main() -> None:
    """Begin with the vectors."""
    with tempfile.TemporaryDirectory() as folder:
        for i, vector in enumerate(v for made in make_vectors().values() for v in made):
            first = bytes([SOCKETS.index(vector["socket"])])
            (Path(folder) / str(i)).write_bytes(first + bytes.fromhex(vector["hex"]))
        atheris.Setup([*sys.argv, folder], one, custom_mutator=mutate)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
