"""Progress: in a terminal without a notebook, by a clock that is told."""

import pytest

import pacinian as pc
from pacinian.notebook import bars, progress
from pacinian.testing import ManualClock


def test_a_terminal_gets_a_bar_on_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    with progress("a ball", 2.0) as on_tick:
        report = pc.Report()
        report.count_tick(1e-3, late=True)
        on_tick(report)
    told = capsys.readouterr()
    assert not told.out
    assert "a ball" in told.err
    assert "1 ticks, 1 late" in told.err


class Kept:
    def __init__(self, what: str, seconds: float) -> None:
        self.shown: list[tuple[float, str]] = []
        self.ended = 0
        KEPT.append(self)

    def show(self, done: float, state: str) -> None:
        self.shown.append((done, state))

    def end(self) -> None:
        self.ended += 1


KEPT: list[Kept] = []


@pytest.fixture
def kept(monkeypatch: pytest.MonkeyPatch) -> list[Kept]:
    monkeypatch.setattr(bars, "TerminalBar", Kept)
    KEPT.clear()
    return KEPT


def test_it_is_drawn_now_and_then_only(kept: list[Kept]) -> None:
    clock, report = ManualClock(), pc.Report()
    with progress("a ball", 2.0, clock.now) as on_tick:
        for _ in range(1999):
            clock.advance(1e-3)
            report.count_tick(1e-4, late=False)
            on_tick(report)
    (bar,) = kept
    assert 3 <= len(bar.shown) <= 5
    assert bar.shown[0][0] == pytest.approx(bars.REFRESH, abs=2e-3)
    assert bar.shown[-1] == (pytest.approx(1.999), "1999 ticks, 0 late")
    assert bar.ended == 1


def test_it_never_shows_more_than_there_is(kept: list[Kept]) -> None:
    clock = ManualClock()
    with progress("a ball", 1.0, clock.now):
        clock.advance(7.0)
    assert kept[0].shown[-1][0] == 1.0


def test_it_ends_where_the_run_does(kept: list[Kept]) -> None:
    clock = ManualClock()

    def run() -> None:
        with progress("a ball", 2.0, clock.now):
            clock.advance(0.3)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run()
    assert kept[0].shown == [(pytest.approx(0.3), "")]
    assert kept[0].ended == 1
