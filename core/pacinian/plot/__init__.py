"""Pictures. Needs Matplotlib, of the extra `plot`; works without a display.

`__init__.pyi` beside this file lists the public names; each is imported when it is first used.

fields.py           `field`, `slices`: the field in planes, and which quantity they draw by default
planes.py           which planes are drawn: size, grid, axes
quantities.py       radiation pressure, sound pressure, level, phase: units, limits, which colour map each has
volumes.py          `volume`, `isosurface`: the field in a box
scenes.py           `scene`: scene, samples and field on one page
boards.py           `boards`: a device's boards, channel order, dead transducers
drives.py           `drive`: phase and amplitude of each transducer
animations.py       `animate`: GIF, WebP, APNG, MP4
timelines.py        `timeline`: drive, ticks, errors, skipped work of a run
feeds.py            time series from a recording of the viewer
emissions.py        gains over time, on an even grid: for `waveform` and `animate`
waveforms.py        `waveform`, `spectrogram`: pressure at a point over time, audible levels
traces.py           `convergence`: error by iteration of solvers
pareto_front.py     `pareto`: run time against error, from `pacinian bench`
exporting.py        `export`: glTF, VTK
meshes.py           triangles of arrays, hands, objects, samples for export
mesh_colours.py     colours of these meshes, colour wheels and strips
discs.py            objects in space as shaded discs
outlines.py         outlines of hands, and of objects in a plane
labels.py           labels beside points, where there is room
style.py            widths, font sizes, colours safe for the colour-blind; the colour maps that pictures share
page.py             figures and panels; saves them; needs the extra `plot`
notebook_figure.py  a figure that notebooks show
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
