"""A game sends a hand that strokes a ball, 120 times per second; its own loop renders it 1000 times per second."""

import math
import threading
import time

import pacinian as pc

RATE, SECONDS = 120.0, 2.0  # [Hz] of the game, [s]
SHAKE = pc.Sine(150.0)
REST = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.215)))  # a tracker supplies pc.Hand(joints, ...)


def compute_swing(t: float, width: float) -> tuple[float, float]:
    """Return position [m] and velocity [m/s] of something that swings once per second."""
    return width * math.sin(math.tau * t), math.tau * width * math.cos(math.tau * t)


def ball(t: float) -> pc.Volume:
    """Return a rolling ball, as the game knows it at time t [s]."""
    y, v = compute_swing(t, 0.01)
    return pc.Volume(
        shape=pc.Sphere(0.03),
        pose=pc.Pose((0.0, y, 0.175)),
        motion=pc.Motion(velocity=(0.0, v, 0.0), time=t),
        radiation_pressure=8.0,
        envelope=SHAKE,
        name="ball",  # `put` replaces the object of this name
    )


def hand(t: float) -> pc.Hand:
    """Return a hand that strokes the ball, as a tracker sees it at time t [s]."""
    x, v = compute_swing(t, 0.02)
    joints = REST.transform(pc.Pose((x, 0.0, 0.0))).joints
    return pc.Hand(joints, velocities=(v, 0.0, 0.0), time=t)


scene = pc.Scene((ball(0.0),), hands=(hand(0.0),))
with pc.Renderer(pc.autd(3, 3), scene) as renderer:
    start = time.perf_counter()  # the renderer counts time from here
    loop = threading.Thread(target=renderer.run, args=(SECONDS,))
    loop.start()
    while loop.is_alive():  # the game
        t = time.perf_counter() - start
        renderer.scene = scene = scene.put(ball(t)).with_hands(hand(t))
        time.sleep(1.0 / RATE)
report = renderer.report
print(f"{report.ticks} ticks, {report.solves} solves, {report.fault_count} faults")
for reason, count in report.skipped.items():
    print(f"{count:8} {reason}")
