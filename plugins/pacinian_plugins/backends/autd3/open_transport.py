"""The available transports to AUTD3 units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pacinian_plugins.backends.autd3.emulated import EmulatedTransport
from pacinian_plugins.backends.autd3.packages import import_package

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian_plugins.backends.autd3.transport_interface import Transport

LINKS = {
    "udp": "units on the network, or the simulator if it runs",
    "simulator": "the Simulator of autd3-console, on this machine",
    "server": "units of an AUTD3 server on this machine, which others use, too",
    "loopback": "the units' own software in this process, behind a real socket",
    "emulator": "the AUTD3 project's emulator, which tells what is emitted",
}
FAILSAFE = "udp", "simulator", "loopback"  # links whose units notice the end of this process
ETHERCAT = "twincat", "remote-twincat", "soem", "ethercrab", "echocat", "remote"
GONE = (
    "was for the EtherCAT firmware, up to 0.9: the AUTD3 packages have no such link any more. Update the units with "
    'autd3-console, and use `link = "udp"`: docs/autd3.md'
)


def make_transport(
    link: str,
    geometry: Any,
    interface: str,
    port: int,
    watchdog: float,
    timeout: float,
    clock: Callable[[], float],
) -> Transport:
    """Open the transport of a link. Raises BackendError, MissingExtra."""
    if link == "emulator":
        return EmulatedTransport(geometry, clock)
    # Only here, because asyncio takes 10 MB and the server's guard loads the modules of all backends.
    from pacinian_plugins.backends.autd3.udp_transport import UdpTransport

    api = import_package("autd3")
    if link == "server":
        option = api.ServerLink(port or import_package("autd3.params").SERVER_PORT)
        return UdpTransport(geometry, option, watchdog, timeout, clock, failsafe=False)
    units = api.UdpEmulator(len(geometry)) if link == "loopback" else None
    if units is not None:
        where = units.option().iface
    elif link == "simulator":
        where = api.Interface.Simulator(port or import_package("autd3.params").SIMULATOR_PORT)
    else:
        where = api.Interface.Name(interface) if interface else api.Interface.Auto
    lost = api.Duration.from_secs_f64(timeout)
    option = api.UdpOption(iface=where, heartbeat=None, lost_timeout=lost)
    return UdpTransport(geometry, option, watchdog, timeout, clock, units=units)
