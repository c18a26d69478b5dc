"""The rules of `pacinian devices check`: pure functions from a description and connected devices to findings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.cli.doctor_rules import Finding, list_first

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from pacinian.devices.board import Board
    from pacinian.devices.description import DeviceDescription
    from pacinian.plugins.backend import Capability, FoundDevice

MIN_TRANSDUCER_SPACING = 0.008  # least plausible distance of transducers [m]
# Largest plausible ratio of a channel's strength to that of its kind, or inverse.
MAX_CHANNEL_STRENGTH_RATIO = 2.0
T4010A1_BAND = 39_000.0, 41_000.0  # band in which a T4010A1 is strong [Hz]


def check_description(device: DeviceDescription) -> list[Finding]:
    """Check the description alone."""
    array = device.array()
    size = " x ".join(f"{1e3 * s:.0f}" for s in np.ptp(array.positions, axis=0))
    count, boards = _count(len(array), "transducer"), _count(len(device.boards), "board")
    text = f"{count} on {boards}, {size} mm"
    found = [Finding("array", "ok", text)]
    found += [_check_board(board) for board in device.boards]
    found += [_check_spacing(device), _check_frequency(device)]
    return found


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _check_board(board: Board) -> Finding:
    L, size = board.layout.count, np.abs(board.responses)
    dead = np.setdiff1d(np.arange(L), board.alive)
    odd = board.alive[
        (size[board.alive] > MAX_CHANNEL_STRENGTH_RATIO)
        | (size[board.alive] < 1.0 / MAX_CHANNEL_STRENGTH_RATIO)
    ]
    text = _count(L, "channel")
    if len(dead):
        text += f", dead: {list_first(dead.tolist())}"
    if len(dead) != L and np.ptp(size[board.alive]):
        text += f", {size[board.alive].min():.2g} to {size[board.alive].max():.2g} times as strong"
    if len(odd):
        text += f", far from their kind: {list_first(odd.tolist())}"
        return Finding(_name(board), "warning", text, "measure them again, or list them as dead")
    return Finding(_name(board), "ok", text)


def _check_spacing(device: DeviceDescription) -> Finding:
    from scipy.spatial import KDTree

    owners: list[str] = []
    places = [board.pose.points(board.layout.positions()) for board in device.boards]
    for board in device.boards:
        owners += [_name(board)] * board.layout.count
    r = np.concatenate(places)
    pairs = KDTree(r).query_pairs(MIN_TRANSDUCER_SPACING)
    if not pairs:
        return Finding("places", "ok", f"none are nearer than {1e3 * MIN_TRANSDUCER_SPACING:g} mm")
    wrong = sorted({" and ".join(sorted({owners[i], owners[j]})) for i, j in pairs})
    nearest = min(float(np.linalg.norm(r[i] - r[j])) for i, j in pairs)
    text = f"transducers overlap, {1e3 * nearest:.1f} mm apart, on {list_first(wrong, '; ')}"
    return Finding("places", "problem", text, "correct the boards' poses and layouts")


def _check_frequency(device: DeviceDescription) -> Finding:
    f, text = device.transducer.frequency, f"{device.transducer.frequency / 1e3:g} kHz"
    if device.transducer.directivity == "t4010a1" and not T4010A1_BAND[0] <= f <= T4010A1_BAND[1]:
        return Finding("frequency", "warning", text, "a T4010A1 is made for 40 kHz")
    return Finding("frequency", "ok", text)


def check_calibration(device: DeviceDescription, measured: Collection[tuple[str, int]]) -> Finding:
    """Check that all live channels were measured. measured: serial and number of each measured channel."""
    left = [
        f"{board.serial} {c}".strip()
        for board in device.boards
        for c in board.alive.tolist()
        if (board.serial, c) not in measured
    ]
    if left:
        fix = "measure them with `pacinian devices calibrate`; until then the description applies"
        text = f"{len(measured)} channels measured, not: {list_first(left)}"
        return Finding("calibration", "warning", text, fix)
    return Finding("calibration", "ok", f"{len(measured)} channels measured")


def check_levels(device: DeviceDescription, can: Capability) -> Finding:
    """Check the described levels against those of the backend."""
    given = device.levels
    if given and (given.phases, given.amplitudes) != (can.phases, len(can.sizes)):
        what = f"described: {given.phases} and {given.amplitudes}; {device.backend} has {can}"
        return Finding("levels", "problem", what, "correct `levels`, or leave it out")
    return Finding("levels", "ok", str(can))


def check_connected(device: DeviceDescription, found: Iterable[FoundDevice]) -> list[Finding]:
    """Check that the described boards are connected, and no others."""
    ours = [f for f in found if device.backend in ("", f.backend)]
    here = [f for f in ours if f.title]
    blind = next((f for f in ours if not f.title), None)
    there = {f.serial: f for f in here}
    made: list[Finding] = []
    for board in device.boards:
        name, one = f"{_name(board)}, connected", there.get(board.serial)
        if not board.serial and len(here) == 1:
            one = here[0]
        if one is None and blind is not None:
            made.append(Finding(name, "problem", "search failed", blind.problem))
        elif one is None:
            others = list_first([f.serial or "one without a serial" for f in here]) or "none"
            fix = f"plug it in and switch it on, or correct its serial (connected: {others})"
            made.append(Finding(name, "problem", "not found", fix))
        elif one.problem:
            made.append(Finding(name, "problem", one.title, one.problem))
        else:
            made.append(Finding(name, "ok", one.title))
    serials = {board.serial for board in device.boards}
    spare = [f.serial for f in here if f.serial and f.serial not in serials]
    if spare and "" not in serials:
        fix = "describe them, or ignore this: they are not driven"
        made.append(Finding("others", "warning", f"not described: {list_first(spare)}", fix))
    return made


def _name(board: Board) -> str:
    return f"board {board.serial}" if board.serial else "board"
