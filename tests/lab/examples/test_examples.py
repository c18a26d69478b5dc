"""The peers' examples: the evaluator against Pacinian's field, and Pacinian's own worker."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

import pacinian as pc
from pacinian_lab.examples import run, tables
from pacinian_lab.examples.examples import Example, make_examples
from pacinian_lab.examples.score import field, find_peak, score
from pacinian_lab.solvers.run import OURS
from pacinian_lab.solvers.worker_process import Worker

EXAMPLES = {example.name: example for example in make_examples()}


def make_array(example: Example) -> tuple[pc.Array, pc.Air]:
    air = pc.Air(speed_of_sound=example.speed, density=1.2)
    a = example.radius
    D = pc.Piston(a, example.wavenumber) if a else pc.omni
    kind = pc.Transducer(pressure=example.pressure, directivity=D)
    return pc.Array(example.positions, example.normals, transducer=kind), air


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_evaluators_field_is_that_of_the_model(name: str) -> None:
    example = EXAMPLES[name]
    array, air = make_array(example)
    rng = np.random.default_rng(0)
    g = np.exp(2j * np.pi * rng.random(len(array)))
    q = example.points[0, 0] + rng.uniform(-0.02, 0.02, (5, 3))
    exact = pc.field(array, g, q, air, "double")
    np.testing.assert_allclose(field(example, g, q), exact, atol=1e-9 * np.abs(exact).max())


def test_a_peak_beside_the_focus_is_found_and_silence_and_a_quiet_place_are_scored() -> None:
    example = EXAMPLES["beside a trap"]
    array, air = make_array(example)
    beside = example.points[0] + [[0.001, -0.0005, 0.0]]
    gains = pc.solve(array, beside, 1.0, scale="max", medium=air).gains
    place, height = find_peak(example, gains.astype(complex), example.points[0, 0])
    np.testing.assert_allclose(place, beside[0], atol=5e-5)
    assert height == pytest.approx(abs(pc.field(array, gains, beside, air))[0], rel=1e-3)
    found = score(example, 3.0 * gains[None])  # stronger than a transducer can be driven
    assert found.strength == pytest.approx(height, rel=1e-3)
    assert found.error == 0.0
    assert found.offset == pytest.approx(np.hypot(0.001, 0.0005), abs=5e-5)
    assert 0.0 < found.quiet < 1.0


def test_our_own_worker_makes_examples_within_their_amplitudes() -> None:
    worker = Worker.of(OURS, sys.executable, 1, run.WORKERS)
    todo = [EXAMPLES["foci"], replace(EXAMPLES["circle"], points=EXAMPLES["circle"].points[::10])]
    try:
        rows = list(run.measure([worker], todo, 0.0, pytest.fail))
    finally:
        worker.close()
    assert [row.example for row in rows] == ["foci", "circle"]
    for example, row in zip(todo, rows, strict=True):
        found = score(example, row.gains)
        assert (found.error < 0.01, found.offset < 5e-4, row.p50 > 0.0) == (True,) * 3
    assert len(tables.tabulate(rows, todo)) == 2
    assert "two foci of 2500 Pa" in tables.write_markdown(rows, todo)
