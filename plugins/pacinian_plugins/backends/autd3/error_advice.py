"""Error messages of the AUTD3 packages, with advice for the user."""

from __future__ import annotations

from pacinian.devices.usb_errors import RESET_ADVICE
from pacinian_plugins.backends.autd3.packages import NAME

LOST = (
    "the units have stopped answering: a cable, the power, or another program that opened them. Their failsafe "
    f"silences them. Mend that, then {RESET_ADVICE}"
)
ADVICE = {  # by a part of the packages' error message
    "no interface has an AUTD3": "switch the units on, connect the first to this machine, allow UDP from port 44336 "
    "through the firewall; units with EtherCAT firmware (0.9 or older) must be updated: docs/autd3.md",
    "no simulator answers": "start it: the Simulator of autd3-console",
    "no server accepts": "start the AUTD3 server on this machine",
    "does not exist or has no IPv6": "name an interface with IPv6, or leave `interface` empty",
    "are attached": "make the array of as many units as are connected, in the order of their cables",
    "were enumerated": "look at the cables and the power of the others",
    "runs firmware": "update it with autd3-console: docs/autd3.md",
    "did not reply": f"look at the cable and the power, then {RESET_ADVICE}",
}


def describe_loss() -> str:
    """Return the message for a lost unit."""
    return f"{NAME}: {LOST}"


def explain(error: Exception) -> str:
    """Return the message for an error of the packages."""
    said = str(error)
    advice = next((advice for part, advice in ADVICE.items() if part in said), RESET_ADVICE)
    return f"{NAME}: {said}: {advice}"
