"""`pacinian.testing.run_server`: a real server that clients find while it runs, and that leaves nothing behind."""

from __future__ import annotations

import socket
import sys

import psutil
import pytest

import pacinian as pc
from pacinian.errors import ServerError
from pacinian.scene.config_sections import Units
from pacinian.serving.settings import Network, Settings
from pacinian.testing import run_server
from pacinian.testing.server import list_processes

ONE = Settings(array=Units(1, 1))


def test_its_processes_are_found_and_end_with_it() -> None:
    with run_server(ONE) as server:
        pids = server.pids
        assert pids.keys() == {"control", "bus", "render", "guard"}
        assert len(set(pids.values())) == 4
        used = server.usage()
        assert used.keys() == pids.keys()
        for one in used.values():
            assert one.memory > 1e6
            assert one.cpu > 0.0
            assert one.files > 0
        with pc.Client(server.connection, timeout=60.0) as client:
            assert client.status().output == "silent"
    assert not any(map(psutil.pid_exists, pids.values()))
    assert not server.connection.exists()
    assert server.process.returncode is not None


@pytest.mark.skipif(
    sys.platform != "linux", reason="processes are forked, and tell PSS, on Linux only"
)
def test_an_idle_server_is_small() -> None:
    """Its processes share most of their memory. 150 MB is what a game can spare."""
    with run_server() as server:
        with pc.Client(server.connection, timeout=60.0) as client:
            assert client.status().output == "silent"
        processes = list_processes(server.process.pid).values()
        taken = [process.memory_full_info().pss / 1e6 for process in processes]
    assert len(taken) == 5
    assert sum(taken) < 150.0, taken


def test_all_of_it_ends_when_its_first_process_was_killed() -> None:
    with run_server(ONE) as server:
        pids = server.pids
        server.process.kill()
    assert not any(map(psutil.pid_exists, pids.values()))


def test_a_server_that_cannot_start_says_why() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        wrong = Settings(array=Units(1, 1), network=Network(control=port))
        with pytest.raises(ServerError, match="cannot be bound"), run_server(wrong):
            pass
