"""A thread that answers ZeroMQ's questions about new connections (ZAP, RFC 27)."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import zmq
from zmq.auth import Authenticator

if TYPE_CHECKING:
    import logging


class ZapThread:
    """Runs pyzmq's authenticator in a thread.

    pyzmq's own `ThreadAuthenticator` does the same with asyncio, which takes 10 MB and 0.1 s to load. rules: configure
    them as those of any authenticator.
    """

    def __init__(self, context: zmq.Context[Any], log: logging.Logger) -> None:
        self.rules = Authenticator(context, log=log)
        self._context = context
        self._end: zmq.Socket[bytes] | None = None
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Start to answer."""
        self.rules.start()
        ours, theirs = (self._context.socket(zmq.PAIR) for _ in range(2))
        for pipe in (ours, theirs):
            pipe.linger = 1
        address = f"inproc://pacinian-zap-{id(self)}"
        ours.bind(address)
        theirs.connect(address)
        self._end = ours
        self._thread = threading.Thread(target=self._run, args=(theirs,), name="zap", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the thread; from then on, nobody is let in."""
        if self._thread is None or self._end is None:
            return
        self._end.send(b"")
        self._thread.join()
        self._end.close()
        self._thread = self._end = None
        self.rules.stop()

    def _run(self, end: zmq.Socket[bytes]) -> None:
        asked = self.rules.zap_socket
        poller = zmq.Poller()
        poller.register(end, zmq.POLLIN)
        poller.register(asked, zmq.POLLIN)
        with end:
            while end not in (events := dict(poller.poll())):
                if asked in events:
                    answer = self.rules.handle_zap_message(asked.recv_multipart())
                    try:
                        # it finishes at once, because our rules are not coroutines
                        answer.send(None)
                    except StopIteration:
                        continue
