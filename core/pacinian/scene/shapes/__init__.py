"""Shapes: primitives, meshes, combinations, voxels, functions; their distances, samples and textures.

box_disc_rectangle.py  `Box`, `Disc`, `Rectangle`
sphere_capsule.py      `Sphere`, `Capsule`
curves.py              `Line`, `Circle`, `Lissajous`, `Polyline`: paths, felt or followed by a focus
arc_length.py          arc length along a polyline, and distance to it
height_map.py          `HeightMap`: surface z = h(x, y) from numbers or a picture
voxels.py              `Voxels`: solid from a grid of values; distance field
sdf.py                 `SDF`: solid from a signed-distance function; samples and normals (gradient) of any solid
csg.py                 `Placed`, `Union`, `Intersection`, `Difference` of solids
csg_sampling.py        samples and area of the shell of such a combination
mesh.py                `Mesh`: triangle mesh, open or closed; its samples
triangles.py           vertices and faces from a file (OBJ, STL, PLY, ...), limits, normals, areas, whether they close
mesh_repair.py         merges equal vertices, drops unused ones and faces of two vertices, turns faces outward
mesh_distance.py       signed distance to a mesh, sign by pseudo-normals: is a point inside?
mesh_bounds.py         rough distances to a mesh from a grid of cells, for points far away
triangle_tree.py       tree of boxes: nearest triangle
winding.py             winding numbers, for mesh_bounds.py and mesh_repair.py
triangle_points.py     random points on triangles, barycentric coordinates
closest.hpp            nearest triangle, bodies: called by triangle_tree.py and mesh_repair.py
cells.hpp              distances between cells: called by mesh_bounds.py
poisson_disk.py        thins points out to even spacing
texture.py             `Texture`, `grating`: data, period, the factor on pressures; why a sweeping finger vibrates
local_samples.py       `LocalSamples`: samples in a shape's own frame; grids
array_data.py          arrays in scenes: numbers or a .npy file or picture, kept as bytes
shape_types.py         SHELLS: which shapes a surface may have (solids: SOLIDS in csg.py); distance to any
"""

from __future__ import annotations

from pacinian.scene.shapes.box_disc_rectangle import Box, Disc, Rectangle
from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.sphere_capsule import Capsule, Sphere

__all__ = ["Box", "Capsule", "Disc", "LocalSamples", "Rectangle", "Sphere"]
