"""`pacinian demo`."""

from __future__ import annotations

from typing import Any

import click

from pacinian.cli.options import TEXT, FiniteRange
from pacinian.cli.run_output import check_picture_path


@click.command()
@click.option(
    "--seconds", type=FiniteRange(0.1, 3600), default=10.0, show_default=True, help="Duration."
)
@click.option(
    "--units",
    type=click.IntRange(1, 9),
    default=3,
    show_default=True,
    help="AUTD units along each side.",
)
@click.option(
    "--rate",
    type=FiniteRange(1, 20_000),
    default=1000.0,
    show_default=True,
    help="Ticks per second.",
)
@click.option(
    "--solver", type=TEXT, default="auto", show_default=True, help="See `pacinian plugins`."
)
@click.option(
    "--out",
    default="demo.png",
    callback=check_picture_path,
    show_default=True,
    help="The picture; empty for none.",
)
@click.option(
    "--dummy", is_flag=True, help="For comparison, also run a loop that only burns as much time."
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a table.")
def demo(
    seconds: float, units: int, rate: float, solver: str, out: str, dummy: bool, as_json: bool
) -> None:
    """Render a moving ball on a simulated array, and draw it.

    A ball circles around a button at 1 kHz above 9 AUTD units. Afterwards, prints how well that went, and draws the
    field of the last tick.
    """
    if not as_json:  # at once: the first import and the kernels may take seconds
        count = "one simulated AUTD unit" if units == 1 else f"{units**2} simulated AUTD units"
        click.echo(f"A ball circles a button above {count}, for {seconds:g} s ...", err=True)

    from pacinian.acoustics.array import autd
    from pacinian.cli.plugin_blame import forbid_exit, keep_renderer_open
    from pacinian.cli.run_output import picture, print_summary, progress, summary
    from pacinian.cli.run_verdict import ProcessorMeter, describe_success
    from pacinian.demo_scene import alternate, make_circling_scene
    from pacinian.plugins.registry import backend
    from pacinian.rendering.renderer import Renderer

    array = autd(units, units)
    device = backend("simulated", rate=rate)
    renderer = Renderer(array, make_circling_scene, solver=solver, backend=device, rate=rate)
    extra: dict[str, Any] = {"seconds": seconds}
    others: float | None = None
    with (
        forbid_exit(),
        keep_renderer_open(renderer),
        progress("rendering", seconds * (2 if dummy else 1), as_json) as on_tick,
    ):
        meter = ProcessorMeter()
        if dummy:  # which only burns the processor's time
            extra["dummy"] = alternate(renderer, seconds, on_tick).summary()
        else:
            renderer.run(seconds, on_tick)
            others = meter.measure_others()
    title = "A circling ball and a button: radiation pressure"
    extra["picture"] = picture(renderer, out, title, quiet=as_json)
    less = "" if units == 1 else "fewer units (`--units 1`), or "
    figures = summary(renderer, extra, others)
    if not as_json and (success := describe_success(figures)):
        click.echo(success)
    print_summary(figures, as_json, f"try {less}a lower `--rate`")
