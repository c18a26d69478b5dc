"""Three points with and without a quiet zone at an ear: the solver satisfies both."""

import sys

import numpy as np

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
line = np.linspace(-0.06, 0.08, 400)  # [m] through two points and the ear
row = np.stack([line, 0 * line, 0 * line + 0.2], axis=-1)
page = figure(6.0, 3.4)
panel = page.subplots()
for solution, name in ((free, "without"), (kept, "with the quiet zone")):
    level = pc.sound_pressure_level(pc.field(array, solution.gains, row, medium=air))
    panel.plot(1e3 * line, level, lw=1.0, label=name)
left, right = ear.position[0] - ear.radius, ear.position[0] + ear.radius
panel.axvspan(1e3 * left, 1e3 * right, color="0.85", label="ear")
panel.set(xlabel="x [mm]", ylabel="level [dB re 20 µPa]", title="A quiet zone", ylim=(75, None))
panel.legend(loc="upper left", fontsize=8)
save(page, sys.argv[1] if len(sys.argv) > 1 else "quiet_zone.png")
