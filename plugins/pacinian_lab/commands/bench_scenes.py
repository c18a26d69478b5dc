"""`pacinian bench scenes`: measure the built-in scenes at 1 kHz."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from pacinian.cli.options import FiniteRange
from pacinian_lab.commands.shared import print_tables, require_matplotlib, units

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.acoustics.array import Array
    from pacinian_lab.scenes.audibility import Sound
    from pacinian_lab.scenes.growth import Growth
    from pacinian_lab.scenes.run import Row
    from pacinian_lab.scenes.savings import Saving

TICKS = 60  # of each side of a comparison, for each second that a scene runs


def names(
    context: click.Context, parameter: click.Parameter, given: tuple[str, ...]
) -> tuple[str, ...]:
    """Check names of scenes."""
    from pacinian.gallery import SCENES

    for name in given:
        if name not in SCENES:
            raise click.BadParameter(f"{name!r} is not one of {', '.join(SCENES)}")
    return given


@click.command()
@units
@click.option(
    "--seconds",
    type=FiniteRange(0.02, 600.0),
    default=5.0,
    show_default=True,
    help="Time to run each scene; the dummy loop runs as long again.",
)
@click.option(
    "--scene", "chosen", multiple=True, callback=names, metavar="NAME",
    help="Only this scene, without skips and growth; repeatable.  [default: all]",
)  # fmt: skip
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Also write all results to this file, as JSON.",
)
@click.option(
    "--pictures",
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    help="Only draw the scenes into this folder; measure nothing.",
)
@click.option(
    "--json", "as_json", is_flag=True,
    help="One JSON list of scenes instead of tables; skips and growth need --out.",
)  # fmt: skip
def scenes(
    side: int,
    seconds: float,
    chosen: tuple[str, ...],
    out: Path | None,
    pictures: Path | None,
    as_json: bool,
) -> None:
    """Measure the built-in scenes at 1 kHz: time per tick by stage, late ticks and error.

    Each scene alternates, second by second, with a loop that burns the same CPU time: late ticks of that loop are due
    to the machine. The command then measures what each skip saves (on and off in turn), the growth with the number of
    objects, and the audible noise with and without smooth output.
    """
    from pacinian.acoustics.array import autd
    from pacinian.gallery import SCENES
    from pacinian_lab.scenes import report as scene_report

    array, todo = autd(side, side), chosen or tuple(SCENES)
    _try(out, pictures)
    if pictures is not None:
        _draw(array, todo, pictures, as_json)
        return
    more = not chosen and (out is not None or not as_json)
    found, interrupted = _measure(array, todo, seconds, more)
    if out is not None:
        result = scene_report.plain(
            *found, units=side * side, seconds=seconds, interrupted=interrupted
        )
        out.write_text(json.dumps(result), encoding="utf-8")
    if as_json:
        click.echo(json.dumps([asdict(row) for row in found.rows]))
    else:
        _print(found)
    if interrupted:
        raise SystemExit(130)


def _try(out: Path | None, pictures: Path | None) -> None:
    """Check, before anything runs, that the results can be written."""
    try:
        if out is not None:
            out.parent.mkdir(parents=True, exist_ok=True)
            out.touch()
        if pictures is not None:
            require_matplotlib()
            pictures.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise click.BadParameter(str(error), param_hint="--out or --pictures") from error


class Found(NamedTuple):
    """The results of all measurements."""

    rows: list[Row]
    savings: list[Saving]
    growth: list[Growth]
    sounds: list[Sound]


def _measure(array: Array, todo: Sequence[str], seconds: float, more: bool) -> tuple[Found, bool]:
    """Return the results, and whether Ctrl-C interrupted the run. more: also measure skips and growth."""
    from rich.console import Console
    from rich.progress import Progress

    from pacinian_lab.scenes import audibility as sounds
    from pacinian_lab.scenes import growth, savings
    from pacinian_lab.scenes import run as scenes
    from pacinian_lab.scenes.skips import skips

    found, ticks = Found([], [], [], []), max(1, round(TICKS * seconds))
    others = skips() if more else []
    with Progress(console=Console(stderr=True), transient=True, auto_refresh=False) as bar:
        task = bar.add_task("", total=len(todo) + len(others) + 2 * more)

        def step(what: str, done: int = 1) -> None:
            bar.update(task, description=what, advance=done)
            bar.refresh()  # in this thread, because a refresh thread would disturb the loop

        try:
            for name in todo:
                step(name, 0)
                found.rows.append(scenes.measure(array, name, seconds))
                step(name)
            for skip in others:
                found.savings.append(savings.measure(array, skip, ticks))
                step("skips")
            if more:
                found.growth.extend(growth.measure(array, ticks))
                step("sounds")
                found.sounds.extend(sounds.measure(array))
        except KeyboardInterrupt:
            return found, True
    return found, False


def _print(found: Found) -> None:
    from pacinian_lab.scenes import report as scene_report
    from pacinian_lab.scenes import tables as scene_tables

    shown = [
        scene_tables.scenes(found.rows),
        scene_tables.tabulate_felt(found.rows),
        scene_tables.stages(found.rows),
    ]
    if found.savings:
        shown.append(scene_tables.savings(found.savings))
    if found.growth:
        shown.append(scene_tables.growth(found.growth))
    if found.sounds:
        shown.append(scene_tables.sounds(found.sounds))
    verdicts = scene_report.verdicts(found.rows, found.savings, found.growth)
    shown.append(scene_tables.verdicts(verdicts))
    print_tables(shown)


def _draw(array: Array, todo: Sequence[str], folder: Path, as_json: bool) -> None:
    from pacinian_lab.scenes.pictures import draw

    files = [str(path) for path in draw(array, todo, folder)]
    click.echo(json.dumps(files) if as_json else "\n".join(f"wrote {file}" for file in files))
