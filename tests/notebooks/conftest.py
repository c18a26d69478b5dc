"""A real kernel, as Jupyter's: cells in, messages out."""

import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from queue import Empty
from typing import Any

import pytest

from ..waiting import PATIENCE


@dataclass
class Cell:
    """What running a cell gave: bundles by MIME type, and what was printed."""

    shown: list[dict[str, Any]] = field(default_factory=list)
    updated: list[dict[str, Any]] = field(default_factory=list)
    text: str = ""
    warned: str = ""
    error: str = ""

    def take(self, kind: str, content: dict[str, Any]) -> None:
        if kind in ("display_data", "execute_result"):
            self.shown.append(content["data"])
        elif kind == "update_display_data":
            self.updated.append(content["data"])
        elif kind == "stream" and content["name"] == "stdout":
            self.text += content["text"]
        elif kind == "stream":
            self.warned += content["text"]
        elif kind == "error":
            self.error = f"{content['ename']}: {content['evalue']}"


class Kernel:
    """Runs cells, one at a time."""

    def __init__(self, manager: Any, client: Any) -> None:
        self.manager, self.client = manager, client

    def run(self, code: str, meanwhile: Callable[[Cell], bool] | None = None) -> Cell:
        """Run a cell to its end. meanwhile: called with what came so far, until it says that it is done."""
        cell, asked, end = Cell(), self.client.execute(code), time.monotonic() + PATIENCE
        while time.monotonic() < end:
            try:
                message = self.client.get_iopub_msg(timeout=1.0)
            except Empty:
                assert self.manager.is_alive(), "the kernel has died"
                continue
            if message["parent_header"].get("msg_id") != asked:
                continue
            content = message["content"]
            if message["msg_type"] == "status" and content["execution_state"] == "idle":
                return cell
            cell.take(message["msg_type"], content)
            if meanwhile is not None and meanwhile(cell):
                meanwhile = None
        pytest.fail(f"the cell does not end: {code}")

    def interrupted(self, code: str, when: str) -> Cell:
        """Run a cell that is interrupted, as by the stop button, once it has printed that."""

        def stop(cell: Cell) -> bool:
            if when in cell.text:
                self.manager.interrupt_kernel()
            return when in cell.text

        return self.run(code, stop)

    def restart(self) -> None:
        """As by the button: at once, with nothing left of what ran."""
        self.manager.restart_kernel(now=True)
        self.client.wait_for_ready(timeout=PATIENCE)


@pytest.fixture(scope="module")
def kernel(need: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    need("ipykernel")
    started = need("jupyter_client.manager")
    folder = tmp_path_factory.mktemp("jupyter")
    own = {
        **os.environ,
        "IPYTHONDIR": str(folder),
        "JUPYTER_RUNTIME_DIR": str(folder),
        "JUPYTER_CONFIG_DIR": str(folder),
    }
    manager, client = started.start_new_kernel(
        startup_timeout=PATIENCE, kernel_name="python3", env=own, cwd=str(folder)
    )
    try:
        yield Kernel(manager, client)
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)
        manager.cleanup_resources()
