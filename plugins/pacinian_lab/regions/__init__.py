"""Benchmark how even the pressure of regions is, at places that no solver was given.

run.py       each shape at each strength, made in each way
shapes.py    flat and solid shapes: request, places of measurement
contacts.py  contacts of a hand, by the rendering loop and by foci
methods.py   ways to make a shape: regions, foci at some spacings, sweeps
peers.py     autd3's solvers on the same shapes, in a process of their own
score.py     force, rms, holes, pressure beside the region
skin.py      what a hand feels over all touched skin, at points that are not samples
cost.py      time of a cold and a warm solve, and of B
tables.py    results in a terminal
pictures.py  pictures of requests and pressures
"""
