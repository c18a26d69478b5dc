"""Change the code in small ways, one at a time, and count how many changes the tests notice.

    python -m pip install -e ".[mutants]"
    python tests/mutants.py --report build/mutants.json    # 200 changes, 50 an area, on two cores
    python tests/mutants.py --again build/mutants.json --report build/after.json

A change (a *mutant*) that no test notices is either harmless or a gap in the tests; the report lists them with their
diffs. `--again` repeats the changes of an earlier report, so that two states of the tests can be compared.
"""

from __future__ import annotations

import argparse
import difflib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from itertools import groupby
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.plugins import get_operator, operator_names

ROOT = Path(__file__).parent.parent
MAX_TEST_SECONDS = 600.0  # a change that makes the tests take longer has been noticed
LEFT_OUT = re.compile(
    "Bit|Shift|Mod|FloorDiv|_Pow$|Invert|RemoveDecorator"  # fail at once, or do not change the code
    "|(?<!_Is)(?<!_IsNot)_Is(Not)?$|_Is(Not)?_(?!Is)"
)
TEST = re.compile(r"tests/\S+\.py::\w+")


@dataclass(frozen=True)
class Area:
    """sources: files to change. tests: tests that should notice. Both are patterns relative to the project's root."""

    sources: tuple[str, ...]
    tests: tuple[str, ...]


SERVING, WIRE = "core/pacinian/serving", "core/pacinian/wire"
AREAS = {
    "solver": Area(
        ("plugins/pacinian_plugins/solvers/lagrange/**/*.py",),
        ("tests/plugins", "tests/core/solving", "tests/core/test_session*.py"),
    ),
    "contact": Area(
        ("core/pacinian/scene/sampling/*.py",),
        ("tests/core/scene/sampling", "tests/core/rendering/test_renderer.py"),
    ),
    "guard": Area(
        (f"{SERVING}/guard/*.py",),
        ("tests/core/serving/guard",),
    ),
    "wire": Area(
        (
            *(
                f"{WIRE}/{name}.py"
                for name in ("binary_arrays", "co*", "objects", "protocol", "replies")
            ),
            *(f"{WIRE}/{name}.py" for name in ("shapes", "state", "time", "decode_errors")),
        ),
        ("tests/core/wire", "tests/wire"),
    ),
}


@dataclass(frozen=True)
class Mutant:
    """The `occurrence`-th place in `path` that `operator` can change."""

    area: str
    path: str
    operator: str
    occurrence: int

    def apply(self, source: str) -> str:
        """Return the changed source."""
        changed = mutate_code(source, get_operator(self.operator)(), self.occurrence)
        assert changed is not None, f"{self} is not of this source"
        return str(changed)


def find_mutants(area: str, root: Path) -> list[list[Mutant]]:
    """Return all changes of an area, grouped by place."""
    operators = {
        name: get_operator(name)
        for name in operator_names()
        if not LEFT_OUT.search(name) and not get_operator(name).arguments()
    }
    found = []
    for path in sorted(p for pattern in AREAS[area].sources for p in root.glob(pattern)):
        nodes, name = list(ast_nodes(get_ast(path.read_text("utf-8")))), str(path.relative_to(root))
        for operator, kind in operators.items():
            places = [place for node in nodes for place in kind().mutation_positions(node)]
            found += [
                ((name, place), Mutant(area, name, operator, i)) for i, place in enumerate(places)
            ]
    found.sort(key=lambda f: f[0])
    return [[m for _, m in group] for _, group in groupby(found, key=lambda f: f[0])]


def sample_mutants(area: str, count: int, seed: int, root: Path) -> list[Mutant]:
    """Return one random change at each of `count` places of an area."""
    choose = random.Random(f"{seed} {area}")
    places = find_mutants(area, root)
    return [choose.choice(place) for place in choose.sample(places, min(count, len(places)))]


class Tree:
    """A copy of the project, in which one change is made at a time."""

    def __init__(self, root: Path, folder: Path) -> None:
        self.root = folder
        parts = shutil.ignore_patterns(".git", ".venv", ".*_cache", "node_modules", "build")
        shutil.copytree(root, folder, ignore=parts)

    def test(self, area: str, test: str = "") -> tuple[bool, str]:
        """Run a test, or all tests of an area. Returns whether they pass, and the last lines of their output."""
        patterns = AREAS[area].tests
        tests = (
            [test]
            if test
            else [str(p) for pattern in patterns for p in sorted(self.root.glob(pattern))]
        )
        roots = os.pathsep.join(str(self.root / r) for r in ("core", "plugins"))
        pytest = [
            *(sys.executable, "-m", "pytest", "-x", "-q", "-n0", "-p", "no:cacheprovider"),
            "--hypothesis-profile=fixed",  # all examples, always the same
        ]
        try:
            done = subprocess.run(
                [*pytest, *tests], cwd=self.root, env={**os.environ, "PYTHONPATH": roots}, text=True,
                capture_output=True, timeout=MAX_TEST_SECONDS, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return False, "timeout"
        if test and done.returncode not in (0, 1):  # the test no longer exists
            return True, ""
        return done.returncode == 0, done.stdout[-300:] + done.stderr[-300:]

    def try_mutant(self, mutant: Mutant, test: str) -> dict[str, object]:
        """Make a change, test, and undo it. Returns its report. test: the test that noticed it last time, tried
        first.
        """
        path = self.root / mutant.path
        source, times = path.read_text("utf-8"), path.stat()
        changed = mutant.apply(source)
        lines = (text.splitlines(keepends=True) for text in (source, changed))
        diff = "".join(difflib.unified_diff(*lines, mutant.path, mutant.path, n=0))
        path.write_text(changed, "utf-8")
        try:
            passed, said = self.test(mutant.area, test) if test else (True, "")
            if passed:
                passed, said = self.test(mutant.area)
        finally:
            path.write_text(source, "utf-8")
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
        return {**asdict(mutant), "noticed": not passed, "diff": diff, "said": "" if passed else said}  # fmt: skip


def tell(*words: object) -> None:
    print(*words, flush=True)  # noqa: T201


def parse_count(text: str) -> int:
    """Read an integer of at least 1."""
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number of at least 1, not {text!r}")
    return int(text)


def parse_project(text: str) -> Path:
    """Check that a folder holds the project."""
    if not (root := Path(text) / "core" / "pacinian").is_dir():
        raise argparse.ArgumentTypeError(f"{root} is not a folder")
    return Path(text)


def parse_report(text: str) -> list[dict[str, Any]]:
    """Read the changes of an earlier report, with the output of their tests."""
    try:
        rows: list[dict[str, Any]] = json.loads(Path(text).read_text("utf-8"))
        assert all(row.keys() >= {"said", *Mutant.__dataclass_fields__} for row in rows)
    except (OSError, ValueError, AttributeError, AssertionError, TypeError) as error:
        raise argparse.ArgumentTypeError(
            f"{text} is not a report of this program: {error}"
        ) from None
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument(
        "--root", type=parse_project, default=ROOT, help="project root; changes are made in copies"
    )
    parser.add_argument("--sample", type=parse_count, default=50, help="changes per area")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", type=parse_report, help="repeat this earlier report's changes")
    parser.add_argument("--area", action="append", choices=AREAS)
    parser.add_argument("--jobs", type=parse_count, default=os.cpu_count() or 1)
    parser.add_argument("--report", type=Path, required=True)
    given = parser.parse_args()
    given.report.parent.mkdir(parents=True, exist_ok=True)
    given.report.touch()
    areas = given.area or list(AREAS)
    known = {}  # by change: the test that noticed it last time
    for row in given.again or []:
        if row["area"] in areas:
            test = TEST.search(row["said"])
            known[Mutant(**{k: row[k] for k in Mutant.__dataclass_fields__})] = (
                test[0] if test else ""
            )
    for area in [] if given.again else areas:
        known |= dict.fromkeys(sample_mutants(area, given.sample, given.seed, given.root), "")
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(given.jobs) as pool:
        trees: SimpleQueue[Tree] = SimpleQueue()
        first = Tree(given.root, Path(folder) / "0")
        for area in areas:  # this also compiles all kernels
            passed, said = first.test(area)
            if not passed:
                sys.exit(f"the tests of {area} fail without any change:\n{said}")
        trees.put(first)
        for i in range(1, given.jobs):
            trees.put(Tree(first.root, Path(folder) / str(i)))

        def run(mutant: Mutant) -> dict[str, object]:
            tree = trees.get()
            try:
                row = tree.try_mutant(mutant, known[mutant])
            finally:
                trees.put(tree)
            tell("noticed" if row["noticed"] else "MISSED ", mutant)
            return row

        rows = []
        for row in pool.map(run, known):
            rows.append(row)
            given.report.write_text(json.dumps(rows, indent=1), "utf-8")
    counts = Counter(r["area"] for r in rows)
    noticed = Counter(r["area"] for r in rows if r["noticed"])
    for area in areas:
        tell(f"{area}: {noticed[area]} of {counts[area]} noticed")


if __name__ == "__main__":
    main()
