"""Benchmarks of the built-in scenes: time per tick, saved work, audible noise.

run.py         time per tick by stage, late ticks, error of pressures
report.py      verdicts, JSON
tables.py      results in a terminal
tick_parts.py  time of a tick in kernels and Python; wake-up delay
savings.py     ticks with and without a skip, in turn
skips.py       which work can be skipped, and how each skip is disabled
growth.py      time by number of objects
audibility.py  audible noise of moving scenes, with and without smoothing
pictures.py    a picture of each scene
"""
