"""Options of a plug-in that clients may set: only those that its annotations bound."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass
from pathlib import Path  # noqa: TC003, which is asked for at run time
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args, get_origin

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import Meta

import pacinian as pc
from pacinian.errors import ArgumentError
from pacinian.plugins.options import check_options, find_client_options
from pacinian.plugins.registry import discover_plugins

if TYPE_CHECKING:
    from collections.abc import Sequence


class Mode(enum.Enum):
    SOFT = "soft"
    HARD = "hard"


@dataclass
class Careless:
    """A plug-in that bounds only some of its options."""

    levels: Annotated[int, Meta(ge=2, le=256)] = 16
    share: Annotated[float, Meta(gt=0.0, lt=1.0)] | None = None
    table: Annotated[int, Meta(ge=1, le=4)] | tuple[float, ...] = 1
    loud: bool = False
    link: Literal["udp", "usb"] = "usb"
    mode: Mode = Mode.SOFT
    file: str = ""
    path: Path | None = None
    folder: str | None = None
    steps: int = 1
    scale: float = 1.0
    low: Annotated[int, Meta(ge=0)] = 0
    high: Annotated[float, Meta(le=1.0)] = 0.0
    endless: Annotated[float, Meta(ge=-math.inf, le=math.inf)] = 0.0
    short: Annotated[str, Meta(max_length=8)] = ""
    names: Sequence[str] = ()
    anything: Any = None
    wait: Annotated[int, "Meta(ge=0, le=1)"] = 0
    bare: object = None


MAY = {"levels", "share", "table", "loud", "link", "mode"}


def test_what_is_bounded_may_be_set_and_all_else_not() -> None:
    assert set(find_client_options(Careless)) == MAY


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("levels", 256, 256),
        ("levels", 5.0, 5),
        ("share", 0.5, 0.5),
        ("table", 4, 4),
        ("loud", True, True),
        ("link", "udp", "udp"),
        ("mode", "hard", Mode.HARD),
    ],
)
def test_within_its_bounds_a_value_is_taken(name: str, value: Any, expected: Any) -> None:
    assert check_options(Careless, {name: value}) == {name: expected}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("levels", 1),
        ("levels", 10**8),
        ("levels", 5.5),
        ("levels", True),
        ("levels", "5"),
        ("share", 0.0),
        ("share", math.nan),
        ("table", "0, 1"),
        ("loud", 1),
        ("link", "/etc/passwd"),
        ("mode", "x" * 10**6),
    ],
)
def test_beyond_them_it_is_refused(name: str, value: Any) -> None:
    with pytest.raises(ArgumentError, match="not what clients may set it to") as raised:
        check_options(Careless, {name: value})
    assert raised.value.argument == name


@given(
    st.sampled_from(sorted({*Careless.__dataclass_fields__, "no such one"} - MAY)),
    st.one_of(st.booleans(), st.integers(), st.floats(), st.text(max_size=200)),
)
def test_what_is_the_owners_is_refused_whatever_the_value(name: str, value: Any) -> None:
    with pytest.raises(
        ArgumentError, match="can only be set in the server's configuration"
    ) as raised:
        check_options(Careless, {"loud": True, name: value})
    assert repr(value) not in str(raised.value) or len(repr(value)) < 5


def test_what_cannot_be_read_is_the_owners() -> None:
    class Later:
        def __init__(self, x: NotThere = 1, y: bool = True) -> None:  # type: ignore[name-defined]  # noqa: F821
            pass

    assert set(find_client_options(Later)) == {"y"}


@pytest.mark.parametrize("offer", discover_plugins().list(), ids=lambda offer: offer.name)
def test_installed_plug_ins_take_the_ends_of_what_they_let_clients_set(offer: Any) -> None:
    for name, kinds in find_client_options(offer.cls).items():
        for kind in kinds:
            if get_origin(kind) is not Annotated:
                continue
            number, meta = get_args(kind)
            ends = meta.ge if meta.gt is None else 1e-9, meta.le
            for end in ends:
                made = offer.cls(**check_options(offer.cls, {name: number(end)}))
                assert getattr(made, name) == end


def test_no_device_is_given_a_file_an_address_or_a_watchdog_by_clients() -> None:
    """Only the operator of the server chooses the device and its safety settings."""
    plugins = discover_plugins()
    found = {o.name: set(find_client_options(o.cls)) for o in plugins.list() if o.kind == "backend"}
    assert found.pop("simulated") == {"phases", "amplitudes", "rate"}
    assert found == {
        "autd3": set(), "openmpd": set(), "sonicsurface": set(), "usb-autd": {"pretend"},
    }  # fmt: skip
    assert issubclass(plugins.find("solver", "auto").cls, pc.Solver)
