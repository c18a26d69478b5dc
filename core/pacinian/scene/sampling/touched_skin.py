"""Random places on touched skin and beside it, where the loop measures what is felt."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.neighbours import find_nearest
from pacinian.region_numbers import BESIDE
from pacinian.scene.hands.skin_lod import FINEST_SKIN_SPACING
from pacinian.scene.objects import Surface, Volume
from pacinian.scene.sampling.array_resolution import ArrayResolution
from pacinian.scene.sampling.contact import Contact, find_contact
from pacinian.scene.sampling.culling_boxes import CullingBoxes, cull, cut
from pacinian.scene.sampling.distance_cache import DistanceCache
from pacinian.scene.sampling.hand_tracking import HandTrack
from pacinian.scene.sampling.pose_prediction import PosePredictor
from pacinian.scene.sampling.posed_skin import PosedSkin, join_capsules
from pacinian.scene.sampling.sample_keys import number_contact, number_object
from pacinian.scene.sampling.sample_sources import forms_region
from pacinian.scene.sampling.samples import Samples, join_samples, no_samples
from pacinian.scene.sampling.unsampled_objects import is_silent

if TYPE_CHECKING:
    from numpy.random import Generator

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.scene.hands.skin import Skin
    from pacinian.scene.haptic_object import HapticObject
    from pacinian.scene.scene import Scene
    from pacinian.types import Floats

MAX_OBJECTS = 8  # largest number of objects whose contacts are measured at a time
TRIED = 3  # number of candidates of a contact that are tried for each place
MIN_PLACES = 8  # smallest number of places on one contact
# Distance by which touched skin extends beyond its outermost points, roughly [m].
MARGIN = FINEST_SKIN_SPACING / 4.0
# Limits of the distance from the places beside a contact to the touched points of the skin [m]. Half of the places are
# no farther away than CLOSE, because the pressure is mostly highest there.
INNER, CLOSE, OUTER = 3e-3 + MARGIN, 10e-3, 30e-3


class TouchedSkinObserver:
    """Finds random places on touched skin and beside it.

    Hands and objects are where the scene puts them, without the blending of updates, and pressures have no ramps.
    """

    def __init__(self, array: Array, medium: Air) -> None:
        self.skin: Skin | None = None
        """Replaces the default skin of hands made of joints."""
        self._resolution = ArrayResolution(array, medium)
        self._boxes = CullingBoxes(self._resolution.centre)
        self._distances = DistanceCache()
        self._rng = np.random.default_rng(0)

    def scatter_places(self, scene: Scene, t: float, count: int) -> Samples:
        """Return random places at time t [s], with the pressures that the materials ask for there.

        The places cover the whole touched skin evenly, also its rim. They are not those of samples. Where several
        contacts press on the same skin, they ask for the mean of their pressures. Other places lie 3 to 30 mm beside
        the touched skin. Their pressure is 0 and their region -2. Objects whose technique moves their samples are left
        out; of many objects, a random selection is used.

        count: of the places on all contacts, roughly. At most as many lie close beside the contacts of each hand, and
        as many farther away; those face the array.
        """
        skins, contacts = self._find_contacts(scene, t)
        total = sum(one.extent for one in contacts)
        found = list[Samples]()
        for one in contacts:
            sharing = [other for other in contacts if _share_skin(one, other)]
            wanted = max(MIN_PLACES, round(count * one.extent / total))
            found.append(_scatter_within(one, sharing, wanted, self._rng))
        for hand in {id(one.hand): one.hand for one in contacts}.values():
            touching = [one for one in contacts if one.hand is hand]
            corners = self._resolution.corners
            found.append(_scatter_beside(hand, touching, count, corners, self._rng))
        if not found:
            return no_samples()
        return cut(scene.workspace, join_samples(found).changed(capsules=join_capsules(skins)))

    def _find_contacts(self, scene: Scene, t: float) -> tuple[list[PosedSkin], list[Contact]]:
        """Return the skins of the hands that are present, and the contacts with them, highest priority first."""
        skins, shares = list[PosedSkin](), list[float]()
        for hand in scene.hands:
            track = HandTrack(self.skin)
            now, share = track.update(hand, t)
            if now is not None:
                skins.append(track.pose_skin(now))
                shares.append(share)
        if not skins:
            return [], []
        objects = scene.objects
        near: list[int] = cull(scene.bounds, t, self._boxes.find(scene, skins)).tolist()
        near = [i for i in near if stays_on_skin(objects[i])]
        if len(near) > MAX_OBJECTS:
            near = self._rng.choice(near, MAX_OBJECTS, replace=False).tolist()
        near.sort(key=lambda i: -objects[i].priority)
        poses, contacts = PosePredictor(), list[Contact]()
        for i in near:
            item = objects[i]
            if is_silent(item):
                continue
            assert isinstance(item, (Surface, Volume))
            pose, number = poses.pose(item, t), number_object(item, i)
            for skin, share in zip(skins, shares, strict=True):
                contact = find_contact(
                    item, pose, i, number_contact(number, skin), skin, objects, share, 0.0,
                    self._resolution, self._distances,
                )  # fmt: skip
                if contact is not None:
                    contacts.append(contact)
        return skins, contacts


def stays_on_skin(item: HapticObject) -> bool:
    """Return whether an object presses as a region where it touches skin, and no technique moves it away."""
    return forms_region(item) and item.technique.keeps_places


def _share_skin(one: Contact, other: Contact) -> bool:
    """Return whether two different contacts share touched skin."""
    if one is other or one.hand is not other.hand:
        return False
    return len(np.intersect1d(one.touched, other.touched, assume_unique=True)) > 0


def _scatter_within(
    contact: Contact, sharing: list[Contact], count: int, rng: Generator
) -> Samples:
    """Return random places on the touched skin, at most `count`."""
    hand = contact.hand
    some = contact.find_bordering(rng.permutation(len(contact.candidates))[: TRIED * count])
    some = np.sort(some[:count] if len(some) else contact.touched[:count])
    fine, spacing = hand.find_finest(some)
    drawn = 2 * count  # because some lie beside the touched skin
    fine = fine.only(rng.choice(len(fine.area), drawn, p=fine.area / fine.area.sum()))
    # move each place within its cell, along the skin
    turn, r = rng.uniform(0.0, 2.0 * np.pi, drawn), spacing / 2.0 * np.sqrt(rng.random(drawn))
    across = np.cross(fine.normals, np.eye(3)[np.abs(fine.normals).argmin(axis=1)])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    aside = np.cross(fine.normals, across)
    moved = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * aside
    fine = fine._replace(points=fine.points + r[:, None] * moved)
    own, total, pressing = np.zeros((3, drawn))
    for one in (contact, *sharing):
        nodes, force = one.press(fine)
        total[nodes] += force / fine.area[nodes]
        pressing[nodes] += force > 0.0
        if one is contact:
            own[:] = total
    nodes = np.flatnonzero(own)[:count]
    P, K = total[nodes] / pressing[nodes], len(nodes)
    return no_samples(contact.items, hand.capsules).changed(
        positions=fine.points[nodes],
        radiation_pressure=P,
        normals=fine.normals[nodes],
        area=np.full(K, contact.extent / max(K, 1)),
        objects=np.full(K, contact.index),
        keys=np.arange(K),
        most=np.full(K, contact.item.pressure),
        regions=np.full(K, contact.region),
    )


def _scatter_beside(
    hand: PosedSkin, touching: list[Contact], count: int, corners: Floats, rng: Generator
) -> Samples:
    """Return random places beside the skin that contacts touch: at most `count` close to it, and as many others."""
    touched = [one.touched for one in touching]
    q = hand.points[np.concatenate(touched)]
    low, high = q.min(axis=0) - OUTER, q.max(axis=0) + OUTER
    x, y, z = ((low < hand.points) & (hand.points < high)).T
    some = rng.permutation(np.flatnonzero(x & y & z))[: 16 * count]
    away = corners - hand.points[some, None]
    some = some[(np.einsum("kj,kvj->kv", hand.normals[some], away) > 0.0).any(axis=1)]
    some, nearest = some[hand.find_exposed(some)], np.zeros(0, np.intp)
    if len(some):
        away, nearest = find_nearest(q, hand.points[some])
        close = np.flatnonzero((away > INNER) & (away < CLOSE))[:count]
        far = np.flatnonzero((away >= CLOSE) & (away < OUTER))[:count]
        kept = np.concatenate([close, far])
        some, nearest = some[kept], nearest[kept]
    K, of = len(some), np.repeat(np.arange(len(touching)), [len(part) for part in touched])[nearest]
    return no_samples(touching[0].items, hand.capsules).changed(
        positions=hand.points[some],
        radiation_pressure=np.zeros(K),
        normals=hand.normals[some],
        area=np.zeros(K),
        objects=np.array([one.index for one in touching])[of],
        keys=np.arange(K),
        most=np.array([one.item.pressure for one in touching])[of],
        regions=np.full(K, BESIDE),
    )
