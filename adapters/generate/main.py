"""Write all generated files: messages in C# and C++, tables, docs, byte vectors and Unity's .meta files.

    python adapters/generate/main.py            writes the files that differ
    python adapters/generate/main.py --check    writes nothing; fails if a file differs

A generator has `generate(model)`, which returns the files: path below its folder, and text.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import cpp
import csharp
import features_table
import published
import unity_metas
import wire

if TYPE_CHECKING:
    from collections.abc import Callable

    from model import Model

ADAPTERS = Path(__file__).resolve().parent.parent
GENERATORS: tuple[tuple[Path, Callable[[Model], dict[str, str]]], ...] = (
    (ADAPTERS, csharp.generate),
    (ADAPTERS, cpp.generate),
    (ADAPTERS, features_table.generate),  # reads what the others write
    (ADAPTERS.parent, published.generate),
)


def main(arguments: list[str]) -> int:
    """Write the files, or check them."""
    model, check = wire.read(), "--check" in arguments
    wrong = 0
    for folder, generate in GENERATORS:
        for name, text in generate(model).items():
            path, data = folder / name, text.encode()
            if path.is_file() and path.read_bytes() == data:
                continue
            wrong += 1
            sys.stdout.write(f"{'differs' if check else 'written'}: {path}\n")
            if not check:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data)
    # Last, because the files that were just written need .meta files, too.
    for path in unity_metas.find_differing(unity_metas.PACKAGE):
        wrong += 1
        sys.stdout.write(f"{'differs' if check else 'written or removed'}: {path}\n")
    if not check:
        unity_metas.write(unity_metas.PACKAGE)
    return 1 if wrong and check else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
