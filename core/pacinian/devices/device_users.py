"""Programs that have a device open, and must end before it can be used."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path


def find_users(device: Path | str, proc: Path = Path("/proc")) -> str:
    """Return the programs that have a device file open, as `name (pid)`, as far as this user may see them.

    device: path of the file, such as `/dev/ttyUSB0`. proc: the process file system; only Linux has one, and without it
    the result is empty. Raises nothing.
    """
    node = str(Path(device).resolve())
    found: list[str] = []
    for process in sorted(proc.glob("[0-9]*"), key=lambda p: int(p.name)):
        with suppress(OSError):  # a process of another user, or one that has ended
            if any(str(fd.readlink()) == node for fd in (process / "fd").iterdir()):
                found.append(f"{(process / 'comm').read_text().strip()} ({process.name})")
    return ", ".join(found)
