"""Adapters in place of the machine's own."""

from __future__ import annotations

from typing import Any

import pytest
import serial
import serial.tools.list_ports

from .adapters import NAME, Port


@pytest.fixture(autouse=True)
def adapters(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What pyserial lists."""
    there: list[Any] = []
    monkeypatch.setattr(serial.tools.list_ports, "comports", lambda: list(there))
    return there


@pytest.fixture
def port(monkeypatch: pytest.MonkeyPatch) -> Port:
    made = Port(NAME)
    monkeypatch.setattr(serial, "Serial", lambda *given, **settings: made)
    return made
