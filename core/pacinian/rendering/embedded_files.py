"""The content of files that objects need, so that a recording needs no file but itself.

In a recording, an object names such a file by the SHA-256 of its content. The recording contains each content once. It
is the same part of the object, with numbers in place of the file: the triangles of a mesh, the values of a texture, a
height map or voxels, the samples of a wave.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any, TypeVar, cast

import msgspec
from msgspec import Struct
from msgspec.structs import replace

from pacinian.errors import ArgumentError
from pacinian.scene.modulation.recorded_wave import Wave
from pacinian.scene.modulation.wav import read_wav
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.mesh import Mesh
from pacinian.scene.shapes.texture import Texture
from pacinian.scene.shapes.voxels import Voxels

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")

PREFIX = "sha256:"
KINDS: dict[str, type[Struct]] = {
    kind.__name__: kind for kind in (Mesh, Texture, HeightMap, Voxels, Wave)
}
MAX_BYTES = 1 << 27  # largest content of the files that one tick adds [bytes]
MAX_EMBEDDED = 1024  # largest number of parts whose content is remembered

# Kind and content of files, by the names that objects have for them.
Contents = dict[str, tuple[str, bytes]]


class EmbeddedFileWriter:
    """Replaces files by names of their content. new: contents that are not written yet."""

    def __init__(self) -> None:
        self.new: Contents = {}
        self._known: set[str] = set()
        # by the id of a part; contains the part, so that no other one gets its id
        self._named: dict[int, tuple[Struct, Struct]] = {}

    def name_files(self, value: T) -> T:
        """Return an object or a part of one with its files named by content. Raises ArgumentError."""
        return map_files(value, self._name_file)

    def take(self) -> Contents:
        """Return the contents that are new, and count them as written. Raises ArgumentError."""
        if sum(len(content) for _, content in self.new.values()) > MAX_BYTES:
            raise ArgumentError("scene", f"has files of more than {MAX_BYTES >> 20} MiB")
        new, self.new = self.new, {}
        self._known.update(new)
        return new

    def _name_file(self, part: Struct) -> Struct:
        kept = self._named.get(id(part))
        if kept is None:
            content = msgspec.msgpack.encode(embed_content(part))
            name = PREFIX + hashlib.sha256(content).hexdigest()
            if name not in self._known:
                self.new[name] = type(part).__name__, content
            if len(self._named) >= MAX_EMBEDDED:
                self._named.clear()
            kept = self._named[id(part)] = part, replace(part, file=name)
        return kept[1]


class EmbeddedFileReader:
    """Puts the content back where objects name it. Damaged values raise any Exception."""

    def __init__(self) -> None:
        self._parts: dict[str, Struct] = {}

    def add(self, contents: Contents) -> None:
        """Take note of further contents."""
        for name, (kind, content) in contents.items():
            self._parts[name] = msgspec.msgpack.decode(content, type=KINDS[kind])

    def restore(self, value: T) -> T:
        """Return an object or a part of one with the content of its files."""
        return map_files(value, self._restore)

    def _restore(self, part: Any) -> Struct:
        if part.file not in self._parts:
            raise ValueError(f"the content of {part.file!r} is missing")
        return self._parts[part.file]


def embed_content(part: Struct) -> Struct:
    """Return a part with the numbers of its file instead of the file. Raises ArgumentError."""
    if isinstance(part, Mesh):
        t = part.triangles
        vertices: Any = map(tuple, t.vertices.tolist())
        faces: Any = map(tuple, t.faces.tolist())
        return Mesh(vertices=tuple(vertices), faces=tuple(faces))
    if isinstance(part, Texture):
        return replace(part, file="", values=part.factors[::-1])
    if isinstance(part, HeightMap):
        return replace(part, file="", heights=part.z[::-1], depth=1.0)
    if isinstance(part, Voxels):
        return replace(part, file="", values=part.filling)
    if isinstance(part, Wave):
        rate, x = read_wav(part.file)
        return replace(part, file="", samples=tuple(x.tolist()), rate=rate)
    raise ArgumentError("scene", f"has a file in a {type(part).__name__}, which cannot be recorded")


def map_files(value: T, change: Callable[[Any], Struct]) -> T:
    """Return an object or a part of one in which each part that has a file is changed."""
    if not isinstance(value, Struct):
        return value
    if getattr(value, "file", ""):
        return cast("T", change(value))
    new: dict[str, Any] = {}
    for name in value.__struct_fields__:
        old = getattr(value, name)
        if isinstance(old, tuple) and old and isinstance(old[0], Struct):
            parts = tuple(map_files(part, change) for part in old)
            now: Any = old if all(a is b for a, b in zip(parts, old, strict=True)) else parts
        else:
            now = map_files(old, change)
        if now is not old:
            new[name] = now
    return cast("T", replace(value, **new)) if new else value
