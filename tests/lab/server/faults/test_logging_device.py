from __future__ import annotations

import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import numpy as np
import pytest

import pacinian as pc
from pacinian_lab.server.faults import logging_device, plugins
from pacinian_lab.server.faults.logging_device import UNPLUGGED, Log, Probe

if TYPE_CHECKING:
    from pathlib import Path


def frame(amplitude: int) -> pc.Frame:
    levels = np.full((1, 4), amplitude, np.uint16)
    return pc.Frame(1, 0.0, np.zeros_like(levels), levels)


@pytest.fixture
def probe(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Probe:
    monkeypatch.setenv(logging_device.FOLDER, str(tmp_path))
    made = Probe()
    made.open(pc.autd(1, 1))
    return made


def test_the_log_keeps_frames_that_sound_and_ends_of_sound(probe: Probe, tmp_path: Path) -> None:
    for amplitude in (0, 5, 5, 0, 0, 7):
        probe.send(frame(amplitude))
    probe.silence()
    probe.close()
    with Log(tmp_path / Probe.name) as log:
        events = log.read()
    assert events["sounds"].tolist() == [0, 1, 1, 0, 1, 0]
    assert (np.diff(events["time"]) >= 0.0).all()


def test_the_newest_events_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(logging_device, "MAX_EVENTS", 8)
    with Log(tmp_path / "log") as log:
        for n in range(20):
            log.write(n % 3 == 0)
        assert log.count == 20
        assert log.read()["sounds"].tolist() == [n % 3 == 0 for n in range(13, 20)]
        assert log.read(18)["sounds"].tolist() == [True, False]
        assert not len(log.read(20))


def test_the_log_outlives_its_process(tmp_path: Path) -> None:
    code = (
        "import os, signal, sys; from pathlib import Path\n"
        "from pacinian_lab.server.faults.logging_device import Log\n"
        "log = Log(Path(sys.argv[1])); log.write(True)\n"
        "os.kill(os.getpid(), signal.SIGKILL)"
    )
    path = tmp_path / "log"
    done = subprocess.run([sys.executable, "-c", code, str(path)], check=False)
    assert done.returncode == -signal.SIGKILL
    with Log(path) as log:
        assert log.read()["sounds"].tolist() == [1]


def test_who_reads_while_another_process_writes_sees_each_count_whole(tmp_path: Path) -> None:
    """A count of which only some bytes were written would be less than one before."""
    code = (
        "import sys; from pathlib import Path\n"
        "from pacinian_lab.server.faults.logging_device import Log\n"
        "log = Log(Path(sys.argv[1]))\n"
        "for _ in range(200_000): log.write(True)"
    )
    path = tmp_path / "log"
    with Log(path) as log, subprocess.Popen([sys.executable, "-c", code, str(path)]) as writer:
        last = 0
        while writer.poll() is None:
            for _ in range(1000):
                count = log.count
                assert count >= last
                last = count
        assert log.count == 200_000


def test_unplugged_it_refuses_and_is_silent(probe: Probe, tmp_path: Path) -> None:
    probe.send(frame(5))
    (tmp_path / UNPLUGGED).touch()
    with pytest.raises(pc.BackendError, match="unplugged"):
        probe.send(frame(5))
    with pytest.raises(pc.BackendError, match="unplugged"):
        probe.open(pc.autd(1, 1))
    with Log(tmp_path / Probe.name) as log:
        assert log.read()["sounds"].tolist() == [0, 1, 0]
    (tmp_path / UNPLUGGED).unlink()
    probe.send(frame(5))
    probe.close()


def test_the_plug_ins_are_found_by_another_process(tmp_path: Path) -> None:
    environment = plugins.install(tmp_path)
    assert environment[logging_device.FOLDER] == str(tmp_path)
    assert logging_device.FOLDER not in os.environ
    code = (
        "import pacinian as pc\n"
        "for name in ('probe', 'probe-other'): assert pc.backend(name).name == name\n"
        "assert pc.solver('stuck', hold=True).hold"
    )
    subprocess.run([sys.executable, "-c", code], env=environment, check=True)
