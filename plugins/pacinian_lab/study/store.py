"""The folder of a study: parts as they are computed, and the joined table. Parquet, by pyarrow.

tasks.parquet     the tasks: a row for each, and the study's digest
parts/*.parquet   the measurements: a row for each task, each file written once and atomically
results.parquet   both, joined at the end of a run
lock              locked during a run
"""

from __future__ import annotations

import contextlib
import uuid
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pacinian.atomic_file import replace_file
from pacinian.errors import MissingExtra, RecordingError
from pacinian.exclusive_lock import try_lock
from pacinian_lab.study.measures import MEASURES
from pacinian_lab.study.tasks import describe_task

try:
    import pyarrow as pa
    import pyarrow.parquet as pq
except ImportError as error:
    raise MissingExtra("pyarrow", "study") from error

Table = Any  # pyarrow.Table; pyarrow has no type hints

if TYPE_CHECKING:
    from collections.abc import Generator, Sequence

    from pacinian_lab.study.tasks import Plan
    from pacinian_lab.study.worker import Row

DIGEST = b"pacinian_lab.study"
MEASURED = pa.schema(
    [
        ("key", pa.string()),
        ("failure", pa.string()),
        ("status", pa.string()),
        ("used", pa.string()),
        ("iterations", pa.int64()),
        ("transducers", pa.int64()),
        ("points", pa.int64()),
        ("aperture", pa.float64()),
        ("spacing", pa.float64()),
        ("rank", pa.int64()),
        *((name, pa.float64()) for name in MEASURES),
        ("seconds", pa.float64()),
    ]
)
TIMES = ("run_time", "seconds")
"""Columns that differ from run to run."""


class Folder:
    """The stored results of a study.

    unreadable: parts that could not be read, whose tasks will run again, and why. Raises OSError.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.unreadable = path, dict[Path, str]()
        self._parts = path / "parts"

    def open(self) -> None:
        """Make the folder if it does not exist."""
        self._parts.mkdir(parents=True, exist_ok=True)

    @contextlib.contextmanager
    def lock(self) -> Generator[None]:
        """Open the folder for one run at a time. Raises RecordingError."""
        try:
            self.open()
            file = (self.path / "lock").open("ab")
        except OSError as error:
            problem = f"cannot be made or written: {error.strerror or error}"
            raise RecordingError(self.path, problem) from error
        with file:
            if not try_lock(file.fileno()):
                raise RecordingError(
                    self.path,
                    "is in use by another run of a study: wait for its end, or use `--out`",
                )
            yield

    def rows(self) -> dict[str, Row]:
        """Return all measurements, by the tasks' keys."""
        self.unreadable.clear()
        found: dict[str, Row] = {}
        for part in sorted(self._parts.glob("*.parquet")):
            try:
                rows = pq.read_table(part).select(MEASURED.names).cast(MEASURED).to_pylist()
            except (pa.ArrowException, KeyError, OSError) as error:
                self.unreadable[part] = str(error)
                continue
            for row in rows:
                if row["failure"] is None or row["key"] not in found:
                    found[row["key"]] = row
        return found

    def set_aside_unreadable(self) -> None:
        """Rename the parts that could not be read, so that no later run reads them again."""
        for part in self.unreadable:
            with contextlib.suppress(OSError):
                part.rename(part.with_suffix(".unreadable"))

    def add(self, rows: Sequence[Row]) -> None:
        """Store rows atomically: after a crash, either all or none of them are there."""
        table = pa.Table.from_pylist(list(rows), schema=MEASURED)
        self._write(table, self._parts / f"{uuid.uuid4().hex}.parquet")

    def read_asked(self) -> tuple[str, set[str]]:
        """Return the digest and the keys of the previous study, or empty values if there is none that can be read."""
        try:
            table = _read_table(self.path / "tasks.parquet")
        except RecordingError:
            return "", set()
        digest = (table.schema.metadata or {}).get(DIGEST, b"").decode()
        return digest, set(table.column("key").to_pylist())

    def ask(self, plan: Plan) -> None:
        """Write the tasks of the current study."""
        rows = [describe_task(task) for task in plan.tasks]
        names = dict.fromkeys(name for row in rows for name in row)
        table = pa.table({name: pa.array([row.get(name) for row in rows]) for name in names})
        table = table.replace_schema_metadata({DIGEST: plan.digest.encode()})
        self._write(table, self.path / "tasks.parquet")

    def join_table(self) -> Table:
        """Return the finished tasks with their measurements, a row for each. Raises RecordingError."""
        asked = _read_table(self.path / "tasks.parquet")
        rows = self.rows()
        done = asked.filter(
            pa.array([key in rows for key in asked.column("key").to_pylist()], pa.bool_())
        )
        found = [rows[key] for key in done.column("key").to_pylist()]
        measured = pa.Table.from_pylist(found, schema=MEASURED).drop_columns("key")
        for name in measured.column_names:
            done = done.append_column(name, measured.column(name))
        return done

    def finish(self) -> Table:
        """Write the table and return it."""
        table = self.join_table()
        self._write(table, self.path / "results.parquet")
        return table

    def _write(self, table: Table, path: Path) -> None:
        with replace_file(path) as file:
            pq.write_table(table, file)


def _read_table(path: Path) -> Table:
    try:
        return pq.read_table(path)
    except (pa.ArrowException, OSError) as error:
        raise RecordingError(path, f"is not a table of a study: {error}") from error
