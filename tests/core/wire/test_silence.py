"""Why an output is silent, from states: each cause by itself, and that the first that applies is told."""

from typing import Any, get_args

import numpy as np
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.scene.hands.capsules import distance_to_skin, make_capsules
from pacinian.scene.objects import Object
from pacinian.wire.silence import Cause, Silence, explain_silence, find_nearest
from pacinian.wire.state import ClientState, State

PALM = (0.0, 0.0, 0.2)


def hand(at: tuple[float, float, float] = PALM) -> bytes:
    joints = pc.Hand.open(pose=pc.Pose(at)).joints
    assert joints is not None
    return joints.astype("<f4").tobytes()


def ball(at: tuple[float, float, float], name: str = "ball", radius: float = 0.02) -> pc.Volume:
    return pc.Volume(
        shape=pc.Sphere(radius), pose=pc.Pose(at), radiation_pressure=5.0, name=name
    )  # fmt: skip


def client(**fields: Any) -> ClientState:
    given = {
        "name": "game", "scene": "hall", "owner": True, "objects": 1, "commands": 9, "errors": 0,
        "dropped": 0, "age": 0.001, "renewed": 0.01,
    }  # fmt: skip
    return ClientState(**{**given, **fields})


def state(**fields: Any) -> State:
    """A state of an armed output that is silent, of a scene with one object."""
    given = {
        "sequence": 1, "time": 1.0, "output": "silent", "armed": True, "owner": "game", "scene": "hall",
        "solver": "auto", "backend": "simulated", "technique": "", "intensity": 1.0, "status": "silent",
        "clients": (client(),),
    }  # fmt: skip
    return State(**{**given, **fields})


ONE = np.ones(1, "<f4").tobytes()
ZERO = np.zeros(1, "<f4").tobytes()
CASES: list[tuple[Cause, State | None, str]] = [
    ("not connected", None, "pacinian serve"),
    ("fault", state(output="faulted", faults=("device: gone",)), "device: gone.*reset.*arm"),
    ("fault", state(output="faulted", backend=""), "no device"),
    ("fault", state(output="faulted"), "log"),
    ("stopped", state(output="stopped", armed=False), r"emergency stop.*reset\(\).*arm\(\)"),
    ("late", state(output="stale"), "late"),
    ("not armed", state(armed=False, owner="", scene=""), r"not armed: call arm\(\)"),
    ("lease lost", state(armed=False), r'"game" lost its lease.*arm\(\).*renew\(\)'),
    ("not ready", state(status="silent: the quiet zones are being prepared"), "quiet zones"),
    ("no pressure", state(intensity=0.0), "intensity is 0"),
    ("no objects", state(clients=(client(objects=0),)), r"put\(\)"),
    ("no objects", state(clients=(client(), client(scene="x"))[1:]), r"put\(\)"),
    ("hand not seen", state(skipped={"hands lost": 9}), "no hand is seen"),
    ("no pressure", state(), "no object presses"),
    ("nothing in reach", state(hands=hand(), skipped={"objects out of reach": 3}), "touches no"),
    ("out of the array's reach",
     state(hands=hand(), asked=ONE, achieved=ZERO, skipped={"samples hardly reached": 1}), "palm"),
    ("pause", state(hands=hand(), asked=ONE, achieved=ONE), "envelope"),
    ("pause", state(asked=ZERO, achieved=ZERO), "envelope"),
]  # fmt: skip


@pytest.mark.parametrize(("cause", "told", "says"), CASES)
def test_each_cause_is_told_with_what_to_do(cause: Cause, told: State | None, says: str) -> None:
    found = explain_silence(told)
    assert found is not None
    assert found.cause == cause
    with pytest.raises(AssertionError, match=says):
        raise AssertionError(str(found))


def test_all_causes_are_tried_here() -> None:
    assert {case[0] for case in CASES} | {"too faint"} == set(get_args(Cause))


def test_what_sounds_has_no_cause() -> None:
    assert explain_silence(state(output="sounding")) is None


def test_the_first_cause_that_applies_is_told() -> None:
    """A cause hides those that are told only of an output that could sound otherwise."""
    worst = state(
        output="faulted", armed=False, intensity=0.0, faults=("x",), skipped={"hands lost": 1}
    )
    order = [worst]
    for change in (
        {"output": "stopped"}, {"output": "silent"}, {"armed": True}, {"intensity": 1.0},
    ):  # fmt: skip
        order.append(replace(order[-1], **change))
    causes = [found.cause for told in order if (found := explain_silence(told))]
    assert causes == ["fault", "stopped", "lease lost", "no pressure", "hand not seen"]


def test_the_nearest_object_is_named_with_its_distance() -> None:
    """The palm's skin is half of its thickness below the joint."""
    far, near = ball((0.0, 0.0, 0.05), "far"), ball((0.0, 0.0, 0.1), "near")
    found = explain_silence(state(hands=hand()), (far, near))
    assert isinstance(found, Silence)
    assert found.cause == "nothing in reach"
    nearest = find_nearest(hand(), (far, near))
    assert nearest is not None
    assert nearest.item.name == "near"
    assert nearest.gap == pytest.approx(0.1 - 0.02 - 0.015, abs=0.006)
    assert f'"near" is nearest, {1e3 * nearest.gap:.0f} mm away' in found.text


@pytest.mark.parametrize(
    "item",
    [
        pc.Point(position=(0.0, 0.0, 0.1), radiation_pressure=1.0, name="it"),
        pc.Path(shape=pc.Circle(0.01), pose=pc.Pose((0.0, 0.0, 0.1)), radiation_pressure=1.0, name="it"),
        pc.Particles(positions=((0.0, 0.0, 0.0), (0.0, 0.0, -0.05)), pose=pc.Pose((0.0, 0.0, 0.1)),
                     radiation_pressure=1.0, name="it"),
        pc.Surface(shape=pc.Disc(0.02), pose=pc.Pose((0.0, 0.0, 0.1)),
                   radiation_pressure=1.0, name="it"),
        ball((0.0, 0.0, 0.1), "it"),
    ],
)  # fmt: skip
def test_every_kind_of_object_has_a_distance(item: Object) -> None:
    """It shrinks as the hand comes nearer, and is that of the flesh around the bones."""
    high, low = find_nearest(hand((0.0, 0.0, 0.25)), (item,)), find_nearest(hand(), (item,))
    assert high is not None
    assert low is not None
    assert 0.045 < high.gap - low.gap < 0.051
    capsules = make_capsules(pc.Hand.open(pose=pc.Pose(PALM)))
    places = item.pose.points(item.sample_surface(0.001).points)
    exact = float(distance_to_skin(capsules, places).min())
    felt = 0.0 if isinstance(item, (pc.Surface, pc.Volume)) else item.radius
    assert low.gap == pytest.approx(exact - felt, abs=1e-3)


@pytest.mark.parametrize(
    ("pressure", "intensity", "cause", "says"),
    [
        (0.1, 1.0, "too faint", "0.1 Pa are below the 0.22 Pa"),
        (1.0, 0.1, "too faint", "0.1 Pa are below the 0.22 Pa"),
        (0.0, 1.0, "no pressure", "its pressure is 0"),
        (1.0, 1.0, "out of the array's reach", "turn the palm"),
    ],
)
def test_a_touch_that_does_not_sound(
    pressure: float, intensity: float, cause: Cause, says: str
) -> None:
    """Too faint, without pressure, or on skin that the array does not see."""
    touched = replace(ball((0.0, 0.0, 0.2)), radiation_pressure=pressure)
    nearest = find_nearest(hand(), (touched,))
    assert nearest is not None
    assert nearest.gap < 0.0
    found = explain_silence(state(hands=hand(), intensity=intensity), (touched,))
    assert found is not None
    assert found.cause == cause
    assert says in found.text
    assert '"ball" is touched' in found.text


def test_without_hands_or_objects_nothing_is_nearest() -> None:
    assert find_nearest(b"", (ball(PALM),)) is None
    assert find_nearest(hand(), ()) is None
    assert find_nearest(np.full((1, 26, 3), np.nan, "<f4").tobytes(), (ball(PALM),)) is None
