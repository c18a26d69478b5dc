"""Benchmark how even the pressure of regions is, at places that no solver was given.

shapes.py, contacts.py         flat and solid shapes; contacts of a hand
methods.py, peers.py           regions, foci, sweeps; autd3's solvers
score.py, skin.py              the figures; what a hand feels over all touched skin
run.py, cost.py, tables.py, pictures.py   the run; run times; what it found
"""
