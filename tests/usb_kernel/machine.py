"""A machine in QEMU whose kernel has USB: it runs the cases of `guest/`, and leaves their results one by one."""

from __future__ import annotations

import json
import os
import platform
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from types import TracebackType

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
KERNEL = CACHE / "pacinian" / "kernel"  # as `kernel` leaves it
APPLETS = "sh", "mount", "insmod", "mkdir", "switch_root"
MAX_SECONDS = 1800.0  # [s] from the start to the last result: only ends what hangs
# QEMU 7.2 may hang before the kernel's first line: then it is started again
MAX_BOOT_SECONDS, MAX_BOOTS = 300.0, 3
# AVX2, as that processor does not have it, is emulated wrongly by QEMU 7.2: NumPy sorts falsely with it
PROCESSOR = "Nehalem"
START = """
exec >/run/out/said 2>&1
cd {root}
export PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/run TMPDIR=/run PYTHONPATH={path}
export PYTHONDONTWRITEBYTECODE=1 PYTEST_DISABLE_PLUGIN_AUTOLOAD=1
for udevd in /lib/systemd/systemd-udevd /usr/lib/systemd/systemd-udevd; do
    [ -x $udevd ] && $udevd --daemon && break
done
{python} -P tests/usb_kernel/guest/run.py /run/out/results
echo o >/proc/sysrq-trigger
sleep 60
"""


def need_kernel() -> None:
    """Skip the test where this machine cannot have a guest; fail it where CI is set and it could."""
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        pytest.skip("the guest's root is the host's: that must be Linux on x86-64")
    if not KERNEL.exists():
        reason = f"no guest's kernel in {KERNEL}; `.ci/setup` builds it"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)


class Machine:
    """Runs from its start until all cases are done. A context manager. folder: for what it needs and leaves."""

    def __init__(self, folder: Path) -> None:
        self._out = folder / "out"
        self._out.mkdir()
        python, path = shlex.quote(sys.executable), shlex.quote(os.environ.get("PYTHONPATH", ""))
        start = START.format(root=shlex.quote(str(ROOT)), python=python, path=path)
        (self._out / "start").write_text(start)
        self._results: dict[str, dict[str, Any]] = {}
        self._begun = time.monotonic()
        self._console = folder / "console"
        self._command = _command(_ramdisk(folder), self._out, self._console)
        self._boots = 0
        self._boot()

    def _boot(self) -> None:
        self._boots, self._booted = self._boots + 1, time.monotonic()
        self._process = subprocess.Popen(self._command, stdin=subprocess.DEVNULL)

    def _boot_again(self) -> None:
        """Start it again if it hangs in QEMU, before anything of ours runs."""
        silent = not (self._out / "said").exists()
        if (
            silent
            and self._boots < MAX_BOOTS
            and time.monotonic() - self._booted > MAX_BOOT_SECONDS
        ):
            self.__exit__(None, None, None)
            self._boot()

    def result(self, case: str) -> dict[str, Any]:
        """What became of a case, once that is known. Fails if it never will be."""
        while case not in self._results:
            self._boot_again()
            ended = self._process.poll() is not None
            self._read()
            if case in self._results:
                break
            late = time.monotonic() - self._begun > MAX_SECONDS
            if ended or late:
                why = "the guest has ended" if ended else f"not within {MAX_SECONDS:g} s"
                pytest.fail(f"no result of {case}: {why}\n{self._said()}", pytrace=False)
            time.sleep(0.02)
        return self._results[case]

    def _read(self) -> None:
        """The results that there are; the last line may not be whole."""
        file = self._out / "results"
        lines = file.read_text("utf-8").split("\n")[:-1] if file.exists() else []
        for line in lines[len(self._results) :]:
            told = json.loads(line)
            self._results[told["name"]] = told

    def _said(self) -> str:
        """The ends of what it said, and of its console."""
        files = self._out / "said", self._console
        return "\n".join(f.read_text("utf-8", "replace")[-4000:] for f in files if f.exists())

    def __enter__(self) -> Machine:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._process.kill()
        self._process.wait()


def _ramdisk(folder: Path) -> Path:
    """What the kernel starts with: busybox, the modules, and `init`."""
    root, file = folder / "root", folder / "ramdisk"
    for name in ("bin", "dev", "proc", "sys", "root"):
        (root / name).mkdir(parents=True)
    shutil.copytree(KERNEL / "modules", root / "modules")
    shutil.copy(HERE / "init", root / "init")
    busybox = shutil.which("busybox")
    assert busybox is not None
    shutil.copy(busybox, root / "bin" / "busybox")
    for name in APPLETS:
        (root / "bin" / name).symlink_to("busybox")
    names = "\n".join(str(path.relative_to(root)) for path in sorted(root.rglob("*")))
    with file.open("wb") as made:
        command = ["cpio", "-o", "-H", "newc", "--quiet"]
        subprocess.run(command, input=names.encode(), stdout=made, cwd=root, check=True)
    return file


def _command(ramdisk: Path, out: Path, console: Path) -> list[str]:
    share = "local,security_model=none"
    return [
        "qemu-system-x86_64", "-accel", "tcg,thread=multi", "-cpu", PROCESSOR, "-smp", "2", "-m", "1024",
        "-nodefaults", "-nographic", "-no-reboot", "-serial", f"file:{console}",
        "-kernel", str(KERNEL / "vmlinuz"), "-initrd", str(ramdisk),
        "-append", "console=ttyS0 quiet panic=-1 mitigations=off no_timer_check",
        "-fsdev", f"{share},id=root,path=/,readonly=on,multidevs=remap",
        "-device", "virtio-9p-pci,fsdev=root,mount_tag=root",
        "-fsdev", f"{share},id=out,path={out}",
        "-device", "virtio-9p-pci,fsdev=out,mount_tag=out",
    ]  # fmt: skip
