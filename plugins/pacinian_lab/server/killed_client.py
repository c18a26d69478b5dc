"""A client of the soak test that moves its own object until it is killed: the server must remove the object."""

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
    """What the client gets: the connection file of the server, and the scene that it joins."""

    connection: str
    scene: str


def main() -> None:
    """Run in a separate process until it is killed."""
    visit = worker_process.read_task(Visit)
    orders = worker_process.queue_orders(Visit)
    with Client(visit.connection, name="killed_client", scene=visit.scene) as client:
        client.put(Volume(shape=Sphere(0.01), radiation_pressure=5.0, name="visit"))
        worker_process.answer(visit)
        while orders.empty():
            x = 0.01 * (time.perf_counter() % 1.0)
            client.move("visit", Pose((x, -0.03, 0.2)), wait=False)
            client.renew()
            time.sleep(FRAME)


if __name__ == "__main__":
    main()
