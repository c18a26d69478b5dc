"""Sampling: turn a scene into samples, given what the hands touch, the array resolves and people feel.

sampler.py                    `Sampler`: one tick, from scene to samples: the sequence of the steps below
samples.py                    `Samples`: points, target pressures, normals, areas, objects, keys, regions
Where
    culling_boxes.py          boxes in which anything can be felt; culls objects, and cuts off samples
    contact.py                `find_contact`: skin inside a surface or volume, and its forces
    posed_skin.hpp            skin near an object; pressure by depth, for surfaces and volumes: called by posed_skin.py
    contact_nodes.hpp         forces on nodes of skin: called by contact.py and posed_skin.py
    posed_skin.py             `PosedSkin`: a hand's skin where it is now; what is near, pressed, or beside
    sample_sources.py         objects without a hand; points, paths and particles that touch one
    spacing.py                distance between samples of any object: a wavelength or more; closer in regions, contacts
    array_resolution.py       resolution of the array by place, and textures that it blurs; how much of its sound
                              reaches skin of some orientation
    small_region_spacing.py   closer samples for small regions
    textured_samples.py       samples on the outlines of a texture, and silent ones where it is 0
    silent_samples.py         silent samples beside touched regions, against spill of pressure
    touched_skin.py           `TouchedSkinObserver`: random places on touched skin and beside it, to measure at
    region_bands.py           parts of a large region that sound in turn
How many, how strong
    sample_budget.py          divides the budget among objects by priority; coarsens spacing
    merge_samples.py          merges close samples of different objects
    merge_samples.hpp         compares all pairs of samples: called by merge_samples.py
    focal_pressure.py         pressure of points and particles from their force and the focus of the array
    unsampled_objects.py      why objects have no samples: silent, outside, too far away, on skin that faces away
    sample_counts.py          what became of samples: coarsened, over budget, merged, too faint, out of reach
    ramps.py                  `PressureRamps`: rise and fall in 5 ms; matches samples of two ticks by key and place
    ramps.hpp                 one tick of ramps: called by ramps.py
    perception_thresholds.py  pressure below which a vibration is not felt, by frequency (40 to 500 Hz)
In time
    hand_tracking.py          `HandTrack`: predicts hands, blends updates, holds and fades lost hands
    pose_prediction.py        `PosePredictor`: predicts poses of objects, blends updates
    sample_keys.py            keys of samples: from numbers of objects, of contacts and of samples
    sample_cache.py           samples of each object in its own frame, for objects that only moved
    distance_cache.py         distances of skin to an object, for skin that has hardly moved
"""
