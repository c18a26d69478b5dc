"""Test numerical stability: hard problems, the promises of every solver, and whether the solver keeps them.

promises.py, check.py, answer_checks.py, region_checks.py   the promises; whether a solver keeps them
case.py, cases.py, problem_parts.py   one problem; all of them; their parts
ill_conditioned_problems.py, extreme_problems.py, region_problems.py   families
reference.py                   the smallest residual, without a solver
run.py                         everything
"""
