"""Four points that press with 20 Pa each, 20 cm above nine AUTD units."""

import numpy as np

import pacinian as pc

array = pc.autd(3, 3)  # 2241 transducers
air = pc.Air(temperature=22.0, humidity=0.4)
points = np.array(
    [[0.03, 0.03, 0.2], [-0.03, 0.03, 0.2], [-0.03, -0.03, 0.2], [0.03, -0.03, 0.2]]
)  # [m]
amplitudes = pc.sound_pressure(np.full(4, 20.0), air)  # [Pa] of sound for 20 Pa on skin
solution = pc.solve(array, points, amplitudes, medium=air)
print(solution)
p = pc.field(array, solution.gains, points, medium=air)
print(pc.radiation_pressure(p, air))  # [20. 20. 20. 20.]
