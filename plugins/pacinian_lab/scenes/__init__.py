"""Benchmarks of the built-in scenes: time per tick, saved work, audible noise.

run.py, report.py, tables.py   run the scenes; their verdicts; tables in a terminal
tick_parts.py                  kernels and Python, by stage; the wake-up
savings.py, skips.py           what a tick saves by skipping work; what can be skipped
growth.py                      time by the number of objects
audibility.py, onsets.py       audible noise of moving scenes; of objects that come and go
pictures.py                    a picture of each scene
"""
