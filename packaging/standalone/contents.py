"""What the standalone server contains: Pacinian, the installed plug-ins, and the distributions that they require."""

from __future__ import annotations

import importlib.metadata
import re
import sysconfig
from typing import TYPE_CHECKING, NamedTuple

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from PyInstaller.utils.hooks import collect_data_files, collect_submodules

if TYPE_CHECKING:
    from pathlib import Path

GROUP = "pacinian"
EXTRAS = "devices", "autd3"  # libraries of backends; what is not installed is left out
LABORATORY = "pacinian_lab"  # benchmarks and studies
LEFT_OUT = LABORATORY, "autd3_emulator", "tkinter"
UNUSED = (
    "**/*.[hc]pp",
    "viewing/page/*",
)  # sources of kernels; the viewer's page, whose server is not here
LICENCES = re.compile(r"\.dist-info/(.*/)?(LICEN[CS]E|COPYING|NOTICE|AUTHORS)[^/]*$", re.IGNORECASE)


class Contents(NamedTuple):
    """modules: to collect. plugins: their packages. files: (source, folder in the bundle). excluded: modules.

    metadata: (name in the bundle, source, kind) of the files that tell versions, plug-ins and licences.
    """

    modules: list[str]
    plugins: list[str]
    files: list[tuple[str, str]]
    excluded: list[str]
    metadata: list[tuple[str, str, str]]


def describe_contents(work: Path) -> Contents:
    """Describe what goes into the bundle. work: a folder for generated files."""
    points = [
        point
        for point in importlib.metadata.entry_points(group=GROUP)
        if not point.module.startswith(LABORATORY)
    ]
    plugins = sorted({point.module.split(".")[0] for point in points})
    ours = sorted({GROUP, *plugins})
    required, optional = find_distributions({p.dist.name for p in points if p.dist})
    installed = importlib.metadata.packages_distributions()
    modules = {
        module: {canonicalize_name(name) for name in names} for module, names in installed.items()
    }
    drivers = [m for m, names in modules.items() if names <= optional and m.isidentifier()]
    return Contents(
        modules=[m for package in (*ours, *drivers) for m in collect_submodules(package)],
        plugins=plugins,
        files=[
            (f"{sysconfig.get_path('stdlib')}/LICENSE.txt", "python"),
            *(file for package in ours for file in collect_data_files(package, excludes=UNUSED)),
        ],
        metadata=[
            file for name in sorted(required | optional) for file in copy_metadata(name, work)
        ],
        excluded=[
            *LEFT_OUT,
            *(
                m
                for m, names in modules.items()
                if not names & (required | optional) and m not in ours
            ),
        ],
    )


def find_distributions(names: set[str]) -> tuple[set[str], set[str]]:
    """Return the canonical names of installed distributions: those that `names` require, and those of their extras."""
    required = _close({(name, "") for name in names})
    every = _close({(name, extra) for name in names for extra in ("", *EXTRAS)})
    return required, every - required


def copy_metadata(name: str, work: Path) -> list[tuple[str, str, str]]:
    """Return the files that tell a distribution's version, plug-ins and licences, without paths of this machine."""
    made = importlib.metadata.distribution(name)
    folder = f"{canonicalize_name(made.name).replace('-', '_')}-{made.version}.dist-info"
    points = (made.read_text("entry_points.txt") or "").splitlines()
    texts = {
        "METADATA": made.read_text("METADATA") or "",
        "entry_points.txt": "\n".join(line for line in points if f"= {LABORATORY}." not in line),
    }
    (work / folder).mkdir(parents=True, exist_ok=True)
    for file, text in texts.items():
        (work / folder / file).write_text(text, encoding="utf-8")
    licences = [path for path in made.files or () if LICENCES.search(path.as_posix())]
    return [
        *((f"{folder}/{file}", str(work / folder / file), "DATA") for file in texts),
        *(("/".join([folder, *path.parts[1:]]), str(path.locate()), "DATA") for path in licences),
    ]


def _close(waiting: set[tuple[str, str]]) -> set[str]:
    """Return the installed distributions that (distribution, extra) pairs lead to."""
    found: set[str] = set()
    seen: set[tuple[str, str]] = set()
    while waiting:
        name, extra = pair = waiting.pop()
        if pair in seen:
            continue
        seen.add(pair)
        try:
            requires = importlib.metadata.requires(name) or []
        except importlib.metadata.PackageNotFoundError:
            continue
        found.add(canonicalize_name(name))
        for requirement in map(Requirement, requires):
            wanted = requirement.marker is None or requirement.marker.evaluate({"extra": extra})
            if wanted and canonicalize_name(requirement.name) not in map(
                canonicalize_name, LEFT_OUT
            ):
                waiting |= {(requirement.name, more) for more in ("", *requirement.extras)}
    return found
