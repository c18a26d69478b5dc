"""Draw the gallery's thumbnails: python docs/building/thumbnails.py. Needs Pillow."""

from __future__ import annotations

import re
from pathlib import Path

from PIL import Image

DOCS = Path(__file__).parents[1]
WIDTH, HEIGHT = 320, 220  # [px]
NAMES = re.compile(r"pictures/thumbnails/([\w.-]+)\.webp")
# Parts of pictures that say more than the whole: left, top, right and bottom, 0 to 1.
PARTS = {
    "scene-": (0.55, 0.04, 0.9, 0.45),
    "example-texture": (0.54, 0.04, 0.93, 0.45),
    "viewer-hand": (0.0, 0.07, 0.75, 0.85),
    "viewer-error": (0.0, 0.07, 0.75, 0.85),
    "regions": (0.0, 0.0, 1.0, 0.5),
    "paper-experiment": (0.0, 0.2, 0.95, 0.75),
    "example-focus": (0.0, 0.06, 0.63, 1.0),
}


def draw(name: str) -> None:
    """Draw the thumbnail of a picture."""
    (source,) = (DOCS / "pictures").glob(f"{name}.*")
    with Image.open(source) as opened:
        picture = opened.convert("RGB")  # a film's first picture
    for prefix, (left, top, right, bottom) in PARTS.items():
        if name.startswith(prefix):
            w, h = picture.size
            picture = picture.crop((int(left * w), int(top * h), int(right * w), int(bottom * h)))
            break
    picture.thumbnail((2 * WIDTH, 2 * HEIGHT), Image.Resampling.LANCZOS)
    background = picture.getpixel((2, 2))
    page = Image.new("RGB", (2 * WIDTH, 2 * HEIGHT), background)
    page.paste(picture, ((2 * WIDTH - picture.width) // 2, (2 * HEIGHT - picture.height) // 2))
    page.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS).save(
        DOCS / f"pictures/thumbnails/{name}.webp", quality=82, method=6
    )


if __name__ == "__main__":
    (DOCS / "pictures/thumbnails").mkdir(exist_ok=True)
    for found in sorted(set(NAMES.findall((DOCS / "gallery.md").read_text("utf-8")))):
        draw(found)
