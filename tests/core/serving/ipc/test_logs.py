from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest

from pacinian.serving.ipc.logs import MAX_EVENT_RATE, RateLimitedLog, _waiting, configure, log
from pacinian.serving.settings import Log
from pacinian.testing import ManualClock

if TYPE_CHECKING:
    from collections.abc import Callable

RUDE = "game\x1b[2J\x07\n2026 fault\u202e\x9b"


@pytest.fixture
def lines(capfd: pytest.CaptureFixture[str]) -> Callable[[], list[dict[str, Any]]]:
    """Return a function that returns the logged lines."""
    configure(Log("json", "info"), "test")

    def read() -> list[dict[str, Any]]:
        _waiting.join()
        return [json.loads(line) for line in capfd.readouterr().err.splitlines()]

    return read


@pytest.mark.parametrize("form", ["console", "json"])
def test_a_clients_name_controls_no_terminal(form: Any, capfd: Any) -> None:
    configure(Log(form, "info"), "test")
    log().warning("client told", message=RUDE)
    _waiting.join()
    text = capfd.readouterr().err
    assert text.count("\n") == 1
    assert text.rstrip("\n").isprintable()
    assert "game?[2J??2026 fault??" in text


def test_what_comes_often_is_logged_now_and_then(
    lines: Callable[[], list[dict[str, Any]]],
) -> None:
    clock = ManualClock(1.0)
    sparse, most = RateLimitedLog(clock.now), int(MAX_EVENT_RATE)
    for _ in range(2 * most):
        sparse.info("reset")
        try:
            raise ValueError("broken")
        except ValueError:
            sparse.exception("request failed", user="x")
    clock.advance(1.0)
    sparse.info("reset")
    seen = lines()
    assert [line["event"] for line in seen] == ["reset", "request failed"] * most + ["reset"]
    assert [line["level"] for line in seen[:2]] == ["info", "error"]
    assert "ValueError: broken" in seen[1]["exception"]
    assert seen[-1]["missed"] == most


@pytest.mark.parametrize("form", ["console", "json"])
def test_what_is_logged_is_bounded(form: Any, capfd: Any) -> None:
    """Texts of any length, and long chains of exceptions."""
    configure(Log(form, "info"), "test")
    error: Exception | None = None
    for _ in range(1000):
        cause, error = error, ValueError("x" * 100_000)
        error.__cause__ = cause
    try:
        raise RuntimeError("boom") from error
    except RuntimeError:
        log().exception("y" * 100_000, user="z" * 100_000)
    _waiting.join()
    text = capfd.readouterr().err
    assert len(text) < 5000
    assert "RuntimeError: boom" in text
    assert "ValueError: xxx" in text
