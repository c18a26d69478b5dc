"""Observe how a server takes a flood: its output, memory and answers. Starts the flooding processes."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import psutil

from pacinian_lab.server.faults.misbehaving_client import Silent

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pacinian.types import Floats
    from pacinian_lab.server.faults.rig import Rig

REQUEST_INTERVAL = 0.05  # [s] between two requests
ANSWER = 5.0  # [s] longest wait for an answer
TICK = 1e-3  # [s]


@dataclass
class Phase:
    """Observations while some processes sent, or none.

    gaps: between two frames [s]. answers: response times of `status` [s]. silences: how often the sound ended.
    """

    name: str
    seconds: float = 0.0
    sent: Counter[str] = field(default_factory=Counter)
    codes: Counter[str] = field(default_factory=Counter)
    failed: int = 0
    gaps: list[Floats] = field(default_factory=list)
    answers: list[float] = field(default_factory=list)
    silences: int = 0
    lost: int = 0
    """Requests without an answer."""

    @property
    def gap(self) -> Floats:
        """All gaps [s]."""
        return np.concatenate(self.gaps) if self.gaps else np.zeros(0)

    @property
    def over(self) -> int:
        """Number of gaps more than one tick longer than the regular one."""
        return int((self.gap > 2.0 * TICK).sum())

    @property
    def often(self) -> float:
        """Silences per second."""
        return self.silences / max(self.seconds, 1e-9)

    def worst(self) -> float:
        """Return the longest gap [s]."""
        return float(self.gap.max(initial=0.0))


class Watch:
    """Observes a `Rig` with a game that sounds. memory: of each process [bytes], at each reading."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.parts = {**rig.server.parts(), "control": psutil.Process(rig.server.process.pid)}
        self.memory: dict[str, list[int]] = {name: [] for name in self.parts}

    def phase(
        self, phase: Phase, messages: Mapping[str, int], seed: int, seconds: float, times: int = 1
    ) -> None:
        """Let processes of each kind send `messages`, and observe until they end.

        seconds: time after which they end anyway. times: number of processes of each kind.
        """
        self.rig.wait_for_sound()
        onlooker = self.rig.onlooker
        mark, start = self.rig.server.log.count, time.perf_counter()
        kinds = list(messages) * times
        floods = [self._flood(k, seed + n, messages[k], seconds) for n, k in enumerate(kinds)]
        until = start + seconds if not floods else start + 10.0 * seconds + 60.0
        try:
            while time.perf_counter() < until and (
                not floods or any(flood.poll() is None for flood in floods)
            ):
                asked = time.perf_counter()
                try:
                    onlooker.ask("status", ANSWER)
                    phase.answers.append(time.perf_counter() - asked)
                except Silent:
                    phase.lost += 1
                self._look()
                time.sleep(REQUEST_INTERVAL)
            events = self.rig.server.log.read(mark)
            phase.seconds += time.perf_counter() - start
            for flood in floods:
                self._count(phase, flood)
        finally:
            for flood in floods:
                flood.kill()
                flood.wait()
                if flood.stdout is not None:
                    flood.stdout.close()
        phase.gaps.append(np.diff(events["time"]))
        phase.silences += int((events["sounds"] == 0).sum())

    def _flood(self, kind: str, seed: int, messages: int, seconds: float) -> subprocess.Popen[str]:
        arguments = (self.rig.server.file, kind, seed, messages, seconds)
        command = [sys.executable, "-m", "pacinian_lab.server.fuzz.flood", *map(str, arguments)]
        return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)

    @staticmethod
    def _count(phase: Phase, flood: subprocess.Popen[str]) -> None:
        result = json.loads(flood.communicate()[0])
        phase.sent.update(result["sent"])
        phase.codes.update(result["codes"])
        phase.failed += result["failed"]

    def _look(self) -> None:
        for name, process in self.parts.items():
            with contextlib.suppress(psutil.NoSuchProcess):  # reported by `same`
                self.memory[name].append(process.memory_info().rss)

    @property
    def same(self) -> bool:
        """Whether all processes are those from the beginning."""
        now = {name: process.pid for name, process in self.rig.server.parts().items()}
        return all(now.get(n, p.pid) == p.pid and p.is_running() for n, p in self.parts.items())

    def growth(self) -> dict[str, float]:
        """Return the growth of each process's memory from the second to the last quarter [bytes]."""
        found: dict[str, float] = {}
        for name, values in self.memory.items():
            quarter = max(1, len(values) // 4)
            early, late = values[quarter : 2 * quarter] or values, values[-quarter:]
            found[name] = float(np.median(late) - np.median(early))
        return found
