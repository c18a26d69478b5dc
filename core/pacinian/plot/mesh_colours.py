"""Colours meshes: with one colour, or from a texture whose coordinates are the values themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.plot.page import require
from pacinian.plot.style import CYCLIC, MAP

if TYPE_CHECKING:
    from PIL.Image import Image

    from pacinian.plot.meshes import Triangles
    from pacinian.types import Floats

COLOURS, STEPS = 256, 64  # steps of a wheel: phases, amplitudes
DARKEST = 0.45  # brightness of a silent transducer
MIN_OPAQUE_SHARE = 0.25  # share of the maximum below which values are transparent


def make_plain_mesh(
    made: Triangles, colour: tuple[float, float, float], opacity: float = 1.0
) -> Any:
    """Make a mesh of one colour, red, green and blue 0..1."""
    look = _material(
        baseColorFactor=[*colour, opacity], alphaMode="BLEND" if opacity < 1.0 else "OPAQUE"
    )
    return _mesh(made, np.zeros((len(made.vertices), 2)), look)


def make_textured_mesh(made: Triangles, uv: Floats, image: Image, *, clear: bool = False) -> Any:
    """Make an emissive mesh with the colours of a picture, independent of light. uv: (V, 2), 0..1, v upwards.

    clear: whether the picture has an opacity channel.
    """
    look = _material(
        baseColorFactor=[0.0, 0.0, 0.0, 1.0], baseColorTexture=image,
        emissiveFactor=[1.0, 1.0, 1.0], emissiveTexture=image.convert("RGB"),
        alphaMode="BLEND" if clear else "OPAQUE",
    )  # fmt: skip
    return _mesh(made, uv, look)


def wheel() -> Image:
    """Make a picture of phases from left to right and amplitudes upwards."""
    hue = _map(CYCLIC)(np.linspace(0.0, 1.0, COLOURS))[:, :3]
    bright = DARKEST + (1.0 - DARKEST) * np.linspace(1.0, 0.0, STEPS)
    return _image(bright[:, None, None] * hue)


def strip(name: str) -> Image:
    """Make a picture of a colour map from left to right."""
    return _image(np.tile(_map(name)(np.linspace(0.0, 1.0, COLOURS))[:, :3], (4, 1, 1)))


def picture(found: Floats, most: float) -> Image:
    """Make a picture of values (rows, columns), first row at the bottom; low values are transparent."""
    share = np.clip(np.nan_to_num(found[::-1]) / most, 0.0, 1.0)
    rgba = np.asarray(_map(MAP)(share))
    rgba[..., 3] = np.clip(share / MIN_OPAQUE_SHARE, 0.1, 0.95)
    return _image(rgba)


def _mesh(made: Triangles, uv: Floats, material: Any) -> Any:
    from trimesh import Trimesh, visual

    textured: Any = visual.TextureVisuals
    return Trimesh(
        made.vertices, made.faces, visual=textured(uv=uv, material=material), process=False
    )


def _material(**given: Any) -> Any:
    """Return a matt, double-sided material."""
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
