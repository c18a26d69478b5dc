"""What the user can do to a running server in a real browser, by mouse and by keys alone."""

from __future__ import annotations

import functools
import time
from typing import TYPE_CHECKING, Any

import msgpack
import pytest

import pacinian as pc

from .browser import seen, status
from .conftest import CALM
from .conftest import CalmGame as Game
from .test_recorded import rendered
from .watching import LIMIT, viewer

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Browser, WebSocketRoute

    from pacinian.testing.server import Running

    from .browser import Seen

pytestmark = [
    pytest.mark.deep("npm", "chromium"),
    pytest.mark.usefixtures("patient"),
    pytest.mark.timeout(600.0),  # in all, they take long
]

SETTINGS = CALM  # of the server
REACHED = {
    "record", "arm", "stop", "solver", "backend", "technique", "intensity", "slice-on", "axis", "slice-at",
    "slice-mm", "slice-size", "slice-follow", "over", "law", "scale", "surface-on", "level", "home", "follow", "help",
    "canvas",
}  # fmt: skip
FOCUSED = """() => {
    const e = document.activeElement, s = getComputedStyle(e), track = e.closest("label") ?? e;
    const name = e.getAttribute("aria-label") || e.innerText || [...(e.labels ?? [])].map(l => l.innerText).join("");
    return [e.id || e.name || e.dataset.from || e.tagName.toLowerCase(), name.trim(),
            s.outlineStyle !== "none" && parseFloat(s.outlineWidth) >= 2];
}"""
# Return whether the page scrolls sideways, or the stop button is not in its first 120 pixels.
OUTSIDE = """() => {
    const { left, right, top, bottom } = document.getElementById("stop").getBoundingClientRect();
    return document.documentElement.scrollWidth > innerWidth
        || left < 0 || top < 0 || right > innerWidth || bottom > 120;
}"""
# Return the controls that a notice covers.
COVERED = """() => {
    const { top, bottom, left, right } = document.getElementById("refused").getBoundingClientRect();
    return [...document.querySelectorAll("button, select, input")].filter((e) => e.checkVisibility()
        && !e.closest("#refused, #panels")).filter((e) => {
        const r = e.getBoundingClientRect();
        return r.left < right && r.right > left && r.top < bottom && r.bottom > top; }).map((e) => e.id);
}"""
# Return the contrast of each text to its background, where that has one colour.
CONTRAST = """() => {
    const part = (x) => { x /= 255; return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4; };
    const light = ([r, g, b]) => 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
    const rgb = (text) => (text.match(/[0-9.]+/g) ?? []).map(Number);
    const ground = (e) => { for (; e; e = e.parentElement) {
        const c = rgb(getComputedStyle(e).backgroundColor); if (c.length === 3 || c[3] > 0.5) return c; }
        return [13, 17, 23]; };
    const poor = [];
    for (const e of document.querySelectorAll("body *")) {
        const own = [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
        if (!own || !e.checkVisibility() || e.closest(":disabled, .u-wrap, option")) continue;
        const [a, b] = [light(rgb(getComputedStyle(e).color)), light(ground(e))];
        const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
        if (ratio < 4.5) poor.push([e.outerHTML.slice(0, 80), ratio]);
    }
    return poor;
}"""


def test_a_solver_is_switched_and_the_server_follows(
    browser: Browser, url: str, server: Running
) -> None:
    now = functools.partial(status, server.connection)
    with seen(browser, url) as shown:
        shown.page.select_option("#solver", "gs-pat")
        shown.until(lambda: now().solver == "gs-pat")
        shown.page.fill("#intensity", "40")
        shown.page.select_option("#technique", "am")
        shown.until(lambda: (now().intensity, now().technique) == (0.4, "am"))
        shown.page.fill("#intensity", "100")
        shown.page.select_option("#technique", "simultaneous")
        shown.page.select_option("#solver", "auto")
        shown.until(lambda: (now().solver, now().intensity) == ("auto", 1.0))
        with Game(server.connection):
            shown.until(lambda: shown.text("#owner") == "game")
            shown.until(lambda: shown.page.is_disabled("#solver"))
            shown.until(lambda: "take over to change these" in shown.text("#drive-why"))
            assert shown.page.input_value("#solver") == "auto"
        shown.until(lambda: shown.page.is_enabled("#solver"))


def test_to_take_over_is_asked_first_and_given_back(
    browser: Browser, url: str, server: Running
) -> None:
    with seen(browser, url) as shown:
        page = shown.page
        assert "has not armed" in str(page.get_attribute("#disarm", "title"))
        with Game(server.connection) as game:
            shown.until(lambda: "Take over" in shown.text("#arm"))
            page.click("#arm")
            shown.until(lambda: "“game”" in shown.text("#take-title"))
            page.click("#take-no")
            assert not page.is_visible("#take")
            assert not game.refused
            page.select_option("#scene", "room") if page.is_visible("#scene") else None
            page.click("#arm")
            page.click("#take-yes")
            shown.until(lambda: shown.text("#owner") == "viewer")
            shown.until(lambda: "owner" in game.refused)
            shown.until(lambda: shown.text("#disarm") == "Give back")
            page.click("#disarm")
            shown.until(lambda: shown.text("#owner") == "nobody")
            with pc.Client(server.connection, name="other") as other:
                other.arm()
                shown.until(lambda: "“other”" in shown.text("#drive-why"))


def test_a_refusal_says_what_to_do_and_covers_nothing(browser: Browser, url: str) -> None:
    def between(route: WebSocketRoute) -> None:
        """Answer each `select` with a refusal."""
        server = route.connect_to_server()
        refused = {
            "type": "refused",
            "action": "select",
            "message": "it is not there",
            "advice": "",
        }

        def said(data: str | bytes) -> None:
            if msgpack.unpackb(data)["type"] == "select":  # type: ignore[arg-type]
                route.send(msgpack.packb(refused) or b"")
            else:
                server.send(data)

        route.on_message(said)

    with seen(browser, url, live=False) as shown:
        page = shown.page
        page.route_web_socket("**/feed*", between)
        page.reload()
        shown.until(lambda: page.is_enabled("#solver"))
        page.select_option("#solver", "gs")
        shown.until(lambda: "it is not there. Choose another one" in shown.text("#refused"))
        assert page.evaluate(COVERED) == []
        page.click("#refused button")
        assert not shown.text("#refused")


def test_a_page_without_a_game_plays_a_demonstration(
    browser: Browser, url: str, server: Running
) -> None:
    with seen(browser, url) as shown:
        page = shown.page
        page.click("#demonstrate")
        shown.until(lambda: shown.text("#owner") == "demonstration" and shown.get("hands") == 1)
        shown.until(lambda: "ball" in shown.text("#samples"))
        assert not page.is_visible("#empty")
        page.click("#demonstrated")
        shown.until(lambda: page.is_visible("#empty") and shown.text("#owner") == "nobody")
        page.click("#demonstrate")
        shown.until(lambda: shown.text("#owner") == "demonstration")
    end = time.monotonic() + LIMIT
    while status(server.connection).owner:  # until the viewer ends it
        assert time.monotonic() < end
        time.sleep(0.05)


def test_there_is_nothing_to_give_back_to_a_demonstration(browser: Browser, url: str) -> None:
    with seen(browser, url) as shown:
        page = shown.page
        page.click("#demonstrate")
        shown.until(lambda: shown.text("#owner") == "demonstration")
        shown.until(lambda: shown.text("#arm") == "Take over …")
        page.click("#arm")
        assert "“Disarm” ends that" in shown.text("#take-text")
        page.click("#take-yes")
        shown.until(lambda: page.is_enabled("#disarm"))
        assert shown.text("#disarm") == "Disarm"


def _tab(shown: Seen) -> dict[str, tuple[str, bool]]:
    """Return what the Tab key reaches: name for screen readers, and whether the focus is visible."""
    found: dict[str, tuple[str, bool]] = {}
    for _ in range(60):
        shown.page.keyboard.press("Tab")
        key, name, visible = shown.page.evaluate(FOCUSED)
        if key in found and key != "body":
            break
        found[key] = name, visible
    return found


def test_arm_stop_and_reset_by_keys_alone(browser: Browser, url: str, server: Running) -> None:
    now = functools.partial(status, server.connection)
    with seen(browser, url) as shown:
        page = shown.page
        shown.until(lambda: page.is_enabled("#arm") and page.is_enabled("#solver"))
        reached = _tab(shown)
        assert reached.keys() >= REACHED, REACHED - reached.keys()
        reached.pop("body", None)
        assert all(name and visible for name, visible in reached.values()), reached
        assert not page.evaluate(CONTRAST)

        page.focus("#arm")
        page.keyboard.press("Enter")
        shown.until(lambda: now().owner == "viewer" and page.is_enabled("#disarm"))
        page.focus("#disarm")
        page.keyboard.press("Enter")
        shown.until(lambda: not now().armed)
        page.focus("#solver")
        page.keyboard.press("Escape")
        shown.until(lambda: now().output == "stopped")
        shown.until(lambda: shown.text("#output-name") == "Stopped" and page.is_disabled("#arm"))
        page.focus("#reset")
        page.keyboard.press("Enter")
        shown.until(lambda: now().output == "silent")
        page.focus("#space > canvas")
        page.keyboard.press("Space")
        shown.until(lambda: now().output == "stopped")
        shown.until(lambda: page.is_enabled("#reset"))
        page.click("#reset")
        shown.until(lambda: now().output == "silent")


def test_a_stop_without_a_connection_raises_an_alarm_and_is_sent_late(
    browser: Browser, url: str, server: Running
) -> None:
    now = functools.partial(status, server.connection)
    routes: list[WebSocketRoute] = []
    cut = False

    def between(route: WebSocketRoute) -> None:
        """Pass all messages on; while `cut`, close each connection."""
        routes.append(route)
        if cut:
            route.close()
        else:
            route.connect_to_server()

    with seen(browser, url, live=False) as shown:
        page = shown.page
        page.route_web_socket("**/feed*", between)
        page.reload()
        shown.until(lambda: shown.get("link") == "live" and shown.get("output") == "silent")
        cut = True
        routes[-1].close()
        shown.until(lambda: shown.get("link") == "closed")
        page.keyboard.press("Escape")
        assert shown.text("#stop-alarm-title") == "Stop was NOT sent: the array may still sound"
        assert "pacinian stop" in shown.text("#stop-alarm-text")
        assert page.get_attribute("#stop-alarm", "role") == "alert"
        assert not page.evaluate(CONTRAST)
        assert now().output == "silent"
        cut = False
        shown.until(lambda: now().output == "stopped")
        shown.until(lambda: not page.is_visible("#stop-alarm"))
        page.click("#reset")
        shown.until(lambda: now().output == "silent")


def test_who_closes_an_armed_page_lets_go(browser: Browser, url: str, server: Running) -> None:
    now = functools.partial(status, server.connection)
    with seen(browser, url) as shown:
        shown.page.click("#arm")
        shown.until(lambda: now().owner == "viewer")
    end = time.monotonic() + LIMIT
    while now().armed:
        assert time.monotonic() < end
        time.sleep(0.05)
    assert now().owner == ""  # it disarmed; its lease did not run out


def test_faults_are_told_with_their_times(browser: Browser, url: str) -> None:
    faults: list[str] = []

    def between(route: WebSocketRoute) -> None:
        """Add faults to each state."""
        server = route.connect_to_server()

        def told(data: str | bytes) -> None:
            message: dict[str, Any] = msgpack.unpackb(data)  # type: ignore[arg-type]
            if message["type"] == "state" and faults:
                message |= {"faults": faults, "fault_count": len(faults), "output": "faulted"}
            route.send(msgpack.packb(message) or b"")

        server.on_message(told)

    with seen(browser, url, live=False) as shown:
        shown.page.route_web_socket("**/feed*", between)
        shown.page.reload()
        shown.until(lambda: shown.text("#fault-count") == "0" and shown.get("output"))
        faults += ["solver: it raised <b>ValueError</b>"]
        shown.until(lambda: shown.text("#fault-count") == "1")
        assert "<b>ValueError</b>" in shown.text("#faults li")
        assert shown.page.get_attribute("#faults time", "datetime")
        assert "ValueError" in str(shown.page.text_content("#spoken"))
        assert shown.page.get_attribute("#spoken", "aria-live") == "assertive"
        assert shown.text("#output-name") == "Faulted"
        shown.until(lambda: shown.page.is_visible("#gone") and "ValueError" in shown.text("#gone"))
        assert shown.page.is_enabled("#reset")
        for size in ((1920, 1080), (1280, 800), (900, 600), (800, 900), (390, 844)):
            shown.page.set_viewport_size({"width": size[0], "height": size[1]})
            for below in (0, 10_000):
                shown.page.evaluate("(y) => scrollTo(0, y)", below)
                shown.until(lambda: not shown.page.evaluate(OUTSIDE))


def test_a_recording_is_made_and_gone_through(
    browser: Browser, url: str, server: Running, folder: Path
) -> None:
    with seen(browser, url) as shown:
        with Game(server.connection):
            shown.until(lambda: "ball" in shown.get("objects"))
            shown.page.click("#record")
            shown.until(lambda: shown.text("#record") == "Recording")
            shown.page.wait_for_timeout(500)
        shown.page.click("#record")
        shown.until(lambda: shown.text("#record") == "Record")
    (file,) = folder.glob("*.feed")
    with viewer(recording=file) as replayed, seen(browser, replayed) as shown:
        page = shown.page
        assert page.is_visible("#replay")
        assert not page.is_visible("#stop")
        assert page.is_disabled("#solver")
        page.fill("#scrub", "0")
        shown.until(
            lambda: shown.text("#play") == "Play" and shown.text("#replay-time") == "0.00 s"
        )
        page.fill("#scrub", "0.4")
        shown.until(lambda: shown.text("#replay-time") == "0.40 s")
        shown.until(lambda: "ball" in shown.get("objects"))
        page.click("#play")
        shown.until(lambda: shown.text("#replay-time") == shown.text("#replay-end") != "0.00 s")


def test_a_recording_without_samples_says_how_to_see_them(browser: Browser, tmp_path: Path) -> None:
    rendered(tmp_path / "r.pac")
    with viewer(recording=tmp_path / "r.pac") as replayed, seen(browser, replayed) as shown:
        shown.until(lambda: "pacinian view --samples" in shown.text("#skin-words"))
