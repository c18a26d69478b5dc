"""C# names for messages whose names UnityEngine or System.IO also has: a script that uses both would not compile."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any

from model import Message, Part, Union

if TYPE_CHECKING:
    from model import Model

NAMES = {
    "Material": "HapticMaterial",
    "Mesh": "HapticMesh",
    "Motion": "HapticMotion",
    "Path": "HapticPath",
    "Pose": "HapticPose",
    "Texture": "HapticTexture",
}


def rename(model: Model) -> Model:
    """Return the same messages with C# names. Their fields, and the names on the wire, stay."""
    made: Model = _rename(model)
    return made


def _rename(part: Any) -> Any:
    if type(part) is tuple:
        return tuple(_rename(each) for each in part)
    if isinstance(part, frozenset):
        return frozenset(NAMES.get(each, each) for each in part)
    if isinstance(part, dict):
        return {key: _rename(each) for key, each in part.items()}
    if not is_dataclass(part) or isinstance(part, type):
        return part
    made = replace(
        part, **{field.name: _rename(getattr(part, field.name)) for field in fields(part)}
    )
    if isinstance(made, (Message, Part)):
        return replace(made, name=NAMES.get(made.name, made.name))
    if isinstance(made, Union):
        return replace(made, kinds=tuple(NAMES.get(kind, kind) for kind in made.kinds))
    return made
