"""Sound in air: the medium, transducers, arrays, and propagation from an array to points.

air.py                 `Air`: speed of sound, density, attenuation, absorption by ISO 9613-1; room temperature 22 degC
transducer.py          `Transducer`: frequency, strength P0, directivity; IDEAL and T4010A1
directivity.py         D(theta): omni, T4010A1, piston, measured table
array.py               `Array`: positions, normals, responses; `autd` units, `lattice`, fold, transform
array_record.py        an array's transducer type and responses as plain values of a file
pose.py                `Pose`: position and quaternion; rotate, invert, apply to points
propagation.py         equations (3) to (7): `matrix` B and `field` p = B g, in single or double precision
kernels.hpp            B and p in one pass, single precision: called by propagation.py
interpolated_field.py  the field on a fine regular grid from fewer points: Chebyshev polynomials, for pictures
audibility.py          how audible a sequence of frames is: from the envelope of the ultrasound
gradients.py           derivatives of pressure by gains and by position
pressure.py            equation (1): radiation pressure from sound pressure; at an angle: skin_facing.py
intensity.py           acoustic intensity; radiation pressure along the skin's normal from particle velocity
skin_facing.py         `SkinFacing`: weights of B for skin that sound meets at an angle, or behind the hand (occlusion)
skin_facing.hpp        these weights: called by skin_facing.py
tapered_capsules.hpp   tapered capsules of a hand: included by skin_facing.hpp and scene/hands/capsules.hpp
resolution.py          what an array resolves: size of a focus, focal area
directions.hpp         spread of directions from points to transducers: called by resolution.py
uncertainty.py         `Uncertainty`: prediction intervals of a pressure or force, by Monte Carlo
"""
