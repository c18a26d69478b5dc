"""The rules of sessions and leases, on a manual clock."""

from __future__ import annotations

import random

import pytest

from pacinian.wire.control import Arm, Bye, Renew, Reset, Stop
from pacinian.wire.protocol import MAJOR, MINOR
from pacinian.wire.replies import Ok, Renewed, Welcome

from ..fake_clients import LEASE, FakeControl, Game, armed, code, hello

# hello


def test_hello_is_answered_with_what_the_client_needs() -> None:
    desk = FakeControl()
    reply = desk.ask(b"game", hello(id=3, scene="kitchen"))
    assert isinstance(reply, Welcome)
    assert (reply.id, len(reply.session), reply.scene) == (3, 16, "kitchen")
    assert (reply.lease, reply.time, reply.protocol) == (LEASE, 100.0, (MAJOR, MINOR))
    listed = desk.sessions.list_sessions()
    assert [(s.key, s.name, s.user) for s in listed.sessions] == [(reply.session, "game", "user")]
    assert listed.owned == ""


@pytest.mark.parametrize(
    ("major", "side"), [(MAJOR + 1, "server"), (MAJOR - 1, "client"), (65535, "server")]
)
def test_another_major_version_is_refused_and_says_which_side_to_update(
    major: int, side: str
) -> None:
    desk = FakeControl()
    reply = desk.ask(b"game", hello(protocol=(major, 0), id=1))
    assert code(reply) == "version"
    assert reply.advice == f"update the {side}"
    assert not desk.sessions.all


def test_a_newer_minor_version_is_accepted_and_answered_with_ours() -> None:
    assert FakeControl().hello(protocol=(MAJOR, MINOR + 9)).welcome.protocol == (MAJOR, MINOR)


def test_scenes_are_shared_by_name_and_otherwise_of_ones_own() -> None:
    desk = FakeControl()
    a, b = desk.hello(b"a", scene="room"), desk.hello(b"b", scene="room")
    c, d = desk.hello(b"c"), desk.hello(b"d")
    assert a.welcome.scene == b.welcome.scene
    assert len({g.welcome.scene for g in (a, c, d)}) == 3
    assert c.welcome.session.hex()[:8] not in c.welcome.scene, "keys are nobody else's"
    assert code(desk.ask(b"e", hello(scene=c.welcome.scene))) == "argument", "it is published"


def test_there_are_only_so_many_clients() -> None:
    desk = FakeControl()
    games = [desk.hello(name) for name in (b"a", b"b", b"c", b"d")]
    assert code(desk.ask(b"e", hello())) == "limit"
    assert isinstance(games[0].ask(Bye), Ok)
    desk.hello(b"e")


def test_a_second_hello_ends_the_first_session() -> None:
    desk = FakeControl()
    old = desk.hello()
    old.arm()
    new = desk.hello()
    assert desk.armed == 2, "it fades out"
    assert code(old.renew()) == "session"
    assert isinstance(new.renew(), Renewed)
    assert len(desk.sessions.all) == 1


def test_keys_are_only_good_on_the_connection_that_said_hello() -> None:
    desk = FakeControl()
    game = desk.hello()
    thief = Game(desk, b"thief", game.welcome)
    assert code(thief.arm()) == "session"
    assert desk.sessions.replayed == 1
    assert not desk.armed
    assert code(desk.ask(b"thief", Arm(session=bytes(16)))) == "session"
    assert desk.sessions.replayed == 1, "that was no key at all"


@pytest.mark.parametrize("asked", [0.05, 0.25, 5.0, None])
def test_a_lease_can_only_be_shorter_than_the_servers(asked: float | None) -> None:
    desk = FakeControl()
    game = desk.hello(lease=asked)
    assert game.welcome.lease == min(LEASE, asked or LEASE)
    game.arm()
    assert desk.permit.until == pytest.approx(100.0 + game.welcome.lease)


# arm, renew, expire


def test_arm_permits_until_the_lease_ends_and_counts() -> None:
    desk = FakeControl()
    game = desk.hello(scene="room")
    assert game.arm() == Ok(id=7)
    assert desk.permit[:4] == (1, 100.0 + LEASE, 1, 0)
    assert desk.sessions.list_sessions().owned == "room"
    assert game.arm() == Ok(id=7), "once more changes nothing"
    assert desk.permit.epoch == 1


def test_renewals_push_the_deadline_and_are_answered() -> None:
    desk, game = armed()
    for _ in range(20):
        desk.wait(0.1)
        reply = game.renew()
        assert isinstance(reply, Renewed)
        assert reply.owner
        assert reply.armed
        assert desk.permit.until == reply.until == pytest.approx(desk.clock.time + LEASE)
    assert desk.permit.epoch == 1


def test_expiry_silences_tells_the_owner_and_needs_a_new_arm() -> None:
    desk, game = armed()
    assert desk.wait(LEASE - 1e-6) == []
    assert desk.armed == 1
    ((peer, told),) = desk.wait(1e-5)
    assert (peer, code(told), told.id) == (b"game", "expired", 0)
    assert desk.armed == 0
    reply = game.renew()
    assert reply.owner
    assert not reply.armed
    assert desk.armed == 0
    assert game.arm() == Ok(id=7)
    assert desk.permit.epoch == 2


def test_a_game_that_goes_on_sounds_again_unless_something_else_ended_it() -> None:
    """A pause is not an error. Only a new renewal of the owner ends it."""
    desk, game = armed(resume=True)
    game.renew()
    assert desk.wait(LEASE + 1.0) == []
    assert desk.armed == 0
    assert not game.renew(late=LEASE).armed  # sent before the pause
    assert game.renew().armed
    assert desk.permit[:3] == (1, pytest.approx(desk.clock.time + LEASE), 2)
    desk.wait(2 * LEASE)
    assert [code(told) for told in desk.all(b"game", Stop())] == ["stopped"]
    game.ask(Reset)
    assert not game.renew().armed
    game.arm(resume=True)
    desk.wait(2 * LEASE)
    desk.sessions.lease.interrupt("fault", "the renderer was restarted")
    assert [code(told) for _, told in desk.sessions.take_replies()] == [
        "fault"
    ]  # it would wait in vain, so it gets an error
    assert not game.renew().armed


def test_a_renewal_that_comes_after_the_deadline_resurrects_nothing() -> None:
    desk, game = armed()
    desk.clock.advance(LEASE)  # without a check in between
    assert isinstance(game.renew(), Renewed)
    assert desk.armed == 0


def test_queued_renewals_do_not_extend_the_lease() -> None:
    """A frozen game leaves renewals in the queue. They count from the time they were sent."""
    desk = FakeControl()
    game = desk.hello()
    for _ in range(10):
        desk.wait(0.05)
        game.renew()
    game.arm()
    armed = desk.clock.time
    for _ in range(24):
        desk.wait(0.01)
        game.renew(late=desk.clock.time - armed)  # all were sent long ago
        assert desk.permit.until <= armed + LEASE + 1e-6
    desk.wait(0.02)
    assert desk.armed == 0


def test_renewals_must_count_up() -> None:
    desk = FakeControl()
    game = desk.hello()
    game.renew()
    for sequence in (1, 1):
        assert code(game.ask(Renew, sequence=sequence, time=1e4)) == "sequence"


@pytest.mark.parametrize("jump", [-1e6, -3.0, -0.5, 0.5, 3.0, 1e6])
def test_a_jump_of_the_clients_clock_never_lengthens_the_lease(jump: float) -> None:
    desk, game = armed()
    for step in range(100):
        desk.wait(0.05)
        if step == 50:
            game.ahead += jump
        game.renew()
        assert desk.permit.until <= desk.clock.time + LEASE
    for _ in range(250):  # after a while, the limit is as before
        desk.wait(0.05)
        game.renew()
    game.arm()
    desk.wait(0.2)
    game.renew()
    desk.wait(0.2)
    assert desk.armed == 1


def test_the_lease_is_a_hard_bound_over_many_expiries() -> None:
    """10,000 expiries with any phase, delay and interval between checks: the lease never lasts longer."""
    random.seed(5)
    desk = FakeControl(session_timeout=3600.0)
    game = desk.hello()
    worst = 0.0
    for _ in range(10_000):
        game.arm()
        sent = desk.clock.time
        for _ in range(random.randrange(3)):
            desk.clock.advance(random.uniform(0.0, LEASE))
            late = random.choice((0.0, random.uniform(0.0, 0.1)))
            before = desk.permit
            game.renew(late)
            if desk.armed:
                sent = max(sent, desk.clock.time - late)
                # the delay is known up to the shortest one seen
                assert desk.permit.until <= sent + LEASE + 1e-6
            else:
                assert desk.clock.time >= before.until or not before.armed
                break
        if desk.armed:
            until = desk.permit.until
            worst = max(worst, until - sent)
            desk.clock.time = until - 1e-9
            desk.sessions.pass_time(desk.clock.time)
            assert desk.armed == 1
            desk.clock.time = until
            desk.sessions.pass_time(desk.clock.time)
        assert desk.armed == 0
        desk.sessions.take_replies()
    assert worst <= LEASE + 1e-6
    assert desk.permit.epoch == 10_000


def test_a_session_that_does_not_renew_is_forgotten() -> None:
    desk = FakeControl(session_timeout=10.0)
    game, other = desk.hello(), desk.hello(b"other")
    told = []
    for _ in range(3):
        told += desk.wait(4.0)
        other.renew()
    assert [(to, code(reply)) for to, reply in told] == [(b"game", "session")]
    assert [s.peer for s in desk.sessions.all] == [b"other"]
    assert code(game.renew()) == "session"
