"""Devices: pacing of frames, quantisation, scatter between transducers.

frame_timing.py  how evenly frames reach a device's model, packing time, load of the bus
quantisation.py  error from a device's levels, with kinds of dithering
scatter.py       effect of scatter in strengths and phases, and what a microphone scan corrects
"""
