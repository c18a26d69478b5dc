"""The commands, run as processes and through click."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, cast

import click
import jsonschema
import msgpack
import numpy as np
import pytest
from click.testing import CliRunner

import pacinian as pc
from pacinian.cli.console import UNSEEN_WIDTH, make_console
from pacinian.cli.main import GROUPS, cli, main
from pacinian.cli.run_verdict import describe_success, judge_pace
from pacinian.cli.standard_input import call_at_end_of_input
from pacinian.rendering import renderer
from pacinian.testing import ManualClock

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.plugins.hookspecs import CommandGroup

LIMIT = 200.0  # ends a test that hangs [s]
EXAMPLE = Path(__file__).parents[3] / "examples" / "ball.toml"
SCRIPT: str = tomllib.loads((EXAMPLE.parents[1] / "pyproject.toml").read_text("utf-8"))["project"][
    "scripts"
]["pacinian"]
# as in the script that pip installs
ENTRY_POINT = "import sys; from {0} import {1}; sys.exit({1}())".format(*SCRIPT.split(":"))


@pytest.fixture(autouse=True)
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Use clocks for this process's renderers by which ticks take no time, so that none is missed."""
    monkeypatch.setattr(renderer, "SystemClock", ManualClock)


def run(*arguments: str) -> Any:
    return CliRunner().invoke(cli, list(arguments))


def told(*arguments: str, code: int = 0) -> Any:
    """Return the JSON object on standard output."""
    result = run(*arguments, "--json")
    assert result.exit_code == code, result.output
    return json.loads(result.stdout)


def ended(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    """Return the exit code of the command."""
    monkeypatch.setattr(sys, "argv", ["pacinian", *arguments])
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    with pytest.raises(SystemExit) as end:
        main()
    return int(str(end.value.code))


def test_demo_tells_one_json_object(tmp_path: Path) -> None:
    picture = tmp_path / "demo.png"
    seen = told("demo", "--seconds", "0.1", "--dummy", "--out", str(picture))
    assert seen["ticks"] == seen["dummy"]["ticks"] == 100
    assert seen["transducers"] == 2241
    assert seen["samples"] > 100  # a region
    assert seen["error_at_samples"] < 0.05  # at the samples of a region that moves
    assert seen["fault_count"] == 0
    assert {"late_ticks", "tick_p50_ms", "tick_p99_ms", "others_share"} <= seen.keys()
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_demo_without_json_is_a_table_and_a_bar() -> None:
    result = run("demo", "--seconds", "0.1", "--out", "", "--units", "1")
    assert result.exit_code == 0
    for word in ("ticks", "late", "p99", "error at samples"):
        assert word in result.stdout


def test_demo_says_at_once_what_it_does_and_at_the_end_where_the_picture_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run("demo", "--seconds", "0.1", "--units", "1", "--out", "it.png")
    assert result.exit_code == 0
    assert result.stderr.startswith("A ball circles a button above one simulated AUTD unit")
    assert "drawing the picture" in result.stderr
    assert result.stdout.splitlines()[-1] == f"Picture: {tmp_path / 'it.png'}"
    assert result.stdout.startswith("It works")
    assert "100% of the 100 planned ticks were on time." in result.stdout


def paced(**given: Any) -> dict[str, Any]:
    """A summary of 1000 planned ticks at 1 kHz."""
    figures = {
        "ticks": 1000,
        "late_ticks": 0,
        "skipped": {},
        "tick_p50_ms": 0.2,
        "tick_p99_ms": 1.4,
        "rate": 1000.0,
        "statuses": {"ok": 50, "deadline": 4},
    }
    return {**figures, "others_share": 0.0, **given}


@pytest.mark.parametrize(
    ("told", "says", "not_says"),
    [
        (paced(late_ticks=40), "96% of the 1,000 planned ticks were on time.$", "Only|close|slow"),
        (paced(late_ticks=60), "^94% of the 1,000.*A tick has 1 ms; the median took 0.2 ms, the slowest 1% .*buy",
         "close|too slow|Only"),
        (paced(late_ticks=60, tick_p99_ms=0.4), "took 0.2 ms.* took 0.4 ms or more. Many began late", "too slow"),
        (paced(ticks=100, late_ticks=90, skipped={"missed ticks": 900}, tick_p50_ms=9.0, tick_p99_ms=12.0),
         "^1% of the 1,000.*has 1 ms.*9.0 ms.*too slow.*buy a faster one", "close|began late"),
        (paced(late_ticks=900, others_share=0.75),
         "^10%.*programs took 75% of the processors: close them, or buy", "too slow"),
        (paced(late_ticks=900, tick_p50_ms=8.0, others_share=None), "too slow", "programs"),
        (paced(statuses={"ok": 10, "deadline": 90}), "on time. 90 of 100 solves ran out of time", "Only"),
        (paced(ticks=0), "^$", "on time"),
    ],
)  # fmt: skip
def test_late_ticks_are_explained_in_words(told: dict[str, Any], says: str, not_says: str) -> None:
    text = judge_pace(told, "buy a faster one")
    assert re.search(says, text)
    assert not re.search(not_says, text)


@pytest.mark.parametrize(
    ("told", "says"),
    [
        (paced(late_ticks=40), "It works."),
        (paced(late_ticks=160), "It works; this machine was too slow for 16% of the ticks."),
        (paced(ticks=100, skipped={"missed ticks": 900}), "It works; this machine was too slow for 90% of the ticks."),
        (paced(late_ticks=1000), ""),
        (paced(fault_count=1), ""),
        (paced(interrupted=True), ""),
        (paced(ticks=0), ""),
    ],
)  # fmt: skip
def test_demo_says_first_whether_it_worked(told: dict[str, Any], says: str) -> None:
    assert describe_success({"fault_count": 0, "interrupted": False, **told}) == says


def test_tables_in_a_pipe_are_as_wide_as_columns_says(monkeypatch: pytest.MonkeyPatch) -> None:
    for columns, width in (("70", 70), ("", UNSEEN_WIDTH), ("wide", UNSEEN_WIDTH)):
        monkeypatch.setenv("COLUMNS", columns)
        assert make_console().width == width


def test_render_takes_a_file_and_draws_and_records(tmp_path: Path) -> None:
    record, picture = tmp_path / "run.pac", tmp_path / "deep" / "run.png"
    seen = told(
        "render", str(EXAMPLE), "--seconds", "0.1", "--record", str(record), "--out", str(picture)
    )
    assert (seen["ticks"], sum(seen["statuses"].values())) == (100, seen["solves"])
    assert seen["statuses"].keys() <= {"silent", "ok", "limited", "deadline"}
    assert picture.exists()
    assert told("replay", str(record))["frames"] == 100
    said = "100 frames of 2241 transducers played on simulated"
    assert said in run("replay", str(record)).stdout
    again = told("rerender", str(record))
    assert again == {
        "recording": str(record), "ticks": 100, "different": 0,
        "environment": [], "array": [], "objects": {},
    }  # fmt: skip
    assert "100 ticks rendered again, 0 frames differ" in run("rerender", str(record)).stdout
    record.write_bytes(record.read_bytes()[:200])
    for command in ("replay", "rerender"):
        assert isinstance(run(command, str(record)).exception, pc.RecordingError)


def test_strict_ends_with_1_unless_all_was_as_asked(tmp_path: Path) -> None:
    record, scene = tmp_path / "run.pac", tmp_path / "scene.toml"
    text = '[array]\ntype = "lattice"\nwidth = 0.05\nheight = 0.05\n[sampling]\nbudget = {}\n'
    text += '[[objects]]\ntype = "surface"\nname = "plate"\nradiation_pressure = 0.01\n'
    text += 'shape = {{ type = "disc", radius = 0.01 }}\npose = {{ position = [0.0, 0.0, 0.1] }}\n'
    scene.write_text(text.format(256))
    options = "render", str(scene), "--seconds", "0.05", "--strict"
    assert told(*options, "--record", str(record))["as_asked"]
    played = run("replay", str(record), "--strict", "--json")
    assert played.exit_code == (json.loads(played.stdout)["late"] > 0)
    scene.write_text(text.format(5))
    refused = run(*options).exception
    assert isinstance(refused, pc.ArgumentError)
    assert "'plate' needs" in str(refused)
    coarse = told("render", str(scene), "--seconds", "0.05")
    assert coarse["deviations"]["plate"]["coarsened"]["ticks"] == 50
    assert "not as asked: plate" in run("render", str(scene), "--seconds", "0.05").stdout


def test_rerender_ends_with_1_where_a_frame_differs(tmp_path: Path) -> None:
    record = tmp_path / "run.pac"
    ticks = told("render", str(EXAMPLE), "--seconds", "0.05", "--record", str(record))["ticks"]
    unpacker = msgpack.Unpacker(strict_map_key=False)
    unpacker.feed(record.read_bytes())
    maps = list(unpacker)
    last = [values for values in maps if "phase" in values][-1]
    last["phase"] = bytes(len(last["phase"]))
    record.write_bytes(b"".join(map(msgpack.packb, maps)))
    seen = told("rerender", str(record), code=1)
    assert seen["ticks"] == ticks
    assert seen["different"] >= 1


def test_replay_drives_the_array_as_it_was(tmp_path: Path, monkeypatch: Any) -> None:
    """The transducers have different strengths, and some are dead."""
    from pacinian.plugins import registry

    rng, made = np.random.default_rng(3), []
    sizes = rng.uniform(0.5, 1.5, 35) * np.exp(1j * rng.uniform(-1.0, 1.0, 35))
    places = pc.lattice(0.05, 0.05).remove_transducers([7])
    array = pc.Array(places.positions, places.normals, pc.T4010A1, sizes)
    scene = pc.Scene((pc.Point(position=(0.0, 0.0, 0.1), radiation_pressure=1.0),))
    first: Any = pc.backend("simulated")
    pc.Renderer(
        array, scene, backend=first, recorder=pc.Recorder(tmp_path / "run.pac"), clock=ManualClock()
    ).run(0.02)
    backend = registry.backend
    monkeypatch.setattr(
        registry, "backend", lambda *a, **k: made.append(backend(*a, **k)) or made[-1]
    )
    assert told("replay", str(tmp_path / "run.pac"))["frames"] == 20
    (again,) = made
    q = rng.uniform([-0.05, -0.05, 0.05], [0.05, 0.05, 0.2], (10, 3))
    fields = [
        pc.field(
            device.array,
            device.frames[19].gains(device.capability)[-1],
            q,
            precision="double",
            medium=pc.Air(),
        )
        for device in (first, again)
    ]
    assert np.abs(fields[0]).max() > 1.0
    np.testing.assert_array_equal(*fields)


def test_a_solver_that_ends_the_program_is_an_error_and_not_silence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("pacinian.session.Session.solve", lambda *_, **__: sys.exit(3))
    error = run("render", str(EXAMPLE), "--seconds", "0.05").exception
    assert isinstance(error, pc.PluginError)
    assert r"SystemExit(3)" in str(error)


class Broken(pc.Backend):
    """A backend of which one part fails."""

    name: ClassVar[str] = "broken"
    part, error = "open", BaseException()
    capability: Any = pc.Capability()

    def fail(self, part: str) -> None:
        if part == self.part:
            raise self.error

    def open(self, array: pc.Array) -> None:
        self.fail("open")

    def send(self, frame: pc.Frame) -> None:
        self.fail("send")

    def silence(self) -> None:
        self.fail("silence")

    def close(self) -> None:
        self.fail("close")


def offer(monkeypatch: pytest.MonkeyPatch, cls: Any) -> None:
    """Install a solver or a backend beside the others."""
    from pacinian.plugins import registry

    plugins, kind = registry.Plugins(), "solver" if issubclass(cls, pc.Solver) else "backend"
    plugins.offers[cast("registry.Kind", kind), cls.name] = registry.Offer(
        cast("registry.Kind", kind), cls, cls.name, "here"
    )
    monkeypatch.setattr(registry, "discover_plugins", lambda: plugins)


@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize("error", [RuntimeError("boom"), OSError("no port")])
def test_a_backend_that_cannot_be_opened_is_named(
    monkeypatch: pytest.MonkeyPatch, error: Exception, strict: bool
) -> None:
    offer(monkeypatch, Broken)
    monkeypatch.setattr(Broken, "error", error)
    options = ["--strict"] if strict else []
    found = run("render", str(EXAMPLE), "--backend", "broken", *options).exception
    assert isinstance(found, pc.PluginError)
    assert str(found).startswith("backend 'broken'")
    assert type(error).__name__ in str(found)
    assert ("solver 'auto'" in str(found)) == strict  # which is then tried, too


@pytest.mark.parametrize("part", ["open", "send"])
@pytest.mark.parametrize(
    ("error", "says"),
    [
        (RuntimeError("boom"), "backend 'broken' failed: RuntimeError: boom"),
        (SystemExit(0), "the solver or the backend ended the run by SystemExit(0)"),
    ],
)
def test_a_backend_that_fails_in_a_replay_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, part: str, error: BaseException, says: str
) -> None:
    record = tmp_path / "run.pac"
    assert not run("render", str(EXAMPLE), "--seconds", "0.01", "--record", str(record)).exception
    offer(monkeypatch, Broken)
    monkeypatch.setattr(Broken, "part", part)
    monkeypatch.setattr(Broken, "error", error)
    can = pc.Recording(record).capability
    monkeypatch.setattr(Broken, "capability", can)
    found = run("replay", str(record), "--backend", "broken").exception
    assert isinstance(found, pc.PluginError)
    assert str(found).startswith(says)
    monkeypatch.setattr(Broken, "capability", None)
    found = run("replay", str(record), "--backend", "broken").exception
    assert "`capability` must be" in str(found)


def test_a_backend_that_ends_the_program_when_it_is_opened_is_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    offer(monkeypatch, Broken)
    monkeypatch.setattr(Broken, "error", SystemExit(0))
    found = run("render", str(EXAMPLE), "--backend", "broken").exception
    assert isinstance(found, pc.PluginError)
    assert "SystemExit(0)" in str(found)


def test_a_solver_that_cannot_be_made_ends_no_command(monkeypatch: pytest.MonkeyPatch) -> None:
    class Quits(pc.Solver):
        name: ClassVar[str] = "quits"

        def __init__(self) -> None:
            sys.exit(0)

        def solve(self, *_: Any) -> pc.Result:
            return pc.Result()

    offer(monkeypatch, Quits)
    for command in (("render", str(EXAMPLE)), ("demo",)):
        found = run(*command, "--solver", "quits").exception
        assert isinstance(found, pc.PacinianError)
        assert "solver 'quits' cannot be made: SystemExit: 0" in str(found)


def test_a_solver_that_ends_the_demo_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pacinian.session.Session.solve", lambda *_, **__: sys.exit(0))
    error = run("demo", "--seconds", "0.1", "--units", "1", "--out", "").exception
    assert isinstance(error, pc.PluginError)
    assert "SystemExit" in str(error)


def test_a_solver_that_ends_a_rendering_again_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    record = tmp_path / "run.pac"
    assert not run("render", str(EXAMPLE), "--seconds", "0.01", "--record", str(record)).exception
    monkeypatch.setattr("pacinian.session.Session.solve", lambda *_, **__: sys.exit(0))
    error = run("rerender", str(record)).exception
    assert isinstance(error, pc.PluginError)
    assert "SystemExit" in str(error)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such files")
def test_a_pipe_is_refused_as_a_recording(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(renderer.Renderer, "open", lambda _: pytest.fail("it waits for a reader"))
    os.mkfifo(tmp_path / "pipe")
    result = run("render", str(EXAMPLE), "--record", str(tmp_path / "pipe"))
    assert result.exit_code == 2
    assert "is a pipe or a socket" in result.output


def test_render_lets_the_solver_be_chosen() -> None:
    seen = told("render", str(EXAMPLE), "--seconds", "0.05", "--solver", "gs-pat")
    assert seen["solver"] == "gs-pat"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "cannot be read"),
        ("solver = ", "is not TOML"),
        ("colour = 1", "colour"),
        ('solver = "magic"', r"\$.solver.*magic.*lagrange"),
        ('solver = { name = "lagrange", options = { mew = 1 } }', r"\$.solver.*mew.*mu"),
        ('backend = "magic"', r"\$.backend.*simulated"),
        ("rate = 100000", "rate"),
        ('[[objects]]\ntype = "point"\nposition = [0, 0, 0.2]', "radiation_pressure"),
    ],
)
def test_a_bad_scene_file_is_an_error_with_the_key(
    tmp_path: Path, text: str | None, says: str
) -> None:
    path = tmp_path / "scene.toml"
    if text is not None:
        path.write_text(text)
    result = run("render", str(path))
    assert isinstance(result.exception, pc.SceneFileError)
    with pytest.raises(pc.SceneFileError, match=says):
        raise result.exception
    assert str(path) in str(result.exception)


@pytest.mark.parametrize(
    "arguments",
    [
        ("render", "none.toml"),
        ("demo", "--solver", "magic"),
        ("replay", "none"),
        ("demo", "--seconds", "-1"),
        ("rerender", "any.pac", "--backend", "simulated"),  # no frames are played
        ("nonsense",),
    ],
)
def test_an_error_is_told_with_exit_code_2(
    arguments: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert ended(monkeypatch, *arguments) == 2
    said = capsys.readouterr()
    assert said.err.strip()
    assert not said.out


def test_plugins_lists_ours_with_options_and_origin() -> None:
    seen = told("plugins")
    ours = {(p["kind"], p["name"]): p for p in seen["plugins"]}
    assert ours["solver", "lagrange"]["options"]["mu"] == 1e-6
    assert "pacinian" in ours["backend", "simulated"]["from"]
    assert not seen["failed"]
    table = run("plugins")
    assert "lagrange" in table.stdout


def test_plugins_of_one_name_are_named_beside_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    from pacinian.plugins import registry

    plugins = registry.Plugins()
    plugins.clashes["gs"] = pc.PluginError("two solvers are called 'gs'")
    monkeypatch.setattr(registry, "discover_plugins", lambda: plugins)
    seen = told("plugins", code=1)
    names = [p["name"] for p in seen["plugins"]]
    assert "lagrange" in names
    assert "gs" not in names
    assert seen["failed"] == {"gs": "two solvers are called 'gs'"}
    table = run("plugins")
    assert "lagrange" in table.stdout
    assert "two solvers are called 'gs'" in table.stderr


def test_offers_that_others_replace_are_named_beside_the_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from pacinian.plugins import registry

    plugins = registry.Plugins()
    plugins.shadowed["twin"] = pc.PluginError("the solver 'gs' of plug-in 'twin' is not used")
    monkeypatch.setattr(registry, "discover_plugins", lambda: plugins)
    seen = told("plugins", code=1)
    assert "gs" in [p["name"] for p in seen["plugins"]]
    assert seen["failed"] == {"twin": "the solver 'gs' of plug-in 'twin' is not used"}


def test_names_cannot_write_to_the_terminal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(click.utils, "should_strip_ansi", lambda *_: False)  # as in a terminal
    file = tmp_path / "scene.json"
    ball = {
        "type": "volume", "name": "\x1b[31mball", "radiation_pressure": 1.0,
        "shape": {"type": "sphere", "radius": 0.02}, "pose": {"position": [0, 0, 0.2]},
        "envelope": {"type": "sine", "frequency": 900.0},  # which the device cannot play
    }  # fmt: skip
    file.write_text(json.dumps({"objects": [ball], "array": {"type": "autd"}}))
    shown = run("render", str(file), "--seconds", "0.01").output
    assert "?[31mball" in shown
    assert "\x1b[31m" not in shown
    file.write_text('{"\\u001b[31mkey": 1}')
    assert ended(monkeypatch, "render", str(file)) == 2
    assert "unknown field `?[31mkey`" in capsys.readouterr().err


EMPTY: list[tuple[str, ...]] = [
    *[
        ("render", str(EXAMPLE), option, "")
        for option in ("--record", "--out", "--solver", "--backend")
    ],
    *[("serve", option, "") for option in ("--connection", "--keys", "--solver", "--host")],
    *[(name, "") for name in ("render", "replay", "rerender", "view", "serve", "unity")],
    ("keys", "server", "--folder", ""),
    ("keys", "client", "one", "--folder", "keys", "--host", ""),
    ("devices", "check", ""),
    ("devices", "draw", str(EXAMPLE), "--out", ""),
    ("devices", "--backend", ""),
    ("new", "solver", "one", "--folder", ""),
    ("status", "--connection", ""),
    ("replay", "run.pac", "--backend", ""),
]


@pytest.mark.parametrize("arguments", EMPTY, ids=" ".join)
def test_nothing_may_be_empty(
    arguments: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert result.exit_code == 2
    assert "must not be empty" in result.output
    assert not list(tmp_path.iterdir())


def test_a_name_that_the_output_cannot_encode_is_printed_with_replacements(tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text(EXAMPLE.read_text().replace('"ball"', '"\u7403"'), encoding="utf-8")
    words = "render", str(file), "--seconds", "0.05", "--backend", "simulated"
    done = subprocess.run(
        [sys.executable, "-m", "pacinian", *words],
        env={**os.environ, "PYTHONIOENCODING": "latin-1"},
        capture_output=True,
        timeout=LIMIT,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert b"?" in done.stdout


def test_schema_prints_a_schema_that_accepts_a_scene_file() -> None:
    schema = json.loads(run("schema").stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.validate(tomllib.loads(EXAMPLE.read_text("utf-8")), schema)


def test_every_command_explains_itself() -> None:
    assert isinstance(cli, click.Group)
    for name, command in cli.commands.items():
        result = run(name, "--help")
        assert result.exit_code == 0
        assert command.help
        for parameter in command.params:
            if isinstance(parameter, click.Option):
                assert parameter.help, (name, parameter.name)
    assert "Exit codes" in run("--help").stdout


@pytest.fixture
def end_of_terminal() -> Iterator[None]:
    """Let processes that start now get SIGHUP, which is ignored under nohup."""
    if sys.platform == "win32":
        yield
        return
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_a_signal_ends_a_run_in_silence_with_its_summary_and_a_whole_recording(
    name: str, tmp_path: Path, end_of_terminal: None
) -> None:
    number = getattr(signal, name, None)
    if number is None:
        pytest.skip("this system has no such signal")
    record = tmp_path / "run.pac"
    with subprocess.Popen(
        [sys.executable, "-m", "pacinian", "render", str(EXAMPLE), "--seconds", "1000", "--json",
         "--record", str(record)],
        stdout=subprocess.PIPE, text=True,
    ) as child:  # fmt: skip
        try:
            end = time.monotonic() + LIMIT
            while not (record.exists() and record.stat().st_size > 500_000):
                assert time.monotonic() < end
                time.sleep(0.02)  # real time, because the other process has its own clock
            child.send_signal(number)
            out, _ = child.communicate(timeout=LIMIT)
        except BaseException:
            child.kill()
            raise
    assert child.returncode == 130
    seen = json.loads(out)
    assert seen["interrupted"]
    frames = len(list(pc.Recording(record)))
    assert seen["frames_sent"] - frames in (0, 1)  # one frame may have been in transit
    again = told("rerender", str(record))  # in this process, from the other's recording
    assert again["different"] == 0
    assert again["ticks"] > 1


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signal")
def test_a_command_survives_the_end_of_the_terminal_under_nohup(
    monkeypatch: pytest.MonkeyPatch, end_of_terminal: None
) -> None:
    terminated = signal.getsignal(signal.SIGTERM)
    monkeypatch.setattr(sys, "argv", ["pacinian", "--version"])
    try:
        for handler, ignored in ((signal.SIG_IGN, True), (signal.SIG_DFL, False)):
            signal.signal(signal.SIGHUP, handler)
            with pytest.raises(SystemExit):
                main()
            assert (signal.getsignal(signal.SIGHUP) is signal.SIG_IGN) == ignored
            assert signal.getsignal(signal.SIGHUP) is not signal.SIG_DFL
    finally:
        signal.signal(signal.SIGTERM, terminated)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows sends Ctrl-C to all of a console")
@pytest.mark.parametrize(
    "program", [["-m", "pacinian"], ["-c", ENTRY_POINT]], ids=["module", "script"]
)
def test_ctrl_c_while_the_command_is_imported_prints_no_traceback(
    program: list[str], tmp_path: Path
) -> None:
    interrupts = (
        "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\nraise ImportError('late')\n"
    )
    (tmp_path / "click.py").write_text(interrupts)
    done = subprocess.run(
        [sys.executable, *program, "plugins"],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True, text=True, timeout=LIMIT, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")


def test_it_works_without_display_home_or_matplotlib(tmp_path: Path) -> None:
    block = tmp_path / "matplotlib.py"
    block.write_text("raise ImportError('no matplotlib')")
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "HOME")}
    done = subprocess.run(
        [sys.executable, "-m", "pacinian", "demo", "--seconds", "0.1", "--units", "1", "--json"],
        env={**environment, "PYTHONPATH": str(tmp_path)}, cwd=tmp_path,
        capture_output=True, text=True, timeout=LIMIT, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["picture"] == ""
    assert '[plot]"' in done.stderr


@pytest.mark.parametrize("out", ["picture", "picture.xyz", "/proc/nowhere/picture.png"])
def test_a_picture_that_cannot_be_written_is_told_before_the_run(
    out: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(renderer.Renderer, "run", lambda *_: pytest.fail("it ran"))
    result = run("demo", "--out", out)
    assert result.exit_code == 2
    assert "picture" in result.output


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk_is_told_and_not_a_crash(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = "render", str(EXAMPLE), "--seconds", "0.2", "--record", "/dev/full", "--json"
    assert ended(monkeypatch, *arguments) == 2
    said = capsys.readouterr()
    assert "No space" in said.out + said.err


def test_a_viewer_that_is_not_installed_is_told_before_the_server_starts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from importlib import util

    from pacinian.serving import server

    started: list[object] = []
    monkeypatch.setattr(server, "serve", lambda *given, **_: started.append(given))
    monkeypatch.setattr(util, "find_spec", lambda name: None if name == "uvicorn" else name)
    result = run("serve", "--view")
    assert isinstance(result.exception, pc.MissingExtra)
    assert '[view]"' in str(result.exception)
    assert not started
    assert run("serve").exit_code == 0
    assert len(started) == 1


def test_the_end_of_standard_input_is_told_and_what_it_says_is_not() -> None:
    (read, write), ended = os.pipe(), threading.Event()
    with os.fdopen(read), os.fdopen(write, "wb", buffering=0) as parent:
        call_at_end_of_input(ended.set, read)
        parent.write(b"anything")
        assert not ended.wait(0.05)
        parent.close()
        assert ended.wait(60.0)


@pytest.mark.parametrize("kind", ["solver", "backend"])
def test_a_plug_in_that_is_not_there_is_told_before_the_server_starts(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pacinian.serving import server

    monkeypatch.setattr(server, "serve", lambda *given, **_: pytest.fail("it starts"))
    result = run("serve", f"--{kind}", "nonsense")
    assert isinstance(result.exception, pc.UnknownPlugin)
    assert f"no {kind} is called 'nonsense'" in str(result.exception)


def sections(text: str) -> dict[str, list[str]]:
    """Return the names of the commands under each heading of the help."""
    found: dict[str, list[str]] = {}
    heading = ""
    for line in text.splitlines():
        if line and not line.startswith(" "):
            heading = line.partition(" ")[0].rstrip(":").lower()
        elif heading and (name := re.match(r"  ([\w-]+)  ", line)):
            found.setdefault(heading, []).append(name[1])
    return found


def test_help_lists_the_commands_in_groups() -> None:
    found = sections(run("--help").stdout)
    assert found["start"] == ["demo", "doctor", "unity", "unreal"]
    assert {"serve", "render"} <= set(found["run"])
    assert {"status", "watch", "view"} <= set(found["inspect"])
    assert {"bench", "soak"} <= set(found["develop"])  # those of the laboratory
    listed = [name for group in GROUPS for name in found[group]]
    assert sorted(listed) == sorted(cli.list_commands(click.Context(cli)))


def test_help_cuts_no_line_short() -> None:
    """Each command is explained by a whole sentence in 80 columns."""
    result = CliRunner().invoke(cli, ["--help"], terminal_width=80)
    lines = result.stdout.partition("Start")[2].splitlines()
    assert not [line for line in lines if line.endswith("...")]


def test_plugins_add_commands(monkeypatch: pytest.MonkeyPatch) -> None:
    """Plug-in commands are imported only for help and unknown names, and cannot replace core commands."""
    import click

    from pacinian.plugins import registry

    class Fakes(registry.Plugins):
        def load(self, name: str | None = None, kind: Any = None) -> None:
            groups: dict[str, CommandGroup] = {"tune": "develop", "play": "run", "serve": "start"}
            for called, group in groups.items():
                command = click.Command(called, callback=lambda: click.echo("tuned"), help="Tune.")
                offer = registry.CommandOffer(called, command, "tuner", "tuner 1", group)
                self.commands[called] = offer

    fakes = Fakes([])
    monkeypatch.setattr(registry, "discover_plugins", lambda: fakes)
    assert CliRunner().invoke(cli, ["serve", "--help"]).exit_code == 0
    assert not fakes.commands
    assert CliRunner().invoke(cli, ["tune"]).stdout == "tuned\n"
    shown = CliRunner().invoke(cli, ["--help"]).stdout
    found = sections(shown)
    assert "tune" in found["develop"]
    assert "play" in found["run"]
    assert "serve" in found["run"]
    assert "serve" not in found["start"]
    listed = CliRunner().invoke(cli, ["plugins", "--json"])
    told = json.loads(listed.stdout)
    assert [command["name"] for command in told["commands"]] == ["play", "tune"]
    assert "'serve', which Pacinian itself has: give it another name" in told["failed"]["serve"]
    assert listed.exit_code == 1
    assert "Tune." not in CliRunner().invoke(cli, ["serve", "--help"]).stdout


def test_an_unknown_command_tells_of_plugins_that_did_not_load(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from pacinian.plugins import registry

    plugins = registry.Plugins([])
    plugins.failed["tuner"] = pc.PluginError("plug-in 'tuner' does not load: no numpy")
    monkeypatch.setattr(registry, "discover_plugins", lambda: plugins)
    result = CliRunner().invoke(cli, ["tune"])
    assert result.exit_code == 2
    assert "No such command 'tune'" in result.stderr
    assert "does not load: no numpy" in result.stderr


def test_a_reader_of_the_first_line_does_not_look_like_a_plug_in_that_failed() -> None:
    """As in `pacinian plugins | head -1`."""
    command = [sys.executable, "-m", "pacinian", "plugins"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout
        assert process.stdout.readline()
        process.stdout.close()
        assert process.wait(60.0) == 0
