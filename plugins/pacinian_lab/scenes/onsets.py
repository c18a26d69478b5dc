"""Measure the audible noise and the largest step of objects that appear, vanish, hop and vibrate.

Run: `python -m pacinian_lab.scenes.onsets [--rows 1 --rows 40]`. The device has so many levels that they
add no noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import click
import numpy as np

from pacinian import gallery
from pacinian.acoustics.air import Air
from pacinian.acoustics.array import autd
from pacinian.acoustics.propagation import matrix
from pacinian.plugins.backend import MAX_LEVELS, Capability
from pacinian.rendering.audibility import compute_envelope, measure_audible
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.rerender import CaptureBackend
from pacinian.scene.modulation.envelope import STEADY
from pacinian.scene.modulation.waves import Constant, Square
from pacinian.scene.objects import Point
from pacinian.scene.scene import Scene
from pacinian.testing import ManualClock

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.scene.modulation.envelope import Envelope
    from pacinian.types import Gains

AIR = Air()
TICKS, EVENT = 400, 0.2  # ticks at 1 kHz; time of the event [s], in the middle
QUIET = 0.025  # [s] of silence between two owners
HERE, THERE = (0.0, 0.0, gallery.HEIGHT), (0.03, 0.0, gallery.HEIGHT)  # [m]
FIVE_PLACES = tuple((0.02 * k - 0.04, 0.01 * (k % 2), gallery.HEIGHT) for k in range(5))
STRONG, WEAK = 20.0, 0.05  # [Pa]
EMPTY = Scene()


@dataclass(frozen=True)
class Coming:
    """Worst values over some places.

    level: audible energy of |p|^2 over its mean square [dB(A)]. step: largest change of |p| from row to row, relative
    to the highest |p|.
    """

    what: str
    level: float
    step: float


def point(
    position: tuple[float, float, float] = HERE, pressure: float = STRONG, name: str = "one",
    envelope: Envelope = STEADY,
) -> Point:  # fmt: skip
    """Return a point with a name."""
    return Point(position=position, radiation_pressure=pressure, name=name, envelope=envelope)


ONE, FAINT = Scene((point(),)), Scene((point(pressure=WEAK),))
FIVE_POINTS = Scene(tuple(point(q, STRONG / 5.0, str(k)) for k, q in enumerate(FIVE_PLACES)))
OTHER = Scene((point(THERE, name="other"),))
STAYS = point(THERE, name="stays")
BESIDE = Scene((STAYS, point(envelope=Square(200.0))))


def after(before: Scene, then: Scene) -> Callable[[float], Scene]:
    """Return a scene that is `before` until the event, and `then` afterwards."""
    return lambda t: before if t < EVENT else then


def owners(t: float) -> Scene:
    """One owner's scene, silence, then another owner's scene."""
    return ONE if t < EVENT else EMPTY if t < EVENT + QUIET else OTHER


def squares(frequency: float) -> Callable[[float], Scene]:
    """Return a scene with a point that vibrates with a square wave."""
    scene = Scene((point(envelope=Square(frequency)),))
    return lambda t: scene


CASES: dict[str, Callable[[float], Scene]] = {
    "a point appears": after(EMPTY, ONE),
    "a point vanishes": after(ONE, EMPTY),
    "a weak point appears": after(EMPTY, FAINT),
    "a weak point vanishes": after(FAINT, EMPTY),
    "five points, armed": after(EMPTY, FIVE_POINTS),
    "five points, disarmed": after(FIVE_POINTS, EMPTY),
    "another owner": owners,
    "a point hops 30 mm": after(ONE, Scene((point(THERE),))),
    "a point appears beside another": after(Scene((STAYS,)), Scene((STAYS, point()))),
    "a point drops to half its pressure": after(ONE, Scene((point(pressure=STRONG / 2.0),))),
    "an envelope drops from 1 to 0.3": after(ONE, Scene((point(envelope=Constant(0.3)),))),
    "square, 100 Hz": squares(100.0),
    "square, 200 Hz": squares(200.0),
    "square, 200 Hz, beside a steady point": lambda t: BESIDE,
}


def measure(array: Array, rows: int) -> list[Coming]:
    """Measure all cases, with `rows` rows per tick."""
    return [
        evaluate(what, collect_gains(array, scene, rows), rows, array)
        for what, scene in CASES.items()
    ]


def evaluate(what: str, made: Gains, rows: int, array: Array) -> Coming:
    """Evaluate rows of gains, (R, N)."""
    places = np.array([HERE, THERE, *FIVE_PLACES])
    e, rate = compute_envelope(made, 1000.0 * rows, array, places, AIR)
    p = np.abs(made @ matrix(array, places, AIR).T)
    top = p.max(axis=0)
    loud = top > 0.3 * top.max()
    step = np.abs(np.diff(p[:, loud], axis=0)).max(axis=0) / top[loud]
    return Coming(
        what, float(measure_audible(e[:, loud], rate, weighted=True).max()), float(step.max())
    )


def collect_gains(
    array: Array, scene: Callable[[float], Scene], rows: int, ticks: int = TICKS
) -> Gains:
    """Return the rows of gains, (ticks * rows, N)."""
    device = CaptureBackend(Capability(MAX_LEVELS, MAX_LEVELS, rate=1000.0 * rows))
    made: list[Gains] = []
    with Renderer(array, scene, backend=device, clock=ManualClock(), adaptive=False) as renderer:
        for k in range(ticks):
            device.frame = None
            renderer.tick(k * renderer.period)
            if device.frame is None:  # the tick repeated the last frame
                made.append(np.repeat(made[-1][-1:], rows, axis=0))
            else:
                made.append(device.frame.gains(device.capability))
    for fault in renderer.report.faults:
        raise fault.cause
    return np.concatenate(made)


@click.command()
@click.option("--rows", multiple=True, type=int, default=(1, 2, 4), help="Rows per tick.")
@click.option("--units", default=1, help="Side of the array, in units.")
def main(rows: tuple[int, ...], units: int) -> None:
    """Print a Markdown table."""
    array = autd(units, units)
    found = [measure(array, count) for count in rows]
    click.echo("| | " + " | ".join(f"{1000 * count} Hz: dB(A), step" for count in rows) + " |")
    click.echo("|---|" + "---|" * len(rows))
    for one in zip(*found, strict=True):
        cells = (f"{x.level:.1f}, {x.step:.3f}" for x in one)
        click.echo(f"| {one[0].what} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
