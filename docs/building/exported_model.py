"""Draw docs/pictures/plot-export.png: the model of docs/plots.md in three.js. Needs Chromium and viewer/node_modules.

python docs/building/exported_model.py
"""

from __future__ import annotations

import functools
import re
import shutil
import tempfile
import threading
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from io import BytesIO
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).parents[2]
SIZE = 900, 580  # [px]
PAGE = """<!doctype html><style>body { margin: 0 }</style>
<script type="importmap">{"imports": {"three": "/viewer/three.module.js", "three/addons/": "/addons/"}}</script>
<script type="module">
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
const scene = new THREE.Scene();
scene.background = new THREE.Color("#f4f6f8");
scene.add(new THREE.HemisphereLight("#ffffff", "#b8c0c8", 3.0));
const camera = new THREE.PerspectiveCamera(23, innerWidth / innerHeight, 0.01, 10);
camera.position.set(0.62, 0.62, 0.95);
camera.lookAt(0.0, 0.085, 0.0);
const model = await new GLTFLoader().loadAsync("/ring.glb");
scene.add(model.scene);
renderer.render(scene, camera);
document.title = "drawn";
</script>"""


class Files(SimpleHTTPRequestHandler):
    """Serve the page, the model and three.js."""

    def __init__(self, *args: object, folder: Path) -> None:
        self.model = folder
        super().__init__(*args)  # type: ignore[arg-type]

    def translate_path(self, path: str) -> str:
        """Return the file of a path."""
        three = ROOT / "viewer/node_modules/three"
        if path.startswith("/addons/"):
            return str(three / "examples/jsm" / path.removeprefix("/addons/"))
        if path.startswith("/viewer/"):
            return str(three / "build" / path.removeprefix("/viewer/"))
        return str(self.model / path.removeprefix("/"))

    def log_message(self, *args: object) -> None:
        """Log nothing."""


def export(folder: Path) -> None:
    """Run the block of docs/plots.md that exports, for its .glb."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs/plots.md").read_text("utf-8"), re.S)
    (block,) = (found for found in blocks if "plot.export" in found)
    lines = [line for line in block.splitlines() if ".vti" not in line]
    code = "\n".join(lines).replace('"ring.glb"', repr(str(folder / "ring.glb")))
    exec(compile(code, "docs/plots.md", "exec"), {})


def draw(path: Path) -> None:
    """Draw the picture."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        export(folder)
        (folder / "page.html").write_text(PAGE)
        server = ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Files, folder=folder))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(
                executable_path=shutil.which("chromium"),
                args=[
                    "--headless=new",
                    "--no-sandbox",
                    "--use-gl=angle",
                    "--use-angle=swiftshader",
                ],
            )
            page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
            page.goto(f"http://127.0.0.1:{server.server_port}/page.html")
            page.wait_for_function("document.title === 'drawn'", timeout=120_000)
            data = page.screenshot()
            browser.close()
        server.shutdown()
    Image.open(BytesIO(data)).convert("RGB").quantize(256).save(path, "PNG", optimize=True)


if __name__ == "__main__":
    draw(ROOT / "docs/pictures/plot-export.png")
