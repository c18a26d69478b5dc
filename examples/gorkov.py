"""A bead in a twin trap: the potential of the acoustic radiation force, from the field and its gradient.

L. P. Gor'kov, Sov. Phys. Dokl. 6, 773 (1962); the factors as in H. Bruus, Lab Chip 12, 1014 (2012). The bead is much
smaller than the wavelength.
"""

import sys

import numpy as np

import pacinian as pc
from pacinian import plot

RADIUS, DENSITY, SPEED = 1e-3, 29.0, 900.0  # of a bead of expanded polystyrene [m], [kg/m^3], [m/s]


def potential(array: pc.Array, gains: pc.Gains, points: pc.Floats, air: pc.Air) -> pc.Floats:
    """Return U = V (f1 |p|^2 / (4 rho c^2) - 3 f2 rho |v|^2 / 8) [J], (M,), at points (M, 3) [m]."""
    found = pc.differentiate_field(array, gains, points, air)
    rho, c = air.density, air.speed_of_sound
    v = found.by_points / (2.0 * np.pi * array.transducer.frequency * rho)  # velocity [m/s]
    f1 = 1.0 - rho * c**2 / (DENSITY * SPEED**2)
    f2 = 2.0 * (DENSITY - rho) / (2.0 * DENSITY + rho)
    volume = 4.0 / 3.0 * np.pi * RADIUS**3  # [m^3]
    p2, v2 = np.abs(found.value) ** 2, (np.abs(v) ** 2).sum(axis=1)
    return np.asarray(volume * (f1 * p2 / (4.0 * rho * c**2) - 3.0 * f2 * rho * v2 / 8.0))


def force(array: pc.Array, gains: pc.Gains, points: pc.Floats, air: pc.Air) -> pc.Floats:
    """Return F = -grad U [N], (M, 3), by central differences."""
    steps = 1e-5 * np.eye(3)
    both = [[potential(array, gains, points + sign * s, air) for sign in (1, -1)] for s in steps]
    return np.stack([(down - up) / 2e-5 for up, down in both], axis=1)


array, air = pc.autd(), pc.Air()
trap = np.array([0.0, 0.0, 0.1])  # [m]
gains = pc.solve(array, trap, 1.0, scale="max", medium=air).gains
gains = gains * np.where(array.positions[:, 0] > array.centre[0], 1.0, -1.0)  # halves in antiphase
x = np.linspace(-0.012, 0.012, 97)  # [m]
page = plot.figure(7.0, 2.6)
left, right = page.subplots(1, 2)
for way, name in enumerate("xyz"):
    line = trap + x[:, None] * np.eye(3)[way]
    left.plot(1e3 * x, 1e9 * potential(array, gains, line, air), label=f"along {name}")
    right.plot(1e3 * x, 1e6 * force(array, gains, line, air)[:, way], label=f"along {name}")
left.set(xlabel="from the trap [mm]", ylabel="potential [nJ]")
right.set(xlabel="from the trap [mm]", ylabel="force along the line [µN]")
weight = 4.0 / 3.0 * np.pi * RADIUS**3 * DENSITY * 9.81  # [N]
sideways = np.abs(force(array, gains, trap + x[:, None] * [1, 0, 0], air)[:, 0]).max()
print(f"the trap holds a bead sideways with {sideways / weight:.1f} times its weight")
left.legend(fontsize=6)
plot.save(page, sys.argv[1] if len(sys.argv) > 1 else "gorkov.png")
