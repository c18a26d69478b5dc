"""The rules of ownership, and of the end of sound, on a manual clock."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.serving.control.output_lease import FADE_OUT_TIME
from pacinian.wire.control import Arm, Bye, Disarm, Reset, Stop
from pacinian.wire.replies import Ok

from ..fake_clients import LEASE, FakeControl, Game, armed, code

# ends


def test_disarm_is_soft_and_then_silent() -> None:
    desk, game = armed()
    assert game.ask(Disarm) == Ok(id=7)
    assert desk.permit[:4] == (2, 100.0 + FADE_OUT_TIME, 1, 0)
    assert desk.sessions.list_sessions().owned == ""
    assert desk.wait(FADE_OUT_TIME) == []
    assert desk.permit[:4] == (0, 0.0, 1, 0)


def test_a_soft_end_is_never_later_than_the_lease() -> None:
    desk, game = armed()
    desk.wait(LEASE - 0.005)
    game.ask(Disarm)
    assert desk.permit.until == pytest.approx(100.0 + LEASE)


def test_arming_again_while_it_fades_waits_and_counts() -> None:
    desk, game = armed()
    game.ask(Disarm)
    message = Arm(session=game.welcome.session, id=9)
    assert desk.all(b"game", message) == []
    assert desk.armed == 2
    assert desk.wait(FADE_OUT_TIME) == [(b"game", Ok(id=9))]
    assert desk.permit[:3] == (1, pytest.approx(100.0 + LEASE), 2)


def test_arming_what_is_armed_extends_it() -> None:
    desk, game = armed()
    desk.wait(LEASE / 2)
    assert game.arm() == Ok(id=7)
    assert desk.permit[:3] == (1, pytest.approx(100.0 + 1.5 * LEASE), 1)
    assert desk.wait(0.9 * LEASE) == []
    assert desk.armed == 1


def test_bye_is_soft_and_a_lost_link_is_not() -> None:
    desk, game = armed()
    assert game.ask(Bye) == Ok(id=7)
    assert desk.armed == 2
    assert not desk.sessions.all
    desk.wait(1.0)
    game = desk.hello()
    game.arm()
    desk.sessions.end_peer(b"game", desk.clock.time)
    assert desk.armed == 0
    assert not desk.sessions.all
    assert desk.sessions.lease.owner is None
    desk.sessions.end_peer(b"game", desk.clock.time)  # a second time is no error


def test_another_client_that_is_lost_changes_nothing() -> None:
    desk = FakeControl()
    game, _other = desk.hello(), desk.hello(b"other")
    game.arm()
    before = desk.permit
    desk.sessions.end_peer(b"other", desk.clock.time)
    assert desk.permit == before


def test_when_the_bus_has_gone_all_sessions_end_and_are_told() -> None:
    desk = FakeControl()
    desk.hello().arm()
    desk.hello(b"other")
    desk.sessions.end_all("gone", desk.clock.time, "say hello")
    assert sorted((to, code(reply)) for to, reply in desk.sessions.take_replies()) == [
        (b"game", "session"),
        (b"other", "session"),
    ]
    assert desk.armed == 0
    assert not desk.sessions.all


# ownership


def test_the_output_is_taken_only_by_asking_and_only_if_allowed() -> None:
    for allowed in (True, False):
        desk = FakeControl(takeover=allowed)
        desk.hello(b"old", scene="old").arm()
        new = desk.hello(b"new", scene="new")
        assert code(new.arm()) == "owner"
        if not allowed:
            assert code(new.arm(take=True)) == "owner"
            assert desk.sessions.list_sessions().owned == "old"
            assert desk.armed == 1


def test_a_hand_over_fades_then_begins_anew_and_tells_the_old_owner() -> None:
    desk = FakeControl()
    old, new = desk.hello(b"old", scene="old"), desk.hello(b"new", scene="new")
    old.arm()
    new.take()
    ((peer, told),) = desk.sessions.take_replies()
    assert (peer, told.id, code(told)) == (b"old", 0, "owner")
    assert desk.permit[:4:2] == (2, 1)
    assert desk.sessions.list_sessions().owned == "new"
    assert code(old.ask(Disarm)) == "owner"
    assert not old.renew().owner
    assert desk.permit.until == 100.0 + FADE_OUT_TIME, "the old one's renewals do not count"
    assert desk.wait(FADE_OUT_TIME) == [(b"new", Ok(id=5))]
    assert desk.permit[:4:2] == (1, 2)


def test_of_two_that_take_the_last_one_owns() -> None:
    desk = FakeControl()
    a, b, c = desk.hello(b"a"), desk.hello(b"b"), desk.hello(b"c")
    a.arm()
    for game in (b, c):
        game.take()
    told = desk.sessions.take_replies()
    assert [(to, reply.id, code(reply)) for to, reply in told] == [
        (b"a", 0, "owner"),
        (b"b", 5, "owner"),
        (b"b", 0, "owner"),
    ]
    assert desk.wait(FADE_OUT_TIME) == [(b"c", Ok(id=5))]
    assert desk.permit.epoch == 2


def test_a_takers_renewals_do_not_lengthen_what_fades() -> None:
    desk = FakeControl()
    desk.hello(b"old").arm()
    new = desk.hello(b"new")
    desk.all(b"new", Arm(session=new.welcome.session, take=True))
    desk.wait(0.01)
    new.renew()
    assert desk.permit[:4] == (2, 100.0 + FADE_OUT_TIME, 1, 0)


def test_a_taker_whose_lease_ended_meanwhile_gets_nothing() -> None:
    desk = FakeControl()
    desk.hello(b"old").arm()
    new = desk.hello(b"new")
    desk.all(b"new", Arm(session=new.welcome.session, id=5, take=True))
    told = desk.wait(LEASE)  # nobody checked during that time
    assert [(to, reply.id, code(reply)) for to, reply in told] == [(b"new", 5, "expired")]
    assert desk.armed == 0


def test_a_taker_that_is_lost_while_the_old_one_fades_gets_nothing() -> None:
    desk = FakeControl()
    desk.hello(b"a").arm()
    desk.hello(b"b").take()
    desk.sessions.end_peer(b"b", desk.clock.time)
    desk.wait(1.0)
    assert desk.permit[:4] == (0, 0.0, 1, 0)
    assert desk.sessions.lease.owner is None


# stop, fault, reset


def test_anyone_can_stop_without_a_session() -> None:
    desk, game = armed()
    desk.sessions.handle(b"anyone", "u", Stop(id=4), desk.clock.time)
    assert desk.permit[:4] == (0, 0.0, 1, 1)
    told = dict(desk.sessions.take_replies())
    assert b"anyone" not in told, "it is confirmed once the guard is silent"
    assert code(told[b"game"]) == "stopped"
    assert code(game.arm()) == "stopped"
    assert code(desk.ask(b"anyone", Reset(session=bytes(16)))) == "session"
    assert game.ask(Reset) == Ok(id=7)
    assert desk.permit[:4] == (0, 0.0, 1, 0)
    assert desk.sessions.resets == 1
    assert game.arm() == Ok(id=7)
    assert desk.permit.epoch == 2


def test_a_stop_while_one_hands_over_holds() -> None:
    desk = FakeControl()
    desk.hello(b"a").arm()
    desk.hello(b"b").take()
    desk.sessions.take_replies()
    desk.sessions.handle(b"x", "u", Stop(), desk.clock.time)
    assert [code(reply) for to, reply in desk.sessions.take_replies() if to == b"b"] == ["stopped"]
    desk.wait(1.0)
    assert desk.permit[0] == 0


def test_a_fault_holds_until_reset_and_is_told_once() -> None:
    desk, game = armed()
    for fault in ("device: unplugged", "device: unplugged", "another"):
        desk.sessions.lease.fail(fault)
    ((_, told),) = desk.sessions.take_replies()
    assert (code(told), told.message) == ("fault", "device: unplugged")
    assert desk.armed == 0
    reply = game.arm()
    assert code(reply) == "stopped"
    assert "unplugged" in reply.message
    game.ask(Reset)
    assert game.arm() == Ok(id=7)


def test_a_renderer_that_is_started_again_needs_an_arm_but_no_reset() -> None:
    desk, game = armed()
    desk.sessions.lease.interrupt("fault", "the renderer was killed")
    assert [code(reply) for _, reply in desk.sessions.take_replies()] == ["fault"]
    assert desk.armed == 0
    assert game.arm() == Ok(id=7)
    assert desk.permit.epoch == 2


def test_a_reset_that_nothing_needs_changes_nothing() -> None:
    desk = FakeControl()
    game, other = desk.hello(), desk.hello(b"other")
    game.arm()
    before = desk.permit
    assert other.ask(Reset) == Ok(id=7)
    assert desk.permit == before
    assert desk.sessions.resets == 0


# whatever happens

steps = st.lists(
    st.tuples(
        st.sampled_from(
            [
                "hello",
                "renew",
                "arm",
                "resume",
                "take",
                "disarm",
                "bye",
                "lost",
                "stop",
                "reset",
                "fault",
            ]
        ),
        st.sampled_from([b"a", b"b", b"c"]),
        st.floats(0.0, 0.3),
    ),
    max_size=60,
)


@settings(max_examples=300)
@given(steps)
def test_whatever_clients_do_sound_is_bounded_owned_and_resumes_only_as_agreed(
    script: list[tuple[str, bytes, float]],
) -> None:
    """After a lease ran out, a renewal lets its owner sound again if its `arm` asked for that; nothing else does."""
    desk = FakeControl()
    games: dict[bytes, Game] = {}
    agreed: dict[bytes, bool] = {}  # `resume` of each client's last `arm`
    resumes: bytes | None = (
        None  # the client that sounded with `resume`, and lost the output only by time
    )
    sign = dict.fromkeys((b"a", b"b", b"c"), -1e9)  # latest possible time of the last sign of life
    for what, peer, seconds in script:
        before = desk.permit
        desk.wait(seconds)
        ends = what in ("stop", "fault", "take") or (
            what in ("hello", "lost", "disarm", "bye") and peer == resumes
        )
        resumes = None if ends or (what == "arm" and peer == resumes) else resumes
        if what == "hello":
            games[peer] = desk.hello(peer)
        elif what == "lost":
            desk.sessions.end_peer(peer, desk.clock.time)
        elif what == "stop":
            desk.all(peer, Stop())
        elif what == "fault":
            desk.sessions.lease.fail("broken")
        elif peer in games:
            game, sign[peer] = games[peer], desk.clock.time
            if what == "renew":
                game.renew()
            elif what in ("arm", "take", "resume"):
                agreed[peer] = what == "resume"
                ask = Arm(
                    session=game.welcome.session, id=7, take=what == "take", resume=agreed[peer]
                )
                game.desk.all(peer, ask)
            else:
                game.ask({"disarm": Disarm, "bye": Bye, "reset": Reset}[what])
        after, owner = desk.permit, desk.sessions.lease.owner
        assert after.epoch >= before.epoch
        if after.armed == 1:
            assert owner is not None
            assert owner in desk.sessions.all
            assert not after.stopped
            assert not desk.sessions.lease.fault
            assert after.until <= sign[owner.peer] + LEASE + 1e-9
            assert desk.clock.time < after.until
            if before.armed != 1:
                assert after.epoch > before.epoch, "sound only begins with a new permit"
            if before.armed == 0:
                assert what in ("arm", "take", "resume") or (what, peer) == ("renew", resumes)
            resumes = owner.peer if agreed[owner.peer] else None
        elif what == "renew" and owner is not None and peer == owner.peer:
            assert resumes != peer, "it goes on, and sounds"
        if after.armed == 2:
            assert after.until <= desk.clock.time + FADE_OUT_TIME
        assert desk.sessions.list_sessions().owned == (owner.scene if owner else "")


def number_of(desk: FakeControl, scene: str) -> int:
    return next(one.number for one in desk.sessions.list_sessions().sessions if one.scene == scene)


def test_a_permit_is_for_the_scene_of_its_owner_alone() -> None:
    desk = FakeControl()
    old, new = desk.hello(b"old", scene="old"), desk.hello(b"new", scene="new")
    old.arm()
    assert desk.permit.scene == number_of(desk, "old")
    desk.all(b"new", Arm(session=new.welcome.session, id=5, take=True))
    assert desk.permit.scene == number_of(desk, "old"), "that fades"
    desk.wait(FADE_OUT_TIME)
    assert desk.permit.scene == number_of(desk, "new") != number_of(desk, "old")


def test_a_scene_that_has_ended_and_begins_again_has_another_number() -> None:
    """The renderer may still hold the objects of the first scene."""
    desk = FakeControl()
    one, other = desk.hello(b"one", scene="table"), desk.hello(b"other", scene="table")
    number = number_of(desk, "table")
    desk.all(b"one", Bye(session=one.welcome.session, id=5))
    assert number_of(desk, "table") == number, "the other is still there"
    desk.all(b"other", Bye(session=other.welcome.session, id=6))
    desk.hello(b"new", scene="table").arm()
    assert desk.permit.scene == number_of(desk, "table") != number
