"""Samples: target pressures at positions on the skin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.notebook import Card, card

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.types import Flags, Floats, Indices, Longs


@dataclass(frozen=True, eq=False)
class Samples:
    """M samples of a scene.

    positions: (M, 3) [m]. radiation_pressure: at full envelope, (M,) [Pa]. normals: outward normals of the skin or,
    without a hand, of the object, (M, 3); zero for points. area: represented by each sample, (M,) [m^2]. objects:
    index of each sample's object in `items`, (M,). keys: identify samples from tick to tick, (M,). most: full pressure
    of each sample's object, (M,) [Pa]. regions: number of each sample's region, (M,), -1 for an isolated sample; see
    `pacinian.Targets`. items: the objects of the scene, then objects that have left it and still fade. capsules: of
    the hands on whose skin the samples lie, (C, 8) [m]; they block sound. None without hands.
    """

    positions: Floats
    radiation_pressure: Floats
    normals: Floats
    area: Floats
    objects: Indices
    keys: Longs
    most: Floats
    regions: Longs
    items: tuple[Object, ...] = ()
    capsules: Floats | None = None

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def force(self) -> float:
        """Total force of the samples [N]."""
        return float(self.radiation_pressure @ self.area)

    def __repr__(self) -> str:
        P = self.radiation_pressure
        felt = (
            f", {P.min():.3g} to {P.max():.3g} Pa, {1e3 * self.force:.3g} mN" if len(self) else ""
        )
        return f"<{len(self)} samples of {len(set(self.objects.tolist()))} objects{felt}>"

    @card
    def _repr_html_(self) -> Card:
        P, items = self.radiation_pressure, len(set(self.objects.tolist()))
        rows = {"objects felt": items, "force": f"{1e3 * self.force:.3g} mN"}
        rows |= {"pressure": f"{P.min():.3g} to {P.max():.3g} Pa"} if len(self) else {}
        return Card(f"{len(self)} samples", rows, draw=self._draw if len(self) else None)

    def _draw(self, panel: Any) -> None:
        """Draw the samples from above, coloured by pressure."""
        x, y, _ = 1e3 * self.positions.T
        marks = panel.scatter(x, y, c=self.radiation_pressure, s=6, vmin=0.0)
        bar = panel.figure.colorbar(marks)
        bar.set_label("[Pa]", fontsize=7)
        bar.ax.tick_params(labelsize=6)
        panel.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal", adjustable="datalim")

    def only(self, kept: Flags | Indices) -> Samples:
        """Select samples by flags, (M,), or by indices in the order wanted."""
        return self.changed(
            positions=self.positions[kept],
            radiation_pressure=self.radiation_pressure[kept],
            normals=self.normals[kept],
            area=self.area[kept],
            objects=self.objects[kept],
            keys=self.keys[kept],
            most=self.most[kept],
            regions=self.regions[kept],
        )

    def with_pressure(self, radiation_pressure: Floats) -> Samples:
        """Return the same samples with other pressures, (M,) [Pa]."""
        return self.changed(radiation_pressure=radiation_pressure)

    def is_near(self, other: Samples, distance: float) -> bool:
        """Return whether these are the same samples at the same pressures, and neither they nor the hands are far away.

        distance: that they may have moved [m]. The envelopes and techniques of their objects must be equal, too.
        """
        if not self._is_alike(other):
            return False
        moved = [self.positions - other.positions]
        if (self.capsules is None) != (other.capsules is None):
            return False
        if self.capsules is not None and other.capsules is not None:
            if self.capsules.shape != other.capsules.shape:
                return False
            moved.append((self.capsules - other.capsules)[:, :6].reshape(-1, 3))
        return not any((d * d).sum(axis=1).max(initial=0.0) > distance * distance for d in moved)

    def find_shift(self, other: Samples, distortion: float) -> Floats | None:
        """Return by how much these samples have moved as one since they were `other`, (3,) [m], or None.

        distortion: by how much the way of each may differ from the mean, along each axis [m]. Pressures, envelopes and
        techniques must be equal.
        """
        if not len(self) or not self._is_alike(other):
            return None
        moved = self.positions - other.positions
        shift: Floats = moved.mean(axis=0)
        return shift if float(np.abs(moved - shift).max()) <= distortion else None

    def _is_alike(self, other: Samples) -> bool:
        """Return whether these are the same samples, wherever they are: pressures, regions, envelopes, techniques."""
        if len(self) != len(other) or not np.array_equal(self.keys, other.keys):
            return False
        if (self.capsules is None) != (other.capsules is None) or len(self.items) != len(
            other.items
        ):
            return False
        P, before = self.radiation_pressure, other.radiation_pressure
        if not np.array_equal(self.regions, other.regions):
            return False
        if not (np.array_equal(P, before) or np.allclose(P, before, 1e-3, 0.0)):
            return False
        pairs = ((self.items[i], other.items[i]) for i in set(self.objects.tolist()))
        return np.array_equal(self.objects, other.objects) and all(
            a is b or (a.envelope == b.envelope and a.technique == b.technique) for a, b in pairs
        )

    def changed(self, **values: Any) -> Samples:
        """Return these samples with other values of some fields; takes a fifth of the time of `dataclasses.replace`."""
        made = object.__new__(Samples)
        made.__dict__.update(self.__dict__, **values)
        return made


def no_samples(items: tuple[Object, ...] = (), capsules: Floats | None = None) -> Samples:
    """Return an empty set of samples."""
    return Samples(
        np.empty((0, 3)), np.empty(0), np.empty((0, 3)), np.empty(0),
        np.empty(0, dtype=np.intp), np.empty(0, dtype=np.int64), np.empty(0), np.empty(0, dtype=np.int64),
        items, capsules,
    )  # fmt: skip


def join_samples(parts: list[Samples]) -> Samples:
    """Join sets of samples of the same objects, in order. At least one part is needed."""
    if len(parts) == 1:
        return parts[0]
    first = parts[0]
    return Samples(
        np.concatenate([part.positions for part in parts]),
        np.concatenate([part.radiation_pressure for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.area for part in parts]),
        np.concatenate([part.objects for part in parts]),
        np.concatenate([part.keys for part in parts]),
        np.concatenate([part.most for part in parts]),
        np.concatenate([part.regions for part in parts]),
        first.items,
        first.capsules,
    )
