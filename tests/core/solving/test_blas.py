"""BLAS threads: one for small problems, as before afterwards."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import pacinian as pc
from pacinian.solving.blas import MAX_ELEMENTS, limit_blas_threads


def threads() -> set[int]:
    return {
        library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"
    }


def test_small_problems_have_one_thread_and_large_ones_what_there_was() -> None:
    pc.solve(pc.lattice(0.02, 0.02), [[0, 0, 0.1], [0.01, 0, 0.1]], [1.0, 1.0])  # loads BLAS
    with threadpool_limits(2):
        before = threads()
        with limit_blas_threads():
            assert threads() == {1}
            with limit_blas_threads():
                assert threads() == {1}
            assert threads() == {1}
        assert threads() == before
        a, b = limit_blas_threads(), limit_blas_threads()  # two requests, interleaved
        a.__enter__()
        b.__enter__()
        a.__exit__(None, None, None)
        assert threads() == {1}
        b.__exit__(None, None, None)
        assert threads() == before
        with limit_blas_threads(MAX_ELEMENTS):
            assert threads() == before
        with pytest.raises(ZeroDivisionError), limit_blas_threads():
            1 / 0  # noqa: B018
        assert threads() == before
        assert np.isfinite(pc.solve(pc.autd(), [[0, 0, 0.2]] * 2, [1.0, 1.0]).error)
        assert threads() == before
