"""The canonical hand: a flat right hand with straight, slightly spread fingers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Floats

JOINTS = 26

# Coordinates in [mm]: x to the little finger, y to the fingertips, z out of the back of the hand. The size is an
# adult's, between the median woman and the median man: 19 cm from the wrist to the tip of the middle finger. We chose
# the lengths between joints near those that headsets report.
WRIST = (0.0, -60.0, 0.0)
# For each finger: both ends of its metacarpal in x and y, its direction from +y towards +x [deg], and the lengths of
# its phalanges.
FINGERS = (
    ((-14.0, -32.0), (-22.5, 31.0), -7.0, (41.0, 24.0, 18.0)),
    ((0.0, -32.0), (0.0, 32.0), 0.0, (45.0, 28.0, 19.0)),
    ((12.0, -31.0), (20.5, 27.0), 7.0, (42.0, 27.0, 19.0)),
    ((22.0, -28.0), (38.5, 17.0), 16.0, (33.0, 19.0, 17.0)),
)
THUMB = ((-22.0, -44.0, -6.0), (-52.0, -14.0, -14.0), (-74.0, 8.0, -17.0), (-88.0, 25.0, -18.0))

# Radius at each joint, from its centre to the skin [mm]: rounded from Meta's hand in the WebXR emulation runtime
# (github.com/meta-quest/immersive-web-emulation-runtime, device/configs/hand), which has no palm joint.
JOINT_RADII = (
    (20.0, 21.0),
    (19.0, 12.5, 10.0, 8.5),
    (20.0, 10.5, 8.5, 7.5, 6.5),
    (20.0, 11.0, 8.5, 7.5, 6.5),
    (19.0, 10.0, 8.0, 7.5, 6.5),
    (18.0, 8.5, 7.0, 6.5, 5.5),
)


def rest_joints() -> Floats:
    """Return the joints of the canonical right hand in OpenXR's order, (26, 3) [m], with the palm at the origin."""
    rows = [(0.0, 0.0, 0.0), WRIST, *THUMB]
    for base, knuckle, angle, lengths in FINGERS:
        forward = np.array([np.sin(np.radians(angle)), np.cos(np.radians(angle))])
        along = np.concatenate([[0.0], np.cumsum(lengths)])
        rows += [(*base, 0.0)] + [(x, y, 0.0) for x, y in knuckle + along[:, None] * forward]
    return np.array(rows) / 1e3


def rest_radii() -> Floats:
    """Return the radii of the canonical hand's joints, (26,) [m]."""
    return np.array([r for part in JOINT_RADII for r in part]) / 1e3
