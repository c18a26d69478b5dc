"""Sampling: turn a scene into samples, given what the hands touch, the array resolves and people feel.

sampler.py, samples.py            the API: one tick, from a scene to samples; what they are
Where
    broad_phase.py, contact.py        objects near a hand; skin that touches them, and how strongly it is pressed
    posed_skin.py                     the skin of a hand where it is now
    sources.py, refine.py             samples of whole objects, points and paths; closer ones for small regions
    spacing.py, array_resolution.py   how far apart samples lie; what the array resolves and sees
    surround.py, bands.py             silent samples beside a region; parts of a large region in turn
How many, how strong
    sample_budget.py, sample_counts.py   samples divided among objects; what becomes of them
    ramps.py, perception_thresholds.py   pressures without jumps; what nobody feels
In time
    hand_tracking.py, pose_prediction.py   hands and objects between their updates
    sample_cache.py, distance_cache.py     what has hardly moved
"""
