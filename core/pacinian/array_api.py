"""The field, and batches of solves, for arrays of any library: NumPy, PyTorch, CuPy, JAX, ...

The functions use only the array API standard (https://data-apis.org/array-api), and the device and precision of their
arguments. With PyTorch or JAX, gradients flow through them. Libraries that do not follow the standard by themselves
need array-api-compat, the extra `arrays`. For NumPy on a CPU, `pacinian.field` and `pacinian.solve` are
faster.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.array import Array
from pacinian.acoustics.directivity import omni
from pacinian.acoustics.propagation import MAX_GAIN, TOUCHING_DISTANCE, check_medium
from pacinian.argument_checks import MAX_LENGTH, check_integer, check_kind, check_number
from pacinian.errors import ArgumentError, MissingExtra, PointOnTransducer

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.types import Floats

STEPS = 1 << 16  # steps of cos(theta) in the table of a directivity
LEAST_COSINE = 1e-12  # in place of 0, where a directivity counts as behind
MAX_ELEMENTS = 1 << 24  # elements of B at once in `field`
MAX_STEPS = 10_000  # Gerchberg-Saxton steps
MAX_ROUNDING = 1e-5  # error of a coordinate in single precision, 0.007 rad of a wave at 40 kHz [m]
# least regularisation, in roundings times sqrt(M), with which equal points have a solution
MIN_MU = 4.0
MU = 1e-6  # default regularisation, relative to the mean square pressure


def matrix(array: Array, points: Any, medium: Air) -> Any:
    """Return B [Pa], complex, (..., M, N), in the library, the precision and on the device of `points`.

    array: N transducers. points: real floating-point array, (..., M, 3) [m]. medium: the air.
    Directivities are interpolated linearly in a table of 65,536 steps of cos(theta). Raises ArgumentError,
    PointOnTransducer, MissingExtra.
    """
    check_medium(medium)
    xp = _find_namespace("points", points)
    _check_points(xp, points, array)
    kind, centre = array.transducer, array.centre

    def local(values: Any) -> Any:
        return xp.asarray(np.array(values), dtype=points.dtype, device=points.device)

    # in two parts, so that the centre is not rounded
    near = np.asarray(centre, np.float32).astype(np.float64)
    q = (points - local(near)) - local(centre - near)
    d = q[..., None, :] - local(array.positions - centre)  # (..., M, N, 3)
    r = xp.sqrt(xp.sum(d * d, axis=-1))
    if medium.singular and bool(xp.any(r < TOUCHING_DISTANCE)):
        on = xp.reshape(xp.any(r < TOUCHING_DISTANCE, axis=-1), (-1,))
        raise PointOnTransducer([k for k in range(on.shape[0]) if bool(on[k])])
    size = (
        kind.pressure * r**-medium.exponent if medium.exponent else kind.pressure * xp.ones_like(r)
    )
    if beta := medium.beta(kind.frequency):
        size = size * xp.exp(-beta * r)
    if kind.directivity is not omni:
        cosine = xp.sum(d * local(array.normals), axis=-1) / xp.where(r > 0.0, r, xp.ones_like(r))
        size = size * _interpolate(xp, kind.directivity, cosine, local)
    phase = medium.wavenumber(kind.frequency) * r
    B = xp.astype(size * xp.cos(phase), _complex(xp, points.dtype))
    B = B - 1j * xp.astype(size * xp.sin(phase), B.dtype)
    if array.response is not None:
        B = B * xp.asarray(np.array(array.response), dtype=B.dtype, device=points.device)
    return B


def field(array: Array, gains: Any, points: Any, medium: Air) -> Any:
    """Return the complex sound pressure p = B g [Pa], (..., M), in the library and on the device of `points`.

    array: N transducers. gains: (..., N), complex or real, of the same library. points: (..., M, 3) [m]. The leading
    dimensions broadcast. medium: the air. Raises ArgumentError, PointOnTransducer, MissingExtra.
    """
    xp = _find_namespace("points", points)
    _check_points(xp, points, array)
    g = _check_gains(xp, gains, points, len(array))[..., None]
    M = points.shape[-2]
    before = int(np.prod(points.shape[:-2], dtype=np.int64))
    rows = max(1, MAX_ELEMENTS // max(1, before * len(array)))
    parts = [
        (matrix(array, points[..., m : min(m + rows, M), :], medium) @ g)[..., 0]
        for m in range(0, max(M, 1), rows)
    ]
    return parts[0] if len(parts) == 1 else xp.concat(parts, axis=-1)


def solve(
    array: Array,
    points: Any,
    amplitudes: Any,
    phases: Any | None = None,
    *,
    medium: Air,
    gain: float = 1.0,
    steps: int = 50,
    mu: float = MU,
) -> tuple[Any, Any]:
    """Return gains, (..., N), and their sound pressures, (..., M) [Pa], for any number of problems at once.

    The method is that of the solver pseudo-inverse: `steps` Gerchberg-Saxton steps on B B^H choose the phases, then
    g = B^H (B B^H + mu s I)^-1 p, with s the mean of the diagonal of B B^H; gains above the limit are scaled down as a
    whole, each problem by itself. If no sound reaches any point of a problem, its gains are 0. mu is at least 4 sqrt(M)
    times the precision's epsilon.

    array: N transducers. points: (..., M, 3) [m]. amplitudes: not negative, broadcast to (..., M) [Pa], of the same
    library. phases: [rad], broadcast to (..., M); None if they are free. medium: the air. gain: limit of
    |g_n|. Raises ArgumentError, PointOnTransducer, MissingExtra.
    """
    gain = check_number("gain", gain, low=0.0, above=True)
    mu = check_number("mu", mu, low=0.0)
    steps = check_integer("steps", steps, low=0)
    if steps > MAX_STEPS:
        raise ArgumentError("steps", f"must be at most {MAX_STEPS}")
    xp = _find_namespace("points", points)
    B = matrix(array, points, medium)
    shape, M = points.shape[:-1], points.shape[-2]
    t = _spread(xp, "amplitudes", amplitudes, points)
    if bool(xp.any(t < 0.0)):
        raise ArgumentError("amplitudes", "must be 0 or more; give a sign as a phase")
    if phases is None:
        m = xp.arange(M, dtype=points.dtype, device=points.device)
        phi = xp.broadcast_to(m * m * (np.pi / max(M, 1)), shape)
    else:
        phi = _spread(xp, "phases", phases, points)
    turn = xp.astype(xp.cos(phi), B.dtype) + 1j * xp.astype(xp.sin(phi), B.dtype)
    t = xp.astype(t, B.dtype)
    p = (t * turn)[..., None]
    adjoint = xp.conj(xp.matrix_transpose(B))
    gram = B @ adjoint
    for _ in range(steps if phases is None else 0):
        q = gram @ p
        length = xp.abs(q)
        q = q / xp.astype(xp.where(length > 0.0, length, xp.ones_like(length)), B.dtype)
        p = t[..., None] * q
    eye = xp.eye(M, dtype=B.dtype, device=points.device)
    mean = xp.real(xp.sum(gram * eye, axis=(-2, -1))) / max(M, 1)
    mean = xp.where(mean > 0.0, mean, xp.ones_like(mean))  # no sound reaches any point: gram is 0
    least = MIN_MU * M**0.5 * float(xp.finfo(points.dtype).eps)
    ridge = xp.astype(max(mu, least) * mean, B.dtype)[..., None, None] * eye
    g = (adjoint @ xp.linalg.solve(gram + ridge, p))[..., 0]
    strongest = xp.max(xp.abs(g), axis=-1, keepdims=True) / gain
    g = g / xp.astype(xp.where(strongest > 1.0, strongest, xp.ones_like(strongest)), B.dtype)
    return g, (B @ g[..., None])[..., 0]


def _find_namespace(name: str, given: Any) -> Any:
    """Return the array API namespace of an array. name: of the argument. Raises ArgumentError, MissingExtra."""
    if hasattr(given, "__array_namespace__"):
        return given.__array_namespace__()
    if not hasattr(given, "device"):
        raise ArgumentError(
            name, f"must be an array of NumPy, PyTorch or another library, not {type(given)}"
        )
    try:
        from array_api_compat import array_namespace
    except ImportError as error:
        raise MissingExtra("array-api-compat", "arrays") from error
    try:
        return array_namespace(given)
    except TypeError as error:
        raise ArgumentError(name, f"must be an array of a supported library: {error}") from None


def _check_points(xp: Any, points: Any, array: Array) -> None:
    """Refuse an array that is none, and points that are not finite and near, (..., M, 3) [m]. Raises ArgumentError."""
    check_kind("array", array, Array)
    if points.ndim < 2 or points.shape[-1] != 3:
        raise ArgumentError("points", f"must have shape (..., M, 3), not {tuple(points.shape)}")
    if points.dtype not in (xp.float32, xp.float64):
        raise ArgumentError("points", f"must be float32 or float64, not {points.dtype}")
    centre = xp.asarray(array.centre, dtype=points.dtype, device=points.device)
    if not bool(xp.all(xp.abs(points - centre) <= MAX_LENGTH)):  # also for NaN
        raise ArgumentError(
            "points",
            f"must be finite, and at most {MAX_LENGTH:g} m from the array's centre: "
            "lengths are in metres (were millimetres given?)",
        )
    away = float(np.abs(array.centre).max())  # [m]
    rounding = away * float(xp.finfo(points.dtype).eps) / 2.0  # [m]
    if rounding > MAX_ROUNDING:
        raise ArgumentError(
            "points",
            f"are {away:g} m from the origin, where {points.dtype} is off by {1e3 * rounding:.2g} mm: use float64, or "
            "put the array at the origin",
        )


def _check_gains(xp: Any, gains: Any, points: Any, count: int) -> Any:
    """Return gains, (..., N), complex, that broadcast with the points. Raises ArgumentError."""
    if _find_namespace("gains", gains) is not xp:
        raise ArgumentError("gains", "must be an array of the same library as `points`")
    if not xp.isdtype(gains.dtype, ("bool", "numeric")):
        raise ArgumentError("gains", f"must be numbers, not {gains.dtype}")
    if gains.shape[-1:] != (count,):
        raise ArgumentError("gains", f"must have shape (..., {count}), not {tuple(gains.shape)}")
    try:
        np.broadcast_shapes(tuple(gains.shape[:-1]), tuple(points.shape[:-2]))
    except ValueError:
        raise ArgumentError(
            "gains",
            f"of shape {tuple(gains.shape)} do not broadcast with `points` of shape {tuple(points.shape)}",
        ) from None
    g = xp.astype(gains, _complex(xp, points.dtype))
    if not bool(xp.all(xp.abs(g) < MAX_GAIN)):  # also for NaN
        raise ArgumentError("gains", f"must be finite, and below {MAX_GAIN:g}")
    return g


def _spread(xp: Any, name: str, given: Any, points: Any) -> Any:
    """Return real numbers broadcast to the shape of `points` without its last dimension. Raises ArgumentError."""
    shape = points.shape[:-1]
    kind = getattr(given, "dtype", None)  # that of another library, perhaps
    if "complex" in str(kind) or (kind is None and np.iscomplexobj(given)):
        raise ArgumentError(name, "must be real: give phases as `phases`")
    try:
        made = xp.broadcast_to(xp.asarray(given, dtype=points.dtype, device=points.device), shape)
    except (TypeError, ValueError, RuntimeError) as error:
        raise ArgumentError(name, f"must broadcast to {tuple(shape)}: {error}") from None
    if not bool(xp.all(xp.isfinite(made))):
        raise ArgumentError(name, "must be finite")
    return made


def _complex(xp: Any, real: Any) -> Any:
    return xp.complex64 if real == xp.float32 else xp.complex128


def _interpolate(
    xp: Any, directivity: Callable[[Floats], Floats], cosine: Any, local: Callable[[Any], Any]
) -> Any:
    """Return a directivity at cos(theta); 0 behind. local: makes an array of the right library."""
    nodes = np.maximum(np.arange(STEPS + 1) / STEPS, LEAST_COSINE)
    table = local(np.asarray(directivity(nodes), dtype=np.float64))
    ahead = xp.clip(cosine, 0.0, 1.0) * STEPS
    below = xp.clip(xp.floor(ahead), 0.0, STEPS - 1.0)
    place = xp.reshape(xp.astype(below, xp.int64), (-1,))
    low, high = (xp.reshape(xp.take(table, place + k), cosine.shape) for k in (0, 1))
    return xp.where(cosine > 0.0, low + (ahead - below) * (high - low), xp.zeros_like(low))
