from __future__ import annotations

from typing import Any

import msgpack
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.acoustics import array_record
from pacinian.rendering.recorded_settings import to_config
from pacinian.rendering.rerender import from_config
from pacinian.rendering.smoothing import Smoothing
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

bounded = settings(max_examples=60)


def again(renderer: pc.Renderer) -> pc.Renderer:
    """Return a renderer from its settings, encoded and decoded as in a file."""
    plain = msgpack.unpackb(msgpack.packb(to_config(renderer)), strict_map_key=False)
    array = renderer.session.array
    array = array_record.from_map(plain, array.positions, array.normals)
    return from_config(plain, array, Simulated(rate=1e5), ManualClock())


def make(array: pc.Array | None = None, **options: Any) -> pc.Renderer:
    device = Simulated(rate=1e5)
    return pc.Renderer(array or pc.lattice(0.05, 0.05), pc.Scene(), backend=device, **options)


PISTON = pc.Piston(0.0045, 739.0)
DIRECTIVITIES = [pc.omni, pc.t4010a1, PISTON, pc.DirectivityTable.sample(PISTON, 7)]


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"rate": 700.0, "adaptive": False},
        {"smoothing": Smoothing(rate=None, align=False)},
        {"smoothing": Smoothing(rate=33.0)},
        {"sampler": pc.Sampler(17, 0.004, ramp=0.02, perception=False)},
        {"medium": pc.Air(temperature=30.0, humidity=0.2, attenuation="absorbing")},
        {"medium": pc.Air(speed_of_sound=351.0, density=1.1, attenuation=0.7, absorption=0.1)},
        *({"array": pc.lattice(0.03, 0.03, transducer=pc.Transducer(directivity=D, pressure=2.5))}
          for D in DIRECTIVITIES),
    ],
)  # fmt: skip
def test_a_renderer_comes_back_with_all_its_settings(options: dict[str, Any]) -> None:
    before = make(**options)
    after = again(before)
    assert after.period == before.period
    assert (after._pipeline.budget_controller is None) == (
        before._pipeline.budget_controller is None
    )
    assert after.smoothing == before.smoothing
    assert after.session.medium == before.session.medium
    assert after.session.array.transducer == before.session.array.transducer
    for name in ("budget", "spacing", "ramp", "perception"):
        assert getattr(after.sampler, name) == getattr(before.sampler, name)


@bounded
@given(st.floats(1.0, 1e5))
def test_the_period_comes_back_to_the_last_bit(rate: float) -> None:
    before = make(rate=max(rate, 200.0))
    assert again(before).period == before.period


def test_a_directivity_of_ones_own_cannot_come_back() -> None:
    kind = pc.Transducer(directivity=lambda cosine: cosine**2)
    before = make(pc.lattice(0.03, 0.03, transducer=kind))
    assert to_config(before)["transducer"]["directivity"] is None
    with pytest.raises(ValueError, match="directivity"):
        again(before)
