"""Notebooks: what they show of an object, and how far a run is.

cards.py   `_repr_html_` of the classes, in one form        bars.py   `progress`, in terminals too
"""

from __future__ import annotations

from pacinian.notebook.bars import progress
from pacinian.notebook.cards import MAX_ROWS, Card, card

__all__ = ["MAX_ROWS", "Card", "card", "progress"]
