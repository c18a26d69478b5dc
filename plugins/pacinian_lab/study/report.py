"""The report of a study: Markdown, with pictures."""

from __future__ import annotations

import math
import re
from collections import Counter, defaultdict
from statistics import median
from typing import TYPE_CHECKING

from pacinian_lab.study import charts, images
from pacinian_lab.study.measures import MEASURES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

    from pacinian_lab.study.store import Table
    from pacinian_lab.study.tasks import Plan
    from pacinian_lab.study.worker import Row

IN_TABLE = (
    "width_across_x", "width_along", "reach", "yield", "efficiency", "side_lobe", "contrast",
    "condition",
)  # fmt: skip
OF_SOLVERS = ("error", "shape_error", "scale", "efficiency", "contrast", "saturation", "run_time")
FAILURES = 20  # maximum number of reasons listed


def write(
    plan: Plan, table: Table, folder: Path, advance: Callable[[], object] = lambda: None
) -> list[Path]:
    """Write report.md and its pictures; return the files. advance: called for each image. Raises MissingExtra."""
    rows = table.to_pylist()
    good = [row for row in rows if row["failure"] is None]
    files = [folder / "layouts.png"]
    images.layouts(plan, files[0])
    files += images.images(plan, folder, advance)
    if good:
        files += [folder / "measures.png", folder / "trends.png"]
        charts.measures(good, files[-2])
        charts.trends(good, files[-1])
    report = folder / "report.md"
    report.write_text(text(plan, rows, [file.name for file in files]), encoding="utf-8")
    return [report, *files]


def text(plan: Plan, rows: Sequence[Row], files: Iterable[str]) -> str:
    """Return the report in Markdown. rows: of the finished tasks. files: its pictures."""
    good = [row for row in rows if row["failure"] is None]
    bad = [row for row in rows if row["failure"] is not None]
    parts = [f"# {_plain(plan.study.title) or 'A study'}", _head(plan, rows, bad)]
    parts += [f"![{name.removesuffix('.png')}]({name})" for name in files]
    for plane in dict.fromkeys(row["plane"] for row in good):
        parts += [f"## {_plain(plane)}", "Medians over patterns, solvers and levels."]
        parts.append(
            _format_table("layout", IN_TABLE, [r for r in good if r["plane"] == plane], sizes=True)
        )
    if good:
        parts += ["## Solvers", "Medians over everything else."]
        parts.append(_format_table("solver", OF_SOLVERS, good))
        parts += ["## Measures", _meanings()]
    if bad:
        parts += ["## Failures", _failures(bad)]
    return "\n\n".join(parts) + "\n"


def _head(plan: Plan, rows: Sequence[Row], bad: Sequence[Row]) -> str:
    study, done = plan.study, f"{len(rows)} of {len(plan.tasks)} tasks are done"
    failed = f", {len(bad)} of them failed" if bad else ""
    gain = "no limit" if study.gain == math.inf else f"|g| <= {study.gain:g}"
    emitted = ""
    if study.emitted is not None:
        emitted = (
            f", rounded to {study.emitted.phases} phases and {study.emitted.amplitudes} amplitudes"
        )
    element = study.transducer
    most = {"layout": images.LAYOUTS, "plane": images.PLANES, "pattern": images.PATTERNS}
    left = [
        f"{first} of {count} {part}s"
        for part, first in most.items()
        if (count := len({getattr(task.place, part).label for task in plan.tasks})) > first
    ]
    drawn = f" Pictures show the first {', '.join(left)}." if left else ""
    return (
        f"{done}{failed}. Gains: {gain}{emitted}. Transducers: {element.directivity}, {element.pressure:g} Pa m, "
        f"{1e-3 * element.frequency:g} kHz. Picture: {1e3 * study.picture.side:g} mm, a pixel every "
        f"{1e3 * study.picture.step:g} mm. Seed {study.seed}.{drawn}"
    )


def _format_table(
    by: str, columns: Sequence[str], rows: Sequence[Row], *, sizes: bool = False
) -> str:
    head = [
        by,
        *(["N", "aperture [mm]", "spacing [mm]"] if sizes else []),
        *map(charts.format_measure, columns),
    ]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    groups: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        groups[row[by]].append(row)
    for name, found in groups.items():
        cells = [_plain(name)]
        if sizes:
            first = found[0]
            cells += [str(first["transducers"])]
            cells += [f"{1e3 * first[key]:.3g}" for key in ("aperture", "spacing")]
        cells += [figure(charts.values(found, column)) for column in columns]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def figure(found: Sequence[float]) -> str:
    """Return the median of finite values as text."""
    return f"{median(found):.3g}" if found else "-"


def _plain(text: str) -> str:
    """Return a name on one line, with Markdown's special characters escaped."""
    return re.sub(r"([\\`*_|<>#\[\]])", r"\\\1", " ".join(text.split()))


def _meanings() -> str:
    return "\n".join(
        f"- **{charts.format_measure(name)}**: {m.meaning}" for name, m in MEASURES.items()
    )


def _failures(bad: Sequence[Row]) -> str:
    reasons = Counter(row["failure"] for row in bad)
    lines = [f"- {count} x {_plain(reason)}" for reason, count in reasons.most_common(FAILURES)]
    if len(reasons) > FAILURES:
        lines.append(
            f"- and {len(reasons) - FAILURES} other reasons: see `failure` in results.parquet"
        )
    return "\n".join(lines)
