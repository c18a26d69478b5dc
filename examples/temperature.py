"""What an error in the temperature of the air costs: a focus that is weaker, and elsewhere."""

import sys

import matplotlib.pyplot as plt
import numpy as np

import pacinian as pc

ASSUMED, HEIGHT = 22.0, 0.2  # [degC], [m]
errors = np.arange(-10, 11)  # [K], of the air less what was assumed
x, z = (v.ravel() for v in np.mgrid[-15:15.5:0.5, -15:15.5:0.5] / 1e3)  # about the focus [m]
figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 3.2), layout="constrained")
for side, aside in ((1, 0.0), (3, 0.0), (3, 0.15)):
    array, name = pc.autd(side, side), f"{side * side} units" if side > 1 else "1 unit"
    focus = array.centre * [1, 1, 0] + [aside, 0.0, HEIGHT]
    places = focus + np.stack([x, 0.0 * x, z], axis=1)
    air = pc.Air(temperature=ASSUMED)
    gains = pc.solve(array, focus[None], [1.0], scale="max", medium=air).gains
    P = []  # radiation pressure there [Pa], by error
    for error in errors.tolist():
        true = pc.Air(temperature=ASSUMED + error)
        P.append(pc.radiation_pressure(pc.field(array, gains, places, true), true))
    kept = np.array(P)[:, len(x) // 2] / P[10][len(x) // 2]  # of it, at the focus
    top = places[np.argmax(P, axis=1)]
    moved = np.linalg.norm(top - top[10], axis=1)  # [m]
    name += f", {1e3 * aside:g} mm aside" if aside else ""
    left.plot(errors, 100.0 * kept, label=name)
    right.plot(errors, 1e3 * moved, label=name)
    for at in (5, 10):
        lost, off = 1.0 - min(kept[10 - at], kept[10 + at]), max(moved[10 - at], moved[10 + at])
        print(
            f"{name}, {at} degrees wrong: {lost:.0%} of the pressure lost, {1e3 * off:.1f} mm off"
        )
left.set(xlabel="error of the temperature [K]", ylabel="radiation pressure at the focus [%]")
right.set(xlabel="error of the temperature [K]", ylabel="the strongest place is off by [mm]")
left.set_ylim(0.0)
left.legend()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "temperature.png", dpi=120)
