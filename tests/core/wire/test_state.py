"""States as text for people: no raw bytes, the cause of silence, and problems before normal values."""

import sys
from typing import Any

import numpy as np
import pytest

from pacinian.wire.binary_arrays import pack
from pacinian.wire.replies import Abilities, Plugin, Pressures, Shown
from pacinian.wire.state import ClientState, FrameState, State
from pacinian.wire.state_wording import share

GIVEN: dict[str, Any] = {
    "sequence": 7, "time": 1.0, "output": "sounding", "armed": True, "owner": "game", "scene": "hall",
    "solver": "auto", "backend": "simulated", "technique": "", "intensity": 1.0, "error": 0.002,
    "points": pack([(0.0, 0.0, 0.2)] * 2), "asked": pack([5.0, 6.0]), "achieved": pack([5.0, 5.9]),
    "objects": ("ball",), "hands": pack(np.zeros((1, 26, 3))), "ticks": 2000, "late": 30, "rate": 1000.0,
    "felt": np.array([(1.0, 0.02, 0.0, 0.5)], "<f4").tobytes(),
    "skipped": {"solve, nothing moved": 1500, "missed ticks": 3},
    "faults": ("first", "last"), "fault_count": 2, "restarts": {"render": 1, "bus": 0},
    "clients": (ClientState(name="game", scene="hall", owner=True, objects=1, commands=9, errors=0,
                            dropped=0, age=0.001, renewed=0.01),),
}  # fmt: skip
SOUNDING = State(**GIVEN)


def test_a_state_says_in_a_line_what_it_emits() -> None:
    line = repr(SOUNDING)
    assert line == (
        '<State 7: sounding, armed by "game": 2 samples of 1 object, 1 hand, error 0.20%>'
    )
    silent = State(**{**GIVEN, "output": "silent", "cause": "not armed", "why": "call arm()"})
    assert repr(silent) == "<State 7: silent: call arm()>"


def test_rows_fold_what_is_normal() -> None:
    rows = SOUNDING.summarise()
    assert rows["output"] == "sounding, armed"
    assert "why" not in rows
    assert rows["ticks"] == "2,000 at 1000 Hz, 2 % late"
    assert rows["left out"] == "3 missed ticks; work saved 1,500 times"
    assert rows["restarts"] == "1 render"
    assert rows["faults"].startswith("2")
    assert [rows["  1"], rows["  2"]] == ["last", "first"]
    assert "force 100.0%" in rows["felt of ball"]
    assert "errors" not in rows["client game"]
    calm = State(**{**GIVEN, "restarts": {}, "faults": (), "fault_count": 0}).summarise()
    assert not {"restarts", "faults"} & calm.keys()


def test_a_notebook_shows_the_same_rows() -> None:
    html = SOUNDING._repr_html_()
    assert html is not None
    assert "work saved 1,500 times" in html
    assert "<img" not in html


@pytest.mark.parametrize(
    ("message", "says"),
    [
        (SOUNDING, "sounding"),
        (FrameState(sequence=3, time=1.0, phases=2, amplitudes=2, phase=bytes(8), amplitude=bytes(8)),
         "a row of 4 levels"),
        (FrameState(sequence=3, time=1.0, phases=2, amplitudes=2, phase=b"", amplitude=b""), "silent"),
        (Shown(scene="hall", version=4, names=("a", "b"), poses=pack(np.zeros((2, 7))), objects={}),
         "2 objects (a, b)"),
        (Pressures(pressures=bytes(24), time=1.5), "at 3 points"),
        (Abilities(solvers=(Plugin(name="gs"),), backends=(), techniques=(), presets=(), positions=bytes(24),
                   normals=bytes(24), frequency=4e4, wavelength=0.0085, phases=2, amplitudes=2,
                   device_rate=1e3, rate=1e3, limits={}), "2 transducers, 1000 Hz; solvers gs; backends none yet"),
    ],
)  # fmt: skip
def test_no_text_of_a_message_holds_raw_bytes(message: object, says: str) -> None:
    assert says in repr(message)
    assert "\\x" not in repr(message)
    assert len(repr(message)) < 200


def test_a_share_is_none_only_of_nothing() -> None:
    assert share(0, 0) == "0 %"
    assert share(1, 10**9) == "0.01 %"
    assert share(1, 300) == "0.33 %"
    assert share(99, 100) == "99 %"


def test_states_are_decoded_without_loading_scenes() -> None:
    """A light client does not need scenes, and prints a state only for a person."""
    import subprocess

    names = {"pacinian.wire.state_wording", "pacinian.wire.felt_regions"}
    code = f"import sys, pacinian.wire.codec; print(sorted({names!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
