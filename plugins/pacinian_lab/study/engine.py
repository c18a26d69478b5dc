"""Run tasks with Dask: on local processes, unless the address of a scheduler is given."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import itertools
import logging
import tempfile
import warnings
from concurrent.futures import CancelledError
from contextlib import AbstractContextManager, contextmanager
from typing import TYPE_CHECKING, cast

from pacinian.errors import ArgumentError, MissingExtra, ServerError
from pacinian_lab.study.worker import make_failure, measure

try:
    from dask import config
    from dask.system import CPU_COUNT
    from distributed import Client, Future, KilledWorker, LocalCluster, Security, as_completed
except ImportError as error:
    raise MissingExtra("dask.distributed", "study") from error

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator, Sequence

    from pacinian_lab.study.tasks import Plan, Task
    from pacinian_lab.study.worker import Row

MAX_WAIT = 30.0  # [s] longest wait for a scheduler to answer, and for a first worker
GONE = "the connection to the Dask scheduler is lost; finished tasks are kept"
AHEAD = 2  # batches per thread that are sent in advance
ONE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
QUIET: dict[str, list[str]] = {
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
}


def start(
    workers: int | None,
    scheduler: str | None,
    dashboard: Callable[[str], object] | None,
    batches: int,
) -> AbstractContextManager[Client]:
    """Start the engine, as in `pacinian_lab.study.study_run`, with at most one local process per batch."""
    if scheduler is not None:
        return remote(scheduler)
    return local(min(batches, CPU_COUNT if workers is None else workers), dashboard)


@contextmanager
def local(workers: int, dashboard: Callable[[str], object] | None = None) -> Generator[Client]:
    """Start a local scheduler with `workers` processes of one thread each, on the loopback interface only.

    Both ends of every connection must present a certificate made for this scheduler, because a scheduler executes any
    code that it receives. dashboard: called with the address of Dask's dashboard, on a loopback port. Raises
    ArgumentError.
    """
    if dashboard is not None and importlib.util.find_spec("bokeh") is None:
        raise ArgumentError("dashboard", "needs bokeh: pip install bokeh")
    with (
        tempfile.TemporaryDirectory(prefix="pacinian-study-") as scratch,
        config.set({"temporary-directory": scratch, **({} if dashboard else QUIET)}),
        warnings.catch_warnings(),
    ):
        warnings.filterwarnings("ignore", "Creating scratch directories", UserWarning)
        with (
            LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                host="tls://127.0.0.1",
                security=Security.temporary(),
                dashboard_address="127.0.0.1:0",
                scheduler_kwargs={"dashboard": dashboard is not None},
                local_directory=scratch,
                memory_limit=0,
                env=ONE,
                preload=["pacinian_lab.study.worker"],
                silence_logs=logging.CRITICAL,
            ) as cluster,
            Client(cluster) as client,
        ):
            if dashboard is not None:
                dashboard(str(client.dashboard_link))
            yield client


@contextmanager
def remote(address: str) -> Generator[Client]:
    """Connect to the scheduler at an address, such as `tcp://host:8786`. Raises ServerError."""
    try:
        client = Client(address, timeout=MAX_WAIT)
    except (OSError, ValueError) as error:
        raise ServerError(f"no Dask scheduler answers at {address}: {error}") from error
    with client:
        try:
            client.wait_for_workers(1, MAX_WAIT)
        except TimeoutError as error:
            advice = f"start one: dask worker {address}"
            raise ServerError(f"the scheduler at {address} has no workers; {advice}") from error
        _alike(client, address)
        yield client


def results(client: Client, plan: Plan, batches: Iterable[Sequence[Task]]) -> Iterator[list[Row]]:
    """Yield the rows of batches as they finish, in any order. Raises ServerError if the scheduler is lost.

    If a worker dies, another worker takes over its tasks. If that happens repeatedly, the rows report the failure.
    """
    waiting = iter(batches)
    running: dict[Future[list[Row]], Sequence[Task]] = {}
    done = as_completed()

    def send() -> None:
        try:
            threads = sum(cast("dict[str, int]", client.nthreads()).values())
        except OSError as error:
            raise ServerError(GONE) from error
        for tasks in itertools.islice(waiting, max(1, AHEAD * threads - len(running))):
            future = client.submit(measure, plan.batch(tasks), pure=False)
            running[future] = tasks
            done.add(future)

    send()
    for future in done:
        tasks = running.pop(future)
        yield _rows(future, plan, tasks)
        future.release()
        send()


def _rows(future: Future[list[Row]], plan: Plan, tasks: Sequence[Task]) -> list[Row]:
    try:
        return list(future.result())
    except CancelledError as error:
        raise ServerError(GONE) from error
    except KilledWorker:
        reason = "KilledWorker: the worker processes died repeatedly"
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
    return [make_failure(job, reason) for job in plan.batch(tasks).jobs]


def _alike(client: Client, address: str) -> None:
    """Refuse workers with another version of Pacinian, because their results would differ."""
    ours = importlib.metadata.version("pacinian")
    versions = cast("dict[str, object]", client.run(_version, on_error="return"))
    for worker, found in versions.items():
        if found != ours:
            raise ServerError(
                f"worker {worker} of {address} must have Pacinian {ours}: it reports {found!r}"
            )


def _version() -> str:
    return importlib.metadata.version("pacinian")
