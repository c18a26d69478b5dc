"""Run the tracker examples with stand-ins for the trackers' libraries: each reads a hand whose joints are known."""

from __future__ import annotations

import ctypes
import importlib
import itertools
import math
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import run_server
from pacinian.wire.connection_file import VARIABLE

LIMIT = 120.0  # [s]
FOLDER = Path(__file__).parents[1] / "examples/trackers"
HAND = pc.Hand.open("right", pc.Pose((0.02, 0.01, 0.23), (0.0, 0.0, math.sin(0.2), math.cos(0.2))))


@pytest.fixture(autouse=True)
def _import_from_the_examples(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(FOLDER))
    for name in ("felt_ball", "openxr_hands", "leap_hands", "webcam_hands"):
        monkeypatch.delitem(sys.modules, name, raising=False)


def stand_in(monkeypatch: pytest.MonkeyPatch, name: str, **members: Any) -> None:
    module = ModuleType(name)
    vars(module).update(members)
    monkeypatch.setitem(sys.modules, name, module)


def seen_from(pose: pc.Pose) -> np.ndarray[Any, Any]:
    """Return the hand's joints in the frame of a tracker at `pose`."""
    assert HAND.joints is not None
    return (HAND.joints - pose.position) @ pose.matrix


def point(p: np.ndarray[Any, Any]) -> SimpleNamespace:
    return SimpleNamespace(x=p[0], y=p[1], z=p[2])


def test_openxr(monkeypatch: pytest.MonkeyPatch) -> None:
    class Position(ctypes.Structure):
        _fields_ = [(name, ctypes.c_float) for name in "xyz"]

    class Pose(ctypes.Structure):
        _fields_ = [("orientation", 4 * ctypes.c_float), ("position", Position)]

    class Joint(ctypes.Structure):
        _fields_ = [("location_flags", ctypes.c_uint64), ("pose", Pose), ("radius", ctypes.c_float)]

    class Locations(ctypes.Structure):
        _fields_ = [("is_active", ctypes.c_uint32), ("joint_count", ctypes.c_uint32),
                    ("joints", ctypes.POINTER(Joint))]  # fmt: skip

        def __init__(self, joint_locations: Any) -> None:
            super().__init__(0, len(joint_locations), joint_locations)
            self.joint_locations = joint_locations

    class Event(ctypes.Structure):
        _fields_ = [("type", ctypes.c_int), ("state", ctypes.c_int)]

    class UnavailableError(Exception):
        pass

    Locate = ctypes.CFUNCTYPE(
        ctypes.c_int, ctypes.c_int, ctypes.c_double, ctypes.POINTER(Locations)
    )

    @Locate
    def locate(side: int, now: float, found: Any) -> int:
        assert now > 0.0
        if side == 1:  # no left hand
            return 0
        found[0].is_active = 1
        for k, at in enumerate(seen_from(openxr_hands.STAGE)):
            joint = found[0].joints[k]
            joint.location_flags, joint.radius = 2, HAND.radii[k]
            joint.pose.position = Position(*at)
        return 0

    events, begun = [Event(5, 2)], []

    def poll_event(instance: str) -> Event:
        if not events:
            raise UnavailableError
        return events.pop()

    def make(*args: Any, **given: Any) -> Any:
        return args, given

    stand_in(
        monkeypatch, "xr", MND_HEADLESS_EXTENSION_NAME="h", EXT_HAND_TRACKING_EXTENSION_NAME="t",
        KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME="c", SPACE_LOCATION_POSITION_VALID_BIT=2,
        HandEXT=SimpleNamespace(LEFT=1, RIGHT=2), InstanceCreateInfo=make, SystemGetInfo=make,
        FormFactor=SimpleNamespace(HEAD_MOUNTED_DISPLAY=1), SessionCreateInfo=make, ReferenceSpaceCreateInfo=make,
        ReferenceSpaceType=SimpleNamespace(STAGE=3), HandTrackerCreateInfoEXT=lambda hand: hand,
        create_instance=make, get_system=make, create_session=make, create_reference_space=make,
        create_hand_tracker_ext=lambda session, hand: hand, HAND_JOINT_COUNT_EXT=26,
        get_instance_proc_addr=lambda instance, name: {"xrLocateHandJointsEXT": locate}[name],
        PFN_xrLocateHandJointsEXT=Locate, timespec=lambda seconds, rest: seconds + 1e-9 * rest,
        convert_timespec_time_to_time_khr=lambda instance, now: now, HandJointLocationEXT=Joint,
        HandJointLocationsEXT=Locations, HandJointsLocateInfoEXT=lambda base_space, time: time,
        check_result=lambda code: SimpleNamespace(is_exception=lambda: code != 0), poll_event=poll_event,
        EventUnavailable=UnavailableError, StructureType=SimpleNamespace(EVENT_DATA_SESSION_STATE_CHANGED=5),
        EventDataSessionStateChanged=Event, SessionState=SimpleNamespace(READY=2, STOPPING=6),
        SessionBeginInfo=make, ViewConfigurationType=SimpleNamespace(PRIMARY_STEREO=2),
        begin_session=lambda *args: begun.append(args), end_session=begun.clear,
    )  # fmt: skip
    openxr_hands = importlib.import_module("openxr_hands")
    reader = openxr_hands.HandReader()
    (hand,) = reader.read()
    assert len(begun) == 1
    assert hand.side == "right"
    np.testing.assert_allclose(hand.joints, HAND.joints, atol=1e-6)
    np.testing.assert_allclose(hand.radii, HAND.radii, atol=1e-6)
    lost = Locations((26 * Joint)())
    assert openxr_hands.make_hand(lost, "left").lost


def test_leap(monkeypatch: pytest.MonkeyPatch) -> None:
    listener = type("Listener", (), {})
    stand_in(monkeypatch, "leap", Listener=listener, HandType=SimpleNamespace(Left=0, Right=1))
    leap_hands = importlib.import_module("leap_hands")
    J = 1e3 * seen_from(leap_hands.PLACE)  # [mm]
    chains = [[2, 2, 3, 4, 5], *([k, k + 1, k + 2, k + 3, k + 4] for k in (6, 11, 16, 21))]
    digits = [
        SimpleNamespace(
            bones=[
                SimpleNamespace(prev_joint=J[a], next_joint=J[b], width=16.0)
                for a, b in itertools.pairwise(chain)
            ]
        )
        for chain in chains
    ]
    hand = SimpleNamespace(digits=digits, arm=SimpleNamespace(next_joint=J[1]), type=1)
    reader = leap_hands.HandReader()
    assert reader.read() == []
    reader.on_tracking_event(SimpleNamespace(hands=[hand]))
    (made,) = reader.read()
    assert made.side == "right"
    np.testing.assert_allclose(made.joints, HAND.joints, atol=1e-6)


def test_a_webcam(monkeypatch: pytest.MonkeyPatch) -> None:
    shape = 480, 640, 3

    def detect(image: Any, now: int) -> SimpleNamespace:
        assert image[0] == "srgb"
        assert image[1].shape == shape
        P = seen_from(webcam_hands.PLACE)[webcam_hands.JOINTS]
        f = 320.0 / math.tan(webcam_hands.FIELD_OF_VIEW / 2.0)
        pixels = [(320.0 + f * x / z, 240.0 + f * y / z, 0.0) for x, y, z in P]
        return SimpleNamespace(
            hand_world_landmarks=[[point(p) for p in P - P.mean(axis=0)]],
            hand_landmarks=[[point(np.array(p) / (640, 480, 1)) for p in pixels]],
            handedness=[[SimpleNamespace(category_name="Right")]],
        )

    camera = SimpleNamespace(read=lambda: (True, np.zeros(shape, np.uint8)))
    stand_in(monkeypatch, "cv2", VideoCapture=lambda index: camera)
    vision = SimpleNamespace(
        HandLandmarker=SimpleNamespace(
            create_from_options=lambda options: SimpleNamespace(detect_for_video=detect)
        ),
        HandLandmarkerOptions=dict,
        RunningMode=SimpleNamespace(VIDEO="video"),
    )
    stand_in(
        monkeypatch, "mediapipe", tasks=SimpleNamespace(vision=vision, BaseOptions=dict),
        Image=lambda kind, data: (kind, data), ImageFormat=SimpleNamespace(SRGB="srgb"),
    )  # fmt: skip
    webcam_hands = importlib.import_module("webcam_hands")
    (hand,) = webcam_hands.HandReader().read()
    assert hand.side == "right"
    assert HAND.joints is not None
    np.testing.assert_allclose(
        hand.joints[webcam_hands.JOINTS], HAND.joints[webcam_hands.JOINTS], atol=1e-6
    )
    np.testing.assert_allclose(hand.joints, HAND.joints, atol=8e-3)  # metacarpals are estimates
    camera.read = lambda: (False, None)
    assert webcam_hands.HandReader().read() == []


def test_the_ball_is_felt(monkeypatch: pytest.MonkeyPatch) -> None:
    class FeltError(Exception):
        pass

    felt_ball = importlib.import_module("felt_ball")
    with run_server() as server, pc.Client(server.connection, name="watcher") as watcher:
        monkeypatch.setenv(VARIABLE, str(server.connection))

        def read() -> list[pc.Hand]:
            if watcher.status().output == "sounding":
                raise FeltError
            return [pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.24)))]

        with pytest.raises(FeltError):
            felt_ball.feel(read, LIMIT)
