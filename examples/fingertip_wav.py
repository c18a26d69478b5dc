"""Play a WAV file on a fingertip: its waveform modulates the pressure that the finger feels."""

import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.io import wavfile

import pacinian as pc
from pacinian.plot import figure, save
from pacinian.testing import ManualClock

RATE = 2000  # [Hz] of the file
t = np.arange(RATE // 2) / RATE
knock = np.exp(-12.0 * (t % 0.25)) * np.sin(2.0 * np.pi * 120.0 * t)  # two knocks

folder = tempfile.TemporaryDirectory()  # for your own file: pc.Wave(file="knock.wav")
wavfile.write(Path(folder.name) / "knock.wav", RATE, (32767 * knock).astype(np.int16))
wave = pc.Wave(file=str(Path(folder.name) / "knock.wav"))

hand = pc.Hand.open("right", pc.Pose((0.0, -0.1, 0.215)))
assert hand.joints is not None
x, y, z = hand.joints[10]  # the index finger's tip, in OpenXR's order [m]
button = pc.Volume(
    shape=pc.Sphere(0.012),
    pose=pc.Pose((x, y, z - 0.012)),
    radiation_pressure=10.0,  # [Pa]
    envelope=wave,
    name="button",
)
array, clock = pc.autd(3, 3), ManualClock()
backend = pc.backend("simulated")
felt, at = [], np.empty((0, 3))
scene = pc.Scene((button,), hands=(hand,))
with pc.Renderer(array, scene, backend=backend, adaptive=False, clock=clock) as renderer:
    for tick in range(500):
        clock.time = tick * renderer.period
        renderer.tick(clock.time)
        samples = renderer.samples
        at = samples.positions if samples is not None else at[:0]
        p = pc.field(array, renderer.last_frame.gains(backend.capability)[-1], at, medium=pc.Air())
        felt.append(pc.radiation_pressure(p, pc.Air()).sum() / max(len(at), 1))
print(f"{len(at)} samples on the fingertip, at most {max(felt):.1f} Pa on average")
folder.cleanup()
page = figure(6.0, 3.4)
upper, lower = page.subplots(2, 1, sharex=True)
upper.plot(1e3 * t, knock, lw=0.8)
upper.set(ylabel="WAV file", title="A WAV on a fingertip")
lower.plot(np.arange(500), felt, lw=0.8)
lower.set(xlabel="time [ms]", ylabel="mean pressure [Pa]")
save(page, sys.argv[1] if len(sys.argv) > 1 else "fingertip_wav.png")
