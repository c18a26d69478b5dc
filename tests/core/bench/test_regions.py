"""`pacinian bench regions`, on one shape."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner

from pacinian.bench.regions import OURS, SHAPES, SWEPT, pressures
from pacinian.cli.bench import bench


def test_a_disc_is_even_by_regions_and_not_by_far_foci() -> None:
    how = ["regions", "--units", "1", "--shape", "disc, 30 mm", "--strength", "0.5", "--json"]
    told = CliRunner().invoke(bench, how, catch_exceptions=False)
    rows = {row["way"]: row for row in json.loads(told.stdout)}
    assert len(rows) == 4
    ours = rows[OURS]
    assert ours["rms"] < 0.04 < rows["foci, 8.5 mm apart"]["rms"]
    assert ours["force"] == pytest.approx(1.0, abs=0.03)
    assert ours["status"] == "ok"
    assert rows[SWEPT]["force"] == pytest.approx(1.0, abs=0.01)


def test_as_a_table_and_with_what_does_not_exist() -> None:
    how = ["regions", "--units", "1", "--shape", "disc, 8 mm", "--strength", "0.25"]
    assert OURS in CliRunner().invoke(bench, how, catch_exceptions=False).output
    for wrong in (["--units", "2"], ["--shape", "nothing"]):
        assert CliRunner().invoke(bench, ["regions", *wrong]).exit_code == 2


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_is_looked_at_within_itself_and_beside(name: str) -> None:
    import pacinian as pc

    shape = SHAPES[name]()
    assert len(shape.places) == len(shape.asked) > 20
    samples = shape.samples(pc.autd())
    assert (samples.regions >= 0).all()
    if len(shape.beside):
        away = np.sqrt(((shape.beside[:, None] - shape.places) ** 2).sum(axis=2)).min(axis=1)
        assert 0.0029 < away.min() <= away.max() < 0.0101
    gains = np.ones((2, 249))
    one = pressures(pc.autd(), gains[0], shape.places)
    assert pressures(pc.autd(), gains, shape.places) == pytest.approx(one)
