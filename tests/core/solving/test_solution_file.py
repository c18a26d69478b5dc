"""Solutions in files: what is read equals what was written; damaged and hostile files are refused."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import pacinian as pc

if TYPE_CHECKING:
    from pathlib import Path

ARRAY = pc.lattice(0.05, 0.05)
AIR = pc.Air(temperature=31.0, humidity=0.1, attenuation="absorbing")
POINTS = np.array([[0.01, 0.0, 0.1], [-0.01, 0.005, 0.11], [0.0, -0.01, 0.12]])


def solve(**given: Any) -> pc.Solution:
    array = given.pop("array", ARRAY)
    return pc.solve(array, POINTS, given.pop("amplitudes", [10.0, 20.0, 5.0]), medium=AIR, **given)


CASES: dict[str, Any] = {
    "plain": dict,
    "a Piston, with responses": lambda: {
        "array": pc.Array(
            ARRAY.positions,
            [0.0, 0.6, 0.8],
            pc.Transducer(directivity=pc.Piston(0.005, 730.0), pressure=3.0),
            np.exp(1j * np.arange(len(ARRAY))),
        )
    },
    "a table": lambda: {
        "array": pc.autd(transducer=pc.Transducer(directivity=pc.DirectivityTable.sample(pc.t4010a1)))
    },
    "the T4010A1": lambda: {"array": pc.autd()},
    "phases, as strong as possible": lambda: {"phases": [0.0, np.nan, 1.0], "scale": "max"},
    "regions": lambda: {"regions": [0, 0, -1]},
    "skin": lambda: {"facing": pc.SkinFacing([[0, 0, -1.0]] * 3, [[0, 0, 0.3, 0, 0.1, 0.3, 0.01, 0.02]])},
    "quiet and exact": lambda: {
        "solver": "lagrange",
        "limits": pc.Limits(power=20.0, quiet=([[0.0, 0.1, 0.1]], 1.0), exact=[0]),
    },
    "zones, no limit of a gain": lambda: {
        "limits": pc.Limits(gain=None, power=5.0, zones=(pc.Zone((0.0, 0.2, 0.2), pressure=0.5, radius=0.02),))
    },
    "double precision": lambda: {"precision": "double"},
    "silent": lambda: {"amplitudes": 0.0},
}  # fmt: skip


def same(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind in "fc")
    if isinstance(a, (pc.Array, pc.Targets, pc.Limits, pc.SkinFacing)):
        return all(same(getattr(a, f.name), getattr(b, f.name)) for f in dataclasses.fields(a))
    if isinstance(a, tuple) and type(a) is tuple:
        return len(a) == len(b) and all(map(same, a, b))
    return a == b or (isinstance(a, float) and math.isnan(a) and math.isnan(b))


@pytest.mark.parametrize("case", CASES)
def test_what_is_read_is_what_was_written(case: str, tmp_path: Path) -> None:
    solution = solve(**CASES[case]())
    solution.save(tmp_path / "it.solution")
    again = pc.Solution.load(tmp_path / "it.solution")
    for part in dataclasses.fields(solution):
        if part.name != "versions":
            assert same(getattr(solution, part.name), getattr(again, part.name)), part.name
    assert again.field(POINTS) == pytest.approx(solution.field(POINTS), rel=0, abs=0)
    assert again.versions["pacinian"]
    again.save(str(tmp_path / "again"))
    assert (tmp_path / "again").read_bytes() == (tmp_path / "it.solution").read_bytes()


def test_a_save_that_fails_leaves_the_earlier_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, before = tmp_path / "it.solution", solve()
    before.save(path)

    def fail(file: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", fail)
    with pytest.raises(
        pc.SolutionFileError, match=r"it\.solution: cannot be written: No space left"
    ):
        solve(amplitudes=1.0).save(path)
    assert same(pc.Solution.load(path).gains, before.gains)
    assert list(tmp_path.iterdir()) == [path]


def test_another_library_can_read_it(tmp_path: Path) -> None:
    import msgpack

    solution = solve()
    solution.save(tmp_path / "it")
    values = msgpack.unpackb((tmp_path / "it").read_bytes())
    gains = np.frombuffer(values["gains"]["data"], values["gains"]["kind"])
    assert np.array_equal(gains, solution.gains)
    assert values["medium"]["speed_of_sound"] == AIR.speed_of_sound


def test_a_directivity_that_is_a_function_is_refused_before_anything_is_written(
    tmp_path: Path,
) -> None:
    kind = pc.Transducer(directivity=lambda c: np.maximum(c, 0.0))
    solution = solve(array=pc.Array(ARRAY.positions, transducer=kind))
    with pytest.raises(pc.ArgumentError, match=r"DirectivityTable\.sample"):
        solution.save(tmp_path / "it")
    assert not (tmp_path / "it").exists()


@pytest.mark.parametrize("path", ["no/such/folder/it", ".", "a\0b"])
def test_paths_that_cannot_be_are_told(path: str) -> None:
    solution = solve()
    with pytest.raises(pc.SolutionFileError):
        solution.save(path)
    with pytest.raises(pc.SolutionFileError):
        pc.Solution.load(path)


def changed(values: dict[str, Any], name: str, value: Any) -> dict[str, Any]:
    *parts, last = name.split(".")
    inner = values
    for part in parts:
        inner = inner[part]
    if value is KeyError:
        del inner[last]
    else:
        inner[last] = value
    return values


def numbers(values: Any) -> dict[str, Any]:
    array = np.asarray(values)
    kind = {"f": "<f8", "c": "<c16", "i": "<i8", "b": "|b1"}[array.dtype.kind]
    return {"kind": kind, "shape": array.shape, "data": array.astype(kind).tobytes()}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("format", "pickle"),
        ("version", 2),
        ("version", "new"),
        ("gains", numbers(np.zeros(3, complex))),
        ("gains", numbers(np.full(36, np.nan + 0j))),
        ("gains", {"kind": "|O", "shape": [36], "data": b""}),
        ("gains", {"kind": "<c8", "shape": [10**9, 10**9], "data": b""}),
        ("gains", {"kind": "<c8", "shape": [-6, -6], "data": bytes(36 * 8)}),
        ("sound_pressure", numbers([1.0, 2.0, 3.0])),
        ("points", numbers([[0.0, 0.0, np.nan]] * 3)),
        ("points", numbers([[0.0, 0.0, 100.0]] * 3)),
        ("array.positions", numbers(np.empty((0, 3)))),
        ("array.positions", numbers([[np.inf, 0.0, 0.0]] * 36)),
        ("array.normals", numbers([[0.0, 0.0, 0.0]] * 36)),
        ("array.settings", {}),
        ("array.settings.transducer", {"frequency": -1.0, "pressure": 1.0, "directivity": "omni"}),
        ("array.settings.transducer", {"frequency": 4e4, "pressure": 1.0, "directivity": "eval"}),
        ("array.settings.response", b"123"),
        ("medium.humidity", 7.0),
        ("medium.density", KeyError),
        ("targets.amplitudes", numbers([-1.0, 1.0, 1.0])),
        ("targets.scale", "loud"),
        ("targets.regions", numbers([[1], [2], [3]])),
        ("limits.gain", math.nan),
        ("limits.exact", numbers([7])),
        ("limits.zones", [{"position": [0.0, 0.0, math.inf], "pressure": 1.0, "radius": 0.0}]),
        ("status", "great"),
        ("status", KeyError),
        ("gain_limit", -1.0),
        ("gain_limit", 1e-9),
        ("gains", numbers(np.full(36, 50.0 + 0j))),
        ("iterations", -5),
        ("seconds", math.nan),
        ("seconds", -1.0),
        ("quiet_weight", -1.0),
        ("quiet_weight", math.inf),
        ("least_error", -4.0),
        ("objective", -1.0),
        ("mu", -1.0),
        ("bound", math.inf),
        ("violations", {"quiet": math.nan}),
        ("felt", [[1.0, math.nan, 0.0, 0.0]]),
        ("multipliers", numbers(np.full(3, np.nan + 0j))),
        ("asked_phases", numbers([0.0, math.nan, 1.0])),
        ("multipliers", numbers(np.zeros(7, complex))),
        ("asked_phases", numbers([1.0])),
        ("felt", [[1.0]]),
        ("violations", {"quiet": "much"}),
        ("extra", 1),
    ],
)
def test_values_that_cannot_be_are_refused(name: str, value: Any, tmp_path: Path) -> None:
    file = tmp_path / "it"
    solve().save(file)
    values = msgspec.msgpack.decode(file.read_bytes())
    del values["digest"]
    file.write_bytes(msgspec.msgpack.encode(changed(values, name, value)))
    with pytest.raises(pc.SolutionFileError, match="it: ") as caught:
        pc.Solution.load(file)
    assert caught.value.path == file
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize(
    "data", [b"", b"\x80", b"\xc1", b"{}", b"\x93\x01\x02\x03", b"\x90" * 5000, b"PK\x03\x04"]
)
def test_other_files_are_refused(data: bytes, tmp_path: Path) -> None:
    (tmp_path / "it").write_bytes(data)
    with pytest.raises(pc.SolutionFileError):
        pc.Solution.load(tmp_path / "it")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=200)
@given(place=st.integers(0, 1 << 20), flip=st.integers(1, 255))
def test_no_changed_byte_goes_unseen(place: int, flip: int, tmp_path: Path) -> None:
    file = tmp_path / "it"
    if not (tmp_path / "whole").exists():
        solve(regions=[0, 0, -1]).save(tmp_path / "whole")
    raw = bytearray((tmp_path / "whole").read_bytes())
    raw[place % len(raw)] ^= flip
    file.write_bytes(bytes(raw))
    with pytest.raises(pc.SolutionFileError):
        pc.Solution.load(file)


def test_gains_above_their_limit_are_kept_if_the_solution_tells_it(tmp_path: Path) -> None:
    """A certificate is also for gains that break limits."""
    session = pc.Session(ARRAY, AIR)
    made = session.solve(POINTS, [10.0, 20.0, 5.0])
    broken = session.certify(np.full(len(ARRAY), 1.5 + 0j))
    assert broken.violations["gain"] == pytest.approx(0.5)
    broken.save(tmp_path / "it")
    assert pc.Solution.load(tmp_path / "it").violations == broken.violations
    with pytest.raises(pc.ArgumentError, match="gains"):
        dataclasses.replace(made, gains=broken.gains).save(tmp_path / "it")
    with pytest.raises(pc.ArgumentError, match="seconds"):
        dataclasses.replace(made, seconds=math.nan).save(tmp_path / "it")


def test_a_file_without_a_digest_is_read(tmp_path: Path) -> None:
    solution = solve()
    solution.save(tmp_path / "it")
    values = msgspec.msgpack.decode((tmp_path / "it").read_bytes())
    del values["digest"]
    (tmp_path / "it").write_bytes(msgspec.msgpack.encode(values))
    assert np.array_equal(pc.Solution.load(tmp_path / "it").gains, solution.gains)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=200)
@given(data=st.data())
def test_damaged_bytes_give_a_solution_or_an_error(data: Any, tmp_path: Path) -> None:
    file = tmp_path / "it"
    if not (tmp_path / "whole").exists():
        solve(regions=[0, 0, -1]).save(file)
        values = msgspec.msgpack.decode(file.read_bytes())
        del values["digest"]  # the values are checked, too
        (tmp_path / "whole").write_bytes(msgspec.msgpack.encode(values))
    raw = bytearray((tmp_path / "whole").read_bytes())
    for _ in range(data.draw(st.integers(0, 4))):
        raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    del raw[data.draw(st.integers(0, len(raw))) :]
    file.write_bytes(bytes(raw))
    try:
        solution = pc.Solution.load(file)
    except pc.SolutionFileError:
        return
    assert np.isfinite(solution.gains).all()
    repr(solution)
