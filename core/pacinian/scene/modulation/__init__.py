"""Envelopes, which set an object's amplitude over time, and techniques, which present its samples in time.

envelope.py, waves.py          what an envelope is; those of a formula
noise.py, recorded_wave.py, wav.py, presets.py   noise; recorded waves and WAV files; preset textures
technique.py, presentation.py  techniques and their options; the samples that they present at a time
stm_paths.py, visit_order.py, tangent_plane.py   paths of a focus; its order of points; directions along skin
"""
