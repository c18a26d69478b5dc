"""Envelopes, which set an object's amplitude over time, and techniques, which present its samples in time.

envelope.py       `Envelope`: any amplitude over time; names of presets; STEADY
waves.py          `Constant`, `Sine`, `Square`, `Pulse`, `Function`; edges of 1.5 ms
noise.py          `Noise`: band-limited, from a seed
recorded_wave.py  `Wave`: recorded samples or a WAV file; resampled to a table
wav.py            reads WAV files
presets.py        "impulsive", "rapturous", "trembling", "buzzing": textures of Hasegawa and Shinoda
technique.py      `Simultaneous`, `AM`, `STM` (moving focus), `LM` (lateral modulation): frequency, path, step at a time
presentation.py   the samples that a technique shows at a step
stm_paths.py      the path of an STM focus through samples: a tour to the nearest one left, or around the convex hull
visit_order.hpp   the order of the samples: called by stm_paths.py
tangent_plane.py  plane fitted to a contact; directions along skin, for LM
"""
