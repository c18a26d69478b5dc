"""Commands for units: change levels without ramps, and be silent."""

from __future__ import annotations

from typing import Any

from pacinian_plugins.backends.autd3.packages import import_package

# Largest change of a level per period of the ultrasound, in 1/256 of a level.
MAX_LEVEL_CHANGE = 65535


def make_unramped() -> Any:
    """Return the command that lets levels change from one period to the next, instead of the silencer's ramps.

    `SetSilencer.disable()` does not do this: in the emulator, some phases then take the long way round, up to 1 ms.
    """
    commands = import_package("autd3.commands")
    return commands.SetSilencer(commands.FixedUpdateRate(MAX_LEVEL_CHANGE, MAX_LEVEL_CHANGE))


def make_silent(units: int) -> Any:
    """Return the command that stops all sound."""
    return import_package("autd3.commands").Pattern(
        import_package("autd3_pattern").PhaseBuffer(units), 0
    )
