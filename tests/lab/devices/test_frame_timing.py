"""`pacinian bench devices`."""

from __future__ import annotations

import json
from importlib.metadata import EntryPoint

import pytest
from click.testing import CliRunner

import pacinian as pc
from pacinian.plugins import registry
from pacinian_lab.commands.bench_devices import devices


@pytest.fixture(autouse=True)
def found(monkeypatch: pytest.MonkeyPatch) -> None:
    """As installed."""
    points = [EntryPoint("usb-autd", "pacinian_plugins.backends.usb_autd", "pacinian")]
    plugins = pc.Plugins(points)
    monkeypatch.setattr(registry, "discover_plugins", lambda: plugins)


def test_what_it_measures_adds_up() -> None:
    done = CliRunner().invoke(devices, ["--seconds", "0.1", "--json"], catch_exceptions=False)
    found = json.loads(done.stdout)
    for load in found["loads"]:
        assert load["size"] > load["units"] * load["rows"] * 249 * 3
        assert load["rate"] == pytest.approx(1000 * load["size"])
    nine = found["loads"][-2]
    assert (nine["units"], nine["rows"], nine["size"]) == (9, 2, 13506)
    assert nine["high"] < 0.3
    assert nine["full"] > 1.0
    for held, rate in zip(found["rates"], (2000.0, 1000.0), strict=True):
        assert held["rate"] == rate
        assert held["accepted"] == held["frames"]
        assert held["frames"] + held["missed"] == round(0.1 * rate)
        assert 0.0 < held["took"][0] <= held["took"][1] <= held["took"][2]
        assert held["pack"] > 0.0


@pytest.mark.parametrize("options", [[], ["--markdown"]])
def test_its_tables(options: list[str]) -> None:
    done = CliRunner().invoke(devices, ["--seconds", "0.05", *options], catch_exceptions=False)
    assert "13,506" in done.stdout
    assert "frames accepted" in done.stdout
