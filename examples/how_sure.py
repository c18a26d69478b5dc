"""How sure a focus is: strength, temperature and single transducers are not known exactly."""

import sys

import numpy as np

import pacinian as pc
from pacinian import plot

array, air = pc.autd(3, 3), pc.Air(temperature=22.0)
focus = np.array([[0.0, 0.0, 0.2]])  # [m]
gains = pc.solve(array, focus, pc.sound_pressure([20.0], air), medium=air).gains
x = np.linspace(-0.02, 0.02, 81)  # [m]
line = np.column_stack([x, 0.0 * x, np.full(len(x), 0.2)])
unsure = {
    "temperature, 5 degrees": pc.Uncertainty(temperature=5.0),
    "and phases, 0.4 rad": pc.Uncertainty(temperature=5.0, phase=0.4),
    "and strength, 15 %": pc.Uncertainty(temperature=5.0, phase=0.4, pressure=0.15),
}
page = plot.figure(7.0, 2.6)
for panel, (name, uncertainty) in zip(
    page.subplots(1, 3, sharey=True), unsure.items(), strict=True
):
    band = pc.predict_radiation_pressure(array, gains, line, uncertainty, air, samples=500)
    panel.fill_between(1e3 * x, band.low, band.high, alpha=0.3, linewidth=0, label="95 %")
    panel.plot(1e3 * x, band.mean, label="mean")
    panel.plot(1e3 * x, band.nominal, "--", color="0.4", label="nominal")
    panel.set_xlabel("x [mm]")
    panel.set_title(name, fontsize=9)
    middle = len(x) // 2
    print(f"{name}: {band.low[middle]:.1f} to {band.high[middle]:.1f} Pa at the focus")
page.axes[0].set(ylabel="radiation pressure [Pa]", ylim=(0.0, None))
page.axes[0].legend(fontsize=6)
plot.save(page, sys.argv[1] if len(sys.argv) > 1 else "how_sure.png")
