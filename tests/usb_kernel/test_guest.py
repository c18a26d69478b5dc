"""The backend `usb-autd` on a real kernel's USB: each case of `guest/`, as it went in a machine in QEMU."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from .guest.run import names
from .machine import MAX_SECONDS, Machine, need_kernel

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.deep("qemu-system-x86_64", "busybox", "cpio", "udevadm", "setpriv")


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Machine]:
    """It is started once, and goes on while the first results are looked at."""
    need_kernel()
    with Machine(tmp_path_factory.mktemp("machine")) as made:
        yield made


@pytest.mark.timeout(1.5 * MAX_SECONDS)
@pytest.mark.parametrize("case", names())
def test_in_the_guest(machine: Machine, case: str) -> None:
    result = machine.result(case)
    print(result["noted"])  # noqa: T201
    if result["wrong"]:
        pytest.fail(result["wrong"], pytrace=False)
