"""Puts the package of a game engine into a project: all of it or nothing, and never over somebody's changes."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pacinian.cli.package_links import complete_links
from pacinian.errors import PacinianError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

LIST = ".pacinian-files"  # in an installed package: SHA-256 and path of each of its files
WORK = ".pacinian-"  # prefix of the folder beside the package, in which it is made
BUILT = re.compile(
    r"(Binaries/(?!ThirdParty/)|Intermediate/|Saved/).*"
)  # by the engine; built again
IGNORED = re.compile(r"Source/ThirdParty/\w+/(Include|Lib)/.*")  # libraries of the checkout's own
MAX_LISTED = 3  # changed files that a message names


class PackageError(PacinianError):
    """The package cannot be put there; the text says why, and what to do."""


class Package(NamedTuple):
    """A package. folder: its files. manifest: the JSON file that has its version, as `key`."""

    folder: Path
    manifest: str
    key: str

    def read_version(self, folder: Path) -> str:
        """Return the version of the copy in a folder; "" if it cannot be read."""
        try:
            return str(
                json.loads((folder / self.manifest).read_text(encoding="utf-8-sig"))[self.key]
            )
        except (OSError, ValueError, KeyError, TypeError):
            return ""

    @property
    def version(self) -> str:
        """The version."""
        return self.read_version(self.folder)


class Installed(NamedTuple):
    """What was done. before: version that was there; None if there was none. copied: whether anything was written."""

    before: str | None
    copied: bool


def find_package(name: str) -> Path:
    """Return the folder of a package, such as "unity": of the installed distribution, or of the checkout.

    Raises PackageError if this installation has none.
    """
    here = Path(__file__).resolve()
    for root in (here.parents[1] / "adapters", here.parents[3] / "adapters"):
        if (root / name).is_dir():
            return root / name
    raise PackageError(
        f"this installation of Pacinian has no package for {name}: install Pacinian from its checkout or its wheel, or "
        f"copy adapters/{name} of the checkout by hand"
    )


def install(package: Package, target: Path, *, replace: bool) -> Installed:
    """Put a copy of a package at `target`. Files there that are not of an earlier copy stay, except what was built.

    replace: even if the copy there is newer, or somebody has changed it. Raises PackageError; then all is as it was.
    """
    files = {path: file.read_bytes() for path, file in _list_files(package.folder)}
    ours = complete_links(files, package.folder)
    try:
        target.parent.mkdir(exist_ok=True)
        _clean_up_interrupted(target)
        if target.is_symlink():
            raise PackageError(f"{target} is a link to {target.readlink()}: remove the link first")
        if not target.exists():
            _write(ours, {}, target)
            return Installed(None, True)
        there = {path: file.read_bytes() for path, file in _list_files(target)}
        before = package.read_version(target)
        known = _read_list(there.pop(LIST, b""))
        if all(there.get(path) == data for path, data in ours.items()) and not (
            known.keys() - ours.keys()
        ):
            return Installed(before, False)
        if not replace:
            _check(target, before, package.version, there, known)
        added = {p: data for p, data in there.items() if p not in ours and p not in known}
        _write(ours, added, target)
    except OSError as error:
        raise PackageError(
            f"cannot write to {target.parent}: {error.strerror or error}. Close the engine's editor, and see that "
            "you may write there; nothing was changed"
        ) from error
    return Installed(before, True)


def _check(
    target: Path, before: str, new: str, there: Mapping[str, bytes], known: Mapping[str, str]
) -> None:
    """Raise PackageError if what is there is newer, or is not as it was installed."""
    force = "--replace replaces it all the same"
    if _order(before) > _order(new):
        raise PackageError(
            f"{target} is version {before}, and this Pacinian has {new}: update Pacinian; {force}"
        )
    if not known:
        raise PackageError(
            f"{target} was not put there by this command, and is not the same: {force}"
        )
    changed = [p for p, digest in known.items() if p not in there or _digest(there[p]) != digest]
    if changed:
        more = f" and {len(changed) - MAX_LISTED} more" if len(changed) > MAX_LISTED else ""
        names = ", ".join(changed[:MAX_LISTED])
        raise PackageError(
            f"somebody has changed {names}{more} in {target}: keep a copy of the changes; {force}"
        )


def _write(ours: Mapping[str, bytes], added: Mapping[str, bytes], target: Path) -> None:
    """Make the package beside its place, then exchange it for what is there."""
    work = Path(tempfile.mkdtemp(prefix=WORK, dir=target.parent))
    made, old = work / "new", work / "old"
    try:
        lines = "".join(f"{_digest(data)}  {path}\n" for path, data in sorted(ours.items()))
        for path, data in {**added, **ours, LIST: lines.encode()}.items():
            file = made / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(data)
        if target.exists():
            target.rename(old)
        made.rename(target)
    finally:  # also after Ctrl-C
        if old.exists() and not target.exists():
            old.rename(target)
        shutil.rmtree(work, ignore_errors=True)


def _clean_up_interrupted(target: Path) -> None:
    """Undo what a run that was killed has left."""
    for work in target.parent.glob(f"{WORK}*"):
        if (work / "old").is_dir() and not target.exists():
            (work / "old").rename(target)
        shutil.rmtree(work)


def _list_files(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield the files of a package by their path, with slashes, but not what was built; of a checkout, no libraries."""
    whole = (folder / LIST).exists()
    for root, folders, names in os.walk(folder):
        folders[:] = sorted(set(folders) - {"__pycache__", ".git"})
        for name in sorted(names):
            path = (Path(root) / name).relative_to(folder).as_posix()
            if BUILT.fullmatch(path) or name == ".DS_Store":
                continue
            if whole or not IGNORED.fullmatch(path):
                yield path, Path(root) / name


def _read_list(data: bytes) -> dict[str, str]:
    """Return the digests of an installed package's files; empty if it has no list."""
    lines = data.decode("utf-8", "replace").splitlines()
    return {path: digest for digest, _, path in (line.partition("  ") for line in lines)}


def _order(version: str) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", version))


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
