"""Rows as text."""

import csv
import dataclasses
import json
import math
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pacinian_lab.solvers.report import replace_non_finite
from pacinian_lab.solvers.rows import COLUMNS, Row, Writer

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


def read(path: Path) -> list[Row]:
    kinds = {"int": int, "float": float, "str": str}
    kind = {field.name: kinds[str(field.type)] for field in dataclasses.fields(Row)}
    with path.open(newline="", encoding="utf-8") as file:
        return [Row(**{k: kind[k](v) for k, v in row.items()}) for row in csv.DictReader(file)]


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
    text = json.dumps(replace_non_finite(dataclasses.asdict(one)), allow_nan=False)
    made = {k: math.nan if v is None else v for k, v in json.loads(text).items()}
    assert same(Row(**made), one)


def test_an_interrupted_file_keeps_what_was_written(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    writer = Writer(path)
    one = Row("pacinian", "auto", "cold", 1, 1, 249, 4, 0.5, 0, p50=0.25)
    writer.write(one)
    assert same(read(path)[0], one)  # still open
    writer.close()


def test_only_what_was_measured_is_ok() -> None:
    one = Row("autd3", "autd3-gs", "cold", 1, 1, 249, 4, 0.5, 0)
    assert one.ok
    assert math.isnan(one.p50)
    assert not dataclasses.replace(one, status="timed out after 1 s").ok
    assert COLUMNS[:2] == ["family", "solver"]
