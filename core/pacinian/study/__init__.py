"""Studies: how the arrangement of an array shapes the image. Needs `pip install "pacinian[study]"`."""

from __future__ import annotations

from pacinian.study.file import Study, read
from pacinian.study.work import load, run

__all__ = ["Study", "load", "read", "run"]
