"""Metrics for Prometheus on 127.0.0.1, computed from the newest state at each request."""

from __future__ import annotations

import threading
from socketserver import ThreadingMixIn
from typing import TYPE_CHECKING, Any
from wsgiref.simple_server import WSGIRequestHandler, WSGIServer, make_server

from prometheus_client import CollectorRegistry, make_wsgi_app
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.registry import Collector

from pacinian.errors import ServerError
from pacinian.serving.settings import METRICS_HOST
from pacinian.wire.state import OUTPUTS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from prometheus_client import Metric

    from pacinian.serving.ipc.messages import BusStatus
    from pacinian.wire.state import State

MAX_CONNECTIONS = 16  # largest number of connections at a time; each takes a thread
MAX_REQUEST_TIME = 5.0  # time limit between two parts of a request [s]


class Metrics(Collector):
    """A collector that serves the metrics while entered.

    newest: returns the state (None before the first), the server's own counts by name, and the bus status. Raises
    ServerError if the port cannot be opened.
    """

    def __init__(
        self, port: int, newest: Callable[[], tuple[State | None, Mapping[str, int], BusStatus]]
    ) -> None:
        self._port, self._newest = port, newest

    def __enter__(self) -> Metrics:
        registry = CollectorRegistry()
        registry.register(self)
        try:
            self._server = make_server(
                METRICS_HOST, self._port, make_wsgi_app(registry), _Server, _Handler
            )
        except OSError as error:
            raise ServerError(
                f"metrics on {METRICS_HOST}:{self._port}: {error.strerror}"
            ) from error
        self._thread = threading.Thread(
            target=self._server.serve_forever, name="metrics", daemon=True
        )
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def collect(self) -> Iterator[Metric]:
        """Yield the current metrics."""
        state, counts, bus = self._newest()
        for name, value in counts.items():
            yield _make_counter(f"control_{name}", f"Control socket: {name}", value)
        yield _make_counter("bus_received", "Commands received", bus.received)
        yield _make_counter("bus_superseded", "Commands that newer ones superseded", bus.superseded)
        yield _make_counter("bus_refused", "Commands refused", bus.refused)
        yield _make_gauge("bus_waiting", "Changes that the renderer has not taken yet", bus.waiting)
        if state is None:
            return
        yield _make_counter("ticks", "Ticks of the loop", state.ticks)
        yield _make_counter("late_ticks", "Ticks that were late", state.late)
        yield _make_counter("frames", "Frames that the device took", state.frames)
        yield _make_counter("faults", "Faults", state.fault_count)
        yield _make_gauge("armed", "Whether a client has armed the output", state.armed)
        yield _make_gauge("tick_rate_hertz", "Ticks per second", state.rate)
        yield _make_gauge(
            "error_ratio", "Error of the sound pressures at the samples, as emitted", state.error
        )
        yield _make_gauge(
            "longest_gap_seconds", "Longest time between frames while armed", state.longest_gap
        )
        yield _make_gauge("clients", "Sessions", len(state.clients))
        yield _make_gauge_family(
            "output",
            "State of the output",
            "state",
            {name: name == state.output for name in OUTPUTS},
        )
        quantiles = {
            str(q): ms / 1e3 for q, ms in zip((0.5, 0.99, 1.0), state.tick_ms, strict=True)
        }
        yield _make_gauge_family(
            "tick_seconds", "Duration of a tick in the last second", "quantile", quantiles
        )
        restarts = CounterMetricFamily(
            "pacinian_restarts", "Restarts of a process", labels=["process"]
        )
        for name, value in state.restarts.items():
            restarts.add_metric([name], value)
        yield restarts
        skipped = CounterMetricFamily("pacinian_skipped", "Samples not rendered", labels=["reason"])
        for name, value in state.skipped.items():
            skipped.add_metric([name], value)
        yield skipped


class _Server(ThreadingMixIn, WSGIServer):
    """Answers a few connections at a time, each in a thread, and closes those beyond."""

    daemon_threads = True

    def __init__(self, *given: Any) -> None:
        self._places = threading.BoundedSemaphore(MAX_CONNECTIONS)
        super().__init__(*given)

    def process_request(self, request: Any, client_address: Any) -> None:
        """Start a thread for a connection."""
        if not self._places.acquire(blocking=False):
            self.shutdown_request(request)
            return
        try:
            super().process_request(request, client_address)
        except BaseException:
            self._places.release()
            raise

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer a connection."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._places.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore connections that are late or broken, and threads that the system does not permit."""


class _Handler(WSGIRequestHandler):
    timeout = MAX_REQUEST_TIME

    def log_message(self, format: str, *_: Any) -> None:  # noqa: A002  # the name in the base class
        """Log nothing: a stranger could fill the log."""


def _make_counter(name: str, text: str, value: float) -> Metric:
    return CounterMetricFamily(f"pacinian_{name}", text, value=value)


def _make_gauge(name: str, text: str, value: float) -> Metric:
    return GaugeMetricFamily(f"pacinian_{name}", text, value=value)


def _make_gauge_family(name: str, text: str, label: str, values: Mapping[str, Any]) -> Metric:
    family = GaugeMetricFamily(f"pacinian_{name}", text, labels=[label])
    for key, value in values.items():
        family.add_metric([key], float(value))
    return family
