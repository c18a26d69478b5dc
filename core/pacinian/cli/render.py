"""`pacinian render`."""

from __future__ import annotations

import stat
from pathlib import Path
from typing import Any

import click

from pacinian.cli.options import PATH, TEXT, FiniteRange, NonEmptyPath
from pacinian.cli.run_output import check_picture_path


def _check_record_path(
    context: click.Context, parameter: click.Parameter, path: str | None
) -> str | None:
    """Refuse a pipe or a socket, because its reader could stop the loop during a tick. Raises BadParameter."""
    try:
        mode = Path(path).stat().st_mode if path else 0
    except (OSError, ValueError):  # not there yet, or the recorder says what is wrong
        return path
    if stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode):
        problem = "is a pipe or a socket, whose reader could stop the run: give a file"
        raise click.BadParameter(f"{path!r} {problem}")
    return path


@click.command()
@click.argument("scene", type=NonEmptyPath(path_type=Path))
@click.option(
    "--seconds",
    type=FiniteRange(0.0, 1e9),
    default=5.0,
    show_default=True,
    help="Duration; 0 to run until Ctrl-C.",
)
@click.option("--solver", type=TEXT, default=None, help="Override the file's solver.")
@click.option("--backend", type=TEXT, default=None, help="Override the file's backend.")
@click.option(
    "--record",
    type=PATH,
    default=None,
    callback=_check_record_path,
    help="Record every tick to this file: scene, decisions, frame.",
)
@click.option(
    "--strict",
    is_flag=True,
    help="Never degrade: leave out, coarsen or interpolate nothing; exit with code 1 if anything was not as asked.",
)
@click.option(
    "--out",
    type=PATH,
    default=None,
    callback=check_picture_path,
    help="Draw the field of the last tick to this PNG.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a table.")
def render(
    scene: Path,
    seconds: float,
    solver: str | None,
    backend: str | None,
    record: str | None,
    strict: bool,
    out: str | None,
    as_json: bool,
) -> None:
    """Render a scene file on an array.

    It is TOML or JSON; `pacinian schema` prints its schema. The exit code is 1 after a fault, or if the picture that
    was asked for could not be drawn.
    """
    from msgspec.structs import replace

    from pacinian.cli.plugin_blame import forbid_exit, keep_renderer_open
    from pacinian.cli.run_output import picture, print_summary, progress, summary
    from pacinian.cli.run_verdict import ProcessorMeter
    from pacinian.rendering.recording import Recorder
    from pacinian.rendering.renderer_from_file import make_renderer
    from pacinian.scene.file import load_scene_file

    if out:  # before anything runs
        from pacinian.plot.page import require

        require()
    file = load_scene_file(scene)
    if solver:
        file = replace(file, solver=solver)
    if backend:
        file = replace(file, backend=backend)
    with forbid_exit():
        renderer = make_renderer(file, scene, strict=strict)
    if record:
        renderer.recorder = Recorder(record)
    extra: dict[str, Any] = {
        "seconds": seconds,
        "scene": str(scene),
        "record": record or "",
        "strict": strict,
    }
    with (
        forbid_exit(),
        keep_renderer_open(renderer),
        progress(scene.name, seconds or 1.0, as_json) as on_tick,
    ):
        meter = ProcessorMeter()
        renderer.run(seconds or None, on_tick)
        others = meter.measure_others()
    extra["picture"] = picture(renderer, out or "", scene.name, quiet=as_json)
    remedy = "give the scene file a lower `rate`, a smaller `array` or fewer objects"
    print_summary(summary(renderer, extra, others), as_json, remedy)
    if out and not extra["picture"]:
        raise SystemExit(1)
