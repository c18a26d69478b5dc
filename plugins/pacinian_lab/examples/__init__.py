"""The peers' (other projects') own examples that are about touch, made again with Pacinian.

examples.py  what each example asks for: array, air, places
workers/     how each package makes it, in its own process
run.py       all packages in turn; their times
score.py     peaks and quiet places of the field, by code that no solver uses
tables.py    results in a terminal or in docs/
"""
