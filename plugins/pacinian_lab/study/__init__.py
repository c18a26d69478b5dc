"""Studies: how the arrangement of an array shapes the image. Needs `pip install "pacinian[study]"`.

What is asked        file.py      studies and their files          sweep.py    lists that stand for each of their values
                     layouts.py, arrangements.py                   planes.py, patterns.py
What is done         tasks.py     the tasks, and their keys        work.py     what is missing is computed
                     engine.py    by Dask                          store.py    and kept
What a worker does   worker.py    solves and measures              stage.py    what the tasks of one place share
                     measures.py  every column of the results      focus.py    how large a focus is
What is told         report.py    in Markdown                      images.py, charts.py
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
from pacinian_lab.study.work import load, run

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
