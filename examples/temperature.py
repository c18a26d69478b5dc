"""The effect of an error in the air temperature: the focus is weaker, and displaced."""

import sys

import matplotlib.pyplot as plt
import numpy as np

import pacinian as pc

ASSUMED, HEIGHT = 22.0, 0.2  # [degC], [m]
errors = np.arange(-10, 11)  # true minus assumed temperature [K]
STEP = 5e-4  # [m] between the places around the focus
x, z = (STEP * v.ravel() for v in np.mgrid[-30:31, -30:31])


def find_peak(P: np.ndarray) -> np.ndarray:
    """Return x and z of the maximum from the focus [m], by a parabola through its neighbours in each direction."""
    P = P.reshape(61, 61)
    at = np.clip(np.unravel_index(P.argmax(), P.shape), 1, 59)
    below, above = P[at[0] - 1 : at[0] + 2, at[1]], P[at[0], at[1] - 1 : at[1] + 2]
    shift = [0.5 * (a - c) / (a - 2.0 * b + c) for a, b, c in (below, above)]
    return np.asarray(STEP * (at - 30 + np.array(shift)))


figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 3.2), layout="constrained")
for side, aside in ((1, 0.0), (3, 0.0), (3, 0.15)):
    array, name = pc.autd(side, side), f"{side * side} units" if side > 1 else "1 unit"
    focus = array.centre * [1, 1, 0] + [aside, 0.0, HEIGHT]
    places = focus + np.stack([x, 0.0 * x, z], axis=1)
    air = pc.Air(temperature=ASSUMED)
    gains = pc.solve(array, focus[None], [1.0], scale="max", medium=air).gains
    P = []  # radiation pressure at the places [Pa], by error
    for error in errors.tolist():
        true = pc.Air(temperature=ASSUMED + error)
        P.append(pc.radiation_pressure(pc.field(array, gains, places, true), true))
    kept = np.array(P)[:, len(x) // 2] / P[10][len(x) // 2]  # fraction that remains at the focus
    top = np.array([find_peak(one) for one in P])
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
right.set(xlabel="error of the temperature [K]", ylabel="displacement of the maximum [mm]")
left.set_ylim(0.0)
left.legend()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "temperature.png", dpi=120)
