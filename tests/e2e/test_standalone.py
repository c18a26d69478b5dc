"""The standalone server, where there is neither Python nor anything else than the C library and zlib."""

from __future__ import annotations

import importlib.metadata
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import psutil
import pytest

import pacinian as pc
from pacinian.errors import Refused
from pacinian.plugins.registry import Plugins

from ..waiting import eventually

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import ModuleType

pytestmark = [pytest.mark.deep("unshare", "chroot", "ldd"), pytest.mark.timeout(900.0)]

BUILD = Path(__file__).parents[2] / "packaging" / "standalone" / "build.py"
LIMIT = 560.0  # [s]
NAMESPACE = "unshare", "--map-root-user", "--mount"
# A root folder of its own, with the system's processes, and memory that they share; then the program.
ENTER = """
root=$1; shift
mount --rbind /proc "$root/proc" && mount -t tmpfs tmpfs "$root/dev/shm" && mount --bind /dev/null "$root/dev/null" &&
exec env -i HOME=/ PATH=/ "$(command -v chroot)" "$root" "$@"
"""
LIBC = "libm.so.6", "librt.so.1"  # of the C library: numpy and ZeroMQ need them
GAME = "import subprocess, sys; subprocess.Popen(sys.argv[1:], stdin=subprocess.PIPE).wait()"
BALL = pc.Volume(
    shape=pc.Sphere(0.03), pose=pc.Pose((0.0, 0.0, 0.2)), radiation_pressure=8.0, name="ball"
)
HAND = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.235)))


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory, need: Callable[[str], ModuleType]) -> Path:
    """A root folder with the standalone server, and the libraries of the system that its program needs."""
    need("PyInstaller")
    probe = subprocess.run([*NAMESPACE, "true"], check=False, capture_output=True)
    if probe.returncode:
        pytest.skip("this user may not have namespaces")
    root = tmp_path_factory.mktemp("root")
    run([sys.executable, BUILD, root])
    needed = set(
        map(Path, re.findall(r"(?<=\s)/\S+", run(["ldd", root / "pacinian" / "pacinian"])))
    )
    beside = next(path.parent for path in needed if path.name.startswith("libc."))
    for library in needed | {beside / name for name in LIBC}:
        target = root / library.relative_to("/")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(library.read_bytes())
        target.chmod(0o755)
    for folder in ("proc", "dev/shm", "tmp"):
        (root / folder).mkdir(parents=True)
    (root / "dev/null").touch()
    return root


def run(words: list[str | Path]) -> str:
    """What a command says."""
    return subprocess.run(words, check=True, capture_output=True, text=True, timeout=LIMIT).stdout


def command(root: Path, *words: str) -> list[str | Path]:
    """A command of the standalone server, in its root folder."""
    return [*NAMESPACE, "sh", "-c", ENTER, "sh", root, "/pacinian/pacinian", *words]


@pytest.fixture
def game(root: Path) -> Generator[psutil.Popen]:
    """A game that has started the server."""
    serve = command(root, "serve", "--until-eof", "--quiet", "--connection", "/connection.json")
    with psutil.Popen([sys.executable, "-c", GAME, *serve]) as process:
        yield process
        process.kill()


def test_it_tells_the_plug_ins_and_versions_of_where_it_was_built_but_no_path(root: Path) -> None:
    offers = json.loads(run(command(root, "plugins", "--json")))["plugins"]
    ours = [offer for offer in Plugins().list() if not offer.plugin.startswith("lab")]
    assert {offer["name"] for offer in offers} == {offer.name for offer in ours}
    assert importlib.metadata.version("pacinian") in run(command(root, "--version"))
    told = {file.name for file in root.glob("pacinian/_internal/pacinian-*.dist-info/*")}
    assert told == {"METADATA", "entry_points.txt", "licenses"}


def test_a_game_outside_sounds_a_ball_and_when_it_is_killed_the_server_ends_in_order(
    root: Path, game: psutil.Popen
) -> None:
    file = root / "connection.json"
    eventually(file.exists)
    with pc.Client(file) as client:
        client.put(BALL)
        client.arm()

        def play() -> None:
            client.hands(HAND, wait=False)
            try:
                client.renew()
            except Refused:  # a process of the server hung on a busy machine
                client.arm()

        eventually(lambda: client.status().output == "sounding", play)
        processes = eventually(lambda: len(found := game.children(recursive=True)) == 5 and found)
        for process in processes:
            mapped = {
                Path(each.path) for each in process.memory_maps() if each.path.startswith("/")
            }
            assert mapped, process
            assert all(path.is_relative_to(root) for path in mapped)
        game.kill()
        assert not psutil.wait_procs(processes, LIMIT)[1]
    assert not file.exists()
