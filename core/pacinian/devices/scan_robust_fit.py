"""The robust least-squares fit of a scan: Gauss-Newton steps with Cauchy weights, and the covariance of what it finds.

Parameters: positions of the microphone in the array's own frame p, (M, 3); speed of sound c and absorption beta of the
air; pose of the array in the frame of the scan, a shift t and a turn w about the array's centre. The readings depend on
p, c and beta alone; the given positions q depend on p and the pose, q_m = T(p_m). Each file after the first has a
factor mu, the microphone's gain and phase relative to the first file; its logarithm is a parameter, too. For given p,
c, beta and mu, the response of each transducer has a closed form (variable projection, Golub and Pereyra 1973).

Readings far from the rest lose their weight (Cauchy's, iterated). The covariance is that of such an estimate, A^-1 V
A^-1 (P. J. Huber, Robust Statistics, 1981, section 6.3), with the priors of positions, air and pose in A and V.

Where the positions or the pose are further off than the given priors say, the priors widen to what the scan shows: to
the errors that make the scan likeliest, by the EM algorithm (Dempster, Laird and Rubin 1977). They never become
narrower.
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
    from pacinian.types import Complexes, Flags, Floats, Longs

MIN_SPEED, MAX_SPEED = 318.0, 366.0  # speed of sound in air of -20 and 60 degC [m/s]
TRIAL_STEP = 0.5  # step of the first grid search over the speed of sound [m/s]
SPEED, SPEED_ERROR = 343.0, 10.0  # prior of the speed of sound: a room, give or take 17 K [m/s]
# of the absorption of a room's air, relative: 15 to 30 degC, 25 to 75 % humidity
ABSORPTION_ERROR = 0.2
FACTOR_ERROR = 10.0  # of ln mu; so wide that it matters only if the readings say nothing
MAX_LOUDNESS = 10.0  # of a reading, relative to a typical one, where the fit begins
TYPICAL = 0.9  # quantile of the readings that stands for all: many may be of dead transducers
KNOWN = 1e-9  # standard error of what is given
MAX_STEPS = 60  # Gauss-Newton steps for one set of priors
MAX_WIDENINGS = 20  # of the priors
# Largest residual, relative to the expected rms; beyond, the scan is not of this array.
MAX_MATCHING_RESIDUAL = 0.5
MIN_WIDENING = 0.01  # smallest relative change of a prior's error after which the fit goes on
MAX_LAST_CORRECTION = 1e-7  # largest correction of a position at convergence [m]
CAUCHY_SCALE = 3.0  # misfit at which a reading has half its weight [standard errors]
MIN_NOISE = 1e-4  # noise floor, relative to the quantile to which readings are scaled
MIN_SUM = 1e-300  # floor of sums of squares that are divisors
MEDIAN = math.sqrt(2.0 * math.log(2.0))  # median of a Rayleigh distribution of unit scale

# Names of the parameters that all positions share, in the order of `Prior.shared`.
SHARED = (
    "speed of sound",
    "absorption of the air",
    *(f"shift of the array along {axis}" for axis in "xyz"),
    *(f"turn of the array about {axis}" for axis in "xyz"),
)


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


def fit_model(
    array: Array, q: Floats, X: Complexes, read: Flags, files: Longs, prior: Prior
) -> ScanModel:
    """Return the likeliest fit: from the likeliest speed of sound, and from that which explains q as given best.

    X, read, files: as for `ScanModel`.
    """
    grid = np.arange(MIN_SPEED, MAX_SPEED, TRIAL_STEP).tolist()
    tried = (grid, [SPEED]) if prior.speed is None else ([prior.speed],)
    starts = dict(_find_start(array, q, X, read, files, speeds) for speeds in tried)
    models = [ScanModel(array, q, X, read, files, prior, *start) for start in starts.items()]
    return min(models, key=lambda model: model.cost)


def _find_start(
    array: Array, q: Floats, X: Complexes, read: Flags, files: Longs, speeds: list[float]
) -> tuple[float, Complexes]:
    """Return the speed of sound [m/s] of `speeds` that explains the readings best, and there mu of each file, (F,).

    sum_m conj(B_mn) X_mn of the readings of file f is about mu_f s_n S_n: a matrix of rank 1.
    """
    B: Complexes = matrix(array, q, Air(speed_of_sound=SPEED))
    r = measure_distances(array, q)
    S = np.maximum((read * np.abs(B) ** 2).sum(axis=0), MIN_SUM)
    parts = [read & (files == f) for f in range(int(files.max()) + 1)]
    sizes = np.array([measure_size(X[part]) / measure_size(B[part]) for part in parts])
    sizes /= sizes[0]
    X = X / sizes[files]
    loudest = MAX_LOUDNESS * measure_size(X[read])  # a single absurd reading must not decide
    X = X * np.minimum(1.0, loudest / np.maximum(np.abs(X), MIN_SUM))

    def compare(c: float) -> tuple[Complexes, Floats]:
        """Return the first left singular vector and the singular values."""
        turn = 2.0 * np.pi * array.transducer.frequency * (1.0 / c - 1.0 / SPEED)
        heard = B.conj() * np.exp(1j * turn * r) * X / np.sqrt(S)
        sums = np.array([(heard * part).sum(axis=0) for part in parts])
        u, values, _ = np.linalg.svd(sums, full_matrices=False)
        return u[:, 0], values

    c = max(speeds, key=lambda c: float(compare(c)[1][0]))
    u, _ = compare(c)
    factors = sizes * np.exp(1j * np.angle(u * u[0].conj()))
    factors[0] = 1.0  # without rounding
    return c, factors


def measure_size(values: Complexes) -> float:
    """Return the size of a typical value; 1 if there is none, or it is 0."""
    return float(np.quantile(np.abs(values), TYPICAL)) or 1.0 if values.size else 1.0


def compare_noise(noise: float, expected: Complexes) -> float:
    """Return the noise (standard error of a real part), relative to the rms of the expected readings."""
    rms = float(np.sqrt(np.mean(np.abs(expected) ** 2))) if len(expected) else 0.0
    return math.sqrt(2.0) * noise / max(rms, MIN_SUM)


def measure_distances(array: Array, q: Floats) -> Floats:
    """Return the distances of positions and transducers [m], (M, N)."""
    d = q[:, None, :] - array.positions
    return np.asarray(np.sqrt((d * d).sum(axis=2)))


class ScanModel:
    """A fit.

    X: readings, about 1, (M, N), 0 if missing. read: which there are, (M, N). files: number of the file of each
    reading, 0 to F - 1, (M, N). c, factors: first speed of sound [m/s], and first mu of each file, (F,), that of file 0
    being 1.
    """

    def __init__(
        self,
        array: Array,
        q: Floats,
        X: Complexes,
        read: Flags,
        files: Longs,
        prior: Prior,
        c: float,
        factors: Complexes,
    ) -> None:
        self.array, self.given, self.read, self.files, self.prior = array, q, read, files, prior
        self.X = X / factors[files]
        self.first_factors, self.logs = factors, np.zeros(len(factors), np.complex128)
        further = files == np.arange(1, len(factors))[:, None, None]  # (F - 1, M, N)
        self.by_factors = np.stack([further, 1j * further], axis=1).reshape(-1, *files.shape)
        """d ln F / d ln mu, by its real and its imaginary part, (2 (F - 1), M, N)."""
        M, P = len(q), 3 * len(q) + 8 + 2 * len(further)
        self.own = slice(3 * M, P - 6)  # parameters that all positions share, without the pose
        self.shared = np.r_[3 * M, 3 * M + 1, P - 6 : P]  # speed, absorption and pose
        self.W = read.astype(np.float64)
        self.p = q.copy()
        self.pose = Pose()
        self.shift, self.turn = np.zeros(3), np.zeros(3)
        self.c, self.beta = c, prior.absorption
        given_prior = prior
        for _ in range(MAX_WIDENINGS):
            self._converge()
            # no errors of positions explain a scan of another array
            if self.residual > MAX_MATCHING_RESIDUAL or not self._widen(given_prior):
                break
        self._weigh()
        self._compute_covariance()

    def _converge(self) -> None:
        """Take Gauss-Newton steps until the positions settle."""
        M = len(self.p)
        for _ in range(MAX_STEPS):
            self._weigh()
            H, slope = self._compute_normal_equations()
            P, prior_gradient = self._compute_prior_terms()
            step = np.linalg.solve(H / self.noise**2 + P, slope / self.noise**2 - prior_gradient)
            self.p += step[: 3 * M].reshape(M, 3)
            self.c = float(np.clip(self.c + step[3 * M], MIN_SPEED, MAX_SPEED))
            self.beta = max(self.beta + float(step[3 * M + 1]), 0.0)
            self.logs[1:] += step[3 * M + 2 : -6 : 2] + 1j * step[3 * M + 3 : -6 : 2]
            self._move(np.asarray(step[-6:], np.float64))
            if np.abs(step[: 3 * M]).max() < MAX_LAST_CORRECTION:
                break

    def _widen(self, given_prior: Prior) -> bool:
        """Widen the errors of positions, shift and turn to what the scan shows; return whether they changed.

        What the scan shows is the mean square of the corrections and of their errors. No error becomes smaller than in
        `given_prior`.
        """
        self._weigh()
        H, _ = self._compute_normal_equations()
        P, _ = self._compute_prior_terms()
        cov = np.linalg.inv(H / self.noise**2 + P)
        places, pose = self.D.reshape(-1, len(cov)), np.diag(cov)[-6:]
        corrections = (self.positions - self.given).ravel()
        squares = (
            corrections**2 + np.einsum("ip,ip->i", places @ cov, places),
            self.shift**2 + pose[:3],
            self.turn**2 + pose[3:],
        )
        shown = np.sqrt([np.mean(square) for square in squares])
        position, shift, turn = np.maximum(shown, given_prior.widths).tolist()
        before = self.prior.widths
        self.prior = replace(given_prior, position=position, shift=shift, turn=turn)
        return not np.allclose(self.prior.widths, before, rtol=MIN_WIDENING, atol=0.0)

    @property
    def residual(self) -> float:
        """The unexplained part of a typical reading, relative to the expected rms."""
        return compare_noise(self.noise, self.F[self.read])

    @property
    def cost(self) -> float:
        """Twice the negative logarithm of the likelihood, apart from a constant."""
        widths = float(np.array([len(self.p), 1, 1]) @ np.log(self.prior.widths))
        return (
            4.0 * float(self.read.sum()) * math.log(self.noise) + self.prior_penalty + 6.0 * widths
        )

    @property
    def factors(self) -> Complexes:
        """mu of each file, (F,)."""
        return np.asarray(self.first_factors * np.exp(self.logs))

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
        heard = np.exp(self.logs)[self.files] / self.array.transducer.pressure
        B, slope = B * heard, slope * heard[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            by_place = np.where(B != 0.0, slope.transpose(1, 0, 2) / B, 0.0)  # d ln B / dp
        r, k = measure_distances(self.array, self.p), self._wavenumber()
        self.T = np.concatenate([by_place, [1j * k / self.c * r, -r], self.by_factors])
        F = B * self._respond(B)
        count = np.maximum(self.read.sum(axis=0), 1)  # readings of each transducer
        spent = np.sqrt(np.maximum(1.0 - 1.0 / count, 0.25))  # its response uses up one
        self.residuals = np.abs(self.X - F) / spent
        self.noise = max(float(np.median(self.residuals[self.read])) / MEDIAN, MIN_NOISE)
        self.W = self.read / (1.0 + (self.residuals / (CAUCHY_SCALE * self.noise)) ** 2)
        self.s = self._respond(B)
        self.F = B * self.s

    def _compute_normal_equations(self) -> tuple[Floats, Floats]:
        """Return the normal equations, responses eliminated: (P, P), (P,), with P parameters."""
        M, N = self.X.shape
        T, size, P = self.T, np.abs(self.s) ** 2, self.own.stop + 6
        VT = self.V * T  # (5 + 2 (F - 1), M, N)
        own = np.einsum("imn,jmn->mij", T.conj(), VT * size).real
        H = np.zeros((P, P))
        shared, all_ = self.own, slice(self.own.stop)
        for m in range(M):
            part = slice(3 * m, 3 * m + 3)
            H[part, part], H[part, shared] = own[m, :3, :3], own[m, :3, 3:]
            H[shared, part] = own[m, 3:, :3]
        H[shared, shared] = own[:, 3:, 3:].sum(axis=0)
        pulled = np.concatenate([VT[:3].transpose(1, 0, 2).reshape(3 * M, N), VT[3:].sum(axis=1)])
        self.J = -pulled / np.maximum(self.S, MIN_SUM)  # d ln s / d (p, c, beta, ln mu), (P - 6, N)
        H[all_, all_] += ((pulled * size).conj() @ self.J.T).real
        G = (T.conj() * (self.W * self.F.conj() * (self.X - self.F))).real.sum(axis=2)
        return H, np.r_[G[:3].T.ravel(), G[3:].sum(axis=1), np.zeros(6)]

    def _compute_prior_terms(self) -> tuple[Floats, Floats]:
        """Return the curvature and slope of the priors: (P, P), (P,), with P parameters."""
        M, R = len(self.p), self.pose.matrix
        D = np.zeros((M, 3, self.own.stop + 6))  # d T(p_m)
        for m in range(M):
            D[m, :, 3 * m : 3 * m + 3] = R
        D[:, :, -6:-3] = np.eye(3)
        D[:, :, -3:] = -_cross_matrix((self.p - self.array.centre) @ R.T)
        self.D = D
        flat, error = D.reshape(3 * M, -1), self.prior.position
        corrections = (self.positions - self.given).ravel()
        P, prior_gradient = flat.T @ flat / error**2, flat.T @ corrections / error**2
        speed = SPEED if self.prior.speed is None else self.prior.speed
        weight = self.prior.shared**-2.0
        shared = np.r_[self.c - speed, self.beta - self.prior.absorption, self.shift, self.turn]
        logs = self.logs[1:].view(np.float64) / FACTOR_ERROR
        self.prior_penalty = float(corrections @ corrections) / error**2 + float(
            weight @ shared**2 + logs @ logs
        )
        P[self.shared, self.shared] += weight
        prior_gradient[self.shared] += weight * shared
        ratios = np.arange(3 * M + 2, self.own.stop)
        P[ratios, ratios] += FACTOR_ERROR**-2.0
        prior_gradient[ratios] += logs / FACTOR_ERROR
        return P, prior_gradient

    def _compute_covariance(self) -> None:
        """Compute `cov`, (P, P), and correct the noise for the degrees of freedom that the fit uses up."""
        H, _ = self._compute_normal_equations()
        P, _ = self._compute_prior_terms()
        weights = self.W[self.read]
        full = H / weights.mean()
        free = 2.0 * float(np.maximum(self.read.sum(axis=0) - 1, 0).sum())
        used = float(np.trace(np.linalg.solve(full / self.noise**2 + P, full / self.noise**2)))
        self.noise *= math.sqrt(max(free, 1.0) / max(free - used, 0.25 * free, 1.0))
        residuals = self.residuals[self.read] / self.noise
        bend = float(np.mean(weights**2))  # mean curvature of the loss
        spread = float(np.mean((weights * residuals) ** 2)) / 2.0  # mean square of its slope
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
