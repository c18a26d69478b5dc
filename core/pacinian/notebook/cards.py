"""HTML cards that notebooks show for an object: a short table, and a small picture if Matplotlib is installed."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from functools import wraps
from io import BytesIO
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

T = TypeVar("T")

MAX_ROWS = 20  # rows of a table
WIDTH, HEIGHT, DPI = 2.6, 1.9, 160  # size of the picture [inch] and its resolution [1/inch]
SHOWN_DPI = 100  # resolution at which a notebook shows the picture [1/inch]
LEFT = 'style="text-align:left"'


@dataclass(frozen=True)
class Card:
    """The contents of a card: title, rows of names and values, a table, and a small picture.

    table: header and the first `MAX_ROWS` rows. count: number of all its rows. draw: draws the picture into Matplotlib
    axes.
    """

    title: str
    rows: Mapping[str, object]
    table: Sequence[Sequence[object]] = ()
    count: int = 0
    draw: Callable[[Any], object] | None = None

    def html(self) -> str:
        """Return the card as HTML. All texts are escaped."""
        rows = "".join(f"<tr>{_cell('th', k)}{_cell('td', v)}</tr>" for k, v in self.rows.items())
        text = f"<b>{escape(self.title)}</b><table>{rows}</table>{self._format_table()}"
        picture = "" if self.draw is None else _picture(self.draw)
        return (
            f'<div style="display:flex;gap:1em;align-items:start"><div>{text}</div>{picture}</div>'
        )

    def _format_table(self) -> str:
        if not self.count:
            return ""
        head, *rows = self.table
        more = self.count - MAX_ROWS
        rest = f"<p>and {more} more</p>" if more > 0 else ""
        body = "".join(_row("td", row) for row in rows[:MAX_ROWS])
        return f"<table><thead>{_row('th', head)}</thead><tbody>{body}</tbody></table>{rest}"


def card(make: Callable[[T], Card]) -> Callable[[T], str | None]:
    """Decorate a method that makes a card as `_repr_html_`. If it fails, notebooks show the plain text."""

    @wraps(make)
    def shown(self: T) -> str | None:
        try:
            return make(self).html()
        except Exception:
            return None

    return shown


def _row(kind: str, cells: Iterable[object]) -> str:
    return f"<tr>{''.join(_cell(kind, cell) for cell in cells)}</tr>"


def escape(text: str) -> str:
    """Return a text as HTML."""
    import html  # 0.2 MB, which no process of the server needs

    return html.escape(text)


def _cell(kind: str, value: object) -> str:
    return f"<{kind} {LEFT}>{escape(str(value))}</{kind}>"


def _picture(draw: Callable[[Any], object]) -> str:
    """Return an inline picture, or "" without Matplotlib."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return ""
    page = Figure(figsize=(WIDTH, HEIGHT), layout="constrained")
    panel = page.subplots()
    draw(panel)
    panel.tick_params(labelsize=6)
    for text in (panel.xaxis.label, panel.yaxis.label):
        text.set_fontsize(7)
    buffer = BytesIO()
    page.savefig(buffer, format="png", dpi=DPI)
    data = b64encode(buffer.getvalue()).decode()
    size = f'width="{WIDTH * SHOWN_DPI:.0f}" height="{HEIGHT * SHOWN_DPI:.0f}"'
    return f'<img alt="" {size} src="data:image/png;base64,{data}">'
