"""The field and solves for arrays of other libraries: equal to those of NumPy, whatever the library."""

from __future__ import annotations

import importlib.util
from typing import TYPE_CHECKING, Any

import array_api_strict
import numpy as np
import pytest

import pacinian as pc
from pacinian import array_api

try:
    import torch
except ImportError:
    torch = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Iterator

CHANCE = np.random.default_rng(4)
ARRAY = pc.Array(
    CHANCE.uniform((-0.05, -0.05, 0.0), (0.05, 0.05, 0.01), (30, 3)),
    CHANCE.normal((0.0, 0.0, 1.0), 0.1, (30, 3)),
    pc.T4010A1,
    np.exp(1j * CHANCE.uniform(-1.0, 1.0, 30)),
)
K, M, N = 3, 4, len(ARRAY)
Q = CHANCE.uniform((-0.04, -0.04, 0.08), (0.04, 0.04, 0.2), (K, M, 3))
G = CHANCE.normal(size=(K, N)) + 1j * CHANCE.normal(size=(K, N))
T = CHANCE.uniform(5.0, 30.0, (K, M))
AIR = pc.Air(attenuation="absorbing")


def is_here(library: str) -> bool:
    """Whether a library is installed, and finds a GPU if it needs one."""
    name, _, place = library.partition(" on ")
    if name not in OTHERS:
        return True
    if importlib.util.find_spec(name) is None:
        return False
    return not place or importlib.import_module(name).cuda.is_available()


OTHERS = "torch", "cupy", "jax"
LIBRARIES = "numpy", "strict", "torch", "torch on a GPU", "cupy on a GPU", "jax"


@pytest.mark.parametrize("library", [x for x in LIBRARIES if not is_here(x)])
def test_libraries_that_are_not_here(library: str) -> None:
    pytest.skip(f"there is no {library} here")


@pytest.fixture(params=[x for x in LIBRARIES if is_here(x)])
def xp(request: pytest.FixtureRequest) -> Iterator[Any]:
    """A library of arrays, in double precision."""
    match request.param:
        case "numpy":
            yield np
        case "strict":
            yield array_api_strict
        case "torch on a GPU":
            with torch.device("cuda"):
                yield torch
        case "jax":
            with importlib.import_module("jax").enable_x64(True):
                yield importlib.import_module("jax.numpy")
        case other:
            yield importlib.import_module(other.split()[0])


def back(made: Any) -> Any:
    """The same as a NumPy array."""
    if hasattr(made, "detach"):
        return made.detach().cpu().numpy()
    return made.get() if hasattr(made, "get") else np.asarray(made)


@pytest.mark.parametrize("air", [AIR, pc.Air(), pc.Air(attenuation="none")])
@pytest.mark.parametrize(
    "kind", [pc.T4010A1, pc.IDEAL, pc.Transducer(directivity=pc.Piston(0.005, 700.0))]
)
def test_the_field_is_that_of_the_reference(xp: Any, air: pc.Air, kind: pc.Transducer) -> None:
    array = pc.Array(ARRAY.positions, ARRAY.normals, kind, ARRAY.response)
    B = array_api.matrix(array, xp.asarray(Q), air)
    p = array_api.field(array, xp.asarray(G), xp.asarray(Q), air)
    assert type(p) is type(xp.asarray(Q))
    for k in range(K):
        exact = pc.matrix(array, Q[k], air)
        np.testing.assert_allclose(back(B)[k], exact, rtol=0.0, atol=1e-7 * np.abs(exact).max())
        np.testing.assert_allclose(
            back(p)[k], exact @ G[k], rtol=0.0, atol=1e-6 * np.abs(exact).max()
        )


def test_precision_and_broadcasting_are_the_callers(xp: Any) -> None:
    q, g = xp.asarray(Q.astype(np.float32)), xp.asarray(G[0].astype(np.complex64))
    p = array_api.field(ARRAY, g, q, AIR)  # one set of gains for all
    assert p.dtype == xp.complex64
    exact = np.array([pc.field(ARRAY, G[0], Q[k], AIR, "double") for k in range(K)])
    np.testing.assert_allclose(back(p), exact, atol=2e-4 * np.abs(exact).max())
    gains, _ = array_api.solve(ARRAY, q, xp.asarray(T.astype(np.float32)), medium=pc.Air())
    assert gains.dtype == xp.complex64


def test_many_points_are_taken_part_by_part(xp: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = back(array_api.field(ARRAY, xp.asarray(G), xp.asarray(Q), AIR))
    monkeypatch.setattr(array_api, "MAX_ELEMENTS", 1)
    np.testing.assert_allclose(
        back(array_api.field(ARRAY, xp.asarray(G), xp.asarray(Q), AIR)), whole, rtol=1e-12
    )


def test_given_phases_are_solved_as_by_the_solver(xp: Any) -> None:
    phi = CHANCE.uniform(-3.0, 3.0, (K, M))
    g, p = array_api.solve(
        ARRAY, xp.asarray(Q), xp.asarray(T), xp.asarray(phi), medium=AIR, mu=0.0, gain=1e3
    )
    np.testing.assert_allclose(back(p), T * np.exp(1j * phi), rtol=1e-6)
    for k in range(K):
        alone = pc.solve(
            ARRAY, Q[k], T[k], phi[k], medium=AIR, solver="pseudo-inverse", precision="double",
            limits=pc.Limits(gain=1e3),
        )  # fmt: skip
        np.testing.assert_allclose(back(g)[k], alone.gains, atol=1e-5 * np.abs(alone.gains).max())


def test_free_phases_meet_the_amplitudes_and_the_limit(xp: Any) -> None:
    g, p = array_api.solve(ARRAY, xp.asarray(Q), xp.asarray(T), medium=AIR, gain=1e3)
    np.testing.assert_allclose(np.abs(back(p)), T, rtol=1e-3)
    loud, heard = array_api.solve(ARRAY, xp.asarray(Q), xp.asarray(1e3 * T), medium=AIR, gain=0.5)
    np.testing.assert_allclose(np.abs(back(loud)).max(axis=-1), 0.5)
    ratio = np.abs(back(heard)) / T
    np.testing.assert_allclose(ratio, np.broadcast_to(ratio[:, :1], ratio.shape), rtol=1e-3)
    for k in range(K):
        single = array_api.solve(ARRAY, xp.asarray(Q[k]), xp.asarray(T[k]), medium=AIR, gain=1e3)[0]
        np.testing.assert_allclose(back(single), back(g)[k], atol=1e-9 * np.abs(back(g)).max())


def test_no_sound_and_equal_points_spoil_no_batch(xp: Any) -> None:
    """Without sound at any point, B B^H is 0; for equal points it is singular. Other problems do not notice."""
    q, t = Q.copy(), T.copy()
    q[1, :, 2] *= -1.0  # behind the array
    q[2], t[2] = q[2, 0], 20.0
    for mu in (0.0, array_api.MU):
        g, p = array_api.solve(ARRAY, xp.asarray(q), xp.asarray(t), medium=AIR, mu=mu, gain=1e3)
        assert not back(g)[1].any()
        np.testing.assert_allclose(np.abs(back(p)[[0, 2]]), t[[0, 2]], rtol=1e-3)


@pytest.mark.parametrize("M", [2, 30])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_equal_points_of_different_phases_have_finite_gains(M: int, kind: Any) -> None:
    rng = np.random.default_rng(0)
    for mu in (0.0, array_api.MU):
        q, phases = np.tile(Q[0, :1], (M, 1)).astype(kind), rng.uniform(-3.0, 3.0, M).astype(kind)
        g, _ = array_api.solve(ARRAY, q, kind(100.0), phases, medium=AIR, mu=mu)
        assert 0.0 < np.abs(g).max() <= 1.0 + 1e-6


def test_without_attenuation_a_point_on_a_transducer_has_the_field_of_the_others(xp: Any) -> None:
    even = pc.Air(attenuation="none")
    q = np.concatenate([ARRAY.positions[3:4], Q[0]])
    p = array_api.field(ARRAY, xp.asarray(G[0]), xp.asarray(q), even)
    np.testing.assert_allclose(back(p), pc.field(ARRAY, G[0], q, even, "double"), rtol=1e-5)


def test_single_precision_holds_away_from_the_origin_or_is_refused(xp: Any) -> None:
    near, far = ((x, 0.0, 0.0) for x in (128.0, 3000.0))
    array = ARRAY.translate(near)
    q = (Q[0] + near).astype(np.float32)
    exact = pc.field(array, G[0], q.astype(np.float64), AIR, "double")
    p = array_api.field(array, xp.asarray(G[0]), xp.asarray(q), AIR)
    assert p.dtype == xp.complex64
    np.testing.assert_allclose(back(p), exact, atol=2e-5 * np.abs(exact).max())
    with pytest.raises(pc.ArgumentError, match=r"3000 m from the origin.*0\.18 mm: use float64"):
        array_api.field(
            ARRAY.translate(far), xp.asarray(G[0]), xp.asarray((Q[0] + far).astype(np.float32)), AIR
        )


@pytest.mark.skipif(torch is None, reason="PyTorch is not installed")
def test_autograd_agrees_with_the_derivatives() -> None:
    q = torch.tensor(Q[0], requires_grad=True)
    g = torch.tensor(G[0], requires_grad=True)
    p = array_api.field(ARRAY, g, q, AIR)
    exact = pc.differentiate_radiation_pressure(ARRAY, G[0], Q[0], AIR)
    P = p.abs() ** 2 / (AIR.density * AIR.speed_of_sound**2)
    np.testing.assert_allclose(P.detach().numpy(), exact.value, rtol=1e-6)
    P.sum().backward()
    assert q.grad is not None
    assert g.grad is not None
    np.testing.assert_allclose(
        q.grad.numpy(), exact.by_points, atol=1e-5 * np.abs(exact.by_points).max()
    )
    by_gains = exact.by_gains.sum(axis=0)  # PyTorch has the same convention
    np.testing.assert_allclose(g.grad.numpy(), by_gains, atol=1e-6 * np.abs(by_gains).max())


def test_silence_and_no_points(xp: Any) -> None:
    g, p = array_api.solve(ARRAY, xp.asarray(Q), xp.asarray(0.0 * T), medium=pc.Air())
    assert not back(g).any()
    assert not back(p).any()
    none = array_api.field(ARRAY, xp.asarray(G[0]), xp.asarray(np.empty((0, 3))), AIR)
    assert none.shape == (0,)


def test_a_point_on_a_transducer_is_told(xp: Any) -> None:
    q = Q[0].copy()
    q[2] = ARRAY.positions[5]
    with pytest.raises(pc.PointOnTransducer) as told:
        array_api.matrix(ARRAY, xp.asarray(q), AIR)
    assert told.value.indices == (2,)


@pytest.mark.parametrize(
    ("argument", "change"),
    [
        ("points", {"points": Q[..., :2]}),
        ("points", {"points": Q[0, 0]}),
        ("points", {"points": np.nan * Q}),
        ("points", {"points": 1e3 * Q}),  # millimetres
        ("points", {"points": np.zeros((2, 3), np.int64)}),
        ("amplitudes", {"amplitudes": T[:2, :3]}),
        ("amplitudes", {"amplitudes": -T}),
        ("amplitudes", {"amplitudes": 1j * T}),
        ("phases", {"phases": 1j * T}),
        ("amplitudes", {"amplitudes": np.nan * T}),
        ("phases", {"phases": np.inf * T}),
        ("gain", {"gain": 0.0}),
        ("mu", {"mu": -1.0}),
        ("steps", {"steps": -1}),
        ("steps", {"steps": 10**9}),
        ("medium", {"medium": "air"}),
    ],
)
def test_bad_arguments_are_named(xp: Any, argument: str, change: dict[str, Any]) -> None:
    good: dict[str, Any] = {"points": Q, "amplitudes": T, "medium": AIR} | change
    given = {k: xp.asarray(v) if isinstance(v, np.ndarray) else v for k, v in good.items()}
    with pytest.raises(pc.ArgumentError) as told:
        array_api.solve(ARRAY, **given)
    assert told.value.argument == argument


def test_libraries_do_not_mix() -> None:
    with pytest.raises(pc.ArgumentError, match="same library"):
        array_api.field(ARRAY, G, array_api_strict.asarray(Q), AIR)
    with pytest.raises(pc.ArgumentError, match="array of NumPy"):
        array_api.matrix(ARRAY, Q.tolist(), AIR)
    with pytest.raises(pc.ArgumentError, match="gains"):
        array_api.field(ARRAY, G[:, :4], Q, AIR)
    for gains in (np.nan * G, G.astype(object), G.astype(str), 1e30 * G, G[:2], G.tolist()):
        with pytest.raises(pc.ArgumentError, match="gains"):
            array_api.field(ARRAY, gains, Q, AIR)
    with pytest.raises(pc.ArgumentError, match="amplitudes"):
        array_api.solve(ARRAY, Q, [1j] * M, medium=AIR)
    nothing: Any = None
    with pytest.raises(pc.ArgumentError, match="array"):
        array_api.field(nothing, G, Q, AIR)
    with pytest.raises(pc.ArgumentError, match="array"):
        array_api.solve(nothing, Q, T, medium=AIR)
