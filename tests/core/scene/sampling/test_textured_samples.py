"""Samples of textured surfaces: on the outlines of what presses, silent beyond, and even pressure inside."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial import KDTree

import pacinian as pc
from pacinian.scene.sampling.textured_samples import lay_out
from pacinian.scene.shapes.texture import Texture, grating

AIR, ONE, NINE = pc.Air(), pc.autd(), pc.autd(3, 3)
SIDE, SPACING = 0.044, 0.0025


def bean(x: Any, y: Any) -> Any:
    """Return whether points are in a shape with a dent, some 25 mm across."""
    angle = np.arctan2(y, x)
    return np.hypot(x, y) < 0.0125 * (1.0 + 0.25 * np.cos(2.0 * angle + 0.5))


def mask(inside: Any, pixels: int = 88) -> Texture:
    """Return a picture of a shape, 1 inside and 0 outside."""
    middle = (np.arange(pixels) + 0.5) / pixels * SIDE - SIDE / 2.0
    x, y = np.meshgrid(middle, middle[::-1])
    values = inside(x, y).astype(float)
    return Texture(values=tuple(map(tuple, values.tolist())), size=(SIDE, SIDE), repeat=False)


def plate(texture: Texture | None) -> pc.Surface:
    return pc.Surface(
        shape=pc.Rectangle(SIDE, SIDE),
        pose=pc.Pose((0.0, 0.0, 0.2)),
        radiation_pressure=1.0,
        texture=texture,
    )


def test_a_mask_has_samples_on_its_outline_and_silent_ones_beyond() -> None:
    local = plate(None).sample_surface(SPACING)
    made, factor, silent = lay_out(mask(bean), local, SPACING)
    x, y = made.points[:, :2].T
    pixel = SIDE / 88
    assert set(factor.round(9).tolist()) == {0.0, 1.0}
    np.testing.assert_array_equal(silent, factor <= 0.0)
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    rim = 0.0125 * (1.0 + 0.25 * np.cos(2.0 * angle + 0.5))
    outline = np.stack([rim * np.cos(angle), rim * np.sin(angle), 0.0 * angle], axis=-1)
    pressing = made.points[factor > 0.0]
    assert bean(*(0.93 * pressing[:, :2].T)).all()
    assert not bean(x[silent] + 0.0, y[silent]).any()
    away = KDTree(pressing).query(outline)[0]
    assert away.max() < SPACING  # the grid alone leaves pieces of 1.4 spacings
    assert np.median(away) < 0.5 * SPACING + pixel
    assert KDTree(pressing).query(made.points[silent])[0].min() > 0.7 * SPACING
    area = 0.0125**2 * math.pi * (1.0 + 0.25**2 / 2.0)
    assert made.area.sum() == pytest.approx(area, rel=0.05)
    assert not made.area[silent].any()


@pytest.mark.parametrize("array", [ONE, NINE], ids=["one unit", "nine"])
def test_a_mask_is_even_up_to_its_outline(array: pc.Array) -> None:
    sampler = pc.Sampler()
    sampler.prepare(array, AIR)
    samples = sampler.sample(pc.Scene((plate(mask(bean)),)))
    session = pc.Session(array, AIR)
    t = pc.sound_pressure(samples.radiation_pressure, AIR)
    most = session.solve(samples.positions, t, regions=samples.regions, scale="max")
    inside = samples.radiation_pressure > 0.0
    half = 0.5 * float((np.abs(most.sound_pressure[inside]) ** 2).mean() / t.max() ** 2)
    g = session.solve(samples.positions, math.sqrt(half) * t, regions=samples.regions).gains
    x, y = np.random.default_rng(2).uniform(-0.016, 0.016, (2, 3000))
    places = np.stack([x, y, np.full(len(x), 0.2)], axis=-1)[bean(x, y)]
    p = pc.field(array, g, places, AIR, precision="double")
    P = np.abs(p) ** 2 / (half * t.max() ** 2)
    assert P.mean() == pytest.approx(1.0, abs=0.03)
    assert np.sqrt(np.mean((P - 1.0) ** 2)) < 0.05
    assert P.min() > 0.5


@pytest.mark.parametrize("period", [0.005, 0.009, 0.012])
def test_narrow_gaps_stay_gaps(period: float) -> None:
    """Samples on the outlines of stripes that lie close together would fill the gaps."""
    local, texture = plate(None).sample_surface(0.00275), grating(period)
    made, factor, silent = lay_out(texture, local, 0.00275)
    np.testing.assert_array_equal(made.points, local.points)
    np.testing.assert_array_equal(factor, texture.at(local.points))
    assert not silent.any()


def test_a_smooth_texture_keeps_its_samples() -> None:
    local = plate(None).sample_surface(SPACING)
    ramp = Texture(values=((0.0, 0.0, 1.0),), size=(2.0 * SIDE, SIDE), repeat=False)
    made, factor, silent = lay_out(ramp, local, SPACING)
    assert (ramp.at(local.points) <= 0.0).any()
    assert not silent.any()
    np.testing.assert_array_equal(made.points, local.points)
    np.testing.assert_array_equal(factor, ramp.at(local.points))


@pytest.mark.parametrize("value", [0.0, 0.5, 1.0])
def test_an_even_texture_changes_no_place(value: float) -> None:
    local = plate(None).sample_surface(SPACING)
    made, factor, silent = lay_out(Texture(values=((value,),), size=(SIDE, SIDE)), local, SPACING)
    np.testing.assert_array_equal(made.points, local.points)
    assert factor == pytest.approx(value)
    assert not silent.any()
