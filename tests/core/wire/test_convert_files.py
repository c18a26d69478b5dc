from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.io import wavfile

from pacinian.errors import WireError
from pacinian.scene.modulation.envelope import (
    Wave,
)
from pacinian.scene.objects import Surface, Volume
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.mesh import Mesh
from pacinian.scene.shapes.texture import Texture
from pacinian.scene.shapes.voxels import Voxels
from pacinian.wire.convert import (
    to_scene,
    to_wire,
)

if TYPE_CHECKING:
    import pathlib

CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SIDES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
BLOCK = np.pad(np.ones((2, 1, 2), np.float32), 1)


def test_files_are_read_on_the_clients_side(tmp_path: pathlib.Path) -> None:
    np.save(tmp_path / "map.npy", np.arange(6.0, dtype=np.float32).reshape(3, 2) / 8.0)
    np.save(tmp_path / "voxels.npy", BLOCK)
    wavfile.write(tmp_path / "tick.wav", 8000, np.linspace(-1.0, 1.0, 50, dtype=np.float32))
    lines = [f"v {x} {y} {z}" for x, y, z in CORNERS]
    lines += ["f " + " ".join(str(i + 1) for i in side) for side in SIDES]
    (tmp_path / "solid.obj").write_text("\n".join(lines))
    grid, grown, wave = (str(tmp_path / n) for n in ("map.npy", "voxels.npy", "tick.wav"))
    items: list[Any] = [
        Surface(
            shape=HeightMap(file=grid, width=0.1, height=0.1),
            texture=Texture(file=grid, size=(0.1, 0.1)),
            radiation_pressure=1.0,
            envelope=Wave(wave),
        ),
        Volume(shape=Voxels(file=grown, pitch=0.01), radiation_pressure=1.0),
        Volume(shape=Mesh(str(tmp_path / "solid.obj"), 0.01), radiation_pressure=1.0),
    ]
    for item in items:
        made: Any = to_scene("a", to_wire(item))
        assert not getattr(made.shape, "file", "")
        assert made.shape.area == pytest.approx(item.shape.area, rel=1e-6)
        if isinstance(item.envelope, Wave):
            t = np.linspace(0.0, 0.006, 20)
            np.testing.assert_allclose(made.envelope.at(t), item.envelope.at(t), atol=1e-6)
            np.testing.assert_array_equal(made.texture.factors, item.texture.factors)


def test_a_file_that_is_not_there_is_told() -> None:
    with pytest.raises(WireError, match="gone") as caught:
        to_wire(Surface(shape=Mesh("gone.obj"), radiation_pressure=1.0))
    assert caught.value.path.startswith("$.shape")
