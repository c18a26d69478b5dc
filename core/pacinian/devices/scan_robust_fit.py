"""The robust least-squares fit of a scan: Gauss-Newton steps with Cauchy weights, and the covariance of what it finds.

Parameters: positions of the microphone in the array's own frame p, (M, 3); speed of sound c and absorption beta of the
air; pose of the array in the frame of the scan, a shift t and a turn w about the array's centre. The readings depend on
p, c and beta alone; the given positions q depend on p and the pose, q_m = T(p_m). For given p, c and beta, the response
of each transducer has a closed form (variable projection, Golub and Pereyra 1973).

Readings far from the rest lose their weight (Cauchy's, iterated). The covariance is that of such an estimate, A^-1 V
A^-1 (P. J. Huber, Robust Statistics, 1981, section 6.3), with the priors of positions, air and pose in A and V.

Where the positions or the pose are further off than was said, their priors widen to what the scan shows: to the errors
that make the scan likeliest, by the EM algorithm (Dempster, Laird and Rubin 1977). They never become narrower.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.gradients import compute_slope
from pacinian.acoustics.pose import Pose
from pacinian.acoustics.propagation import matrix

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.types import Complexes, Flags, Floats

MIN_SPEED, MAX_SPEED = 318.0, 366.0  # speed of sound in air of -20 and 60 degC [m/s]
TRIAL_STEP = 0.5  # step of the first grid search over the speed of sound [m/s]
SPEED, SPEED_ERROR = 343.0, 10.0  # prior of the speed of sound: a room, give or take 17 K [m/s]
# of the absorption of a room's air, relative: 15 to 30 degC, 25 to 75 % humidity
ABSORPTION_ERROR = 0.2
KNOWN = 1e-9  # standard error of what is given
MAX_STEPS = 60  # Gauss-Newton steps for one set of priors
MAX_WIDENINGS = 20  # of the priors
MAX_RESIDUAL = 0.5  # residual, relative to the expected rms; beyond, the scan is not of this array
MIN_WIDENING = 0.01  # smallest relative change of a prior's error after which the fit goes on
MAX_LAST_CORRECTION = 1e-7  # largest correction of a position at convergence [m]
CAUCHY_SCALE = 3.0  # misfit at which a reading has half its weight [standard errors]
MIN_NOISE = 1e-4  # noise floor, relative to the quantile to which readings are scaled
MIN_SUM = 1e-300  # floor of sums of squares that are divisors
MEDIAN = math.sqrt(2.0 * math.log(2.0))  # median of a Rayleigh distribution of unit scale


@dataclass(frozen=True)
class Prior:
    """What is known before the scan: standard errors of each coordinate [m], of the pose [m] and [rad], and the air.

    speed: speed of sound [m/s]; None if it is not known. absorption: most likely one [1/m].
    """

    position: float
    shift: float
    turn: float
    speed: float | None
    absorption: float

    @property
    def widths(self) -> Floats:
        """Standard errors of positions [m], shift [m] and turn [rad], (3,)."""
        return np.maximum([self.position, self.shift, self.turn], KNOWN)

    @property
    def shared(self) -> Floats:
        """Standard errors of what all positions share, (8,): speed, absorption, shift and turn."""
        air = SPEED_ERROR if self.speed is None else KNOWN, ABSORPTION_ERROR * self.absorption
        pose = [max(self.shift, KNOWN)] * 3 + [max(self.turn, KNOWN)] * 3
        return np.array([*air, *pose])


def fit_model(array: Array, q: Floats, X: Complexes, read: Flags, prior: Prior) -> ScanModel:
    """Return the likeliest fit: from the likeliest speed of sound, and from that which explains q as given best."""
    if prior.speed is not None:
        return ScanModel(array, q, X, read, prior, prior.speed)
    starts = dict.fromkeys((_try_speeds(array, q, X, read), SPEED))
    models = [ScanModel(array, q, X, read, prior, c) for c in starts]
    return min(models, key=lambda model: model.cost)


def _try_speeds(array: Array, q: Floats, X: Complexes, read: Flags) -> float:
    """Return the speed of sound [m/s] of a coarse grid that explains the readings best."""
    B: Complexes = matrix(array, q, Air(speed_of_sound=SPEED))
    r = measure_distances(array, q)
    S = np.maximum((read * np.abs(B) ** 2).sum(axis=0), MIN_SUM)

    def explain(c: float) -> float:
        turn = 2.0 * np.pi * array.transducer.frequency * (1.0 / c - 1.0 / SPEED)
        heard = (B.conj() * np.exp(1j * turn * r) * X).sum(axis=0)
        return float((np.abs(heard) ** 2 / S).sum())

    return float(max(np.arange(MIN_SPEED, MAX_SPEED, TRIAL_STEP), key=explain))


def compare_noise(noise: float, expected: Complexes) -> float:
    """Return the noise (standard error of a real part), relative to the rms of the expected readings."""
    rms = float(np.sqrt(np.mean(np.abs(expected) ** 2))) if len(expected) else 0.0
    return math.sqrt(2.0) * noise / max(rms, MIN_SUM)


def measure_distances(array: Array, q: Floats) -> Floats:
    """Return the distances of positions and transducers [m], (M, N)."""
    d = q[:, None, :] - array.positions
    return np.asarray(np.sqrt((d * d).sum(axis=2)))


class ScanModel:
    """A fit. X: readings, about 1, (M, N), 0 if missing. read: which there are, (M, N). c: first speed [m/s]."""

    def __init__(
        self, array: Array, q: Floats, X: Complexes, read: Flags, prior: Prior, c: float
    ) -> None:
        self.array, self.given, self.X, self.read, self.prior = array, q, X, read, prior
        self.W = read.astype(np.float64)
        self.p = q.copy()
        self.pose = Pose()
        self.shift, self.turn = np.zeros(3), np.zeros(3)
        self.c, self.beta = c, prior.absorption
        said = prior
        for _ in range(MAX_WIDENINGS):
            self._converge()
            # no errors of positions explain a scan of another array
            if self.residual > MAX_RESIDUAL or not self._widen(said):
                break
        self._weigh()
        self._compute_covariance()

    def _converge(self) -> None:
        """Take Gauss-Newton steps until the positions settle."""
        M = len(self.p)
        for _ in range(MAX_STEPS):
            self._weigh()
            H, slope = self._normal()
            P, pull = self._prior()
            step = np.linalg.solve(H / self.noise**2 + P, slope / self.noise**2 - pull)
            self.p += step[: 3 * M].reshape(M, 3)
            self.c = float(np.clip(self.c + step[3 * M], MIN_SPEED, MAX_SPEED))
            self.beta = max(self.beta + float(step[3 * M + 1]), 0.0)
            self._move(np.asarray(step[3 * M + 2 :], np.float64))
            if np.abs(step[: 3 * M]).max() < MAX_LAST_CORRECTION:
                break

    def _widen(self, said: Prior) -> bool:
        """Set the errors of positions, shift and turn to what the scan shows, or was said; return whether they changed.

        What the scan shows is the mean square of the corrections and of their errors.
        """
        self._weigh()
        H, _ = self._normal()
        P, _ = self._prior()
        cov = np.linalg.inv(H / self.noise**2 + P)
        places, pose = self.D.reshape(-1, len(cov)), np.diag(cov)[-6:]
        away = (self.positions - self.given).ravel()
        squares = (
            away**2 + np.einsum("ip,ip->i", places @ cov, places),
            self.shift**2 + pose[:3],
            self.turn**2 + pose[3:],
        )
        shown = np.sqrt([np.mean(square) for square in squares])
        position, shift, turn = np.maximum(shown, said.widths).tolist()
        before = self.prior.widths
        self.prior = replace(said, position=position, shift=shift, turn=turn)
        return not np.allclose(self.prior.widths, before, rtol=MIN_WIDENING, atol=0.0)

    @property
    def residual(self) -> float:
        """The unexplained part of a typical reading, relative to the expected rms."""
        return compare_noise(self.noise, self.F[self.read])

    @property
    def cost(self) -> float:
        """Twice the negative logarithm of the likelihood, apart from a constant."""
        widths = float(np.array([len(self.p), 1, 1]) @ np.log(self.prior.widths))
        return 4.0 * float(self.read.sum()) * math.log(self.noise) + self.surprise + 6.0 * widths

    @property
    def positions(self) -> Floats:
        """Corrected positions in the frame of the scan [m], (M, 3)."""
        return self.pose.points(self.p)

    def _move(self, step: Floats) -> None:
        """Shift the pose and turn it about the array's centre. step: [m] and [rad], (6,)."""
        angle = float(np.linalg.norm(step[3:]))
        turned = Pose().rotate(step[3:], angle) if angle > 0.0 else Pose()
        rotation = (turned @ self.pose).rotation
        self.shift, self.turn = self.shift + step[:3], self.turn + step[3:]
        a = self.array.centre
        plain = Pose((0.0, 0.0, 0.0), rotation)
        self.pose = Pose(tuple((a + self.shift - plain.directions(a[None])[0]).tolist()), rotation)

    def _wavenumber(self) -> float:
        return 2.0 * np.pi * self.array.transducer.frequency / self.c

    def _respond(self, B: Complexes) -> Complexes:
        self.V = self.W * np.abs(B) ** 2  # (M, N)
        self.S = self.V.sum(axis=0)  # (N,)
        s: Complexes = (self.W * B.conj() * self.X).sum(axis=0) / np.maximum(self.S, MIN_SUM)
        return s

    def _weigh(self) -> None:
        """Update the responses for these positions, the noise (standard error of a real part) and the weights."""
        B, slope = compute_slope(
            self.array, self.p, Air(speed_of_sound=self.c, absorption=self.beta)
        )
        B, slope = B / self.array.transducer.pressure, slope / self.array.transducer.pressure
        with np.errstate(divide="ignore", invalid="ignore"):
            by_place = np.where(B != 0.0, slope.transpose(1, 0, 2) / B, 0.0)  # d ln B / dp
        r, k = measure_distances(self.array, self.p), self._wavenumber()
        self.T = np.concatenate([by_place, [1j * k / self.c * r, -r]])  # (5, M, N)
        F = B * self._respond(B)
        count = np.maximum(self.read.sum(axis=0), 1)  # readings of each transducer
        spent = np.sqrt(np.maximum(1.0 - 1.0 / count, 0.25))  # its response uses up one
        self.away = np.abs(self.X - F) / spent
        self.noise = max(float(np.median(self.away[self.read])) / MEDIAN, MIN_NOISE)
        self.W = self.read / (1.0 + (self.away / (CAUCHY_SCALE * self.noise)) ** 2)
        self.s = self._respond(B)
        self.F = B * self.s

    def _normal(self) -> tuple[Floats, Floats]:
        """Return the normal equations, responses eliminated: (3M + 8, 3M + 8), (3M + 8,)."""
        M, N = self.X.shape
        T, size = self.T, np.abs(self.s) ** 2
        VT = self.V * T  # (5, M, N)
        own = np.einsum("imn,jmn->mij", T.conj(), VT * size).real
        H = np.zeros((3 * M + 8, 3 * M + 8))
        air, all_ = slice(3 * M, 3 * M + 2), slice(3 * M + 2)
        for m in range(M):
            part = slice(3 * m, 3 * m + 3)
            H[part, part], H[part, air] = own[m, :3, :3], own[m, :3, 3:]
            H[air, part] = own[m, 3:, :3]
        H[air, air] = own[:, 3:, 3:].sum(axis=0)
        pulled = np.concatenate([VT[:3].transpose(1, 0, 2).reshape(3 * M, N), VT[3:].sum(axis=1)])
        self.J = -pulled / np.maximum(self.S, MIN_SUM)  # d ln s / d (p, c, beta), (3M + 2, N)
        H[all_, all_] += ((pulled * size).conj() @ self.J.T).real
        G = (T.conj() * (self.W * self.F.conj() * (self.X - self.F))).real.sum(axis=2)  # (5, M)
        return H, np.r_[G[:3].T.ravel(), G[3:].sum(axis=1), np.zeros(6)]

    def _prior(self) -> tuple[Floats, Floats]:
        """Return the curvature and slope of the priors: (3M + 8, 3M + 8), (3M + 8,)."""
        M, R = len(self.p), self.pose.matrix
        D = np.zeros((M, 3, 3 * M + 8))  # d T(p_m)
        for m in range(M):
            D[m, :, 3 * m : 3 * m + 3] = R
        D[:, :, 3 * M + 2 : 3 * M + 5] = np.eye(3)
        D[:, :, 3 * M + 5 :] = -_cross_matrix((self.p - self.array.centre) @ R.T)
        self.D = D
        flat, error = D.reshape(3 * M, -1), self.prior.position
        away = (self.positions - self.given).ravel()
        P, pull = flat.T @ flat / error**2, flat.T @ away / error**2
        speed = SPEED if self.prior.speed is None else self.prior.speed
        weight = self.prior.shared**-2.0
        shared = np.r_[self.c - speed, self.beta - self.prior.absorption, self.shift, self.turn]
        self.surprise = float(away @ away) / error**2 + float(weight @ shared**2)
        P[np.arange(3 * M, 3 * M + 8), np.arange(3 * M, 3 * M + 8)] += weight
        pull[3 * M :] += weight * shared
        return P, pull

    def _compute_covariance(self) -> None:
        """Compute `cov`, (3M + 8, 3M + 8), and correct the noise for the degrees of freedom that the fit uses up."""
        H, _ = self._normal()
        P, _ = self._prior()
        weights = self.W[self.read]
        full = H / weights.mean()
        free = 2.0 * float(np.maximum(self.read.sum(axis=0) - 1, 0).sum())
        used = float(np.trace(np.linalg.solve(full / self.noise**2 + P, full / self.noise**2)))
        self.noise *= math.sqrt(max(free, 1.0) / max(free - used, 0.25 * free, 1.0))
        away = self.away[self.read] / self.noise
        bend = float(np.mean(weights**2))  # mean curvature of the loss
        spread = float(np.mean((weights * away) ** 2)) / 2.0  # mean square of its slope
        A, V = bend * full / self.noise**2 + P, spread * full / self.noise**2 + P
        inverse = np.linalg.inv(A)
        self.cov = inverse @ V @ inverse
        self.response_noise = self.noise * np.sqrt(
            spread / bend**2 * weights.mean() / np.maximum(self.S, MIN_SUM)
        )  # of a real part, (N,)


def _cross_matrix(v: Floats) -> Floats:
    """Return the matrices [v]x of cross products, (M, 3, 3)."""
    made = np.zeros((len(v), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        made[:, j, i], made[:, i, j] = v[:, k], -v[:, k]
    return made
