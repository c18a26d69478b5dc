"""Large requests are split into several messages, or rejected; sending waits for room only once."""

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import ManualClock
from pacinian.wire import commands
from pacinian.wire.codec import encode
from pacinian.wire.protocol import MAX_COMMAND_BYTES

from .fake_server import Fake

POINT = pc.Point(position=(0.0, 0.01, 0.2), radiation_pressure=5.0, name="button")


def test_many_go_in_one_message_and_too_many_in_several(server: Fake, client: pc.Client) -> None:
    client.put(*(pc.Point(position=(0, 0, 0.2), force=0.01, name=str(i)) for i in range(300)))
    client.remove(*map(str, range(300)))
    assert [len(m.objects) for m in server.of(commands.Put)] == [256, 44]
    assert [len(m.names) for m in server.of(commands.Remove)] == [256, 44]
    sequences = [m.sequence for m in server.seen if isinstance(m, commands.Command)]
    assert sequences == sorted(set(sequences))


def test_large_ones_go_in_several_messages_too(server: Fake, client: pc.Client) -> None:
    rain = tuple((0.0, 0.0, 1e-5 * i) for i in range(10_000))  # 120 kB
    many = [pc.Particles(positions=rain, radiation_pressure=1.0, name=str(i)) for i in range(20)]
    client.put(*many)
    sent = server.of(commands.Put)
    assert [name for m in sent for name in m.objects] == [item.name for item in many]
    assert [len(m.objects) for m in sent] == [7, 7, 6]
    assert max(len(encode(m)) for m in sent) < MAX_COMMAND_BYTES


@pytest.mark.parametrize("wait", [True, False])
def test_what_fits_into_no_message_is_refused_before_anything_is_sent(
    server: Fake, client: pc.Client, wait: bool
) -> None:
    corners = np.random.default_rng(1).random((48_000, 3)).tolist()
    faces = (np.arange(3 * 48_000).reshape(-1, 3) % 48_000).tolist()
    mesh = pc.Mesh(vertices=corners, faces=faces)  # 1.15 MB
    large = pc.Surface(shape=mesh, radiation_pressure=1.0, name="large")
    with pytest.raises(pc.WireError, match=r"\$\.objects\[large\].*bytes: keep to"):
        client.put(POINT, large, wait=wait)
    client.clear()
    assert server.of(commands.Put) == []


def test_what_waits_is_waited_for_no_longer_than_once(
    server: Fake, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = ManualClock()
    waits: list[float] = []

    def slow(link: object, data: bytes, timeout: float = 0.0) -> bool:
        waits.append(timeout)
        clock.advance(0.6 * timeout)
        return True

    with pc.Client(server.connection, clock=clock.now) as client:
        session = client._server_session
        for _ in range(5):
            session.outbox.add(
                commands.Quiet(session=session.welcome.session, sequence=1, time=0.0, zones=())
            )
        session.outbox.waiting *= 5
        monkeypatch.setattr(session, "_send", slow)
        assert session._flush(1.0)
        monkeypatch.undo()
    assert len(waits) == 5
    assert 0.6 * sum(waits) <= 1.0
