"""A link that a test can block and release."""

from __future__ import annotations

import contextlib
import socket
import threading
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

ROOM = 1 << 14  # [bytes] that wait in it


class BlockableLink:
    """Forwards bytes to a `tcp://host:port` unless it is blocked; a context manager. address: where it listens."""

    def __init__(self, to: str) -> None:
        host, port = to.removeprefix("tcp://").rsplit(":", 1)
        self._to = host, int(port)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, ROOM)
        self.address = f"tcp://127.0.0.1:{self._listener.getsockname()[1]}"
        self.goes = threading.Event()
        """Set: it passes."""
        self.goes.set()
        self.tap: Callable[[str, bytes], object] = lambda _side, _data: None
        """Is told what comes, and from whom: "near", who connected, or "far"."""
        self._open: list[socket.socket] = []
        self._threads = [threading.Thread(target=self._accept)]
        self._threads[0].start()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):  # closed
            while True:
                near, _ = self._listener.accept()
                try:
                    far = socket.create_connection(self._to)
                except OSError:  # no program listens now
                    near.close()
                    continue
                self._open += near, far
                for way in (("near", near, far), ("far", far, near)):
                    self._threads.append(threading.Thread(target=self._pass, args=way))
                    self._threads[-1].start()

    def _pass(self, side: str, source: socket.socket, sink: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while data := source.recv(ROOM):
                self.goes.wait()
                self.tap(side, data)
                sink.sendall(data)
            sink.shutdown(socket.SHUT_WR)

    def __enter__(self) -> BlockableLink:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.goes.set()
        for each in (self._listener, *self._open):
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()
        for thread in self._threads:
            thread.join()
