"""Studies: how the arrangement of an array shapes the image. Needs the extra `study`.

Definition
    study_file.py    `Study`: study files, their schema
    layouts.py       layouts: arrangements bent into space, real devices
    arrangements.py  positions in a plane: hexagonal, sunflower, rings, Poisson disc
    planes.py        planes of patterns
    patterns.py      focus, circle, grid, letters, random points
    sweep.py         lists in place of values: all combinations
Execution
    study_run.py     `run`, `load`: computes the missing tasks
    tasks.py         tasks, labels, keys of what a result depends on
    engine.py        runs tasks with Dask
    store.py         folder of results, Parquet
Worker
    worker.py        solves the tasks of one place and measures
    target_plane.py  what the tasks of one place share: B, field
    measures.py      columns of the results: error, yield, widths
    focus.py         widths of a focus, its main lobe
Report
    report.py        Markdown
    images.py        pictures of layouts and images
    charts.py        charts of measures
"""

from __future__ import annotations

from pacinian_lab.study.layouts import Autd, Device, Hexagonal, Lattice, Rings, Scattered, Sunflower
from pacinian_lab.study.patterns import (
    Circle,
    Focus,
    Letters,
    PointGrid,
    Points,
    RandomPoints,
    Shape,
)
from pacinian_lab.study.planes import Plane
from pacinian_lab.study.study_file import Method, Picture, Study, read
from pacinian_lab.study.study_run import load, run

__all__ = [
    "Autd",
    "Circle",
    "Device",
    "Focus",
    "Hexagonal",
    "Lattice",
    "Letters",
    "Method",
    "Picture",
    "Plane",
    "PointGrid",
    "Points",
    "RandomPoints",
    "Rings",
    "Scattered",
    "Shape",
    "Study",
    "Sunflower",
    "load",
    "read",
    "run",
]
