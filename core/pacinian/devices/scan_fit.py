"""The response of each transducer, from a microphone scan.

Least squares for s, q and c in

    X_mn = mu s_n B_mn(q_m, c),    B as in `pacinian.matrix`, with the absorption of air

X_mn is the reading of the microphone at position m while only transducer n is driven. mu, the microphone's gain and
phase, is one complex number for the whole scan. It cannot be separated from a factor common to all responses, so their
mean strength is set to 1 and their common phase to 0. For given positions q and speed of sound c, each s_n follows in
closed form.
Gauss-Newton steps correct q and c with s eliminated (variable projection, Golub and Pereyra 1973). Readings far from
the rest lose their weight (Cauchy's, iterated).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.propagation import matrix
from pacinian.checks import check_near, check_number, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Complexes, Flags, Floats

MIN_POSITIONS, MAX_POSITIONS = 6, 1000
MIN_SPEED, MAX_SPEED = 318.0, 366.0  # speed of sound in air of -20 and 60 degC [m/s]
TRIAL_STEP = 0.5  # step of the first grid search over the speed of sound [m/s]
SPEED, SPEED_ERROR = 343.0, 10.0  # prior of the speed of sound: a room, give or take 17 K [m/s]
POSITION_ERROR = 1e-3  # standard error of the microphone's coordinates [m]
MAX_MOVE = 2.0  # rms correction of the positions, in standard errors
MAX_STEPS = 60  # Gauss-Newton steps
SETTLED = 1e-7  # largest correction of a position at convergence [m]
OUTLYING = 3.0  # distance at which a reading loses weight, in standard errors
TYPICAL = 0.9  # quantile of the readings to which all are scaled: many may be of dead transducers
MIN_NOISE = 1e-4  # noise floor, relative to that quantile: no microphone is better
MAX_RESIDUAL = 0.5  # residual, relative to the expected rms; beyond, the scan is not of this array
MAX_ERROR = 0.1  # relative error of a response from noise; beyond, the transducer is unseen
MIN_STRENGTH = 0.1  # strength relative to the mean; below, the transducer is dead
MIN_SUM = 1e-300  # floor of sums of squares that are divisors
MEDIAN = 1.177  # median of a Rayleigh distribution of unit scale


@dataclass(frozen=True, eq=False)
class ScanFit:
    """The fit of N transducers to a scan at M positions.

    responses: complex responses, (N,), of mean strength 1; 0 if dead, 1 if unseen.
    errors: standard errors of the responses, (N,), both of their relative strengths and of their phases [rad].
    dead: weaker than a tenth of the mean, (N,). unseen: the scan does not determine the response, (N,). reversed: in
        antiphase to most others, (N,).
    positions: corrected positions of the microphone [m], (M, 3). residuals: unexplained part of a typical reading at
        each position, relative to the expected rms there, (M,). residual: the same for the whole scan. outliers:
        number of readings that lost most of their weight.
    speed_of_sound: fitted or given speed [m/s]. speed_error: its standard error [m/s]. gain: ratio of the rms reading
        to the predicted sound pressure [microphone's unit/Pa].
    """

    responses: Complexes
    errors: Floats
    dead: Flags
    unseen: Flags
    reversed: Flags
    positions: Floats
    residuals: Floats
    residual: float
    outliers: int
    speed_of_sound: float
    speed_error: float
    gain: float


def fit_scan(
    array: Array,
    positions: ArrayLike,
    readings: Complexes,
    *,
    position_error: float = POSITION_ERROR,
    speed_of_sound: float | None = None,
) -> ScanFit:
    """Fit the response of each of N transducers to a scan at M positions.

    array: array as described, without responses. positions: positions of the microphone [m], (M, 3). readings: complex
    readings in any unit, (M, N), of positive phase where the sound leads; NaN if missing. position_error: standard
    error of each coordinate [m]; above 1 mm the fit may converge a whole wavelength off. speed_of_sound: [m/s]; fitted
    by default. Raises ArgumentError, also if the scan does not fit the array.
    """
    q0 = check_numbers("positions", positions, (None, 3))
    check_near("positions", q0, array.centre)
    if not MIN_POSITIONS <= len(q0) <= MAX_POSITIONS:
        wanted = f"{MIN_POSITIONS} to {MAX_POSITIONS}; 8 or more are good"
        raise ArgumentError("positions", f"must be {wanted}, not {len(q0)}")
    check_number("position_error", position_error, low=1e-6, high=0.01)
    X = np.asarray(readings, np.complex128)
    if X.shape != (len(q0), len(array)):
        raise ArgumentError("readings", f"must have shape {(len(q0), len(array))}, not {X.shape}")
    read = ~np.isnan(X)
    finite = read.any() and bool(np.isfinite(X[read]).all())
    size = float(np.quantile(np.abs(X[read]), TYPICAL)) if finite else 0.0
    if not 0.0 < size < np.inf:
        raise ArgumentError("readings", "must be finite, and most of them not 0")
    X = np.where(read, X / size, 0.0)
    best = _Fit(array, q0, X, read, position_error, speed_of_sound)
    if best.residual > MAX_RESIDUAL:
        turned = _Fit(array, q0, X.conj(), read, position_error, speed_of_sound)
        raise ArgumentError("readings", _advise(best.residual, turned.residual))
    moved = float(np.sqrt(np.mean((best.q - q0) ** 2)))
    if moved > MAX_MOVE * position_error:
        raise ArgumentError(
            "positions",
            f"would be corrected by {1e3 * moved:.1f} mm rms in each coordinate, for an error of "
            f"{1e3 * position_error:g} mm: measure them again, and check the temperature if it is given",
        )
    return best.finish(size)


def _advise(residual: float, turned: float) -> str:
    told = f"do not fit the array: {residual:.0%} of a typical one is not explained. "
    if turned <= MAX_RESIDUAL:
        return told + "They do with phases of the other sign: count them positive where sound leads"
    return told + (
        "Check the positions (in metres, in the frame of the description), the order of the channels, the drive "
        "frequency, that phases are in radians and have one reference, and the temperature; and that it is this array"
    )


class _Fit:
    """State of the iteration. X: readings, (M, N), 0 if missing."""

    def __init__(
        self, array: Array, q: Floats, X: Complexes, read: Flags, error: float, c: float | None
    ) -> None:
        self.array, self.X, self.read, self.W = array, X, read, read.astype(np.float64)
        M = len(q)
        self.q, self.c = q.copy(), SPEED if c is None else c
        if c is None:
            self.c = self._try_speeds()
        prior = np.r_[np.full(3 * M, error), SPEED_ERROR if c is None else 1e-9] ** -2.0
        first = np.r_[q.ravel(), SPEED if c is None else c]
        for _ in range(MAX_STEPS):
            self._weigh()
            H, slope = self._normal()
            away = np.r_[self.q.ravel(), self.c] - first
            self.cov = np.linalg.inv(H / self.noise**2 + np.diag(prior))
            step = self.cov @ (slope / self.noise**2 - prior * away)
            self.q += step[:-1].reshape(M, 3)
            self.c = float(np.clip(self.c + step[-1], MIN_SPEED, MAX_SPEED))
            if np.abs(step[:-1]).max() < SETTLED:
                break
        self._weigh()

    def _propagate(self, c: float) -> Complexes:
        medium = Air(speed_of_sound=c, attenuation="absorbing")
        B: Complexes = matrix(self.array, self.q, medium) / self.array.transducer.pressure
        return B

    def _try_speeds(self) -> float:
        """Return the speed of sound [m/s] of a coarse grid that explains the readings best."""
        B, r = self._propagate(self.c), self._distances()[1][..., 0]
        S = np.maximum((self.read * np.abs(B) ** 2).sum(axis=0), MIN_SUM)

        def explain(c: float) -> float:
            turn = self._wavenumber(c) - self._wavenumber(self.c)
            heard = (B.conj() * np.exp(1j * turn * r) * self.X).sum(axis=0)
            return float((np.abs(heard) ** 2 / S).sum())

        return float(max(np.arange(MIN_SPEED, MAX_SPEED, TRIAL_STEP), key=explain))

    def _distances(self) -> tuple[Floats, Floats]:
        d = self.q[:, None, :] - self.array.positions  # (M, N, 3) [m]
        return d, np.sqrt((d * d).sum(axis=2, keepdims=True))

    def _wavenumber(self, c: float) -> float:
        return 2.0 * np.pi * self.array.transducer.frequency / c

    def _responses(self, B: Complexes) -> Complexes:
        self.V = self.W * np.abs(B) ** 2  # (M, N)
        self.S = self.V.sum(axis=0)  # (N,)
        s: Complexes = (self.W * B.conj() * self.X).sum(axis=0) / np.maximum(self.S, MIN_SUM)
        return s

    def _weigh(self) -> None:
        """Update the responses for these positions, the noise (standard error of a real part) and the weights."""
        B = self._propagate(self.c)
        F = B * self._responses(B)
        count = self.read.sum(
            axis=0
        )  # readings of each transducer; its response uses up one degree of freedom
        spent = np.sqrt(np.maximum(1.0 - 1.0 / np.maximum(count, 1), 0.25))
        self.away = np.abs(self.X - F) / spent
        self.noise = max(float(np.median(self.away[self.read])) / MEDIAN, MIN_NOISE)
        self.W = self.read / (1.0 + (self.away / (OUTLYING * self.noise)) ** 2)
        self.s = self._responses(B)
        self.F = B * self.s

    def _normal(self) -> tuple[Floats, Floats]:
        """Return the normal equations of positions and speed, responses eliminated: (3M + 1, 3M + 1), (3M + 1,).

        dF/dq = -j k u F, dF/dc = j k r / c F. Only phases count, because amplitudes change 100 times more slowly.
        """
        d, r = self._distances()
        k = self._wavenumber(self.c)
        T = np.concatenate([-k * d / r, k * r / self.c], axis=2)  # (M, N, 4)
        M, N = self.X.shape
        own = np.einsum("mn,mni,mnj->mij", self.V * np.abs(self.s) ** 2, T, T, optimize=True)
        H = np.zeros((3 * M + 1, 3 * M + 1))
        for m in range(M):
            part = slice(3 * m, 3 * m + 3)
            H[part, part] = own[m, :3, :3]
            H[part, -1] = H[-1, part] = own[m, :3, 3]
        H[-1, -1] = own[:, 3, 3].sum()
        VT = self.V[..., None] * T
        pulled = np.concatenate(
            [VT[..., :3].transpose(0, 2, 1).reshape(3 * M, N), VT[..., 3].sum(axis=0)[None]]
        )
        self.turn: Floats = pulled / np.maximum(self.S, MIN_SUM)
        H -= (pulled * np.abs(self.s) ** 2) @ self.turn.T
        G = np.einsum("mni,mn->mi", T, self.W * np.imag(self.F.conj() * (self.X - self.F)))
        return H, np.r_[G[:, :3].ravel(), G[:, 3].sum()]

    @property
    def residual(self) -> float:
        """Unexplained part of a typical reading, relative to the expected rms."""
        return self._compare(self.noise, self.F[self.read])

    @staticmethod
    def _compare(noise: float, expected: Complexes) -> float:
        rms = float(np.sqrt(np.mean(np.abs(expected) ** 2))) if len(expected) else 0.0
        return float(np.sqrt(2.0)) * noise / max(rms, MIN_SUM)

    def finish(self, size: float) -> ScanFit:
        """Normalise, and find dead, unseen and reversed transducers. Raises ArgumentError.

        size: reading that was scaled to 1.
        """
        strength, noise = np.abs(self.s), self.noise / np.sqrt(np.maximum(self.S, MIN_SUM))
        mean, seen = 0.0, self.S > 0.0
        for _ in range(3):  # the mean is over transducers that are seen and alive
            mean = float(strength[seen].mean()) if seen.any() else 0.0
            seen = (noise <= MAX_ERROR * mean) & (strength > MIN_STRENGTH * mean)
        if not seen.any():
            raise ArgumentError(
                "readings",
                "show no transducer: place the microphone before the array, drive it harder",
            )
        unseen = noise > MAX_ERROR * mean
        s = self.s / mean
        axis = (s[seen] ** 2 / np.abs(s[seen])).sum()  # squares: reversed ones do not cancel
        s = s * np.exp(-0.5j * np.angle(axis))
        if s[seen].real.sum() < 0.0:
            s = -s
        dead = ~unseen & ~seen
        s[dead], s[unseen] = 0.0, 1.0
        turn = self.turn - self.turn[:, seen].mean(axis=1, keepdims=True)  # phase by q and c
        by_place = np.einsum("pn,pq,qn->n", turn, self.cov, turn, optimize=True)
        relative = noise / np.where(seen, strength, mean)
        residuals = [
            self._compare(float(np.median(away[read])) / MEDIAN, F[read]) if read.any() else 0.0
            for away, F, read in zip(self.away, self.F, self.read, strict=True)
        ]
        return ScanFit(
            s,
            np.sqrt(relative**2 + by_place),
            dead,
            unseen,
            seen & (s.real < 0.0),
            self.q,
            np.array(residuals),
            self.residual,
            int((self.read & (self.W < 0.1)).sum()),
            self.c,
            float(np.sqrt(self.cov[-1, -1])),
            mean * size / self.array.transducer.pressure,
        )
