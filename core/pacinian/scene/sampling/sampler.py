"""The sampler turns a scene into samples at each tick, where hands touch objects, as finely as the array resolves."""

from __future__ import annotations

import math
from collections import Counter
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from pacinian.argument_checks import check_integer, check_length, check_number
from pacinian.scene.config_sections import DEFAULT_BUDGET, MIN_SAMPLE_SPACING
from pacinian.scene.objects import Body, Point, Surface, Volume
from pacinian.scene.sampling.array_resolution import ArrayResolution
from pacinian.scene.sampling.contact import find_contact
from pacinian.scene.sampling.culling_boxes import CullingBoxes, cull, cut
from pacinian.scene.sampling.distance_cache import DistanceCache
from pacinian.scene.sampling.focal_pressure import spread_forces
from pacinian.scene.sampling.hand_tracking import HandTrack
from pacinian.scene.sampling.merge_samples import merge_samples
from pacinian.scene.sampling.perception_thresholds import find_vibration, lowest_threshold
from pacinian.scene.sampling.pose_prediction import PosePredictor
from pacinian.scene.sampling.posed_skin import join_capsules
from pacinian.scene.sampling.ramps import PressureRamps
from pacinian.scene.sampling.sample_budget import (
    ALONE,
    FINE_ON_SKIN,
    ON_SKIN,
    PLAIN,
    Allowance,
    allot_budget,
    make_all_samples,
)
from pacinian.scene.sampling.sample_cache import SampleCache
from pacinian.scene.sampling.sample_counts import (
    COARSENED,
    FAINT,
    HAND_FADING,
    HAND_LOST,
    MERGED,
    NO_SURFACE,
    OVER_BUDGET,
    PRESSURE_LIMITED,
    TOO_FINE,
    SampleCounts,
)
from pacinian.scene.sampling.sample_keys import number_contact, number_object
from pacinian.scene.sampling.sample_sources import (
    PointContacts,
    SampleSource,
    SinglePoint,
    WholeObject,
    forms_region,
    lacks_surface,
)
from pacinian.scene.sampling.samples import no_samples
from pacinian.scene.sampling.silent_samples import FAST_SURROUND, FINE_SURROUND, add_surround
from pacinian.scene.sampling.small_region_spacing import refine
from pacinian.scene.sampling.spacing import (
    FINE_LEAST,
    FINE_SHARE,
    IN_TIME,
    ContactDensity,
    compute_spacing,
    space_contacts,
)
from pacinian.scene.sampling.unsampled_objects import is_silent, note_outside, note_unseen
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
    from collections.abc import Iterator

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.scene.hands.skin import Skin
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.scene import Scene

COUNTED = {
    COARSENED: COARSENED_SAMPLES,
    OVER_BUDGET: SAMPLES_OVER_BUDGET,
    MERGED: SAMPLES_MERGED,
    FAINT: SAMPLES_FAINT,
    PRESSURE_LIMITED: FORCES_LIMITED,
}
"""Reasons of `Sampler.skipped`, by those of the sample counts."""


class SamplingMode(NamedTuple):
    """How scenes are sampled for the solves that follow: what the render loop, its limits and its solver ask for.

    bands: maximum number of bands that sound in turn, each within the budget. max_uniform_points: that of the solver,
    for samples that sound at once. peak: maximum radiation pressure that a force may request [Pa]. surround: whether to
    surround regions that touch skin with silent samples. strict: whether to raise ArgumentError instead of leaving out
    or coarsening anything. steers: whether the field of one object in free air may be steered. fine: whether contacts
    have many samples, because solves may take long.
    """

    bands: int = 1
    max_uniform_points: float = 1.0
    peak: float = math.inf
    surround: bool = False
    strict: bool = False
    steers: bool = False
    fine: bool = True


class Sampler:
    """Samples scenes, and keeps state between ticks.

    Because of this state, samples stay fixed to their object or to the skin, and their pressures ramp up and down.

    budget: maximum number of samples. Surfaces and volumes that meet hands may use 1.5 times it; without `mode.fine`,
    0.8 times it, or 1.2 times it if their spacing is coarser than intended. One of them alone in free air may use up to
    twice as many, if `mode.steers` is set. If a scene has more, the sampler samples the objects of lowest priority more
    coarsely, and then drops them. spacing: between samples [m]. The default is one wavelength, or the resolution of the
    array where that is coarser. The samples of surfaces and volumes form regions: these use 0.35 times the default, or
    less if they are small. Where a hand touches them, they use 0.06 to 0.3 times the default, less for smaller
    contacts; without `mode.fine`, at least 0.08 times. ramp: time in which a pressure rises or falls [s]; 0
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
        self.mode = SamplingMode()
        """How to sample. The render loop sets this before each solve."""
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
        self.frame_budget = self.budget
        """Maximum number of samples in one frame at the last call of `sample`."""
        self.sample_counts = SampleCounts()
        """What each object asked for at the last call of `sample`, and what was left out, before ramps."""
        self._coarseness: dict[int, int] = {}  # by priority
        self._wanted: dict[int, float] = {}  # last spacing of each contact [m]
        self._still, self._ahead = False, 0.0
        self._boxes = CullingBoxes(None if self._resolving is None else self._resolving.centre)

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
        asked = scene, self.allowed, self.spacing, self.mode
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
        hands = self._track_hands(scene, t, counts)
        skins = [hand for hand, _ in hands]
        self._present = skins, t
        capsules = join_capsules(skins) if scene.hands else None
        near = self._find_near(scene, t, skins, counts)
        sources = self._find_sources(scene, t, near, hands)
        self._note_unresolved(sources, counts)
        self._still = (
            t >= max(scene.moves_until, self._tracks.blends_until)
            and not any(track.can_move(t) for track in self._hands.values())
        )  # fmt: skip
        resolving, mode = self._resolving, self.mode
        if not sources:
            if resolving is not None:
                note_unseen(scene, t, near, skins, self._tracks, resolving, self._distances, counts)
            return no_samples(scene.objects, capsules)
        solid = any(forms_region(source.item) for source, _ in sources)
        budget = self.budget if solid else min(self.budget, self.allowed)
        allowance = self._choose_allowance(sources, solid=solid, skin=bool(scene.hands))
        self.frame_budget = allowance.find_limit(budget, len(allowance.shares) - 1)
        cut_off = partial(cut, scene.workspace)
        if mode.strict:
            parts = make_all_samples(
                sources, budget, cut_off, counts, mode.bands, allowance=allowance
            )
        else:
            parts = allot_budget(
                sources, budget, self._coarseness, cut_off, counts, mode.bands, self.budget,
                allowance=allowance,
            )  # fmt: skip
        items = [source.item for source, _ in sources]
        samples = merge_samples(parts, items, self.spacing, counts, strict=mode.strict)
        if resolving is not None:
            samples = spread_forces(samples, resolving, mode.max_uniform_points, mode.peak, counts)
            if mode.surround and solid and skins:
                left = allowance.find_limit(budget, 0) - len(samples)
                surround = FINE_SURROUND if mode.fine else FAST_SURROUND
                samples = add_surround(samples, skins, resolving, left, surround)
        return samples if len(hands) < 2 else samples.changed(capsules=capsules)

    def _find_near(
        self, scene: Scene, t: float, skins: list[PosedSkin], counts: SampleCounts
    ) -> list[int]:
        """Return the indices of the objects that may be felt at time t [s], and count the others."""
        near: list[int] = cull(scene.bounds, t, self._boxes.find(scene, skins)).tolist()
        culled = len(scene.objects) - len(near)
        outside = 0
        if culled and not scene.hands:
            outside = note_outside(scene, near, self.spacing, counts)
        self.skipped[AWAY_FROM_HANDS] += culled - outside
        self.skipped[OBJECTS_OUTSIDE] += outside
        return near

    def _choose_allowance(
        self, sources: list[tuple[SampleSource, float]], *, solid: bool, skin: bool
    ) -> Allowance:
        """Return how many samples a frame may have. solid: whether there are regions. skin: whether there are hands."""
        mode = self.mode
        if not solid:
            return PLAIN
        if skin:
            return FINE_ON_SKIN if mode.fine else ON_SKIN
        alone = mode.steers and not mode.strict and len(sources) == 1
        return ALONE if alone and sources[0][0].item.technique.keeps_places else PLAIN

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
            now, share = tracks[hand.name].update(hand, t, self._ahead)
            if now is None:
                self.skipped[HANDS_LOST] += 1
                counts.note_hand(HAND_LOST, hand.name)
            else:
                if share < 1.0:
                    counts.note_hand(HAND_FADING, hand.name)
                there.append((tracks[hand.name].pose_skin(now), share))
        return there

    def _find_sources(
        self, scene: Scene, t: float, near: list[int], hands: list[tuple[PosedSkin, float]]
    ) -> list[tuple[SampleSource, float]]:
        """Return the sources of samples, highest priority first, each with its intended spacing [m]."""
        objects, sources = scene.objects, list[tuple[SampleSource, float]]()
        resolving, judged = self._resolving, self.perception and not self.mode.strict
        free = not scene.hands  # nothing needs to be touched
        for i in near:
            item = objects[i]
            if is_silent(item):
                continue
            number, pose = number_object(item, i), self._tracks.pose(item, t)
            if free:
                of = SinglePoint if isinstance(item, Point) else WholeObject
                whole = of(item, i, number, pose, self._covers, objects)
                sources.append((whole, self._compute_spacing(item, pose.position)))
                continue
            least = lowest_threshold(find_vibration(item)) if judged else 0.0
            for hand, share in hands:
                own = number_contact(number, hand)
                source: SampleSource | None
                if isinstance(item, (Surface, Volume)):
                    source = find_contact(
                        item, pose, i, own, hand, objects, share, least, resolving, self._distances
                    )
                else:
                    source = PointContacts(
                        item, i, own, pose, self._covers, objects, hand, share, resolving, least
                    )
                if source is not None:
                    sources.append((source, self._compute_spacing(item, hand.centre)))
        if self.spacing is None:
            density = (
                ContactDensity(FINE_SHARE * self.budget, FINE_LEAST) if self.mode.fine else IN_TIME
            )
            self._wanted = space_contacts(sources, density, self._wanted)
        sources.sort(key=lambda source: -source[0].item.priority)
        return refine(sources, self.budget) if free and self.spacing is None else sources

    def _note_unresolved(
        self, sources: list[tuple[SampleSource, float]], counts: SampleCounts
    ) -> None:
        """Note the objects whose texture the array cannot resolve, and those without a surface."""
        resolving = self._resolving
        for source, _ in sources:
            if (
                resolving is not None
                and resolving.find_blurring_period(source.item, source.place) > 0.0
            ):
                counts.note_object(TOO_FINE, source.index)
            if isinstance(source, WholeObject) and lacks_surface(source.item):
                counts.note_object(NO_SURFACE, source.index)

    def find_fine_textures(self, scene: Scene) -> Iterator[tuple[int, float, float]]:
        """Yield the objects whose texture is finer than the array resolves where they are.

        Yields the index of each, the period of its texture, and the shortest period that the array resolves there [m].
        Raises ArgumentError if a texture's file cannot be read.
        """
        if self._resolving is None:
            return
        for i, item in enumerate(scene.objects):
            resolved = self._resolving.find_blurring_period(item, item.pose.position)
            if resolved > 0.0:
                assert isinstance(item, Body)
                assert item.texture is not None
                yield i, item.texture.period, resolved

    def _compute_spacing(self, item: Object, place: tuple[float, float, float]) -> float:
        """Return the spacing of an object's samples at `place` [m]."""
        own = self.spacing
        return compute_spacing(item, place, self._resolving) if own is None else own
