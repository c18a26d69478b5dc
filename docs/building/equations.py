"""Render equations as MathML. Browsers draw it without a library, so the pages load nothing from other sites."""

from __future__ import annotations

from typing import Any

from docutils.nodes import SkipNode
from latex2mathml.converter import convert


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def visit_inline(writer: Any, node: Any) -> None:
    """Write an equation within a line of text."""
    writer.body.append(render_mathml(node.astext(), "inline"))
    raise SkipNode


def visit_block(writer: Any, node: Any) -> None:
    """Write an equation on a line of its own."""
    writer.body.append(f'<div class="equation">{render_mathml(node.astext(), "block")}</div>\n')
    raise SkipNode


def render_mathml(equation: str, display: str) -> str:
    """Convert LaTeX to MathML. Raises ValueError for an unknown command."""
    made = convert(equation, display=display)
    if "\\" in made:
        raise ValueError(f"unknown command in an equation: {equation}")
    return made
