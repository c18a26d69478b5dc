"""Sample and solve in a thread of its own, while the loop sends frames on time."""

from __future__ import annotations

import queue
import threading
import weakref
from concurrent.futures import Future, wait
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from pacinian.solving.blas import limit_blas_threads

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")
MAX_CLOSING = 2.0  # longest wait for a job that still runs when its renderer is closed [s]


def start_daemon(work: Callable[[], object], name: str) -> None:
    """Run `work` in a new thread, which does not keep the process from ending."""
    threading.Thread(target=work, name=name, daemon=True).start()


class BackgroundSolve(Generic[T]):
    """Runs one job at a time in a thread, which begins with the first job, and ends with this object or the process.

    start_thread: runs a function in a new thread of the given name. deferred: whether there is no thread, and a job
    runs when its result is taken; so it is when a recording is rendered again.
    """

    def __init__(
        self, start_thread: Callable[[Callable[[], object], str], None] = start_daemon
    ) -> None:
        self.deferred = False
        self._start_thread = start_thread
        self._job: tuple[Callable[[], T], Future[T]] | None = None
        self._jobs: queue.SimpleQueue[tuple[Callable[[], T], Future[T]] | None] | None = None
        self._last: list[Future[T]] = []  # of the job that was started last

    @property
    def running(self) -> bool:
        """Whether a job was started whose result is not taken yet."""
        return self._job is not None

    @property
    def done(self) -> bool:
        """Whether `take` returns at once."""
        return self._job is not None and self._job[1].done()

    def start(self, job: Callable[[], T]) -> None:
        """Start a job. The result of the last one must have been taken."""
        new: tuple[Callable[[], T], Future[T]] = job, Future()
        if not self.deferred:
            if self._jobs is None:
                jobs: queue.SimpleQueue[Any] = queue.SimpleQueue()
                self._end = weakref.finalize(self, _end_thread, jobs, self._last)
                self._start_thread(lambda: _run_jobs(jobs), "solve")  # may be interrupted
                self._jobs = jobs
            self._last[:] = [new[1]]
            self._jobs.put(new)
        self._job = new

    def take(self) -> T:
        """Wait for the job that runs, and return its result, or raise its exception."""
        assert self._job is not None
        job, future = self._job
        if not (self.deferred or future.done()):
            wait([future])  # an interruption leaves it running
        self._job = None
        return job() if self.deferred else future.result()

    def drop(self) -> None:
        """Wait for the job that runs, if any, and ignore its result. A deferred job is not run."""
        if self._job is not None and not self.deferred:
            wait([self._job[1]])
        self._job = None

    def close(self) -> None:
        """End the thread after the job that runs, if any. Wait for this job, but not longer than MAX_CLOSING."""
        if self._jobs is None:
            return
        self._end()
        self._jobs = None
        if self._job is not None and self._job[1].done():
            self._job = None


def _end_thread(jobs: queue.SimpleQueue[Any], last: list[Future[Any]]) -> None:
    """End a thread, and wait for its last job, because a thread in a kernel must not outlive the interpreter."""
    jobs.put(None)
    wait(last, MAX_CLOSING)


def _run_jobs(jobs: queue.SimpleQueue[tuple[Callable[[], T], Future[T]] | None]) -> None:
    while (job := jobs.get()) is not None:
        work, future = job
        try:
            with limit_blas_threads():  # as in the ticks, so that the frames are the same
                future.set_result(work())
        except BaseException as error:  # a plug-in can raise anything; the loop raises it again
            future.set_exception(error)
        del job, work, future  # because they hold the renderer
