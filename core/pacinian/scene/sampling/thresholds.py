"""What nobody feels: the threshold of vibration on the palm side of the hand, as radiation pressure.

Its level was measured with radiation force: on a finger, through a disc of 1.8 cm^2, modulated by
squares, 50 to 1000 Hz, least at 200 Hz, about 0.4 mN, which is 2.2 Pa [1]. In air the least is at
about 200 Hz too [2].

Its shape comes from the threshold of displacement, even up to 40 Hz, then falling by 12 dB an octave to
250 Hz [3], then rising by 9 [4], and from the skin, a spring below its natural frequency, a mass above;
that is 80 Hz in the palm, 200 Hz in the fingers [5]. Of both places the table has the lower: 80 to 200 Hz
are as the palm, where 12 dB more of force an octave cancel the fall, and above the mass is left out.

[1] Dalecki et al., JASA 97, 3165, 1995. [2] Hasegawa and Shinoda, IEEE Trans. Haptics, 2018, doi
10.1109/TOH.2018.2799220. [3] Verrillo, 1963, in Gescheider and Verrillo, doi 10.1007/978-1-4613-3039-4_10.
[4] Verrillo, "Vibrotactile thresholds for hairy skin", which says so of both kinds of skin. [5] Lundström,
J. Biomech. 17, 137, 1984. [6] Brisben et al., J. Neurophysiol. 81, 1548, 1999. Of all only the abstracts were
read: not the curves of [1] and [2]. That both descriptions may be joined is our assumption.
"""

from __future__ import annotations

import functools

import numpy as np

from pacinian.checks import check_number

TABLE = np.array([(40.0, 8.8), (80.0, 2.2), (200.0, 2.2), (1000.0, 22.0)])  # [Hz], [Pa]
MIN_THRESHOLD = float(TABLE[:, 1].min())  # [Pa]
MARGIN = 10.0
"""20 dB for people and places: 2.2 Pa is a mean on 1.8 cm^2, and twice the area needs 3 dB less [4], which
for a whole hand of 150 cm^2 would be 19 dB (measured: a bar in the hand 18.5 dB below a pin of 1 mm [6])."""
MAX_FREQUENCY = 500.0  # [Hz]; what is faster sounds as slower in a device of 1000 frames per second


@functools.lru_cache(maxsize=256)
def threshold(frequency: float) -> float:
    """Radiation pressure [Pa], at its peak, that a vibration at `frequency` [Hz] needs to be felt.

    Straight on logarithmic scales between the rows of `TABLE`, constant beyond them. Raises ArgumentError.
    """
    f = max(check_number("frequency", frequency, low=0.0), float(TABLE[0, 0]))
    return float(np.exp(np.interp(np.log(f), *np.log(TABLE).T)))


def lowest_threshold(envelope: object) -> float:
    """The least radiation pressure [Pa], at full envelope, that anyone might feel.

    A tenth of the threshold counts as felt (`MARGIN`). envelope: one with a `frequency` [Hz] up to 500
    counts at that frequency, any other where the skin is most sensitive. Give None for what moves
    along a path: then the skin feels other frequencies than the envelope's.
    """
    frequency = getattr(envelope, "frequency", None)
    if isinstance(frequency, (int, float)) and 0.0 < frequency <= MAX_FREQUENCY:
        return threshold(frequency) / MARGIN
    return MIN_THRESHOLD / MARGIN
