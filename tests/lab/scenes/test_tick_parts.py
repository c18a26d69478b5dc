from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor

import pytest

import pacinian as pc
from pacinian.native import scene, solving
from pacinian_lab.scenes.tick_parts import KernelTimer, measure


def test_kernels_and_python_make_up_each_stage_and_the_stages_the_tick() -> None:
    """Checked on a scene with contact, by sums that no quantile hides: every tick is its own quantile of one."""
    row = measure(pc.autd(), "sliding-ball", 0.05)
    assert row.ticks > 0
    stages = set(row.total) - {"tick"}
    assert {"sample", "solve", "drive", "send"} <= stages
    assert set(row.kernels) == set(row.python) == set(row.total)
    for stage in row.total:
        total, kernels, python = row.total[stage], row.kernels[stage], row.python[stage]
        assert 0.0 <= kernels.p999 <= total.p999
        assert 0.0 < python.p999 <= total.p999
    assert row.kernels["tick"].p999 > 0.0
    assert row.processor.p50 > 0.0
    assert row.calibration > 0.0


def test_the_timer_counts_a_kernel_in_its_stage_and_leaves_nothing_behind() -> None:
    before = {module: dict(vars(module)) for module in (scene, solving)}
    stage = "a"
    with KernelTimer(lambda: stage) as timer:
        changed = {name for m in before for name in vars(m) if vars(m)[name] is not before[m][name]}
        assert changed
        begin = time.perf_counter()
        with pytest.raises(TypeError):
            next(vars(m)[n] for m in before for n in vars(m) if n in changed)(
                "no", "such", "arguments"
            )
        passed = time.perf_counter() - begin
        assert 0.0 < timer.spent["a"] <= passed
        spent = dict(timer.spent)
        kernel = next(vars(m)[n] for m in before for n in vars(m) if n in changed)
        with ThreadPoolExecutor() as pool, pytest.raises(TypeError):
            pool.submit(kernel, "no", "such", "arguments").result()
        assert timer.spent == spent
    assert before == {module: dict(vars(module)) for module in before}
