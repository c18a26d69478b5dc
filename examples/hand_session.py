"""Record a session with a hand, play it back, and render it again: the frames are the same bit for bit."""

import math
import sys
import tempfile
from pathlib import Path

import numpy as np

import pacinian as pc
from pacinian.plot import figure, save
from pacinian.testing import ManualClock

ball = pc.Volume(
    shape=pc.Sphere(0.03),
    pose=pc.Pose((0.0, 0.0, 0.175)),
    radiation_pressure=8.0,  # [Pa]
    envelope=pc.Sine(150.0),
    name="ball",
)
REST = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.215)))  # a tracker supplies pc.Hand(joints, ...)


def session(t: float) -> pc.Scene:
    """Return the scene at time t [s]: the hand moves to and fro over the ball."""
    hand = REST.transform(pc.Pose((0.05 * math.sin(math.tau * t), 0.0, 0.0)))
    return pc.Scene((ball,), hands=(hand,))


with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "session.pac"
    clock = ManualClock()  # simulated time; omit it with a tracker
    report = pc.Renderer(pc.autd(3, 3), session, clock=clock, recorder=pc.Recorder(file)).run(1.0)
    recording = pc.Recording(file)
    print(f"{report.ticks} ticks recorded; {pc.rerender(recording)}")
    can = recording.capability
    time = np.array([frame.time for frame in recording])  # [s]
    drive = np.array([np.mean(np.abs(frame.gains(can)[-1]) ** 2) for frame in recording])
page = figure(6.0, 2.6)
panel = page.subplots()
panel.plot(1e3 * (time - time[0]), 1e2 * drive, lw=0.6)
panel.set(
    xlabel="time [ms]", ylabel="mean drive power [% of full]", title="A hand session, replayed"
)
save(page, sys.argv[1] if len(sys.argv) > 1 else "hand_session.png")
