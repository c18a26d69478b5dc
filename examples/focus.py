"""The strongest focus that nine AUTD units can make 20 cm above them."""

import sys

import numpy as np

import pacinian as pc
from pacinian import plot

array, air = pc.autd(3, 3), pc.Air()
point = np.array([[0.0, 0.0, 0.2]])  # [m]
solution = pc.solve(array, point, [1.0], scale="max", medium=air)
p = pc.field(array, solution.gains, point, medium=air)  # complex [Pa]
print(
    f"{pc.sound_pressure_level(p)[0]:.0f} dB SPL, {pc.radiation_pressure(p, air)[0]:.0f} Pa on skin"
)
print(f"{solution.solver}: {solution.saturation:.0%} of {len(array)} transducers at full drive")
page = plot.slices(array, solution.gains, point, air, "One focus")
plot.save(page, sys.argv[1] if len(sys.argv) > 1 else "focus.png")
