"""Reading TOML and JSON files: errors suggest the intended key, whatever the structs are called."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec
import pytest

import pacinian as pc
from pacinian.config_files import decode_document

if TYPE_CHECKING:
    from pathlib import Path


def struct(name: str, module: str, *fields: tuple[str, type]) -> type[msgspec.Struct]:
    optional = [(field, kind | None, None) for field, kind in fields]
    return msgspec.defstruct(name, optional, module=module, forbid_unknown_fields=True)


def twins() -> type[msgspec.Struct]:
    """Make a file type with two structs called `Grid`, and a part with the same name as the file."""
    plane, space = struct("Grid", "a.b", ("columns", int)), struct("Grid", "c.d", ("layers", int))
    inner = struct("File", "c.d", ("width", float))
    return struct("File", "a.b", ("plane", plane), ("space", space), ("inner", inner))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("plan = {}", "did you mean `plane`"),
        ("plane = { colums = 3 }", "did you mean `columns`"),
        ("space = { layrs = 3 }", "did you mean `layers`"),
        ("plane = { layrs = 3 }", "there are columns$"),
        ("inner = { with = 3 }", "did you mean `width`"),
    ],
)
def test_structs_of_one_name_are_told_apart(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "file.toml"
    file.write_text(text)
    with pytest.raises(pc.SceneFileError, match=said):
        decode_document(file, twins())


def test_what_is_like_nothing_is_answered_with_all_there_is(tmp_path: Path) -> None:
    file = tmp_path / "file.toml"
    file.write_text("zzzz = 1")
    with pytest.raises(pc.SceneFileError, match=r"there are inner, plane, space"):
        decode_document(file, twins())


def test_an_unknown_key_is_answered_with_those_of_its_own_table(tmp_path: Path) -> None:
    file = tmp_path / "device.toml"
    file.write_text('[[boards]]\nlayout = { type = "grid", columns = 4, rows = 4, zzz = 1 }')
    with pytest.raises(pc.SceneFileError, match=r"there are columns, pitch, rows$"):
        decode_document(file, pc.DeviceDescription)
    file.write_text("[[boards]]\n[levels]\nzzz = 1")
    with pytest.raises(pc.SceneFileError, match=r"there are amplitudes, phases$"):
        decode_document(file, pc.DeviceDescription)


@pytest.mark.parametrize(
    "text", ['{"plane": {"columns": 1, "columns": 2}}', '{"plane": {}, "plane": {}}']
)
def test_a_key_may_not_be_there_twice_in_json(tmp_path: Path, text: str) -> None:
    file = tmp_path / "file.json"
    file.write_text(text)
    with pytest.raises(pc.SceneFileError, match=r"the key '(columns|plane)' twice"):
        decode_document(file, twins())
