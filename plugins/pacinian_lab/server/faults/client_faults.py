"""Faults of a client, or of its connection. Each function injects one fault into a rig, once."""

from __future__ import annotations

import signal
import time
from functools import partial
from typing import TYPE_CHECKING

import psutil
import zmq

from pacinian.wire.connection_file import Connection
from pacinian_lab.server.faults.game import POINT
from pacinian_lab.server.faults.misbehaving_client import MisbehavingClient, Silent, prepare
from pacinian_lab.server.faults.proxy import Proxy
from pacinian_lab.server.faults.rig import Times, until

if TYPE_CHECKING:
    from pacinian_lab.server.faults.rig import Rig

FREEZE = 0.6  # [s]
HOUR = 3600.0  # [s]
READERS, READ = 20, 3.0  # subscribers that never read; length of the test [s]
MOST_TOPICS = 20_000


def kill_client(rig: Rig) -> Times:
    """Kill the game with kill -9, then start another."""
    return Times(rig.inject_fault(rig.end), rig.recover(rig.play))


def stop_client(rig: Rig) -> Times:
    """Stop the game with SIGSTOP, so that its sockets stay open, then continue it with SIGCONT."""
    rig.wait_for_sound()
    game = rig.game
    if game is None:
        raise RuntimeError("there is no game")
    silence = rig.inject_fault(lambda: game.send_signal(signal.SIGSTOP))
    return Times(silence, rig.recover(lambda: game.send_signal(signal.SIGCONT)))


def freeze_client(rig: Rig) -> Times:
    """Freeze the game's thread while its sockets stay alive, then let it go on."""
    silence = rig.inject_fault(lambda: rig.tell("freeze", seconds=FREEZE))
    return Times(silence, rig.recover(after=FREEZE))


def half_open_client(rig: Rig) -> Times:
    """Cut the connection without closing either end. A new game then connects directly."""
    rig.end()
    file = Connection.read(rig.server.file)
    with Proxy(file.control) as control, Proxy(file.command) as command:
        rig.play(control=control.address, command=command.address)

        def cut() -> None:
            control.cut()
            command.cut()

        silence = rig.inject_fault(cut)
        rig.end()
    return Times(silence, rig.recover(rig.play))


def jump_clock(rig: Rig) -> Times:
    """Set the game's clock forward by an hour, then back by two. The output should continue."""
    gaps = [
        rig.measure_gap(partial(rig.tell, "jump", seconds=ahead), 0.5)
        for ahead in (HOUR, -2.0 * HOUR, HOUR)
    ]
    silence = rig.inject_fault(lambda: rig.tell("freeze", seconds=FREEZE))
    recovery = rig.recover(after=FREEZE)
    return Times(
        silence, recovery, max(gaps), note="then frozen: the lease is no longer than before"
    )


def subscribe_unread(rig: Rig) -> Times:
    """Subscribe to the state and never read it; check the memory."""
    context = zmq.Context()
    file = rig.onlooker.file
    process = psutil.Process(rig.server.process.pid)
    before = process.memory_info().rss
    sockets = [context.socket(zmq.SUB) for _ in range(READERS)]
    try:
        for socket in sockets:
            prepare(socket, file)
            socket.rcvhwm, socket.rcvbuf = 1, 4096
            socket.subscribe(b"")
            socket.connect(file["state"])
        gap = rig.measure_gap(lambda: None, READ)
        grown = process.memory_info().rss - before
    finally:
        for socket in sockets:
            socket.close()
        context.term()
    return Times(gap=gap, note=f"{READERS} subscribers for {READ:g} s: {grown / 1e6:+.1f} MB")


def subscribe_widely(rig: Rig) -> Times:
    """Subscribe to thousands of topics; check the memory."""
    context = zmq.Context()
    file = rig.onlooker.file
    process = psutil.Process(rig.server.process.pid)
    before = process.memory_info().rss
    with context.socket(zmq.SUB) as socket:
        prepare(socket, file)
        socket.sndhwm = 0
        socket.connect(file["state"])

        def subscribe() -> None:
            for n in range(MOST_TOPICS):
                socket.subscribe(f"{n:<200d}".encode())

        gap = rig.measure_gap(subscribe, 2.0)
        grown = process.memory_info().rss - before
    context.term()
    return Times(gap=gap, note=f"{MOST_TOPICS} topics: {grown / 1e6:+.1f} MB")


def stop_in_emergency(rig: Rig) -> Times:
    """Stop the output from another client, then reset it."""
    onlooker = rig.onlooker
    silence = rig.inject_fault(lambda: onlooker.say("stop"))
    time.sleep(0.2)  # the game keeps arming meanwhile, and must not sound
    events = rig.events()
    heard = bool(events["sounds"][events["time"] > rig.at + silence].any())
    recovery = rig.recover(lambda: onlooker.ask("reset"))
    return Times(silence, recovery, note="sounded before the reset" if heard else "")


def restart_server(rig: Rig) -> Times:
    """Kill the server with kill -9 under a running client, and start a new one in its place.

    Messages that the client sends in between must not arrive, and its old session and token must not be valid.
    """
    rig.wait_for_sound()
    with MisbehavingClient(rig.server.file) as old:
        old.hello(client="left behind")
        silence = rig.inject_fault(lambda: rig.server.signal("control", signal.SIGKILL))
        until(lambda: not rig.server.list_running())
        since = time.perf_counter()
        writable = 0
        for _ in range(50):
            writable += old.command.poll(0, zmq.POLLOUT) and 1
            if writable:
                old.tell("put", objects={"stale": POINT})
        rig.server.start()
        ready = time.perf_counter()
        recovery = max(0.0, rig.find_heard(since) - ready)
        status = rig.onlooker.ask("status")
        names = [client["name"] for client in status["clients"]]
        try:
            old.renew()
            answered = old.answer(old.id, 0.5)["type"] == "renewed"
        except Silent:
            answered = False
    wrong = ["the old session is still valid"] * answered + ["a stale client"] * (
        "left behind" in names
    )
    wrong += ["stale objects"] * ("stale" in status["objects"])
    note = "; ".join(wrong) or f"nothing stale; the new one was ready after {ready - since:.1f} s"
    return Times(silence, recovery, note=note)
