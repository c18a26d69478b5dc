"""Notebooks in a real kernel: what they show, run twice, and stopped in the middle."""

import time
from base64 import b64decode
from collections.abc import Iterator
from io import BytesIO
from typing import Any

import pytest
from PIL import Image

import pacinian as pc
from pacinian.scene.config_sections import Units
from pacinian.serving.settings import Safety, Settings
from pacinian.testing import Running, run_server

NOTEBOOK = [
    "import hashlib, sys\nimport numpy as np\nimport pacinian as pc\nfrom pacinian import plot",
    "array = pc.autd()\narray",
    "points = np.array([[0.02, 0.0, 0.15], [-0.02, 0.0, 0.15]])\n"
    "solution = pc.solve(array, points, [300.0, 200.0])\n"
    "print(hashlib.sha256(solution.gains.tobytes()).hexdigest())\n"
    "solution",
    "plot.field(array, solution.gains, medium=solution.medium, points=points)",
    "session = pc.Session(array)\n"
    "for _ in range(2):\n"
    "    again = session.solve(points, [300.0, 200.0])\n"
    "    print(hashlib.sha256(again.gains.tobytes()).hexdigest())",
    "ball = pc.Volume(shape=pc.Sphere(0.01), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=5.0,\n"
    "                 name='<b>ball</b>')\n"
    "scene = pc.Scene((ball,))\n"
    "scene",
    "from pacinian.notebook import progress\n"
    "renderer = pc.Renderer(array, scene)\n"
    "with progress('a ball', 1.2) as on_tick:\n"
    "    report = renderer.run(1.2, on_tick)\n"
    "report",
    "print(renderer.backend.silent, 'matplotlib.pyplot' in sys.modules)",
]


@pytest.fixture(scope="module")
def twice(kernel: Any) -> list[list[Any]]:
    return [[kernel.run(cell) for cell in NOTEBOOK] for _ in range(2)]


def test_no_cell_fails_or_complains(twice: list[list[Any]]) -> None:
    for cells in twice:
        for code, cell in zip(NOTEBOOK, cells, strict=True):
            assert not cell.error, code
            assert not cell.warned, code


def test_what_is_run_twice_is_the_same(twice: list[list[Any]]) -> None:
    first, second = twice
    for k in (1, 3, 5):
        assert first[k].shown == second[k].shown, NOTEBOOK[k]
    for k in (2, 4, 7):
        assert first[k].text == second[k].text, NOTEBOOK[k]
    assert len(set(first[4].text.split())) == 1


def test_objects_are_shown_as_tables_with_a_picture_and_as_plain_text(
    twice: list[list[Any]],
) -> None:
    for k, words in ((1, "249 transducers"), (2, "the targets are met"), (6, "left out")):
        (bundle,) = (b for b in twice[0][k].shown if "progress" not in b["text/html"])
        assert words in bundle["text/html"]
        assert "data:image/png;base64," in bundle["text/html"]
    (bundle,) = twice[0][1].shown
    assert bundle["text/plain"] == repr(pc.autd())


def test_names_are_text_and_no_markup(twice: list[list[Any]]) -> None:
    (bundle,) = twice[0][5].shown
    assert "&lt;b&gt;ball&lt;/b&gt;" in bundle["text/html"]


def test_a_figure_is_shown_without_pyplot(twice: list[list[Any]]) -> None:
    (bundle,) = twice[0][3].shown
    with Image.open(BytesIO(b64decode(bundle["image/png"]))) as picture:
        assert picture.size[0] == 700
    assert twice[0][7].text.split() == ["True", "False"]


def test_a_bar_moves_while_a_run_goes_on(twice: list[list[Any]]) -> None:
    for cells in twice:
        assert "<progress" in cells[6].shown[0]["text/html"]
        last = cells[6].updated[-1]
        assert "1.2 of 1.2 s" in last["text/plain"]
        assert "ticks" in last["text/html"]


def test_stop_ends_a_run_in_silence_and_the_kernel_goes_on(kernel: Any) -> None:
    kernel.run("import pacinian as pc\narray = pc.autd()")
    kernel.run(
        "spark = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)\n"
        "renderer = pc.Renderer(array, pc.Scene((spark,)))\n"
        "say = lambda report: report.ticks == 100 and print('it runs', flush=True)"
    )
    for _ in range(2):
        cell = kernel.interrupted("report = renderer.run(1000.0, say)", "it runs")
        assert not cell.error
        after = kernel.run(
            "print(report.interrupted, renderer.backend.silent, renderer.backend.received >= 100,\n"
            "      abs(renderer.solution.gains).max() > 0.0)"
        )
        assert after.text.split() == ["True"] * 4, after.error


@pytest.fixture(scope="module")
def server() -> Iterator[Running]:
    """A machine that stands still for a moment ends nothing in it."""
    safety = Safety(lease=10.0, frame_timeout=1.0, hang_timeout=60.0, session_timeout=3600.0)
    with run_server(Settings(array=Units(1, 1), safety=safety)) as running:
        yield running


PATIENT = (
    "import zmq\n"
    "import pacinian as pc\n"
    "from pacinian.client import link\n"
    "link.HEARTBEAT |= {zmq.HEARTBEAT_TTL: 60_000, zmq.HEARTBEAT_TIMEOUT: 60_000}\n"
)
SPARK = (
    "client = pc.Client({path!r}, timeout=60.0)\n"
    "client.put(pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=10.0, name='spark'))\n"
    "client.arm()\n"
)


def let_go(server: Running) -> None:
    """Wait for silence, and see that it did not come of a lease that has run out: that leaves an owner."""
    with pc.Client(server.connection, timeout=60.0) as watcher:
        end = time.monotonic() + 60.0
        while (state := watcher.status()).armed or state.output != "silent":
            assert time.monotonic() < end
        assert state.owner == ""


def test_a_client_that_is_forgotten_gives_the_output_back(kernel: Any, server: Running) -> None:
    kernel.run(PATIENT)
    for _ in range(3):
        cell = kernel.run(SPARK.format(path=str(server.connection)) + "print(client.armed)")
        assert (cell.error, cell.text) == ("", "True\n")
    assert kernel.run("client.close()").error == ""


def test_stop_while_a_client_holds_ends_in_silence(kernel: Any, server: Running) -> None:
    hold = (
        "renew = client.renew\n"
        "def renewed():\n"
        "    renew()\n"
        "    print('it holds', flush=True)\n"
        "client.renew = renewed\n"
        "client.hold(1000.0)"
    )
    spark = PATIENT + SPARK.format(path=str(server.connection))
    cell = kernel.interrupted(spark + hold, "it holds")
    if "Unexpected exception formatting" not in cell.text:  # IPython's own, which prints it then
        assert cell.error.startswith("KeyboardInterrupt"), cell
    assert "KeyboardInterrupt" in cell.error + cell.text + cell.warned, cell
    let_go(server)
    again = kernel.run(spark + "client.close()\nprint('fine')")
    assert (again.error, again.text) == ("", "fine\n")


def test_a_restart_ends_in_silence_and_the_notebook_runs_again(
    kernel: Any, server: Running
) -> None:
    spark = PATIENT + SPARK.format(path=str(server.connection))
    cell = kernel.run(spark + "print(client.armed)")
    assert (cell.error, cell.text) == ("", "True\n")
    kernel.restart()
    let_go(server)
    again = kernel.run(spark + "client.close()\nprint('fine')")
    assert (again.error, again.text) == ("", "fine\n")
