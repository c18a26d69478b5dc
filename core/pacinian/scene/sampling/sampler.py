"""The sampler turns a scene into samples at each tick, where hands touch objects, as finely as the array resolves."""

from __future__ import annotations

import math
import zlib
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from pacinian.argument_checks import MAX_LENGTH, check_integer, check_length, check_number
from pacinian.native.scene import merge
from pacinian.scene.config_sections import DEFAULT_BUDGET, MIN_SAMPLE_SPACING
from pacinian.scene.modulation.technique import AM
from pacinian.scene.modulation.waves import Constant
from pacinian.scene.objects import Body, Point, Surface, Volume
from pacinian.scene.sampling.array_resolution import ArrayResolution
from pacinian.scene.sampling.contact import Contact, find_contact, touches_unseen
from pacinian.scene.sampling.distance_cache import DistanceCache
from pacinian.scene.sampling.hand_tracking import HandTrack
from pacinian.scene.sampling.perception_thresholds import lowest_threshold
from pacinian.scene.sampling.pose_prediction import PosePredictor
from pacinian.scene.sampling.ramps import PressureRamps
from pacinian.scene.sampling.sample_budget import (
    ALONE,
    FINE_ON_SKIN,
    ON_SKIN,
    PLAIN,
    allot_budget,
)
from pacinian.scene.sampling.sample_cache import SampleCache, estimate_samples
from pacinian.scene.sampling.sample_counts import (
    COARSENED,
    FACES_AWAY,
    FAINT,
    FAR,
    HAND_FADING,
    HAND_LOST,
    MERGED,
    NO_SURFACE,
    OUTSIDE,
    OVER_BUDGET,
    PRESSURE_LIMITED,
    TOO_FINE,
    SampleCounts,
)
from pacinian.scene.sampling.sample_sources import (
    PointContacts,
    SampleSource,
    SinglePoint,
    WholeObject,
    cull,
    forms_region,
    is_sequential,
    lacks_surface,
)
from pacinian.scene.sampling.samples import ISOLATED, Samples, join_samples, no_samples
from pacinian.scene.sampling.silent_samples import FINE_SURROUND, SURROUND, add_surround
from pacinian.scene.sampling.small_region_spacing import refine
from pacinian.scene.sampling.spacing import (
    FINE_LEAST,
    FINE_SHARE,
    IN_TIME,
    REGION_SPACING,
    SPACING_WITHOUT_ARRAY,
    ContactDensity,
    compute_spacing,
    space_contacts,
)
from pacinian.scene.sampling.touched_skin import scatter_places, stays_on_skin
from pacinian.skip_reasons import (
    AWAY_FROM_HANDS,
    COARSENED_SAMPLES,
    FORCES_LIMITED,
    HANDS_LOST,
    OBJECTS_OUTSIDE,
    SAMPLES_FAINT,
    SAMPLES_MERGED,
    SAMPLES_OVER_BUDGET,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.scene.hands.skin import Skin
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.scene import Scene, Workspace
    from pacinian.types import Floats

NAMES = 1 << 31  # numbers of objects in sample keys are smaller than this
OFF = Constant(0.0)
COUNTED = {
    COARSENED: COARSENED_SAMPLES,
    OVER_BUDGET: SAMPLES_OVER_BUDGET,
    MERGED: SAMPLES_MERGED,
    FAINT: SAMPLES_FAINT,
    PRESSURE_LIMITED: FORCES_LIMITED,
}
"""Reasons of `Sampler.skipped`, by those of the sample counts."""
MERGE_SHARE = 0.5  # isolated samples of different objects merge if they are nearer than this fraction of the spacing
MERGE_DISTANCE = 1e-6  # samples of different regions merge if they are nearer than this [m]
MAX_UNSEEN = 8  # largest number of objects that are checked for skin that faces away
MAX_SCATTERED = 8  # largest number of objects whose contacts are measured at a time
MAX_MERGE_SAMPLES = 2048  # largest number of samples that are considered for merging


class Sampler:
    """Samples scenes, and keeps state between ticks.

    Because of this state, samples stay fixed to their object or to the skin, and their pressures ramp up and down.

    budget: maximum number of samples. Surfaces and volumes that meet hands use four fifths of it, because contacts take
    more time, or 1.2 times it if their spacing is coarser than intended. One of them alone in free air may use up to
    twice as many, if `steers` is set. If a scene has more, the sampler samples the objects of lowest priority more
    coarsely, and then drops them. spacing: between samples [m]. The default is one wavelength, or the resolution of the
    array where that is coarser. The samples of surfaces and volumes form regions: these use 0.35 times the default, or
    less if they are small. Where a hand touches them, they use 0.06 to 0.3 times the default, less for smaller
    contacts; without the attribute `fine`, at least 0.08 times. ramp: time in which a pressure rises or falls [s]; 0
    disables ramps. perception: whether to leave out samples that are too faint to feel on a hand.

    Set the attribute `allowed` below the budget to save time. It is ignored if the scene has regions, because they
    would get holes.

    The force of points and particles is spread over the focus that the array makes where they are felt
    (`pacinian.focal_area`). The object's own disc is used instead before `prepare`, and where no focus is possible
    (on a transducer, or with a single transducer). Raises ArgumentError.
    """

    def __init__(
        self,
        budget: int = DEFAULT_BUDGET,
        spacing: float | None = None,
        *,
        ramp: float = 0.0,
        perception: bool = True,
    ) -> None:
        self.budget = self.allowed = check_integer("budget", budget, low=1)
        if spacing is not None:
            spacing = check_number(
                "spacing", check_length("spacing", spacing), low=MIN_SAMPLE_SPACING
            )
        self.spacing = spacing
        self.ramp = check_number("ramp", ramp, low=0.0, high=10.0)
        self.perception = bool(perception)
        self.bands = 1
        """Maximum number of bands that sound in turn, each within the budget. The render loop sets this."""
        self.max_uniform_points = 1.0
        """`Solver.max_uniform_points` of the solver, for samples that sound at once. The render loop sets this."""
        self.peak = math.inf
        """Maximum radiation pressure that a force may request [Pa]. The render loop sets this."""
        self.surround = False
        """Whether to surround regions that touch skin with silent samples. The render loop sets this for its solver."""
        self.strict = False
        """Whether to raise ArgumentError instead of leaving out or coarsening anything. The render loop sets this."""
        self.steers = False
        """Whether the field of one object in free air may be steered. The render loop sets this."""
        self.fine = True
        """Whether contacts have many samples, because solves may take long. The render loop sets this."""
        self.skipped: Counter[str] = Counter()
        """Number of samples, objects and hands left out, by reason."""
        self.skin: Skin | None = None
        """Replaces the default skin of hands made of joints. Set it before the first sample."""
        self._resolving: ArrayResolution | None = None
        self.reset()

    def reset(self) -> None:
        """Discard all state, so that the next scene starts from silence."""
        self._tracks, self._hands = PosePredictor(), dict[str, HandTrack]()
        self._covers, self._distances = SampleCache(), DistanceCache()
        self._ramps = PressureRamps(self.ramp)
        self._asked: tuple[object, ...] = ()
        self._target = no_samples()
        # Hands of the last call, and its time [s].
        self._present: tuple[list[PosedSkin], float] = [], 0.0
        self._chance = np.random.default_rng(0)
        self.frame_budget = self.budget
        """Maximum number of samples in one frame at the last call of `sample`."""
        self.sample_counts = SampleCounts()
        """What each object asked for at the last call of `sample`, and what was left out, before ramps."""
        self._levels: dict[int, int] = {}
        self._wanted: dict[int, float] = {}  # last spacing of each contact [m]
        self._still, self._ahead = False, 0.0
        self._rooms: tuple[object, Floats] = (self, np.empty(6))

    def prepare(self, array: Array, medium: Air) -> None:
        """Set the array and medium to sample for, and reset."""
        self._resolving = ArrayResolution(array, medium)
        self.reset()

    @property
    def still(self) -> bool:
        """Whether the passing of time moves nothing in the scene of the last call of `sample`; ramps do not count."""
        return self._still

    def invalidate(self) -> None:
        """Sample again at the next call, even if the scene is the same."""
        self._still = False

    def sample(self, scene: Scene, t: float = 0.0, ahead: float = 0.0) -> Samples:
        """Return samples of `scene` at time t [s]: the same object as before if nothing has changed.

        ahead: how far t lies in the future [s].
        """
        self._ahead = ahead
        asked = (
            scene, self.allowed, self.spacing, self.bands, self.surround, self.max_uniform_points, self.strict,
            self.fine, self.steers,
        )  # fmt: skip
        if not (self._still and self._asked == asked):
            self._target = self._sample(scene, t)
            self._asked = asked
        return self._ramps.follow(self._target, t)

    def rest_until(self, t: float) -> None:
        """Let a change at the next call of `sample` begin at time t [s]: nothing has changed until then."""
        self._ramps.rest_until(t)

    def pose_seen(self) -> tuple[PosedSkin, ...]:
        """Return the skins of the hands at the last call of `sample`, as they were seen: not blended, and none lost."""
        hands, t = self._present
        return tuple(self._hands[hand.hand.name].pose_seen(hand, t) for hand in hands)

    def scatter_places(self, scene: Scene, t: float, count: int) -> Samples:
        """Return random places on the touched skin and beside it at time t [s], as `scatter_places` describes.

        Hands and objects are where the scene puts them, without the blending of updates, and pressures have no ramps.
        Objects whose technique moves their samples are left out; of many objects, some are taken by chance. count: of
        places, roughly. Forgets hands and poses, so use a sampler of its own for it, without perception.
        """
        self._tracks, self._hands = PosePredictor(), {}
        hands = self._track_hands(scene, t, SampleCounts(scene.objects))
        if not hands or self._resolving is None:
            return no_samples()
        near = cull(scene.bounds, t, self._boxes(scene, hands, skin=True)).tolist()
        found = [i for i in near if stays_on_skin(scene.objects[i])]
        if len(found) > MAX_SCATTERED:
            found = self._chance.choice(found, MAX_SCATTERED, replace=False).tolist()
        sources = self._sources(scene, t, found, hands, skin=True)
        contacts = [source for source, _ in sources if isinstance(source, Contact)]
        places = scatter_places(contacts, count, self._resolving.corners, self._chance)
        places = places.changed(capsules=_all([hand.capsules for hand, _ in hands]))
        return self._cut(scene.workspace)(places)

    def _sample(self, scene: Scene, t: float) -> Samples:
        """Return the target samples at time t [s], before the ramps."""
        counts = self.sample_counts = SampleCounts(scene.objects)
        counts.samples = self._make_samples(scene, t, counts)
        if not counts.clean:
            for reason, skipped in COUNTED.items():
                if count := counts.total(reason):
                    self.skipped[skipped] += count
        return counts.samples

    def _make_samples(self, scene: Scene, t: float, counts: SampleCounts) -> Samples:
        skin = bool(scene.hands)
        hands = self._track_hands(scene, t, counts)
        self._present = [hand for hand, _ in hands], t
        capsules = _all([hand.capsules for hand, _ in hands]) if skin else None
        boxes = self._boxes(scene, hands, skin)
        found = cull(scene.bounds, t, boxes).tolist()
        culled = len(scene.objects) - len(found)
        outside = 0 if skin or not culled else self._note_outside(scene, found, counts)
        self.skipped[AWAY_FROM_HANDS] += culled - outside
        self.skipped[OBJECTS_OUTSIDE] += outside
        sources = self._sources(scene, t, found, hands, skin)
        for source, _ in sources:
            if self._find_unresolved(source.item, source.place) > 0.0:
                counts.note_object(TOO_FINE, source.index)
            if isinstance(source, WholeObject) and lacks_surface(source.item):
                counts.note_object(NO_SURFACE, source.index)
        self._still = (
            t >= max(scene.moves_until, self._tracks.blends_until)
            and not any(track.can_move(t) for track in self._hands.values())
        )  # fmt: skip
        if not sources:
            self._note_unseen(scene, t, found, hands, counts)
            return no_samples(scene.objects, capsules)
        solid = any(forms_region(source.item) for source, _ in sources)
        budget = self.budget if solid else min(self.budget, self.allowed)
        alone = solid and self.steers and not skin and not self.strict and len(sources) == 1
        alone = alone and sources[0][0].item.technique.still
        allowance = ALONE if alone else PLAIN
        if solid and skin:
            allowance = FINE_ON_SKIN if self.fine else ON_SKIN
        self.frame_budget = allowance.find_limit(budget, len(allowance.shares) - 1)
        parts = allot_budget(
            sources,
            budget,
            self._levels,
            self._cut(scene.workspace),
            counts,
            self.bands,
            self.budget,
            allowance=allowance,
            strict=self.strict,
        )
        if len(parts) > 1:
            parts = [self._merge_samples([source.item for source, _ in sources], parts, counts)]
        parts = [self._focal(parts[0], counts)]
        if self.surround and skin and solid and self._resolving is not None:
            touching, centre = [hand for hand, _ in hands], self._resolving.centre
            resolved = min(
                self._resolving.compute_isolated_spacing(hand.centre) for hand in touching
            )
            left = allowance.find_limit(budget, 0) - len(parts[0])
            surround = FINE_SURROUND if self.fine else SURROUND
            parts = [add_surround(parts[0], touching, centre, resolved, left, surround)]
        return parts[0] if len(hands) < 2 else parts[0].changed(capsules=capsules)

    def _note_unseen(
        self, scene: Scene, t: float, found: list[int], hands: list[tuple[PosedSkin, float]], counts: SampleCounts
    ) -> None:  # fmt: skip
        """Note objects that touch only skin that faces away from the array, where nothing is felt.

        found: indices of the objects near the hands; the first MAX_UNSEEN are checked.
        """
        resolving = self._resolving
        if resolving is None:
            return
        for i in found[:MAX_UNSEEN]:
            item = scene.objects[i]
            if (
                not isinstance(item, (Surface, Volume))
                or not item.pressure > 0.0
                or item.envelope == OFF
            ):
                continue
            pose = self._tracks.pose(item, t)
            name = _name(item, i)
            if any(
                touches_unseen(
                    item, pose, (name + hand.salt) % NAMES, hand, resolving, self._distances
                )
                for hand, _ in hands
            ):
                counts.note_object(FACES_AWAY, i)

    def _note_outside(self, scene: Scene, found: list[int], counts: SampleCounts) -> int:
        """Count the samples of objects that need no hand, but lie outside the workspace or too far from the array.

        Returns how many objects are outside the workspace and would press.
        """
        outside = 0
        for i in sorted(set(range(len(scene.objects))) - set(found)):
            item = scene.objects[i]
            if item.pressure > 0.0 and item.envelope != OFF:
                spacing = self.spacing or SPACING_WITHOUT_ARRAY * (
                    REGION_SPACING if forms_region(item) else 1.0
                )
                count = round(estimate_samples(item, spacing))
                counts.ask(i, count)
                counts.note(FAR if scene.workspace is None else OUTSIDE, i, count)
                outside += scene.workspace is not None
        return outside

    def _focal(self, samples: Samples, counts: SampleCounts) -> Samples:
        """Spread the forces of foci over the area that the focus has at each sample."""
        if self._resolving is None:
            return samples
        if not any(samples.items[i].focal for i in set(samples.objects.tolist())):
            return samples
        items = [samples.items[i] for i in samples.objects.tolist()]
        which = np.flatnonzero([item.focal for item in items])
        single = np.array([is_sequential(items[i]) for i in which])
        together = len(items) - sum(map(is_sequential, items))
        P, most, area = samples.radiation_pressure.copy(), samples.most.copy(), samples.area.copy()
        for uniform in (True, False):
            rows = which[(np.where(single, 1, together) <= self.max_uniform_points) == uniform]
            if not len(rows):
                continue
            found = self._resolving.focal_areas(
                samples.positions[rows], samples.normals[rows], uniform=uniform
            )
            found = np.where(np.isnan(found), area[rows], found)
            P[rows] *= area[rows] / found
            most[rows] *= area[rows] / found
            area[rows] = found
        counts.note_rows(PRESSURE_LIMITED, samples, which[P[which] > self.peak])
        P[which], most[which] = np.minimum(P[which], self.peak), np.minimum(most[which], self.peak)
        return samples.changed(radiation_pressure=P, most=most, area=area)

    def _track_hands(
        self, scene: Scene, t: float, counts: SampleCounts
    ) -> list[tuple[PosedSkin, float]]:
        """Return the hands that are present, each with the factor on its pressures, 0..1."""
        tracks = {
            hand.name: self._hands.get(hand.name) or HandTrack(self.skin) for hand in scene.hands
        }
        self._hands = tracks
        there: list[tuple[PosedSkin, float]] = []
        for hand in scene.hands:
            now, share = tracks[hand.name].at(hand, t, self._ahead)
            if now is None:
                self.skipped[HANDS_LOST] += 1
                counts.note_hand(HAND_LOST, hand.name)
            else:
                if share < 1.0:
                    counts.note_hand(HAND_FADING, hand.name)
                there.append((tracks[hand.name].pose_skin(now), share))
        return there

    def _boxes(self, scene: Scene, hands: list[tuple[PosedSkin, float]], skin: bool) -> Floats:
        """Return the boxes in which objects can be felt, as lower and upper corners, (boxes, 6) [m]."""
        room = self._room(scene.workspace)
        if not skin:
            return room[None]
        boxes = np.empty((len(hands), 6))
        for box, (hand, _) in zip(boxes, hands, strict=True):
            np.maximum(hand.box[:3], room[:3], out=box[:3])
            np.minimum(hand.box[3:], room[3:], out=box[3:])
        return (
            boxes if scene.workspace is None else boxes[(boxes[:, :3] <= boxes[:, 3:]).all(axis=1)]
        )

    def _room(self, workspace: Workspace | None) -> Floats:
        """Return the box in which anything can be felt at all, (6,) [m]."""
        if self._rooms[0] is workspace:
            return self._rooms[1]
        room = np.array([-np.inf] * 3 + [np.inf] * 3)
        if self._resolving is not None:
            centre = self._resolving.centre
            room = np.concatenate([centre - MAX_LENGTH, centre + MAX_LENGTH])
        if workspace is not None:
            low, high = workspace.lower, workspace.upper
            room = np.concatenate([np.maximum(room[:3], low), np.minimum(room[3:], high)])
        self._rooms = workspace, room
        return room

    def _sources(
        self, scene: Scene, t: float, found: list[int], hands: list[tuple[PosedSkin, float]],
        skin: bool,
    ) -> list[tuple[SampleSource, float]]:  # fmt: skip
        """Return the sources of samples, highest priority first, each with its intended spacing [m]."""
        objects, sources = scene.objects, list[tuple[SampleSource, float]]()
        for i in found:
            item = objects[i]
            if not item.pressure > 0.0 or item.envelope == OFF:
                continue
            name, pose = _name(item, i), self._tracks.pose(item, t)
            if not skin:
                of = SinglePoint if isinstance(item, Point) else WholeObject
                whole = of(item, i, name, pose, self._covers, objects)
                sources.append((whole, self._compute_spacing(item, pose.position)))
                continue
            judged = self.perception and not self.strict
            least = lowest_threshold(find_vibration(item)) if judged else 0.0
            for hand, share in hands:
                own = (name + hand.salt) % NAMES
                source: SampleSource | None
                if isinstance(item, (Surface, Volume)):
                    source = find_contact(
                        item,
                        pose,
                        i,
                        own,
                        hand,
                        objects,
                        share,
                        least,
                        self._resolving,
                        self._distances,
                    )
                else:
                    source = PointContacts(
                        item,
                        i,
                        own,
                        pose,
                        self._covers,
                        objects,
                        hand,
                        share,
                        self._resolving,
                        least,
                    )
                if source is not None:
                    sources.append((source, self._compute_spacing(item, hand.centre)))
        if self.spacing is None:
            density = ContactDensity(FINE_SHARE * self.budget, FINE_LEAST) if self.fine else IN_TIME
            self._wanted = space_contacts(sources, density, self._wanted)
        sources.sort(key=lambda source: -source[0].item.priority)
        return sources if skin or self.spacing is not None else refine(sources, self.budget)

    def find_fine_textures(self, scene: Scene) -> Iterator[tuple[int, float, float]]:
        """Yield the objects whose texture is finer than the array resolves where they are.

        Yields the index of each, the period of its texture, and the shortest period that the array resolves there [m].
        Raises ArgumentError if a texture's file cannot be read.
        """
        for i, item in enumerate(scene.objects):
            if (resolved := self._find_unresolved(item, item.pose.position)) > 0.0:
                assert isinstance(item, Body)
                assert item.texture is not None
                yield i, item.texture.period, resolved

    def _find_unresolved(self, item: Object, place: tuple[float, float, float]) -> float:
        """Return the shortest period that the array resolves at `place`, if the texture is finer, else 0 [m]."""
        texture = getattr(item, "texture", None)
        if texture is None or self._resolving is None:
            return 0.0
        resolved = self._resolving.compute_period(place)
        return resolved if texture.period < resolved else 0.0

    def _compute_spacing(self, item: Object, place: tuple[float, float, float]) -> float:
        """Return the spacing of an object's samples at `place` [m]."""
        own = self.spacing
        return compute_spacing(item, place, self._resolving) if own is None else own

    def _cut(self, workspace: Workspace | None) -> Callable[[Samples], Samples]:
        """Return a function that drops the samples outside the workspace."""

        def cut(samples: Samples) -> Samples:
            if workspace is None:
                return samples
            if len(samples) == 1:  # fast path, mostly for points
                x, y, z = samples.positions[0].tolist()
                (a, b, c), (u, v, w) = workspace.lower, workspace.upper
                if a <= x <= u and b <= y <= v and c <= z <= w:
                    return samples
            kept = workspace.holds(samples.positions)
            return samples if kept.all() else samples.only(kept)

        return cut

    def _merge_samples(
        self, items: list[Object], parts: list[Samples], counts: SampleCounts
    ) -> Samples:
        """Join all samples, and merge those of different `items` that the array cannot resolve.

        Only samples of equal envelope and technique are merged; if `strict`, only those at one place.
        """
        whole = join_samples(parts)
        if len(whole) > MAX_MERGE_SAMPLES:
            return whole
        sizes = [len(part) for part in parts]
        source = np.repeat(np.arange(len(parts)), sizes)
        group = np.repeat(_number_groups(items), sizes)
        P, area = np.empty(len(whole)), np.empty(len(whole))
        kept = np.empty(len(whole), dtype=np.bool_)
        apart = MERGE_SHARE * (SPACING_WITHOUT_ARRAY if self.spacing is None else self.spacing)
        radius = np.full(len(whole), MERGE_DISTANCE if self.strict else apart)
        radius[whole.regions != ISOLATED] = MERGE_DISTANCE
        gone = merge(
            whole.positions, whole.radiation_pressure, whole.area, source, group, radius,
            P, area, kept,
        )  # fmt: skip
        if not gone:
            return whole
        counts.note_rows(MERGED, whole, ~kept & (whole.radiation_pressure > 0.0))
        return whole.changed(radiation_pressure=P, area=area).only(kept)


def _name(item: Object, index: int) -> int:
    """Return a number that identifies an object from tick to tick."""
    return zlib.crc32(item.name.encode()) % NAMES if item.name else index


def _number_groups(items: list[Object]) -> list[int]:
    """Number the items so that items of equal envelope and technique share a number."""
    seen: list[tuple[object, object]] = []
    numbers = list[int]()
    for item in items:
        group = item.envelope, item.technique
        if group not in seen:
            seen.append(group)
        numbers.append(seen.index(group))
    return numbers


def find_vibration(item: Object) -> object:
    """Return the envelope or technique that sets the frequency at which an object is felt; None if neither does."""
    if not item.technique.still:
        return None
    return item.technique if isinstance(item.technique, AM) else item.envelope


def _all(capsules: list[Floats]) -> Floats:
    return np.concatenate([np.empty((0, 8)), *capsules])
