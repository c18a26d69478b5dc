"""What a decoder is told, and what it must make of it; and how the reference device and the C decoder are asked."""

from __future__ import annotations

import json
import struct
import subprocess
import zlib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian_plugins.backends.usb_autd import frames, protocol
from pacinian_plugins.backends.usb_autd.model import Device
from pacinian_plugins.backends.usb_autd.protocol import FULL, Request, Verdict
from pacinian_plugins.backends.usb_autd.report_layout import CapabilityReport

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian_plugins.backends.usb_autd.frames import Frame

FILE = Path(__file__).parent / "vectors.json"
SMALL = CapabilityReport(units=3, transducers=4, queue=8, samples=12, longest=256)
ONE_UNIT = CapabilityReport(units=1)

Step = list[Any]


def message(
    sequence: int = 1,
    session: int = 7,
    units: int = 0b111,
    rows: int = 1,
    lead: int = 2,
    steps: int | None = None,
    envelope: Sequence[int] | None = None,
    transducers: int = 4,
    level: tuple[int, int] | None = None,
    seed: int = 0,
) -> bytes:
    """A frame with random levels, or all of one."""
    random = np.random.default_rng([seed, sequence])
    shape = rows, units.bit_count() * transducers
    phase = random.integers(0, protocol.PHASES, shape, np.uint16)
    amplitude = random.integers(0, protocol.AMPLITUDES, shape, np.uint16)
    if level is not None:
        phase[-1, -1], amplitude[-1, -1] = level
    steps = rows if steps is None else steps
    samples = np.array([FULL] * steps if envelope is None else envelope, "<u2")
    out = bytearray(frames.size(*shape, len(samples)))
    head = session, sequence, units, lead, steps
    frames.pack(head, samples, phase, amplitude, memoryview(out))
    return bytes(out)


def altered(data: bytes, at: int, *value: int) -> bytes:
    """With other bytes at a place, and CRCs that are right again."""
    made = bytearray(data)
    made[at : at + len(value)] = bytes(value)
    check = zlib.crc32(made[:20])
    struct.pack_into("<I", made, 20, check)
    struct.pack_into("<I", made, len(made) - 4, zlib.crc32(made[24:-4], check))
    return bytes(made)


def unknown() -> bytes:
    """A message of a kind that a newer minor version has."""
    return altered(bytes(message())[:24] + b"newer" + bytes(4), 5, 2, 0, 0, 33)


def cut(data: bytes, end: int) -> bytes:
    """What is left of a write that was cut."""
    return data[:end]


def cases() -> dict[str, tuple[CapabilityReport, list[Step]]]:
    """By name: the device, and what it is told."""
    one, two, three = (message(sequence) for sequence in (1, 2, 3))
    feed = lambda *parts: [["feed", part] for part in parts]  # noqa: E731
    made: dict[str, list[Step]] = {
        "one frame": feed(one),
        "three in one write": feed(one + two + three),
        "byte by byte": feed(*(bytes([b]) for b in one + two)),
        "some rows, and an envelope that goes on": feed(
            message(1, rows=3, steps=5, envelope=[FULL, 7, 0, 1, FULL, 9000, 1])
        ),
        "one unit of three": feed(message(1, units=0b010)),
        "the largest that waits": feed(message(1, rows=8, lead=0)),
        "noise before and between": feed(b"\0\xa5\xa5U" + one + b"\xa5UAD noise" + two),
        "a short write: the next frame is found": feed(cut(one, 40), two, three),
        "cut in its header": feed(cut(one, 13), two),
        "cut in its magic": feed(cut(one, 2), two),
        "cut, then flushed": [*feed(cut(one, 40)), ["flush"], *feed(two)],
        "cut, then silenced": [*feed(cut(two, 40)), ["silence", 2], *feed(two, three)],
        "a wrong bit in a level": feed(_flipped(one, 60), two),
        "a wrong bit in the header": feed(_flipped(one, 9), two),
        "a wrong bit in the CRC": feed(_flipped(one, len(one) - 1), two),
        "a frame within a damaged frame": feed(_flipped(one, 61)[:50] + two + one[50:], three),
        "another major version": feed(altered(one, 4, 2), two),
        "flags of a newer minor version": feed(altered(one, 6, 1, 0)),
        "a kind of a newer minor version": feed(unknown(), one),
        "longer than the device takes": feed(altered(one, 8, 1, 1), two),
        "shorter than can be": feed(altered(one, 8, 27, 0), two),
        "length and content differ": feed(altered(one, 24 + 6, 2, 0), two),
        "no unit": feed(altered(one, 24, 0, 0), two),
        "a unit that is not there": feed(message(1, units=0b1001), two),
        "no row": feed(altered(one, 26, 0), two),
        "more rows than steps": feed(altered(message(1, rows=2), 28, 1, 0), two),
        "more than can wait": feed(message(1, lead=8), two),
        "fewer samples than steps": feed(message(1, steps=2, envelope=[FULL]), two),
        "more samples than fit": feed(message(1, envelope=[FULL] * 13), two),
        "an envelope above full": feed(message(1, envelope=[FULL + 1]), two),
        "a phase that is none": feed(message(1, level=(640, 0)), two),
        "an amplitude that is none": feed(message(1, level=(0, 320)), two),
        "the highest levels": feed(message(1, level=(639, 319))),
        "another session": feed(message(1, session=8), two),
        "not armed": [["disarm"], *feed(one)],
        "armed anew": [*feed(one, two), ["arm", 9], *feed(three, message(1, session=9))],
        "a frame again": feed(one, one, two),
        "frames are missing": feed(one, message(5)),
        "an older frame": feed(message(5), two),
        "the sequence begins anew": [
            ["silence", 0x7FFFFFFF], ["silence", 0xFFFFFFFE], *feed(message(0xFFFFFFFF), message(0))
        ],
        "silenced up to a number": [["silence", 2], *feed(one, two, three)],
    }  # fmt: skip
    small = {name: (SMALL, [["arm", 7], *steps]) for name, steps in made.items()}
    whole = message(1, units=1, rows=2, transducers=249, envelope=[FULL, FULL, 100])
    return {
        **small,
        "just attached": (SMALL, feed(one)),
        "an AUTD unit": (ONE_UNIT, [["arm", 7], *feed(whole)]),
    }


def _flipped(data: bytes, at: int) -> bytes:
    return data[:at] + bytes([data[at] ^ 4]) + data[at + 1 :]


def ask(can: CapabilityReport, steps: Sequence[Step]) -> tuple[list[list[int]], list[int]]:
    """The reference device's verdicts after each feed, and how it ends: as `check.c` prints it."""
    device = Device(replace(can), now=lambda: 0.0)
    frames: list[Frame] = []
    take = device._take
    device._take = lambda frame, now: [v := take(frame, now), v or frames.append(frame)][0]  # type: ignore[method-assign]
    verdicts: list[list[int]] = []
    for name, *value in steps:
        if name == "feed":
            device.history = []
            device.write(value[0])
            verdicts.append([int(v) for v in device.history])
        elif name == "arm":
            device.tell(Request.ARM, struct.pack("<IHH", value[0], 0, 0))
        elif name == "disarm":
            device.tell(Request.DISARM)
        else:
            data = struct.pack("<I", value[0]) if value else b""
            device.tell(Request.SILENCE, data)
    s = device.status()
    total = [s.accepted, s.refused, s.corrupt, s.skipped, s.lost & 0xFFFFFFFF, s.sequence]
    return verdicts, [*total, int(s.refusal), _sum(frames[-1:])]


def _sum(frames: Sequence[Frame]) -> int:
    made = 0
    for frame in frames:
        phase, amplitude = frame.levels()
        scaled = (amplitude.astype(np.int64) * int(frame.envelope[0]) + FULL // 2) // FULL
        for p, a in zip(phase.ravel().tolist(), scaled.ravel().tolist(), strict=True):
            made = (made * 31 + p * 4096 + a) & 0xFFFFFFFF
    return made


def script(can: CapabilityReport, steps: Sequence[Step]) -> str:
    """What `check.c` reads."""
    device = (
        can.units,
        can.transducers,
        can.phases,
        can.amplitudes,
        can.queue,
        can.samples,
        can.longest,
    )
    lines = [("device", *device)]
    for name, *value in steps:
        lines.append((name, *(v.hex() if isinstance(v, bytes) else v for v in value)))
    return "".join(" ".join(map(str, line)) + "\n" for line in [*lines, ("end",)])


def run(program: Path, scripts: str) -> list[str]:
    """What the C decoder says to it, by lines."""
    done = subprocess.run([program], input=scripts, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def vectors() -> dict[str, Any]:
    """All of it, as the file has it."""
    made: list[dict[str, Any]] = []
    names = "units", "transducers", "phases", "amplitudes", "queue", "samples", "longest"
    ends = "accepted", "refused", "corrupt", "skipped", "lost", "sequence", "refusal"
    for name, (can, steps) in cases().items():
        verdicts, end = ask(can, steps)
        told = iter(verdicts)
        plain = [
            {"feed": s[1].hex(), "verdicts": [Verdict(v).name for v in next(told)]}
            if s[0] == "feed"
            else {s[0]: s[1] if s[1:] else True}
            for s in steps
        ]
        made.append(
            {
                "name": name,
                "device": {key: getattr(can, key) for key in names},
                "steps": plain,
                "end": dict(zip(ends, end, strict=False)),
            }
        )
    return {"format": "usb-autd 1.0", "cases": made}


def text() -> str:
    """The file."""
    return json.dumps(vectors(), indent=1) + "\n"
