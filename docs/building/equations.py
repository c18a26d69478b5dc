"""Equations as MathML, which browsers draw by themselves: the pages load nothing from elsewhere."""

from __future__ import annotations

from typing import Any

from docutils.nodes import SkipNode
from latex2mathml.converter import convert


def setup(app: Any) -> dict[str, bool]:
    """Sphinx's entry point."""
    app.add_html_math_renderer("mathml", (inline, None), (displayed, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def inline(writer: Any, node: Any) -> None:
    """In a line of text."""
    writer.body.append(drawn(node.astext(), "inline"))
    raise SkipNode


def displayed(writer: Any, node: Any) -> None:
    """On a line of its own."""
    writer.body.append(f'<div class="equation">{drawn(node.astext(), "block")}</div>\n')
    raise SkipNode


def drawn(equation: str, display: str) -> str:
    """MathML of LaTeX. Raises ValueError where a command is not known."""
    made = convert(equation, display=display)
    if "\\" in made:
        raise ValueError(f"not known in an equation: {equation}")
    return made
