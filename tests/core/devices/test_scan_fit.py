"""Responses are recovered from simulated scans, despite noise, wrong positions and unknown air.

Independent NumPy code simulates the scans, and judges the field at a focus.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.acoustics.directivity import T4010A1_CUBICS
from pacinian.devices.scan import decode_drives
from pacinian.devices.scan_fit import fit_scan

FOCI = np.array([[0.0, 0.0, 0.2], [0.03, -0.02, 0.15], [-0.05, 0.04, 0.3]])
C = 347.3  # [m/s], 27 degC
AUTD = pc.autd()
SPARSE = pc.lattice(
    0.17, 0.13, 0.022, transducer=pc.T4010A1
)  # as wide, with a quarter of the transducers


def simulate(array: pc.Array, q: Any, c: float = C, loss: float = 1.32) -> Any:
    """Return B / P0, (M, N), of the T4010A1 in air that absorbs `loss` dB/m."""
    d = q[:, None] - array.positions
    r = np.linalg.norm(d, axis=2)
    theta = np.degrees(np.arccos(np.clip((d * array.normals).sum(axis=2) / r, -1.0, 1.0)))
    D = np.zeros_like(theta)
    for i, cubic in enumerate(T4010A1_CUBICS):
        part = (theta > 10.0 * i) & (theta <= 10.0 * i + 10.0)
        D[part] = np.polyval(cubic[::-1], theta[part] - 10.0 * i)
    D[theta >= 90.0] = 0.0
    return D / r * 10.0 ** (-loss * r / 20.0) * np.exp(-2j * np.pi * 40e3 / c * r)


def scatter(N: int, rng: np.random.Generator, degrees: float = 20.0) -> Any:
    return (1.0 + 0.1 * rng.normal(size=N)) * np.exp(1j * np.radians(degrees) * rng.normal(size=N))


def place(M: int, rng: np.random.Generator, width: float = 0.1) -> Any:
    return rng.uniform([-width, -width, 0.2], [width, width, 0.4], (M, 3))


def disturb(X: Any, noise: float, rng: np.random.Generator) -> Any:
    size = noise * np.sqrt(np.mean(np.abs(X) ** 2) / 2.0)
    return X + size * (rng.normal(size=X.shape) + 1j * rng.normal(size=X.shape))


def focus(array: pc.Array, truth: Any, believed: Any) -> Any:
    """Return the radiation pressure at foci, relative to that with all waves in phase."""
    B = simulate(array, FOCI)
    g = np.exp(-1j * np.angle(B * believed))
    return np.abs((B * truth * g).sum(axis=1)) ** 2 / np.abs(B * truth).sum(axis=1) ** 2


def differ(found: Any, truth: Any) -> Any:
    """Return the errors of responses, apart from a common factor."""
    z = found / truth
    return z / z.mean() - 1.0


@pytest.mark.parametrize("seed", range(3))
def test_without_noise_the_focus_is_that_of_an_ideal_array(seed: int) -> None:
    rng = np.random.default_rng(seed)
    truth, q = scatter(249, rng), place(8, rng)
    fit = fit_scan(AUTD, q, simulate(AUTD, q) * truth)
    assert (
        focus(AUTD, truth, np.ones(249)) < 0.95
    ).all()  # without calibration, foci would be weaker
    assert (focus(AUTD, truth, fit.responses) > 0.9999).all()
    assert fit.speed_of_sound == pytest.approx(C, abs=0.05)
    assert not (fit.dead | fit.unseen | fit.reversed).any()


@pytest.mark.parametrize("seed", range(5))
def test_noise_and_wrong_positions_cost_what_is_told(seed: int) -> None:
    """With 3 % noise, 1 mm errors in each coordinate and 12 positions, fitting positions keeps 0.998 of P."""
    rng = np.random.default_rng(seed)
    truth, q = scatter(249, rng), place(12, rng)
    given = q + 1e-3 * rng.normal(size=q.shape)
    X = disturb(simulate(AUTD, q) * truth, 0.03, rng)
    fit = fit_scan(AUTD, given, X)
    assert (focus(AUTD, truth, fit.responses) > 0.998).all()
    naive = (simulate(AUTD, given).conj() * X).sum(axis=0)
    assert focus(AUTD, truth, naive).min() < focus(AUTD, truth, fit.responses).min()
    wrong = np.sqrt(np.mean(np.abs(differ(fit.responses, truth)) ** 2 / 2.0))
    told = np.sqrt(np.mean(fit.phase_errors**2 + fit.gain_errors**2) / 2.0)
    assert wrong < 2.0 * told < 8.0 * wrong
    assert abs(fit.speed_of_sound - C) < 4.0 * fit.speed_error
    assert np.abs(fit.positions - q).mean() < np.abs(given - q).mean()


@pytest.mark.deep
def test_nine_units() -> None:
    rng = np.random.default_rng(0)
    array = pc.autd(3, 3)
    truth, q = scatter(len(array), rng), place(12, rng, 0.25)
    X = disturb(simulate(array, q) * truth, 0.03, rng)
    fit = fit_scan(array, q + 1e-3 * rng.normal(size=q.shape), X)
    assert (focus(array, truth, fit.responses) > 0.998).all()


@pytest.mark.parametrize("factor", [1.0, 1e-9j, -3e8, np.exp(2j)])
def test_the_microphone_s_gain_and_phase_do_not_matter(factor: complex) -> None:
    rng = np.random.default_rng(1)
    truth, q = scatter(249, rng), place(7, rng)
    X = disturb(simulate(AUTD, q) * truth, 0.01, rng)
    fit, plain = fit_scan(AUTD, q, factor * X), fit_scan(AUTD, q, X)
    np.testing.assert_allclose(fit.responses, plain.responses, atol=1e-7)
    assert np.abs(fit.responses).mean() == pytest.approx(1.0)
    assert fit.pressure == pytest.approx(abs(factor) * np.abs(truth).mean(), rel=0.01)


def test_dead_reversed_unseen_and_absurd_readings_are_told_apart() -> None:
    rng = np.random.default_rng(2)
    truth, q = scatter(249, rng), place(10, rng)
    truth[[3, 17]] = 0.0
    truth[[5, 100, 101]] *= -1.0
    X = disturb(simulate(AUTD, q) * truth, 0.03, rng)
    X[2, 40], X[3, 41], X[7, 3] = 1e6, -80.0, 50j
    X[:, 60] = np.nan
    X[rng.uniform(size=X.shape) < 0.05] = np.nan  # missing readings do no harm
    fit = fit_scan(AUTD, q, X)
    assert np.flatnonzero(fit.dead).tolist() == [3, 17]
    assert np.flatnonzero(fit.reversed).tolist() == [5, 100, 101]
    assert np.flatnonzero(fit.unseen).tolist() == [60]
    assert fit.responses[60] == 1.0
    assert (fit.responses[[3, 17]] == 0.0).all()
    assert 1 <= fit.outliers <= 10
    good = ~fit.dead & ~fit.unseen
    assert np.abs(differ(fit.responses[good], truth[good])).max() < 0.1


def test_half_reversed_half_dead() -> None:
    """Transducers are soldered either way round, and most of them are missing."""
    rng = np.random.default_rng(4)
    truth, q = scatter(249, rng), place(10, rng)
    truth[:120] *= -1.0
    truth[::3] = truth[1::3] = 0.0
    fit = fit_scan(AUTD, q, disturb(simulate(AUTD, q) * truth, 0.02, rng))
    alive = np.abs(truth) > 0.0
    assert np.array_equal(fit.dead, ~alive)
    assert np.array_equal(fit.reversed, alive & (np.arange(249) < 120))


def test_a_transducer_that_faces_away_is_unseen() -> None:
    rng = np.random.default_rng(5)
    normals = np.tile([0.0, 0.0, 1.0], (249, 1))
    normals[7] = [0.0, 0.0, -1.0]
    array = pc.Array(AUTD.positions, normals, AUTD.transducer)
    truth, q = scatter(249, rng), place(8, rng)
    fit = fit_scan(array, q, disturb(simulate(array, q) * truth, 0.01, rng))
    assert np.flatnonzero(fit.unseen).tolist() == [7]


def test_a_position_that_is_wrong_is_corrected_and_one_that_is_nonsense_counts_little() -> None:
    rng = np.random.default_rng(6)
    truth, q = scatter(249, rng), place(12, rng)
    given = q.copy()
    given[4, 0] += 0.006
    X = disturb(simulate(AUTD, q) * truth, 0.01, rng)
    X[7] = X[7, ::-1]
    fit = fit_scan(AUTD, given, X)
    assert np.linalg.norm(fit.positions[4] - q[4]) < 1e-3
    assert np.flatnonzero(fit.residuals > 0.5).tolist() == [7]
    assert np.flatnonzero(fit.doubtful).tolist() == [7]
    assert (focus(AUTD, truth, fit.responses) > 0.999).all()


def test_patterns_of_all_channels_hear_better_than_one_at_a_time() -> None:
    """With a Hadamard matrix and the same noise in each reading, the error is smaller by sqrt(256)."""
    from scipy.linalg import hadamard

    rng = np.random.default_rng(7)
    truth, q = scatter(249, rng), place(8, rng)
    X = simulate(AUTD, q) * truth
    noise = 0.2 * (rng.normal(size=(256, 8)) + 1j * rng.normal(size=(256, 8)))
    G = hadamard(256)[:, :249].astype(complex)
    alone = differ(
        fit_scan(AUTD, q, X + noise[:249].T).responses, truth
    ).real  # positions contain phases, too
    together = differ(fit_scan(AUTD, q, decode_drives(G, G @ X.T + noise)).responses, truth).real
    assert 12.0 < np.linalg.norm(alone) / np.linalg.norm(together) < 20.0


def scan(**changes: Any) -> dict[str, Any]:
    rng = np.random.default_rng(8)
    truth, q = scatter(len(SPARSE), rng), place(8, rng)
    X = disturb(simulate(SPARSE, q) * truth, 0.02, rng)
    made = {"array": SPARSE, "positions": q, "readings": X}
    return made | {name: change(made[name]) for name, change in changes.items()}


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"positions": lambda q: 1e3 * q}, "millimetres"),
        ({"positions": lambda q: 1e2 * q}, "millimetres|do not fit"),  # centimetres
        pytest.param(
            {"positions": lambda q: q[:, [1, 0, 2]]}, "do not fit", marks=pytest.mark.deep
        ),
        pytest.param({"positions": lambda q: q[::-1]}, "do not fit", marks=pytest.mark.deep),
        (
            {"positions": lambda q: q * [1.0, 1.0, -1.0]},
            "show the sound of no transducer|do not fit",
        ),
        ({"positions": lambda q: np.where(q > 0.3, np.nan, q)}, "finite"),
        ({"positions": lambda q: np.r_[q[:-1], SPARSE.positions[:1]]}, "on a transducer"),
        ({"positions": lambda q: q[:5], "readings": lambda X: X[:5]}, "6 to 1000.*not 5"),
        ({"positions": lambda q: q[:0], "readings": lambda X: X[:0]}, "6 to 1000.*not 0"),
        ({"positions": lambda q: q[:, :2]}, "shape"),
        ({"readings": lambda X: X[:, :62]}, r"shape \(8, 63\)"),
        pytest.param({"readings": lambda X: X[:, ::-1]}, "do not fit", marks=pytest.mark.deep),
        ({"readings": lambda X: X.conj()}, "sign of all phases is reversed"),
        pytest.param({"readings": np.abs}, "do not fit", marks=pytest.mark.deep),
        ({"readings": lambda X: 0.0 * X}, "not 0"),
        ({"readings": lambda X: np.nan * X}, "not 0"),
        ({"readings": lambda X: np.where(X.real > 0.0, np.inf, X)}, "finite"),
        ({"readings": lambda X: disturb(0.0 * X + 1e-9, 1e9, np.random.default_rng(0))}, "do not"),
        ({"array": lambda a: pc.lattice(0.17, 0.13, 0.011, transducer=pc.T4010A1)}, "shape"),
        pytest.param(
            {"array": lambda a: a.replace_transducer(pc.Transducer(frequency=25e3))},
            "do not fit|corrected",
            marks=pytest.mark.deep,
        ),
    ],
)
def test_what_does_not_fit_is_refused_with_what_to_look_at(
    changes: dict[str, Any], told: str
) -> None:
    with pytest.raises(pc.ArgumentError, match=told):
        fit_scan(**scan(**changes))


def test_positions_wrong_by_more_than_is_said_are_refused() -> None:
    """If a wrong wavelength would fit as well, no calibration is better than a wrong one."""
    refused = 0
    for seed in range(5):
        rng = np.random.default_rng(seed)
        truth, q = scatter(249, rng), place(8, rng)
        X = disturb(simulate(AUTD, q) * truth, 0.03, rng)
        try:
            fit = fit_scan(AUTD, q + 3e-3 * rng.normal(size=q.shape), X)
        except pc.ArgumentError:
            refused += 1
        else:
            assert (focus(AUTD, truth, fit.responses) > 0.98).all()
    assert refused >= 4


def test_drives_that_do_not_tell_channels_apart_are_refused() -> None:
    rng = np.random.default_rng(9)
    Y = rng.normal(size=(20, 3)) + 0j
    for G in (
        np.eye(20, 30),
        np.ones((20, 4)),
        np.zeros((20, 4)),
        np.vander(np.linspace(0, 1, 20), 12),
    ):
        with pytest.raises(pc.ArgumentError, match=r"drives.*distinguish"):
            decode_drives(G.astype(complex), Y)


def turn(array: pc.Array, shift: Any, axis: Any) -> pc.Array:
    """Return the array, rotated about its centre by a rotation vector [rad], then shifted [m], by SciPy."""
    R = Rotation.from_rotvec(axis)
    r = R.apply(array.positions - array.centre) + array.centre + shift
    return pc.Array(r, array.normals @ R.as_matrix().T, array.transducer)


def choose_files(M: int, F: int, rng: np.random.Generator) -> tuple[Any, Any]:
    """Return the file of each position, (M, 1), and gain and phase of the microphone in each file, (F,)."""
    files = rng.permutation(np.arange(M) % F)[:, None]
    factors = np.exp(rng.uniform(-1.0, 1.0, F) + 1j * rng.uniform(-3.0, 3.0, F))
    return files, factors / factors[0]


def miss(seed: int, F: int = 1) -> dict[str, Any]:
    """Return the errors of a fit to a random scan, in standard errors, and whether the band contains the focus.

    F: number of files.
    """
    rng = np.random.default_rng(seed)
    nx, ny, M = rng.integers(4, 7), rng.integers(4, 7), rng.integers(9, 16)
    pitch, noise = rng.uniform(0.01, 0.016), rng.uniform(0.01, 0.06)
    array = pc.lattice((nx - 1) * pitch, (ny - 1) * pitch, pitch, transducer=pc.T4010A1)
    N, place_error = len(array), rng.uniform(2e-4, 1e-3)
    truth, q = 3.0 * scatter(N, rng), rng.uniform([-0.1, -0.1, 0.12], [0.1, 0.1, 0.35], (M, 3))
    shift, axis = 1.5e-3 * rng.normal(size=3), 8e-3 * rng.normal(size=3)
    c, loss = 343.0 + 5.0 * rng.normal(), 1.365 * (1.0 + 0.2 * rng.normal())
    X = disturb(simulate(turn(array, shift, axis), q, c, loss) * truth, noise, rng)
    files, factors = choose_files(M, F, np.random.default_rng([seed, F]))
    fit = fit_scan(
        array, q + place_error * rng.normal(size=q.shape), X * np.exp(2j) * factors[files], files=files,
        position_error=place_error, shift_error=1.5e-3, turn_error=8e-3,
    )  # fmt: skip
    strength = np.abs(truth).mean()
    s = truth / strength
    s *= np.exp(-0.5j * np.angle((s**2 / np.abs(s)).sum()))
    s *= np.sign(s.real.sum())
    pose = np.r_[fit.shift - shift, fit.turn - axis] / fit.pose_errors
    unsure = pc.Uncertainty(
        pressure=fit.pressure_error, gain=fit.gain_errors, phase=fit.phase_errors
    )
    found = replace(
        array.replace_transducer(replace(pc.T4010A1, pressure=fit.pressure)), response=fit.responses
    )
    focus = np.array([[0.01, -0.01, 0.15]])
    air = pc.Air(speed_of_sound=c, absorption=loss * np.log(10.0) / 20.0)
    gains = np.exp(-1j * np.angle(pc.matrix(found, focus, air)[0]))
    band = pc.predict_sound_pressure(found, gains, focus, unsure, air, samples=400)
    p = np.abs((simulate(array, focus, c, loss) * truth) @ gains)
    return {
        "speed": (fit.speed_of_sound - c) / fit.speed_error,
        "shift": pose[:3],
        "turn": pose[3:],
        "P0": np.log(fit.pressure / strength) / fit.pressure_error,
        "gain": (np.abs(fit.responses) / np.abs(s) - 1.0) / fit.gain_errors,
        "phase": np.angle(fit.responses / s) / fit.phase_errors,
        "positions": (fit.positions - q) / fit.position_errors,
        "factors": np.log(fit.factors / factors)[1:].view(float).reshape(-1, 2)
        / fit.factor_errors[1:],
        "band": np.where((band.low <= p) & (p <= band.high), 0.0, np.inf),
    }


@pytest.mark.deep
@pytest.mark.parametrize(("F", "scans"), [(1, 80), (3, 200)])
def test_of_many_scans_the_truth_lies_in_the_95_percent_intervals(F: int, scans: int) -> None:
    """Random arrays, positions, noise, poses and air. A share of 200 independent trials is 0.95 +- 0.015."""
    misses = [miss(seed, F) for seed in range(scans)]
    for name in misses[0] if F > 1 else misses[0].keys() - {"factors"}:
        share = np.mean(np.concatenate([np.abs(np.ravel(one[name])) for one in misses]) < 1.96)
        low = 0.92 if name in ("gain", "phase", "positions") else 0.89
        assert low < share < 0.99, (name, share)


@pytest.mark.parametrize("F", [2, 3])
def test_each_file_has_its_own_gain_and_phase_of_the_microphone(F: int) -> None:
    """The calibration is the same whatever they are; taken as one scan, it was off by 10 degrees."""
    rng = np.random.default_rng(F)
    truth, q = scatter(63, rng), place(12, rng)
    X = disturb(simulate(SPARSE, q) * truth, 0.03, rng)
    X[3, 5], X[8, 7] = 1e6j, -50.0
    given = q + 1e-3 * rng.normal(size=q.shape)
    files, factors = choose_files(12, F, rng)
    fit = fit_scan(SPARSE, given, X * factors[files], files=files)
    same = fit_scan(SPARSE, given, X, files=files)
    one = fit_scan(SPARSE, given, X)
    np.testing.assert_allclose(fit.responses, same.responses, atol=1e-5)
    np.testing.assert_allclose(fit.phase_errors, same.phase_errors, rtol=1e-3)
    assert (
        np.abs(differ(fit.responses, truth)).mean()
        < 2.0 * np.abs(differ(one.responses, truth)).mean()
    )
    away = np.abs(np.log(fit.factors / factors)[1:].view(float).reshape(-1, 2))
    assert (away < 4.0 * fit.factor_errors[1:]).all()
    assert fit.factors[0] == 1.0
    assert not fit.factor_errors[0].any()
    mixed = fit_scan(SPARSE, given, X * factors[files])
    assert fit.residual < 0.06 < mixed.residual


def test_files_that_share_no_transducer_count_as_one() -> None:
    """Their gains cannot be compared, but for a third file that shares transducers with both."""
    rng = np.random.default_rng(3)
    truth, q = scatter(63, rng), place(12, rng)
    X = disturb(simulate(SPARSE, q) * truth, 0.02, rng)
    halves = np.tile(np.arange(63) // 32, (12, 1))
    fit, one = fit_scan(SPARSE, q, X, files=halves), fit_scan(SPARSE, q, X)
    np.testing.assert_array_equal(fit.responses, one.responses)
    assert np.isnan(fit.factor_errors).tolist() == [[False] * 2, [True] * 2]
    assert fit.factors.tolist() == [1.0, 1.0]
    halves[8:] = 2
    factors = np.array([1.0, 1.4j, -0.8])
    fit = fit_scan(SPARSE, q, X * factors[halves], files=halves)
    assert (
        np.abs(np.log(fit.factors / factors)[1:].view(float)).reshape(-1, 2)
        < 4.0 * fit.factor_errors[1:]
    ).all()
    assert np.abs(differ(fit.responses, truth)).mean() < 0.03


@pytest.mark.parametrize("files", [-1, 1000, 0.5, [0, 1], "first"])
def test_numbers_of_files_that_cannot_be_are_refused(files: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`files`"):
        fit_scan(**scan(), files=files)


@pytest.mark.parametrize("scans", [10, pytest.param(40, marks=pytest.mark.deep)])
def test_an_array_that_is_further_off_than_was_said_has_wider_errors(scans: int) -> None:
    """Poses off by 3 times their errors: 95 % intervals of the scans hold nine of ten values, and say that they grew.

    With the errors as given, they held two of three.
    """
    array = pc.lattice(0.06, 0.06, 0.012, transducer=pc.T4010A1)
    misses, widened = [], []
    for seed in range(scans):
        rng = np.random.default_rng(seed)
        q = rng.uniform([-0.1, -0.1, 0.2], [0.1, 0.1, 0.4], (12, 3))
        shift, axis = 3e-3 * rng.normal(size=3), 15e-3 * rng.normal(size=3)
        X = simulate(turn(array, shift, axis), q) * scatter(len(array), rng)
        given = q + 1e-3 * rng.normal(size=q.shape)
        fit = fit_scan(array, given, disturb(X, 0.03, rng))
        misses.append(np.r_[fit.shift - shift, fit.turn - axis] / fit.pose_errors)
        widened.append(fit.widened)
    assert np.mean(np.abs(misses) < 1.96) > 0.85
    assert np.sqrt(np.mean(np.square(misses))) < 1.5
    assert 2.0 < np.median(widened, axis=0)[1] < 4.0
    assert np.median(widened, axis=0)[0] < 1.2  # the positions were as good as said


@pytest.mark.parametrize(
    ("q", "told"),
    [
        (
            np.array([[0.0, 0.0, 0.2]]),
            "not 1: .*; the scan does not determine the speed of sound: give",
        ),
        (
            np.array([[0.0, 0.0, 0.2], [0.03, 0.0, 0.3], [0.0, 0.05, 0.25]]),
            "not 3: .*; .*determine.*turn",
        ),
    ],
)
def test_what_too_few_positions_do_not_tell_is_told(q: Any, told: str) -> None:
    X = disturb(simulate(AUTD, q), 0.03, np.random.default_rng(0))
    with pytest.raises(pc.ArgumentError, match=told):
        fit_scan(AUTD, q, X)


def test_what_a_scan_does_not_tell_is_told() -> None:
    """On a line through the centre, a rotation about it is unknown. From far away, no pose is known."""
    rng = np.random.default_rng(1)
    line = np.c_[np.zeros((9, 2)), np.linspace(0.2, 0.4, 9)]
    far = rng.uniform([-0.1, -0.1, 2.9], [0.1, 0.1, 3.0], (12, 3))
    for q, told, count in ((line, "turn of the array about z: measure", 1), (far, "shift", 2)):
        vague = fit_scan(AUTD, q, disturb(simulate(AUTD, q), 0.03, rng)).vague
        assert len(vague) == count
        assert told in vague[0]
    good = place(12, rng)
    fit = fit_scan(AUTD, good, disturb(simulate(AUTD, good), 0.03, rng))
    assert not fit.vague
    assert not fit.doubtful.any()


def test_gaps_that_leave_fewer_readings_than_unknowns_are_refused() -> None:
    rng = np.random.default_rng(2)
    q = place(8, rng)
    X = simulate(AUTD, q)
    X[np.arange(8)[:, None] != np.arange(249) % 8] = np.nan  # one reading of each transducer
    with pytest.raises(pc.ArgumentError, match=r"498 numbers for 530 unknowns.*distinguished.*34"):
        fit_scan(AUTD, q, X)
