"""Quiet zones that move, and zones that are still prepared."""

from __future__ import annotations

import pytest

import pacinian as pc
from pacinian.serving.render.zone_placement import MOVEMENT_MARGIN, ZonePlacement

from ....waiting import eventually

ARRAY, AIR = pc.autd(), pc.Air()
FIXED = pc.Zone((0.1, 0.0, 0.25), pressure=4.0, radius=0.005)


def head(x: float = 0.0, pressure: float = 5.0, radius: float = 0.004) -> pc.Zone:
    return pc.Zone((x, 0.1, 0.3), pressure=pressure, radius=radius)


@pytest.fixture
def quieting() -> ZonePlacement:
    return ZonePlacement(ARRAY, AIR, pc.Limits(gain=0.5), fixed=1)


def covered(quieting: ZonePlacement, *zones: pc.Zone) -> None:
    """Check that each zone lies within the prepared one, at the gain given."""
    assert quieting.limits.gain == 0.5
    for big, small in zip(quieting.limits.zones, zones, strict=True):
        away = sum((a - b) ** 2 for a, b in zip(big.position, small.position, strict=True)) ** 0.5
        assert away + small.radius <= big.radius
        assert big.pressure <= small.pressure


def test_zones_are_kept_once_they_are_prepared(quieting: ZonePlacement) -> None:
    assert quieting.keeps(())
    zones = FIXED, head()
    if not quieting.keeps(zones):
        assert "being prepared" in quieting.note
    eventually(lambda: quieting.keeps(zones))
    covered(quieting, *zones)
    assert quieting.limits.zones[0] == FIXED  # it never moves, so it needs no margin
    assert quieting.keeps(())
    assert quieting.limits.zones == ()


def test_zones_of_the_settings_are_kept_from_the_start(quieting: ZonePlacement) -> None:
    quieting.prepare((FIXED,))
    assert quieting.keeps((FIXED,))
    covered(quieting, FIXED)


def test_a_zone_may_move_a_little_without_a_pause(quieting: ZonePlacement) -> None:
    eventually(lambda: quieting.keeps((FIXED, head())))
    at = 0.0
    for _ in range(8):
        at += 0.4 * MOVEMENT_MARGIN
        assert quieting.keeps((FIXED, head(at)))
        covered(quieting, FIXED, head(at))

        def goes_on(x: float = at) -> bool:
            zones = FIXED, head(x)
            assert quieting.keeps(zones)  # while other zones are prepared
            return quieting.limits.zones[1].position[0] > x - 0.5 * MOVEMENT_MARGIN

        eventually(goes_on)


@pytest.mark.parametrize("zone", [head(0.1), head(pressure=1.0), head(radius=0.05)])
def test_one_that_jumps_is_another_until_which_there_is_silence(
    quieting: ZonePlacement, zone: pc.Zone
) -> None:
    eventually(lambda: quieting.keeps((FIXED, head())))
    before = quieting.limits
    if not quieting.keeps((FIXED, zone)):
        assert quieting.limits is before
    eventually(lambda: quieting.keeps((FIXED, zone)))
    covered(quieting, FIXED, zone)


@pytest.mark.parametrize("strict", [head(radius=0.03), head(pressure=0.5)])
def test_a_zone_that_becomes_smaller_or_less_quiet_is_prepared_anew_without_a_pause(
    quieting: ZonePlacement, strict: pc.Zone
) -> None:
    """Otherwise, objects in the larger zone would stay silent."""
    eventually(lambda: quieting.keeps((FIXED, strict)))
    now = FIXED, head()

    def is_prepared() -> bool:
        assert quieting.keeps(now)
        last = quieting.limits.zones[1]
        return last.pressure == now[1].pressure and last.radius == now[1].radius + MOVEMENT_MARGIN

    eventually(is_prepared)


def test_there_is_silence_while_the_zones_are_not_known(quieting: ZonePlacement) -> None:
    assert not quieting.keeps(None)
    assert quieting.note.startswith("silent: ")
    assert quieting.keeps(())


def test_what_cannot_be_kept_is_told_and_then_what_can_be_is_kept(quieting: ZonePlacement) -> None:
    around = pc.Zone((0.0, 0.0, 0.0), pressure=1.0, radius=0.5)

    def is_told() -> bool:
        assert not quieting.keeps((FIXED, around))
        return "contain a transducer" in quieting.note

    eventually(is_told)
    zones = FIXED, head()
    eventually(lambda: quieting.keeps(zones))
    covered(quieting, *zones)


def test_where_there_is_no_room_to_move_in_a_zone_is_kept_where_it_is(
    quieting: ZonePlacement,
) -> None:
    x, y, z = (ARRAY.positions[0] - [0.0, 0.0, -0.012]).tolist()
    zone = pc.Zone(
        (x, y, z), pressure=50.0, radius=0.002
    )  # with its margin, the zone contains a transducer
    eventually(lambda: quieting.keeps((FIXED, zone)))
    assert quieting.limits.zones[1] == zone
