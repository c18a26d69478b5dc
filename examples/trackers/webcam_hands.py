"""Hands in a webcam's picture, through MediaPipe. Start `pacinian serve` first; needs the file hand_landmarker.task."""

# pyright: basic, reportMissingImports=false
from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any, Literal

import cv2
import mediapipe as mp
import numpy as np

import pacinian as pc

if TYPE_CHECKING:
    from pacinian.types import Floats

# The camera's place in the array's frame: 60 cm above the middle, looking down, with the top of its picture at +y.
PLACE = pc.Pose((0.0, 0.0, 0.6)).rotate("x", math.pi)
FIELD_OF_VIEW = math.radians(65.0)  # of the camera, from the left to the right edge
MODEL = "hand_landmarker.task"
# OpenXR's joints that MediaPipe has, in MediaPipe's order: wrist, four of the thumb, and four of each finger.
JOINTS = [1, 2, 3, 4, 5, 7, 8, 9, 10, 12, 13, 14, 15, 17, 18, 19, 20, 22, 23, 24, 25]
PALM, WRIST, MIDDLE = 0, 1, 11
METACARPALS = np.array([6, 11, 16, 21])  # of the fingers; MediaPipe has none
DEPTHS = np.array(
    [[0.33], [0.30], [0.35], [0.45]]
)  # their beginnings, from wrist (0) to knuckle (1)


class HandReader:
    """Up to two hands in the newest picture."""

    def __init__(self, camera: int = 0) -> None:
        self.camera = cv2.VideoCapture(camera)
        vision = mp.tasks.vision
        self.landmarker = vision.HandLandmarker.create_from_options(
            vision.HandLandmarkerOptions(
                base_options=mp.tasks.BaseOptions(model_asset_path=MODEL),
                running_mode=vision.RunningMode.VIDEO,
                num_hands=2,
            )
        )

    def read(self) -> list[pc.Hand]:
        """Return the hands in the next picture, in the array's frame."""
        good, picture = self.camera.read()
        if not good:
            return []
        rgb = np.ascontiguousarray(picture[:, :, ::-1])
        image = mp.Image(mp.ImageFormat.SRGB, rgb)
        found = self.landmarker.detect_for_video(image, time.monotonic_ns() // 1_000_000)
        height, width = rgb.shape[:2]
        return [
            make_hand(local, seen, label[0].category_name.lower(), width, height)
            for local, seen, label in zip(
                found.hand_world_landmarks, found.hand_landmarks, found.handedness, strict=True
            )
        ]


def make_hand(
    local: list[Any], seen: list[Any], side: Literal["left", "right"], width: int, height: int
) -> pc.Hand:
    """Return a hand. local: landmarks about the hand's middle [m]; seen: the same in the picture, 0 to 1."""
    points = np.array([[p.x, p.y, p.z] for p in local])
    pixels = np.array([[width * (p.x - 0.5), height * (p.y - 0.5)] for p in seen])
    points += find_translation(points, pixels / (0.5 * width / math.tan(FIELD_OF_VIEW / 2.0)))
    joints = np.empty((26, 3))
    joints[JOINTS] = points
    joints[METACARPALS] = joints[WRIST] + DEPTHS * (joints[METACARPALS + 1] - joints[WRIST])
    joints[PALM] = (joints[MIDDLE] + joints[MIDDLE + 1]) / 2.0
    return pc.Hand(joints, side=side).transform(PLACE)


def find_translation(points: Floats, slopes: Floats) -> Floats:
    """Return where the hand's middle is in the camera's frame (x right, y down, z ahead) [m].

    points: (21, 3) [m]; slopes: x/z and y/z at which the camera sees them, (21, 2). A least-squares fit of
    (points + t)[:2] = slopes (points + t)[2].
    """
    rows, rest = np.zeros((21, 2, 3)), slopes * points[:, 2:] - points[:, :2]
    rows[:, 0, 0] = rows[:, 1, 1] = 1.0
    rows[:, :, 2] = -slopes
    found = np.linalg.lstsq(rows.reshape(42, 3), rest.reshape(42), rcond=None)[0]
    return np.asarray(found, np.float64)


if __name__ == "__main__":
    from felt_ball import feel

    feel(HandReader().read)
