"""Hands, given by joints or by a mesh, and their skin.

hand.py          `Hand`: what a tracker sends, 26 joints or a mesh; checks, velocity, radii
default_hand.py  a flat right hand at rest: positions and radii of its 26 joints
bones.py         bones between joints, fingers, lines that fill the palm
capsules.py      flesh as tapered capsules around bones; distance to skin, nearest skin, what lies inside another finger
capsules.hpp     these distances: called by capsules.py
skin.py          `Skin`: points fixed to the hand; where they are at each pose; sharing forces between levels
capsule_skin.py  skin of a hand of 26 joints
mesh_skin.py     skin of a hand given as a mesh
skin.hpp         places points of skin: called by capsule_skin.py and mesh_skin.py
skin_lod.py      levels of detail: evenly spread nodes, finest spacing 1.75 mm
skin_lod.hpp     spreads nodes and shares forces: called by skin_lod.py
skin_cache.py    skin of each kind of hand, built once
"""
