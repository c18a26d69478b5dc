"""What units are told to be: exact, and silent."""

from __future__ import annotations

from typing import Any

from pacinian_plugins.backends.autd3.packages import import_package

AT_ONCE = 65535  # of 256 levels in units of 1/256: in one period of the ultrasound


def make_exact() -> Any:
    """The command that lets levels change from one period to the next: the silencer ramps them otherwise.

    `SetSilencer.disable()` does not: in the emulator some phases then run the long way round, for up to 1 ms.
    """
    commands = import_package("autd3.commands")
    return commands.SetSilencer(commands.FixedUpdateRate(AT_ONCE, AT_ONCE))


def make_silent(units: int) -> Any:
    """The command that ends all sound."""
    return import_package("autd3.commands").Pattern(
        import_package("autd3_pattern").PhaseBuffer(units), 0
    )
