"""The session: arguments, state, and guarantees that hold whatever a solver does."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

import pacinian as pc
from pacinian.solving.limit_enforcement import enforce_limits
from pacinian.testing import ManualClock

ARRAY = pc.lattice(0.05, 0.05)
POINT = [[0.0, 0.0, 0.1]]


@dataclass(frozen=True)
class Writes(pc.Solver):
    """A solver that writes given gains, or raises a given error."""

    name: ClassVar[str] = "writes"
    gains: Any = 0.0

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        if isinstance(self.gains, Exception):
            raise self.gains
        out[:] = self.gains
        return pc.Result()


@pytest.mark.parametrize(
    ("argument", "call"),
    [
        ("array", {"array": None}),
        ("medium", {"medium": "x"}),
        ("limits", {"limits": {}}),
        ("solver", {"solver": 5}),
        ("solver", {"solver": pc.Solver}),
        ("points", {"points": [[0, 0]]}),
        ("points", {"points": [[0, 0, np.nan]]}),
        ("points", {"points": [[0, 0, 100.0]]}),  # millimetres
        ("amplitudes", {"amplitudes": [1.0, 2.0]}),
        ("amplitudes", {"amplitudes": [-1.0]}),
        ("amplitudes", {"amplitudes": [np.nan]}),
        ("amplitudes", {"amplitudes": [1e31]}),  # implausible pressure
        ("amplitudes", {"amplitudes": np.array(["2020-01-01"], dtype="datetime64[D]")}),
        ("phases", {"phases": [0.0, 1.0]}),
        ("phases", {"phases": "free"}),
        ("phases", {"phases": 1j}),
        ("phases", {"phases": np.inf}),
        ("scale", {"scale": "most"}),
        ("scale", {"scale": np.array(["exact", "max"])}),
        ("scale", {"scale": "max", "limits": pc.Limits(gain=None)}),  # contradictory
        ("deadline", {"deadline": -1.0}),
        ("deadline", {"deadline": np.nan}),
        ("out", {"out": [1, 2]}),
        ("out", {"out": np.zeros(36)}),
        ("out", {"out": np.zeros(35, dtype=np.complex64)}),
        ("out", {"out": np.zeros(72, dtype=np.complex64)[::2]}),
        ("precision", {"precision": "half"}),
    ],
)
def test_a_bad_argument_is_named(argument: str, call: dict[str, Any]) -> None:
    given = {"array": ARRAY, "points": POINT, "amplitudes": [1.0]} | call
    with pytest.raises(pc.ArgumentError, match=f"`{argument}`") as caught:
        pc.solve(**given)
    assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize("limit", [{"gain": 0.0}, {"gain": -1.0}, {"gain": np.nan}, {"power": 0.0}])
def test_a_bad_limit_is_named(limit: dict[str, float]) -> None:
    with pytest.raises(pc.ArgumentError, match=next(iter(limit))):
        pc.Limits(**limit)


def test_an_unknown_solver_is_named_with_those_there_are() -> None:
    with pytest.raises(pc.UnknownPlugin, match="lagrange"):
        pc.solve(ARRAY, POINT, [1.0], solver="magic")


def test_a_point_on_a_transducer_is_an_error_only_where_that_is_singular() -> None:
    on = [[0.0, 0.0, 0.1], ARRAY.positions[5]]
    with pytest.raises(pc.PointOnTransducer) as caught:
        pc.solve(ARRAY, on, [1.0, 1.0])
    assert caught.value.indices == (1,)
    solution = pc.solve(ARRAY, on, [1.0, 1.0], medium=pc.Air(attenuation="none"))
    assert solution.status is pc.Status.ok


def test_an_array_far_from_the_origin_loses_nothing() -> None:
    pose = pc.Pose((1000.0, -2000.0, 500.0))
    q = np.array([[0.01, 0.0, 0.1], [-0.01, 0.01, 0.1]])
    here = pc.solve(ARRAY, q, [50.0, 80.0], 0.0)
    there = pc.solve(ARRAY.transform(pose), pose.points(q), [50.0, 80.0], 0.0)
    np.testing.assert_allclose(there.gains, here.gains, atol=2e-5)


@pytest.mark.parametrize("gains", [np.nan, np.inf, complex(0, np.nan)])
def test_gains_that_are_not_finite_end_in_silence(gains: complex) -> None:
    with np.errstate(invalid="ignore"):
        solution = pc.solve(ARRAY, POINT, [1.0], solver=Writes(gains))
    assert solution.status is pc.Status.failed
    assert not solution.gains.any()


@pytest.mark.parametrize("gains", [1.0000001, 1e30, 1e-3 + 5j])
def test_a_solver_that_ignores_the_limit_is_scaled_down(gains: complex) -> None:
    solution = pc.solve(ARRAY, POINT, [1.0], solver=Writes(gains))
    exact = solution.gains.astype(np.complex128)
    assert (exact.real**2 + exact.imag**2 <= 1.0).all()


def test_the_limit_is_kept_in_exact_arithmetic() -> None:
    rng = np.random.default_rng(0)
    for limit in (1.0, 0.3, 0.7071):
        angle = rng.uniform(0, 2 * np.pi, 100_000)
        g = (limit * np.exp(1j * angle)).astype(np.complex64)
        assert (
            np.abs(g.astype(np.complex128)) > limit
        ).any()  # rounding alone would exceed the limit
        assert enforce_limits(g, pc.Limits(gain=limit), "exact") == (True, False)
        exact = g.astype(np.complex128)
        assert (exact.real**2 + exact.imag**2 <= limit**2).all()


def test_what_a_solver_raises_comes_out_and_leaves_the_session_usable() -> None:
    session = pc.Session(ARRAY, solver=Writes(RuntimeError("broken")))
    with pytest.raises(RuntimeError, match="broken"):
        session.solve(POINT, [1.0])
    session.solver = "single-focus"
    assert session.solve(POINT, [1.0]).status is pc.Status.ok


def test_gains_are_written_to_out() -> None:
    out = np.full(36, 7, dtype=np.complex64)
    solution = pc.solve(ARRAY, POINT, [5.0], out=out)
    assert solution.gains is out
    assert np.abs(out).max() < 1.0


def test_a_warm_session_gives_what_a_cold_one_gives() -> None:
    rng = np.random.default_rng(3)
    session = pc.Session(ARRAY, solver="lagrange")
    q = rng.uniform(-0.04, 0.04, (5, 3)) + np.array([0, 0, 0.1])
    for _ in range(5):
        q += rng.uniform(-0.001, 0.001, q.shape)
        warm = session.solve(q, np.full(5, 12.0), 0.0)
        cold = pc.solve(ARRAY, q, np.full(5, 12.0), 0.0, solver="lagrange")
        assert warm.error == pytest.approx(cold.error, abs=1e-4)
        np.testing.assert_allclose(warm.gains, cold.gains, atol=2e-3)


def test_a_deadline_is_measured_by_the_sessions_clock() -> None:
    clock = ManualClock()
    spent: list[bool] = []

    class Slow(pc.Solver):
        name = "slow"

        def solve(
            self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
        ) -> pc.Result:
            spent.append(budget.spent)
            clock.advance(0.002)
            spent.append(budget.spent)
            return pc.Result(late=True)

    solution = pc.Session(ARRAY, solver=Slow(), clock=clock.now).solve(POINT, [1.0], deadline=0.001)
    assert spent == [False, True]
    assert solution.status is pc.Status.deadline
    assert solution.seconds == pytest.approx(0.002)


def test_phases_may_be_partly_free() -> None:
    q = [[0.03, 0.0, 0.1], [-0.03, 0.0, 0.1], [0.0, 0.03, 0.1]]
    solution = pc.solve(ARRAY, q, [20.0, 20.0, 20.0], [0.5, np.nan, -0.5], solver="lagrange")
    assert solution.status is pc.Status.ok
    np.testing.assert_allclose(np.angle(solution.sound_pressure)[[0, 2]], [0.5, -0.5], atol=1e-3)


def test_a_solution_describes_itself() -> None:
    solution = pc.solve(ARRAY, POINT, [5.0])
    assert "single-focus" in repr(solution)
    assert "ok" in repr(solution)
    assert solution.status.advice == solution.status.value


def cheat(act: Any) -> pc.Solver:
    class Cheats(pc.Solver):
        name = "cheats"

        def solve(
            self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
        ) -> pc.Result:
            out[:] = 0.5
            act(propagator, targets)
            return pc.Result()

    return Cheats()


@pytest.mark.parametrize(
    "act",
    [
        lambda propagator, targets: targets.amplitudes.fill(0.0),
        lambda propagator, targets: propagator.B.fill(0.0),
        lambda propagator, targets: propagator.gram.fill(0.0),
        lambda propagator, targets: propagator.points.fill(0.0),
    ],
)
def test_a_solver_cannot_change_what_it_is_judged_by(act: Any) -> None:
    with pytest.raises(ValueError, match="read-only"):
        pc.solve(ARRAY, POINT, [5.0], solver=cheat(act))


def test_a_solver_that_moves_the_points_is_found_out() -> None:
    with pytest.raises(pc.PluginError, match="moved the points"):
        pc.solve(
            ARRAY,
            POINT,
            [5.0],
            solver=cheat(lambda propagator, _: propagator.set_points(np.ones((1, 3)))),
        )


@pytest.mark.parametrize("amplitude", [1e-300, 1e-44, 1e-30, 1e30])
@pytest.mark.parametrize("scale", ["exact", "max"])
@pytest.mark.parametrize(
    "limits", [pc.Limits(), pc.Limits(power=10.0), pc.Limits(gain=None, power=1.0)]
)
@pytest.mark.parametrize("solver", ["lagrange", "pseudo-inverse", "gs-pat"])
def test_the_evidence_is_finite_for_targets_of_any_size(
    amplitude: float, scale: str, limits: pc.Limits, solver: str
) -> None:
    q = [[0.02, 0.0, 0.1], [-0.02, 0.0, 0.1]]
    solution = pc.solve(
        ARRAY, q, [amplitude, amplitude / 2], solver=solver, scale=scale, limits=limits
    )
    assert np.isfinite([solution.error, solution.shape_error]).all()
    assert solution.status is (pc.Status.silent if amplitude < 1e-30 else solution.status)
    if limits.power is not None:
        assert np.vdot(solution.gains, solution.gains).real <= limits.power
    if scale == "max" and amplitude >= 1e-29:
        assert solution.shape_error < 0.1


def test_a_solver_that_returns_no_result_is_named() -> None:
    class Mute(pc.Solver):
        name = "mute"

        def solve(self, *arguments: Any) -> pc.Result:
            return None  # type: ignore[return-value]

    with pytest.raises(pc.ArgumentError, match="mute"):
        pc.solve(ARRAY, POINT, [1.0], solver=Mute())


def test_one_number_is_the_amplitude_of_all_points() -> None:
    points = [[0.02, 0.0, 0.15], [-0.02, 0.0, 0.15]]
    for amplitude in (90.0, 90, np.float32(90.0), np.array(90.0)):
        solution = pc.solve(ARRAY, points, amplitude)
        assert (solution.targets.amplitudes == 90.0).all()
        assert np.abs(solution.sound_pressure) == pytest.approx([90.0, 90.0], rel=0.01)


def test_one_point_may_have_shape_3() -> None:
    for point in ((0.0, 0.0, 0.15), [0, 0, 0.15], np.array([0.0, 0.0, 0.15])):
        one = pc.solve(ARRAY, point, 300.0)
        assert one.points.shape == (1, 3)
        assert one.gains == pytest.approx(pc.solve(ARRAY, [[0.0, 0.0, 0.15]], [300.0]).gains)


@pytest.mark.parametrize("amplitude", [math.nan, -1.0, math.inf, "loud", 1j, None, 1e40, [1.0]])
def test_an_amplitude_that_cannot_be_is_refused(amplitude: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`amplitudes`"):
        pc.solve(ARRAY, [[0.02, 0.0, 0.15], [-0.02, 0.0, 0.15]], amplitude)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("bound", None),
        ("objective", "much"),
        ("iterations", "a"),
        ("iterations", 1.5),
        ("late", "a"),
        ("limited", None),
        ("note", None),
        ("solver", 3),
        ("mu", "a"),
        ("mu", -1.0),
        ("mu", math.inf),
        pytest.param("mu", 10**400, id="mu-huge"),
        pytest.param("bound", -(10**400), id="bound-huge"),
        ("multipliers", [1.0]),
        ("multipliers", np.zeros(2)),
        ("multipliers", np.array(["a"])),
    ],
)
def test_a_wrong_result_is_told_with_solver_and_field(field: str, value: Any) -> None:
    with pytest.raises(pc.PluginError, match=rf"solver 'reports'.*`{field}`"):
        pc.solve(ARRAY, POINT, [5.0], solver=reports(**{field: value}))


@pytest.mark.parametrize(
    "given",
    [
        np.array([2, 3], np.int8),
        np.array([2.0, 3.0], np.float32),
        np.array([2.0, 3.0], np.complex64),
        np.array([2.0, 3.0], ">c16"),
        np.array([2.0, 0.0, 3.0], complex)[::2],
        np.frombuffer(b"\0" + np.array([2.0, 3.0], complex).tobytes(), complex, 2, 1),
    ],
    ids=["int8", "float32", "complex64", "big-endian", "strided", "not aligned"],
)
def test_multipliers_of_any_numeric_type_are_converted_for_the_kernels(given: Any) -> None:
    points = [[0.02, 0.0, 0.15], [-0.02, 0.0, 0.15]]
    y = pc.solve(ARRAY, points, 300.0, solver=reports(multipliers=given)).multipliers
    assert y is not None
    assert y.dtype == np.dtype(np.complex128)
    assert y.dtype.isnative
    assert y.flags.c_contiguous
    assert y.flags.aligned
    assert y.tolist() == [2.0, 3.0]


def test_multipliers_that_need_no_conversion_are_not_copied() -> None:
    given = np.array([2.0 + 1j])
    assert pc.solve(ARRAY, POINT, [5.0], solver=reports(multipliers=given)).multipliers is given


def test_a_bound_that_cannot_be_checked_does_not_count() -> None:
    assert math.isnan(pc.solve(ARRAY, POINT, [5.0], solver=reports(bound=1e9)).bound)
    checked = pc.solve(ARRAY, POINT, [5.0], solver=reports(bound=1e9, mu=np.float32(1e-6)))
    assert checked.bound == checked.objective


def reports(**fields: Any) -> pc.Solver:
    class Reports(Writes):
        name: ClassVar[str] = "reports"

        def solve(self, *_: Any) -> pc.Result:
            return pc.Result(**fields)

    return Reports()
