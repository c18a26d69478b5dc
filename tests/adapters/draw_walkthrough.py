"""Draws how one gets to a felt ball in Unity and in Unreal: `python -m tests.adapters.draw_walkthrough docs/pictures`.

No engine is needed. Terminals show what commands print; menus and fields come from the packages' sources; the viewer
shows the components of both packages, which play with stubs of the engines' types and a real server.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import textwrap
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image

from pacinian.plot import save
from pacinian.serving.settings import Safety

from ..viewing.pictures import open_viewer, reduced, settle, take
from . import tools, unity, unreal
from .drawing import (
    INK,
    MARGIN,
    TEXT,
    WIDTH,
    Row,
    draw_badge,
    draw_box,
    draw_menu,
    draw_panel,
    draw_panels,
    draw_place,
    draw_terminal,
    make_page,
    write_note,
)
from .game import Game
from .level import MIRROR, level, numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from matplotlib.figure import Figure

COLOURS = 64
SIZE = 1280, 800  # [px] of the viewer
PROGRAM = Path(sys.executable).with_name("pacinian")
BALL, PALM = (0.0, 0.0, 0.175), (0.0, 0.0, 0.215)  # above the array's middle [m]
UNITY_NOTE = "Drawn from the package's names and defaults. This is not a screenshot of Unity."
UNREAL_NOTE = "Drawn from the plugin's names and defaults. This is not a screenshot of Unreal."


def spell_name(name: str) -> str:
    """Return a field's name as the engines show it, such as Radiation Pressure."""
    name = re.sub(r"^b(?=[A-Z])", "", name)
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name[:1].upper() + name[1:])


# What commands print


@contextmanager
def run_serve(folder: Path) -> Iterator[tuple[str, dict[str, str]]]:
    """Run `pacinian serve` as a user does; yield the line that it prints, and the environment that finds it."""
    environment = {**os.environ, "PACINIAN_CONNECTION": str(folder / "connection.json")}
    server = subprocess.Popen(
        [PROGRAM, "serve"], env=environment, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    assert server.stdout is not None
    try:
        yield server.stdout.readline().strip(), environment
    finally:
        server.terminate()
        server.wait()


def run_command(command: str, folder: Path, environment: dict[str, str] | None = None) -> str:
    """Return what a command of Pacinian prints, without trailing spaces."""
    done = subprocess.run(
        [PROGRAM, *command.split()[1:]], cwd=folder, env=environment, text=True,
        capture_output=True, check=True,
    )  # fmt: skip
    return "\n".join(line.rstrip() for line in done.stdout.strip().split("\n"))


def draw_server() -> Figure:
    """Draw the start of a server, and its status before a game connects."""
    with tempfile.TemporaryDirectory() as folder, run_serve(Path(folder)) as (line, environment):
        ready = line.replace(folder, "…")
        status = run_command("pacinian status", Path(folder), environment).split("\n")[:4]
    return draw_terminal(
        [("pacinian serve", ready), ("pacinian status", "\n".join([*status, "…"]))]
    )


def draw_installation(command: str, *files: str) -> Figure:
    """Draw the installation into a new project; files: of that project, empty but for what the command reads."""
    with tempfile.TemporaryDirectory() as folder:
        for file in files:
            made = Path(folder, "Game", file)
            made.parent.mkdir(parents=True, exist_ok=True)
            made.write_text("m_EditorVersion: 2021.3.0f1\n" if made.suffix == ".txt" else "{}\n")
        said = run_command(f"{command} Game", Path(folder))
        said = said.replace(str(tools.ADAPTERS.parent), "…")  # which is another on each computer
        return draw_terminal([(f"{command} Game", said)])


# Unity


def read_unity_fields(name: str, shown: Sequence[str] = (), **given: str) -> list[Row]:
    """Return the fields of a component, as its inspector has them. shown: only these. given: what the reader sets."""
    sources = (unity.PACKAGE / "Runtime").glob(f"{name}*.cs")
    text = "".join(
        source.read_text(encoding="utf-8") for source in sorted(sources, key=lambda s: len(s.name))
    )
    text = re.sub(r'"[^"]*"', '""', text)
    rows = []
    for kind, field, value in re.findall(
        r"\[SerializeField[^;]*?private ([\w.\[\]]+) (\w+)(?: = ([^;]*))?;", text
    ):
        if not shown or field in shown:
            rows.append(_make_row(spell_name(field), kind, value, given.get(field)))
    return rows


def _make_row(label: str, kind: str, value: str, given: str | None) -> Row:
    last = spell_name(re.split(r"::|\.", value)[-1])
    if kind == "bool":
        row = Row(label, "x" if value == "true" else "", "check")
    elif kind in {"float", "int", "int32"}:
        row = Row(label, value.strip("f").removesuffix(".0") or "0", "number")
    elif re.fullmatch(r"\w+(?:\.|::)\w+", value):
        row = Row(label, last, "choice")
    elif kind in {"string", "FString"}:
        row = Row(label, "", "number")
    elif "new" in value or kind in {"UnityEvent", "FHapticTechnique"}:
        row = Row(label, kind="fold")
    else:
        bare = re.sub(r"TObjectPtr<U?|>", "", kind)
        row = Row(label, f"None ({spell_name(bare)})", "object")
    return row if given is None else row._replace(value=given, marked=True)


def draw_unity_menu() -> Figure:
    """Draw the menu that makes a scene, and the objects that it makes."""
    text = (unity.PACKAGE / "Editor" / "GameObjectMenu.cs").read_text(encoding="utf-8")
    found = re.findall(r'MenuItem\("GameObject/Pacinian/([^"]+)", false, (\d+)\)', text)
    items = [name for name, _ in sorted(found, key=lambda item: int(item[1]))]
    chosen = ["Array", "Ball", "Hands"]
    objects = [
        Row(match[1])
        for name in chosen
        if (match := re.search(rf'void {name}\(.*?Made\(command, "([^"]+)"', text, re.DOTALL))
    ]
    below = [Row(f"      {name}") for name in re.findall(r'Hand\(hands, "(\w+)"', text)]
    made, axes = make_page(WIDTH, 230.0)
    draw_menu(axes, (MARGIN, MARGIN), 190.0, ["GameObject:", "…", "Pacinian  ▸"], ["Pacinian"])
    draw_menu(axes, (MARGIN + 200.0, MARGIN), 290.0, items, chosen)
    draw_panel(axes, (540.0, MARGIN), 404.0, "Hierarchy", [Row("Main Camera"), *objects, *below])
    write_note(axes, UNITY_NOTE)
    return made


def draw_unity_inspector() -> Figure:
    """Draw the inspector of the ball, and of its envelope."""
    effect = [
        row
        for row in read_unity_fields("HapticEffect", envelope="Envelope (Haptic Envelope)")
        if row.label != "Force"
    ]
    pressure = float(next(row.value for row in effect if row.label == "Radiation Pressure"))
    settings = (unity.PACKAGE / "Runtime" / "PacinianSettings.cs").read_text(encoding="utf-8")
    full = re.search(r"fullPressure = (\d+)", settings)
    assert full is not None
    label = f"Relative strength ({pressure:.1f} of {full[1]} Pa)"
    slider = Row(label, str(pressure / float(full[1])), "slider")
    editor = (unity.PACKAGE / "Editor" / "HapticEnvelopeEditor.cs").read_text(encoding="utf-8")
    sine = next(line for line in editor.split("\n") if '"frequency", "low", "high" }' in line)
    return draw_panels(
        ("Haptic Volume, of Haptic Ball", [*effect, *read_unity_fields("HapticVolume"), slider]),
        (
            "Envelope (Haptic Envelope)",
            read_unity_fields("HapticEnvelope", ["kind", *re.findall(r'"(\w+)"', sine)]),
        ),
        UNITY_NOTE,
        [
            "Assets > Create > Pacinian > Haptic Envelope makes it.",
            "Drag it to the field Envelope.",
        ],
    )


def draw_game_windows(texts: dict[str, str]) -> Figure:
    """Draw the game's window for each act, with the text on its screen."""
    made, axes = make_page(WIDTH, 220.0)
    width = (WIDTH - MARGIN * (len(texts) + 1)) / len(texts)
    for k, (act, text) in enumerate(texts.items()):
        x = MARGIN + k * (width + MARGIN)
        draw_box(axes, (x, MARGIN), (width, 120.0), "#3c4653")
        axes.text(
            x + 12.0, MARGIN + 12.0, textwrap.fill(text, 46), fontsize=TEXT, color="white", va="top"
        )
        draw_badge(axes, (x + 10.0, MARGIN + 142.0), str(k + 1))
        axes.text(x + 26.0, MARGIN + 142.0, act, fontsize=TEXT, color=INK, va="center")
    write_note(
        axes, "Drawn. The texts are those that Haptic Status showed while the components ran."
    )
    return made


# Unreal


def read_unreal_fields(header: str, **given: str) -> list[Row]:
    """Return the properties of a class, as the details panel has them. given: what the reader sets."""
    (each,) = unreal.classes(unreal.SOURCE / "Pacinian" / "Public" / f"{header}.h")
    rows, values, advanced = [], [], False
    for member in each.members:
        match = re.match(r"([\w<>*]+) (\w+)(?: = ([^;]*))?;", member.text)
        if member.kind != "UPROPERTY" or "EditAnywhere" not in member.specifiers or not match:
            continue
        kind, name, value = match[1], match[2], match[3] or ""
        if "::" in value:
            values.append(value)
        condition = re.search(r'EditCondition = "([^"]*)"', member.specifiers)
        if condition and not any(value in condition[1] for value in values):
            continue
        advanced = advanced or "AdvancedDisplay" in member.specifiers
        if "AdvancedDisplay" not in member.specifiers:
            unit = re.search(r'Units = "(\w+)"', member.specifiers)
            row = _make_row(spell_name(name), kind, value, given.get(name))
            row = row._replace(kind="choice") if row.kind == "object" else row
            rows.append(row._replace(value=f"{row.value} {unit[1]}") if unit else row)
    return [*rows, Row("Advanced", kind="fold")] if advanced else rows


def draw_unreal_actor() -> Figure:
    """Draw where the array is found, and its components."""
    text = (unreal.SOURCE / "Pacinian" / "Private" / "HapticArray.cpp").read_text(encoding="utf-8")
    parts = re.findall(r"CreateDefaultSubobject<U(\w+)Component>\(TEXT\(\"(\w+)\"\)\)", text)
    found = [Row("Search", "haptic", "number", marked=True), Row("Haptic Array")]
    return draw_panels(
        ("Place Actors", found),
        ("Haptic Array: its components", [Row(name, spell_name(kind)) for kind, name in parts]),
        UNREAL_NOTE,
    )


def draw_unreal_details() -> Figure:
    """Draw the details of the ball's component, and of its envelope."""
    rows = read_unreal_fields("HapticEffectComponent", Envelope="Hum") + read_unreal_fields(
        "HapticVolumeComponent"
    )
    rows.sort(key=lambda row: row.label == "Advanced")
    return draw_panels(
        ("Haptic Volume, of the sphere", rows),
        ("Hum (Haptic Envelope)", read_unreal_fields("HapticEnvelope")),
        UNREAL_NOTE,
        ["Content Browser: Miscellaneous, Data Asset,", "Haptic Envelope. Choose it as Envelope."],
    )


def draw_unreal_play(status: dict[str, object]) -> Figure:
    """Draw the details of the hand, and the status of the server while the level plays."""
    text = (unreal.SOURCE / "PacinianEditor" / "Private" / "HapticServerDetails.cpp").read_text(
        "utf-8"
    )
    names = re.findall(r'Add\(LOCTEXT\("\w+", "([^"]+)"\)', text)
    armed = ", armed" if status["armed"] else ""
    values = [
        spell_name(str(status["status"])), spell_name(str(status["output"])) + armed, str(status["silence"]),
        f"{1e3 * float(str(status['latency'])):.3f} ms", str(status["problem"]),
    ]  # fmt: skip
    return draw_panels(
        (
            "Haptic Hand, of an actor above the ball",
            read_unreal_fields("HapticHandComponent", Source="Mouse"),
        ),
        (
            "Haptics Status, of the Haptic Array",
            [Row(name, value) for name, value in zip(names, values, strict=True)],
        ),
        UNREAL_NOTE + " The status is from the run in the next picture.",
    )


# The packages' components play


@contextmanager
def play_before_viewer(
    start: Callable[[Path], Game],
) -> Iterator[tuple[Game, Callable[[], Image.Image]]]:
    """Play a game against a server; yield it, and a function that takes a picture of the viewer."""
    safety = Safety(lease=10.0, frame_timeout=1.0)
    with open_viewer(safety, SIZE) as (server, shown), start(server.connection) as game:

        def view() -> Image.Image:
            settle(shown, "ball")
            return reduced(take(shown))

        yield game, view
        game.end()


def draw_unity_walkthrough() -> Iterator[tuple[str, Figure | Image.Image]]:
    """Yield the pictures of the walkthrough for Unity."""
    yield "server", draw_server()
    project = "Assets/empty", "ProjectSettings/ProjectVersion.txt"
    yield "package", draw_installation("pacinian unity", *project)
    yield "menu", draw_unity_menu()
    yield "place", draw_place({"ball": BALL[2], "palm": PALM[2]}, "m", "y")
    yield "inspector", draw_unity_inspector()
    with tempfile.TemporaryDirectory() as folder:
        player = unity.build(Path(folder)).player
        with play_before_viewer(lambda file: Game(["mono", player, file, "0"])) as (game, view):
            game.do("play")
            game.event("connected")
            game.do("wave off")
            game.do("mouse 960 648 0")  # 3 cm before the middle, so that the palm is above the ball
            silent = game.until(lambda s: s["cause"] == "hand not seen")["screen"]
            game.do("mouse 960 648 1")
            sounds = game.until(lambda s: s["screen"] == "Sounding" and s["force"] > 0.5)["screen"]
            texts = {"Press play": silent, "Hold the left mouse button, and move": sounds}
            yield "play", draw_game_windows(texts)
            yield "felt", view()


def draw_unreal_walkthrough() -> Iterator[tuple[str, Figure | Image.Image]]:
    """Yield the pictures of the walkthrough for Unreal."""
    yield "server", draw_server()
    yield "plugin", draw_installation("pacinian unreal", "Game.uproject", "Source/Game.Target.cs")
    yield "actor", draw_unreal_actor()
    yield "place", draw_place({"ball": 100.0 * BALL[2], "palm": 100.0 * PALM[2]}, "cm", "z")
    yield "details", draw_unreal_details()
    unreal.generate(tools.CPP / "build" / "watched" / "headers")
    program = tools.watched("play") / "play"
    with play_before_viewer(lambda file: Game([program, file], tools.environment())) as (
        game,
        view,
    ):
        game.event("connected")
        game.do(f"place array {numbers(level([0.0, 0.0, 0.0]))} 30 1")
        game.do(f"place ball {numbers(100.0 * MIRROR @ BALL)} 0 1")
        game.do(f"open {numbers(level(PALM))}")
        game.do("mouse 960 540 1")  # the middle of the window
        status = game.until(lambda s: s["output"] == "sounding" and s["force"] > 0.5)
        yield "play", draw_unreal_play(status)
        yield "felt", view()


if __name__ == "__main__":
    only = sys.argv[2:]
    for engine, draw in {
        "unity": draw_unity_walkthrough,
        "unreal": draw_unreal_walkthrough,
    }.items():
        if only and engine not in only:
            continue
        for name, drawn in draw():
            path = Path(sys.argv[1]) / f"{engine}-walkthrough-{name}.png"
            if isinstance(drawn, Image.Image):
                drawn.save(path, "PNG", optimize=True)
            else:
                save(drawn, path, COLOURS)
