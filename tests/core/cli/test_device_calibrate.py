"""`pacinian devices calibrate`: from the files of a scan to a calibration for the description."""

from __future__ import annotations

import io
import json
import re
import zipfile
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

import pacinian as pc
from pacinian.cli.main import cli
from pacinian.devices.calibration import write_calibration

if TYPE_CHECKING:
    from pathlib import Path

HEAD = "x,y,z,serial,channel,amplitude,phase\n"
DEVICE = """
[[boards]]
serial = "A"
layout = {{ type = "grid", columns = 6, rows = 5, pitch = 0.02 }}
gain = 0.7
dead = [3]
[[boards]]
serial = "B"
layout = {{ type = "grid", columns = 6, rows = 5, pitch = 0.02 }}
pose = {{ position = [0.13, 0.0, 0.0], rotation = [0.0, 0.0, 0.707107, 0.707107] }}
order = {order}
"""


class Bench:
    """Two boards that differ from their description, and readings of a microphone, (M, 60), board by board."""

    def __init__(self, folder: Path) -> None:
        rng = np.random.default_rng(11)
        self.folder, self.file = folder, folder / "device.toml"
        self.file.write_text(DEVICE.format(order=rng.permutation(30).tolist()), encoding="utf-8")
        described = pc.DeviceDescription.load(self.file)
        boards = [
            board.pose.points(board.layout.positions())[board.drives] for board in described.boards
        ]
        self.ideal = pc.Array(
            np.concatenate(boards), transducer=pc.T4010A1
        )  # in the order of channels
        self.truth = rng.uniform(0.6, 1.2, 60) * np.exp(0.4j * rng.normal(size=60))
        self.truth[[8, 50]] = 0.0
        self.truth[[9, 40]] *= -1.0
        self.q = rng.uniform([-0.05, -0.06, 0.15], [0.18, 0.06, 0.35], (10, 3))
        air = pc.Air(temperature=25.0, attenuation="absorbing")
        self.X = 0.3j * pc.matrix(self.ideal, self.q, air) * self.truth
        self.X += 0.05 * (rng.normal(size=(10, 60)) + 1j * rng.normal(size=(10, 60)))

    def rows(self) -> list[str]:
        return [
            f"{x:.5f},{y:.5f},{z:.5f},{'AB'[c // 30]},{c % 30},{abs(v):.5g},{np.angle(v):.5f}\n"
            for (x, y, z), row in zip(self.q, self.X, strict=True)
            for c, v in enumerate(row)
        ]

    def csv(self, text: str | bytes | None = None) -> Path:
        path = self.folder / "scan.csv"
        given = HEAD + "".join(self.rows()) if text is None else text
        path.write_bytes(given if isinstance(given, bytes) else given.encode())
        return path

    def npz(self, **changes: Any) -> Path:
        G = np.exp(2j * np.pi * np.outer(np.arange(64), np.arange(60)) / 64)
        parts: dict[str, Any] = {"positions": self.q, "drives": G, "readings": G @ self.X.T}
        path = self.folder / "scan.npz"
        np.savez(path, **{k: v for k, v in (parts | changes).items() if v is not None})
        return path

    def hdf5(self, units: bool = True, **changes: Any) -> Path:
        path = self.folder / "scan.h5"
        parts: dict[str, Any] = {"positions": 1e3 * self.q, "readings": 1e3 * self.X} | changes
        with h5py.File(path, "w") as file:
            for name, value in parts.items():
                if isinstance(value, h5py.ExternalLink):
                    file[name] = value
                else:
                    file.create_dataset(name, data=value)
            if units:
                file["positions"].attrs["units"] = "mm"
                file["readings"].attrs["units"] = np.bytes_("mPa")
        return path

    def found(self, out: Path) -> Any:
        """Return the responses by channel that a description reads from a calibration."""
        text = f"calibration = {json.dumps(str(out))}\n" + self.file.read_text().replace(
            "dead", "#"
        )
        (self.folder / "calibrated.toml").write_text(text)
        device = pc.DeviceDescription.load(self.folder / "calibrated.toml")
        return np.concatenate([board.responses for board in device.boards])


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return Bench(tmp_path)


def run(*words: object) -> tuple[int, str]:
    done = CliRunner().invoke(cli, ["devices", *map(str, words)])
    if isinstance(done.exception, pc.PacinianError):
        return 2, str(done.exception)
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.exit_code, done.output


@pytest.mark.parametrize("kind", ["csv", "npz", "npz alone", "hdf5", "two files", "shuffled"])
def test_a_scan_becomes_a_calibration(bench: Bench, kind: str) -> None:
    scans = [bench.npz() if kind == "npz" else bench.csv()]
    if kind == "npz alone":
        scans = [bench.npz(drives=None, readings=bench.X)]
    elif kind == "hdf5":
        scans = [bench.hdf5()]
        assert (
            "P0 is 1.1" in run("calibrate", bench.file, *scans, "--out", bench.folder / "b.csv")[1]
        )
    elif kind == "two files":
        rows = bench.rows()
        scans = [bench.csv(HEAD + "".join(rows[:240])), bench.folder / "b.csv"]
        scans[1].write_text(HEAD + "\n".join(rows[240:]))
    elif kind == "shuffled":
        scans = [bench.csv("\ufeff" + HEAD.replace(",", " , ") + "\r\n".join(sorted(bench.rows())))]
    out = bench.folder / "out.csv"
    code, told = run("calibrate", bench.file, *scans, "--out", out)
    assert code == 0, told
    assert re.search("dead: 2: A 8, B 20", told)
    assert re.search("reversed: 2: A 9, B 10", told)
    assert re.search("air: 346.* 2[56] degC", told)
    alive = np.abs(bench.truth) > 0.0
    found = bench.found(out)
    assert (found[~alive] == 0.0).all()
    z = found[alive] / bench.truth[alive]
    np.testing.assert_allclose(z / z.mean(), 1.0, atol=0.06)
    code, told = run("check", bench.folder / "calibrated.toml", "--offline")
    assert "60 channels measured" in told


def split(bench: Bench, factor: complex, places: Any, channels: Any = slice(None)) -> list[Path]:
    """Write two files, of which the second has readings at `places` of `channels`, times `factor`."""
    second = np.zeros(bench.X.shape, bool)
    second[places, channels] = True
    bench.X[second] *= factor
    files = [bench.folder / "a.csv", bench.folder / "b.csv"]
    for path, part in zip(files, (~second, second), strict=True):
        rows = [row for row, here in zip(bench.rows(), part.ravel(), strict=True) if here]
        path.write_text(HEAD + "".join(rows))
    return files


def test_files_may_differ_in_gain_and_phase_of_the_microphone(bench: Bench) -> None:
    out = bench.folder / "out.csv"
    files = split(bench, 1.5 * np.exp(2j), slice(5, None))
    code, told = run("calibrate", bench.file, *files, "--out", out)
    assert code == 0, told
    assert re.search(
        r"warning +files: b.csv has 1.5 times the gain of a.csv \(\+- 0.[0-9]%\), and leads by 1[0-9][0-9] \+- "
        r"[0-9]+ deg\n.*nothing to do.*P0 has the gain of a.csv",
        told,
    ), told
    assert "ok       fit" in told
    alive = np.abs(bench.truth) > 0.0
    z = bench.found(out)[alive] / bench.truth[alive]
    np.testing.assert_allclose(z / z.mean(), 1.0, atol=0.06)
    made = json.loads(run("calibrate", bench.file, *files, "--out", out, "--json")[1])
    first, second = made["files"]
    assert first == {
        "file": str(files[0]),
        "gain": 1.0,
        "phase": 0.0,
        "gain_error": 0.0,
        "phase_error": 0.0,
    }
    assert second["gain"] == pytest.approx(1.5, abs=4.0 * second["gain_error"])
    assert second["phase"] == pytest.approx(2.0, abs=4.0 * second["phase_error"])
    assert made["pressure"] == pytest.approx(0.3 * 4.386 * np.abs(bench.truth).sum() / 58, rel=0.02)


def test_files_that_do_not_differ_are_told_to_be_alike(bench: Bench) -> None:
    files = split(bench, 1.0, slice(5, None))
    _, told = run("calibrate", bench.file, *files, "--out", bench.folder / "out.csv")
    assert re.search(
        r"ok +files: b.csv has (0.99[0-9]|1|1.0[01]*) times the gain of a.csv", told
    ), told


def test_files_of_different_channels_cannot_be_compared(bench: Bench) -> None:
    files = split(bench, 1.0, slice(None), slice(30, None))
    out = bench.folder / "out.csv"
    code, told = run("calibrate", bench.file, *files, "--out", out)
    assert code == 0, told
    assert re.search(
        r"warning +files that cannot be compared: .*a.csv with b.csv\n.*must be the same", told
    ), told
    made = json.loads(run("calibrate", bench.file, *files, "--out", out, "--json")[1])
    assert made["files"][1]["gain_error"] is None


def test_a_gain_that_changes_within_a_file_is_a_large_residual(bench: Bench) -> None:
    bench.X[5:] *= 1.5
    code, told = run("calibrate", bench.file, bench.csv(), "--out", bench.folder / "out.csv")
    assert code == 0
    assert re.search(r"warning +fit: [12][0-9].*\n.*gain.*within a file", told), told


@pytest.mark.parametrize("degrees", ["70", "-30", "nan", "warm"])
def test_a_temperature_that_cannot_be_is_told_by_its_option(bench: Bench, degrees: str) -> None:
    code, told = run("calibrate", bench.file, bench.csv(), "--temperature", degrees)
    assert code == 2
    assert "'--temperature'" in told


def test_it_can_be_read_by_programs_and_the_temperature_given(bench: Bench) -> None:
    out = bench.folder / "out.csv"
    code, told = run(
        "calibrate", bench.file, bench.csv(), "--out", out, "--json", "--temperature", 25
    )
    made = json.loads(told)
    assert code == 0
    assert len(made["channels"]) == 60
    alive = [one for one in made["channels"] if one["gain"]]
    assert all(0.0 < one[f"{part}_error"] < 0.1 for one in alive for part in ("gain", "phase"))
    assert {f["name"] for f in made["findings"]} >= {
        "fit",
        "air",
        "pose",
        "phase",
        "strength",
        "dead",
    }
    assert made["speed_error"] < 1e-6
    assert np.abs(made["pose"]["position"]).max() < 4.0 * max(made["pose_errors"][:3])
    assert made["pressure"] == pytest.approx(0.3 * 4.386 * np.abs(bench.truth).sum() / 58, rel=0.02)
    assert made["pressure_error"] > 0.1  # due to the microphone


@pytest.mark.parametrize(
    ("unit", "told"),
    [
        ("[Pa]", "P0 is 1.1.* Pa m, give or take 10%.*\n.*set pressure = 1.1"),
        ("[mPa]", "warning +strength.*times the described.*\n.*unit of the readings"),
        ("(V)", "P0 is 1.1.* V m.*\n.*pascal"),
        ("", "P0 is 1.1.* units m.*\n.*pascal"),
    ],
)
def test_p0_is_told_in_the_unit_of_the_readings(bench: Bench, unit: str, told: str) -> None:
    head = HEAD.replace("amplitude", f"amplitude {unit}").replace("phase", "phase [deg]")
    head = head.replace("x,y", "x [mm],y [m]")
    rows = [row.strip().split(",") for row in bench.rows()]
    text = "".join(
        ",".join([f"{1e3 * float(x)}", *rest, f"{np.degrees(float(phase))}"]) + "\n"
        for x, *rest, phase in rows
    )
    code, said = run(
        "calibrate", bench.file, bench.csv(head + text), "--out", bench.folder / "o.csv"
    )
    assert code == 0, said
    assert re.search(told, said), said


def test_a_calibration_s_errors_are_the_description_s(bench: Bench) -> None:
    """From the scan to a band: the errors of each transducer, in the order of the array."""
    out = bench.folder / "out.csv"
    run("calibrate", bench.file, bench.csv(), "--out", out)
    bench.found(out)
    device = pc.DeviceDescription.load(bench.folder / "calibrated.toml")
    unsure, array = device.uncertainty(temperature=2.0), device.array()
    rows = {tuple(r[:2]): r[2:] for r in (line.split(",") for line in out.read_text().split()[1:])}
    for wiring in device.wiring:
        for channel, index in zip(wiring.channels, wiring.indices, strict=True):
            errors = rows[wiring.serial, str(channel)][2:]
            assert (unsure.gain[index], unsure.phase[index]) == pytest.approx([*map(float, errors)])  # type: ignore[index]
    assert (unsure.pressure, unsure.temperature, len(unsure.gain)) == (0.3, 2.0, len(array))  # type: ignore[arg-type]
    described = pc.DeviceDescription.load(bench.file).uncertainty()
    assert set(described.gain) == {0.1}  # type: ignore[arg-type]
    assert set(described.phase) == {0.35}  # type: ignore[arg-type]


def test_what_was_not_scanned_is_left_as_described_and_told(bench: Bench) -> None:
    rows = [row for row in bench.rows() if ",A,5," not in row]
    out = bench.folder / "out.csv"
    code, told = run("calibrate", bench.file, bench.csv(HEAD + "".join(rows)), "--out", out)
    assert code == 0
    assert "unseen: 1: A 5" in told
    assert abs(bench.found(out)[5]) == 0.7  # as in the description
    assert (
        "59 channels measured, not: A 5"
        in run("check", bench.folder / "calibrated.toml", "--offline")[1]
    )


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "line 1: must be x,y,z,serial,channel,amplitude,phase"),
        (HEAD, "no reading"),
        ("x,y,z,serial,channel,amplitude\n0,0,0.2,A,0,1\n", "no phases.*lock-in"),
        (HEAD + "0,0,0.2,A,0,1,0\n0,0,0.2,A,1,1,0\n", "all phases are equal.*lock-in"),
        (HEAD + "0,0,0.2,A,0,1\n", "line 2: must have 7 values, not 6"),
        (HEAD + "0,0,0.2,A,0,1,0.1\n\n0,0,0.2,A,zero,1,0\n", "line 4: must be numbers"),
        (HEAD + "0,0,0.2,A,1.5,1,0\n", "line 2.*`channel`.*whole"),
        (HEAD + "0,0,0.2,A,-1,1,0\n", "line 2.*`channel`"),
        (HEAD + "0,0,0.2,A,30,1,0\n", "line 2.*channels 0 to 29"),
        (HEAD + "0,0,0.2,C,0,1,0\n", "line 2.*no board is 'C'; there are 'A', 'B'"),
        (HEAD + "0,nan,0.2,A,0,1,0\n", "line 2.*`y`.*finite"),
        (HEAD + "0,0,0.2,A,0,inf,0\n", "line 2.*`amplitude`.*finite"),
        (HEAD + "0,0,0.2,A,0,1e300,0\n", "line 2.*`amplitude`"),
        (HEAD + "0,0,0.2,A,0,-1,0\n", "line 2.*`amplitude`"),
        (HEAD + "0,0,0.2,A,0,1,90\n", "line 2.*`phase`.*degrees"),
        (HEAD + "0,0,0.2,A,0,1,0\n0,0,0.2,A,0,1,1\n", "line 3.*again"),
        (
            HEAD + "0,0,0.2,A,0,1,0\n0,0,0.2,A,1,1,1\n",
            "`positions` must be 6.*not determine the speed",
        ),
        (HEAD.replace("x,", "x [inch],"), "line 1.*`x` in 'inch'; there are m, cm"),
        (HEAD.replace("amplitude", "amplitude [dB]"), "line 1.*`amplitude` in 'dB'; there are Pa"),
        (
            HEAD + "".join(f"0,0,{0.2 + 0.02 * i},A,{i},1,{i % 3}\n" for i in range(9)),
            "fewer|18 numbers for .* unknowns.*distinguished",
        ),
        (HEAD + "0,0,200,A,0,1,0\n0,0,200,A,1,1,1\n", "millimetres"),
        (HEAD + "".join(f"0,0,{i},A,0,1,{i % 3}\n" for i in range(1001)), "line 1002.*1000"),
        ("\xff\xfe" + HEAD, "not CSV|line 1"),
        (HEAD + "0,0,0.2,A\x00,0,1,0\n", "not CSV|no board"),
    ],
)
def test_a_csv_that_is_wrong_is_told_with_its_line(bench: Bench, text: str, told: str) -> None:
    out = bench.folder / "out.csv"
    code, said = run("calibrate", bench.file, bench.csv(text.encode("latin-1")), "--out", out)
    assert code == 2
    assert re.search(told, said), said
    assert not out.exists()


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"positions": None}, "lacks positions"),
        ({"drives": None}, r"readings.*\(K, 60\)"),
        ({"drives": None, "readings": np.ones((9, 60)) + 0j}, "must be of 10 positions, not 9"),
        (
            {"drives": None, "readings": np.eye(10, 60) + 1j, "positions": np.zeros((10, 3))},
            "0 0 0 m twice, and 60 channels.*average",
        ),
        ({"drives": np.eye(59) + 0j}, r"drives.*\(K, 60\)"),
        ({"drives": np.ones((64, 60)) + 0j}, "distinguish the 60 channels.*Hadamard"),
        ({"drives": np.eye(60) + 0j}, "readings.*60 patterns"),
        ({"drives": np.full((64, 60), np.nan)}, "drives.*finite"),
        ({"readings": np.ones((64, 10))}, "no phases"),
        ({"readings": np.ones((64, 9)) + 0j}, r"readings.*\(K, 10\)"),
        ({"readings": np.ones(()) + 0j}, "readings"),
        ({"positions": np.ones((10, 2))}, "positions.*shape"),
        ({"positions": np.array([{"x": 1}] * 10, dtype=object)}, "not NPZ"),
        ({"positions": np.array(["a"] * 10)}, "positions"),
    ],
)
def test_an_npz_that_is_wrong_is_told(bench: Bench, changes: dict[str, Any], told: str) -> None:
    code, said = run("calibrate", bench.file, bench.npz(**changes), "--out", bench.folder / "o.csv")
    assert code == 2
    assert re.search(told, said), said


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"positions": h5py.ExternalLink("other.h5", "x")}, "not a link"),
        ({"readings": np.ones((10, 60))}, "no phases"),
        ({"readings": h5py.Empty("c16")}, "readings.*shape"),
        ({"positions": np.ones((10, 2))}, "positions.*shape"),
        ({"readings": np.full((10, 60), np.inf + 1j)}, "readings.*finite"),
    ],
)
def test_an_hdf5_that_is_wrong_is_told(bench: Bench, changes: dict[str, Any], told: str) -> None:
    path = bench.hdf5(units=False, **changes)
    code, said = run("calibrate", bench.file, path, "--out", bench.folder / "o.csv")
    assert code == 2
    assert re.search(told, said), said


def test_hdf5_by_matlab_and_units_that_are_none(bench: Bench) -> None:
    made = np.empty(bench.X.shape, [("real", "f8"), ("imag", "f8")])
    made["real"], made["imag"] = 1e3 * bench.X.real, 1e3 * bench.X.imag
    path = bench.hdf5(readings=made)
    assert run("calibrate", bench.file, path, "--out", bench.folder / "o.csv")[0] == 0
    with h5py.File(path, "a") as file:
        file["positions"].attrs["units"] = "furlong"
    assert "in 'furlong'; there are m, cm" in run("calibrate", bench.file, path)[1]
    path.write_bytes(b"nothing")
    assert "is not HDF5" in run("calibrate", bench.file, path)[1]


def test_bombs_and_files_that_are_none_are_refused(bench: Bench, monkeypatch: Any) -> None:
    path = bench.folder / "scan.npz"
    claim = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        claim, {"descr": "<c16", "fortran_order": False, "shape": (1 << 40, 1 << 10)}
    )
    with zipfile.ZipFile(path, "w") as file:
        for name in ("positions", "drives", "readings"):
            file.writestr(f"{name}.npy", claim.getvalue())
    assert "is not NPZ" in run("calibrate", bench.file, path)[1]
    path.write_bytes(b"nothing")
    assert "is not NPZ" in run("calibrate", bench.file, path)[1]
    monkeypatch.setattr("pacinian.devices.scan.MAX_ARRAY_BYTES", 1000)
    assert "is larger" in run("calibrate", bench.file, bench.hdf5())[1]
    assert "is larger" in run("calibrate", bench.file, bench.npz())[1]
    monkeypatch.setattr("pacinian.devices.scan.MAX_BYTES", 1000)
    assert "is larger" in run("calibrate", bench.file, bench.csv())[1]
    assert "not a file" in run("calibrate", bench.file, "/dev/zero.csv")[1]
    (bench.folder / "d.csv").mkdir()
    assert "not a file" in run("calibrate", bench.file, bench.folder / "d.csv")[1]
    assert "must end in" in run("calibrate", bench.file, "/dev/zero")[1]


def test_nothing_that_was_read_is_overwritten(bench: Bench) -> None:
    scan = bench.csv()
    for out in (
        scan,
        bench.file,
        bench.folder / "out.txt",
        bench.folder / ".." / bench.folder.name / "scan.csv",
    ):
        code, told = run("calibrate", bench.file, scan, "--out", out)
        assert code == 2
        assert "none of the input files" in told
    assert run("calibrate", bench.file, "--out", "o.csv")[0] == 2  # not a scan
    assert (
        "existing folder"
        in run("calibrate", bench.file, scan, "--out", bench.folder / "no" / "o.csv")[1]
    )
    assert "twice" in run("calibrate", bench.file, scan, scan, "--out", bench.folder / "o.csv")[1]


def test_a_pose_that_is_wrong_by_more_than_is_said_is_refused(bench: Bench) -> None:
    bench.q += [0.006, 0.0, 0.0]
    out = bench.folder / "o.csv"
    code, told = run("calibrate", bench.file, bench.csv(), "--out", out)
    assert code == 1
    assert re.search("problem +pose: off by [5-7].*\n.*--shift-error", told), told
    assert re.search("standard errors: the scan shows .*[2-9][.].* times --shift-error", told), told
    assert re.search("o.csv: not written, because the scan contradicts .*device.toml", told), told
    assert not out.exists()
    made = json.loads(run("calibrate", bench.file, bench.csv(), "--out", out, "--json")[1])
    assert made["out"] is None
    assert made["widened"]["shift"] > 2.0
    assert not out.exists()
    wide = ("--shift-error", "0.006", "--turn-error", "0.01")
    code, told = run("calibrate", bench.file, bench.csv(), "--out", out, *wide)
    assert code == 0, told
    assert "problem" not in told.replace("no problem found", "")
    assert "--shift-error" not in told
    assert out.exists()


@pytest.mark.parametrize("wide", [(), ("--shift-error", "0.01", "--turn-error", "0.05")])
def test_another_order_of_the_channels_is_refused(tmp_path: Path, wide: tuple[str, ...]) -> None:
    """Channels are shifted by one. A shift of the array explains this, except at the ends of rows."""
    file, scan, out = tmp_path / "device.toml", tmp_path / "scan.npz", tmp_path / "o.csv"
    layout = '{ type = "grid", columns = 8, rows = 8, pitch = 0.01 }'
    file.write_text(f"[[boards]]\nlayout = {layout}\n", encoding="utf-8")
    rng = np.random.default_rng(1)
    q = rng.uniform([-0.08, -0.07, 0.15], [0.08, 0.07, 0.35], (8, 3))
    array = pc.DeviceDescription.load(file).array()
    X = pc.matrix(array, q, pc.Air()) * np.exp(0.3j * rng.normal(size=64))
    X += 0.02 * np.abs(X).mean() * (rng.normal(size=X.shape) + 1j * rng.normal(size=X.shape))
    np.savez(scan, positions=q, readings=X)
    code, told = run("calibrate", file, scan, "--out", out, *wide)
    assert code == 0, told
    assert "channels that do not fit" not in told
    out.unlink()
    np.savez(scan, positions=q, readings=np.roll(X, 1, axis=1))
    code, told = run("calibrate", file, scan, "--out", out, *wide)
    assert code == 1
    assert re.search(
        r"problem +channels that do not fit: 8: 0, 8, 16.*\n.*order of the channels", told
    ), told
    assert not out.exists()


def test_two_channels_that_are_swapped_are_named(bench: Bench) -> None:
    bench.X[:, [14, 33]] = bench.X[:, [33, 14]]
    code, told = run("calibrate", bench.file, bench.csv(), "--out", bench.folder / "o.csv")
    assert code == 0
    assert re.search(
        "warning +channels that do not fit: 2: A 14, B 3\n.*leave their rows out", told
    ), told
    rows = [row for row in bench.rows() if ",A,14," not in row and ",B,3," not in row]
    told = run(
        "calibrate", bench.file, bench.csv(HEAD + "".join(rows)), "--out", bench.folder / "o.csv"
    )[1]
    assert "do not fit" not in told


def test_an_amplifier_at_its_limit_is_told(bench: Bench) -> None:
    _, told = run("calibrate", bench.file, bench.csv(), "--out", bench.folder / "o.csv")
    assert "clipped" not in told
    size = np.abs(bench.X)
    bench.X *= np.minimum(size, np.quantile(size, 0.9)) / size
    _, told = run("calibrate", bench.file, bench.csv(), "--out", bench.folder / "o.csv")
    assert re.search(
        "warning +clipped: 6[0-9] readings share the highest.*\n.*lower the gain", told
    ), told


def test_channels_in_another_order_are_suspected(bench: Bench) -> None:
    """Each reading is assigned to the next channel; a shift of the array explains a part of this."""
    rows = [row.split(",") for row in bench.rows()]
    assert (
        "outliers: "
        not in run("calibrate", bench.file, bench.csv(), "--out", bench.folder / "o.csv")[1]
    )
    for row in rows:
        row[4] = str(int(row[4]) + (int(row[4]) in (12, 13)) - 2 * (int(row[4]) == 14))
    text = HEAD + "".join(map(",".join, rows))
    code, told = run("calibrate", bench.file, bench.csv(text), "--out", bench.folder / "o.csv")
    assert "order of the channels" in told, told
    assert code == 2 or re.search("warnings: [1-9]", told), told


def test_a_microphone_that_stands_still_is_told(bench: Bench) -> None:
    """If its position is unknown, any readings fit some calibration."""
    q = bench.q[:1] + np.zeros((10, 1))
    X = np.tile(bench.X[:1], (10, 1))
    X += 0.05 * np.random.default_rng(1).normal(size=X.shape)
    G = np.eye(60) + 0j
    scan = bench.npz(positions=q, drives=G, readings=G @ X.T)
    code, told = run("calibrate", bench.file, scan, "--out", bench.folder / "o.csv")
    assert code == 2 or "standard error: above" in told, told


def test_a_calibration_that_cannot_be_written_leaves_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "c.csv"
    write_calibration(path, {("A", 0): (1.0, 0.5)})
    old = path.read_text()
    with pytest.raises(ZeroDivisionError):
        write_calibration(path, _Broken({("A", 0): (1.0, 0.5)}))
    assert path.read_text() == old
    assert list(tmp_path.iterdir()) == [path]


class _Broken(dict[Any, Any]):
    def items(self) -> Any:
        yield from super().items()
        raise ZeroDivisionError
