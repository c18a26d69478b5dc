"""One focus: nine AUTD units press with 20 Pa, 20 cm above them."""

import sys

import pacinian as pc
from pacinian import plot

array, air = pc.autd(3, 3), pc.Air()
point = [[0.0, 0.0, 0.2]]  # [m]
solution = pc.solve(array, point, pc.sound_pressure([20.0], air), medium=air)
p = pc.field(array, solution.gains, point, medium=air)  # complex [Pa]
print(
    f"{pc.sound_pressure_level(p)[0]:.0f} dB SPL, {pc.radiation_pressure(p, air)[0]:.0f} Pa on skin"
)
print(
    f"{solution.solver}: the strongest transducer at {abs(solution.gains).max():.0%} of full drive"
)
page = plot.slices(array, solution.gains, point, air, "One focus of 20 Pa")
plot.save(page, sys.argv[1] if len(sys.argv) > 1 else "focus.png")
