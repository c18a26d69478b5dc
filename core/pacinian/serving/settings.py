"""The server's settings, read from a configuration file. No client can change or exceed them."""

from __future__ import annotations

import ipaddress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from msgspec import Meta, Struct
from msgspec.structs import force_setattr, replace

from pacinian.acoustics.pose import Vector, vector
from pacinian.argument_checks import HEAD_RADIUS, check_number
from pacinian.config_files import decode_document
from pacinian.errors import ArgumentError, SceneFileError
from pacinian.scene.config_sections import (
    Device,
    Lattice,
    Medium,
    PluginConfig,
    Sampling,
    Units,
    Workspace,
    resolve_path,
)
from pacinian.wire.protocol import MAX_COMMAND_BYTES, MAX_CONTROL_BYTES

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.solving import quiet_zone

METRICS_HOST = "127.0.0.1"
Port = Annotated[int, Meta(ge=0, le=65535, description="0: any that is free")]


class Network(Struct, frozen=True, forbid_unknown_fields=True):
    """The address to listen on: an IP address, and the ports of the three sockets."""

    host: str = "127.0.0.1"
    control: Port = 0
    command: Port = 0
    state: Port = 0

    def __post_init__(self) -> None:
        try:
            ipaddress.ip_address(self.host)
        except ValueError:
            problem = f"must be an IP address, such as 127.0.0.1 or 0.0.0.0, not {self.host!r}"
            raise ArgumentError("host", problem) from None

    @property
    def loopback(self) -> bool:
        """Whether only programs on this machine can connect."""
        return ipaddress.ip_address(self.host).is_loopback

    def endpoint(self, port: int, *, local: bool = False) -> str:
        """Return the address to bind a socket to. local: the address for clients on this machine."""
        address = ipaddress.ip_address(self.host)
        if local and address.is_unspecified:
            address = ipaddress.ip_address("127.0.0.1" if address.version == 4 else "::1")
        return f"tcp://[{address}]:{port}" if address.version == 6 else f"tcp://{address}:{port}"


class Zone(Struct, frozen=True, forbid_unknown_fields=True):
    """A ball that always stays quiet. pressure: maximum sound pressure in it [Pa]. radius: [m]; 0 for a point."""

    position: Vector
    pressure: float
    radius: float = HEAD_RADIUS

    def __post_init__(self) -> None:
        force_setattr(self, "position", vector("position", self.position))
        check_number("pressure", self.pressure, low=0.0, above=True)
        check_number("radius", self.radius, low=0.0, high=1.0)

    def make(self) -> quiet_zone.Zone:
        """Return the zone for solvers."""
        from pacinian.solving.quiet_zone import Zone  # here, because most processes load no solver

        return Zone(self.position, pressure=self.pressure, radius=self.radius)

    def check_place(self, array: Array) -> None:
        """Check that the zone is near the array and contains no transducer. Raises ArgumentError."""
        from pacinian.solving.quiet_zone import check_zone_place  # see `make`

        check_zone_place(self.make(), array)


class Safety(Struct, frozen=True, forbid_unknown_fields=True):
    """Safety limits. All times are in seconds.

    lease: from the owner's last renewal to silence. frame_timeout: the device is silenced when its newest frame is
    older than this. hang_timeout: a process is killed when its last heartbeat is older than this. session_timeout:
    a session ends when its last renewal is older than this. takeover: whether a client may take the output from
    another. pressure: maximum radiation pressure of an object, and on the skin of the hands [Pa]. The bus refuses
    stronger objects; on the skin it is the same limit as `Renderer(peak=)`. The default, 200 Pa, is 165 dB SPL on skin
    and ten times the strongest object of the gallery: it stops a mistaken unit, not a strong effect. zones: quiet zones
    of the installation.
    """

    lease: float = 0.25
    frame_timeout: float = 0.02
    hang_timeout: float = 2.0
    session_timeout: float = 10.0
    takeover: bool = True
    pressure: float = 200.0
    zones: tuple[Zone, ...] = ()

    def __post_init__(self) -> None:
        check_number("lease", self.lease, low=0.05, high=10.0)
        check_number("frame_timeout", self.frame_timeout, low=0.002, high=1.0)
        check_number("hang_timeout", self.hang_timeout, low=0.1, high=60.0)
        check_number("session_timeout", self.session_timeout, low=0.1, high=3600.0)
        check_number("pressure", self.pressure, low=0.0, above=True)


class ClientLimits(Struct, frozen=True, forbid_unknown_fields=True):
    """Limits for clients.

    max_sessions: largest number of sessions; a session may have several connections. max_objects: largest number of
    objects of one scene; max_client_objects: of one client. max_rate: messages per second of one connection.
    max_command_bytes: largest size of one command.
    """

    max_sessions: Annotated[int, Meta(ge=1, le=1024)] = 64
    max_objects: Annotated[int, Meta(ge=1, le=65_536)] = 4096
    max_client_objects: Annotated[int, Meta(ge=1, le=65_536)] = 1024
    max_rate: Annotated[float, Meta(ge=1.0, le=1e6)] = 20_000.0
    max_command_bytes: Annotated[int, Meta(ge=MAX_CONTROL_BYTES, le=MAX_COMMAND_BYTES)] = (
        MAX_COMMAND_BYTES
    )


class Security(Struct, frozen=True, forbid_unknown_fields=True):
    """Access from other machines. keys: a folder with server.key and clients/*.key (`pacinian keys`)."""

    keys: str = ""


class Log(Struct, frozen=True, forbid_unknown_fields=True):
    """Logging to standard error, as text for people or as JSON for programs."""

    format: Literal["console", "json"] = "console"
    level: Literal["debug", "info", "warning", "error"] = "info"


class Metrics(Struct, frozen=True, forbid_unknown_fields=True):
    """The port of the Prometheus metrics, on 127.0.0.1 only; 0 disables them."""

    port: Annotated[int, Meta(ge=0, le=65535)] = 0


class Settings(Struct, frozen=True, forbid_unknown_fields=True):
    """A configuration file. Keys that a scene file also has mean the same here.

    power: maximum sum of squared gains; None for no limit. max_cycle_frames: largest number of frames that
    may present a region in turn; 1: one frame presents all of it. connection: path of the connection file for clients
    on this machine; "" for the default. state_rate: of the published state [Hz]. Raises ArgumentError.
    """

    array: Units | Lattice | Device = Units()
    medium: Medium = Medium()
    solver: str | PluginConfig = "auto"
    backend: str | PluginConfig = "simulated"
    rate: float = 1000.0
    gain: float = 1.0
    power: float | None = None
    max_cycle_frames: Annotated[int, Meta(ge=1, le=16)] = 4
    sampling: Sampling = Sampling()
    workspace: Workspace | None = None
    network: Network = Network()
    connection: str = ""
    safety: Safety = Safety()
    clients: ClientLimits = ClientLimits()
    security: Security = Security()
    log: Log = Log()
    metrics: Metrics = Metrics()
    state_rate: float = 60.0

    def __post_init__(self) -> None:
        check_number("rate", self.rate, low=1.0, high=100_000.0)
        check_number("gain", self.gain, low=1e-6, high=1.0)
        check_number("state_rate", self.state_rate, low=1.0, high=1000.0)
        if self.power is not None:
            check_number("power", self.power, low=1e-12, high=1e12)
        network = self.network
        ports = network.control, network.command, network.state, self.metrics.port
        if twice := [port for port in ports if port and ports.count(port) > 1]:
            raise ArgumentError("network", f"must not have port {twice[0]} twice")
        if not self.network.loopback and not self.security.keys:
            raise ArgumentError(
                "security.keys",
                f"must be a folder of keys to listen on {self.network.host}: "
                "`pacinian keys server --folder F` makes one",
            )


def load(path: str | Path) -> Settings:
    """Read a configuration file, TOML or JSON.

    Paths in it are relative to its folder, except those in the options of plug-ins.

    Raises SceneFileError, which names the file, the key and the fix.
    """
    path = Path(path)
    settings = decode_document(path, Settings)
    settings = replace(settings, array=resolve_path(settings.array, path.parent))
    if keys := settings.security.keys:
        settings = replace(settings, security=Security(str(path.parent / keys)))
    if settings.connection:
        settings = replace(settings, connection=str(path.parent / settings.connection))
    try:
        settings.medium.make()
    except ArgumentError as error:
        raise SceneFileError(path, "$.medium", str(error)) from error
    try:
        array = settings.array.make()
    except (ArgumentError, SceneFileError) as error:  # the latter of a device's file
        raise SceneFileError(path, "$.array", str(error)) from error
    for i, zone in enumerate(settings.safety.zones):
        try:
            zone.check_place(array)
        except ArgumentError as error:
            raise SceneFileError(path, f"$.safety.zones[{i}]", str(error)) from error
    return settings
