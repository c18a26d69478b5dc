"""Options that cannot be meant, and units that cannot be reached: what the user is told."""

from __future__ import annotations

import sys
import threading
import time
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian_plugins.backends.autd3 import Autd3
from pacinian_plugins.backends.autd3.udp_transport import UdpTransport

from .loopback import PATIENT

UNREACHED: dict[str, tuple[dict[str, Any], str]] = {
    "no such interface": (
        {"link": "udp", "interface": "none-such"},
        "none-such does not exist.*: name an interface with IPv6, or leave `interface` empty",
    ),
    "no simulator": (
        {"link": "simulator", "port": 44991},
        "no simulator answers at .*44991: start it: the Simulator of autd3-console",
    ),
    "no server": (
        {"link": "server", "port": 44993},
        "no server accepts .*44993: start the AUTD3 server on this machine",
    ),
}


@pytest.mark.usefixtures("loopback")
@pytest.mark.parametrize("case", UNREACHED)
def test_what_cannot_be_reached_says_what_to_do(case: str) -> None:
    options, problem = UNREACHED[case]
    backend, threads = Autd3(**options), threading.active_count()
    with pytest.raises(pc.BackendError, match=f"autd3: .*{problem}"):
        backend.open(pc.autd())
    assert threading.active_count() == threads
    with pytest.raises(pc.BackendError, match="autd3 is not open"):
        backend.send(pc.Frame(0, 0.0, np.zeros((1, 249), np.uint16), np.zeros((1, 249), np.uint16)))
    backend.silence()
    backend.close()


@pytest.mark.usefixtures("loopback")
def test_another_number_of_units_than_there_is_says_what_to_do() -> None:
    from autd3 import Duration, UdpEmulator, UdpOption

    from pacinian_plugins.backends.autd3.units import layout_of_array

    emulated = UdpEmulator(3)
    patient = Duration.from_secs(4)  # all of which it takes; the machine may be busy
    option = UdpOption(iface=emulated.option().iface, response_timeout=patient)
    geometry = layout_of_array(pc.autd(2, 1)).geometry()
    with pytest.raises(pc.BackendError, match="2 devices but 3 are attached: make the array of as"):
        UdpTransport(geometry, option, PATIENT["watchdog"], PATIENT["timeout"], time.perf_counter)


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"link": "usb"}, '`link` must be one of "udp", "simulator"'),
        ({"link": "twincat"}, '`link` "twincat" was for the EtherCAT firmware'),
        ({"rate": 3000}, "`rate` must divide 40000 Hz, not 3000"),
        ({"rate": 50}, "`rate` must be a whole number of at least 100"),
        ({"watchdog": 0.0}, "`watchdog`"),
        ({"lead": 1.0}, "`lead`"),
        ({"timeout": 0.0}, "`timeout`"),
        ({"port": -1}, "`port`"),
    ],
)
def test_options_that_cannot_be_meant_are_refused(options: dict[str, Any], problem: str) -> None:
    with pytest.raises(pc.ArgumentError) as caught:
        Autd3(**options)
    assert problem.replace('"', "'") in str(caught.value)


@pytest.mark.parametrize("link", ["udp", "emulator"])
def test_without_the_packages_it_says_which_extra_to_install(
    link: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = "autd3" if link == "udp" else "autd3_emulator"
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(pc.MissingExtra, match=r'pip install .*\[autd3\]"'):
        Autd3(link=link).open(pc.autd())


def test_units_of_a_server_others_use_too_so_nothing_is_promised_of_their_failsafe() -> None:
    assert Autd3(link="server").capability.watchdog is None
    assert Autd3(link="emulator").capability.watchdog is None
    assert Autd3().capability.watchdog == 0.05
