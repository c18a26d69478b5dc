"""`pacinian bench footprint`: a row for each state, of each process its memory and its share."""

from __future__ import annotations

import json
from functools import partial

import pytest
from click.testing import CliRunner

from pacinian.cli.main import cli
from pacinian.serving.settings import Safety, Settings
from pacinian_lab.server import footprint


@pytest.mark.deep
def test_it_has_a_row_for_each_state(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(footprint, "SETTLE", 0.3)
    # A busy machine does not end sessions.
    patient = Safety(lease=10.0, session_timeout=60.0, hang_timeout=60.0)
    monkeypatch.setattr(footprint, "Settings", partial(Settings, safety=patient))
    arguments = ["--seconds", "1", "--rounds", "1", "--units", "1", "--json"]
    result = CliRunner().invoke(cli, ["bench", "footprint", *arguments], catch_exceptions=False)
    found = json.loads(result.output)
    assert found["units"] == 1
    assert [row["state"] for row in found["rows"]] == list(footprint.STATES)
    for row in found["rows"]:
        assert row["ready"] > 0.0
        assert row["calibration"] > 0.0
        assert set(row["memory"]) == set(row["cores"]) == set(row["wakeups"])
        assert set(row["memory"]) - {"spare"} == {"control", "guard", "bus", "render"}
        assert min(row["memory"].values()) > 1.0
        assert min(row["cores"].values()) >= 0.0
        # A server at rest may take less than the system's clock counts.
        assert row["state"] == "idle" or row["cores"]["render"] > 0.0
    idle, armed = (row["wakeups"] for row in found["rows"][:2])
    assert idle["render"] < armed["render"]  # a server at rest waits for an event
