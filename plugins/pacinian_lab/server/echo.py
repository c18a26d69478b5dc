"""The baseline for latency: a ROUTER with the server's authentication that echoes each message."""

from __future__ import annotations

import secrets
import threading
from typing import TYPE_CHECKING, Any

import zmq
from msgspec import Struct
from zmq.auth.thread import ThreadAuthenticator

from pacinian.serving.ipc.auth import DOMAIN, USER
from pacinian_lab.server import worker_process

if TYPE_CHECKING:
    from collections.abc import Iterator


class Echo(Struct, frozen=True):
    """Address of the echo server. token: its password."""

    endpoint: str
    token: str


def run(ended: threading.Event) -> Iterator[Echo]:
    """Yield the address, then echo messages until `ended`."""
    context = zmq.Context[Any]()
    guard = ThreadAuthenticator(context)
    guard.start()
    token = secrets.token_hex(32)
    guard.configure_plain(DOMAIN, passwords={USER: token})
    router = context.socket(zmq.ROUTER)
    router.linger, router.plain_server, router.zap_domain = 0, True, DOMAIN.encode()
    try:
        port = router.bind_to_random_port("tcp://127.0.0.1")
        yield Echo(f"tcp://127.0.0.1:{port}", token)
        while not ended.is_set():
            if router.poll(100):
                router.send_multipart(router.recv_multipart())
    finally:
        router.close(0)
        guard.stop()
        context.term()


def main() -> None:
    """Run in a separate process until the parent ends."""
    ended = threading.Event()

    def watch() -> None:
        worker_process.read_order(Echo)
        ended.set()

    threading.Thread(target=watch, daemon=True).start()
    for echo in run(ended):
        worker_process.answer(echo)


if __name__ == "__main__":
    main()
