"""Results of the scenes benchmark, as tables for a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian_lab.solvers.tables import plain_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from pacinian_lab.scenes.audibility import Sound
    from pacinian_lab.scenes.growth import Growth
    from pacinian_lab.scenes.report import Verdict
    from pacinian_lab.scenes.run import Row
    from pacinian_lab.scenes.savings import Saving


def scenes(rows: Sequence[Row]) -> Table:
    """Return a table of the ticks of each scene."""
    head = [
        "", "samples", "p50\n[ms]", "p99\n[ms]", "late\n[%]", "dummy\n[%]", "held\n[Hz]", "solves\n[1/s]",
        "lag\n[ms]",
    ]  # fmt: skip
    lines = [
        [
            row.scene, str(row.samples), f"{row.p50_ms:.3f}", f"{row.p99_ms:.3f}",
            f"{100 * row.late:.2f}", f"{100 * row.dummy_late:.2f}", f"{row.rate:.0f}",
            f"{row.solves:.0f}", f"{row.lag_ms:.1f}",
        ]
        for row in rows
    ]  # fmt: skip
    return plain_table("Ticks of each scene", head, lines)


def tabulate_felt(rows: Sequence[Row]) -> Table:
    """Return a table of what each scene makes the skin feel, compared with its request."""
    head = [
        "", "error at\nsamples", "force", "rms\nerror", "holes", "spill", "left\nout",
    ]  # fmt: skip
    lines = [
        [
            row.scene, f"{100 * row.error_at_samples:.2f}",
            *(["", "", "", ""] if row.felt is None else [f"{100 * x:.1f}" for x in row.felt.values()]),
            f"{100 * row.left_out:.1f}",
        ]
        for row in rows
    ]  # fmt: skip
    return plain_table(
        "Pressure relative to the request: at the samples, over all touched skin [%]",
        head,
        lines,
    )


def stages(rows: Sequence[Row]) -> Table:
    """Return a table of the time of each stage."""
    names = list(dict.fromkeys(stage for row in rows for stage in row.stages))
    lines = [[row.scene, *(f"{row.stages.get(name, 0.0):.3f}" for name in names)] for row in rows]
    return plain_table("Mean time of each stage in a tick [ms]", ["", *names], lines)


def savings(found: Sequence[Saving]) -> Table:
    """Return a table with a row for each skip."""
    lines = [
        [
            one.what, f"{one.on_ms:.3f}", f"{one.off_ms:.3f}", f"{100 * one.ratio:.1f}",
            "" if one.limit is None else f"{100 * one.limit:.0f}",
        ]
        for one in found
    ]  # fmt: skip
    head = ["", "with\n[ms]", "without\n[ms]", "left\n[%]", "target\n[%]"]
    return plain_table("Tick times with and without each skip: medians", head, lines)


def growth(found: Sequence[Growth]) -> Table:
    """Return a table with a row for each number of objects."""
    lines = [
        [
            str(line.objects), f"{line.near:.0f}", f"{line.still_ms:.3f}",
            f"{line.still_ms / found[0].still_ms:.2f}", f"{100 * line.linear(found[0]):.3g}",
            f"{line.replaced_ms:.3f}", f"{line.replaced_ms / found[0].replaced_ms:.2f}",
        ]
        for line in found
    ]  # fmt: skip
    head = [
        "objects", "near", "tick\n[ms]", f"over\n{found[0].objects}", "of linear\n[%]",
        "one replaced\neach tick [ms]", f"over\n{found[0].objects}",
    ]  # fmt: skip
    return plain_table("Growth with the number of objects: medians", head, lines)


def sounds(found: Sequence[Sound]) -> Table:
    """Return a table of the audible noise."""
    head = ["", "focus: off", "aligned", "on", "ears: off", "aligned", "on"]
    lines = [[one.what, *(f"{dB:.0f}" for dB in one.focus + one.ear)] for one in found]
    return plain_table(
        "Audible energy of |p|^2 over its mean square [dB(A)], by smooth output", head, lines
    )


def verdicts(found: Sequence[Verdict]) -> Table:
    """Return a table with a line for each target."""
    lines = [["met" if one.met else "missed", f"{one.target}: {one.found}"] for one in found]
    made = plain_table("Targets", ["", ""], lines)
    made.show_header = False
    made.columns[1].justify, made.columns[1].no_wrap = "left", False
    return made
