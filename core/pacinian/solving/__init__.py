"""Inputs and outputs of solvers: targets, limits, budget, propagator and solution. The solvers are plug-ins.

What goes in
    problem.py, quiet_zone.py         targets, limits and budget; quiet zones
    propagator.py, column_groups.py, factor.py   B and what is derived from it
What solvers share
    regions.py, phases.py, skin_phases.py, corrections.py   free phases; amplitudes that are missing
    least_squares.py, quiet_subspace.py   gains of least norm, also without sound in quiet zones
    limit_enforcement.py              limits, whatever a solver has written
    linalg.py, blas.py, buffer_pool.py   libraries and memory
What comes out
    solution.py, solution_values.py, solution_file.py, solution_tables.py, status.py
Evidence
    solution_check.py, gain_evaluation.py   from the gains: status, limits, bound; in double precision
    felt_regions.py, surface_force.py   between and beside the samples; force on a surface
    relaxation.py                     a lower bound for any phases
"""
