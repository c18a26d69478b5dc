"""Which programs have a device open: who has to end before it can be used."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path


def find_users(device: Path | str, proc: Path = Path("/proc")) -> str:
    """Programs that have a device's file open, as `name (pid)`, as far as this user may know.

    device: as `/dev/ttyUSB0`. proc: where the system tells of processes; none are known where it does not (Linux
    alone does). Raises nothing.
    """
    node = str(Path(device).resolve())
    found: list[str] = []
    for process in sorted(proc.glob("[0-9]*"), key=lambda p: int(p.name)):
        with suppress(OSError):  # other users' are closed to us, and some have ended since
            if any(str(fd.readlink()) == node for fd in (process / "fd").iterdir()):
                found.append(f"{(process / 'comm').read_text().strip()} ({process.name})")
    return ", ".join(found)
