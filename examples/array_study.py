"""An array study: a ring of eight points from arrays of one size, ever coarser, regular or not."""

import sys
import tempfile
from pathlib import Path

import pacinian.study as ps
from pacinian.plot import figure, save

STUDY = """
title = "Pitch"
layouts = [
  { type = "lattice", width = 0.2, pitch = [0.008, 0.01, 0.0125, 0.016, 0.02] },
  { type = "sunflower", diameter = 0.22, count = [121, 169, 289, 441] },
]
patterns = [{ type = "circle", radius = 0.03, count = 8 }]
picture = { side = 0.3, step = 0.003 }
"""

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "pitch.toml"
    file.write_text(STUDY)
    rows = ps.run(ps.read(file), Path(folder) / "out", workers=0).to_pylist()  # 0: in this process
page = figure(6.0, 3.2)
panel = page.subplots()
for kind, mark in (("lattice", "o"), ("sunflower", "s")):
    mine = [row for row in rows if row["layout.type"] == kind]
    counts = [row["transducers"] for row in mine]
    panel.plot(counts, [row["side_lobe"] for row in mine], mark, label=kind)
    for row in mine:
        print(
            f"{kind:10} {row['transducers']:4} transducers, side lobes {row['side_lobe']:6.1f} dB"
        )
panel.set(xlabel="transducers", ylabel="side lobes [dB]", title="Eight points by arrays of 20 cm")
panel.legend()
save(page, sys.argv[1] if len(sys.argv) > 1 else "array_study.png")
