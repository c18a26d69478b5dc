"""Scenes of virtual objects and hands, and the samples that represent them to a solver.

objects.py, haptic_object.py   points, paths, particles, surfaces and volumes; fields and defaults that all share
scene.py, file.py, setup.py    a snapshot of objects and hands; scene files; what they share with a server's settings
material.py, motion.py         how hard an object feels; where it is between two updates
point_sets.py                  grids, discs and balls of points
shapes/                        what is felt: signed distances
hands/                         joints and skin of hands; what trackers send
modulation/                    envelopes and techniques
sampling/                      from a scene to samples
"""
