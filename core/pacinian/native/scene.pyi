# Made by `python native_build.py --stubs`.
from pacinian.types import Flags, Floats, Longs


def spread(points: Floats, normals: Floats, fingers: Longs, spacings: Floats, order: Longs, apart: Floats, nearest: Longs, counts: Longs) -> None:
    """
    Choose points one after the other, each the one farthest from those before it: see `skin_lod.spread_pressure`.

    points, normals: (N, 3). fingers: (N,). spacings: of each level, coarse to fine, (L,) [m]. order, apart: written,
    (N,). nearest: written, (L, N). counts: of the points of each level, written, (L,).
    """

def share(points: Floats, normals: Floats, fingers: Longs, nodes: int, spacing: float, indices: Longs, weights: Floats) -> None:
    """
    Share every point among the nearest of the first `nodes`: see `skin_lod.share_pressure`.

    points, normals: (N, 3). fingers: (N,). spacing: of the nodes [m]. indices, weights: written, (N, 3); zero before.
    """

def capsules(joints: Floats, radii: Floats, ends: Longs, out: Floats) -> None:
    """
    Write a hand's capsules, (C, 8) [m]: both ends of each axis, and the radius at either, means of two joints.

    joints: (26, 3) [m]. radii: (26,) [m]. ends: the joints of the first end and of the last, (C, 4).
    """

def bounds(capsules: Floats, out: Floats) -> None:
    """
    Write a sphere around each capsule, (C, 8): its centre and radius, (C, 4) [m].
    """

def nearest(capsules: Floats, points: Floats, steps: int, surface: Floats, normals: Floats, distance: Floats, bone: Longs) -> None:
    """
    Write the nearest skin of the union of capsules, (C, 8), to points, (P, 3) [m]: see `capsules.Nearest`.

    steps: at most, from inside to the surface; with 0 the distances alone are to be used.
    """

def buried(capsules: Floats, points: Floats, bone: Longs, slack: Floats, which: Longs, out: Flags) -> None:
    """
    Write whether each of the points `which`, (K,), lies inside of a capsule, deeper than its slack: `out`, (K,).

    capsules: (C, 8). points: (P, 3) [m]. bone: each point's own capsule, which does not count, (P,). slack: (P,) [m].
    """

def tilt(axial: Floats, along: Floats, first: float, last: float, length: float, out: Floats, area: Floats) -> None:
    """
    Write the axial parts of normals where a capsule tapers, and what the areas there are proportional to [m^2].

    axial, along: (N,), as for `capsule_skin._Around`. first, last: radii [m]. length: [m]. out, area: (N,).
    """

def place_on_capsules(joints: Floats, mirror: float, capsules: Floats, parents: Longs, axes: Floats, length: Floats, radii: Floats, bone: Longs, along: Floats, axial: Floats, sides: Floats, area: Floats, at: Floats, facing: Floats, stands: Floats) -> None:
    """
    Write where the points of a capsule skin are: `at`, `facing`, (K, 3), and the area each `stands` for, (K,).

    joints: (26, 3) [m]. mirror: -1 for a left hand. capsules: (C, 8) [m]. parents, axes, length, radii: of the bones at
    rest, (C,), (C, 3), (C,), (C, 2). bone, along, axial, sides, area: of the points: see `CapsuleSkin`.
    """

def place_on_mesh(vertices: Floats, corners: Longs, coordinates: Floats, outward: float, doubled: Floats, area: Floats, patch: Longs, at: Floats, facing: Floats, stands: Floats, bounds: Floats) -> None:
    """
    Write where the points of a mesh skin are: `at`, `facing`, (K, 3), the area each `stands` for, (K,), `bounds`, (C, 4).

    vertices: (V, 3) [m]. corners: of each point's face, (K, 3). coordinates: barycentric, (K, 3). outward: 1 or -1.
    doubled: twice the face's area at rest. area: of each point at rest. patch: of each, (K,). bounds are 0 before.
    """

def candidates(points: Floats, normals: Floats, bone: Longs, bounds: Floats, centre: Floats, radius: float, R: Floats, corners: Floats, which: Longs, local: Floats) -> int:
    """
    Write which points of a skin lie in a sphere and face any of the corners, and where in its frame; return how many.

    points, normals: (K, 3). bone: of each, (K,). bounds: sphere of each bone, (C, 4). centre: (3,), radius: [m]. R: the
    frame's axes as columns, (3, 3). corners: (V, 3); without any, points need not face anything. which: (K,).
    local: (K, 3).
    """

def box(bounds: Floats, out: Floats) -> None:
    """
    Write the lower and the upper corner of the box around spheres, (C, 4), to `out`, (6,) [m].
    """

def press(d: Floats, which: Longs, reach: float, stiffness: float, max_pressure: float, points: Floats, normals: Floats, area: Floats, bone: Longs, slack: Floats, capsules: Floats, viewpoints: Floats, blocked: float, full: float, inside: Longs, force: Floats) -> int:
    """
    Write which points of a skin are pressed, and with how much; return how many.

    d: signed distance of the points `which`, (I,) [m]. reach [m], stiffness [Pa/m], max_pressure [Pa]: of a material.
    points, normals, area, bone, slack: of the skin, (K, 3), (K,). capsules: of the hand, (C, 8), inside of which, deeper
    than the slack, there is no skin; none for a mesh. viewpoints: positions of transducers, (V, 3); none: all skin is pressed.
    blocked, full: weighted mean cos^2 of the angle of incidence at which skin is not pressed, and fully. inside: indices into `which`, (I,). force: of each [N], (I,).
    """

def stale(which: Longs, local: Floats, places: Floats, known: Floats, beyond: float, deep: float, d: Floats, ask: Longs) -> int:
    """
    Reuse the known distances of points that have moved little; list the others, and return how many these are.

    A distance changes by no more than the point has moved. which: points, (I,). local: where they are, (I, 3). places,
    known: of all points, where each distance was asked, far away if never, and what it was, (K, 3), (K,). d: (I,), if
    farther outside than `beyond` or deeper inside than `deep` [m] not exactly. ask: the places in `which` of the others.
    """

def share_out(touched: Longs, force: Floats, indices: Longs, weights: Floats, least: float, got: Floats, nodes: Longs) -> int:
    """
    Share forces on points out among the nodes of a level; write which nodes got any, in order, and return how many.

    touched: (T,). force: (T,) [N]. indices, weights: of every point, (K, 3). least: share of the largest that counts as
    any. got: by node, (count,) [N]. nodes: (count,).
    """

def around(points: Floats, normals: Floats, count: int, q: Floats, centre: Floats, inner: float, outer: float, capsules: Floats, bone: Longs, slack: Floats, most: int, which: Longs, nearest: Longs) -> int:
    """
    Write which of the first `count` points of a skin lie beside q, (K, 3), and by which of these they are nearest.

    points, normals: (N, 3). inner, outer: how far away the nearest of q is [m]. centre: (3,); points that face away from
    it are left out, and so are those inside other flesh. capsules, bone, slack: as for `buried`; no capsules for a mesh.
    most: largest number of points. which, nearest: (count,). Returns how many there are.
    """

def thin(touched: Longs, force: Floats, level_count: int, node_area: Floats, rest_area: Floats, area: Floats, points: Floats, capsules: Floats, bone: Longs, slack: Floats, nodes: Longs, pressed: Floats, extent: Floats) -> int:
    """
    Keep those of the points `touched`, (I,), that are nodes of a level and not inside other flesh; return how many.

    force: on each, (I,) [N]. level_count: number of points, from the first on, that are nodes. node_area: area of each
    node at rest, (level_count,) [m^2]. rest_area, area: of each point, at rest and now, (K,) [m^2]. points: (K, 3) [m].
    capsules, bone, slack: as for `buried`; no capsules for a mesh. nodes, pressed, extent: the nodes kept, the force on
    each [N] and its area [m^2], with room for I.
    """

def press_on(nodes: Longs, force: Floats, extent: Floats, least: float, points: Floats, normals: Floats, name: int, P: Floats, area: Floats, positions: Floats, outward: Floats, keys: Longs) -> int:
    """
    Write the samples on `nodes`, (I,), that have an area and a pressure of at least `least` [Pa]; return how many.

    force, extent: on each node [N], and its area [m^2], (I,). points, normals: of the skin, (K, 3). name: number of the
    object in the samples' keys. P, area, positions, outward (normals), keys: of the samples, with room for I.
    """

def ramp(keys: Longs, positions: Floats, regions: Longs, area: Floats, P: Floats, most: Floats, last_keys: Longs, last_positions: Floats, last_regions: Longs, last_area: Floats, last_P: Floats, last_most: Floats, share: float, jump: float, now: Floats, top: Floats, going: Longs, fading: Floats, jumped: Flags) -> int:
    """
    Write the pressures and their maxima after one tick, `now` and `top`, (M,) [Pa]; return how many samples fade out.

    keys to most: of the samples asked for. last_keys to last_most: of those of the tick before. share: part of a full ramp
    that the tick covers. jump: distance from which on a sample starts anew [m]. going, fading, jumped: which of the last
    samples fade out, with what pressure [Pa], and whether they jumped; room for all, (L,).
    """

def merge(points: Floats, P: Floats, area: Floats, source: Longs, group: Longs, radius: Floats, pressed: Floats, stands: Floats, kept: Flags) -> int:
    """
    Merge samples of different sources and one group, nearer than both their `radius` [m], into the first of them.

    points: (M, 3) [m], in order of importance. P: (M,) [Pa]. area: (M,) [m^2]. source, group: (M,). Writes pressures,
    areas (a sample that takes another has both areas and the sum of the forces), and which are kept; returns how many
    are not.
    """

def visit_through(q: Floats, order: Longs) -> None:
    """
    Write the order of points q, (M, 3) [m], to `order`, (M,): from the first on, always the nearest that is left.
    """

def visit_around(q: Floats, order: Longs, corners: Longs) -> int:
    """
    Write which points q, (M, 2) [m], are corners of their hull, anticlockwise; of points on a line, its ends.

    order: of the points by x, then y, (M,). corners: room for 2 M + 1. Andrew's monotone chain: the lower side, then the
    upper. Returns how many.
    """

def measure_cells(marked: Flags, squared: Floats) -> None:
    """
    Write the squared distance of each cell, (X, Y, Z), from the nearest marked one [cells^2]; 1e12 if none is marked.
    """

def label_cells(free: Flags, part: Longs) -> int:
    """
    Write the number of the part of each free cell, (X, Y, Z), from 1 on; 0 for the others. Cells that share a face are
    of the same part. Returns the number of parts.
    """

def build_boxes(vertices: Floats, faces: Longs, order: Longs, boxes: Floats, right: Longs) -> int:
    """
    Write the tree of boxes of triangles: vertices, (V, 3) [m], faces, (F, 3), F > 0. Returns the number of nodes.

    order: of the triangles, (F,). boxes: lower and upper corner of each node, (F, 6) [m]. right: its second node, (F,).
    """

def find_closest(vertices: Floats, faces: Longs, order: Longs, boxes: Floats, right: Longs, points: Floats, squared: Floats, face: Longs, nearest: Floats) -> None:
    """
    Write the squared distance of points, (K, 3), from triangles [m^2], the nearest triangle and the nearest point [m].

    order, boxes, right: from `build_boxes`. From a point that is not finite, the distance is infinite.
    """

def label_bodies(edges: Longs, first: Longs, body: Longs) -> int:
    """
    Write the number of each triangle's body, (F,): bodies are parts that edges connect. Returns the number of bodies.

    edges: of the triangles, (F, 3). first: room for the first triangle of each edge, (E,).
    """

def near(bounds: Floats, t: float, boxes: Floats, found: Longs) -> int:
    """
    Write the indices of the objects whose bounding spheres touch any of the boxes at time t [s]; return how many.

    bounds: as `Scene.bounds`, (objects, 8). boxes: lower and upper corners, (boxes, 6) [m]. found: (objects,).
    """

def rough(points: Floats, low: Floats, high: Floats, size: float, gap: Floats, least: float, most: float, d: Floats, near: Longs) -> int:
    """
    Write bounds of the distance to `d`, and to `near` the indices of those from least to most [m]; return how many.

    low, high: corners of the box of cells [m]. size: of a cell [m]. gap: bound of each cell [m]; a point outside of the
    box is at a right angle or more from there to all in it.
    """

def sign(points: Floats, squared: Floats, face: Longs, nearest: Floats, inward: Floats, offset: Floats, normals: Floats, features: Longs, where: Longs, d: Floats) -> None:
    """
    Write the signed distance of the k-th point to d[where[k]].

    squared: of the distance [m^2], to the point `nearest` [m] of `face`. The others: see `MeshDistance`.
    """
