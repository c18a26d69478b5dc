"""Four points with 20, 20, 10 and 10 Pa, 20 cm above nine AUTD units, checked by computing the field."""

import sys

import numpy as np

import pacinian as pc
from pacinian import plot

array = pc.autd(3, 3)  # 2241 transducers
air = pc.Air(temperature=22.0, humidity=0.4)
points = np.array(
    [[0.03, 0.03, 0.2], [-0.03, 0.03, 0.2], [-0.03, -0.03, 0.2], [0.03, -0.03, 0.2]]
)  # [m]
amplitudes = pc.sound_pressure([20.0, 20.0, 10.0, 10.0], air)  # peak sound pressure [Pa]
solution = pc.solve(array, points, amplitudes, medium=air)
print(solution)
p = pc.field(array, solution.gains, points, medium=air)
print(pc.radiation_pressure(p, air))  # [20. 20. 10. 10.]
page = plot.slices(array, solution.gains, points, air, "Four control points")
plot.save(page, sys.argv[1] if len(sys.argv) > 1 else "control_points.png")
