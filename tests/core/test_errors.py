from __future__ import annotations

import inspect
import json
import pickle
import re
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

import pacinian as pc
from pacinian import errors

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

CLASSES = {
    name: kind
    for name, kind in inspect.getmembers(errors, inspect.isclass)
    if kind.__module__ == errors.__name__
}
BUILT_IN = {
    "ValueError": ValueError,
    "ImportError": ImportError,
    "ConnectionError": ConnectionError,
}
SAMPLES = {
    "PacinianError": errors.PacinianError("it broke"),
    "ArgumentError": errors.ArgumentError("points", "must be finite"),
    "PointOnTransducer": errors.PointOnTransducer([3, 5]),
    "SceneFileError": errors.SceneFileError("a.json", "$.objects[0]", "has no shape"),
    "PluginError": errors.PluginError("it does not load"),
    "UnknownPlugin": errors.UnknownPlugin("solver", "x", ["auto", "gs-pat"]),
    "UnsupportedLimit": errors.UnsupportedLimit("gs-pat", "gain"),
    "BackendError": errors.BackendError("it is gone"),
    "ServerError": errors.ServerError("it does not start"),
    "Refused": errors.Refused("limit", "too many objects", "$.objects", "remove some"),
    "ConnectionLost": errors.ConnectionLost("the server is gone"),
    "WireError": errors.WireError("must be finite", "$.objects[0].radius"),
    "RecordingError": errors.RecordingError("a.rec", "is cut short"),
    "SolutionFileError": errors.SolutionFileError("a.solution", "is cut short"),
    "MissingExtra": errors.MissingExtra("matplotlib", "plot"),
}


def tree() -> list[tuple[str, str | None, str | None]]:
    """Return name, parent and built-in base of each class in the tree of the module's docstring."""
    found: list[tuple[str, str | None, str | None]] = []
    above: dict[int, str] = {}
    for line in (errors.__doc__ or "").splitlines():
        match = re.match(r"^ {4}([│├└─ ]*)([A-Z]\w+)(?: \((\w+)\))?(?: {2}|$)", line)
        if match:
            depth = len(match[1]) // 4
            above[depth] = match[2]
            found.append((match[2], above[depth - 1] if depth else None, match[3]))
    return found


def test_the_tree_in_the_docstring_lists_every_class_once() -> None:
    names = [name for name, _, _ in tree()]
    assert sorted(names) == sorted(CLASSES)


def test_every_class_descends_as_the_tree_says() -> None:
    for name, parent, built_in in tree():
        expected = [CLASSES[parent]] if parent else [Exception]
        assert list(CLASSES[name].__bases__) == expected + (
            [BUILT_IN[built_in]] if built_in else []
        )


def test_every_error_is_a_pacinian_error_in_the_table_of_contents() -> None:
    for name, kind in CLASSES.items():
        assert issubclass(kind, pc.PacinianError)
        assert getattr(pc, name) is kind
        assert kind.__doc__


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("ArgumentError", ["`points`", "must be finite"]),
        ("PointOnTransducer", ["`points`", "3, 5", 'attenuation="none"']),
        ("SceneFileError", ["a.json", "$.objects[0]", "has no shape"]),
        ("UnknownPlugin", ["solver", "'x'", "auto, gs-pat", "pacinian plugins"]),
        ("UnsupportedLimit", ["'gs-pat'", "limits.gain"]),
        ("RecordingError", ["a.rec", "is cut short"]),
        ("SolutionFileError", ["a.solution", "is cut short"]),
        ("Refused", ["$.objects", "too many objects", "remove some"]),
        ("WireError", ["$.objects[0].radius", "must be finite"]),
        ("MissingExtra", ["matplotlib is not installed", "python -m pip install", '[plot]"']),
    ],
)
def test_the_message_says_what_is_wrong_and_where(name: str, words: list[str]) -> None:
    assert all(word in str(SAMPLES[name]) for word in words)


def test_the_message_says_so_where_nothing_can_be_named() -> None:
    assert str(errors.SceneFileError("a.json", "", "is empty")) == "a.json: is empty"
    assert "there are: none" in str(errors.UnknownPlugin("backend", "x", []))


def test_a_point_on_a_transducer_carries_every_index_but_shows_five() -> None:
    error = errors.PointOnTransducer(range(100))
    assert error.indices == tuple(range(100))
    assert error.argument == "points"
    assert "0, 1, 2, 3, 4, ..." in str(error)
    assert ", ..." not in str(errors.PointOnTransducer(range(5)))


@pytest.mark.parametrize(
    ("origin", "says"),
    [
        (
            {"dir_info": {"editable": True}, "url": "HERE"},
            'python -m pip install -e "HERE[plot,view]"',
        ),
        ({"dir_info": {}, "url": "HERE"}, 'python -m pip install "HERE[plot,view]"'),
        ({"dir_info": {}, "url": "HERE/moved"}, "where SOURCE is the wheel or the source folder"),
        (
            {"archive_info": {}, "url": "HERE/pacinian.whl"},
            'python -m pip install "HERE/pacinian.whl[plot,view]"',
        ),
        ({"archive_info": {}, "url": "HERE/moved.whl"}, "where SOURCE is the wheel or the source"),
        (None, "where SOURCE is the wheel or the source folder"),
    ],
)
def test_extras_are_installed_from_where_pacinian_came_from(
    origin: dict[str, Any] | None, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pacinian is on no registry, so `pip install pacinian` would find nothing, or another package."""
    from importlib import metadata

    folder = tmp_path / "a folder"
    folder.mkdir()
    (folder / "pyproject.toml").touch()
    (folder / "pacinian.whl").touch()
    text = origin and json.dumps(origin).replace("HERE", folder.as_uri())
    monkeypatch.setattr(
        metadata, "distribution", lambda _: SimpleNamespace(read_text=lambda _: text)
    )
    told = errors.suggest_install("plot,view")
    assert says.replace("HERE", str(folder)) in told
    assert '[plot,view]"' in told


@pytest.mark.parametrize("name", CLASSES)
def test_an_error_survives_the_way_between_processes(name: str) -> None:
    error = SAMPLES[name]
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert vars(copy) == vars(error)


class Rude(Exception):
    """An exception of a plug-in, whose text is the result of `says`."""

    says: Callable[[], str] = staticmethod(lambda: "")

    def __str__(self) -> str:
        return type(self).says()


def leave() -> str:
    raise SystemExit(3)


@pytest.mark.parametrize(
    ("says", "expected"),
    [
        (lambda: "x" * 10**7, "Rude: " + "x" * (errors.MAX_TEXT - 6)),
        (lambda: "bad \udcff name", "Rude: bad ? name"),
        (lambda: 1 / 0, "Rude"),
        (lambda: 3, "Rude"),
        (leave, "Rude"),
    ],
)
def test_what_plug_ins_raise_can_always_be_told(
    says: Callable[[], str], expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Rude, "says", staticmethod(says))
    assert errors.describe_error(Rude()) == expected


def test_the_name_of_what_is_raised_is_cut_too() -> None:
    assert len(errors.describe_error(type("N" * 10**6, (Exception,), {})("x"))) == errors.MAX_TEXT


@pytest.mark.parametrize("kind", [errors.BackendError, MemoryError, ValueError])
def test_an_error_without_a_text_is_told_by_its_kind(kind: type[Exception]) -> None:
    assert errors.describe_error(kind("")) == kind.__name__


def test_our_errors_are_told_without_their_kind() -> None:
    assert errors.describe_error(errors.BackendError("it is gone")) == "it is gone"
