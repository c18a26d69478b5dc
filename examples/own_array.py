"""A custom array: rings of transducers on a bowl, two of them dead, and the focus that it makes."""

import sys

import numpy as np

import pacinian as pc
from pacinian import plot

BOWL, RINGS = 0.2, 7  # radius of the bowl [m]; number of rings
places, normals = [[0.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]]
for ring in range(1, RINGS + 1):
    theta = ring * 0.011 / BOWL  # 11 mm between rings
    for phi in 2.0 * np.pi * np.arange(6 * ring) / (6 * ring):
        x, y = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
        places.append([BOWL * x, BOWL * y, BOWL * (1.0 - np.cos(theta))])
        normals.append([-x, -y, np.cos(theta)])  # towards the bowl's centre
array = pc.Array(np.array(places), np.array(normals), pc.T4010A1)
alive = np.ones(len(array), bool)
alive[[5, 40]] = False
array, air = array.remove_transducers(~alive), pc.Air()
point = np.array([[0.0, 0.0, 0.15]])  # [m]
solution = pc.solve(array, point, [1.0], scale="max", medium=air)
P = pc.radiation_pressure(pc.field(array, solution.gains, point, medium=air), air)
print(f"{len(array)} transducers, {P[0]:.1f} Pa at the focus")
page = plot.slices(array, solution.gains, point, air, "Seven rings on a bowl")
plot.save(page, sys.argv[1] if len(sys.argv) > 1 else "own_array.png")
