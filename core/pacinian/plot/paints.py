"""Triangles with colours: one for all, or from a picture by coordinates that are the values themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.plot.page import require
from pacinian.plot.style import CYCLIC, MAP

if TYPE_CHECKING:
    from PIL.Image import Image

    from pacinian.plot.meshes import Triangles
    from pacinian.types import Floats

COLOURS, STEPS = 256, 64  # of a wheel: phases, amplitudes
DARKEST = 0.45  # share of its colour that a silent transducer has
FAINT = 0.25  # of the most; what is less is seen through


def painted(made: Triangles, colour: tuple[float, float, float], opacity: float = 1.0) -> Any:
    """A mesh of one colour, red, green and blue 0..1."""
    look = _material(
        baseColorFactor=[*colour, opacity], alphaMode="BLEND" if opacity < 1.0 else "OPAQUE"
    )
    return _mesh(made, np.zeros((len(made.vertices), 2)), look)


def coloured(made: Triangles, uv: Floats, image: Image, *, clear: bool = False) -> Any:
    """A mesh that shines with the colours of a picture, whatever the light is. uv: (V, 2), 0..1, up from below.

    clear: the picture has an opacity.
    """
    look = _material(
        baseColorFactor=[0.0, 0.0, 0.0, 1.0], baseColorTexture=image,
        emissiveFactor=[1.0, 1.0, 1.0], emissiveTexture=image.convert("RGB"),
        alphaMode="BLEND" if clear else "OPAQUE",
    )  # fmt: skip
    return _mesh(made, uv, look)


def wheel() -> Image:
    """Phases from left to right, amplitudes from below up."""
    hue = _map(CYCLIC)(np.linspace(0.0, 1.0, COLOURS))[:, :3]
    bright = DARKEST + (1.0 - DARKEST) * np.linspace(1.0, 0.0, STEPS)
    return _image(bright[:, None, None] * hue)


def strip(name: str = MAP) -> Image:
    """A map of colours from left to right."""
    return _image(np.tile(_map(name)(np.linspace(0.0, 1.0, COLOURS))[:, :3], (4, 1, 1)))


def picture(found: Floats, most: float) -> Image:
    """Values (rows, columns), the first row below, in colours up to the most; seen through where they are low."""
    share = np.clip(np.nan_to_num(found[::-1]) / most, 0.0, 1.0)
    rgba = np.asarray(_map(MAP)(share))
    rgba[..., 3] = np.clip(share / FAINT, 0.1, 0.95)
    return _image(rgba)


def _mesh(made: Triangles, uv: Floats, material: Any) -> Any:
    from trimesh import Trimesh, visual

    textured: Any = visual.TextureVisuals
    return Trimesh(
        made.vertices, made.faces, visual=textured(uv=uv, material=material), process=False
    )


def _material(**given: Any) -> Any:
    """Dull, and the same from both sides."""
    from trimesh.visual import material

    made: Any = material.PBRMaterial
    return made(metallicFactor=0.0, roughnessFactor=1.0, doubleSided=True, **given)


def _map(name: str) -> Any:
    require()
    from matplotlib import colormaps

    return colormaps[name]


def _image(colours: Floats) -> Image:
    from PIL import Image

    return Image.fromarray((255.0 * colours + 0.5).astype(np.uint8))
