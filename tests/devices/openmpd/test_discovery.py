"""Which boards are found and opened, and what the user sees where one cannot be."""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian_plugins.backends.openmpd import OpenMpd
from pacinian_plugins.backends.openmpd.troubles import ANONYMOUS, explained, holders

from ..usb_in_memory import error
from .chips import UDEV, Chip, Setup


def test_only_boards_that_are_named_are_touched() -> None:
    it = Setup("FT1", "OTHER", serials=[])
    it.refused(
        it.open,
        "openmpd: name the boards: `serials`, or those of a `description`; any FT232H looks like one; "
        "there are: FT1, OTHER",
    )
    it = Setup("FT1", "OTHER")
    it.backend.serials = ["FT1"]
    it.array = pc.Array(it.array.positions[:256], it.array.normals[:256])
    it.open()
    it.play()
    it.backend.close()
    other = it.chips[1]
    assert (other.requests, other.writes, other.configured) == ([], [], False)


def test_a_dead_chip_that_is_still_listed_is_passed_over() -> None:
    it = Setup()
    it.bus.stale = True
    it.chip.unplug()
    it.refused(it.open, "openmpd FT1: is not connected; there are: none")
    again = Chip("FT1", it.clock)
    it.bus.plug(again)
    it.open()
    it.play()
    assert again.model.pulses().any()
    it.backend.close()


def test_a_chip_that_is_listed_and_answers_nothing() -> None:
    it = Setup()
    it.chip.configured = it.chip.mute = True
    silent = "bus 1, address 2: it does not answer: unplug it and plug it in again"
    it.refused(it.open, f"openmpd FT1: is not connected; there are: none; {silent}")


def test_it_is_plugged_in_while_the_program_runs() -> None:
    it = Setup()
    it.bus.devices.clear()
    it.refused(it.open, "openmpd FT1: is not connected; there are: none")
    it.bus.plug(it.chip)
    it.open()
    it.backend.close()


def test_all_or_none_are_opened() -> None:
    it = Setup("FT1", "FT2")
    it.bus.devices.remove(it.chips[1])
    it.refused(it.open, "openmpd FT2: is not connected; there are: FT1")
    assert (it.bus.open, it.chip.requests) == (0, [])


def test_no_permission() -> None:
    it = Setup("FT1", "FT2")
    it.chip.denied = True
    told = f"bus 1, address 2: {UDEV}"
    it.refused(it.open, f"openmpd FT1: is not connected; there are: FT2; {told}")


def test_no_driver_on_windows() -> None:
    it = Setup()
    it.chip.driverless = True
    it.refused(
        it.open,
        "openmpd FT1: is not connected; there are: none; bus 1, address 2: it has no driver that "
        "programs may use: give it WinUSB with Zadig (https://zadig.akeo.ie)",
    )


def test_another_program_has_it_and_is_not_disturbed() -> None:
    it = Setup().open()
    it.play()
    told = len(it.chip.requests)
    other = OpenMpd(library=it.bus, serials=["FT1"], wait=it.clock.advance, clock=it.clock.now)
    it.refused(
        lambda: other.open(it.array),
        "openmpd FT1: opening it: it is in use by another program: end that first",
    )
    assert it.sounding()
    assert len(it.chip.requests) == told
    it.play()
    it.backend.close()
    other.open(it.array)
    other.close()


def test_who_holds_it_is_told_where_that_can_be_known(tmp_path: Path) -> None:
    for pid, node in ((12, "/dev/null"), (345, "/dev/bus/usb/001/002")):
        fds = tmp_path / str(pid) / "fd"
        fds.mkdir(parents=True)
        (fds / "3").symlink_to(node)
        (fds.parent / "comm").write_text(f"program{pid}\n")
    (tmp_path / "99").mkdir()  # it has ended since
    assert holders(1, 2, tmp_path) == "program345 (345)"
    assert holders(1, 3, tmp_path) == ""
    assert str(os.getpid()) not in holders(250, 250)


def test_the_systems_serial_driver_gives_way_and_is_back_afterwards() -> None:
    it = Setup()
    it.chip.driver = True
    it.chip.configured = True
    it.open()
    assert it.bus.calls == ["detach"]
    it.play()
    it.backend.close()
    assert it.bus.calls == ["detach", "attach"]


def test_boards_are_in_the_order_in_which_they_are_named() -> None:
    it = Setup("FT2", "FT1").open()
    levels = np.zeros((1, 512), np.uint16)
    levels[:, :256], levels[:, 256:] = 1, 2
    it.backend.send(pc.Frame(0, 0.0, levels, levels))
    assert [int(chip.model.pulses().sum(axis=1).max()) for chip in it.chips] == [1, 2]
    it.backend.close()


def test_two_with_one_serial_are_an_error() -> None:
    it = Setup("FT1", "FT1", serials=["FT1"])
    it.array = pc.Array(it.array.positions[:256], it.array.normals[:256])
    it.refused(
        it.open,
        "openmpd FT1: 2 have this serial number, at bus 1, address 2 and bus 1, address 3: unplug one",
    )
    assert it.bus.open == 0


def test_an_array_of_another_size_is_refused() -> None:
    it = Setup("FT1", "FT2", serials=["FT1"])
    it.refused(it.open, "openmpd: the array has 512 transducers, and its 1 boards 256")


def test_boards_of_a_description(tmp_path: Path) -> None:
    order = list(reversed(range(256)))
    board = f'layout = {{ type = "grid" }}\norder = {order}\n'
    file = tmp_path / "device.toml"
    file.write_text(
        f'backend = "openmpd"\n[[boards]]\nserial = "FT2"\n{board}'
        f'[[boards]]\nserial = "FT1"\n{board}dead = [5]\npose = {{ position = [0.2, 0.0, 0.0] }}\n'
    )
    it = Setup("FT1", "FT2", serials=[], description=str(file))
    it.array = pc.DeviceDescription.load(file).array()
    it.open()
    levels = (np.arange(511, dtype=np.uint16) % 65)[None]
    it.backend.send(pc.Frame(0, 0.0, np.zeros_like(levels), levels))
    first, second = (chip.model.pulses().sum(axis=1) for chip in reversed(it.chips))
    np.testing.assert_array_equal(first[::-1], levels[0, :256])
    assert second[5] == 0
    np.testing.assert_array_equal(np.delete(second[::-1], 250), levels[0, 256:])
    it.backend.close()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[boards]]\nlayout = { type = 'grid' }\n", "name the boards: "),
        ("[[boards]]\nserial = 'FT1'\n", "a board has 256 channels: correct the description"),
    ],
)
def test_descriptions_that_do_not_fit(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "device.toml"
    file.write_text(text)
    it = Setup(serials=[], description=str(file))
    it.array = pc.DeviceDescription.load(file).array()
    with pytest.raises(pc.BackendError, match=message):
        it.open()


def test_the_examples_pins_are_where_the_boards_have_them() -> None:
    file = Path(__file__).parents[3] / "examples" / "devices" / "openmpd-four.toml"
    (order,) = {board.order for board in pc.DeviceDescription.load(file).boards}
    # of the top row the first and the last, then of the bottom row; and the top row's next ones
    assert [order[pin] for pin in (249, 58, 197, 7)] == [240, 255, 0, 15]
    assert [order[pin] for pin in (248, 251, 250, 185)] == [241, 242, 243, 244]
    assert order[253] == 224  # below the first


def test_no_library(monkeypatch: pytest.MonkeyPatch) -> None:
    import usb.core

    def find(**_: Any) -> Any:
        raise usb.core.NoBackendError("No backend available")

    monkeypatch.setattr(usb.core, "find", find)
    message = "openmpd: libusb is not installed: `apt install libusb-1.0-0`, or `pip install libusb-package`"
    it = Setup()
    it.refused(it.open, message)
    (found,) = OpenMpd.found()
    assert f"openmpd: {found.problem}" == message


def test_without_pyftdi_the_extra_is_named_and_the_chip_given_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "pyftdi.ftdi", None)
    it = Setup()
    with pytest.raises(pc.MissingExtra, match=r"pip install 'pacinian\[devices\]'"):
        it.open()
    assert (it.bus.open, it.chip.holder, it.chip.writes) == (0, None, [])


def test_errors_that_nobody_expected_say_what_was_being_done() -> None:
    told = explained(error(errno.EIO), "openmpd X", "sending")
    assert str(told).startswith("openmpd X: sending: ")
    assert "Input/Output Error" in str(told)


def test_what_is_connected_is_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    it = Setup("FT2", "FT1", "FT3", "")
    it.chips[2].denied = True
    find = __import__("usb.core").core.find
    monkeypatch.setattr("usb.core.find", lambda **given: find(**{**given, "backend": it.bus}))
    found = list(OpenMpd.found())
    assert [one.serial for one in found] == ["", "", "FT1", "FT2"]
    assert {found[0].problem, found[1].problem} == {UDEV, ANONYMOUS}
    title = "FT232H, an OpenMPD board or anything else, bus 1, address 3"
    assert found[2] == pc.Found("openmpd", "FT1", title)
    assert it.bus.open == 0
    assert not any(chip.requests for chip in it.chips)


@pytest.mark.parametrize(
    "options",
    [
        {"rate": 50.0},
        {"rate": 20_000.0},
        {"timeout": 0.0},
        {"led": (0, 0)},
        {"led": (0, 0, 256)},
        {"led": (0, 0, 1.5)},
        {"serials": "FT1,,FT2"},
        {"serials": ["A", "A"]},
    ],
)
def test_bad_settings_are_named(options: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=next(iter(options))):
        OpenMpd(**options)
