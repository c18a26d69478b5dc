"""Hands, given by joints or by a mesh, and their skin.

hand.py, default_hand.py       a hand as a tracker reports it; one at rest
bones.py, capsules.py          its bones; its flesh around them
skin.py, capsule_skin.py, mesh_skin.py   points fixed on its skin: in general, of 26 joints, of a mesh
skin_lod.py, skin_cache.py     coarser levels of these points; the skin of each kind of hand, built once
"""
