"""Notebook display: HTML cards of objects, and progress bars.

cards.py   `_repr_html_` of the classes, in one form
bars.py    `progress`, also in terminals
"""

from __future__ import annotations

from pacinian.notebook.bars import progress
from pacinian.notebook.cards import MAX_ROWS, Card, card

__all__ = ["MAX_ROWS", "Card", "card", "progress"]
