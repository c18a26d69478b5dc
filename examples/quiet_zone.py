"""Three points with and without a quiet zone at an ear: the solver satisfies both."""

import sys

import numpy as np
from matplotlib.patches import Circle

import pacinian as pc
from pacinian.plot import figure, save

array, air = pc.autd(3, 3), pc.Air()
points = np.array([[0.02, 0.0, 0.2], [-0.02, 0.0, 0.2], [0.0, 0.03, 0.2]])  # [m]
amplitudes = pc.sound_pressure([15.0, 15.0, 15.0], air)  # peak sound pressure [Pa]
# A ball in a side lobe of the pattern, with a limit of 20 Pa peak sound pressure (117 dB).
ear = pc.Zone(position=(0.05, 0.0, 0.2), pressure=20.0, radius=0.006)
rng = np.random.default_rng(1)
ways = rng.normal(size=(500, 3))
ways *= np.cbrt(rng.random((500, 1))) / np.linalg.norm(ways, axis=1, keepdims=True)
inside = np.array(ear.position) + ear.radius * ways  # places that the solver does not know


def at_ear(solution: pc.Solution) -> float:
    """Return the highest level at the ear [dB SPL]."""
    p = pc.field(array, solution.gains, inside, medium=air)
    return float(pc.sound_pressure_level(p).max())


free = pc.solve(array, points, amplitudes, medium=air)
limits = pc.Limits(zones=(ear,))
kept = pc.solve(array, points, amplitudes, limits=limits, medium=air)
print(f"allowed: {pc.sound_pressure_level(ear.pressure):.1f} dB at the ear")
print(f"without: {at_ear(free):.1f} dB at the ear, error {free.error:.2%}")
print(f"with:    {at_ear(kept):.1f} dB at the ear, error {kept.error:.2%}")
x, y = np.linspace(-0.06, 0.08, 281), np.linspace(-0.04, 0.06, 201)  # [m]
places = np.stack([*np.meshgrid(x, y), np.full((201, 281), 0.2)], axis=-1)
page = figure(7.0, 4.6)
grid = page.add_gridspec(2, 2, height_ratios=[1.2, 1.0])
maps = [page.add_subplot(grid[0, k]) for k in range(2)]
curves = page.add_subplot(grid[1, :])
for panel, solution, name in zip(maps, (free, kept), ("without", "with"), strict=True):
    level = pc.sound_pressure_level(pc.field(array, solution.gains, places, medium=air))
    panel.imshow(level, vmin=80.0, vmax=155.0, origin="lower", extent=(-60, 80, -40, 60))
    panel.add_patch(Circle((50.0, 0.0), 6.0, fill=False, color="white"))
    panel.set(title=f"{name} the quiet zone", xlabel="x [mm]", ylabel="y [mm]")
    curves.plot(1e3 * x, level[80], lw=1.0, label=name)  # at y = 0: two of the points, and the ear
page.colorbar(maps[0].images[0], ax=maps, label="level [dB re 20 µPa]", extend="min", fraction=0.05)
allowed = float(pc.sound_pressure_level(ear.pressure))
curves.axhline(allowed, color="0.3", lw=0.8, ls="--", label="allowed")
curves.axvspan(44.0, 56.0, color="0.85", label="ear")
curves.set(xlabel="x [mm], at y = 0", ylabel="level [dB re 20 µPa]", xlim=(-60, 80))
curves.legend(loc="lower left", fontsize=8)
save(page, sys.argv[1] if len(sys.argv) > 1 else "quiet_zone.png")
