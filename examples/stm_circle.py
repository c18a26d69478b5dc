"""Spatio-temporal modulation: one focus that runs along a circle, 100 times per second."""

import sys

import numpy as np

import pacinian as pc
from pacinian import plot
from pacinian.testing import ManualClock

array = pc.autd(3, 3)
spark = pc.Point(
    position=(0.0, 0.0, 0.2),
    radiation_pressure=20.0,  # [Pa]
    technique=pc.STM(100.0, along=pc.Circle(0.015)),  # [Hz], [m]
    name="circle",
)
clock = ManualClock()  # simulated time, so nothing waits
emitted, places = [], []
with pc.Renderer(array, pc.Scene((spark,)), adaptive=False, clock=clock) as renderer:
    for tick in range(20):  # two turns of 10 ms
        clock.time = tick * renderer.period
        renderer.tick(clock.time)
        emitted.append(renderer.emitted_gains)
        places.append(renderer.samples.positions if renderer.samples else np.empty((0, 3)))
last = np.concatenate(places[-10:])
print(f"{len(last)} places in the last turn, {np.ptp(last[:, 0]) * 1e3:.0f} mm across")
page = plot.slices(
    array, np.array(emitted[-10:]), last, title="STM: the mean over one turn", medium=pc.Air()
)
plot.save(page, sys.argv[1] if len(sys.argv) > 1 else "stm_circle.png")
