"""The compiled kernels: all variants for this processor give the same results, and reject invalid arguments."""

import importlib
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian import native
from pacinian.acoustics.propagation import KernelData, matrix
from pacinian.scene.sampling.sampler import Sampler
from pacinian_lab.regions.contacts import CONTACTS

ROOT = Path(__file__).parents[2]
VARIANTS = [name.lstrip("_") for name in native.list_runnable()]
every = pytest.mark.parametrize("variant", VARIANTS)
AIR = pc.Air(attenuation="absorbing")
ARRAY = pc.Array(pc.autd().positions, pc.autd().normals, pc.T4010A1)


def kernels(variant: str, package: str = "pacinian.native") -> Any:
    return native.load(package, f"_{variant}")


@every
def test_b_is_the_reference_in_every_variant(variant: str) -> None:
    wave, rng = KernelData.prepare(ARRAY, AIR), np.random.default_rng(0)
    q = rng.uniform(-0.1, 0.1, (33, 3)) + np.array([0.0, 0.0, 0.25])
    B, touches = np.empty((33, len(ARRAY)), np.complex64), np.empty(33, np.float32)
    place = np.ascontiguousarray(q - wave.origin, np.float32)
    kernels(variant).acoustics.matrix(
        place, wave.r, wave.n, wave.law, wave.table, np.arange(33), B, touches
    )
    exact = matrix(ARRAY, q, AIR)
    assert np.abs(B - exact).max() < 1e-4 * np.abs(exact).max()
    assert not touches.any()


@every
def test_weights_of_a_hand_are_the_reference_in_every_variant(variant: str) -> None:
    sampler, wave = Sampler(), KernelData.prepare(ARRAY, AIR)
    sampler.prepare(ARRAY, AIR)
    samples = sampler.sample(CONTACTS["ball of 12 mm radius at a fingertip"](), 0.04)
    assert samples.capsules is not None
    facing = pc.SkinFacing(samples.normals, samples.capsules)
    W = np.ones((len(samples), len(ARRAY)), np.complex64)
    boxes = importlib.import_module("pacinian.acoustics.skin_facing")._boxes(wave)
    kernels(variant).acoustics.weigh(
        samples.positions, facing.normals, facing.capsules, facing.edge, wave.origin, wave.r,
        boxes, np.arange(len(W)), W,
    )  # fmt: skip
    assert np.abs(W - facing.weights(samples.positions, ARRAY.positions)).max() < 2e-4


@every
@pytest.mark.parametrize("what", ["nothing", "nan", "infinite", "huge"])
def test_what_is_no_number_is_noticed_in_every_variant(variant: str, what: str) -> None:
    solving = kernels(variant).solving
    wrong = {"nothing": 0.5, "nan": np.nan, "infinite": np.inf, "huge": 1e300}[what]
    for dtype in (np.complex64, np.complex128):
        g = np.full(100, 0.25, dtype)
        with np.errstate(over="ignore"):
            g[37] = wrong
        assert np.isnan(solving.peak(g)) == (what != "nothing")
    q, t = np.zeros((100, 3)), np.ones(100)
    q[63, 1] = wrong
    assert np.isfinite(solving.furthest(q, np.zeros(3), t)) == (what == "nothing")
    gains = np.full((1, 100), 0.25, np.complex64)
    with np.errstate(over="ignore"):
        gains[0, 37] = wrong
    last, out = np.zeros(100, np.complex64), np.empty((2, 100), np.complex64)
    loudest = np.zeros(1, np.float32)
    kernels(variant).rendering.follow(gains, np.inf, 1, 1.0, True, 0, False, loudest, last, out)
    assert np.isfinite(out).all()


@every
def test_an_array_of_another_type_or_order_is_refused_and_not_copied(variant: str) -> None:
    power = kernels(variant).solving.power
    good = np.ones(8, np.complex64)
    assert power(good) == pytest.approx(8.0)
    sealed = good.copy()
    sealed.flags.writeable = False
    assert power(sealed) == pytest.approx(8.0)
    for bad in (good[::2], good.real.copy(), good[None], good.byteswap().view(">c8"), None, [1.0]):
        with pytest.raises(TypeError):
            power(bad)
    with pytest.raises(TypeError):  # the kernel would write to it
        kernels(variant).solving.limit_gains(sealed, 1.0, 1.0)
    with pytest.raises(ValueError, match="shapes"):
        kernels(variant).solving.apply(
            np.ones((2, 8), np.complex64), good[:4].copy(), np.empty(2, complex)
        )


def test_a_lower_variant_can_be_asked_for_and_no_other_one() -> None:
    code = "import pacinian.native as n; print(n.VARIANT)"
    for wanted in [*VARIANTS, "v9"]:
        environment = {**os.environ, native.CHOICE: wanted}
        done = subprocess.run(
            [sys.executable, "-c", code],
            env=environment,
            check=False,
            capture_output=True,
            text=True,
        )
        assert (done.stdout.strip() == wanted) == (wanted in VARIANTS)
        if wanted not in VARIANTS:
            assert f"must be one of {', '.join(VARIANTS)}, not 'v9'" in done.stderr


def test_kernels_that_were_never_compiled_say_what_to_do() -> None:
    with pytest.raises(ImportError, match="install Pacinian again"):
        native.load("pacinian", "_v4")


def test_the_stubs_are_those_of_the_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT))
    build = importlib.import_module("native_build")
    for path, text in build.make_stubs().items():
        told = f"{path.name} is old: `python native_build.py --stubs`"
        assert path.read_text("utf-8") == text, told
