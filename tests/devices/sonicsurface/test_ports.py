"""Which port is opened, and for which boards; what the user sees where one cannot be."""

from __future__ import annotations

import errno
import os
import re
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import serial

import pacinian as pc
from pacinian.errors import suggest_install
from pacinian_plugins.backends.sonicsurface import SonicSurface
from pacinian_plugins.backends.sonicsurface.ports import PERMISSION

from ...waiting import eventually
from .adapters import ARRAY, NAME, Port, Terminal, frame, refused


def adapter(device: str, serial_number: str | None) -> Any:
    return SimpleNamespace(device=device, serial_number=serial_number, vid=0x10C4)


def test_only_a_port_that_is_named_is_opened(adapters: list[Any], monkeypatch: Any) -> None:
    tried: list[str] = []

    def serial_(device: str, *given: Any, **settings: Any) -> Port:
        tried.append(device)
        return Port(device)

    monkeypatch.setattr(serial, "Serial", serial_)
    adapters += [adapter("/dev/ttyUSB1", "X1"), adapter("/dev/ttyUSB0", None)]
    refused(
        lambda: SonicSurface().open(ARRAY),
        "sonicsurface: name the port: `port`, or the serial number in the `description`; "
        "there are: /dev/ttyUSB0 (no serial), /dev/ttyUSB1 (X1)",
    )
    list(SonicSurface.find_devices())
    assert not tried
    for name, device in (("X1", "/dev/ttyUSB1"), ("/dev/ttyUSB0", "/dev/ttyUSB0")):
        backend = SonicSurface(port=name)
        backend.open(ARRAY)
        backend.close()
        assert tried[-1] == device
    adapters.append(adapter("/dev/ttyUSB2", "X1"))
    refused(
        lambda: SonicSurface(port="X1").open(ARRAY),
        "sonicsurface X1: 2 adapters have this serial number, at /dev/ttyUSB1 and /dev/ttyUSB2: name one of these",
    )


def test_no_such_port(adapters: list[Any]) -> None:
    refused(
        lambda: SonicSurface(port="/dev/ttyNONE").open(ARRAY),
        "sonicsurface /dev/ttyNONE: is not connected; there are: none",
    )


@pytest.mark.parametrize(
    ("number", "message"),
    [(errno.EACCES, PERMISSION), (errno.EBUSY, "it is in use by another program: end that first")],
)
def test_a_port_that_cannot_be_opened(monkeypatch: Any, number: int, message: str) -> None:
    def refuses(*given: Any, **settings: Any) -> Any:
        raise serial.SerialException(number, f"could not open port {NAME}")

    monkeypatch.setattr(serial, "Serial", refuses)
    refused(lambda: SonicSurface(port=NAME).open(ARRAY), f"sonicsurface {NAME}: {message}")


@pytest.mark.skipif(os.name == "nt", reason="Windows has no pseudo-terminals")
def test_a_real_port_is_ours_alone() -> None:
    terminal = Terminal()
    try:
        backend, other = (SonicSurface(port=terminal.name) for _ in range(2))
        backend.open(ARRAY)
        who = f"({os.getpid()})" if sys.platform == "linux" else "another program"
        with pytest.raises(pc.BackendError, match=re.escape(f"{who}: end that first")):
            other.open(ARRAY)
        backend.send(frame())
        eventually(lambda: terminal.pump() and terminal.board.pulses().any())
        backend.close()
        other.open(ARRAY)
        other.close()
    finally:
        terminal.close()


def test_what_is_connected_is_listed(adapters: list[Any], monkeypatch: Any) -> None:
    adapters += [
        adapter("/dev/ttyUSB1", "X1"),
        adapter("/dev/ttyUSB0", None),
        SimpleNamespace(device="/dev/ttyS0", serial_number=None, vid=None),
    ]
    monkeypatch.setattr(os, "access", lambda device, mode: device != "/dev/ttyUSB1")
    first, second = SonicSurface.find_devices()
    title = "serial adapter, of a SonicSurface or anything else, at /dev/ttyUSB"
    assert first == pc.FoundDevice("sonicsurface", "", title + "0")
    assert second == pc.FoundDevice("sonicsurface", "X1", title + "1", PERMISSION)


def test_without_pyserial_the_extra_is_named(monkeypatch: Any) -> None:
    monkeypatch.setitem(sys.modules, "serial.tools.list_ports", None)
    with pytest.raises(pc.MissingExtra, match=r"pip install .*\[devices\]"):
        SonicSurface(port=NAME).open(ARRAY)
    problem = f"pyserial is not installed: {suggest_install('devices')}"
    assert SonicSurface.find_devices() == [pc.FoundDevice("sonicsurface", "", "", problem)]


def test_two_boards_of_a_description(port: Port, tmp_path: Path) -> None:
    file = tmp_path / "device.toml"
    board = 'layout = { type = "grid" }\n'
    file.write_text(
        f'backend = "sonicsurface"\n[[boards]]\nserial = "{NAME}"\n{board}'
        f'[[boards]]\nserial = "second"\n{board}dead = [5]\npose = {{ position = [0.2, 0.0, 0.0] }}\n'
    )
    array = pc.DeviceDescription.load(file).array()
    backend = SonicSurface(description=str(file), select=(0xC0, 0xC0))
    backend.open(array)
    ones = np.ones((1, 511), np.uint16)
    backend.send(pc.Frame(0, 0.0, ones, ones))
    eventually(lambda: len(port.writes) >= 3)
    second = bytearray([31]) * 256
    second[5] = 32
    want = b"\xc0\xfe" + b"\x1f" * 256 + b"\xc0\xfe" + second + b"\xfd"
    assert port.writes[2] == want
    backend.close()


@pytest.mark.parametrize(
    ("count", "message"),
    [
        (249, "sonicsurface: the array has 249 transducers, and its boards drive 256"),
        (257, "sonicsurface: the array has 257 transducers, and its boards drive 512"),
        (747, "sonicsurface: the array has 747 transducers, a port drives 256 or 512"),
    ],
)
def test_arrays_of_another_size(count: int, message: str) -> None:
    r = pc.autd(3, 1).positions[:count]
    array = pc.Array(r, np.tile([0.0, 0.0, 1.0], (count, 1)))
    fix = "set `array` in the server's settings (docs/sonicsurface.md)"
    refused(lambda: SonicSurface(port=NAME).open(array), f"{message}: {fix}")


def test_the_examples_channels_are_where_the_array_has_them() -> None:
    file = Path(__file__).parents[3] / "examples" / "devices" / "sonicsurface.toml"
    (board,) = pc.DeviceDescription.load(file).boards
    # the first channel's transducer is in a corner, the second's two further on, the eighth's beside the first
    assert board.order[:8] == (0, 2, 3, 17, 16, 19, 18, 1)
    assert board.order[64] == 4


@pytest.mark.parametrize(
    "options",
    [
        {"rate": 0.0},
        {"timeout": 0.0},
        {"select": (1,)},
        {"select": (192, 256)},
        {"select": (-1, 2)},
    ],
)
def test_bad_settings_are_named(options: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=next(iter(options))):
        SonicSurface(**options)
