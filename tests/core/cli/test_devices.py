"""`pacinian devices`: connected devices, checks of a description, the picture, the udev rule."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

import pacinian as pc
from pacinian.cli import device_check_rules, devices
from pacinian.cli.main import cli
from pacinian.cli.udev import make_rules
from pacinian.devices.board import Board
from pacinian.devices.layouts import Grid
from pacinian.plot import boards as drawing
from pacinian.plot.page import save
from pacinian.plugins import device_discovery, registry
from pacinian.plugins.registry import Offer

if TYPE_CHECKING:
    from collections.abc import Iterable

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "examples" / "devices"
CAN = pc.Capability(128, 65, 1000.0)
READY = pc.FoundDevice("mine", "A", "an array at 1-2")
DENIED = pc.FoundDevice("mine", "B", "an array at 1-3", "no right to it: see the udev rule")


class Mine(pc.Backend):
    """A backend with a list of fake devices."""

    name: ClassVar[str] = "mine"
    usb = (0x0403, 0x6014), (0xFF, 0x41, 0x01)
    shelf: ClassVar[list[Any]] = []

    @classmethod
    def find_devices(cls) -> Iterable[pc.FoundDevice]:
        for one in cls.shelf:
            if isinstance(one, BaseException):
                raise one
            yield one

    @property
    def capability(self) -> pc.Capability:
        return CAN

    def open(self, array: pc.Array) -> None: ...
    def send(self, frame: pc.Frame) -> None: ...
    def silence(self) -> None: ...
    def close(self) -> None: ...


@pytest.fixture
def plugins(monkeypatch: pytest.MonkeyPatch) -> pc.Plugins:
    """Install that backend, without devices."""
    made = pc.Plugins([])
    made.offers["backend", "mine"] = Offer("backend", Mine, "mine", "here")
    monkeypatch.setattr(registry, "discover_plugins", lambda: made)
    Mine.shelf[:] = []
    return made


def run(*words: object) -> tuple[int, str]:
    done = CliRunner().invoke(cli, ["devices", *map(str, words)])
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.exit_code, done.output


@pytest.mark.parametrize("system", ["linux", "win32", "darwin", "freebsd"])
def test_nothing_connected_says_what_to_try(
    plugins: Any, system: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(devices.sys, "platform", system)
    code, told = run()
    assert code == 0
    assert "no device is connected" in told
    assert {"win32": "Zadig", "darwin": "macOS"}.get(system, "udevadm") in told


def test_the_list_tells_serials_and_what_is_wrong(plugins: Any) -> None:
    Mine.shelf[:] = [DENIED, READY]
    code, told = run()
    assert code == 1
    assert re.search(r"mine +A +an array at 1-2 +ready", told)
    assert re.search(r"mine +B +an array at 1-3 +cannot be used", told)
    assert "mine B: no right to it" in told
    assert told.index(" A ") < told.index(" B ")
    Mine.shelf[:] = [READY]
    assert run()[0] == 0


def test_the_list_is_json_for_programs(plugins: Any) -> None:
    Mine.shelf[:] = [READY]
    code, told = run("--json", "--backend", "mine")
    assert code == 0
    assert json.loads(told)["devices"] == [
        {"backend": "mine", "serial": "A", "title": "an array at 1-2", "problem": ""}
    ]


def test_a_backend_that_fails_to_look_is_told_and_takes_nothing_down(plugins: Any) -> None:
    Mine.shelf[:] = [READY, OSError("no USB here")]
    (one,) = device_discovery.list_connected(plugins)
    assert "OSError: no USB here" in one.problem


def test_a_backend_that_ends_the_program_does_not_hide_the_devices_of_others(plugins: Any) -> None:
    class Other(Mine):
        name: ClassVar[str] = "other"
        shelf: ClassVar[list[Any]] = [SystemExit(0)]

    plugins.offers["backend", "other"] = Offer("backend", Other, "other", "here")
    Mine.shelf[:] = [READY]
    ready, failed = device_discovery.list_connected(plugins)
    assert ready == READY
    assert "SystemExit: 0; a plug-in must not end the program" in failed.problem


def test_what_a_device_calls_itself_does_not_control_the_terminal(
    plugins: Any, tmp_path: Path
) -> None:
    Mine.shelf[:] = [pc.FoundDevice("mine", "\x1b[2J\udcff", "an \x1b[31marray\r", "not\x07 yours")]
    _, told = run()
    assert re.search(r"mine +\?\[2J\? +an \?\[31marray\? +cannot be used", told)
    assert "mine ?[2J?: not? yours" in told
    path = tmp_path / "d.toml"
    path.write_text('backend = "mine"\n[[boards]]\nserial = "A"\n')
    checked = run("check", path)[1]
    assert "connected: ?[2J?" in checked
    assert not re.search(r"[\x07\x0d\x1b]", told + checked)


def test_two_of_one_serial_are_a_problem_of_both(plugins: Any) -> None:
    Mine.shelf[:] = [
        READY,
        READY,
        pc.FoundDevice("mine", "", "no serial"),
        pc.FoundDevice("mine", "", "nor this"),
    ]
    found = device_discovery.list_connected(plugins)
    assert [bool(f.problem) for f in found] == [False, False, True, True]


def test_what_cannot_be_looked_for_is_a_row_with_its_fix_and_no_failure(plugins: Any) -> None:
    Mine.shelf[:] = [pc.FoundDevice("mine", "", "", "libusb is not installed: `apt install it`")]
    plugins.failed["odd"] = pc.PluginError("plug-in 'odd' does not load: ImportError: no odd")
    code, told = run()
    assert code == 0
    assert re.search(r"mine +- +- +search failed", told)
    assert re.search(r"odd +- +- +search failed", told)
    assert "mine: libusb is not installed: `apt install it`" in told
    assert "odd: plug-in 'odd' does not load: ImportError" in told
    assert "no device is connected" in told
    assert run("--backend", "mine")[0] == 1
    Mine.shelf += [READY]
    assert run()[0] == 0
    Mine.shelf += [DENIED]
    assert run()[0] == 1


def test_boards_are_not_missed_where_nobody_could_look(plugins: Any) -> None:
    blind = pc.FoundDevice("mine", "", "", "install libusb")
    for boards in ([pc.Board("A")], [pc.Board()]):
        (found,) = device_check_rules.check_connected(
            described(boards=boards, backend="mine"), [blind]
        )
        assert (found.level, found.text, found.fix) == (
            "problem", "search failed", "install libusb",
        )  # fmt: skip


def test_looking_imports_backends_alone() -> None:
    code = (
        "import sys; from pacinian.cli.main import cli\n"
        "for backend in (['--backend', 'simulated'], []):\n"
        "    cli(['devices', '--json', *backend], standalone_mode=False)\n"
        "    print('#', [m for m in sys.modules if m.startswith(('pacinian.native', 'pacinian_plugins.'))])\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True, text=True, timeout=200, check=True,
    )  # fmt: skip
    one, every = (line for line in done.stdout.splitlines() if line.startswith("#"))
    for imported in (one, every):
        assert "pacinian.native" not in imported
        assert "plugins.solvers." not in imported
        assert "backends.simulated" in imported
    assert "usb_autd" not in one
    assert "usb_autd" in every


def test_a_backend_that_is_not_there_is_an_error(plugins: Any) -> None:
    with pytest.raises(pc.UnknownPlugin, match="mine"):
        device_discovery.list_connected(plugins, "other")


# ------------------------------------------------------------------ check


def described(**changes: Any) -> pc.DeviceDescription:
    boards = [pc.Board("A"), pc.Board("B", pose=pc.Pose((0.2, 0.0, 0.0)))]
    return pc.DeviceDescription(tuple(changes.pop("boards", boards)), **changes)


def levels(findings: Iterable[Any]) -> dict[str, str]:
    return {f.name: f.level for f in findings}


def test_a_sound_description_has_no_problem() -> None:
    assert set(levels(device_check_rules.check_description(described())).values()) == {"ok"}


def test_boards_that_overlap_are_named() -> None:
    near = pc.Board("B", pose=pc.Pose((0.0, 0.004, 0.0)))
    found = device_check_rules.check_description(described(boards=[pc.Board("A"), near]))
    (problem,) = (f for f in found if f.level == "problem")
    assert re.search(r"overlap, 4\.0 mm apart, on board A and board B", problem.text)
    opposite = pc.Board("B", pose=pc.Pose((0.0, 0.0, 0.2), (1.0, 0.0, 0.0, 0.0)))
    assert (
        levels(device_check_rules.check_description(described(boards=[pc.Board("A"), opposite])))[
            "places"
        ]
        == "ok"
    )
    tight = pc.Board("A", Grid(4, 4, 0.005))
    found = device_check_rules.check_description(described(boards=[tight]))
    assert "on board A" in next(f.text for f in found if f.level == "problem")


def test_dead_and_odd_channels_are_counted() -> None:
    gain = np.ones(249)
    gain[[3, 4]] = 0.2, 3.0
    one = pc.Board("A", dead=(7, 9), gain=tuple(gain.tolist()))
    found = {f.name: f for f in device_check_rules.check_description(described(boards=[one]))}[
        "board A"
    ]
    assert found.level == "warning"
    assert "dead: 7, 9" in found.text
    assert "far from their kind: 3, 4" in found.text
    assert (
        "247 transducers" in device_check_rules.check_description(described(boards=[one]))[0].text
    )


def test_a_frequency_far_from_the_transducer_s_is_a_warning() -> None:
    from pacinian.devices.description import TransducerType

    found = levels(
        device_check_rules.check_description(
            described(transducer=TransducerType(frequency=30_000.0))
        )
    )
    assert found["frequency"] == "warning"


def test_levels_must_be_the_backend_s() -> None:
    from pacinian.devices.description import LevelCounts

    assert device_check_rules.check_levels(described(), CAN).level == "ok"
    assert (
        device_check_rules.check_levels(described(levels=LevelCounts(128, 65)), CAN).level == "ok"
    )
    wrong = device_check_rules.check_levels(
        described(levels=LevelCounts(256, 65), backend="mine"), CAN
    )
    assert wrong.level == "problem"
    assert "mine has 128 phases" in wrong.text


def test_boards_are_looked_for_by_serial() -> None:
    device = described(backend="mine")
    other = pc.FoundDevice("other", "B", "of another kind")
    found = device_check_rules.check_connected(
        device, [READY, other, pc.FoundDevice("mine", "C", "spare")]
    )
    assert levels(found) == {
        "board A, connected": "ok", "board B, connected": "problem", "others": "warning",
    }  # fmt: skip
    assert "connected: A, C" in found[1].fix
    denied = device_check_rules.check_connected(device, [READY, DENIED])
    assert denied[1].fix == DENIED.problem


def test_a_board_without_a_serial_is_the_only_one_there() -> None:
    device = described(boards=[pc.Board()])
    nameless = pc.FoundDevice("mine", "", "a serial port")
    assert levels(device_check_rules.check_connected(device, [nameless])) == {
        "board, connected": "ok"
    }
    assert levels(device_check_rules.check_connected(device, [READY])) == {"board, connected": "ok"}
    two = [READY, pc.FoundDevice("mine", "C", "another")]
    assert levels(device_check_rules.check_connected(device, two))["board, connected"] == "problem"


def test_check_tells_all_of_it(plugins: Any, tmp_path: Path) -> None:
    path = tmp_path / "d.toml"
    path.write_text('backend = "mine"\n[[boards]]\nserial = "A"\n')
    Mine.shelf[:] = [READY]
    code, told = run("check", path)
    assert code == 0
    assert "no problem found" in told
    assert "128 phases, 65 amplitudes" in told
    Mine.shelf[:] = []
    code, told = run("check", path, "--json")
    assert code == 1
    assert any(f["level"] == "problem" for f in json.loads(told)["findings"])
    assert run("check", path, "--offline")[0] == 0


# ------------------------------------------------------------------ draw, udev, schema


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda p: p.stem)
def test_a_description_is_drawn(path: Path, tmp_path: Path, need: Any) -> None:
    need("matplotlib")
    out = tmp_path / "device.png"
    assert run("draw", path, "--out", out) == (0, f"{out}\n")
    picture = np.asarray(Image.open(out).convert("RGB")).astype(int)
    red = (picture[..., 0] > 180) & (picture[..., 1:] < 80).all(axis=2)
    dead = any(
        board.alive.size < board.layout.count for board in pc.DeviceDescription.load(path).boards
    )
    assert bool(red.any()) == dead  # crosses


@pytest.mark.parametrize("name", ["folder.png", "file/device.png"])
def test_a_picture_that_cannot_be_written_is_refused_before_it_is_drawn(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "file").touch()
    monkeypatch.delattr(pc.DeviceDescription, "load")
    path = next(EXAMPLES.glob("*.toml"))
    code, told = run("draw", path, "--out", tmp_path / name)
    assert code == 2
    assert "cannot be written" in told


def test_no_transducer_of_a_small_board_is_cut_off_in_its_picture(need: Any) -> None:
    need("matplotlib")
    board = Board(layout=Grid(columns=4, rows=4, pitch=0.0105), dead=(3,))
    page = drawing.boards(pc.DeviceDescription((board,)))
    (panel,) = (p for p in page.get_axes() if p.get_title() == "board, 1 dead")
    for low, high in (panel.get_xlim(), panel.get_ylim()):
        edge = (
            1.5 * 10.5 + drawing.RING * 10.5 / 2.0
        )  # of the ring around an outermost transducer [mm]
        assert low < -edge < edge < high
    assert panel.get_xlabel() == "x of the board [mm]"
    (space,) = (p for p in page.get_axes() if p.name == "3d")
    assert space.get_zlabel() == "z [mm]"


def test_one_is_not_plural() -> None:
    few = pc.DeviceDescription((Board(layout=Grid(columns=1, rows=1)),))
    array, board, *_ = device_check_rules.check_description(few)
    assert array.text.startswith("1 transducer on 1 board,")
    assert board.text == "1 channel"


@pytest.mark.parametrize("sides", [(1, 1), (8, 1), (1, 8)])
@pytest.mark.parametrize("axis", [None, "x", "y"])
def test_boards_of_one_row_are_drawn(
    sides: tuple[int, int], axis: str | None, tmp_path: Path, need: Any
) -> None:
    need("matplotlib")
    turn: Any = {"x": (0.5, 0.5, 0.5, 0.5), "y": (0.5**0.5, 0.0, 0.5**0.5, 0.0)}
    pose = pc.Pose((0.1, 0.0, 0.0), turn[axis]) if axis else pc.Pose()
    board = Board(layout=Grid(columns=sides[0], rows=sides[1]), pose=pose)
    save(drawing.boards(pc.DeviceDescription((board,))), str(tmp_path / "row.png"))
    assert (tmp_path / "row.png").read_bytes().startswith(b"\x89PNG")


def test_boards_that_are_only_in_the_overview_are_counted(need: Any) -> None:
    need("matplotlib")
    few = [
        Board(serial=str(i), layout=Grid(columns=1, rows=1), pose=pc.Pose((0.02 * i, 0.0, 0.0)))
        for i in range(drawing.MAX_BOARDS + 1)
    ]
    page = drawing.boards(pc.DeviceDescription(tuple(few)))
    words = f"the first {drawing.MAX_BOARDS} of {drawing.MAX_BOARDS + 1} boards"
    assert any(words in text.get_text() for part in page.subfigs for text in part.texts)
    page = drawing.boards(pc.DeviceDescription(tuple(few[:-1])))
    assert not any(part.texts for part in page.subfigs)


def test_the_rule_is_the_one_that_is_shipped() -> None:
    """The rule covers all our backends, regardless of what is installed."""
    with (ROOT / "pyproject.toml").open("rb") as file:
        ours = tomllib.load(file)["project"]["entry-points"]["pacinian"]
    plugins = pc.Plugins([EntryPoint(name, value, "pacinian") for name, value in ours.items()])
    text = make_rules(plugins)
    assert not plugins.failed
    (shipped,) = (ROOT / "packaging").glob("*.rules")
    assert shipped.read_text("utf-8") == text
    assert shipped.name < "73"  # 73-seat-late.rules evaluates `uaccess`


def test_a_rule_names_each_kind_of_device(plugins: Any) -> None:
    code, told = run("udev")
    assert code == 0
    by_maker, by_interface = (
        [part.strip() for part in line.split(",")][:-2]
        for line in told.splitlines()
        if line and not line.startswith("#")
    )
    usb = ['SUBSYSTEM=="usb"', 'ENV{DEVTYPE}=="usb_device"']
    maker = ['ATTR{idVendor}=="0403"', 'ATTR{idProduct}=="6014"']
    assert by_maker == [*usb, *maker, 'TAG+="uaccess"']
    assert by_interface == [*usb, 'ENV{ID_USB_INTERFACES}=="*:ff4101:*"', 'TAG+="uaccess"']


def test_the_schema_is_that_of_descriptions() -> None:
    code, told = run("schema")
    assert code == 0
    assert "boards" in json.dumps(json.loads(told))
