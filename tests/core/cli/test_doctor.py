"""What the doctor makes of facts, and what it sees here."""

import json
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from pacinian.cli import examining, findings
from pacinian.cli.doctor import doctor
from pacinian.cli.findings import Finding

from ..client.fake import Fake

OK, WARNING, PROBLEM = "ok", "warning", "problem"


@pytest.mark.parametrize(
    ("found", "level", "says"),
    [
        (findings.python((3, 11, 7), "python"), OK, "3.11.7"),
        (findings.python((3, 10, 9), "python"), PROBLEM, "3.11 or newer"),
        (findings.libraries({"zmq": "27", "numpy": "2"}), OK, "zmq 27, numpy 2"),
        (findings.libraries({"zmq": None, "numpy": "2"}), PROBLEM, "missing: zmq.*pip install"),
        (findings.extras({}), OK, "all"),
        (findings.extras({"plot": "matplotlib"}), OK, r"matplotlib.*pacinian\[plot\]"),
        (findings.air("22 °C, 345.1 m/s"), OK, "22 °C.*pacinian serve --temperature"),
        (findings.curve(True, "4.3.5"), OK, "with CURVE"),
        (findings.curve(False, "4.3.5"), WARNING, "without CURVE.*pyzmq"),
        (findings.kernels("v3", 3), OK, "AVX2"),
        (findings.kernels("plain", 0), OK, "its kind"),
        (findings.kernels("plain", 1), WARNING, "longer"),
        (findings.processor(4), OK, "4 cores"),
        (findings.processor(1), WARNING, "two cores"),
        (findings.plugins(11, []), OK, "11"),
        (findings.plugins(11, ["plug-in 'x' does not load"]), PROBLEM, "'x'.*uninstall"),
        (findings.plugins(0, []), PROBLEM, "none"),
        (findings.port(""), OK, "127.0.0.1"),
        (findings.port("denied"), PROBLEM, "denied.*firewall"),
        (findings.connection("/c", False, ""), OK, "/c is not there.*pacinian serve"),
        (findings.connection("/c", True, "gone"), PROBLEM, "gone.*remove the file"),
        (findings.connection("/c", True, ""), OK, "/c"),
        (findings.server("no answer", "", ""), PROBLEM, "no answer.*log"),
        (findings.server("", "silent", "1.0"), OK, "silent.*--connection"),
        (findings.server("", "faulted", "1.0"), WARNING, "reset"),
        (findings.memory("/dev/shm", True, 2**30, 2**25), OK, "1024 MiB free, 32 MiB"),
        (findings.memory("/dev/shm", True, 2**20, 2**25), PROBLEM, "--shm-size"),
        (findings.memory("/tmp", False, 2**30, 2**25), PROBLEM, "TMPDIR"),
        (findings.clock(1e-9, [1e-4] * 200), OK, "resolution 1 ns"),
        (findings.clock(1e-9, [1e-4] * 195 + [0.015] * 5), WARNING, "15.00 ms"),
        (findings.clock(1e-9, [1e-4] * 199 + [0.015]), OK, "15.00 ms at most"),
        (findings.clock(0.015, [1e-4] * 200), PROBLEM, "better"),
        (findings.usb(True, "linux"), OK, "found"),
        (findings.usb(False, "linux"), WARNING, "apt install"),
        (findings.usb(False, "freebsd"), WARNING, "libusb 1.0"),
        (findings.permissions(5, 0), WARNING, "0 of 5.*pacinian devices udev"),
        (findings.permissions(5, 1), OK, "1 of 5"),
        (findings.permissions(0, 0), OK, "0 of 0"),
    ],
)
def test_facts_and_what_to_do(found: Finding, level: str, says: str) -> None:
    import re

    assert found.level == level
    assert re.search(says, f"{found.told} {found.fix}", re.DOTALL)
    assert found.fix or level == OK  # whatever is wrong comes with a way to mend it


@pytest.fixture
def server() -> Iterator[Fake]:
    with Fake() as fake:
        yield fake


def told(*arguments: str) -> tuple[int, dict[str, dict[str, str]]]:
    result = CliRunner().invoke(doctor, [*arguments, "--json"])
    found = json.loads(result.stdout)["findings"]
    return result.exit_code, {f["name"]: f for f in found}


def test_here_all_that_is_needed_is_there(tmp_path: Path) -> None:
    code, found = told("--connection", str(tmp_path / "none"))
    for name in ("Python", "libraries", "ZeroMQ", "processor", "plug-ins", "loopback", "clock"):
        assert found[name]["level"] != PROBLEM, found[name]
    assert "server" not in found
    assert code == any(f["level"] == PROBLEM for f in found.values())
    lines = CliRunner().invoke(doctor, ["--connection", str(tmp_path / "none")]).stdout
    assert "Python: " in lines


def test_it_sees_a_server_and_why_one_does_not_answer(server: Fake, tmp_path: Path) -> None:
    path = server.connection.write(tmp_path / "connection.json")
    assert examining.file(str(path)).level == OK
    assert "fake" in examining.server(str(path)).told
    path.chmod(0o644)
    assert "chmod 600" in examining.file(str(path)).told
    path.chmod(0o600)
    server.close()
    code, found = told("--connection", str(path))
    assert code == 1
    assert found["server"]["level"] == PROBLEM


def test_each_extra_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    assert examining.extras().told == "all installed"  # as the tests need them
    absent = {"matplotlib", "starlette", "pyarrow", "pyftdi", "autd3"}
    there = examining._version
    monkeypatch.setattr(examining, "_version", lambda name: None if name in absent else there(name))
    found = examining.extras()
    assert set(found.fix.partition("[")[2].partition("]")[0].split(",")) == set(examining.EXTRAS)
    assert "view without starlette" in found.told
    assert "devices without pyftdi" in found.told


def test_a_look_that_fails_is_a_finding(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def broken(*_: object) -> None:
        raise RuntimeError("odd machine")

    monkeypatch.setattr(examining, "processor", broken)
    monkeypatch.setattr(socket, "socket", broken)
    code, found = told("--connection", str(tmp_path / "none"))
    assert code == 1
    assert "odd machine" in found["processor"]["told"]
    assert "odd machine" in found["loopback"]["told"]
