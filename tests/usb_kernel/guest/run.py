"""Run the cases, in the guest; each result is written down as soon as it is there: run.py FILE."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parents[2]
CASES = sorted(HERE.glob("cases_*.py"))
HANGS = 200  # [s] after which a case says where it is


def names() -> list[str]:
    """Of the cases, in their order."""
    return [
        n for file in CASES for n in re.findall(r"^def (test_\w+)", file.read_text("utf-8"), re.M)
    ]


class Results:
    """Writes a line of JSON for each case: its name, what it noted, and what went wrong."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._seconds = 0.0
        self._wrong = ""

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """One of set-up, call, and end."""
        self._seconds += report.duration
        if not report.passed:
            self._wrong += f"{report.when}: {report.longreprtext}\n"
        if report.when != "teardown":
            return
        name = report.nodeid.rpartition("::")[2]
        noted = {"seconds in the guest": self._seconds, **dict(report.user_properties)}
        line: dict[str, Any] = {"name": name, "noted": noted, "wrong": self._wrong}
        with self._file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
        self._seconds, self._wrong = 0.0, ""


def main(results: Path) -> int:
    """The exit code."""
    options = [
        f"--rootdir={ROOT}", "--noconftest", "-c", "/dev/null", "-q", "-W", "error", "--import-mode=importlib",
        "-p", "no:cacheprovider", "-o", "python_files=cases_*.py", "-o", f"faulthandler_timeout={HANGS}",
    ]  # fmt: skip
    options += map(str, CASES)
    return pytest.main(options, plugins=[Results(results)])


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
