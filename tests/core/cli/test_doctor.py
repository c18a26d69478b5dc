"""The doctor's findings from given facts, and its probes on this machine."""

import json
import socket
import threading
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from pacinian.cli import doctor_probes, doctor_rules
from pacinian.cli.doctor import doctor
from pacinian.cli.doctor_rules import Finding
from pacinian.wire import control

from ..client.fake_server import Fake, state

OK, WARNING, PROBLEM = "ok", "warning", "problem"


@pytest.mark.parametrize(
    ("found", "level", "says"),
    [
        (doctor_rules.check_python((3, 11, 7), "python"), OK, "3.11.7"),
        (doctor_rules.check_python((3, 10, 9), "python"), PROBLEM, "3.11 or newer"),
        (doctor_rules.check_libraries({"zmq": "27", "numpy": "2"}), OK, "zmq 27, numpy 2"),
        (
            doctor_rules.check_libraries({"zmq": None, "numpy": "2"}),
            PROBLEM,
            "missing: zmq.*pip install",
        ),
        (doctor_rules.check_extras({}), OK, "all"),
        (
            doctor_rules.check_extras({"plot": "matplotlib"}),
            OK,
            r"matplotlib.*python -m pip install.*\[plot\]",
        ),
        (doctor_rules.report_air("22 °C, 345.1 m/s"), OK, "22 °C.*pacinian serve --temperature"),
        (doctor_rules.check_encryption(True, "4.3.5"), OK, "with CURVE"),
        (doctor_rules.check_encryption(False, "4.3.5"), WARNING, "without CURVE.*pyzmq"),
        (doctor_rules.check_kernels("v3", 3), OK, "AVX2"),
        (doctor_rules.check_kernels("plain", 0), OK, "its kind"),
        (doctor_rules.check_kernels("plain", 1), WARNING, "longer"),
        (doctor_rules.check_processor(4), OK, "4 cores"),
        (doctor_rules.check_processor(1), WARNING, "two cores"),
        (doctor_rules.check_plugins(11, []), OK, "11"),
        (doctor_rules.check_plugins(11, ["plug-in 'x' does not load"]), PROBLEM, "'x'.*uninstall"),
        (doctor_rules.check_plugins(0, []), PROBLEM, "none"),
        (doctor_rules.check_loopback(""), OK, "127.0.0.1"),
        (doctor_rules.check_loopback("denied"), PROBLEM, "denied.*firewall"),
        (
            doctor_rules.check_connection_file("/c", False, ""),
            OK,
            "/c does not exist.*pacinian serve",
        ),
        (doctor_rules.check_connection_file("/c", True, "gone"), PROBLEM, "gone.*remove the file"),
        (doctor_rules.check_connection_file("/c", True, ""), OK, "/c"),
        (doctor_rules.check_server("no answer", "", ""), PROBLEM, "no answer.*log"),
        (doctor_rules.check_server("", "silent", "1.0"), OK, "silent.*--connection"),
        (
            doctor_rules.check_server("", "silent", "1.0", "not armed"),
            OK,
            "is silent: not armed; another",
        ),
        (doctor_rules.check_server("", "faulted", "1.0"), WARNING, "reset"),
        (
            doctor_rules.check_shared_memory("/dev/shm", True, 2**30, 2**25),
            OK,
            "1024 MiB free, 32 MiB",
        ),
        (doctor_rules.check_shared_memory("/dev/shm", True, 2**20, 2**25), PROBLEM, "--shm-size"),
        (doctor_rules.check_shared_memory("/tmp", False, 2**30, 2**25), PROBLEM, "TMPDIR"),
        (doctor_rules.check_clock(1e-9, [1e-4] * 200), OK, "resolution 1 ns"),
        (doctor_rules.check_clock(1e-9, [1e-4] * 195 + [0.015] * 5), WARNING, "15.00 ms"),
        (
            doctor_rules.check_clock(1e-9, [1e-4] * 199 + [0.015]),
            OK,
            "at most 0.10 ms late .99 %., 15.00 ms at worst",
        ),
        (doctor_rules.check_clock(0.015, [1e-4] * 200), PROBLEM, "better"),
        (doctor_rules.check_usb(True, "linux"), OK, "installed"),
        (doctor_rules.check_usb(False, "linux"), WARNING, "apt install"),
        (doctor_rules.check_usb(False, "freebsd"), WARNING, "libusb 1.0"),
        (doctor_rules.check_usb_permissions(5, 0), WARNING, "0 of 5.*pacinian devices udev"),
        (doctor_rules.check_usb_permissions(5, 1), OK, "1 of 5"),
        (doctor_rules.check_usb_permissions(0, 0), OK, "no USB device"),
    ],
)
def test_facts_and_what_to_do(found: Finding, level: str, says: str) -> None:
    import re

    assert found.level == level
    assert re.search(says, f"{found.text} {found.fix}", re.DOTALL)
    assert found.fix or level == OK  # each problem comes with a fix


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
    server.answers[control.Status] = lambda m: state(id=m.id, cause="not armed", why="call arm()")
    path = server.connection.write(tmp_path / "connection.json")
    assert doctor_probes.file(str(path)).level == OK
    told_of = doctor_probes.server(str(path)).text
    assert "fake" in told_of
    assert "its output is silent: call arm()" in told_of
    path.chmod(0o644)
    assert "chmod 600" in doctor_probes.file(str(path)).text
    path.chmod(0o600)
    server.close()
    code, found = told("--connection", str(path))
    assert code == 1
    assert found["server"]["level"] == PROBLEM


def test_each_extra_is_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    assert doctor_probes.extras().text == "all installed"  # as the tests need them
    absent = {"matplotlib", "starlette", "pyarrow", "pyftdi", "autd3"}
    there = doctor_probes._version
    monkeypatch.setattr(
        doctor_probes, "_version", lambda name: None if name in absent else there(name)
    )
    found = doctor_probes.extras()
    assert set(found.fix.partition("[")[2].partition("]")[0].split(",")) == set(
        doctor_probes.EXTRAS
    )
    assert "view without starlette" in found.text
    assert "devices without pyftdi" in found.text


def test_a_look_that_fails_is_a_finding(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def broken(*_: object) -> None:
        raise RuntimeError("odd machine")

    monkeypatch.setattr(doctor_probes, "processor", broken)
    monkeypatch.setattr(socket, "socket", broken)
    code, found = told("--connection", str(tmp_path / "none"))
    assert code == 1
    assert "odd machine" in found["processor"]["text"]
    assert "odd machine" in found["loopback"]["text"]


def test_a_plug_in_that_does_not_come_back_from_its_import_is_a_problem(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    come = threading.Event()
    hanging = SimpleNamespace(load=come.wait, importing="snail", offers={"one": 1}, problems={})
    monkeypatch.setattr("pacinian.plugins.registry.discover_plugins", lambda: hanging)
    monkeypatch.setattr(doctor_probes, "MAX_IMPORT_TIME", 0.01)
    try:
        found = doctor_probes.plugins()
    finally:
        come.set()
    assert (found.level, "'snail' has not been imported" in found.text) == (PROBLEM, True)
