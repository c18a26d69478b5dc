"""Build the standalone server, which needs no Python: `python packaging/standalone/build.py FOLDER`.

It contains this environment's Pacinian, with its plug-ins: first install those that the game needs. The result is
FOLDER/pacinian.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

SPEC = Path(__file__).with_name("pacinian.spec")


def build(folder: Path) -> Path:
    """Build into a folder, whose `pacinian` is replaced; return the program. Raises CalledProcessError."""
    with tempfile.TemporaryDirectory() as work:
        command = [sys.executable, "-m", "PyInstaller", "--noconfirm", "--log-level", "WARN"]
        subprocess.run([*command, "--distpath", folder, "--workpath", work, SPEC], check=True)
    program = folder / "pacinian" / ("pacinian.exe" if sys.platform == "win32" else "pacinian")
    subprocess.run([program, "plugins"], check=True, stdout=subprocess.DEVNULL)
    return program


def main() -> None:
    """Build, and tell the program and its size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    program = build(parser.parse_args().folder)
    size = sum(file.lstat().st_size for file in program.parent.rglob("*"))
    sys.stdout.write(f"{program}: {size / 1e6:.0f} MB\n")


if __name__ == "__main__":
    main()
