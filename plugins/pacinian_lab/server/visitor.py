"""A client that comes to be killed: it moves an object of its own until then."""

from __future__ import annotations

import time

from msgspec import Struct

from pacinian.acoustics.pose import Pose
from pacinian.client.client import Client
from pacinian.scene.objects import Volume
from pacinian.scene.shapes import Sphere
from pacinian_lab.server import worker_process

FRAME = 1.0 / 90.0  # [s]


class Visit(Struct, frozen=True):
    """Where, and which scene."""

    connection: str
    scene: str


def main() -> None:
    """In its own process, until it is killed."""
    visit = worker_process.read_task(Visit)
    orders = worker_process.queue_orders(Visit)
    with Client(visit.connection, name="visitor", scene=visit.scene) as client:
        client.put(Volume(shape=Sphere(0.01), radiation_pressure=5.0, name="visit"))
        worker_process.answer(visit)
        while orders.empty():
            x = 0.01 * (time.perf_counter() % 1.0)
            client.move("visit", Pose((x, -0.03, 0.2)), wait=False)
            client.renew()
            time.sleep(FRAME)


if __name__ == "__main__":
    main()
