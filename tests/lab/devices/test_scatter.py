"""The formulas of what scatter costs, against random arrays."""

from __future__ import annotations

import numpy as np
import pytest

from pacinian_lab.devices.scatter import measure_scatter, predict_power, predict_unevenness


@pytest.mark.parametrize("N", [249, 2241])
@pytest.mark.parametrize(("degrees", "percent"), [(10, 5), (20, 10), (45, 20)])
def test_a_focus_keeps_what_is_predicted(N: int, degrees: float, percent: float) -> None:
    """Written out here once more: independent draws, by NumPy alone."""
    rng = np.random.default_rng(N)
    b = rng.uniform(0.3, 1.0, N)
    e, f = rng.normal(size=(2, 400, N))
    p = ((1.0 + 0.01 * percent * e) * np.exp(1j * np.radians(degrees) * f)) @ b
    P = np.abs(p) ** 2
    predicted = predict_power(b[None] + 0j, degrees, percent)[0]
    assert P.mean() == pytest.approx(predicted, abs=4.0 * P.std() / 20.0)
    assert predicted / b.sum() ** 2 == pytest.approx(
        np.exp(-(np.radians(degrees) ** 2)), abs=2.0 / N
    )


def test_twenty_degrees_and_ten_per_cent() -> None:
    assert predict_power(np.ones((1, 2241), complex), 20, 10)[0] / 2241**2 == pytest.approx(
        0.885, abs=5e-4
    )


def test_points_become_as_uneven_and_silence_as_loud_as_predicted() -> None:
    rng = np.random.default_rng(3)
    b = rng.normal(size=(40, 500)) + 1j * rng.normal(size=(40, 500))
    power, uneven = measure_scatter(b, 15, 5, 300)
    np.testing.assert_allclose(power, predict_power(b, 15, 5), rtol=0.1)
    assert uneven == pytest.approx(predict_unevenness(b, 15, 5), rel=0.06)
    silent = b[:1] - b[:1].mean()
    found = measure_scatter(silent, 15, 5, 2000)[0][0]
    assert found == pytest.approx(predict_power(silent, 15, 5)[0], rel=0.1)
    assert found > 0.0
