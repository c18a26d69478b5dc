"""RMS sound pressure from the AUTD3 project's own emulator (autd3 0.12.0), an independent reference.

Its phase p means exp(-2j pi p / 256). Its intensity i gives a pulse width of w = round(512 asin(i /
255) / pi) steps and with that the amplitude sin(pi w / 512). A unit's origin is its transducer 0.
Transducers are omnidirectional, 4.3859003539 Pa m (peak); what is returned is the RMS.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from autd3.commands import Pattern, SetSilencer
from autd3_core import Autd3, Duration, Geometry, Velocity
from autd3_emulator import Emulator, Grid, Recorder, RmsRecordOption
from autd3_pattern import IntensityBuffer, PhaseBuffer

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

PERIOD = Duration.from_micros(25)

Units = list[tuple["ArrayLike", "ArrayLike"]]
"""Units, each with its position [m] and its rotation, a quaternion (w, x, y, z)."""


def geometry(units: Units) -> Geometry:
    return Geometry([Autd3(1e3 * np.asarray(r, float), np.asarray(q, float)) for r, q in units])


def positions(units: Units) -> NDArray[np.float64]:
    """Positions of all transducers [m], shape (249 units, 3)."""
    return np.concatenate([unit.positions() for unit in geometry(units)]).astype(float) / 1e3


def rms(
    units: Units, phases: ArrayLike, intensities: ArrayLike, points: ArrayLike
) -> NDArray[np.float64]:
    """Return the RMS sound pressure [Pa] at `points` [m], shape (M, 3), for levels of shape (249 units,)."""
    devices = geometry(units)
    phase, intensity = (
        np.asarray(levels, np.uint8).reshape(len(devices), 249) for levels in (phases, intensities)
    )

    def drive(recorder: Recorder) -> None:
        recorder.send(SetSilencer.disable())  # otherwise it ramps the drive over ten periods
        recorder.send(Pattern(PhaseBuffer.from_array(phase), IntensityBuffer.from_array(intensity)))
        recorder.tick(PERIOD)

    record = Emulator(devices).record(drive)
    option = RmsRecordOption(Velocity.from_m_s(340.0))
    return np.array(
        [
            record.sound_field(Grid(x, y, z, 1.0, "xyz"), option).next(PERIOD).item(0, 0)
            for x, y, z in (1e3 * np.asarray(points, float)).tolist()
        ]
    )
