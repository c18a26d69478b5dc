"""What goes wrong at a client's end, or on the way to it. Each function does one to a stage, once."""

from __future__ import annotations

import signal
import time
from functools import partial
from typing import TYPE_CHECKING

import psutil
import zmq

from pacinian_lab.server.faults.game import POINT
from pacinian_lab.server.faults.proxy import Proxy
from pacinian_lab.server.faults.raw_client import Peer, Silent, prepare
from pacinian_lab.server.faults.stage import Times, until

if TYPE_CHECKING:
    from pacinian_lab.server.faults.stage import Stage

FREEZE = 0.6  # [s]
HOUR = 3600.0  # [s]
READERS, READ = 20, 3.0  # who never read; for so long [s]
MOST_TOPICS = 20_000


def killed(stage: Stage) -> Times:
    """kill -9 of the game; another is started."""
    return Times(stage.broken(stage.end), stage.healed(stage.play))


def stopped(stage: Stage) -> Times:
    """SIGSTOP of the game, its sockets stay open; SIGCONT."""
    stage.sounding()
    game = stage.game
    if game is None:
        raise RuntimeError("there is no game")
    silence = stage.broken(lambda: game.send_signal(signal.SIGSTOP))
    return Times(silence, stage.healed(lambda: game.send_signal(signal.SIGCONT)))


def frozen(stage: Stage) -> Times:
    """The game's thread freezes, its sockets are alive; it thaws."""
    silence = stage.broken(lambda: stage.tell("freeze", seconds=FREEZE))
    return Times(silence, stage.healed(after=FREEZE))


def half_open(stage: Stage) -> Times:
    """The wire is cut and no end is told; the game comes anew, by another."""
    stage.end()
    with Proxy(address(stage, "control")) as control, Proxy(address(stage, "command")) as command:
        stage.play(control=control.address, command=command.address)

        def cut() -> None:
            control.cut()
            command.cut()

        silence = stage.broken(cut)
        stage.end()
    return Times(silence, stage.healed(stage.play))


def address(stage: Stage, name: str) -> str:
    """Of one of the server's sockets."""
    with Peer(stage.server.file) as peer:
        return str(peer.file[name])


def jumped(stage: Stage) -> Times:
    """The game's clock goes on by an hour, then back by two; it should sound on."""
    gaps = [
        stage.gap(partial(stage.tell, "jump", seconds=ahead), 0.5)
        for ahead in (HOUR, -2.0 * HOUR, HOUR)
    ]
    silence = stage.broken(lambda: stage.tell("freeze", seconds=FREEZE))
    recovery = stage.healed(after=FREEZE)
    return Times(silence, recovery, max(gaps), note="then frozen: the lease is no longer than ever")


def slow(stage: Stage) -> Times:
    """Clients that subscribe to the state and never read it: memory."""
    context = zmq.Context()
    file = stage.onlooker.file
    process = psutil.Process(stage.server.process.pid)
    before = process.memory_info().rss
    sockets = [context.socket(zmq.SUB) for _ in range(READERS)]
    try:
        for socket in sockets:
            prepare(socket, file)
            socket.rcvhwm, socket.rcvbuf = 1, 4096
            socket.subscribe(b"")
            socket.connect(file["state"])
        gap = stage.gap(lambda: None, READ)
        grown = process.memory_info().rss - before
    finally:
        for socket in sockets:
            socket.close()
        context.term()
    return Times(gap=gap, note=f"{READERS} of them for {READ:g} s: {grown / 1e6:+.1f} MB")


def greedy(stage: Stage) -> Times:
    """A client that subscribes to thousands of topics: memory."""
    context = zmq.Context()
    file = stage.onlooker.file
    process = psutil.Process(stage.server.process.pid)
    before = process.memory_info().rss
    with context.socket(zmq.SUB) as socket:
        prepare(socket, file)
        socket.sndhwm = 0
        socket.connect(file["state"])

        def subscribe() -> None:
            for n in range(MOST_TOPICS):
                socket.subscribe(f"{n:<200d}".encode())

        gap = stage.gap(subscribe, 2.0)
        grown = process.memory_info().rss - before
    context.term()
    return Times(gap=gap, note=f"{MOST_TOPICS} topics: {grown / 1e6:+.1f} MB")


def emergency(stage: Stage) -> Times:
    """An emergency stop from another client; then a reset."""
    onlooker = stage.onlooker
    silence = stage.broken(lambda: onlooker.say("stop"))
    time.sleep(0.2)  # the game arms again and again meanwhile, and must not be heard
    events = stage.events()
    heard = bool(events["sounds"][events["time"] > stage.at + silence].any())
    recovery = stage.healed(lambda: onlooker.ask("reset"))
    return Times(silence, recovery, note="was heard before the reset" if heard else "")


def restarted(stage: Stage) -> Times:
    """kill -9 of the server under a running client, and a new one in its place.

    What the client sends meanwhile must not arrive, nor its session and token be good for anything.
    """
    stage.sounding()
    with Peer(stage.server.file) as old:
        old.hello(client="left behind")
        silence = stage.broken(lambda: stage.server.signal("control", signal.SIGKILL))
        until(lambda: not stage.server.left())
        since = time.perf_counter()
        told = 0
        for _ in range(50):
            told += old.command.poll(0, zmq.POLLOUT) and 1
            if told:
                old.tell("put", objects={"stale": POINT})
        stage.server.start()
        ready = time.perf_counter()
        recovery = max(0.0, stage.heard(since) - ready)
        status = stage.onlooker.ask("status")
        names = [client["name"] for client in status["clients"]]
        try:
            old.renew()
            answered = old.answer(old.id, 0.5)["type"] == "renewed"
        except Silent:
            answered = False
    wrong = ["the old session lives"] * answered + ["a stale client"] * ("left behind" in names)
    wrong += ["stale objects"] * ("stale" in status["objects"])
    note = "; ".join(wrong) or f"nothing stale; the new one was ready after {ready - since:.1f} s"
    return Times(silence, recovery, note=note)
