"""The Fourier baseline: right where its assumptions hold, lost where they do not."""

import numpy as np
import pytest

import pacinian as pc
from pacinian_lab.paper import experiment, fourier

k = experiment.MEDIUM.wavenumber(40_000.0)


def test_one_sample_gives_the_paraxial_focus():
    array, q, z = pc.lattice(0.1, 0.1), np.array([[0.02, -0.03, 2.0]]), 2.0
    g = fourier.gains(array.positions, q, np.ones(1), z, k)
    p = pc.field(array, g, q, experiment.MEDIUM, precision="double")
    assert np.abs(p[0]) == pytest.approx(len(array), rel=1e-4)


def test_gains_are_the_inverse_transform_times_a_lens_phase():
    array = pc.lattice(0.05, 0.07)
    u, v = experiment.grid()
    q = np.stack([0.1 * u, 0.1 * v, 0.0 * u], axis=-1).reshape(-1, 3)
    t = experiment.pattern("cross").ravel()
    g = fourier.gains(array.positions, q, t, 0.6, k)
    r = array.positions
    n = 17
    lens = np.exp(0.5j * k / 0.6 * (r[n] @ r[n]))
    assert g[n] == pytest.approx(lens * (t * np.exp(-1j * k / 0.6 * (q @ r[n]))).sum())


@pytest.mark.parametrize("name", ["disc", "cross"])
def test_far_away_it_makes_the_image_as_well_as_the_pseudo_inverse(name):
    found = fourier.compare("1a far", name)
    assert found.correlation > 0.9
    assert found.correlation == pytest.approx(found.pseudo_inverse.correlation, abs=0.02)


@pytest.mark.parametrize("place", ["1a", "2a"])
def test_near_by_and_upright_the_pseudo_inverse_is_better(place):
    found = fourier.compare(place, "cross")
    assert found.correlation < 0.5
    assert found.correlation < found.pseudo_inverse.correlation - 0.2


def test_the_amplitude_shown_is_the_multiple_nearest_to_the_target():
    case, target = experiment.case("1a", fourier.FAR_HEIGHT), experiment.pattern("disc")
    size = fourier.amplitude(case, target, fourier.FAR_HEIGHT)
    errors = [np.linalg.norm(factor * size - target) for factor in (0.99, 1.0, 1.01)]
    assert min(errors) == errors[1]


def test_a_known_outcome_is_not_solved_again():
    known = experiment.Outcome("2a", "ring", experiment.pattern("ring"), np.ones((41, 41)), 0, 0, 0)
    assert fourier.compare("2a", "ring", known).pseudo_inverse is known
