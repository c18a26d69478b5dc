"""The kernels with sanitizers: no test of theirs goes beyond an array, or does what C++ does not define."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CHECKS = "address,undefined"
# tests of kernels, which call nearly all of them
TESTS = (
    "tests/core/acoustics/test_propagation.py",
    "tests/core/acoustics/test_skin_facing.py",
    "tests/core/rendering/test_levels.py",
    "tests/core/rendering/test_reachability.py",
    "tests/core/rendering/test_smoothing.py",
    "tests/core/scene/hands/test_skin.py",
    "tests/core/scene/sampling/test_broad_phase.py",
    "tests/core/scene/sampling/test_small_region_spacing.py",
    "tests/core/scene/sampling/test_sample_kernels.py",
    "tests/core/scene/sampling/test_silent_samples.py",
    "tests/core/scene/shapes/test_mesh_distance.py",
    "tests/core/scene/shapes/test_triangles.py",
    "tests/core/solving/test_kernels.py",
    "tests/core/solving/test_region_groups.py",
    "tests/core/solving/test_error_lower_bound.py",
    "tests/core/test_neighbours.py",
    "tests/plugins/lagrange/test_convex.py",
    "tests/plugins/lagrange/test_region_newton.py",
    "tests/plugins/lagrange/test_steps.py",
    "tests/plugins/test_published.py",
)
# those of whole solves, and of the shape of skin, take long and call no other kernels
LONG = (
    "sound_keeps_off",
    "get_no_surround",
    "is_even_between",
    "area_is_that",
    "points_between_the_others",
    "reference_on_a_hand",
    "inside_of_a_small_solid",
    "moves_continuously_as_the_hand_closes",
    "walk_along_each_capsule",
    "fewer_products_with_blocks",
)
# samples of groups, of which the output has one: kernels do not check indices that come from our own code
SUM = """
import sys
import numpy as np
import tests.sanitized
from pacinian.native import solving
B, p, rows = np.ones((2, 8), np.complex64), np.ones(2, complex), np.empty((1, 8), np.complex64)
solving.sum_group_rows(B, p, np.array([0, int(sys.argv[1])]), rows)
"""


# one test, because each process would compile the kernels anew
@pytest.mark.deep("g++")
@pytest.mark.timeout(1800.0)
def test_kernels_stay_within_their_arrays() -> None:
    environment = compile_kernels()

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *words],
            env=environment,
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )

    assert run("-c", SUM, "0").returncode == 0
    beyond = run("-c", SUM, "1")
    assert beyond.returncode != 0
    assert "heap-buffer-overflow" in beyond.stderr
    # -s, so that what a sanitizer says is not captured
    done = run(
        "-m", "pytest", "-p", "tests.sanitized", "-p", "no:cacheprovider", "-qs", "-n", "0",
        "-k", f"not ({' or '.join(LONG)})", *TESTS,
    )  # fmt: skip
    assert done.returncode == 0, (done.stdout[-4000:], done.stderr[-8000:])
    assert " passed" in done.stdout


def compile_kernels() -> dict[str, str]:
    """Compile the kernels with sanitizers; return the environment of a process that imports them."""
    sys.path.insert(0, str(ROOT))
    try:
        build = importlib.import_module("native_build")
    finally:
        sys.path.remove(str(ROOT))
    build.build(sanitize=CHECKS)
    libraries = [
        subprocess.check_output(
            [*build.find_system_compiler().command, f"-print-file-name={name}"], text=True
        ).strip()
        for name in ("libasan.so", "libstdc++.so.6")
    ]
    return {
        **os.environ,
        "LD_PRELOAD": " ".join(libraries),
        # Python keeps what it has. Its objects need no watching, which would take half of the time: arrays come from
        # the system's `malloc`.
        "ASAN_OPTIONS": "detect_leaks=0",
        "UBSAN_OPTIONS": "print_stacktrace=1",
        "PACINIAN_SANITIZED": str(ROOT / "build" / f"native-{CHECKS.replace(',', '-')}"),
        "PACINIAN_VARIANT": "plain",
    }
