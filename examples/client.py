"""A game in which a hand feels a rolling ball. Start `pacinian serve` in another terminal first."""

import math
import time

import pacinian as pc

RATE, SECONDS = 90.0, 5.0  # [Hz] of the game, [s]
HAND = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.215)))  # a tracker gives pc.Hand(joints, ...)
BALL = pc.Volume(
    shape=pc.Sphere(0.03),
    pose=pc.Pose((0.0, 0.0, 0.175)),
    radiation_pressure=8.0,  # [Pa]
    envelope=pc.Sine(150.0),
    name="ball",
)

with pc.Client(name="example") as client:
    client.put(BALL)
    client.hands(HAND)
    client.arm()  # from now on, call `renew` repeatedly, or the output falls silent
    begin = time.perf_counter()
    while (t := time.perf_counter() - begin) < SECONDS:  # the game's own loop
        y, v = 0.01 * math.sin(math.tau * t), 0.01 * math.tau * math.cos(math.tau * t)
        client.move("ball", pc.Pose((0.0, y, 0.175)), pc.Motion((0.0, v, 0.0)), wait=False)
        client.hands(HAND, wait=False)
        client.renew()  # raises Refused after a stop, a fault or a takeover: the user should look
        time.sleep(1.0 / RATE)
    state = client.status()
print(f"{state.output}, {len(state.asked) // 4} samples, error {state.error:.2%}")
