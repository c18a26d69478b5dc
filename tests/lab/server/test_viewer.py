"""`pacinian bench view`: a row for each kind of window, and in each what a page of that kind has."""

from __future__ import annotations

import shutil
from functools import partial

import pytest
from click.testing import CliRunner

from pacinian.cli.main import cli
from pacinian.serving.settings import Settings
from pacinian.testing.server import run_server
from pacinian_lab.server import viewer as view
from pacinian_lab.server import viewer_pages as pages
from pacinian_lab.server.viewer import measure

from ...viewing.conftest import SETTINGS
from ...viewing.watching import viewer
from ...waiting import eventually

LIMIT = 600.0  # [s] for a page with a slice, which is computed at nice 19: minutes beside busy processes
WINDOW = 5.0  # [s], in which even a browser that draws by a busy processor draws something


@pytest.mark.timeout(3.0 * LIMIT)
@pytest.mark.deep("npm", "chromium")
def test_all_kinds_of_windows_are_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(view, "SETTLE", 0.5)
    for module in (view, pages):
        monkeypatch.setattr(module, "LIMIT", LIMIT)
    monkeypatch.setattr(view, "Settings", partial(Settings, safety=SETTINGS.safety))
    monkeypatch.setattr(view, "HOW", ("closed", "slice"))  # a feed is a slice's without it
    rows = {row.how: row for row in measure(1, WINDOW, 1, shutil.which("chromium") or "")}
    assert list(rows) == ["closed", "slice", "browser", "alone"]
    for how, row in rows.items():
        assert (row.ticks is None) == (how == "alone")
        assert (row.viewer > 0.0) == (how != "closed")
        assert (row.frames > 0.0) == (row.browser > 0.0) == (how in ("browser", "alone"))
        assert (row.slices > 0.0) == (how in ("slice", "browser", "alone"))
        if row.ticks is not None:
            assert 0.0 < row.ticks.p50 <= row.ticks.p99
            assert 0.0 < row.ticks.sounding <= 1.0
            assert 0.0 <= row.ticks.late <= 1.0


def test_a_page_that_only_reads_gets_all() -> None:
    with (
        run_server(SETTINGS) as server,
        viewer(server.connection) as url,
        pages.Reader(url, sliced=False) as page,
    ):
        eventually(lambda: page.batches > 20)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--browser", "no-such-browser"), "is not a program"),
        (("--seconds", "1"), "2.0<=x"),
        (("--units", "2"), "1, 4, 9"),
    ],
)
def test_what_cannot_be_measured_is_refused_first(arguments: tuple[str, str], told: str) -> None:
    result = CliRunner().invoke(cli, ["bench", "view", *arguments])
    assert result.exit_code == 2
    assert told in result.output
