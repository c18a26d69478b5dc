"""Write the messages of the wire in the languages of the adapters, from `pacinian.wire`, and a feature table.

    python adapters/generate/main.py            writes all generated files
    python adapters/generate/main.py --check    writes nothing; fails if a file is not what that would write

A generator has `generate(model)`, which gives the files: path below adapters/, and text.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import cpp
import csharp
import features_table
import wire

if TYPE_CHECKING:
    from collections.abc import Callable

    from model import Model

GENERATORS: tuple[Callable[[Model], dict[str, str]], ...] = (
    csharp.generate,
    cpp.generate,
    features_table.generate,  # reads what the others write
)
ADAPTERS = Path(__file__).resolve().parent.parent


def main(arguments: list[str]) -> int:
    """Write, or check."""
    model, check = wire.read(), "--check" in arguments
    wrong = 0
    for generate in GENERATORS:
        for name, text in generate(model).items():
            path, data = ADAPTERS / name, text.encode()
            if path.is_file() and path.read_bytes() == data:
                continue
            wrong += 1
            sys.stdout.write(f"{'differs' if check else 'written'}: {path}\n")
            if not check:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
    return 1 if wrong and check else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
