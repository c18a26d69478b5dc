"""Shared by tests of plots."""

from collections.abc import Callable, Iterator
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest
from matplotlib.figure import Figure


@pytest.fixture
def axes() -> Callable[..., Any]:
    """Return a function that makes axes of a user's own figure."""

    def made(count: int = 1) -> Any:
        found = Figure(figsize=(4.0, 3.0)).subplots(count, 1, squeeze=False).ravel().tolist()
        return found[0] if count == 1 else found

    return made


@pytest.fixture(autouse=True)
def untouched() -> Iterator[None]:
    """Check that no plot changes global state: Matplotlib's settings and pyplot's figures."""
    before = dict(mpl.rcParams)
    yield
    assert dict(mpl.rcParams) == before
    assert not plt.get_fignums()
