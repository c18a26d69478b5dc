"""Saved work and problems are separated in the same way as on the viewer's page."""

import re
from pathlib import Path

from pacinian import skip_reasons
from pacinian.skip_reasons import SAVED, split_skips

ROOT = Path(__file__).parents[2]


def test_problems_are_listed_and_saved_work_is_folded() -> None:
    skipped = {
        "solve, nothing moved": 900, "missed ticks": 7, "drive, nothing changed": 300, "halted": 0, "other": 8,
    }  # fmt: skip
    found = split_skips(skipped)
    assert list(found.problems.items()) == [("other", 8), ("missed ticks", 7)]
    assert list(found.saved) == ["solve, nothing moved", "drive, nothing changed"]
    assert str(found) == "8 other; 7 missed ticks; work saved 1,200 times"
    assert str(split_skips({})) == "nothing"
    assert str(split_skips({"hands lost": 1})) == "a hand lost in 1 tick"
    assert str(split_skips({"hands lost": 2000})) == "a hand lost in 2,000 ticks"


def test_the_page_calls_the_same_reasons_saved() -> None:
    text = (ROOT / "viewer/src/panels/skip-reasons.ts").read_text()
    saved, _, problems = text.partition("const PROBLEMS")
    quoted = re.compile(r'^  "?([^":]+)"?:', re.MULTILINE)
    assert set(quoted.findall(saved)) == SAVED
    assert not set(quoted.findall(problems.partition("};")[0])) & SAVED


def test_the_page_knows_every_reason() -> None:
    constants = vars(skip_reasons).items()
    every = {reason for name, reason in constants if name.isupper() and isinstance(reason, str)}
    text = (ROOT / "viewer/src/panels/skip-reasons.ts").read_text()
    assert set(re.findall(r'^  "?([a-z][^":]+)"?: "', text, re.MULTILINE)) == every


def test_the_documentation_explains_every_reason_of_the_page() -> None:
    page = (ROOT / "viewer/src/panels/skip-reasons.ts").read_text()
    reasons = re.findall(r'^  "?([a-z][^":]+)"?: "', page, re.MULTILINE)
    explained = (ROOT / "docs/skipped.md").read_text()
    assert re.findall(r"^\| `([^`]+)` \|", explained, re.MULTILINE) == [
        *(reason for reason in reasons if reason not in SAVED),
        *(reason for reason in reasons if reason in SAVED),
    ]
