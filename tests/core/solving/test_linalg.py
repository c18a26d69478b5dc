"""BLAS and LAPACK, loaded without the rest of SciPy."""

from __future__ import annotations

import subprocess
import sys

import pytest

LATER = """
import sys
from pacinian.solving.linalg import blas, lapack
assert not {"scipy", "scipy.linalg"} & set(sys.modules), "SciPy is loaded"
import numpy as np
a = np.array([[4.0, 2.0], [0.0, 3.0]], np.complex128, order="F")
assert np.allclose(lapack.zpotrf(a)[0], np.linalg.cholesky([[4.0, 2.0], [2.0, 3.0]]).T)
import scipy.linalg
assert scipy.linalg.lapack.zpotrf is lapack.zpotrf
assert scipy.linalg.blas.zherk is blas.zherk
assert np.allclose(scipy.linalg.solve([[2.0]], [4.0]), [2.0])
"""
ELSEWHERE = """
from importlib.machinery import PathFinder
find_spec, missed = PathFinder.find_spec, []
def find(name, path=None, target=None):
    if name.startswith("scipy.linalg._f") and name not in missed:
        missed.append(name)
        return None
    return find_spec(name, path, target)
PathFinder.find_spec = find
from pacinian.solving.linalg import blas, lapack
import scipy.linalg
assert len(missed) == 2
assert lapack is scipy.linalg.lapack and blas is scipy.linalg.blas
"""


@pytest.mark.parametrize("code", [LATER, ELSEWHERE], ids=["then SciPy", "elsewhere"])
def test_the_functions_are_those_of_scipy(code: str) -> None:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
