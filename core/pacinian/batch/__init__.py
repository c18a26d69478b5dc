"""Many problems in one call, on all cores.

solve_many.py   the call        task.py   the problems and how one is solved
processes.py   the other processes      columns.py   the solutions that they send
"""
