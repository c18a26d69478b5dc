"""An array study: a ring of eight points from arrays of one area, with ever fewer transducers, regular or not."""

import sys
import tempfile

import pacinian_lab.study as ps
from pacinian.plot import figure, save

study = ps.Study(
    layouts=(  # a tuple in the place of a value is swept
        ps.Lattice(width=0.2, pitch=(0.008, 0.01, 0.0125, 0.016, 0.02)),  # [m]
        ps.Sunflower(diameter=0.226, count=(676, 441, 289, 169, 121)),
    ),
    patterns=(ps.Circle(radius=0.03, count=8),),  # in the plane z = 0.2 m
    picture=ps.Picture(side=0.3, step=0.003),
)
with tempfile.TemporaryDirectory() as folder:  # one that stays lets a study go on
    rows = ps.run(study, folder, workers=0).to_pylist()  # 0: in this process
page = figure(6.0, 3.2)
panel = page.subplots()
for kind, mark in (("lattice", "o"), ("sunflower", "s")):
    mine = [row for row in rows if row["layout.type"] == kind]
    counts, side_lobes = ([row[name] for row in mine] for name in ("transducers", "side_lobe"))
    panel.plot(counts, side_lobes, mark, label=kind)
    for count, level in zip(counts, side_lobes, strict=True):
        print(f"{kind:10} {count:4} transducers, side lobes {level:6.1f} dB")
panel.set(xlabel="transducers", ylabel="largest side lobe [dB]", title="Eight points by 20 cm")
panel.legend()
save(page, sys.argv[1] if len(sys.argv) > 1 else "array_study.png")
