"""Sampling: turn a scene into samples, given what the hands touch, the array resolves and people feel.

sampler.py, samples.py            the API: one tick, from a scene to samples; what they are
Where
    broad_phase.py, posed_skin.py     objects near a hand; skin that touches them
    sources.py, refine.py             samples of objects and contacts; closer ones for small regions
    array_resolution.py               what the array resolves and sees
    surround.py, bands.py             silent samples beside a region; parts of a large region in turn
How many, how strong
    sample_budget.py, sample_counts.py   samples divided among objects; what becomes of them
    ramps.py, perception_thresholds.py   pressures without jumps; what nobody feels
In time
    hand_tracking.py, pose_prediction.py   hands and objects between their updates
    sample_cache.py, distance_cache.py     what has hardly moved
"""
