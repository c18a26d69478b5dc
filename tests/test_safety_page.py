"""The page on safety says what its script prints."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

PAGE = Path(__file__).parents[1] / "docs" / "safety.md"


def test_the_levels_at_an_ear_are_those_that_the_script_prints() -> None:
    text = PAGE.read_text()
    (script,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(script, str(PAGE), "exec"), {})
    assert f"prints `{said.getvalue().strip()}`" in text
