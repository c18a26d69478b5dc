"""Sound in air: the medium, transducers, arrays, and propagation from an array to points.

air.py, transducer.py, directivity.py, array.py, array_record.py, pose.py   what emits, and in what
propagation.py, interpolated_field.py, gradients.py   equations (3) to (7); on fine grids; derivatives
pressure.py, intensity.py      equation (1); along the normals of skin
skin_facing.py                 sound at an angle, and behind a hand
resolution.py, uncertainty.py  what an array resolves; how sure a pressure is
"""
