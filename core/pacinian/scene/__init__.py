"""Scenes of virtual objects and hands, and the samples that represent them to a solver.

scene.py            `Scene`: snapshot of objects and hands; names are unique, in files too; bounding spheres
objects.py          `Point`, `Path`, `Particles`, `Surface`, `Volume`: immutable
haptic_object.py    what all objects share: force or pressure, envelope, technique, material, motion, priority
material.py         `Material`: stiffness, reach; pressure by depth for points; for bodies: sampling/posed_skin.hpp
motion.py           `Motion`: velocity; extrapolates a pose between two updates, for at most 0.1 s
file.py             scene files, TOML or JSON: keys, paths, JSON Schema; rules for the whole scene: scene.py
config_sections.py  sections of scene files and server settings, and their limits: array, medium, sampling, workspace
point_sets.py       `grid`, `disc`, `ball` of points
non_finite.hpp      kernels safe for NaN and infinity: called by sampling/sample_sources.py, shapes/mesh_distance.py
shapes/             what is felt: signed distances, meshes, textures
hands/              joints and skin of hands; what trackers send
modulation/         envelopes and techniques: AM, STM, LM, waves
sampling/           from a scene to samples: contact, budget, spacing, ramps
"""
