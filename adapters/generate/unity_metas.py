"""Writes the .meta file of each file and folder of the Unity package.

Unity finds an asset by the GUID in its .meta file. Here that comes from its path, so it is always the same.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1] / "unity"
NAME = "com.pacinian.haptics"
COMMON = "  userData: \n  assetBundleName: \n  assetBundleVariant: \n"
PLAIN = "  externalObjects: {}\n" + COMMON
SCRIPT = """  externalObjects: {}
  serializedVersion: 2
  defaultReferences: []
  executionOrder: 0
  icon: {instanceID: 0}
"""
IMPORTERS = {
    ".asmdef": "AssemblyDefinitionImporter:\n" + PLAIN,
    ".asset": "NativeFormatImporter:\n  externalObjects: {}\n  mainObjectFileID: 11400000\n"
    + COMMON,
    ".cs": "MonoImporter:\n" + SCRIPT + COMMON,
    ".json": "PackageManifestImporter:\n" + PLAIN,
    ".md": "TextScriptImporter:\n" + PLAIN,
    ".prefab": "PrefabImporter:\n" + PLAIN,
    ".unity": "DefaultImporter:\n" + PLAIN,
}


def assets(package: Path) -> list[Path]:
    """Return the files and folders that Unity imports: also those of samples, but not those in `Documentation~`."""
    found = []
    for path in sorted(package.rglob("*")):
        parts = path.relative_to(package).parts
        hidden = any(part.startswith(".") for part in parts) or parts[0] == "Documentation~"
        if path.suffix != ".meta" and not hidden and parts[-1] != "Samples~":
            found.append(path)
    return found


def guid(path: str) -> str:
    """Return the GUID of a path inside the package, as 32 hexadecimal digits."""
    return hashlib.md5(f"{NAME}/{path}".encode(), usedforsecurity=False).hexdigest()


def make_meta(package: Path, path: Path) -> str:
    """Return the content of an asset's .meta file. Raises KeyError for an unknown kind of file."""
    head = f"fileFormatVersion: 2\nguid: {guid(path.relative_to(package).as_posix())}\n"
    if path.is_dir():
        return head + "folderAsset: yes\nDefaultImporter:\n" + PLAIN
    return head + IMPORTERS[path.suffix]


def generate_metas(package: Path) -> dict[Path, str]:
    """Return all .meta files and their contents."""
    return {
        path.with_name(path.name + ".meta"): make_meta(package, path) for path in assets(package)
    }


def find_differing(package: Path) -> list[Path]:
    """Return the .meta files that are missing, different, or without an asset."""
    metas = generate_metas(package)
    orphans = [path for path in package.rglob("*.meta") if path not in metas]
    return orphans + [p for p, t in metas.items() if not p.is_file() or p.read_text() != t]


def write(package: Path) -> None:
    """Write all .meta files, and remove those without an asset."""
    metas = generate_metas(package)
    for path in find_differing(package):
        if path in metas:
            path.write_text(metas[path], encoding="utf-8", newline="\n")
        else:
            path.unlink()
