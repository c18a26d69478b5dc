"""The peers' own examples that are about touch, made again with Pacinian.

examples.py   what each example asks        workers/   how each package makes it, in its own process
score.py      the field that comes out, by code that no solver uses        run.py, tables.py   the command
"""
