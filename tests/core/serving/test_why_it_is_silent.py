"""The cause of silence of a real server, as a client gets it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.scene.config_sections import Units
from pacinian.testing import run_server

from ...waiting import eventually
from ..client.long_timeouts import wait_long
from .processes import PATIENT

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from pacinian.wire.silence_cause import Cause, Silence

HIGH = pc.Pose((0.0, 0.0, 0.2))
HAND = pc.Hand.open(pose=HIGH)


@pytest.fixture(scope="module")
def connection() -> Iterator[Path]:
    with run_server(replace(PATIENT, array=Units(1, 1))) as server:
        yield server.connection


@pytest.fixture
def game(connection: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[pc.Client]:
    wait_long(monkeypatch)
    with pc.Client(connection, name="game") as client:
        yield client


def ball(height: float, pressure: float = 3.0) -> pc.Volume:
    return pc.Volume(
        shape=pc.Sphere(0.02),
        pose=pc.Pose((0.0, 0.0, height)),
        radiation_pressure=pressure,
        name="ball",
    )


def becomes(client: pc.Client, cause: Cause | None, *hands: pc.Hand) -> Silence | None:
    """Wait until the answer has this cause; return it. hands: sent in each frame of the game."""

    def ask() -> tuple[Silence | None] | None:
        client.renew()
        if hands:
            client.hands(*hands)
        found = client.explain_silence()
        return (found,) if (found.cause if found else None) == cause else None

    found = eventually(ask)
    assert found is not None
    return found[0]


def test_from_nothing_to_sound(game: pc.Client) -> None:
    """A game that forgot several things gets one cause after another, until it sounds."""
    assert "must arm" in str(becomes(game, "not armed"))
    game.arm()
    assert "must put them there" in str(becomes(game, "no objects"))
    game.put(ball(0.1))
    assert becomes(game, None) is None  # without a hand, the whole ball sounds
    game.hands()
    assert "no hand is seen" in str(becomes(game, "hand not seen"))
    found = str(becomes(game, "nothing in reach", HAND))
    gap = re.search(r'"ball" is nearest, (\d+) mm away', found)
    assert gap, found
    assert 50 < int(gap[1]) < 75  # from 120 mm to the skin of a palm at 200 mm
    game.move("ball", HIGH)
    assert becomes(game, None, HAND) is None
    game.select(intensity=0.0)
    assert "select one above 0" in str(becomes(game, "no pressure", HAND))
    game.select(intensity=1.0)
    assert becomes(game, None, HAND) is None
    assert "send it in each frame" in str(becomes(game, "hand not seen"))  # the tracker hangs


def test_a_touch_below_the_threshold(game: pc.Client) -> None:
    game.put(ball(0.2, pressure=1e-6))
    game.arm()
    assert "below the 0.22 Pa" in str(becomes(game, "too faint", HAND))


def test_a_touch_that_the_array_does_not_see(game: pc.Client) -> None:
    """The ball touches the back of the hand, which the hand itself hides from the array."""
    game.put(ball(0.228))
    game.arm()
    assert "turn the palm" in str(becomes(game, "out of the array's reach", HAND))


def test_a_lost_lease_and_an_emergency_stop(game: pc.Client, connection: Path) -> None:
    with pc.Client(connection, name="frozen", lease=0.05) as frozen:
        frozen.arm()

        def lost() -> str:  # another client asks, because the game is frozen
            found = game.explain_silence()
            return found.text if found and found.cause == "lease lost" else ""

        assert '"frozen" no longer renews its lease: the output sounds again' in eventually(lost)

        def goes_on() -> bool:
            frozen.renew()
            return frozen.armed

        assert eventually(goes_on)
        frozen.arm(resume=False)
        assert '"frozen" lost its lease' in eventually(lost)
    game.stop()
    found = becomes(game, "stopped")
    assert found is not None
    assert "reset the server, then arm again" in found.text
    game.reset()
    becomes(game, "not armed")


def test_a_client_without_a_connection_is_told(connection: Path) -> None:
    with pc.Client(connection) as client:
        client.explain_silence()
    found = client.explain_silence()
    assert found is not None
    assert found.cause == "not connected"
