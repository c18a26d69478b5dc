"""Hands of an OpenXR runtime, without graphics, through pyopenxr. Start `pacinian serve` and the runtime first."""

# pyright: basic, reportMissingImports=false
from __future__ import annotations

import ctypes
import math
import time
from typing import Any, Literal

import numpy as np
import xr

import pacinian as pc

# The stage's origin in the array's frame. The stage has y up and the array has z up. Measure the position.
STAGE = pc.Pose((0.0, -0.3, -0.8)).rotate("x", math.pi / 2.0)
EXTENSIONS = [
    xr.MND_HEADLESS_EXTENSION_NAME,
    xr.EXT_HAND_TRACKING_EXTENSION_NAME,
    xr.KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME,  # Linux
]
VALID = xr.SPACE_LOCATION_POSITION_VALID_BIT
Side = Literal["left", "right"]
SIDES: dict[Side, Any] = {"left": xr.HandEXT.LEFT, "right": xr.HandEXT.RIGHT}


class HandReader:
    """Both hands of an OpenXR session."""

    def __init__(self) -> None:
        self.instance = xr.create_instance(
            xr.InstanceCreateInfo(enabled_extension_names=EXTENSIONS)
        )
        system = xr.get_system(
            self.instance, xr.SystemGetInfo(form_factor=xr.FormFactor.HEAD_MOUNTED_DISPLAY)
        )
        self.session = xr.create_session(self.instance, xr.SessionCreateInfo(system_id=system))
        self.stage = xr.create_reference_space(
            self.session, xr.ReferenceSpaceCreateInfo(xr.ReferenceSpaceType.STAGE)
        )
        self.trackers: dict[Side, Any] = {
            side: xr.create_hand_tracker_ext(self.session, xr.HandTrackerCreateInfoEXT(hand=hand))
            for side, hand in SIDES.items()
        }
        address = xr.get_instance_proc_addr(self.instance, "xrLocateHandJointsEXT")
        self.locate = ctypes.cast(address, xr.PFN_xrLocateHandJointsEXT)
        self.begun = False

    def read(self) -> list[pc.Hand]:
        """Return the tracked hands, in the array's frame."""
        self._follow_session()
        if not self.begun:
            return []
        seconds, rest = divmod(time.clock_gettime_ns(time.CLOCK_MONOTONIC), 10**9)
        now = xr.convert_timespec_time_to_time_khr(self.instance, xr.timespec(seconds, rest))
        return [
            make_hand(locations, side)
            for side, tracker in self.trackers.items()
            if (locations := self._locate(tracker, now)).is_active
        ]

    def _locate(self, tracker: xr.HandTrackerEXT, now: xr.Time) -> xr.HandJointLocationsEXT:
        joints = (xr.HandJointLocationEXT * xr.HAND_JOINT_COUNT_EXT)()
        found = xr.HandJointLocationsEXT(joint_locations=joints)
        where = xr.HandJointsLocateInfoEXT(base_space=self.stage, time=now)
        result = xr.check_result(self.locate(tracker, where, ctypes.byref(found)))
        if result.is_exception():
            raise result
        return found

    def _follow_session(self) -> None:
        """Begin the session when the runtime is ready, and end it when the runtime stops."""
        while True:
            try:
                event = xr.poll_event(self.instance)
            except xr.EventUnavailable:
                return
            if event.type != xr.StructureType.EVENT_DATA_SESSION_STATE_CHANGED:
                continue
            changed = ctypes.cast(
                ctypes.byref(event), ctypes.POINTER(xr.EventDataSessionStateChanged)
            ).contents
            if changed.state == xr.SessionState.READY:
                xr.begin_session(
                    self.session, xr.SessionBeginInfo(xr.ViewConfigurationType.PRIMARY_STEREO)
                )
                self.begun = True
            elif changed.state == xr.SessionState.STOPPING:
                xr.end_session(self.session)
                self.begun = False


def make_hand(locations: xr.HandJointLocationsEXT, side: Side) -> pc.Hand:
    """Return a hand. Joints without a valid position are NaN: such a hand counts as lost."""
    joints, radii = np.full((26, 3), np.nan), np.empty(26)
    for k, joint in enumerate(locations.joint_locations):
        at = joint.pose.position
        if joint.location_flags & VALID:
            joints[k] = at.x, at.y, at.z
        radii[k] = joint.radius
    return pc.Hand(joints, radii, side=side).transform(STAGE)


if __name__ == "__main__":
    from felt_ball import feel

    feel(HandReader().read)
