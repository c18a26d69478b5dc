"""How far apart samples lie: as far as the array resolves, and closer within regions and contacts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from pacinian.scene.sampling.array_resolution import SPACING_RATIO
from pacinian.scene.sampling.contact import Contact
from pacinian.scene.sampling.sample_sources import forms_region

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.array_resolution import ArrayResolution
    from pacinian.scene.sampling.sample_sources import SampleSource

SPACING_WITHOUT_ARRAY = 0.0085  # spacing before an array is known [m]
# Spacing within a region, relative to the resolution. Above it, the pressure between samples is uneven.
REGION_SPACING = 0.5 / SPACING_RATIO
# Largest spacing within a contact, relative to the resolution. The pressure of a contact falls to 0 at its rim.
MAX_CONTACT_SPACING = 0.3
# a contact keeps its spacing if the spacing would change by less than this factor
KEPT_SPACING = 1.3


class ContactDensity(NamedTuple):
    """How densely contacts are sampled.

    number: total area of the contacts over the squared spacing. The points of a skin lie less densely, so that contacts
    have about half as many samples. least: smallest spacing, relative to the resolution.
    """

    number: float
    least: float


IN_TIME = ContactDensity(150, 0.08)  # if solves must be fast
# Otherwise: number of samples relative to the budget, and smallest spacing relative to the resolution (decision 80).
FINE_SHARE, FINE_LEAST = 1.25, 0.06


def compute_spacing(
    item: Object, place: tuple[float, float, float], resolving: ArrayResolution | None
) -> float:
    """Return the spacing of an object's samples at `place` [m]. resolving: None if no array is known yet."""
    resolved = (
        SPACING_WITHOUT_ARRAY if resolving is None else resolving.compute_isolated_spacing(place)
    )
    return REGION_SPACING * resolved if forms_region(item) else resolved


def space_contacts(
    sources: list[tuple[SampleSource, float]], density: ContactDensity, last: dict[int, float]
) -> dict[int, float]:
    """Set the spacings of all contacts that are regions, so that together they have about `density.number` samples.

    sources: each with its spacing [m]; those of contacts are replaced. last: previous spacings, by the name of the
    contact [m]. Returns the new ones.
    """
    wanted: dict[int, float] = {}
    dense = [
        (n, source, spacing / REGION_SPACING)
        for n, (source, spacing) in enumerate(sources)
        if isinstance(source, Contact) and forms_region(source.item)
    ]
    each = sum(contact.extent for _, contact, _ in dense) / density.number
    for n, contact, resolved in dense:
        spacing = _choose_spacing(each, resolved, density.least, last.get(contact.name))
        wanted[contact.name] = contact.fine = spacing
        sources[n] = contact, spacing
    return wanted


def _choose_spacing(each: float, resolved: float, least: float, last: float | None) -> float:
    """Return the spacing of a contact's samples [m], but no finer than the array can use.

    each: area for which one sample should stand [m^2]. resolved: resolution of the array there [m]. least: smallest
    spacing, over that. last: previous spacing [m], which is kept if the new one is similar.
    """
    wanted = min(max(math.sqrt(each), least * resolved), MAX_CONTACT_SPACING * resolved)
    if last is not None and wanted / KEPT_SPACING < last < wanted * KEPT_SPACING:
        return last
    return wanted
