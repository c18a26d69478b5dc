"""Devices: pacing of frames, quantisation, scatter between transducers."""
