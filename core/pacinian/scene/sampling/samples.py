"""Samples: where on the skin how much pressure is wanted."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.notebook import Card, card

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.types import Flags, Floats, Indices, Longs


ISOLATED = -1  # the region of a sample of none, as in `pacinian.Targets`
BESIDE = -2  # the region of a silent sample beside regions


@dataclass(frozen=True, eq=False)
class Samples:
    """M samples of a scene.

    positions: (M, 3) [m]. radiation_pressure: at full envelope, (M,) [Pa]. normals: outward, of the
    skin, or without a hand of the object; (M, 3), zero for points. area: what each stands for, (M,)
    [m^2]. objects: index of each sample's object among `items`, (M,). keys: which sample each is from
    tick to tick, (M,). most: the most that each one's object presses with, (M,) [Pa]. regions: the surface that
    each is of, (M,), -1 for an isolated one; see `pacinian.Targets`. items: the objects:
    the scene's, then those that are gone and still fade. capsules: of the hands on whose skin they lie, and
    which hide what is behind them, (C, 8) [m]; None without hands.
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
        """What all of them press with [N]."""
        return float(self.radiation_pressure @ self.area)

    @card
    def _repr_html_(self) -> Card:
        P, items = self.radiation_pressure, len(set(self.objects.tolist()))
        rows = {"objects felt": items, "force": f"{1e3 * self.force:.3g} mN"}
        rows |= {"pressure": f"{P.min():.3g} to {P.max():.3g} Pa"} if len(self) else {}
        return Card(f"{len(self)} samples", rows, draw=self._draw if len(self) else None)

    def _draw(self, panel: Any) -> None:
        """Where they are, from above, and how strong."""
        x, y, _ = 1e3 * self.positions.T
        marks = panel.scatter(x, y, c=self.radiation_pressure, s=6, vmin=0.0)
        bar = panel.figure.colorbar(marks)
        bar.set_label("[Pa]", fontsize=7)
        bar.ax.tick_params(labelsize=6)
        panel.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal", adjustable="datalim")

    def only(self, kept: Flags | Indices) -> Samples:
        """Those samples: flags, (M,), or indices in the order wanted."""
        return replace(
            self,
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
        """The same samples with other pressures, (M,) [Pa]."""
        return replace(self, radiation_pressure=radiation_pressure)


def no_samples(items: tuple[Object, ...] = (), capsules: Floats | None = None) -> Samples:
    """No samples."""
    return Samples(
        np.empty((0, 3)), np.empty(0), np.empty((0, 3)), np.empty(0),
        np.empty(0, dtype=np.intp), np.empty(0, dtype=np.int64), np.empty(0), np.empty(0, dtype=np.int64),
        items, capsules,
    )  # fmt: skip


def join_samples(parts: list[Samples]) -> Samples:
    """All of several samples of the same objects, in order; at least one part."""
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
