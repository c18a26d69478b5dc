"""Rows there and back."""

import dataclasses
import json
import math
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian_lab.solvers.rows import COLUMNS, Row, Writer, plain, read, row

NUMBERS = st.floats(allow_infinity=False)
ROWS = st.builds(
    Row,
    family=st.sampled_from(["pacinian", "autd3"]),
    solver=st.text(st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"]), max_size=9),
    mode=st.sampled_from(["cold", "warm"]),
    threads=st.integers(1, 64),
    units=st.integers(1, 9),
    N=st.integers(1, 9999),
    M=st.integers(1, 9999),
    level=st.floats(0.1, 2.0),
    seed=st.integers(0, 9),
    status=st.sampled_from(["ok", 'failed: "a, b"\nc']),
    **dict.fromkeys(("p50", "p99", "error", "scale", "drive", "traced"), NUMBERS),
)


def same(a: Row, b: Row) -> bool:
    return repr(a) == repr(b)  # NaN included


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rows=st.lists(ROWS, max_size=5))
def test_csv_there_and_back(tmp_path: Path, rows: list[Row]) -> None:
    path = tmp_path / "rows.csv"
    with Writer(path) as writer:
        for one in rows:
            writer.write(one)
    assert all(map(same, read(path), rows))
    assert len(read(path)) == len(rows)


@given(one=ROWS)
def test_json_there_and_back(one: Row) -> None:
    text = json.dumps(plain(one), allow_nan=False)
    assert same(row(json.loads(text)), one)


def test_an_interrupted_file_keeps_what_was_written(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    writer = Writer(path)
    one = Row("pacinian", "auto", "cold", 1, 1, 249, 4, 0.5, 0, p50=0.25)
    writer.write(one)
    assert same(read(path)[0], one)  # still open
    writer.__exit__(None, None, None)


def test_only_what_was_measured_is_ok() -> None:
    one = Row("autd3", "autd3-gs", "cold", 1, 1, 249, 4, 0.5, 0)
    assert one.ok
    assert math.isnan(one.p50)
    assert not dataclasses.replace(one, status="timed out after 1 s").ok
    assert COLUMNS[:2] == ["family", "solver"]


@pytest.mark.parametrize("text", [None, "a,b\n1,2\n", ",".join(COLUMNS) + "\n1,2,3\n"])
def test_another_file_is_refused(tmp_path: Path, text: str | None) -> None:
    path = tmp_path / "rows.csv"
    if text is not None:
        path.write_text(text)
    with pytest.raises(pc.RecordingError, match=r"rows\.csv"):
        read(path)
