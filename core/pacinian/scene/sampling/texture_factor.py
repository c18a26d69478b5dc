"""Textures on samples: the factor by which an object's texture changes what its samples or its touched skin press.

The factor depends on the place alone, not on time: a finger that rests on ridges feels them, and one that sweeps across
them vibrates, at its speed divided by the texture's period. For the data see `pacinian.scene.shapes.texture`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pacinian.scene.shapes.texture import Texture
    from pacinian.types import Floats


def apply_texture(texture: Texture | None, points: Floats, pressed: Floats) -> None:
    """Multiply pressures [Pa] or forces [N], (K,), in place, by the texture's factor at their points.

    texture: None leaves them as they are. points: in the object's own frame, (K, 3) [m].
    """
    if texture is not None:
        pressed *= texture.at(points)
