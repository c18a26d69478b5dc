"""Divide the time of a tick into kernels and Python, by stage, and measure the wake-up before it."""

from __future__ import annotations

import functools
import math
import sys
import threading
import time
from collections import defaultdict
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct

from pacinian.gallery import SCENES, TRACKED
from pacinian.plugins import registry
from pacinian.rendering.realtime_section import realtime_section
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.tick_pacing import pace
from pacinian.solving import linalg
from pacinian_lab.solvers.timing import calibrate

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

    from pacinian.acoustics.array import Array
    from pacinian.scene.scene import Scene
    from pacinian.types import Floats

    Times = dict[str, float]  # by stage [s]

RATE = 1000.0  # of ticks and frames [Hz]
PART = 0.5  # time after which the loops take turns [s]
WARM = 0.5  # time before the first counted tick [s]
ADDITIONS = 100_000  # of the calibration loop
WHOLE_TICK = "tick"  # name of the row of all stages together
USERS = "pacinian", "pacinian_plugins"  # packages that call kernels
QUANTILES = 0.5, 0.99, 0.999


class Part(Struct, frozen=True):
    """Quantiles of a part of a tick [s]."""

    p50: float
    p99: float
    p999: float


class Row(Struct, frozen=True):
    """The parts of the ticks of a scene.

    ticks: number of them. late: fraction that ended after the next tick was due. total, kernels, python: by stage, and
    for the whole `tick`. kernels: time in compiled functions of Pacinian and in LAPACK and BLAS; python: all other
    time, NumPy's included. processor: processor time of the whole tick. The other parts include the time in which other
    programs had the core. wakeup: from when a tick was due until it began, of ticks that followed a tick in time;
    dummy: the same of a loop that only sleeps. calibration: processor time of a fixed Python loop of 100,000 additions,
    median in this run [s].
    """

    scene: str
    ticks: int
    late: float
    total: dict[str, Part]
    kernels: dict[str, Part]
    python: dict[str, Part]
    processor: Part
    wakeup: Part
    dummy: Part
    calibration: float


class KernelTimer:
    """While entered, adds up this thread's time in kernels, LAPACK and BLAS, in `spent` by the present stage [s].

    stage: returns it. A call takes 0.4 us longer, half of which is added. Only kernels that are loaded are measured.
    Calls of other threads are not counted: a tick does not wait for them.
    """

    def __init__(self, stage: Callable[[], str]) -> None:
        self.spent: Times = defaultdict(float)
        self._stage = stage
        self._before: list[tuple[ModuleType, str, Any]] = []

    def __enter__(self) -> KernelTimer:
        groups = _list_kernels()
        timed = {
            id(kernel): self._time(kernel)
            for group in groups
            for kernel in vars(group).values()
            if callable(kernel) and not isinstance(kernel, type)
        }
        users = [m for name, m in sys.modules.items() if name.partition(".")[0] in USERS]
        for module in {id(module): module for module in (*groups, *users)}.values():
            for name, value in list(vars(module).items()):
                if id(value) in timed:  # also where a module has imported it by name
                    self._before.append((module, name, value))
                    setattr(module, name, timed[id(value)])
        return self

    def __exit__(self, *_: object) -> None:
        for module, name, kernel in self._before:
            setattr(module, name, kernel)
        self._before.clear()

    def _time(self, kernel: Callable[..., Any]) -> Callable[..., Any]:
        spent, stage, now = self.spent, self._stage, time.perf_counter
        thread = threading.get_ident()

        def call(*given: Any, **named: Any) -> Any:
            if threading.get_ident() != thread:
                return kernel(*given, **named)
            begin = now()
            try:
                return kernel(*given, **named)
            finally:
                spent[stage()] += now() - begin

        return call


def _list_kernels() -> list[ModuleType]:
    """Return the loaded groups of kernels of Pacinian and its plug-ins, and LAPACK and BLAS."""
    found = [
        module
        for name, module in list(sys.modules.items())
        if ".native." in name and not name.rpartition(".")[2].startswith("_")
    ]
    return [*found, linalg.blas, linalg.lapack]


def measure(array: Array, name: str, seconds: float) -> Row:
    """Tick a built-in scene for `seconds` [s], in turn with a loop that only sleeps and with the calibration loop.

    Solves run in the ticks, even if these are then late. Late ticks are skipped, as in the server. Raises KeyError, and
    the error of a failed tick.
    """

    @functools.cache
    def update(k: int) -> Scene:
        return SCENES[name]((k + 0.5) / TRACKED)

    for k in range(math.ceil((2.0 * seconds + WARM + 1.0) * TRACKED)):
        update(k)
    device = registry.backend("simulated", rate=RATE, keep=1)
    with Renderer(array, lambda t: update(int(t * TRACKED)), backend=device, rate=RATE) as renderer:
        renderer.schedule.period = math.inf  # no tick is long, so that all of them solve
        loop = _Loop(renderer)
        with realtime_section():
            loop.run(WARM)
            with KernelTimer(lambda: renderer.stage) as timer:
                loop.forget(timer.spent)
                while loop.passed < seconds:
                    loop.run(PART)
                    loop.sleep(PART)
                    loop.calibrations.append(calibrate(ADDITIONS))
    for fault in renderer.report.faults:
        raise fault.cause
    return loop.row(name)


class _Loop:
    """Ticks a renderer, and keeps the time of every stage."""

    def __init__(self, renderer: Renderer) -> None:
        self._renderer = renderer
        self.forget(defaultdict(float))

    def forget(self, spent: Times) -> None:
        """Begin again. spent: the time in kernels by stage, which grows [s]."""
        self.passed, self.late, self._spent = 0.0, 0, spent
        self.calibrations: list[float] = []
        self._total: list[Times] = []
        self._kernels: list[Times] = []
        self._processor: list[float] = []
        self._wakeup: list[float] = []
        self._dummy: list[float] = []

    def run(self, seconds: float) -> None:
        """Tick for `seconds` [s]."""
        renderer, clock, ended = self._renderer, self._renderer.clock, -math.inf
        stages, spent = dict(renderer.report.stages), dict(self._spent)
        for due, lost in pace(clock, renderer.period, seconds, max_lag=0.0):
            if ended < due:
                self._wakeup.append(clock.now() - due)
            begin = time.thread_time()
            renderer.tick(due, lost)
            self._processor.append(time.thread_time() - begin)
            ended = clock.now()
            self.late += ended > due + renderer.period
            before, stages = stages, dict(renderer.report.stages)
            self._total.append({name: stages[name] - before.get(name, 0.0) for name in stages})
            before, spent = spent, dict(self._spent)
            self._kernels.append({name: spent[name] - before.get(name, 0.0) for name in spent})
        self.passed += seconds

    def sleep(self, seconds: float) -> None:
        """Wake up at the same rate, and do nothing."""
        clock = self._renderer.clock
        for due, lost in pace(clock, self._renderer.period, seconds, max_lag=0.0):
            if not lost:
                self._dummy.append(clock.now() - due)

    def row(self, name: str) -> Row:
        """Return the results."""
        total, kernels = _gather(self._total), _gather(self._kernels)
        nothing = np.zeros(len(self._total))
        python = {stage: total[stage] - kernels.get(stage, nothing) for stage in total}
        return Row(
            scene=name,
            ticks=len(self._total),
            late=self.late / len(self._total),
            total={stage: _part(each) for stage, each in total.items()},
            kernels={stage: _part(kernels.get(stage, nothing)) for stage in total},
            python={stage: _part(each) for stage, each in python.items()},
            processor=_part(np.array(self._processor)),
            wakeup=_part(np.array(self._wakeup)),
            dummy=_part(np.array(self._dummy)),
            calibration=median(self.calibrations),
        )


def _gather(ticks: list[Times]) -> dict[str, Floats]:
    """Return the times of each stage, and of all together, (T,) [s]."""
    stages = sorted({stage for tick in ticks for stage in tick})
    found = {stage: np.array([tick.get(stage, 0.0) for tick in ticks]) for stage in stages}
    return {WHOLE_TICK: sum(found.values(), np.zeros(len(ticks))), **found}


def _part(times: Floats) -> Part:
    if not len(times):
        return Part(math.nan, math.nan, math.nan)
    return Part(*np.quantile(times, QUANTILES, method="inverted_cdf").tolist())
