"""Studies: how the arrangement of an array shapes the image. Needs the extra `study`.

Definition   file.py      studies and their files          sweep.py    lists that are swept
             layouts.py, arrangements.py                   planes.py, patterns.py
Execution    tasks.py     the tasks, and their keys        study_run.py     computes missing tasks
             engine.py    runs them with Dask              store.py         stores the results
Worker       worker.py    solves and measures              target_plane.py  data that the tasks of one place share
             measures.py  the columns of the results       focus.py         the size of a focus
Report       report.py    Markdown                         images.py, charts.py
"""

from __future__ import annotations

from pacinian_lab.study.file import Method, Picture, Study, read
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
