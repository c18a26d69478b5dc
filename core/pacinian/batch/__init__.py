"""Many problems in one call, on all cores.

solve_many.py  `solve_many`: threads or processes, how problems are spread on cores
task.py        `Task`: all problems and what they share; solves those with given numbers
processes.py   worker processes: pickles over pipes, reused for 60 s
columns.py     solutions as columns, cheaper to send than one by one
"""
