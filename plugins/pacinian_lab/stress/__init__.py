"""Test numerical stability: hard problems, the guarantees of every solver, and whether the solver keeps them.

run.py                       every problem with every solver; the propagator through many moves
guarantees.py                what each solver guarantees, with tolerances
check.py                     does a solver keep its guarantees on a problem?
answer_checks.py             guarantees of every answer: limits, reported error, bound
region_checks.py             guarantees about regions, by brute force
reference.py                 the smallest residual, without a solver
case.py                      one hard problem
cases.py                     all of them
problem_parts.py             building blocks: arrays, points, targets
ill_conditioned_problems.py  coincident points, touching transducers, low rank, extreme media
extreme_problems.py          extreme targets, all limits, many points, long series of moves
region_problems.py           hard regions
"""
