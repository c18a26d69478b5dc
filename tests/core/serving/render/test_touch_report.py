"""What a hand touches, and what is nearest to it, against independently computed distances."""

import numpy as np
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.scene.hands.capsules import distance_to_skin, make_capsules
from pacinian.scene.objects import Object
from pacinian.serving.render.touch_report import (
    explain_contact,
    explain_loading,
    explain_outside,
    find_nearest,
    find_touches,
)
from pacinian.wire.silence_cause import Silence

PALM = (0.0, 0.0, 0.2)


def hand(at: tuple[float, float, float] = PALM, name: str = "right@1") -> pc.Hand:
    return pc.Hand.open("right", pc.Pose(at), name=name)


def ball(at: tuple[float, float, float], name: str = "ball", radius: float = 0.02) -> pc.Volume:
    return pc.Volume(
        shape=pc.Sphere(radius), pose=pc.Pose(at), radiation_pressure=5.0, name=name
    )  # fmt: skip


def test_the_nearest_object_is_named_with_its_distance() -> None:
    """The palm's skin lies half of the palm's thickness below the joint."""
    far, near = ball((0.0, 0.0, 0.05), "far"), ball((0.0, 0.0, 0.1), "near")
    found = explain_contact([hand()], (far, near))
    assert found.cause == "nothing in reach"
    nearest = find_nearest([hand()], (far, near))
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
    """The distance shrinks as the hand approaches. It is measured from the skin."""
    high, low = find_nearest([hand((0.0, 0.0, 0.25))], (item,)), find_nearest([hand()], (item,))
    assert high is not None
    assert low is not None
    assert 0.045 < high.gap - low.gap < 0.051
    capsules = make_capsules(hand())
    places = item.pose.points(item.sample_surface(0.001).points)
    exact = float(distance_to_skin(capsules, places).min())
    felt = 0.0 if isinstance(item, (pc.Surface, pc.Volume)) else item.radius
    assert low.gap == pytest.approx(exact - felt, abs=1e-3)


@pytest.mark.parametrize(
    ("pressure", "cause", "says"),
    [
        (0.1, "too faint", "0.1 Pa are below the 0.22 Pa"),
        (0.0, "no pressure", "its pressure is 0"),
        (1.0, "out of the array's reach", "turn the palm"),
    ],
)
def test_a_touch_that_does_not_sound(pressure: float, cause: str, says: str) -> None:
    """The touch is too faint, has no pressure, or is on skin that the array does not see."""
    touched = replace(ball((0.0, 0.0, 0.2)), radiation_pressure=pressure)
    nearest = find_nearest([hand()], (touched,))
    assert nearest is not None
    assert nearest.gap < 0.0
    found = explain_contact([hand()], (touched,))
    assert found.cause == cause
    assert says in found.text
    assert '"ball" is touched' in found.text


def test_without_hands_or_objects_nothing_is_nearest() -> None:
    assert find_nearest([], (ball(PALM),)) is None
    assert find_nearest([hand()], ()) is None
    assert find_nearest([pc.Hand(np.full((26, 3), np.nan))], (ball(PALM),)) is None


def test_touches_are_those_of_each_hand_with_each_object() -> None:
    """Two hands, one of them on two objects, make three touches, each with the object's own pressure."""
    left, right = hand((-0.06, 0.0, 0.2), "left@1"), hand((0.06, 0.0, 0.2))
    items = (
        ball((-0.06, 0.0, 0.175), "soft"),
        replace(ball((0.06, 0.02, 0.18), "hard"), radiation_pressure=20.0),
        ball((0.06, -0.02, 0.18), "low"),
    )
    scene = pc.Scene(items, hands=(left, right))
    samples = pc.Sampler(budget=200).sample(scene)
    touches = find_touches(samples, scene.hands)
    assert [(t.hand, t.object) for t in touches] == [
        ("left", "soft"),
        ("right", "hard"),
        ("right", "low"),
    ]
    for touch, item in zip(touches, items, strict=True):
        near = float(np.linalg.norm(np.subtract(touch.position, item.pose.position)))
        assert near < 0.025  # at the skin in the ball
        assert 0.0 < touch.strength <= 1.0
        assert touch.pressure == pytest.approx(touch.strength * item.pressure, rel=1e-6)
    assert not find_touches(samples, ())
    assert not find_touches(samples.only(samples.objects < 0), scene.hands)


def test_objects_that_are_prepared_are_named() -> None:
    assert explain_loading([]) is None
    found = explain_loading("abcd")
    assert found is not None
    assert found.cause == "not ready"
    assert found.text.startswith('being prepared: "a", "b", "c" and others; ')


def test_objects_outside_the_workspace_are_named() -> None:
    """Only those that need no hand; a few of many."""
    room = pc.Workspace((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3))

    def explain(*places: float) -> Silence | None:
        points = (
            pc.Point(position=(x, 0.0, 0.2), radiation_pressure=1.0, name=f"at {x:g}")
            for x in places
        )
        sampler = pc.Sampler()
        sampler.sample(pc.Scene(tuple(points), room))
        return explain_outside(sampler.sample_counts.objects)

    assert explain() is None
    assert explain(0.0) is None
    found = explain(0.0, 0.5)
    assert found is not None
    assert found.cause == "no pressure"
    assert found.text.startswith('outside the workspace: "at 0.5"; move')
    many = explain(*np.arange(1.0, 9.0))
    assert many is not None
    assert '"at 1", "at 2", "at 3" and others' in many.text
