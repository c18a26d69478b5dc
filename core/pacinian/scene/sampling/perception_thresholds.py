"""Perception thresholds of vibration on the palm side of the hand, as radiation pressure.

The level of the threshold was measured with radiation force on a finger, through a disc of 1.8 cm^2, with square-wave
modulation of 50 to 1000 Hz. The minimum is about 0.4 mN at 200 Hz, which is 2.2 Pa [1]. In air, the minimum is at about
200 Hz too [2].

The shape of the threshold follows from two curves. The threshold of displacement is flat up to 40 Hz, falls by 12 dB
per octave to 250 Hz [3], and then rises by 9 dB per octave [4]. The skin acts as a spring below its natural frequency,
and as a mass above. This frequency is 80 Hz in the palm, and 200 Hz in the fingers [5]. The table holds the lower
threshold of both places. From 80 to 200 Hz it follows the palm, where the mass needs 12 dB more force per octave, which
cancels the fall of the displacement. Above 200 Hz, the mass is left out.

[1] Dalecki et al., JASA 97, 3165, 1995. [2] Hasegawa and Shinoda, IEEE Trans. Haptics, 2018, doi
10.1109/TOH.2018.2799220. [3] Verrillo, 1963, in Gescheider and Verrillo, doi 10.1007/978-1-4613-3039-4_10.
[4] Verrillo, "Vibrotactile thresholds for hairy skin", which states this for both kinds of skin. [5] Lundström,
J. Biomech. 17, 137, 1984. [6] Brisben et al., J. Neurophysiol. 81, 1548, 1999. We read only the abstracts, not the
curves of [1] and [2]. We assume that the two curves may be combined.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from pacinian.argument_checks import check_number
from pacinian.scene.modulation.technique import AM

if TYPE_CHECKING:
    from pacinian.scene.objects import Object

THRESHOLDS = np.array([(40.0, 8.8), (80.0, 2.2), (200.0, 2.2), (1000.0, 22.0)])  # [Hz], [Pa]
MIN_THRESHOLD = float(THRESHOLDS[:, 1].min())  # [Pa]
FELT_MARGIN = 10.0
"""Factor below the mean threshold within which a pressure still counts as felt.

These 20 dB cover differences between people and between places. 2.2 Pa is a mean for 1.8 cm^2. Twice the area needs
3 dB less [4], which would be 19 dB less for a whole hand of 150 cm^2. In a measurement, the threshold of a bar in the
hand was 18.5 dB below that of a pin of 1 mm [6]."""
MAX_FREQUENCY = 500.0  # higher frequencies alias in a device of 1000 rows per second [Hz]


@functools.lru_cache(maxsize=256)
def threshold(frequency: float) -> float:
    """Return the peak radiation pressure that a vibration at `frequency` [Hz] needs to be felt [Pa].

    Interpolates linearly on logarithmic scales between the rows of `THRESHOLDS`, and is constant beyond them. Raises
    ArgumentError.
    """
    f = max(check_number("frequency", frequency, low=0.0), float(THRESHOLDS[0, 0]))
    return float(np.exp(np.interp(np.log(f), *np.log(THRESHOLDS).T)))


def lowest_threshold(envelope: object) -> float:
    """Return the lowest radiation pressure at full envelope that anyone might feel [Pa].

    A tenth of the threshold counts as felt (`FELT_MARGIN`). envelope: if it has a `frequency` of up to 500 Hz, the
    threshold at that frequency counts; otherwise the lowest threshold counts. Pass None for a sample that moves along a
    path, because the skin then feels other frequencies than the envelope's.
    """
    frequency = getattr(envelope, "frequency", None)
    if isinstance(frequency, (int, float)) and 0.0 < frequency <= MAX_FREQUENCY:
        return threshold(frequency) / FELT_MARGIN
    return MIN_THRESHOLD / FELT_MARGIN


def find_vibration(item: Object) -> object:
    """Return the envelope or technique that sets the frequency at which an object is felt; None if neither does."""
    if not item.technique.keeps_places:
        return None
    return item.technique if isinstance(item.technique, AM) else item.envelope
