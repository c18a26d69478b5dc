"""The launch configuration: what control writes to the standard input of a new child."""

from __future__ import annotations

from pathlib import Path

import msgspec
from msgspec import Struct

from pacinian.errors import ServerError
from pacinian.serving.settings import Settings

MAX_CONFIG_BYTES = 1 << 20  # largest launch configuration [bytes]
ACTIVATE = b"!"  # byte that tells a spare to begin; it follows the configuration


class LaunchConfig(Struct, frozen=True):
    """The launch configuration of a child. folder: of the shared memory. secrets: names to values, only for the bus.

    spare: for a spare, the id of the process whose end it waits for; otherwise 0.
    """

    folder: str
    settings: Settings
    secrets: dict[str, str] = {}
    spare: int = 0

    def __repr__(self) -> str:  # never show the secrets
        return f"LaunchConfig({self.folder!r})"

    @property
    def path(self) -> Path:
        """The folder."""
        return Path(self.folder)


def encode_config(config: LaunchConfig) -> bytes:
    """Return the configuration as bytes. Raises ServerError."""
    try:
        data = msgspec.json.encode(config)
    except UnicodeEncodeError as error:
        raise ServerError(
            f"the path {error.object!r} in the settings is not Unicode: rename that file or folder"
        ) from None
    if len(data) > MAX_CONFIG_BYTES:
        raise ServerError(f"the settings take {len(data)} bytes, more than {MAX_CONFIG_BYTES}")
    return data
