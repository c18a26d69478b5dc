"""Dask for real: processes that are killed, workers elsewhere, schedulers that are not there."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import ssl
import subprocess
import sys
import time
from typing import TYPE_CHECKING, Any

import psutil
import pytest

import pacinian as pc
import pacinian_lab.study as ps
from pacinian_lab.study import engine
from pacinian_lab.study.tasks import Plan

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

LONG = """
solvers = ["auto", "gs-pat"]
[[layouts]]
type = "lattice"
width = [0.08, 0.1]
[[layouts]]
type = "random"
width = 0.1
count = 100
[[patterns]]
type = "focus"
[[patterns]]
type = "letters"
text = "A"
[[planes]]
z = [0.15, 0.2]
"""
# Dask sometimes drops the socket of a worker that was killed without closing it.
pytestmark = pytest.mark.filterwarnings(
    r"ignore:Exception ignored in. <ssl\.SSLSocket:pytest.PytestUnraisableExceptionWarning"
)
ALERT = b"\x15"  # first byte of a TLS alert
WAIT = 200.0  # [s] ends a test that hangs
HELD_UP = """
import threading
from pacinian.cli.main import main
from pacinian_lab.study import engine
results = engine.results
def held_up(*given):
    for count, rows in enumerate(results(*given), 1):
        yield rows
        if count == 2:
            threading.Event().wait()
engine.results = held_up
main()
"""  # `pacinian`, as if a study took for ever after its second part


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The table of the long study, done in this process."""
    folder = tmp_path_factory.mktemp("undisturbed")
    (folder / "study.toml").write_text(LONG)
    return ps.run(folder / "study.toml", folder / "out", workers=0)


@contextlib.contextmanager
def command(*arguments: str, cwd: Path) -> Iterator[subprocess.Popen[str]]:
    """`pacinian study` as a process group of its own, which gets no further than two parts."""
    process = subprocess.Popen(
        [sys.executable, "-W", "error", "-c", HELD_UP, "study", *arguments],
        cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def until(happened: Callable[[], Any], run: subprocess.Popen[str] | None = None) -> Any:
    """What a condition comes to when it is true; run: what must not end before."""
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        if found := happened():
            return found
        if run is not None and run.poll() is not None:
            pytest.fail(f"it has ended: {run.communicate()}")
        time.sleep(0.005)
    pytest.fail(f"it has not happened in {WAIT:g} s")


def parts(out: Path) -> int:
    return len(list((out / "parts").glob("*.parquet")))


def workers(pid: int) -> list[psutil.Process]:
    """The worker processes of a process."""
    found = list[psutil.Process]()
    for child in psutil.Process(pid).children(recursive=True):
        with contextlib.suppress(psutil.Error):  # it has just ended
            title = " ".join(child.cmdline())
            if (
                "spawn_main" in title or "dask worker" in title
            ):  # with setproctitle, which renames it
                found.append(child)
    return found


@pytest.mark.deep
def test_a_worker_that_is_killed_costs_nothing(
    undisturbed: Any, same: Callable[[Any], str], write: Callable[..., Path], tmp_path: Path
) -> None:
    killed: list[psutil.Process] = []

    def kill(count: int) -> None:
        if not killed:
            killed.extend(workers(os.getpid())[:1])
            killed[0].kill()

    table = ps.run(write(LONG), tmp_path / "out", workers=2, advance=kill)
    assert killed
    assert same(table) == same(undisturbed)


@pytest.mark.deep
def test_a_command_that_is_killed_and_then_interrupted_goes_on_where_it_stopped(
    undisturbed: Any, same: Callable[[Any], str], write: Callable[..., Path], tmp_path: Path
) -> None:
    path, out = write(LONG), tmp_path / "out"
    arguments = (str(path), "--out", str(out), "--workers", "1", "--no-pictures")
    with command(*arguments, cwd=tmp_path) as run:
        until(lambda: parts(out) == 2, run)
        (worker,) = workers(run.pid)
        run.kill()
        run.communicate()
    until(lambda: not worker.is_running() or worker.status() == psutil.STATUS_ZOMBIE)
    with command(*arguments, cwd=tmp_path) as run:
        until(lambda: parts(out) == 4, run)
        (worker,) = workers(run.pid)
        os.killpg(run.pid, signal.SIGINT)  # as a terminal does
        _, stderr = run.communicate(timeout=WAIT)
    assert run.returncode == 130
    assert "tasks were done before" in stderr
    assert "finished tasks are kept: run the same command to continue" in stderr
    assert "Traceback" not in stderr
    assert not worker.is_running() or worker.status() == psutil.STATUS_ZOMBIE
    assert 0 < len(ps.load(out)) < len(undisturbed)
    assert same(ps.run(path, out, workers=0)) == same(undisturbed)


@pytest.fixture
def scheduler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], str]]:
    """Starts a scheduler as its own command does; then a worker, when it is called."""
    monkeypatch.setattr(engine, "MAX_WAIT", WAIT)
    here = {**os.environ, "DASK_DISTRIBUTED__SCHEDULER__HTTP__ROUTES": "[]"}
    options: dict[str, Any] = {"cwd": tmp_path, "env": here, "stdout": subprocess.DEVNULL}
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
    alone = ["--no-dashboard", "--dashboard-address", "127.0.0.1:0"]
    processes = [
        subprocess.Popen(
            [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", address, *alone],
            stderr=subprocess.DEVNULL, **options,
        )
    ]  # fmt: skip

    def work() -> str:
        processes.append(
            subprocess.Popen(
                [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1",
                 "--no-nanny", *alone],
                stderr=subprocess.DEVNULL, **options,
            )
        )  # fmt: skip
        return address

    def listens() -> bool:
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", int(address.rsplit(":", 1)[1]))) == 0

    until(listens)
    work.address = address  # type: ignore[attr-defined]
    work.processes = processes  # type: ignore[attr-defined]
    yield work
    for process in processes[::-1]:
        process.kill()
        process.wait()


@pytest.mark.deep
def test_a_scheduler_elsewhere_without_workers_with_one_and_gone(
    undisturbed: Any, same: Callable[[Any], str], write: Callable[..., Path], tmp_path: Path,
    scheduler: Any, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    path, out = write(LONG), tmp_path / "out"

    def refused() -> bool:
        try:
            ps.run(path, out, scheduler=scheduler.address)
        except pc.ServerError as error:
            return "has no workers; start one: dask worker" in str(error)
        return False

    with monkeypatch.context() as impatient:
        impatient.setattr(engine, "MAX_WAIT", 0.5)
        until(refused)
    scheduler()
    table = ps.run(path, tmp_path / "whole", scheduler=scheduler.address)
    assert same(table) == same(undisturbed)
    done: list[int] = []

    def end(count: int) -> None:
        done.append(count)
        if len(done) == 2:
            for process in scheduler.processes[::-1]:
                process.kill()

    with pytest.raises(pc.ServerError, match="Dask scheduler is lost; finished tasks are kept"):
        ps.run(path, out, scheduler=scheduler.address, advance=end)
    assert sum(done) <= len(ps.load(out)) < len(undisturbed)
    assert same(ps.run(path, out, workers=0)) == same(undisturbed)


def test_no_scheduler_is_told(
    write: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine, "MAX_WAIT", 0.5)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        nobody = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        for address in (nobody, "nonsense://x"):
            with pytest.raises(pc.ServerError, match="no Dask scheduler answers at"):
                ps.run(write(), tmp_path / "out", scheduler=address)


def test_local_processes_have_one_thread_listen_on_the_loopback_alone_and_know_each_other() -> None:
    with engine.local(1) as client:
        found = client.run(_surroundings)
        mine = psutil.Process()
        (pid,) = (told["pid"] for told in found.values())
        for process in (mine, psutil.Process(pid)):
            heard = [c.laddr.ip for c in process.net_connections() if c.status == "LISTEN"]
            assert set(heard) <= {"127.0.0.1"}
        (told,) = found.values()
        assert told["threads"] == 1
        assert set(told["environment"]) == {"1"}
        assert told["ignored"]
        address = client.scheduler.address
        assert address.startswith("tls://127.0.0.1:")
        host, port = address.removeprefix("tls://").split(":")
        for encrypted in (True, False):
            assert _refused(host, int(port), encrypted=encrypted)


def _refused(host: str, port: int, *, encrypted: bool) -> bool:
    """Whether one without our certificate is told nothing but a TLS alert."""
    stranger = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    stranger.check_hostname, stranger.verify_mode = False, ssl.CERT_NONE
    with socket.create_connection((host, port), 30.0) as plain:
        try:
            if encrypted:
                with stranger.wrap_socket(plain) as secure:
                    return secure.recv(1) == b""
            plain.sendall(b"hello" * 20)
            return plain.recv(1) in (b"", ALERT)
        except (ssl.SSLError, ConnectionError):
            return True


def _surroundings(dask_worker: Any) -> dict[str, Any]:
    """Of a worker."""
    from threadpoolctl import threadpool_info

    return {
        "pid": os.getpid(),
        "threads": max(
            [dask_worker.state.nthreads, *(p["num_threads"] for p in threadpool_info())]
        ),
        "environment": [os.environ[name] for name in engine.ONE],
        "ignored": signal.getsignal(signal.SIGINT) is signal.SIG_IGN,
    }


@pytest.mark.deep
def test_what_kills_its_workers_again_and_again_is_a_row(
    write: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    from dask import config

    plan = Plan(ps.read(write()))
    monkeypatch.setattr(engine, "measure", _die)
    with config.set({"distributed.scheduler.allowed-failures": 0}), engine.local(1) as client:
        (rows,) = engine.results(client, plan, plan.batches()[:1])
    assert [row["key"] for row in rows] == [task.key for task in plan.batches()[0]]
    assert all("died repeatedly" in row["failure"] for row in rows)


def _die(batch: object) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_dashboard_needs_bokeh(
    write: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(pc.ArgumentError, match="pip install bokeh"):
        ps.run(write(), tmp_path / "out", workers=1, dashboard=print)
