"""What the page shows, with a real browser, viewer and server."""

from __future__ import annotations

import io
import math
import os
import signal
from threading import Event
from typing import TYPE_CHECKING, Any
from urllib.request import urlopen

import msgpack
import numpy as np
import pytest
from PIL import Image

import pacinian as pc
from pacinian.testing.server import run_server

from .browser import SMALL, seen
from .conftest import CALM
from .conftest import CalmGame as Game
from .test_live import cycles, mean_pressure
from .watching import Page, viewer

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
ARRAY = pc.autd(1, 1)
TINY = 480, 400  # [px]
PHONE = 390, 844  # [px]
NARROWEST = 320, 640  # an enlarged page of 1280 px [px]
TABLET = 1024, 768  # [px]


def test_two_viewers_show_what_there_is(browser: Browser, url: str, server: Running) -> None:
    with (
        Game(server.connection),
        viewer(server.connection) as other,
        seen(browser, url) as shown,
        seen(browser, other, TINY) as second,
    ):
        shown.until(lambda: shown.get("output") == "sounding" and shown.get("drive.mean") > 0.0)
        assert shown.get("transducers") == len(ARRAY)
        shown.until(lambda: {"ball", "plate"} <= shown.get("objects").keys())
        assert all(thing["drawn"] for thing in shown.get("objects").values())
        shown.until(lambda: "game" in shown.text("#clients"))
        shown.until(lambda: shown.text("#owner") == "game")
        shown.until(lambda: shown.text("#output-name") == "Sounding")
        shown.until(lambda: "ball" in shown.text("#samples"))
        samples = shown.get("samples")
        assert all(0.0 < sample["asked"] <= 5.01 for sample in samples)
        shown.until(lambda: _strength(shown.get("samples")) > 0.5)  # the sound may still fade in
        shown.until(lambda: "p99" in shown.text("#chart-ticks"))
        shown.until(lambda: shown.text("#clients").count("viewer") == 2)
        second.until(lambda: {"ball", "plate"} <= second.get("objects").keys())
        second.until(lambda: len(second.get("samples")) > 0 and second.get("slice"))
    licences = urlopen(url.split("?", maxsplit=1)[0] + "LICENSES.txt").read().decode()
    assert "three 0." in licences
    assert "Permission is hereby granted" in licences


def _strength(samples: list[dict[str, float]]) -> float:
    """Return the mean of achieved over target pressure."""
    return float(np.mean([s["achieved"] / s["asked"] for s in samples]))


def _samples(shown: Seen, low: float, high: float) -> list[list[float]]:
    """Return the positions of samples with x in a range [m]: the plate's are beyond 0.02, the point's below -0.02."""
    found = [sample["position"] for sample in shown.get("samples")]
    return [position for position in found if low < position[0] < high]


def _rings(shown: Seen, at: list[float]) -> int:
    """Count the white pixels around a sample."""
    x, y = shown.page.evaluate("(at) => pacinian.project(at)", at)
    clip: Any = {"x": x - 12, "y": y - 12, "width": 24, "height": 24}
    image = Image.open(io.BytesIO(shown.page.screenshot(clip=clip))).convert("RGB")
    return int((np.asarray(image).min(axis=-1) > 225).sum())


def test_what_moves_is_seen_to_move(browser: Browser, url: str, server: Running) -> None:
    with Game(server.connection) as game, seen(browser, url) as shown:
        shown.until(lambda: "plate" in shown.get("objects"))
        shown.page.uncheck("#slice-on")
        shown.page.click("[data-from=near]")
        shown.until(lambda: any(_rings(shown, at) > 10 for at in _samples(shown, 0.02, 0.04)))
        shown.until(lambda: any(_rings(shown, at) > 10 for at in _samples(shown, -0.04, -0.02)))
        game.moves = True
        heights, samples, places = set[float](), set[float](), set[float]()

        def moved() -> bool:
            if (height := shown.get("objects.plate?.position[2]")) is not None:
                heights.add(height)
            of_plate = _samples(shown, 0.021, 0.04)
            samples.update(position[2] for position in of_plate)
            places.update(
                shown.page.evaluate("(at) => pacinian.project(at)[1]", position)
                for position in of_plate
            )
            return len(heights) > 3 and len(samples) > 3 and len(places) > 3

        shown.until(moved)
        assert 0.15 <= min(heights) < max(heights) < 0.161
        assert abs(np.array(sorted(samples)) - 0.155).max() < 0.01


def _of(shown: Seen, plane: dict[str, Any], feed: Page) -> float:
    """Return the largest error of a slice against the emitted frames, over the largest pressure."""
    rows, columns = plane["shape"]
    axis = shown.get("wanted.axis")
    u, v = {"x": ([0, 1, 0], [0, 0, 1]), "y": ([1, 0, 0], [0, 0, 1]), "z": ([1, 0, 0], [0, 1, 0])}[
        axis
    ]
    x = ((np.arange(columns) + 0.5) / columns - 0.5) * plane["size"][0]
    y = ((np.arange(rows) + 0.5) / rows - 0.5) * plane["size"][1]
    at = np.array(plane["centre"]) + x[None, :, None] * np.array(u) + y[:, None, None] * np.array(v)
    feed.next("frame")
    if not cycles(feed):
        return math.inf  # silent, because the machine was too busy for a frame
    wanted = mean_pressure(feed, at)
    found = np.array(plane["pressure"]).reshape(rows, columns)
    return float(np.abs(found - wanted).max() / wanted.max())


def _arrived(shown: Seen, axis: int) -> bool:
    """Return whether the slice shown is the requested one, in full resolution."""
    plane = shown.get("slice && {...pacinian.slice, pressure: pacinian.slice.pressure.length}")
    at = shown.get("wanted.position")
    return bool(plane and abs(plane["centre"][axis] - at) < 1e-9 and plane["shape"] == [64, 64])


def test_the_slice_is_dragged_and_is_the_field(browser: Browser, url: str, server: Running) -> None:
    with Game(server.connection), Page(url) as feed, seen(browser, url) as shown:
        page = shown.page
        feed.until(lambda: feed.newest.get("frame", {}).get("phase"))
        page.select_option("#slice-cells", "64")
        page.select_option("#slice-size", "0.1")
        shown.until(lambda: _arrived(shown, 1))
        shown.until(lambda: _of(shown, shown.get("slice"), feed) < 1e-3)

        page.click("[data-from=home]")
        begin = shown.get("wanted.position")
        x, y = shown.get("grip()")
        page.mouse.move(x, y)
        page.mouse.down()
        for step in range(1, 6):
            page.mouse.move(x - 6 * step, y + 3 * step)
        page.mouse.up()
        dragged = shown.get("wanted.position")
        assert abs(dragged - begin) > 0.004
        shown.until(lambda: _arrived(shown, 1))
        shown.until(lambda: _of(shown, shown.get("slice"), feed) < 1e-3)
        assert page.input_value("#slice-mm") == f"{1000 * dragged:.1f}".removesuffix(".0")

        page.mouse.move(*shown.page.evaluate("() => pacinian.project(pacinian.slice.centre)"))
        shown.until(lambda: "Pa at" in shown.text("#told"))

        page.focus("#space > canvas")
        page.keyboard.press("z")
        page.keyboard.press("c")
        before = shown.get("wanted.position")
        for key in ("PageUp", "PageUp", "Shift+PageDown"):
            page.keyboard.press(key)
        assert abs(shown.get("wanted.position") - before + 0.008) < 1e-9
        assert shown.get("wanted.axis") == "z"
        shown.until(lambda: _arrived(shown, 2))
        shown.until(lambda: _of(shown, shown.get("slice"), feed) < 1e-3)
        asked = max(sample["asked"] for sample in shown.get("samples"))
        top = min(max(shown.get("slice.pressure")), 2.0 * asked)
        shown.until(lambda: top <= shown.get("scale") <= 4.0 * top)


def test_the_error_is_shown_on_what_is_felt(browser: Browser, url: str, server: Running) -> None:
    with Game(server.connection, names=("plate",)), seen(browser, url) as shown:
        shown.until(lambda: shown.text("#samples td:nth-child(5)").endswith("%"))
        shown.page.check("[name=of][value=error]")
        shown.page.check("[name=axis][value=z]")
        shown.until(lambda: shown.get("slice.quantity") == "error")
        shown.until(lambda: abs(shown.get("slice.centre")[2] - 0.15) < 1e-4)
        shown.until(lambda: any(value is not None for value in shown.get("slice.pressure")))
        shown.until(lambda: shown.text("#bar-caption") == "made − asked [Pa]")
        shown.until(lambda: shown.text("#slice-most").endswith("too much"))
        shown.until(lambda: shown.text("#bar-ticks").split()[2] == "0")
        shown.page.focus("canvas")
        shown.page.keyboard.press("e")
        shown.until(lambda: shown.get("slice.quantity") == "pressure")
        shown.until(lambda: shown.text("#bar-caption") == "mean pressure [Pa]")
        assert shown.page.is_checked("[name=of][value=pressure]")


def test_the_slice_and_the_camera_follow_what_is_felt(
    browser: Browser, url: str, server: Running
) -> None:
    with Game(server.connection, names=("plate",)), seen(browser, url) as shown:
        page = shown.page
        shown.until(lambda: shown.get("samples.length") > 0)
        shown.until(lambda: abs(shown.get("wanted.position") - 0.03) < 3e-3)
        assert shown.get("wanted.axis") == "y"  # it faces the initial view
        page.click("[data-from=z]")
        shown.until(lambda: shown.get("wanted.axis") == "z")
        page.click("[data-from=x]")
        shown.until(lambda: shown.get("wanted.axis") == "x")
        width, height = SMALL
        x, y = page.evaluate("() => pacinian.project([0.03, 0.03, 0.15])")
        box = page.locator("#space").bounding_box()
        assert box
        assert abs(x - box["x"] - box["width"] / 2) < 0.2 * width
        assert abs(y - box["y"] - box["height"] / 2) < 0.2 * height
        page.check("[name=axis][value=y]")
        page.fill("#slice-mm", "50")
        page.press("#slice-mm", "Enter")
        shown.until(lambda: not shown.get("wanted.follows"))
        assert page.get_attribute("#slice-follow", "aria-pressed") == "false"
        page.click("#slice-follow")
        shown.until(lambda: abs(shown.get("wanted.position") - 0.03) < 3e-3)


def test_mean_peak_and_instant_and_the_laws_of_colours(
    browser: Browser, url: str, server: Running
) -> None:
    with Game(server.connection), seen(browser, url) as shown:
        page = shown.page
        shown.until(lambda: shown.get("slice && pacinian.slice.average") == "mean")
        page.select_option("#over", "peak")
        shown.until(lambda: shown.text("#bar-caption") == "peak pressure [Pa]")
        page.select_option("#over", "instant")
        shown.until(lambda: shown.text("#bar-caption") == "pressure now [Pa]")
        page.select_option("#law", "decibel")

        def thirty_decibels() -> bool:
            ticks = [float(tick) for tick in shown.text("#bar-ticks").split()]
            return abs(ticks[0] / ticks[-1] / 1e3 - 1.0) < 0.1

        shown.until(thirty_decibels)


def test_the_colour_bar_follows_a_still_field(browser: Browser, url: str, server: Running) -> None:
    seen_slice = Event()

    def between(route: WebSocketRoute) -> None:
        """Multiply all slices by 10. Keep back the states, and so the targets, until there is a slice."""
        server = route.connect_to_server()

        def pass_on(data: str | bytes) -> None:
            message: dict[str, Any] = msgpack.unpackb(data)  # type: ignore[arg-type]
            if message["type"] == "slice" and message["pressure"].strip(b"\0"):
                message["pressure"] = (
                    10.0 * np.frombuffer(message["pressure"], np.float32)
                ).tobytes()
                seen_slice.set()
            if message["type"] != "state" or seen_slice.is_set():
                route.send(msgpack.packb(message) or b"")

        server.on_message(pass_on)

    with Game(server.connection), seen(browser, url, live=False) as shown:
        shown.page.route_web_socket("**/feed*", between)
        shown.page.reload()
        shown.until(lambda: seen_slice.is_set() and shown.get("scale") > 20.0)
        shown.until(lambda: shown.get("scale") <= 20.0)  # targets are 5 Pa
        for found in (shown.text("#bar-ticks").split()[0], shown.page.input_value("#scale")):
            assert float(found) == shown.get("scale")


def test_on_a_phone_the_colour_bar_covers_nothing(
    browser: Browser, url: str, server: Running
) -> None:
    with Game(server.connection), seen(browser, url, PHONE) as shown:
        shown.until(lambda: shown.page.is_visible("#bar") and shown.get("scale") > 1.0)
        view, bar, colours = (
            shown.page.locator(css).bounding_box()
            for css in ("#space > canvas", "#bar", "#bar-colours")
        )
        assert view
        assert bar
        assert colours
        assert bar["y"] > view["y"] + view["height"] - 1.0  # the view has whole pixels
        assert bar["x"] <= colours["x"] < colours["x"] + colours["width"] <= bar["x"] + bar["width"]
        assert colours["width"] > 10.0 * colours["height"]
        low, high = (
            shown.page.locator(f"#bar-ticks li:{which}-child").bounding_box()
            for which in ("last", "first")
        )
        assert low
        assert high
        assert low["x"] < high["x"]
        shown.page.click("#help")
        assert shown.page.is_visible("#keys .touch")
        assert not shown.page.locator("#keys kbd:visible").count()


def test_on_the_narrowest_page_nothing_is_cut_off(
    browser: Browser, url: str, server: Running
) -> None:
    with Game(server.connection), seen(browser, url, NARROWEST) as shown:
        shown.until(lambda: "p99" in shown.text("#chart-ticks"))
        for css in ("#help", "#wheel", "#legend", "#stop", "#chart-ticks output"):
            box = shown.page.locator(css).bounding_box()
            assert box, css
            assert box["x"] >= 0.0, css
            assert box["x"] + box["width"] <= NARROWEST[0], css


def test_the_figures_of_the_charts_are_complete(
    browser: Browser, url: str, server: Running
) -> None:
    inside = """(id) => {
        const chart = document.getElementById(id).getBoundingClientRect();
        const range = document.createRange();
        range.selectNodeContents(document.querySelector(`#${id} output`));
        const text = range.getBoundingClientRect();
        return text.left >= chart.left && text.right <= chart.right && text.bottom <= chart.bottom; }"""
    with Game(server.connection), seen(browser, url, TABLET) as shown:
        shown.until(lambda: "p99" in shown.text("#chart-ticks"))
        for name, texts in (("drive", ("mean", "max")), ("ticks", ("p50", "p99", "max", " ms"))):
            assert all(text in shown.text(f"#chart-{name} output") for text in texts)
            cut = f"() => document.querySelector('#chart-{name} output')"
            assert shown.page.evaluate(f"{cut}.scrollWidth") <= shown.page.evaluate(
                f"{cut}.clientWidth"
            )
            assert shown.page.evaluate(inside, f"chart-{name}")


def test_the_top_of_the_scale_is_checked(browser: Browser, url: str, server: Running) -> None:
    with Game(server.connection), seen(browser, url, TABLET) as shown:
        page = shown.page
        shown.until(lambda: page.is_visible("#bar"))
        page.fill("#scale", "1e12")
        page.press("#scale", "Enter")
        shown.until(lambda: shown.get("scale") == 1e12 and "1e+12" in shown.text("#bar-ticks"))
        bar = page.locator("#bar").bounding_box()
        assert bar
        for tick in page.locator("#bar-ticks li").all():
            box = tick.bounding_box()
            assert box
            assert box["x"] + box["width"] <= bar["x"] + bar["width"]
        for value in ("-3", "0", ""):
            page.fill("#scale", value)
            page.press("#scale", "Enter")
            assert page.get_attribute("#scale", "aria-invalid") == "true"
            assert "1.00e+12 Pa" in shown.text("#scale-why")
            assert shown.get("scale") == 1e12
        page.press("#scale", "Tab")
        assert float(page.input_value("#scale")) == 1e12
        assert page.get_attribute("#scale", "aria-invalid") == "false"
        assert not page.is_visible("#scale-why")


def test_with_forced_colours_states_can_be_told_apart(browser: Browser, url: str) -> None:
    with seen(browser, url, TABLET) as shown:
        page = shown.page
        page.emulate_media(forced_colors="active", reduced_motion="reduce")

        def picture(css: str) -> Any:
            page.mouse.move(0, 0)
            page.evaluate("() => document.activeElement.blur()")
            data = page.locator(css).screenshot()
            return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), float)

        for css in ("#slice-on", "#skin-on", "#surface-on", "#follow", "#slice-follow"):
            before = picture(css)
            page.click(css)
            differ = abs(picture(css) - before).max(axis=-1) > 60.0
            assert differ.mean() > 0.3, css  # not only the border
        look = "(css) => getComputedStyle(document.querySelector(css)).backgroundColor"
        assert page.evaluate(look, "#stop") != page.evaluate(look, "#arm")


def test_what_the_server_has_not_told_is_not_shown(browser: Browser, url: str) -> None:
    told = Event()

    def between(route: WebSocketRoute) -> None:
        """Keep back the states until `told`. Then no technique is chosen."""
        server = route.connect_to_server()

        def pass_on(data: str | bytes) -> None:
            message: dict[str, Any] = msgpack.unpackb(data)  # type: ignore[arg-type]
            if message["type"] == "state":
                message["technique"] = ""
            if message["type"] != "state" or told.is_set():
                route.send(msgpack.packb(message) or b"")

        server.on_message(pass_on)

    with seen(browser, url, live=False) as shown:
        page = shown.page
        page.route_web_socket("**/feed*", between)
        page.reload()
        shown.until(lambda: page.locator("#solver option").count() > 1)
        assert [page.input_value(css) for css in ("#solver", "#backend", "#technique")] == 3 * [""]
        assert shown.text("#output-name") == "Connecting"
        assert shown.text("#drive-why") == page.get_attribute("#arm", "title") == "Connecting …"
        told.set()
        shown.until(lambda: page.input_value("#solver") == "auto" and page.is_enabled("#arm"))
        assert page.locator("#technique option:checked").inner_text() == "of each object"


def test_a_hand_is_painted_with_what_it_feels(browser: Browser, url: str, server: Running) -> None:
    with seen(browser, url) as shown:
        page = shown.page
        page.click("#demonstrate")
        shown.until(lambda: shown.get("painted"))
        shown.until(lambda: "force" in shown.text("#skin-words"))
        coloured = """() => ["skin-asked", "skin-felt"].map((id) => {
            const canvas = document.getElementById(id);
            const often = { willReadFrequently: true };
            const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", often);
            copy.drawImage(canvas, 0, 0);  // Chromium warns of a page whose own canvas is read often
            const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
            return data.filter((x, k) => k % 4 === 3 && x).length; })"""
        shown.until(lambda: min(page.evaluate(coloured)) > 200)
        page.uncheck("#skin-on")
        shown.until(lambda: not shown.get("painted"))


def test_the_surface_is_where_the_field_is_so_strong(
    browser: Browser, url: str, server: Running
) -> None:
    with Game(server.connection), seen(browser, url) as shown:
        shown.until(lambda: shown.get("slice && Math.max(...pacinian.slice.pressure) > 1"))
        shown.page.check("#surface-on")
        shown.until(lambda: shown.get("surface.triangles") > 20)
        levels, counts = ["30", "95"], {"30": 0, "95": 0}

        def grows() -> bool:
            """Change the level, and return whether the surface is larger at the lower one."""
            counts[levels[0]] = shown.get("surface.triangles")
            levels.reverse()
            shown.page.fill("#level", levels[0])
            return counts["30"] > max(20, 1.5 * counts["95"])

        shown.until(grows)
        shown.page.uncheck("#surface-on")
        shown.until(lambda: shown.get("surface.triangles") == 0)


def test_amplitudes_are_those_of_uneven_levels(browser: Browser, url: str) -> None:
    sizes = np.linspace(0.0, 1.0, 256, dtype="<f4") ** 2
    levels = np.arange(len(ARRAY), dtype="<u2") % 100

    def between(route: WebSocketRoute) -> None:
        """Replace the device's levels by uneven ones, and the frames by `levels`."""
        server = route.connect_to_server()

        def told(data: str | bytes) -> None:
            message: dict[str, Any] = msgpack.unpackb(data)  # type: ignore[arg-type]
            if message["type"] == "array":
                message["sound"]["sizes"] = sizes.tobytes()
            if message["type"] == "frame":
                message |= {"phase": levels.tobytes(), "amplitude": levels.tobytes()}
                message |= {"phases": len(sizes), "amplitudes": len(sizes)}
            route.send(msgpack.packb(message) or b"")

        server.on_message(told)

    with seen(browser, url, live=False) as shown:
        shown.page.route_web_socket("**/feed*", between)
        shown.page.reload()
        shown.until(lambda: shown.get("drive.most") > 0.0)
        assert shown.get("drive.most") == pytest.approx(sizes[99])
        assert shown.get("drive.mean") == pytest.approx(float(sizes[levels].mean()))
        shown.until(lambda: f"max {1e2 * sizes[99]:.1f} %" in shown.text("#chart-drive"))


def test_frames_are_drawn_where_something_has_changed(browser: Browser, url: str) -> None:
    with seen(browser, url, TINY) as still, seen(browser, f"{url}&power=all", TINY) as all_power:
        still.page.uncheck("#slice-on")
        still.until(lambda: still.get("output") == "silent")
        why = "not armed: press Arm, or start a program that arms"
        still.until(lambda: still.page.get_attribute("#output-why", "title") == why)
        all_power.until(lambda: all_power.get("frames") > 10)
        drawn, many = still.get("frames"), all_power.get("frames")
        all_power.until(lambda: all_power.get("frames") > many + 60)
        assert still.get("frames") <= drawn + 2


def test_a_server_that_is_killed_and_comes_back(browser: Browser, tmp_path: Path) -> None:
    connection = tmp_path / "connection.json"
    with viewer(connection) as url, seen(browser, url, live=False) as shown:
        shown.until(lambda: "waiting" in shown.text("#gone"))
        assert shown.page.is_disabled("#arm")
        assert shown.page.is_enabled("#stop")
        with run_server(CALM) as first, Game(first.connection):
            connection.symlink_to(first.connection)
            shown.until(lambda: "ball" in shown.get("objects") and shown.get("drive.mean") > 0.0)
            assert not shown.page.is_visible("#gone")
            pids = first.pids.values()
            for what in (
                signal.SIGSTOP,
                signal.SIGKILL,
            ):  # stop all first, so that none sees another die
                for pid in pids:
                    os.kill(pid, what)
            shown.until(lambda: shown.get("link") == "lost")
        assert "waiting" in shown.text("#gone")
        assert shown.text("#output-name") == "No server"
        looks = "() => getComputedStyle(document.getElementById('panels')).filter"
        shown.until(lambda: "grayscale" in shown.page.evaluate(looks))
        assert "ball" in shown.get("objects")  # still visible
        connection.unlink()
        with run_server(CALM) as again:
            connection.symlink_to(again.connection)
            shown.until(lambda: shown.get("link") == "live" and shown.get("output") == "silent")
            shown.until(lambda: not shown.get("objects"))
            assert not shown.page.is_visible("#gone")
